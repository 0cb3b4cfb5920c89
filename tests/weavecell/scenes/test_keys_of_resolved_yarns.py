"""No key is passed over by resolved yarns: one that changes a shot at pinned yarns changes that at
resolved yarns too, or is refused there."""

import hashlib

import numpy as np
import pytest

from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_reach import ENTRIES, row, with_value
from weavecell.scenes import build, honoured
from weavecell.scenes.impact import check

# yarns break within the run, so that keys of failure matter
PINNED = {
    "fabric": {"name": "S-726"},
    "projectile": {
        "mass": "0.69 g",
        "diameter": "5.56 mm",
        "edge_radius": "0.5 mm",
        "strike_velocity": "300 m/s",
    },
    "panel": {"opening": "40 mm", "symmetry": "whole", "impact_point": ["0.2 mm", "0.3 mm"]},
    "run": {"end_time": "10 us"},
}
RESOLVED = {"panel": {"crossovers": "yarns", "zone": "8 mm"}}
# what else the scene says, and the value, where those of `row` would be refused for another reason
HEAVY = {"projectile": {"mass": "3 g"}}
OTHERWISE = {
    "projectile.body": (HEAVY, "elastic_bar"),
    "projectile.bore_diameter": (merged(HEAVY, {"projectile": {"body": "elastic_bar"}}), "4.5 mm"),
    "projectile.azimuth": ({"projectile": {"obliquity": "20 deg"}}, "90 deg"),
    "projectile.roll": (
        {"projectile": {"shape": "chisel", "flat_width": "2.5 mm", "flat_angle": "35 deg"}},
        "45 deg",
    ),
    "panel.impact_point": ({}, ["1 mm", "0 mm"]),
}
TABLES = ("fabric", "projectile", "panel", "numerics")
# a body from a file costs seconds, plies and sides have tables of their own, and pinned yarns have
# none of the keys of the zone
LEFT_OUT = ("panel.ply.", "panel.boundary.", "fabric.surface", "projectile.stl")
OF_THE_ZONE = ("panel.crossovers", "panel.zone", "panel.aim_seed", "panel.crossover_friction")
KEYS = [
    key
    for key in ENTRIES
    if key.partition(".")[0] in TABLES
    and not key.startswith(LEFT_OUT)
    and key not in (*OF_THE_ZONE, "projectile.density")
]


def bits(scene):
    """Digest of the steps of a shot; the error of one that is refused."""
    try:
        setup = build.setup(build.build(check(scene, None, honoured.IMPACT), None, "s"), None)
        result = run_impact(setup)
    except InputError as problem:
        return problem
    return hashlib.sha256(np.ascontiguousarray(result.step_history)).hexdigest()


@pytest.fixture(scope="module")
def known():
    """{scene as text: its digest} of the shots without the keys."""
    return {}


@pytest.mark.parametrize("key", KEYS)
def test_a_key_that_matters_to_pinned_yarns_is_not_passed_over(key, known):
    if key in OTHERWISE:
        context, value = OTHERWISE[key]
    else:
        context, value, _, _ = row(key)

    def pair(scene):
        """Digests without and with the key."""
        base = merged(scene, context)
        if str(base) not in known:
            known[str(base)] = bits(base)
        return known[str(base)], bits(with_value(base, key, value))

    without, with_key = pair(merged(PINNED, RESOLVED))
    if isinstance(with_key, InputError) or with_key != without:
        return
    without, with_key = pair(PINNED)
    assert with_key == without, f"{key} is passed over by resolved yarns"
