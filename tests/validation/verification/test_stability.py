"""Stability maps: the default is in the stable region, and outside it a guard ends the run or the answer is wrong."""

import pytest

from fabrics.errors import UnstableError
from validation.verification.stability import core, shots, study
from validation.verification.stability.core import FAILED, STABLE, WRONG


def failed(outcome, text):
    """Whether a guard has stopped a point and said why, where and when."""
    return outcome.kind == FAILED and text in outcome.message and ", at " in outcome.message


def test_beyond_the_largest_step():
    assert study.solve("plies", 1.4, "smooth").kind != STABLE
    outcome = study.solve("time-step", 2.0, "S-720, default")
    assert failed(outcome, "a node moves at") or failed(outcome, "the energy balance is off by")
    with pytest.raises(UnstableError) as caught:
        shots.step(cfl=2.0, straight=True, failure=False)
    assert caught.value.exit_code == 3


@pytest.mark.parametrize("cloth", study.load("time-step").y.values)
def test_the_default_step_has_a_margin_on_every_cloth(cloth):
    """One and a half of the default is stable: of the equilibrium form, of taut cloth and of one that rings too."""
    assert study.solve("time-step", core.MARGIN_TARGET * shots.Numerics.cfl, cloth).kind == STABLE


def test_the_step_leaves_the_contact_as_it_is():
    """Half the step has the same contact: peaks stay within 1 %, where one four times as stiff moves them by more."""
    usual, half = (shots.step(cfl=cfl, failure=False) for cfl in (0.9, 0.45))
    assert half.off(usual) < 0.01
    assert shots.fire(failure=False, cfl=0.45).off(shots.fire(failure=False)) > 0.01


# (map, x, y, kind of the outcome, part of its message)
POINTS = (
    ("time-step", 0.9, "S-720, default", STABLE, ""),
    ("viscosity", 0.1, 92.5, STABLE, ""),
    ("viscosity", 0.0, 92.5, WRONG, ""),  # it rings, which nothing but a comparison shows
    ("penalty", 0.6, 0.5, STABLE, ""),
    ("penalty", 4.0, 0.5, FAILED, "the contact has given"),  # else it ends quietly, its peaks 65 % too high
    ("plies", 0.2, "smooth", STABLE, ""),
    ("plies", 0.2, "nodes", WRONG, ""),
    ("edge-radius", 0.3e-3, "1 element per crossover", STABLE, ""),
    ("edge-radius", 0.3e-3, "1/4 element per crossover", STABLE, ""),
    ("printed-law", 0.0, 0.0, WRONG, "where there is none"),
    ("printed-law", 20e-6, 20e-6, STABLE, ""),
    ("load-step", 0.1, "warp only", STABLE, ""),
    ("load-step", 1.0, "warp only", FAILED, "the crossover found no equilibrium: no convergence"),
    ("newton", 16e-6, 16e-6, STABLE, ""),
    ("newton", -10e-6, -10e-6, WRONG, ""),  # a root of negative force
    ("bars", 44, "2 x 2 x 2 points", STABLE, ""),
    ("bias", 1.0, "locking at 7°, as published", STABLE, ""),
    ("bias", 0.0, "locking at 7°, as published", FAILED, "the shear has run into bands"),
)
NEEDED = {"load-step": "dolfinx", "bars": "dolfinx"}


@pytest.mark.parametrize(("key", "x", "y", "kind", "message"), POINTS)
def test_a_point_of_each_map(key, x, y, kind, message):
    pytest.importorskip(NEEDED.get(key, "numpy"))
    outcome = study.solve(key, x, y)
    assert outcome.kind == kind
    assert message in outcome.message
    assert kind != FAILED or failed(outcome, message)


@pytest.mark.parametrize("heights", [(16e-6, 16e-6), (-10e-6, -10e-6), (0.0, 0.0), (10e-6, -10e-6), (-4e-6, 8e-6)])
def test_the_bracket_finds_every_crossover(heights):
    assert study.solve("newton", 0.0, 0.0).kind == FAILED  # it divides by nothing
    outcome = study.solve("bracket", *heights)
    assert outcome.kind == STABLE
    assert outcome.value < 30
