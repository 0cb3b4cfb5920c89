"""Fidelity on demand: what is asked, what two pilot runs say, which model is chosen, and what the check does."""

from dataclasses import replace
from math import inf, isnan
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.boundary import PullIn
from shellfabric.projectile.bar import rigid_is_enough
from shellfabric.projectile.projectile import Projectile
from weavecell.analysis.fidelity import error_database, ladder, quantities, select

FABRIC = catalogue.load("S-720").with_effective_density()
SETUP = ImpactSetup(FABRIC, 60.0, opening=0.05, end_time=40e-6, symmetry="whole")
PACK = replace(SETUP, plies=3, stacking="alternating", ply_gap=1e-4)
ONE, TWO, THREE = "1 element", "2 elements", "3 elements"
STRENGTH = tuple(yarn.strength for yarn in FABRIC.weave.yarns)


def result(outcome="stopped", speed=0.0, z=0.02, peaks=((100.0, 120.0),), strike=100.0, rigidity=None, **changes):
    """Made-up result of a shot: residual velocity [m/s], deflection [m], peak tensions of each ply [N]."""
    return SimpleNamespace(
        outcome=outcome, residual_velocity=speed, rigidity=rigidity, ply_tensions=np.array(peaks),
        step_history=np.array([[0, 0, 0, 0], [1, z, 0, 0], [2, 0.9 * z, 0, 0]]),
        setup=replace(SETUP, strike_velocity=strike, plies=len(peaks), **changes),
    )  # fmt: skip


def values(*arguments, **changes):
    return quantities.of(result(*arguments, **changes))


def book(factors, *, apart=1.0, usual=0.01, weight=0.0):
    """An error database of models with factors {model: [-]}, the same for all quantities."""
    costs = {"graded": 0.03, ONE: 0.04, TWO: 0.2, THREE: 0.5, ladder.FULL: 1.0, ladder.SCOUT: 0.02}
    models = {
        name: {"factor": factor, "apart": apart, "expected": factor, "weight": weight}
        for name, factor in factors.items()
    }
    regimes = {
        regime: {
            name: {"scenes": 9, "usual": usual, "models": models}
            for name in quantities.NAMES
            if quantities.is_defined(name, regime)
        }
        for regime in (quantities.HELD, quantities.THROUGH)
    }
    own = {regime: dict.fromkeys(quantities.NAMES, 0.0) for regime in regimes}
    return error_database.Book({name: {"cost": cost} for name, cost in costs.items()}, regimes, own, {}, {})


# --- quantities and how hard a scene is


def test_quantities_are_shares_of_the_strike_and_absent_where_undefined():
    held, through = values(speed=-0.3), values("perforated", 60.0)
    assert (held["residual_velocity"], held["absorbed_energy"], held["deflection"]) == (0, 1, 0.02)
    assert held["load"] == pytest.approx(max(100.0 / STRENGTH[0], 120.0 / STRENGTH[1]))
    assert (through["residual_velocity"], through["absorbed_energy"]) == (0.6, pytest.approx(0.64))
    assert isnan(through["deflection"])
    assert all(map(isnan, through["peak_tension"]))


def test_peaks_of_a_pack_are_the_highest_of_any_ply_by_the_fabrics_own_warp_and_weft():
    peaks = (100.0, 80.0), (85.0, 110.0), (90.0, 70.0)
    assert values(peaks=peaks, stacking="alternating")["peak_tension"] == (110.0, 85.0)
    assert values(peaks=peaks, stacking="aligned")["peak_tension"] == (100.0, 110.0)


def test_differences_and_mixed_peaks():
    one, other, through = values(z=0.0202, peaks=((90.0, 121.0),)), values(), values("perforated", 10.0)
    apart = quantities.differences(one, other)
    assert (apart["deflection"], apart["peak_tension"], apart["residual_velocity"]) == pytest.approx((0.01, 0.1, 0))
    apart = quantities.differences(through, other)
    assert isnan(apart["deflection"])
    assert apart["residual_velocity"] == 0.1
    assert quantities.mixed(one, other, 0.25)["peak_tension"] == pytest.approx((92.5, 120.75))
    assert quantities.mixed(one, through, 0.25) == one


def test_scale_of_errors():
    """A share e of the absorbed energy A moves v_r / v = sqrt(1 - A) by e A / (2 v_r / v); of a shot that is held, the
    scale is the distance of two meshes, of peaks its root; with yarns near their strength, or in doubt, none."""
    fast, slow = values("perforated", 95.0), values("perforated", 60.0)
    for name in ("absorbed_energy", "residual_velocity"):
        assert quantities.scale(name, slow, slow, 0.0) > 3 * quantities.scale(name, fast, fast, 0.0)
    moved = 0.6 - (1 - 0.64 * 1.001) ** 0.5
    assert quantities.scale("residual_velocity", slow, slow, 0.0) == pytest.approx(moved / 0.001, rel=0.01)
    near, far, fine, tense = values(z=0.0201), values(z=0.022), values(z=0.02), values(peaks=((110.0, 120.0),))
    assert quantities.scale("deflection", fine, near, 0.01) == pytest.approx(0.01 + 1 - 0.02 / 0.0201)
    assert quantities.scale("deflection", fine, far, 0.01) > 0.09
    assert quantities.scale("peak_tension", fine, tense, 0.01) == pytest.approx((0.01 + 1 - 100 / 110) ** 0.5)
    loaded = values(peaks=((0.95 * STRENGTH[0], 100.0),))
    for one, other in ((fine, fast), (loaded, fine), (fine, loaded)):
        assert isnan(quantities.scale("deflection", one, other, 0.01))


def test_bounds_of_the_survey():
    """Faster than 0.27 of what fails a lone yarn at once, about 200 m/s here, coarse meshes are no model; neither is
    one that no survey has seen."""
    fast, slow = (values("perforated", 0.9 * v, strike=v) for v in (260.0, 160.0))
    assert (quantities.hasty(fast), quantities.hasty(slow)) == (True, False)
    coarse, fine = (ladder.BY_NAME[name] for name in (ONE, TWO))
    known = book({ONE: 0.01, TWO: 0.01})
    assert max(known.bound(model, "residual_velocity", (slow, slow)) for model in (coarse, fine)) < 0.01
    assert (
        known.bound(fine, "residual_velocity", (fast, fast))
        < 0.01
        < known.bound(coarse, "residual_velocity", [fast] * 2)
    )
    assert book({}).bound(coarse, "deflection", (values(), values())) == inf
    own = error_database.load()
    assert own.cost(ladder.BY_NAME[ladder.FULL]) == 1
    assert own.bound(fine, "deflection", (values(), values())) < 0.01
    far, near = (values("perforated", speed) for speed in (95.0, 30.0))
    for model in (model for model in ladder.LADDER if model.name != ladder.FULL):
        lower, higher = (own.bound(model, "residual_velocity", (seen, seen)) for seen in (far, near))
        assert lower < higher


# --- which model


@pytest.mark.parametrize(
    ("changes", "symmetry"),
    [
        ({}, {"quarter"}),
        ({"projectile": Projectile(obliquity=0.3, azimuth=np.pi / 2)}, {"half"}),
        ({"projectile": Projectile(obliquity=0.3, azimuth=0.7)}, {"whole"}),
        ({"edge": ((PullIn(1e-3, 0.0, 1e-4), "clamped"), "clamped")}, {"half", "whole"}),
    ],
)
def test_the_simplest_symmetry(changes, symmetry):
    assert ladder.simplest(replace(SETUP, **changes), ladder.Tables()).symmetry in symmetry


@pytest.mark.parametrize(
    ("changes", "asked", "message"),
    [
        ({"opening": 0.005}, {"deflection": 0.1}, "opening"),
        ({}, {"speed": 0.1}, "speed"),
        ({}, {"deflection": 0.0}, "above 0"),
    ],
)
def test_bad_requests(changes, asked, message):
    with pytest.raises(InputError, match=message):
        select.options(replace(SETUP, **changes), asked, book=book({ONE: 0.1}))


PILOTS = {z: (values(z=0.02), values(z=z)) for z in (0.0202, 0.0208, 0.022)}
DOUBT = values(z=0.02), values("perforated", 10.0)


@pytest.mark.parametrize(
    ("factors", "usual", "share", "seen", "name"),
    [
        ((0.05, 0.02, 0.001), 0.01, 0.1, None, ONE),
        ((0.05, 0.02, 0.001), 0.01, 0.03, None, TWO),
        ((0.05, 0.02, 0.001), 0.01, 0.01, None, THREE),
        ((0.05, 0.02, 0.001), 0.01, 1e-5, None, ladder.FULL),
        ((0.5, 0.2, 0.01), 0.0, 0.008, PILOTS[0.0202], ONE),  # what two pilot runs are apart counts
        ((0.5, 0.2, 0.01), 0.0, 0.008, PILOTS[0.0208], TWO),
        ((0.5, 0.2, 0.01), 0.0, 0.008, PILOTS[0.022], THREE),
        ((0.5, 0.2, 0.01), 0.0, 0.2, DOUBT, ladder.FULL),
    ],
)
def test_the_cheapest_that_is_enough(factors, usual, share, seen, name):
    known = book(dict(zip((ONE, TWO, THREE), factors)), usual=usual)
    options = select.options(SETUP, {"deflection": share}, book=known, seen=seen)
    assert select.pick(options).model.name == name
    sizes = {option.model.name: option for option in options}
    assert sizes[TWO].elements == 4 * sizes[ONE].elements
    assert sizes[TWO].effort == pytest.approx(8 * sizes[ONE].effort)


@pytest.mark.parametrize(
    ("shorts", "chosen"), [((9.0, 4.0, 3.5), 1), ((9.0, 4.0, 3.0), 2), ((5.0, 4.9, 4.8), 0), ((inf, inf, inf), 2)]
)
def test_without_one_that_is_enough_the_finest_that_pays(shorts, chosen):
    model = SimpleNamespace(answers=True)
    options = [SimpleNamespace(model=model, enough=False, short=short, effort=n) for n, short in enumerate(shorts)]
    assert select.pick(options) is options[chosen]


@pytest.mark.parametrize(
    ("elements", "fixed", "names", "symmetry"),
    [
        (2, {"elements_per_crossover", "symmetry"}, {TWO}, "whole"),
        (4, {"elements_per_crossover"}, {"as set by hand"}, "quarter"),
    ],
)
def test_what_is_set_by_hand_stays(elements, fixed, names, symmetry):
    setup, known = replace(SETUP, elements_per_crossover=elements), book({ONE: 0.05, TWO: 0.02, THREE: 0.001})
    options = select.options(setup, {"deflection": 0.2}, fixed=fixed, book=known)
    assert {option.model.name for option in options} == names
    assert options[0].setup.symmetry == symmetry


# --- the answer and its check, with made-up results


@pytest.fixture
def answer(monkeypatch):
    """(Answer, sides of the elements or "bar" of each run) from {elements a crossover: result or error}."""

    def run_all(results, *, fixed=frozenset({"projectile"}), setup=SETUP, **asked):
        calls = []

        def run(setup, table=None):
            side = round(1 / setup.grading[0][1], 6) if setup.grading else setup.elements_per_crossover
            calls.append(side if setup.projectile.bar is None else "bar")
            if isinstance(results[side], Exception):
                raise results[side]
            return results[side]

        monkeypatch.setattr(select.simulation, "run", run)
        known = None if setup.plies > 1 else book({ONE: 0.5, TWO: 0.1, THREE: 0.01}, apart=2.0, weight=0.5)
        return select.answer(setup, asked, book=known, fixed=fixed), calls

    return run_all


THROUGH = result("perforated", 30.0)
HELD = {n: result() for n in (0.5, 1, 2, 3)}
# {elements a crossover, 0.5 for those of 2 x 2: result}, what is asked, and of the answer: the model, what it is held
# against, the errors of all attempts, and the runs
ANSWERS = {
    "a promise that holds": (
        HELD | {0.5: result(z=0.021), 2: result(z=0.0201)}, {"deflection": 0.01}, TWO, "graded",
        [0.1 * (0.01 + 1 - 0.02 / 0.021)], [0.5, 1, 2],  # two pilot runs and the answer, and no finer mesh
    ),
    "too far from the pilot runs": (
        HELD | {0.5: result(z=0.021), 2: result(z=0.03), 3: result(z=0.0301)}, {"deflection": 0.01}, THREE, TWO,
        [inf, 0.0301 / 0.03 - 1], [0.5, 1, 2, 3],
    ),
    "in doubt": (  # to the full model at once, not over the meshes between
        HELD | {0.5: THROUGH, 3: result("perforated", 20.0)}, {"residual_velocity": 0.03}, ladder.FULL, "",
        [0.0], [0.5, 1, 3],
    ),
    "neither has a deflection": (
        dict.fromkeys(HELD, THROUGH), {"deflection": 0.02}, None, None, [0.0], None,
    ),
    "outcomes that differ": (
        HELD | {0.5: result(z=0.0201), 2: THROUGH, 3: result("perforated", 20.0)}, {"deflection": 0.002}, None, None,
        [inf, 0.0], None,
    ),
    "a pilot run is unstable": (
        HELD | {0.5: UnstableError("it broke")}, {"deflection": 0.1}, None, None, [inf, 0.0], None,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", ANSWERS)
def test_an_answer_is_held_against_another_mesh(answer, case):
    results, asked, model, against, errors, runs = ANSWERS[case]
    found, calls = answer(results, **asked)
    assert found.confirmed
    assert [*(error for attempt in found.attempts for error in attempt.errors.values())] == pytest.approx(errors)
    if model is not None:
        assert (found.final.option.model.name, found.final.against, calls) == (model, against, runs)


def test_peaks_are_mixed_with_those_of_the_next_mesh(answer):
    final = answer(HELD | {2: result(peaks=((99.0, 121.0),))}, peak_tension=0.02)[0].final
    assert (final.option.model.name, final.partner) == (TWO, "graded")
    assert final.values["peak_tension"] == pytest.approx((99.5, 120.5))


LONG, SHORT = (rigid_is_enough(time, 1e-6) for time in (50e-6, 1e-6))
BAR = replace(SETUP, projectile=Projectile(body="elastic_bar"))


@pytest.mark.parametrize(
    ("rigidity", "fixed", "setup", "words", "bars"),
    [
        (LONG, set(), SETUP, "projectile: rigid; contact lasts 50 us", 0),
        (SHORT, set(), SETUP, "projectile: an elastic bar; contact lasts 1 us", 3),  # pilot runs again, and the answer
        (SHORT, {"projectile"}, SETUP, "projectile: rigid, as set", 0),
        (LONG, {"projectile"}, BAR, "projectile: an elastic bar, as set", 3),
    ],
)
def test_a_projectile_is_as_elastic_as_it_needs_to_be(answer, rigidity, fixed, setup, words, bars):
    results = {n: result(rigidity=rigidity) for n in (0.5, 1, 2, 3)}
    found, calls = answer(results, fixed=frozenset(fixed), setup=setup, deflection=0.1)
    assert found.body.startswith(words)
    assert calls.count("bar") == bars
    assert (found.final.option.setup.projectile.bar is not None) == bool(bars)


def test_the_models_of_a_pack():
    options = {option.model.name: option for option in select.options(PACK, {"deflection": 1.0})}
    assert set(options) == {ladder.PACK_DEFAULT, ladder.PACK_FULL}
    default, full = options[ladder.PACK_DEFAULT].setup, options[ladder.PACK_FULL].setup
    assert (default.plies, default.symmetry) == (3, "quarter")
    assert default.grading == replace(PACK, symmetry="quarter").meshed.grading
    assert full.grading[0][1] == pytest.approx(1 / 3)
    oblique = replace(PACK, projectile=Projectile(obliquity=0.3), symmetry="half")  # short elements everywhere
    sides = [ladder.BY_NAME[name].of(oblique) for name in (ladder.PACK_DEFAULT, ladder.PACK_FULL)]
    assert [(setup.grading, setup.elements_per_crossover) for setup in sides] == [(None, 2), (None, 3)]
    for fixed in ("grading", "elements_per_crossover"):
        assert not ladder.BY_NAME[ladder.PACK_FULL].leaves(PACK, {fixed})


@pytest.mark.parametrize(
    ("coarse", "asked", "error"),
    [
        (result(z=0.02028, peaks=[(100.0, 120.0)] * 3), {"deflection": 0.02}, 0.0138),
        (result(z=0.02028, peaks=[(100.0, 120.0)] * 3), {"deflection": 0.01}, 0.0138),
        (result("perforated", peaks=[(100.0, 120.0)] * 3), {"absorbed_energy": 0.1}, inf),
    ],
)
def test_a_pack_is_answered_on_the_finer_of_two_meshes(answer, coarse, asked, error):
    fine = result(peaks=[(100.0, 120.0)] * 3)
    found, calls = answer({2: coarse, 3: fine}, setup=PACK, **asked)
    (attempt,) = found.attempts
    assert (attempt.option.model.name, attempt.against) == (ladder.PACK_FULL, ladder.PACK_DEFAULT)
    assert calls == [2, 3]
    assert list(attempt.errors.values()) == pytest.approx([error], rel=0.01)
    assert attempt.values["deflection"] == 0.02
    assert found.confirmed == (error < next(iter(asked.values())))
