"""No key is passed over: under each model of yarns, of metal and of several plies one that is set is refused by
its name, or the shot has other bits."""

import hashlib
from dataclasses import fields, is_dataclass, replace
from math import inf

import numpy as np
import pytest

from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_reach import ENTRIES, ROOT, row, with_value
from weavecell.scenes import build
from weavecell.scenes.impact import check

# yarns break within the run, so that keys of failure matter
SHOT = {
    "fabric": {"name": "S-726"},
    "projectile": {
        "mass": "0.69 g",
        "diameter": "5 mm",
        "edge_radius": "0.2 mm",
        "strike_velocity": "300 m/s",
    },
    "panel": {"opening": "26 mm", "symmetry": "whole", "impact_point": ["0.2 mm", "0.3 mm"]},
    "run": {"end_time": "10 us"},
}
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
MODELS = {
    "pinned": {},
    "yarns": {"panel": {"crossovers": "yarns", "zone": "8 mm"}},
    "metal": {"projectile": BULLET, "run": {"end_time": "4 us"}},
    "pack": {"panel": {"plies": 2}, "run": {"end_time": "4 us"}},
}
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
    "panel.opening": ({}, "30 mm"),
    "panel.impact_point": ({}, ["1 mm", "0 mm"]),
    "panel.symmetry": ({"panel": {"impact_point": ["0 mm", "0 mm"]}}, "half"),
}
TABLES = ("fabric", "projectile", "panel", "numerics")
# a body from a file costs seconds, plies and sides have tables of their own, a preset is a set of other
# keys, and the zone of this walk is the whole panel
LEFT_OUT = (
    "panel.ply.",
    "panel.boundary.",
    "panel.preset",
    "panel.zone",
    "fabric.surface",
    "projectile.stl",
    "projectile.density",
)
# where the numbers come from; threads, by which no result depends; and the rear end of the projectile,
# which nothing touches in so short a run
NO_BITS = (
    "fabric.weaving_damage.source",
    "fabric.weaving_damage.status",
    "numerics.threads",
    "projectile.length",
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
}
# what shots of 10 us show of one ply, and shorter ones do not
LATER = ("numerics.erosion_gap",)
KEYS = [
    key
    for key in ENTRIES
    if key.partition(".")[0] in TABLES and not key.startswith(LEFT_OUT) and key not in NO_BITS
]
PAIRS = [
    (model, key)
    for model in MODELS
    for key in KEYS
    if (model, key) not in CHOSEN and (model in ("pinned", "yarns") or key not in LATER)
]


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


def bits(scene):
    """Digest of a shot; the error of one that is refused."""
    try:
        setup = build.setup(build.build(check(scene, None, "shot"), None, "s"), None)
        # a coarse table of the cell, and one audit, tell two shots apart as well
        setup = replace(setup, table_size=31, audit_interval=setup.end_time)
        # over the whole panel: no membrane beyond it reads the key
        if setup.crossovers is not None:
            setup = replace(setup, crossovers=replace(setup.crossovers, half_width=inf))
        result = run_impact(setup)
    except InputError as problem:
        return problem
    found = hashlib.sha256()
    walk(result, "", found)
    return found.hexdigest()


@pytest.fixture(scope="module")
def known():
    """{scene as text: its digest} of the shots without the keys."""
    return {}


@pytest.mark.parametrize("model, key", PAIRS)
def test_a_key_is_refused_or_changes_the_shot(model, key, known, monkeypatch):
    """A shot that the model refuses for what else the scene says tells nothing, and of pinned yarns there is none."""
    monkeypatch.chdir(ROOT)
    context, value = OTHERWISE.get(key) or row(key)[:2]
    base = merged(merged(SHOT, MODELS[model]), context)
    if str(base) not in known:
        known[str(base)] = bits(base)
    without = known[str(base)]
    if isinstance(without, InputError):
        assert model != "pinned", without
        return
    found = bits(with_value(base, key, value))
    assert found != without
    if isinstance(found, InputError):
        wanted = NAMED.get((model, key))
        if wanted is None:
            assert found.key.rpartition(".")[2] in key.split("."), found
        else:
            assert found.key.rpartition(".")[2] == wanted, found
