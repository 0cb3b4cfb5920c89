"""Each key of an input file sets its own field of the set-up, in SI units, and no other."""

from dataclasses import fields, is_dataclass
from math import inf, pi, radians
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base import schema
from fabrics.base.units import si
from shellfabric.cell.model import CellModel
from tests.scene_text import merged, table_of
from weavecell.results import coupon as results
from weavecell.scenes import build, honoured
from weavecell.scenes.coupon import CouponScene, PullOutTable
from weavecell.scenes.fabric_table import FabricTable
from weavecell.scenes.impact import Scene, check

ROOT = Path(__file__).parents[3]
SURFACE = str(ROOT / "tests" / "shellfabric" / "cell" / "data" / "S-720-coarse-9x9.h5")
SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {
        "mass": "2.9 g",
        "diameter": "5 mm",
        "edge_radius": "0.2 mm",
        "strike_velocity": "90 m/s",
    },
    "panel": {"opening": "50 mm"},
    "run": {"end_time": "60 us"},
}
CONE = {"projectile": {"shape": "cone", "half_angle": "40 deg", "tip_radius": "0.4 mm"}}
CHISEL = {"projectile": {"shape": "chisel", "flat_width": "2.4 mm", "flat_angle": "30 deg"}}
CUBE = {
    "shape": "stl",
    "stl": str(ROOT / "examples/cube.stl"),
    "stl_unit": "mm",
    "mass": "0.8 g",
    "diameter": None,
}
STL = {"projectile": CUBE | {"edge_radius": "0.5 mm"}}
DENSE = {
    "projectile": CUBE | {"mass": None, "density": "8 g/cm^3", "edge_radius": "2 mm"},
    "panel": {"opening": "1 m"},
}
PACK = {"panel": {"plies": 2}}
LAW = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
OWN_LAW, PLIES = {"fabric": {"law": LAW}}, {"panel": {"ply": [{"law": LAW}, {}]}}
DRAWN = {"panel": {"strength": {"weibull_shape": 14.3}}}
DAMAGE = {"fabric": {"weaving_damage": {"source": "made up"}}}
GRIP, PULL = (
    {"clamp_force": "10 N"},
    {"pull_in": "1 mm", "start": "1 us", "end": "40 us", "zone": "50 mm"},
)


def of_laws(value, *names, before=("",)):
    """What both laws, of warp and weft, hold under a name."""
    return {f"{first}laws.{k}.{name}": value for first in before for k in (0, 1) for name in names}


def of_sides(key, value, field, found):
    """Rows of a key of a side that slips: of warp, of weft, and of both where it stands in panel.boundary itself."""
    for side, held in (("", (0, 1)), (".warp", (0,)), (".weft", (1,))):
        first = table_of(f"panel.boundary{side}", GRIP if key == "clamp_force" else PULL)
        yield (
            f"panel.boundary{side}.{key}",
            (first, value, {f"edge.{k}.{field}": found for k in held}),
        )


OF_PLY = "", "lay_up.0."
# key -> (what else the scene says, value, {field of the set-up: what it then holds}), where it is not that a field of
# the same name holds the value in SI units; a name that ends with a point stands for all that is within
ROWS = {
    "fabric.name": (
        {},
        "S-728",
        {"fabric.name": "S-728", "laws.0.a": 4.4e-5, "fabric.": ..., "laws.": ...},
    ),
    "fabric.file": (
        {"fabric": {"name": None, "file": "fabrics/catalogue/S-720.toml"}},
        "fabrics/catalogue/S-731.toml",
        {"fabric.name": "S-731", "laws.0.a": 4.6e-5, "fabric.": ..., "laws.": ...},
    ),
    "fabric.linear_density": (
        {"fabric": {"name": "S-726"}},
        "nominal",
        {f"fabric.weave.{yarn}.linear_density": 840 / 9e6 for yarn in ("warp", "weft")},
    ),
    "fabric.weaving_damage.modulus": (
        DAMAGE,
        0.9,
        {"fabric.weave.warp.E": 0.9 * 96e9, "fabric.weave.weft.E": 0.9 * 96e9, "fabric.": ...},
    ),
    "fabric.weaving_damage.strength": (
        DAMAGE,
        0.8,
        {f"fabric.weave.{yarn}.failure_strain": 0.8 * 0.03 for yarn in ("warp", "weft")}
        | {"fabric.": ...},
    ),
    "fabric.weaving_damage.source": (DAMAGE, "tests", {"fabric.": ...}),
    "fabric.weaving_damage.status": (DAMAGE, "measured", {"fabric.": ...}),
    "fabric.law": (
        {},
        LAW,
        of_laws(4e-5, "a") | of_laws(5e-5, "b") | of_laws("given in the scene", "provenance"),
    ),
    "fabric.law.a": (OWN_LAW, "0.03 mm", of_laws(3e-5, "a")),
    "fabric.law.b": (OWN_LAW, "0.06 mm N^(1/3)", of_laws(6e-5, "b")),
    "fabric.law.form": (OWN_LAW, "printed", of_laws("printed", "form")),
    "fabric.cell_model": (
        {"fabric": {"cell_model": "incompressible"}},
        "decoupled",
        {"cell_model": "decoupled"},
    ),
    "fabric.cell_formulation": ({}, "equilibrium", {"form": "equilibrium"}),
    "fabric.crossover_gap": ({}, "0.01 mm", {"gap": 1e-5}),
    "fabric.surface": ({}, SURFACE, {"surface.fabric": "S-720", "surface.": ...}),
    "projectile.name": (
        {"projectile": {"name": "FSP 1.10 g", "mass": None, "diameter": None, "edge_radius": None}},
        "FSP 2.79 g",
        {"projectile.mass": 2.79e-3, "projectile.radius": 3.745e-3, "projectile.": ...},
    ),
    "projectile.diameter": ({}, "6 mm", {"projectile.radius": 3e-3}),
    "projectile.strike_velocity": ({}, "92.5 m/s", {"strike_velocity": 92.5}),
    "projectile.shape": ({}, "hemisphere", {"projectile.shape": "hemisphere"}),
    "projectile.half_angle": (CONE, "45 deg", {"projectile.half_angle": pi / 4}),
    "projectile.tip_radius": (CONE, "0.5 mm", {"projectile.tip_radius": 5e-4}),
    "projectile.flat_width": (CHISEL, "2.5 mm", {"projectile.flat_width": 2.5e-3}),
    "projectile.flat_angle": (CHISEL, "35 deg", {"projectile.flat_angle": radians(35)}),
    "projectile.stl": (
        STL,
        str(Path(__file__).with_name("pyramid.stl")),
        {"projectile.length": 4e-3, "projectile.radius": 18**0.5 * 1e-3, "projectile.solid.": ...},
    ),
    "projectile.stl_unit": (
        DENSE,
        "cm",
        {
            "projectile.mass": 8e3 * 0.052**3,
            "projectile.length": 0.052,
            "projectile.radius": 0.052 * 0.5**0.5,
            "projectile.solid.": ...,
        },
    ),
    "projectile.density": (DENSE, "4 g/cm^3", {"projectile.mass": 4e3 * 0.0052**3}),
    "projectile.bore_diameter": (
        {"projectile": {"body": "elastic_bar"}},
        "4.5 mm",
        {"projectile.bore_diameter": 4.5e-3},
    ),
    "panel.opening_shape": ({}, "round", {"round": True}),
    "panel.boundary": ({}, "free", {"edge": "free"}),
    "panel.boundary.warp": (table_of("panel.boundary", {}), "free", {"edge": ("free", "clamped")}),
    "panel.boundary.weft": (table_of("panel.boundary", {}), "free", {"edge": ("clamped", "free")}),
    "panel.stacking": (PACK, "alternating", {"stacking": "alternating"}),
    "panel.ply_gap": (PACK, "0.1 mm", {"ply_gap": 1e-4}),
    "panel.ply_friction": (PACK, 0.2, {"ply_friction": 0.2}),
    "panel.ply_contact": (
        PACK,
        "pressure_law",
        {"fabric.ply_contact.status": "fitted", "fabric.ply_contact.": ...},
    ),
    "panel.yarn_failure": ({}, False, {"failure": False, "fabric.assumed": ()}),
    "panel.strength.weibull_shape": (DRAWN, 7.0, {"strength.weibull_shape": 7.0}),
    "panel.strength.seed": (DRAWN, 3, {"strength.seed": 3}),
    "panel.strength.gauge_length": (DRAWN, "50 mm", {"strength.gauge_length": 0.05}),
    "panel.rate_dependence": ({}, True, {"rate_dependence": True, "fabric.": ...}),
    "panel.nose_bending": ({}, True, {"nose_bending": True, "fabric.": ...}),
    "panel.grading": ({}, [[9, "1/2"], [inf, 2]], {"grading": ((9.0, 0.5), (inf, 2.0))}),
    **dict(of_sides("clamp_force", "20 N", "force", 20.0)),
    **dict(of_sides("pull_in", "2 mm", "length", 2e-3)),
    **dict(of_sides("start", "10 us", "start", 1e-5)),
    **dict(of_sides("end", "50 us", "end", 5e-5)),
    **dict(of_sides("zone", "30 mm", "zone", 3e-2)),
    "panel.ply.name": (
        PLIES,
        "S-728",
        {
            "fabric.name": "S-728",
            "lay_up.0.fabric.name": "S-728",
            "fabric.": ...,
            "lay_up.0.fabric.": ...,
        },
    ),
    "panel.ply.file": (
        {"panel": {"ply": [{"file": "fabrics/catalogue/S-720.toml"}, {}]}},
        "fabrics/catalogue/S-731.toml",
        {
            "lay_up.0.fabric.name": "S-731",
            "lay_up.0.laws.0.a": 4.6e-5,
            "lay_up.0.": ...,
            "fabric.": ...,
            "laws.": ...,
        },
    ),
    "panel.ply.law": (PLIES, LAW | {"a": "0.03 mm"}, of_laws(3e-5, "a", before=OF_PLY)),
    "panel.ply.law.a": (PLIES, "0.03 mm", of_laws(3e-5, "a", before=OF_PLY)),
    "panel.ply.law.b": (PLIES, "0.06 mm N^(1/3)", of_laws(6e-5, "b", before=OF_PLY)),
    "panel.ply.law.form": (PLIES, "printed", of_laws("printed", "form", before=OF_PLY)),
    "panel.ply.angle": (PLIES, "90 deg", {"lay_up.0.angle": pi / 2}),
    "panel.ply.gap": (PLIES, "0.2 mm", {"lay_up.0.gap": 2e-4}),
    "panel.ply.count": (PLIES, 3, {"plies": 4, "lay_up.": ...}),
    "backing.material": (
        {},
        "gelatine 10 %",
        {"backing.name": "gelatine 10 %", "backing.material.": ...},
    ),
}
# values of keys whose example is their default
OTHERS = {
    "title": "mine",
    "run.outputs": ["report"],
    "history.interval": "2 us",
    "run.snapshot_interval": "20 us",
    "backing.size": ["200 mm", "300 mm", "100 mm"],
    "backing.modulus": "90 MPa",
    "backing.density": "2 g/cm^3",
    "backing.yield_stress": "10 MPa",
    "backing.hardening": "1 MPa",
    "backing.reference_rate": "2 / s",
    "backing.min_size": "2 mm",
    "backing.refined_depth": "9 mm",
}
OF_BACKING = {
    "modulus",
    "density",
    "poisson",
    "yield_stress",
    "hardening",
    "erosion_strain",
    "rate_exponent",
}
OF_BACKING |= {"reference_rate"}  # which its material holds
# what the set-up of the solver does not hold: the checked scene does
OF_THE_RUN = {
    "title",
    "history.report_positions",
    "run.checkpoint_interval",
    "run.outputs",
}
ENTRIES = schema.entries(Scene)


def row(key):
    """What else the scene says, the value, and what the set-up then holds."""
    if key in ROWS:
        return ROWS[key]
    value = OTHERS.get(key) or ENTRIES[key].examples[0]
    table, _, name = key.rpartition(".")
    where = {
        "fabric": "",
        "panel": "",
        "run": "",
        "backing": "backing.material." if name in OF_BACKING else "backing.",
    }
    return {}, value, {where.get(table, f"{table}.") + name: in_si(key, value)}


def in_si(key, value):
    """A value as it stands in a file, in SI units."""
    if isinstance(value, list):
        return tuple(in_si(key, part) for part in value)
    unit = schema.unit_of(ENTRIES[key])
    return value if unit is None else si(value, "" if unit == "1" else unit)


def fields_of(thing, name=""):
    """{path: value} of a set-up, through the objects and the tuples of objects that it holds."""
    if is_dataclass(thing):
        parts = {field.name: getattr(thing, field.name) for field in fields(thing) if field.compare}
    elif isinstance(thing, tuple) and any(map(is_dataclass, thing)):
        parts = dict(enumerate(thing))
    else:
        return {name: thing}
    found = {}
    for key, value in parts.items():
        found |= fields_of(value, f"{name}.{key}".lstrip("."))
    return found


def setup_of(table):
    """The fields of the set-up of `weavecell impact`."""
    return fields_of(build.setup(build.build(check(table, None, honoured.IMPACT), None, "s"), None))


def with_value(table, key, value):
    """A scene with a value of a key; of [[panel.ply]] that of its first table."""
    name = key.removeprefix("panel.ply.")
    if name == key:
        return merged(table, table_of(key, value))
    first, *others = table["panel"]["ply"]
    return merged(table, {"panel": {"ply": [merged(first, table_of(name, value)), *others]}})


@pytest.mark.parametrize(
    "key", [key for key in ENTRIES if key not in OF_THE_RUN and not key.startswith("accuracy.")]
)
def test_a_key_sets_its_field_and_no_other(key, monkeypatch):
    """Fields that change are those named, and hold what is named; the unit of the value is that of the schema."""
    monkeypatch.chdir(ROOT)
    context, value, expected = row(key)
    table = key.partition(".")[0]
    base = merged(merged(SHOT, {table: {}}), context)
    plain, made = setup_of(base), setup_of(with_value(base, key, value))
    changed = {
        path: new
        for path, new in made.items()
        if path not in plain or not np.array_equal(plain[path], new)
    }
    assert changed
    within = tuple(path for path in expected if path.endswith("."))
    named = {path: found for path, found in expected.items() if path not in within}
    assert {path: changed.get(path) for path in named} == {
        path: about(found) for path, found in named.items()
    }
    assert [path for path in changed if path not in named and not path.startswith(within)] == []


def about(value):
    """A number within the rounding of an STL file, which is of single precision; all else exactly."""
    return pytest.approx(value, rel=3e-7) if isinstance(value, float) else value


@pytest.mark.parametrize(
    "key", [key for key in ENTRIES if key in OF_THE_RUN or key.startswith("accuracy.")]
)
def test_a_key_that_the_run_reads_stands_in_the_scene(key):
    _, value, _ = row(key)
    assert attrgetter(key)(check(with_value(SHOT, key, value), None)) == in_si(key, value)


@pytest.mark.parametrize("name", ["IMPACT", "LIMITS", "V50", "SWEEP", "COUPON"])
def test_what_is_not_honoured_are_keys(name):
    """One that is declared in vain would be honoured in silence."""
    model = CouponScene if name == "COUPON" else Scene
    assert set(getattr(honoured, name)) <= {
        part for key in schema.entries(model) for part in honoured.with_tables(key)
    }


def test_what_is_set_is_found():
    """Tables without a key, and keys at their default, count as not set."""
    changes = {
        "panel": {"boundary": {"warp": [GRIP, "clamped"]}, "plies": 1},
        "history": {},
        "numerics": {},
    }
    found = set(schema.changed(check(merged(SHOT, changes), None)))
    assert {"panel.boundary.warp.clamp_force", "history"} <= found
    assert not {"panel.plies", "numerics", "fabric", "run.snapshot_interval"} & found


def test_keys_of_fabric_reach_the_cell_of_a_coupon():
    table = FabricTable.model_validate(
        {
            "cell_model": "incompressible",
            "crossover_gap": "0.01 mm",
        }
    )
    fabric = catalogue.load("S-720")
    cell = CellModel(fabric, fabric.laws, *build.cell_of(table))
    assert (cell.model, cell.form) == ("incompressible", "variational")
    assert cell.gap == pytest.approx(1e-5)


def test_keys_of_a_pull_out_reach_its_model(monkeypatch):
    monkeypatch.setattr("shellfabric.coupon.pull_out.PullOut", lambda **values: values)
    monkeypatch.setattr(
        "shellfabric.coupon.pull_out.follow", lambda *values, samples: (*values, samples)
    )
    given = {
        "crossings": 10,
        "displacement": "5 mm",
        "pre_tension": "7 N",
        "crossover_friction": 0.3,
        "crossover_cohesion": "0.1 N",
        "samples": 100,
    }
    inputs = PullOutTable.model_validate(given)
    assert set(inputs.model_fields_set) == set(PullOutTable.model_fields)
    model, displacement, samples = results.run_pull_out("cell", inputs, bending=1e-6)
    assert model == {
        "table": "cell",
        "crossings": 10,
        "pre_tension": 7.0,
        "mu": 0.3,
        "cohesion": 0.1,
        "bending": (1e-6, 1e-6),
    }
    assert (displacement, samples) == (pytest.approx(5e-3), 100)
