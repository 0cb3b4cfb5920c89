"""Constants fitted to biaxial tests: recovered from made data, their intervals, and what is predicted.

Tests are made of the unbalanced weave with warp and weft errors of their own, by the crossover's cell, which
tests/shellfabric/cell holds against plain twins; here the fit is tested.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from shellfabric.cell.model import CellModel
from weavecell.studies import biaxial_fit
from weavecell.studies.biaxial_path import to_strength
from weavecell.studies.biaxial_tests import BiaxialTest, read

FABRIC = catalogue.load("glass-unbalanced")
TRUTH = CompressionLaw(1.7e-4, 0.9e-4)
CELL = CellModel(FABRIC, (TRUTH, TRUTH))
# [N] of warp and weft
NOISE = np.array([9.0, 1.1])
RATIOS = {"even": (1, 1), "along": (2, 1), "across": (0.5, 1)}


def made(cell=CELL, ratios=("even", "along"), seed=3, noise=NOISE, late=0.0, rows=19):
    """Tests of a cell, whose strains are counted from `late` on."""
    rng = np.random.default_rng(seed)
    tests = []
    for name in ratios:
        path = to_strength(cell, RATIOS[name], rows)
        load = path.tension + noise * rng.standard_normal(path.tension.shape)
        tests.append(BiaxialTest(name, path.strain - late * np.array(path.ratio), load))
    return tests


def fitted(tests, **options):
    return biaxial_fit.fit(CellModel(FABRIC), tests, with_profiles=False, **options)


@pytest.fixture(scope="module")
def found():
    tests = made(ratios=("across", "even", "along"))
    return fitted(tests, chosen=["even", "along"])


def test_constants_come_back_from_noisy_tests_and_the_third_is_predicted(found):
    for name, true in (("a", TRUTH.a), ("b", TRUTH.b)):
        constant = found.values[name]
        assert constant.low < true < constant.high
        assert constant.spread < 0.25
        assert getattr(found.law, f"{name}_interval") == (constant.low, constant.high)
    assert 0.8 < found.correlation[0, 1] < 1
    across, even, along = found.comparisons
    assert (across.role, even.role, along.role) == ("predicted", "fitted", "fitted")
    for one in found.comparisons:
        assert one.rms == pytest.approx(NOISE, rel=0.45)
        assert one.agrees
    # the weft of all three tests together breaks at 80 N, its greatest load
    assert across.shares[1] == pytest.approx(across.rms[1] / 80, rel=0.05)
    assert abs(across.own_start) < 2e-4
    assert not any(check.doubtful for check in found.checks)


def test_warp_and_weft_have_errors_of_their_own(found):
    """With one error for both, the weft, of a tenth of the load, would say nothing of the constants."""
    problem = biaxial_fit._Problem(
        CellModel(FABRIC), [one.test for one in found.fitted], ("a", "b")
    )
    _, weights = problem.solve()
    assert weights == pytest.approx(NOISE, rel=0.3)


def test_an_interval_ends_where_the_profile_has_risen_far_enough(found):
    """b is fitted again at the end of a's interval by a search of its own; how far is Student's t with the freedom of
    both errors, and Meier's factor for weights that are estimates."""
    problem = biaxial_fit._Problem(
        CellModel(FABRIC), [one.test for one in found.fitted], ("a", "b")
    )
    _, weights = problem.solve()
    squares = lambda a, b: np.sum(problem.residuals(np.log([a, b]), weights) ** 2)  # noqa: E731
    least = squares(found.law.a, found.law.b)
    at = np.log([found.law.a, found.law.b])
    slopes = [
        (problem.residuals(at + step, weights) - problem.residuals(at - step, weights)) / 2e-4
        for step in 1e-4 * np.eye(2)
    ]
    of_a = np.linalg.lstsq(np.array(slopes).T, np.eye(76), rcond=None)[0][0] ** 2
    # rows are warp, weft, warp, ...
    share = of_a[::2].sum() / of_a.sum()
    assert 0.02 < share < 0.98
    freedom = 38 * (1 - 2 / 76)
    t = student.ppf(0.975, freedom / (share**2 + (1 - share) ** 2))
    wanted = 1 + t**2 * (1 + 8 * share * (1 - share) / freedom) / (76 - 2)
    for end in found.law.a_interval:
        again = minimize_scalar(
            lambda b, end=end: squares(end, b),
            bounds=(0.3 * found.law.b, 3 * found.law.b),
            method="bounded",
            options={"xatol": 1e-9},
        )
        assert again.fun / least == pytest.approx(wanted, rel=2e-3)


def test_one_ratio_of_the_balanced_weave_does_not_determine_b():
    fabric = catalogue.load("glass-balanced")
    tests = made(CellModel(fabric), ("even", "along", "across"), noise=np.array([7.0, 7.0]))
    fit = partial(biaxial_fit.fit, CellModel(fabric), tests, with_profiles=False)
    alone = fit(["even"])
    assert [one.name for one in alone.undetermined] == ["b"]
    assert alone.correlation[0, 1] > 0.9
    (check,) = [one for one in alone.checks if one.doubtful]
    assert (check.name, check.value) == ("widest interval", alone.values["b"].spread)
    together = fit()
    for name in ("a", "b"):
        assert together.values[name].spread < 0.8 * alone.values[name].spread


def test_starts_crimps_and_heights_come_back():
    late = 2.5e-4
    found = fitted(made(late=late), constants=["a", "b", "start"])
    for name in RATIOS:
        if f"start of {name}" in found.values:
            start = found.values[f"start of {name}"]
            assert start.low < late < start.high
            assert start.value == pytest.approx(late, rel=0.2)
    # a fit with no free start would take it for another law
    assert abs(fitted(made(late=late)).law.a / TRUTH.a - 1) > 3 * abs(found.law.a / TRUTH.a - 1)

    other = FABRIC.with_yarns(crimp=(0.0047, 0.0059))
    found = fitted(
        made(replace(CELL, fabric=other)), constants=["a", "warp crimp", "weft crimp", "b"]
    )
    for m, name in enumerate(("warp crimp", "weft crimp")):
        true = other.weave.yarns[m].crimp
        assert found.values[name].low < true < found.values[name].high
        assert found.values[name].value == pytest.approx(true, rel=0.12)
        assert found.model.fabric.weave.yarns[m].crimp == found.values[name].value

    loose = replace(CELL, crossover_gap=4e-5)
    known = replace(CellModel(FABRIC), laws=(TRUTH, TRUTH))
    found = biaxial_fit.fit(known, made(loose), constants=["h"], with_profiles=False)
    assert found.values["h"].value == pytest.approx(sum(CELL.h0) - 4e-5, rel=5e-3)
    assert found.model.crossover_gap == pytest.approx(4e-5, rel=0.1)
    assert (found.law.a, found.law.b) == (TRUTH.a, TRUTH.b)


def test_a_stiffening_by_the_strain_comes_back():
    true = 160.0
    tests = made(
        replace(CELL, stiffening=true), ("across", "even", "along"), noise=NOISE / 20, rows=15
    )
    found = fitted(tests, constants=["a", "b", "stiffening"])
    stiffening = found.values["stiffening"]
    assert stiffening.low < true < stiffening.high
    assert stiffening.value == pytest.approx(true, rel=0.25)
    assert found.model.stiffening == stiffening.value
    # a cell without it follows the same tests less closely
    plain = fitted(tests)
    assert np.nanmax([one.rms for one in plain.comparisons]) > 1.5 * np.nanmax(
        [one.rms for one in found.comparisons]
    )


def test_a_cell_unlike_the_cloth_says_so():
    """Tests of straight yarns with feet, fitted by cosines of linear yarns, and by the cell that they are of."""
    fabric = replace(CELL, centreline="straight", slack=(8e-4, 5e-4))
    tests = made(fabric, ("even", "across"), noise=NOISE / 20, rows=31)
    like = {}
    for name, model in (("linear", CellModel(FABRIC)), ("own", replace(fabric, laws=None))):
        found = biaxial_fit.fit(model, tests, ["even"], with_profiles=False)
        like[name] = {check.name: check for check in found.checks}
    alike = "likeness of neighbouring residuals"
    assert like["linear"][alike].status == "noted"
    assert like["own"][alike].status == "ok"
    error = "error of prediction"
    assert like["linear"][error].value > 5 * like["own"][error].value
    # only cosines are looked at for contact along the yarns
    assert "length without contact" not in like["own"]
    assert like["linear"]["length without contact"].status == "noted"


def test_a_free_edge_pulls_a_yarn_alone():
    strain = np.linspace(0, 0.02, 12)
    test = BiaxialTest("free", np.stack([strain, np.full(12, np.nan)], 1), np.full((12, 2), 5.0))
    assert (test.free, test.ratio) == ("weft", "weft free")
    loads = biaxial_fit.loads_of(CELL, test, start=1e-3)
    assert loads[:, 0] == pytest.approx(CELL.alone(0, 1.001 + strain))
    assert not loads[:, 1].any()


def test_most_of_a_few_intervals_hold_the_truth():
    """Of 95 % intervals; `validation/studies/biaxial-coverage.toml` has 200 draws."""
    draws = [fitted(made(seed=seed, rows=9)) for seed in range(8)]
    held = [one.law.a_interval[0] < TRUTH.a < one.law.a_interval[1] for one in draws]
    assert sum(held) >= 6
    widths = [one.values["a"].spread for one in draws]
    off = [abs(one.law.a / TRUTH.a - 1) for one in draws]
    # an interval is twice the scatter, not ten times
    assert np.mean(widths) < 8 * np.mean(off)


def test_noise_is_no_error_of_a_prediction():
    """Each load is off by 8 % of the greatest: at random it agrees, as a shift of the curve it does not."""
    strain = np.stack([np.linspace(0, 0.011, 60), np.linspace(0, 0.022, 60)], 1)
    greatest = np.array([850.0, 80.0])
    computed = greatest * strain / strain[-1]
    noise = 0.08 * greatest * np.random.default_rng(11).standard_normal((60, 2))
    shift = np.full((60, 2), 0.08) * greatest
    verdicts = {}
    for name, off in (("noise", noise), ("shift", shift), ("both", noise + shift)):
        one = biaxial_fit.Comparison(
            BiaxialTest(name, strain, computed + off), computed, False, greatest
        )
        assert not one.agrees_with_noise
        verdicts[name] = one.verdict, *one.missed
    assert verdicts["noise"][0] == "agrees"
    assert max(verdicts["noise"][1:]) < 0.03
    assert verdicts["shift"] == ("differs", pytest.approx(0.08), pytest.approx(0.08))
    assert verdicts["both"][0] == "differs"
    assert verdicts["both"][1:] == pytest.approx([0.08, 0.08], rel=0.2)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"chosen": ["even", "odd"]}, "fitted"),
        ({"constants": ["a", "c"]}, "constants"),
    ],
)
def test_names_that_are_unknown(options, key):
    with pytest.raises(InputError, match=key):
        fitted(made(rows=5), **options)


def test_tests_that_do_not_depend_on_a_constant():
    strain = np.linspace(0, 0.013, 12)
    alone = np.stack([strain, np.full(12, np.nan)], 1)
    load = np.stack([CELL.alone(0, 1 + strain), np.full(12, np.nan)], 1)
    with pytest.raises(InputError, match="do not depend on a and b"):
        fitted([BiaxialTest("free", alone, load + np.sin(np.arange(12))[:, None])])


CSV = """# loads of one yarn
weft load [N]; test; weft strain [-]; warp load [kN]; warp strain [%]
1; k 2; 0,001; 0,01; 0,2
2; k 2; 0,002; ; 0,4
3; free; ; 0,02; 0,1
4; k 2; 0,003; 0,03; 0,6
5; k 2; 0,004; 0,04; 0,8
6; k 2; 0,005; 0,05; 1,0
; free; ; 0,02; 0,2
; free; ; 0,03; 0,3
; free; ; 0,04; 0,4
; free; ; 0,05; 0,5
"""


def test_a_file_in_any_order_and_unit(tmp_path):
    (tmp_path / "t.csv").write_text(CSV)
    steep, free = read(tmp_path / "t.csv", (1.1e-3, 1.3e-3))
    assert (steep.name, free.name) == ("k 2", "free")
    assert steep.ratio == "1 : 0.5"
    assert steep.strain[1] == pytest.approx([0.004, 0.002])
    assert steep.load[0] == pytest.approx([10, 1])
    assert np.isnan(steep.load[1, 0])
    assert steep.greatest == pytest.approx([50, 6])
    # the load of a free direction is that of its clamps' friction, if of anything
    assert np.isnan(free.load[:, 1]).all()
    assert np.isnan(free.strain[:, 1]).all()
    assert free.load[-1, 0] == pytest.approx(50)
