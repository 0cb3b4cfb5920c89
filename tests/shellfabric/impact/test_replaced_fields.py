"""`dataclasses.replace` has a door: every field of every set-up refuses, by its name, what its annotation or its key
does not allow, before anything is computed."""

from dataclasses import fields, replace
from math import inf, nan
from types import UnionType
from typing import Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base import fields as of_fields
from fabrics.base.assumed_number import Assumed
from fabrics.base.errors import InputError
from fabrics.materials import load
from shellfabric.block.block import Backing
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.impact.strengths import YarnStrength
from shellfabric.loop.histories import HistoryRequest
from shellfabric.membrane.boundary import Grip, PullIn
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.numerics import PlyContact
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone

S720 = catalogue.load("S-720")
SETUPS = (
    ImpactSetup(S720, 92.5),
    Ply(S720),
    Projectile(),
    Projectile(
        shape="ogive", nose_length=6e-3, tip_diameter=2e-3, length=20e-3, body="metal", mass=5e-3
    ),
    Projectile(shape="cone", half_angle=0.7, tip_radius=0.5e-3),
    Projectile(shape="chisel", flat_width=2.5e-3, flat_angle=0.6),
    YarnZone(),
    YarnStrength(14.3),
    HistoryRequest(),
    Numerics(),
    PlyContact(),
    Backing(),
    load("backing"),
    PullIn(5e-3, 2e-4, 6e-4),
    Grip(20.0),
)
# of each kind of field five values that none may have, or more
WRONG = {
    float: ("5 mm", nan, True, [1.0], (1.0, 2.0, 3.0), {"value": 1.0}, b"1"),
    int: ("2", 2.5, nan, True, [2], -(10**6)),
    bool: ("yes", 1, 0.0, [], "false"),
    str: (5, b"text", ("quarter",), True, nan),
    tuple: ("text", 5.0, [0.0, 0.0], True, nan, {1.0}),
    object: ("text", 5.0, ("text",), nan, [1.0], {"name": "S-720"}),
}
# any text is one, and any object
FREE = {("Projectile", "core"), ("Projectile", "jacket")}
CASES = [
    (owner, entry.name)
    for owner in SETUPS
    for entry in fields(owner)
    if entry.init and (type(owner).__name__, entry.name) not in FREE
]


def kinds(owner, name):
    """The kinds of WRONG of which a field may have none."""
    hint = of_fields._plain(get_type_hints(type(owner), include_extras=True)[name])
    parts = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    parts = [part for part in map(of_fields._plain, parts) if part is not type(None)]
    return {tuple if tuple in (part, get_origin(part)) else part for part in parts}


def wrong_values(owner, name):
    found = kinds(owner, name)
    values = [value for kind in found for value in WRONG.get(kind, WRONG[object])]
    if {float, tuple} <= found or {str, tuple} <= found:
        values = ["none", nan, True, [1.0], (1.0, 2.0, 3.0), {}, b"1", ("none", "none", "none")]
    if str in found and object not in found and len(found) > 1:
        values = [nan, 5.0, True, [1.0], b"rigid", "none", ("a", 1)]
    return values


@pytest.mark.parametrize(
    "owner, name",
    CASES,
    ids=[f"{type(owner).__name__}-{name}-{i}" for i, (owner, name) in enumerate(CASES)],
)
def test_a_field_refuses_wrong_values_by_its_name(owner, name):
    # several seeds are allowed
    values = [value for value in wrong_values(owner, name) if (name, value) != ("seed", [2])]
    assert len(values) >= 5
    for value in values:
        with pytest.raises(InputError) as caught:
            replace(owner, **{name: value})
        assert caught.value.key in (name, "zone", "crossover_friction"), value


OUT_OF_RANGE = {
    "strike_velocity": (0.0, -92.5, 9250.0, inf),
    "opening": (0.0, -0.2, 203.0, (0.2, 0.0), inf),
    "end_time": (0.0, -1e-3, 800.0, inf),
    "elements_per_crossover": (0, -1, 9),
    "bending": (-1e-9, (1e-9, -1e-9), inf),
    "table_size": (0, 1, -201),
    "audit_interval": (0.0, -1e-6, inf),
    "snapshot_interval": (0.0, -1e-6, inf),
    "ply_friction": (-0.1, 2.5, inf),
    "symmetry": ("third", "Quarter", ""),
    "weave_angle": (1.6, -1.6, inf),
    "impact_point": ((nan, 0.0), (inf, 0.0), (0.0,), (0.0, 0.0, 0.0)),
    "packed_area": (0.0, 1.5, -1.0, inf),
    "grading": (((9.0, 0.5), (5.0, 1.0)), (), ((9.0, -0.5),)),
    "boundary": ("clamp", ("clamped",) * 3, ("clamped", "held")),
    "plies": (0, -1, 101),
    "stacking": ("crossed", ""),
    "ply_gap": (-1e-4, inf),
    "cell_model": ("rigid", ""),
    "cell_formulation": ("implicit", ""),
    "crossover_gap": (-1e-5, inf),
}


@pytest.mark.parametrize("name", OUT_OF_RANGE)
def test_a_set_up_refuses_what_its_key_refuses(name):
    for value in OUT_OF_RANGE[name]:
        with pytest.raises(InputError) as caught:
            replace(SETUPS[0], **{name: value})
        assert caught.value.key == name, value


def test_what_is_allowed_is_taken():
    """Numbers of numpy, assumed ones, pairs; a fixed point of `replace`."""
    for owner in SETUPS:
        assert replace(owner) == owner
    made = replace(
        SETUPS[0],
        strike_velocity=np.float64(120.0),
        opening=(0.2, 0.3),
        plies=np.int64(2),
        bending=(1e-9, 2e-9),
        ply_friction=Assumed(0.3),
        impact_point=(0.01, 0.0),
        symmetry="whole",
    )
    assert made.plies == 2
    assert replace(YarnZone(), half_width=inf, friction=inf).whole.width == inf
    assert replace(SETUPS[7], weibull_shape=inf).weibull_shape == inf
