"""Stability maps: edges on made-up methods; of each real one, that its guard speaks outside and the default is in."""

import pytest

from fabrics.errors import UnstableError
from validation.verification.stability import core, shots, study
from validation.verification.stability.core import ABOVE, BELOW, FAILED, STABLE, WRONG, Axis, Map, Outcome


def made_up(**changes):
    """A method that is wrong below 0.1, fails above 3, and has its default at 1."""

    def point(x, y):
        def run():
            if x > 3:
                raise UnstableError("it broke", where="everywhere", when="at once")
            return Outcome(STABLE if x >= 0.1 else WRONG, x)

        return core.guarded(run)

    given = {
        "x": Axis("x", (0.0, 0.05, 0.5, 1.0, 2.0, 8.0)), "y": Axis("y", ("only",)), "point": point,
        "default": (1.0, "only"), "sides": (ABOVE, BELOW),
    }  # fmt: skip
    return Map("made", "Made up", "", **(given | changes))


def explored(chart, halvings=8):
    return core.explore(chart, lambda points: [chart.point(*point) for point in points], halvings)


def test_edges_are_found_and_margins_are_ratios():
    found = explored(made_up())
    above, below = found.edges
    assert above.value == pytest.approx(3, rel=0.01)
    assert above.margin == pytest.approx(3, rel=0.01)
    assert above.beyond.kind == FAILED
    assert above.beyond.message == "it broke, at everywhere, at once"
    assert below.value == pytest.approx(0.1, rel=0.01)
    assert below.margin == pytest.approx(10, rel=0.01)
    assert found.count(WRONG) == 2
    assert above.enough


def test_a_default_near_the_edge_and_one_outside_are_reported():
    near = explored(made_up(default=(2.5, "only"), x=Axis("x", (1.0, 2.5, 8.0)), sides=(ABOVE,))).edges[0]
    assert near.margin == pytest.approx(1.2, rel=0.01)
    assert not near.enough
    outside = explored(made_up(default=(8.0, "only"), sides=(ABOVE,))).edges[0]
    assert outside.margin == 1.0
    assert not outside.enough


def test_an_edge_that_is_not_met_is_at_least_the_end_of_the_axis():
    edge = explored(made_up(x=Axis("x", (1.0, 2.0)), sides=(ABOVE,))).edges[0]
    assert not edge.met
    assert edge.margin == 2.0


# the maps, with the guard of each outside its stable region


def failed(outcome, text):
    """Whether a guard has stopped a point and said why, where and when."""
    return outcome.kind == FAILED and text in outcome.message and ", at " in outcome.message


def test_time_step():
    assert study.solve("time-step", 0.9, "S-720, default").kind == STABLE
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


POINTS = (
    ("viscosity", 0.1, 92.5, STABLE, ""),
    ("viscosity", 0.0, 92.5, WRONG, ""),  # it rings, which nothing but a comparison shows
    ("penalty", 0.6, 0.5, STABLE, ""),
    (
        "penalty",
        4.0,
        0.5,
        FAILED,
        "the contact has given",
    ),  # without the guard it ends quietly, its peaks 65 % too high
    ("plies", 0.2, "smooth", STABLE, ""),
    ("plies", 0.2, "nodes", WRONG, ""),
    ("edge-radius", 0.3e-3, "1 element per crossover", STABLE, ""),
    ("edge-radius", 0.3e-3, "1/4 element per crossover", WRONG, "failed segments, 0 on the finest mesh"),
    ("printed-law", 0.0, 0.0, WRONG, "where there is none"),
    ("printed-law", 20e-6, 20e-6, STABLE, ""),
    ("load-step", 0.1, "warp only", STABLE, ""),
    ("load-step", 1.0, "warp only", FAILED, "the crossover found no equilibrium: no convergence"),
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


def test_contact_between_plies_beyond_its_step():
    assert study.solve("plies", 1.4, "smooth").kind != STABLE


def test_newton_on_two_heights_and_the_bracket():
    assert study.solve("newton", 16e-6, 16e-6).kind == STABLE
    assert study.solve("newton", -10e-6, -10e-6).kind == WRONG  # a root of negative force
    assert study.solve("newton", 0.0, 0.0).kind == FAILED  # it divides by nothing
    for place in ((16e-6, 16e-6), (-10e-6, -10e-6), (0.0, 0.0), (10e-6, -10e-6), (-4e-6, 8e-6)):
        outcome = study.solve("bracket", *place)
        assert outcome.kind == STABLE
        assert outcome.value < 30


@pytest.mark.parametrize("key", study.NAMES)
def test_every_map_has_its_default_on_it(key):
    if NEEDED.get(key) == "dolfinx":
        pytest.importorskip("dolfinx")
    for quick in (False, True):
        chart = study.load(key, quick)
        assert chart.key == key
        if chart.default is not None:
            assert chart.default in chart.points
            assert chart.default[0] in chart.x.values
        assert not chart.sides or chart.default is not None


def test_defaults_in_the_file_of_maps_are_those_of_the_code():
    from shellfabric.panel.model import Numerics
    from shellfabric.plies.model import PlyContact

    contact = [Numerics.penalty, Numerics.contact_damping]
    assert study.MAPS["time-step"]["default"][0] == Numerics.cfl
    assert study.MAPS["viscosity"]["default"] == [Numerics.stretch_viscosity, shots.VELOCITY]
    assert study.MAPS["viscosity"]["reference"] == {"x": Numerics.stretch_viscosity}
    assert study.MAPS["penalty"]["default"] == contact
    assert study.MAPS["penalty"]["reference"] == {"x": contact[0], "y": contact[1]}
    assert study.MAPS["plies"]["default"] == [PlyContact.courant, PlyContact.form]
    assert study.MAPS["plies"]["reference"] == {"x": PlyContact.courant, "y": PlyContact.form}


def test_the_default_of_the_load_step_is_that_of_the_code():
    pytest.importorskip("dolfinx")
    from unitcell3d.solver.load_stepping import Steps

    assert study.MAPS["load-step"]["default"][0] == Steps().largest
