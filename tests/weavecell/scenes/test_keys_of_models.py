"""No key is passed over: under each model one that is set is refused by its name, with the model, or what is computed
has other bits. Models of a shot are fired, those of a patch planned, coupons relaxed."""

import hashlib
import re
from dataclasses import fields, is_dataclass, replace
from math import inf

import numpy as np
import pytest

from fabrics.base import schema
from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from tests.scene_text import merged, table_of
from tests.weavecell.scenes.test_keys_reach import ENTRIES, ROOT, row, with_value
from weavecell.api import coupons
from weavecell.results import coupon as coupon_results
from weavecell.scenes import build
from weavecell.scenes.coupon import TESTS, CouponScene
from weavecell.scenes.fabric_table import check_scene
from weavecell.scenes.impact import check

SHOT = {
    "fabric": {"name": "S-726"},
    "projectile": {
        "mass": "0.69 g",
        "diameter": "5 mm",
        "edge_radius": "0.2 mm",
        "strike_velocity": "300 m/s",
    },
    "panel": {"opening": "26 mm", "symmetry": "whole", "impact_point": ["0.2 mm", "0.3 mm"]},
    "run": {"end_time": "2 us"},
}
# within which yarns break, where a shorter run shows nothing of a key
LONGER = {"run": {"end_time": "10 us"}}
BULLET = {
    "shape": "ogive",
    "nose_length": "5 mm",
    "tip_diameter": "3 mm",
    "length": "14 mm",
    "body": "metal",
    "mass": "2.68 g",
    "jacket": "brass",
    "jacket_thickness": "0.5 mm",
}
BLOCK = {
    "modulus": "100 MPa",
    "yield_stress": "0.5 MPa",
    "size": ["26 mm", "26 mm", "8 mm"],
    "min_size": "2 mm",
    "refined_depth": "4 mm",
}
MODELS = {
    "pinned": {},
    "yarns": {"panel": {"crossovers": "yarns", "zone": "8 mm"}},
    "metal": {"projectile": BULLET},
    "block": {"backing": BLOCK},
    "pack": {"panel": {"plies": 2}},
}
# refused beside pinned crossovers, which the scene of a patch has
OF_YARNS = ("panel.zone", "panel.aim_seed")
OF_BLOCKS = {"backing.": MODELS["block"]}
# what else the scene says, and the value, where those of `row` would be refused for another reason
HEAVY = {"projectile": {"mass": "2.9 g"}}
OTHERWISE = {
    "projectile.body": (HEAVY, "elastic_bar"),
    "projectile.bore_diameter": (merged(HEAVY, {"projectile": {"body": "elastic_bar"}}), "4 mm"),
    "projectile.azimuth": ({"projectile": {"obliquity": "20 deg"}}, "90 deg"),
    "projectile.roll": (
        {"projectile": {"shape": "chisel", "flat_width": "2.5 mm", "flat_angle": "35 deg"}},
        "45 deg",
    ),
    "fabric.surface": (
        {"fabric": {"name": "S-720"}},
        f"{ROOT}/tests/shellfabric/cell/data/S-720-coarse-9x9.h5",
    ),
    "panel.opening": ({}, "30 mm"),
    "panel.areal_density": ({}, "0.6 kg/m^2"),
    "panel.impact_point": ({}, ["1 mm", "0 mm"]),
    "panel.symmetry": ({"panel": {"impact_point": ["0 mm", "0 mm"]}}, "half"),
    "panel.aim_seed": ({"panel": {"impact_point": None}}, 3),
    "run.end_time": ({}, "1 us"),
    "history.interval": ({"history": {"interval": "1 us"}}, "0.5 us"),
    "history.warp": ({"history": {"interval": "1 us"}}, ["1 mm", "2 mm"]),
    "history.weft": ({"history": {"interval": "1 us"}}, ["1 mm", "2 mm"]),
    "backing.size": ({}, ["26 mm", "26 mm", "9 mm"]),
    "backing.min_size": ({}, "1.5 mm"),
    "backing.refined_depth": ({}, "6 mm"),
    "backing.erosion_strain": ({"backing": {"erosion_strain": 0.9}}, 0.01),
    "backing.rate_exponent": ({"backing": {"reference_rate": "1 / s"}}, 0.1),
    "backing.reference_rate": ({"backing": {"rate_exponent": 0.1}}, "2 / s"),
}
# a set of other keys; and of resolved yarns the zone, which is the whole panel here
LEFT_OUT = ("panel.preset", "panel.zone", "accuracy.")
# what is written and told; where numbers come from; threads, by which no result depends; and what nothing
# touches in so short a run: the rear end of the projectile, and a block after the stop (`test_coupling`)
NO_BITS = (
    "title",
    "run.checkpoint_interval",
    "run.outputs",
    "run.snapshot_interval",
    "history.report_positions",
    "fabric.weaving_damage.source",
    "panel.ply.weaving_damage.source",
    "fabric.weaving_damage.status",
    "panel.ply.weaving_damage.status",
    "numerics.threads",
    "projectile.length",
    "backing.after_stop",
)
# the model itself
CHOSEN = {
    ("yarns", "panel.crossovers"),
    ("pack", "panel.plies"),
}
# the key that the refusal names, where it is another one: of two that do not go together
NAMED = {
    ("yarns", "panel.opening_shape"): "zone",
    ("yarns", "panel.weave_angle"): "zone",
    ("yarns", "panel.stacking"): "zone",
    ("metal", "projectile.diameter"): "mass",
    ("metal", "projectile.shape"): "nose_length",
    ("metal", "panel.crossovers"): "body",
    ("yarns", "panel.ply.count"): "zone",
    ("yarns", "panel.areal_density"): "zone",
    ("pack", "panel.areal_density"): "plies",
}
# by which a refusal names its model
WORDS = {
    "pinned": "pinned",
    "yarns": "resolved|friction without",
    "metal": "metal|drawing",
    "block": "block|backing",
    "pack": "plies|pack",
    "coupon": "coupon|pull-out|quasi-static|frame",
}
KEYS = [key for key in ENTRIES if not key.startswith(LEFT_OUT) and key not in NO_BITS]
# a body from a file costs seconds: the walk of a patch has it
OF_FILES = ("projectile.stl", "projectile.density")
PAIRS = [
    (model, key)
    for model in MODELS
    for key in KEYS
    if (model, key) not in CHOSEN
    and not key.startswith(OF_FILES)
    and (model == "block" or not key.startswith("backing."))
]


def is_slow(model, key):
    """What is computed by the same code as of pinned yarns: `make test-slow`."""
    if key.startswith(("panel.boundary.warp.", "panel.boundary.weft.")):
        return model != "pinned"
    if model == "block":
        return not key.startswith(("backing.", "numerics."))
    of_projectile = key.startswith("projectile.")
    return (model == "pack" and of_projectile) or (model == "metal" and not of_projectile)


WALK = [pytest.param(*pair, marks=pytest.mark.slow if is_slow(*pair) else ()) for pair in PAIRS]


def walk(thing, name, digest):
    """Add all numbers of a result to a digest."""
    if is_dataclass(thing):
        thing = {entry.name: getattr(thing, entry.name) for entry in fields(thing)}
    if isinstance(thing, dict):
        for key, value in thing.items():
            if key not in ("setup", "target", "wall_time", "ns_per_element_step", "alone_from"):
                walk(value, f"{name}.{key}", digest)
    elif isinstance(thing, tuple | list):
        for key, value in enumerate(thing):
            walk(value, f"{name}.{key}", digest)
    elif isinstance(thing, np.ndarray | float | int | str):
        digest.update(name.encode())
        digest.update(np.asarray(thing).tobytes())


def digest_of(thing):
    found = hashlib.sha256()
    walk(thing, "", found)
    return found.hexdigest()


def fire(scene):
    """Digest of a shot."""
    setup = build.setup(build.build(check(scene, None, "shot"), None, "s"), None)
    # a coarse table of the cell, and one audit, tell two shots apart as well
    setup = replace(setup, table_size=31, audit_interval=setup.end_time)
    # over the whole panel: no membrane beyond it reads the key
    if setup.crossovers is not None:
        setup = replace(setup, crossovers=replace(setup.crossovers, half_width=inf))
    return digest_of(run_impact(setup))


def relax(scene):
    """Digest of a coupon: what it measures, and why it ended."""
    made = check_scene(CouponScene, scene, None, "coupon")
    case = build.build(made, None, "s")
    compute = coupons._pull_out if made.test == "pull_out" else coupons._relax
    result, failure = compute(case, "", None, False)
    return digest_of((result.record.columns, str(failure or "")))


@pytest.fixture(scope="module")
def answers():
    """{what, scene: digest, or the error of what is refused}"""
    return {}


@pytest.fixture
def answer(answers, monkeypatch):
    """The digest of a scene by fire, plan or relax, or the error of one that is refused."""
    monkeypatch.chdir(ROOT)

    def of(compute, scene):
        asked = compute.__name__, str(scene)
        if asked not in answers:
            try:
                answers[asked] = compute(scene)
            except InputError as problem:
                answers[asked] = problem
        return answers[asked]

    return of


def judge(found, model, key):
    """A refusal names the key, and the model if that is why."""
    last = (found.key or "").rpartition(".")[2]
    wanted = [NAMED[model, key]] if (model, key) in NAMED else key.split(".")
    assert last in wanted, found


def read_by_pinned(answer, context, key, value):
    """Whether the same key is computed of pinned yarns."""
    base = merged(SHOT, context)
    return not isinstance(answer(fire, with_value(base, key, value)), InputError)


@pytest.mark.parametrize("model, key", WALK)
def test_a_key_is_refused_or_changes_the_shot(model, key, answer):
    """A shot that the model refuses for what else the scene says tells nothing, and of pinned yarns there is none."""
    context, value = OTHERWISE.get(key) or row(key)[:2]
    base = merged(merged(SHOT, MODELS[model]), context)
    without = answer(fire, base)
    if isinstance(without, InputError):
        assert model != "pinned", without
        return
    found = answer(fire, with_value(base, key, value))
    if found == without:
        without, found = (
            answer(fire, merged(scene, LONGER)) for scene in (base, with_value(base, key, value))
        )
    assert found != without
    if isinstance(found, InputError):
        judge(found, model, key)
        if (model, key) not in NAMED and read_by_pinned(answer, context, key, value):
            assert re.search(WORDS[model], str(found)), found


COUPONS = {
    "bias_extension": {"length": "14 mm", "width": "6 mm", "elongation": "0.4 mm"},
    "picture_frame": {"shear_angle": "5 deg", "crossovers": 3},
    "uniaxial": {"direction": "warp", "length": "6 mm", "width": "4 mm", "strain": "2 %"},
    "biaxial": {"strain": ["1 %", "0.7 %"], "centre": 3, "arm": 2},
    "pull_out": {"crossings": 4, "displacement": "1 mm", "crossover_cohesion": "0.1 N"},
}
OF_COUPONS = {
    "fabric.cell_model": ({}, "incompressible"),
    "fabric.bending": ({}, "1e-6 N m^2"),
    "bias_extension.length": ({}, "16 mm"),
    "bias_extension.width": ({}, "8 mm"),
    "bias_extension.elongation": ({}, "0.3 mm"),
    "bias_extension.trellis": ({}, False),
    "picture_frame.shear_angle": ({}, "4 deg"),
    "picture_frame.crossovers": ({}, 4),
    "uniaxial.direction": ({}, "weft"),
    "uniaxial.length": ({}, "7 mm"),
    "uniaxial.width": ({}, "5 mm"),
    "uniaxial.strain": ({}, "1.5 %"),
    "uniaxial.failure": ({"uniaxial": {"strain": "9 %"}, "run": {"steps": 3}}, False),
    "biaxial.strain": ({}, ["1 %", "0.5 %"]),
    "biaxial.centre": ({}, 4),
    "biaxial.arm": ({}, 3),
    "biaxial.cross_yarns_removed": ({}, False),
    "biaxial.failure": ({"biaxial": {"strain": ["9 %", "1 %"]}, "run": {"steps": 3}}, False),
    "pull_out.crossings": ({}, 5),
    "pull_out.displacement": ({}, "0.8 mm"),
    "pull_out.pre_tension": ({}, "10 N"),
    "pull_out.crossover_friction": ({"fabric": {"bending": "1e-6 N m^2"}}, 0.3),
    "pull_out.crossover_cohesion": ({}, "0.2 N"),
    "pull_out.samples": ({}, 100),
    "run.steps": ({}, 2),
    "run.elements_per_crossover": ({}, 2),
    "run.tolerance": ({}, 1e-2),
    "run.max_iterations": ({}, 10),
}
# a frame shears all of its fabric alike: nothing is left to be relaxed
AT_ONCE = {("picture_frame", "run.tolerance"), ("picture_frame", "run.max_iterations")}
# and has yarns and a law as all fabrics do, though it stretches none
DATA = ("fabric.linear_density", "fabric.law")
OF_TESTS = [
    (test, key)
    for test in TESTS
    for key in schema.entries(CouponScene)
    if key.partition(".")[0] in ("fabric", "run", test)
    and key not in NO_BITS
    and (test, key) not in AT_ONCE
    and not (test == "picture_frame" and key.startswith(DATA))
]


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("test, key", OF_TESTS)
def test_a_key_is_refused_or_changes_the_coupon(test, key, answer, monkeypatch):
    monkeypatch.setattr(coupon_results, "TABLE_SIZE", 41)
    context, value = OF_COUPONS.get(key) or OTHERWISE.get(key) or row(key)[:2]
    base = {"fabric": {"name": "S-720"}, test: COUPONS[test]}
    if test != "pull_out":
        base["run"] = {"steps": 1}
    base = merged(base, context)
    without = answer(relax, base)
    if isinstance(without, InputError):
        assert re.search(WORDS["coupon"], str(without)), without
        return
    found = answer(relax, merged(base, table_of(key, value)))
    assert found != without
    if isinstance(found, InputError):
        judge(found, test, key)
        assert re.search(WORDS["coupon"], str(found)), found


@pytest.mark.parametrize("key", [{"zone": "8 mm"}, {"crossover_friction": 0.1, "aim_seed": 4}])
@pytest.mark.parametrize("plies", [1, 2, 5])
def test_a_key_of_the_zone_asks_for_resolved_yarns(key, plies):
    """Whatever the number of plies resolves by itself; beside pinned crossovers it is refused."""
    given = {"fabric": {"name": "S-728"}, "panel": {"opening": "40 mm", "plies": plies} | key}
    given["projectile"] = {"name": "FSP 1.10 g", "strike_velocity": "90 m/s"}
    made = build.setup(build.build(check(given, None), None, "shot"), None)
    assert made.crossovers is not None
    assert made.instead is None
    given["panel"]["crossovers"] = "pinned"
    with pytest.raises(InputError, match="left out where crossovers are pinned"):
        check(given, None)
