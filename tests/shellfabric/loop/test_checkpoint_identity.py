"""A checkpoint belongs to a run whose steps and records are its own: each thing that these follow from tells it from
a run with another."""

from dataclasses import replace
from functools import cache

import pytest

from fabrics import backings, catalogue
from fabrics.base import run_cache
from shellfabric.block.block import Backing
from shellfabric.impact.run import _make_solver, check_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.impact.strengths import YarnStrength
from shellfabric.loop.histories import HistoryRequest
from shellfabric.membrane.boundary import Grip
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import PlyContact
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone

FABRIC = catalogue.load("S-726")
SPHERE = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere", friction=0.1)
CLAY = backings.load("Roma Plastilina No. 1")
PACK = ImpactSetup(
    FABRIC,
    120.0,
    projectile=SPHERE,
    opening=0.02,
    symmetry="whole",
    elements_per_crossover=1,
    boundary=Grip(20.0),
    plies=2,
    table_size=21,
    history=HistoryRequest(),
    strength=YarnStrength(20.0),
    numerics=Numerics(threads=1),
)
ZONE = replace(
    PACK,
    opening=0.04,
    elements_per_crossover=None,
    boundary="clamped",
    plies=1,
    strength=None,
    history=None,
    crossovers=YarnZone(8e-3, 0.2),
)
BLOCK = replace(
    PACK,
    plies=1,
    symmetry="quarter",
    strength=None,
    history=None,
    backing=Backing(
        CLAY,
        size=(0.04, 0.04, 0.02),
        min_size=2.5e-3,
        refined_depth=5e-3,
        growth=1.5,
        after_stop=1e-4,
    ),
)
BASES = {"pack": PACK, "zone": ZONE, "block": BLOCK}


def with_part(part, **changes):
    """A change of an object that a set-up holds."""
    return lambda setup: {part: replace(getattr(setup, part), **changes)}


# what changes: of which set-up, and to what
CHANGES = {
    "strike velocity": ("pack", {"strike_velocity": 121.0}),
    "samples": ("pack", {"audit_interval": 3e-6, "history": HistoryRequest(3e-6)}),
    "recorded yarns": ("pack", {"history": HistoryRequest(warp=(0.0, 2e-3))}),
    "strength of yarns": ("pack", {"fabric": FABRIC.with_yarns(failure_strain=[0.03, 0.04])}),
    "law of yarns": ("pack", {"laws": catalogue.load("S-728").laws}),
    "gap of the cell": ("pack", {"crossover_gap": 1e-6}),
    "drawn strengths": ("pack", {"strength": YarnStrength(20.0, 2)}),
    "mass": ("pack", with_part("projectile", mass=0.7e-3)),
    "friction of the nose": ("pack", with_part("projectile", friction=0.2)),
    "place": ("pack", {"impact_point": (1e-3, 0.0)}),
    "clamps": ("pack", {"boundary": Grip(21.0)}),
    "bending": ("pack", {"bending": 1e-7}),
    "packed area": ("pack", {"packed_area": 0.4}),
    "failure": ("pack", {"yarn_failure": False, "strength": None}),
    "viscosity": ("pack", with_part("numerics", stretch_viscosity=0.06)),
    "stacking": ("pack", {"stacking": "alternating"}),
    "gap of plies": ("pack", {"ply_gap": 31e-6}),
    "friction of plies": ("pack", {"ply_friction": 0.2}),
    "contact of plies": ("pack", {"contact": PlyContact(damping=0.07)}),
    "friction of crossovers": ("zone", with_part("crossovers", friction=0.21)),
    "stiffness sideways": ("zone", with_part("crossovers", lateral=1.3)),
    "edge of yarns": ("zone", with_part("crossovers", edge=0.3)),
    "zone": ("zone", with_part("crossovers", half_width=9e-3)),
    "material of the block": (
        "block",
        with_part("backing", material=replace(CLAY, density=1500.0)),
    ),
    "time after the stop": ("block", with_part("backing", after_stop=2e-4)),
    "stiffness of its contact": ("block", with_part("backing", ply_penalty=0.11)),
}


def identity(setup):
    """The digest of what determines a run."""
    solver = _make_solver(setup, check_impact(setup))
    return run_cache.inputs_digest(solver.checkpoint_identity()[0])


@cache
def identity_of_base(name):
    return identity(BASES[name])


@pytest.mark.parametrize("name", CHANGES)
def test_what_steps_and_records_follow_from_tells_one_run_from_another(name):
    of_base, change = CHANGES[name]
    base = BASES[of_base]
    changed = replace(base, **(change(base) if callable(change) else change))
    assert identity(changed) != identity_of_base(of_base)


def test_a_longer_run_of_more_threads_goes_on_from_the_same_checkpoint():
    longer = replace(BASES["pack"], end_time=900e-6, numerics=Numerics(threads=2))
    assert identity(longer) == identity_of_base("pack")
