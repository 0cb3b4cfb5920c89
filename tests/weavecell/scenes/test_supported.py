"""Every key of every scene's schema is declared by every command, and what is declared supported reaches the solver."""

import copy
from pathlib import Path

import pytest

from weavecell.scenes import build, of_commands, supported
from weavecell.scenes import coupon as scenes_coupon
from weavecell.scenes import impact as scenes_impact

DATA = Path(__file__).parents[2] / "shellfabric" / "cell" / "data"
SUPPORTS = {
    "impact": of_commands.IMPACT,
    "impact with accuracy": of_commands.ACCURACY,
    "explain": of_commands.EXPLAIN,
    "draws": of_commands.DRAWS,
    "critical-velocity": of_commands.LIMITS,
    "fit": of_commands.FIT,
    "fit of a coupon": of_commands.FIT_COUPON,
    "sensitivity": of_commands.SENSITIVITY,
    "sweep": of_commands.SWEEP,
    "coupon": of_commands.COUPON,
}
SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "92.5 m/s"},
    "panel": {"opening": "50 mm", "symmetry": "whole"},
    "run": {"end_time": "60 us"},
}
NAMED = {"name": "FSP 1.10 g", "mass": None, "diameter": None, "edge_radius": None}
CONE = {"shape": "cone", "half_angle": "45 deg", "tip_radius": "0.5 mm"}
CHISEL = {"shape": "chisel", "flat_width": "2.5 mm", "flat_angle": "35 deg"}
EXAMPLES = Path(__file__).parents[3] / "examples"
STL = {"shape": "stl", "stl": str(EXAMPLES / "cube.stl"), "stl_unit": "mm", "mass": "0.8 g", "diameter": None}
PULL = {"pull_in": "1 mm", "start": "0 us", "end": "40 us"}
LAW = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
DAMAGE = {"source": "made up"}
FILE = str(Path(__file__).parents[3] / "fabrics" / "catalogue" / "S-728.toml")
SURFACE = str(DATA / "S-720-coarse-9x9.h5")


def table_of(key, value):
    """{"panel": {"boundary": {"warp": value}}} of "panel.boundary.warp"."""
    for part in reversed(key.split(".")):
        value = {part: value}
    return value


def merged(table, changes):
    found = copy.deepcopy(table)
    for key, value in changes.items():
        both = isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = merged(found[key], value) if both else value
    return {key: value for key, value in found.items() if value is not None}


# key -> (what else the scene needs, two values that must not come to the same), where default and example will not do
SLIPS = {
    f"{side}.{name}": (table_of(side, first), first[name], other)
    for side in ("panel.boundary", "panel.boundary.warp", "panel.boundary.weft")
    for name, other, first in (
        ("clamp_force", "30 N", {"clamp_force": "20 N"}),
        ("pull_in", "2 mm", PULL),
        ("start", "10 us", PULL),
        ("end", "50 us", PULL),
        ("zone", "30 mm", PULL | {"zone": "40 mm"}),
    )
}
KEYS = SLIPS | {
    "fabric.name": ({}, "S-720", "S-728"),
    "fabric.file": ({"fabric": {"name": None}}, FILE, FILE.replace("S-728", "S-731")),
    "fabric.weaving_damage.modulus": ({"fabric": {"weaving_damage": DAMAGE}}, 1.0, 0.9),
    "fabric.weaving_damage.strength": ({"fabric": {"weaving_damage": DAMAGE}}, 1.0, 0.8),
    "fabric.weaving_damage.source": ({"fabric": {"weaving_damage": DAMAGE}}, "made up", "another"),
    "fabric.weaving_damage.status": ({"fabric": {"weaving_damage": DAMAGE}}, "assumed", "measured"),
    "fabric.law": ({}, "published", LAW),
    "fabric.law.a": ({"fabric": {"law": LAW}}, "0.04 mm", "0.05 mm"),
    "fabric.law.b": ({"fabric": {"law": LAW}}, "0.05 mm N^(1/3)", "0.06 mm N^(1/3)"),
    "fabric.law.form": ({"fabric": {"law": LAW}}, "regularised", "printed"),
    "fabric.cell_formulation": ({}, "variational", "equilibrium"),
    "fabric.crossover_gap": ({}, "0 mm", "0.01 mm"),
    "fabric.surface": ({}, None, SURFACE),
    "projectile.name": ({"projectile": NAMED}, "FSP 1.10 g", "FSP 2.79 g"),
    "projectile.mass": ({}, "3 g", "4 g"),
    "projectile.diameter": ({}, "5.5 mm", "6 mm"),
    "projectile.edge_radius": ({}, "0.3 mm", "0.4 mm"),
    "projectile.strike_velocity": ({}, "92.5 m/s", "100 m/s"),
    "projectile.shape": ({}, "flat", "hemisphere"),
    "projectile.half_angle": ({"projectile": CONE}, "45 deg", "50 deg"),
    "projectile.tip_radius": ({"projectile": CONE}, "0.5 mm", "0.6 mm"),
    "projectile.flat_width": ({"projectile": CHISEL}, "2.5 mm", "2.6 mm"),
    "projectile.flat_angle": ({"projectile": CHISEL}, "35 deg", "36 deg"),
    "projectile.stl": ({"projectile": STL}, STL["stl"], str(Path(__file__).with_name("pyramid.stl"))),
    "projectile.stl_unit": (
        {"projectile": STL | {"mass": None, "density": "1 g/cm^3", "edge_radius": "2 mm"},
         "panel": {"opening": "300 mm"}},
        "mm", "cm",
    ),
    "projectile.density": ({"projectile": STL | {"mass": None}}, "7.85 g/cm^3", "8 g/cm^3"),
    "projectile.azimuth": ({"projectile": {"obliquity": "30 deg"}}, "0 deg", "90 deg"),
    "projectile.roll": ({"projectile": CHISEL}, "0 deg", "5 deg"),
    "projectile.bore_diameter": ({"projectile": {"body": "elastic_bar"}}, "4.5 mm", "4.6 mm"),
    "panel.opening": ({}, "50 mm", "60 mm"),
    "panel.boundary": ({}, "clamped", "free"),
    "panel.boundary.warp": ({}, "clamped", "free"),
    "panel.boundary.weft": ({}, "clamped", "free"),
    "panel.symmetry": ({}, "whole", "quarter"),
    "panel.crossover_friction": ({"panel": {"crossovers": "sliding"}}, 0.2, 0.3),
    "panel.crossover_cohesion": ({"panel": {"crossovers": "sliding"}}, "0 N", "1 N"),
    "panel.plies": ({}, 1, 2),
    "panel.ply.name": ({}, [{"name": "S-726"}, {}], [{"name": "S-728"}, {}]),
    "panel.ply.file": ({}, [{"file": FILE}, {}], [{"file": FILE.replace("S-728", "S-731")}, {}]),
    "panel.ply.law": ({}, [{"law": LAW}, {}], [{"law": LAW | {"a": "0.05 mm"}}, {}]),
    "panel.ply.law.a": ({}, [{"law": LAW}, {}], [{"law": LAW | {"a": "0.05 mm"}}, {}]),
    "panel.ply.law.b": ({}, [{"law": LAW}, {}], [{"law": LAW | {"b": "0.06 mm N^(1/3)"}}, {}]),
    "panel.ply.law.form": ({}, [{"law": LAW}, {}], [{"law": LAW | {"form": "printed"}}, {}]),
    "panel.ply.angle": ({}, [{"angle": "0 deg"}, {}], [{"angle": "90 deg"}, {}]),
    "panel.ply.gap": ({}, [{"gap": "0.1 mm"}, {}], [{"gap": "0.2 mm"}, {}]),
    "panel.ply.count": ({}, [{"count": 2}], [{"count": 3}]),
    "panel.stacking": ({"panel": {"plies": 2}}, "aligned", "alternating"),
    "panel.ply_gap": ({"panel": {"plies": 2}}, "0.1 mm", "0.2 mm"),
    "panel.ply_contact": ({"panel": {"plies": 2}}, "solid", "pressure_law"),
    "panel.ply_friction": ({"panel": {"plies": 2}}, 0.0, 0.1),
    "panel.grading": ({}, [["inf", 1]], [[8, 1], ["inf", 2]]),
    "run.end_time": ({}, "60 us", "70 us"),
    "run.snapshot_interval": ({}, "10 us", "20 us"),
    "history.interval": ({"history": {}}, "1 us", "2 us"),
    "backing.material": ({"backing": {}}, "gelatine 10 %", "gelatine 20 %"),
    "backing.size": ({"backing": {}}, ["300 mm", "300 mm", "180 mm"], ["200 mm", "300 mm", "180 mm"]),
    "backing.modulus": ({"backing": {}}, "100 MPa", "90 MPa"),
    "backing.density": ({"backing": {}}, "3 g/cm^3", "2 g/cm^3"),
    "backing.yield_stress": ({"backing": {}}, "20 MPa", "10 MPa"),
    "backing.hardening": ({"backing": {}}, "0 Pa", "1 MPa"),
    "backing.reference_rate": ({"backing": {}}, "1 / s", "2 / s"),
    "backing.min_size": ({"backing": {}}, "1 mm", "2 mm"),
    "backing.refined_depth": ({"backing": {}}, "8 mm", "9 mm"),
}  # fmt: skip


def values(key):
    """What else the scene needs for a key, and two values that must not come to the same, None for its default."""
    if key in KEYS:
        return KEYS[key]
    entry = supported.entries(scenes_impact.Scene)[key]
    return {key.partition(".")[0]: {}}, None, entry.examples[0] if entry.examples else not entry.default


# what the set-up of the solver does not hold; tests/weavecell/scenes/test_scene_matrix.py sees to them by runs
OF_THE_RUN = {
    "title",
    "history.report_positions",
}
OF_THE_RUN |= {
    "run.checkpoint_interval",
    "run.outputs",
    *(f"accuracy.{name}" for name in scenes_impact.AccuracyTable.model_fields),
}
COUPONS = {
    "bias_extension": {"length": "60 mm", "width": "30 mm", "elongation": "4 mm"},
    "picture_frame": {"shear_angle": "20 deg"},
    "uniaxial": {"direction": "warp", "length": "40 mm", "width": "10 mm", "strain": "2 %"},
    "biaxial": {"strain": ["1 %", "1 %"]},
}


def numbers(value):
    """A table's `inf` as TOML gives it."""
    if isinstance(value, list):
        return [numbers(part) for part in value]
    return float("inf") if value == "inf" else value


def unknown(support):
    """Keys of a command's declaration that the schema has not, or that it declares twice."""
    every = supported.keys(support.model)
    known = {name for key in every for name in supported.with_tables(key)}
    named = [*support.ignored, *support.rejected]
    wrong = [key for key in (*named, *(rule.key for rule in support.rules)) if key not in known]
    return wrong + [key for key in named if named.count(key) > 1]


@pytest.mark.parametrize("name", SUPPORTS)
def test_what_is_declared_exists(name):
    assert unknown(SUPPORTS[name]) == []


def test_what_is_set_is_found():
    changes = {
        "panel": {"boundary": {"warp": [{"clamp_force": "20 N"}, "clamped"]}, "plies": 1},
        "history": {},
        "numerics": {},
    }
    asked = scenes_impact.check(merged(SHOT, changes), "s")
    found = list(supported.changed(asked))
    assert "panel.boundary.warp.clamp_force" in found
    assert "history" in found
    assert not {"panel.plies", "numerics", "fabric", "run.snapshot_interval"} & set(found)


def honoured():
    """(command, key) of what the commands that shoot declare supported and the set-up holds."""
    for name, support in SUPPORTS.items():
        if support.model is scenes_impact.Scene:
            yield from ((name, key) for key in support.supported if key not in OF_THE_RUN)


@pytest.mark.parametrize(("name", "key"), list(honoured()))
def test_a_supported_key_reaches_the_solver(name, key):
    """Two values of it make two set-ups, or for the ballistic limit two panels."""
    context, first, other = values(key)
    if name in ("impact with accuracy", "explain"):
        context = merged(context, {"accuracy": {"deflection": "5 %"}})
    made = []
    for value in (first, other):
        written = "panel.ply" if key.startswith("panel.ply.") else key  # plies are given whole
        table = merged(merged(SHOT, context), table_of(written, numbers(value)))
        asked = scenes_impact.check(table, "s", SUPPORTS[name])
        made.append(repr(build.setup(build.build(asked, "s", "s"), "s")))
    assert made[0] != made[1]


OF_THE_CELL = [key for key in of_commands.COUPON.supported if key.startswith("fabric.") and key != "fabric.bending"]


@pytest.mark.parametrize("key", OF_THE_CELL)
def test_a_supported_key_of_a_coupon_reaches_its_cell(key):
    context, first, other = values(key)
    made = []
    for value in (first, other):
        base = {"fabric": SHOT["fabric"], "uniaxial": COUPONS["uniaxial"]}
        asked = scenes_coupon.check(merged(merged(base, context), table_of(key, value)), "s", of_commands.COUPON)
        this, cloth = build.build(asked, "s", "s"), asked.fabric
        cell = (cloth.crossover_gap, cloth.cell_model, cloth.cell_formulation, cloth.cell_profile, cloth.fibre_slack)
        made.append(repr((this.fabric, this.laws, cell)))
    assert made[0] != made[1]


@pytest.mark.parametrize("test", COUPONS)
def test_the_tables_of_a_coupon_are_arguments_of_its_test(test):
    """All keys of a test's table and of [run] are passed on by name, so that one too many is a TypeError."""
    import inspect

    from shellfabric.coupon import quasistatic
    from shellfabric.coupon import solver as coupon_solver

    kind = scenes_coupon.CouponScene.model_fields[test].annotation.__args__[0]
    known = set(inspect.signature(getattr(quasistatic, test)).parameters)
    known |= set(inspect.signature(coupon_solver.run).parameters)
    named = {{"crossovers": "cells"}.get(key, key) for key in kind.model_fields}
    assert named <= known
    assert set(scenes_coupon.CouponRunTable.model_fields) - {"outputs"} <= known


def test_the_table_of_a_pull_out_is_used_whole():
    """All keys of the table are read by the run, which names each."""
    import inspect

    from weavecell.results import pull_out

    text = inspect.getsource(pull_out.run)
    assert [key for key in scenes_coupon.PullOutTable.model_fields if f"inputs.{key}" not in text] == []


def test_what_is_ignored_is_named_in_the_help(command):
    for words, support in (
        ("impact", of_commands.EXPLAIN),
        ("impact", of_commands.DRAWS),
        ("compare", of_commands.LIMITS),
        *(("fit", one) for one in (of_commands.FIT, of_commands.LIMITS, of_commands.FIT_COUPON)),
        ("critical-velocity", of_commands.LIMITS),
        ("v50", of_commands.LIMITS),
        ("sensitivity", of_commands.SENSITIVITY),
    ):
        told = command(words, "--help")[1]
        ignored = [key for key in supported.keys(support.model) if support.use_of(key) == "ignored"]
        assert [key for key in ignored if key not in told] == []
    ignoring = {name for name, support in SUPPORTS.items() if support.ignored}
    assert ignoring == {
        "explain", "draws", "critical-velocity", "sensitivity", "sweep", "fit", "fit of a coupon",
    }  # fmt: skip
