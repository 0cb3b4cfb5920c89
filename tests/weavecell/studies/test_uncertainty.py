"""Scatter: likelihoods against closed forms, draws, rounds, and the limit without scatter."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import gamma

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.stats import chi2

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.impact.strengths import YarnStrength, draw_strengths
from shellfabric.membrane import failure_kernels
from shellfabric.membrane.model import Panel
from shellfabric.membrane.slots import by_node
from weavecell.studies import (
    ballistic_limit,
    inputs,
    probit,
    protocol,
    strengths,
    unknown,
    v50,
)

OPENING = 0.03048


def setup_of(fabric, opening, **others):
    return ImpactSetup(fabric, 1.0, opening=opening, **({"elements_per_crossover": 1} | others))


def shot_of(number, velocity, perforated):
    """At a panel that differs in nothing from the fabric."""
    point = (0.0, 0.0)
    return v50.Shot(number, velocity, 0.0, perforated, 1.0, 1.0, 1.0, (1.0, 1.0), point, 0.0)


def test_the_mesh_of_a_study(fabric):
    """Graded where nothing is said; what is said counts, and free edges have elements that are all alike."""
    plain = ImpactSetup(fabric, 1.0)
    near, *_ = v50.grade_mesh(plain).grading
    assert near[1] * 2 * max(fabric.weave.w) <= fabric.failure_length
    assert v50.grade_mesh(plain).grading[-1] == (np.inf, 4)
    drawn = strengths.draw_panel(v50.grade_mesh(plain), inputs.read_scatter(), 1, 5).pack.plies[0]
    assert max(far / step for far, step in zip(drawn.reach(), drawn.spacing)) < near[0] / near[1]
    stepped = (
        {"round": True},
        {"impact_point": (5e-3, 0.0), "symmetry": "whole"},
        {"weave_angle": 0.3},
    )
    for changes in ({"elements_per_crossover": 1}, {"grading": ((np.inf, 1),)}):
        assert v50.grade_mesh(replace(plain, **changes)) == replace(plain, **changes)
    for changes in stepped:
        assert v50.grade_mesh(replace(plain, **changes)).grading[0][1] == near[1]
    free = v50.grade_mesh(replace(plain, boundary="free"))
    assert free.grading is None
    assert free.elements_per_crossover * near[1] == 1
    pack = replace(plain, plies=2)
    assert v50.grade_mesh(pack) is pack


@pytest.fixture(scope="module")
def panel(fabric):
    return Panel(CellModel(fabric).table(21), (OPENING, OPENING), symmetry="whole")


def test_changed_fabric(fabric):
    heavy = inputs.scale_fabric(
        fabric, areal_density=1.04, crimp_warp=0.8, failure_strain=1.2, trellis_stiffness=1.2
    )
    warp = heavy.weave.warp
    old = fabric.weave.warp
    assert warp.EA == pytest.approx(old.EA, rel=1e-12)
    assert warp.linear_density == pytest.approx(1.04 * old.linear_density, rel=1e-12)
    assert warp.strength == pytest.approx(1.2 * old.strength, rel=1e-12)
    assert (warp.crimp, heavy.weave.weft.crimp) == pytest.approx(
        (0.8 * old.crimp, fabric.weave.weft.crimp)
    )
    assert heavy.shear.G2 == pytest.approx(1.2 * fabric.shear.G2)


def test_likelihood_of_repeated_shots_at_two_velocities():
    """With two velocities the curve goes through both shares: V50 and s in closed form."""
    V = np.repeat([100.0, 120.0], 10)
    hit = np.tile(np.arange(10), 2) < np.repeat([2, 7], 10)
    for link, law in probit.LINKS.items():
        curve = probit.fit(V, hit, link=link)
        s = 20 / (law.ppf(0.7) - law.ppf(0.2))
        assert curve.s == pytest.approx(s, rel=1e-5)
        assert curve.V50 == pytest.approx(100 - s * law.ppf(0.2), rel=1e-6)
        low, high = curve.intervals["V50"]
        assert low < curve.V50 < high


def test_separated_shots():
    curve = probit.fit([90, 95, 100, 105, 110], [False, False, False, True, True])
    assert curve.V50 == 102.5
    assert curve.s == 0.0
    assert curve.separated
    few = probit.fit(range(50, 130, 10), [False, True, False, False, True, False, True, True])
    # no velocity is below 0
    assert few.V0 == 0.0
    assert few.intervals["V0"][0] == 0.0


def test_a_step_at_the_velocity_of_a_stop_and_a_perforation():
    """The likelihood is largest for s = 0 there, whatever the share that perforated, and the interval is found."""
    V = [100.0, 110.0, *[140.0] * 22, 160.0]
    hit = [False, False, True, *[False] * 21, True]
    curve = probit.fit(V, hit)
    assert curve.V50 == pytest.approx(140.0, abs=0.01)
    assert curve.s == 0.0
    assert curve.separated
    assert curve.by_prior
    assert "a step, s = 0" in curve.words()
    assert curve.likelihood == pytest.approx(np.log(1 / 22) + 21 * np.log(21 / 22), rel=1e-3)
    low, high = curve.intervals["V50"]
    assert low <= curve.V50
    assert 150.0 < high


@pytest.mark.parametrize(
    "velocities, outcomes, told",
    [
        ([130, 135, 140, 145, 150, 155], "CCCPPP", "share of perforations does not grow"),
        ([100, 110, 120, 130], "PCCP", "share of perforations does not grow"),
        ([140, 140, 140, 140], "PCPC", "all shots have one velocity, 140 m/s"),
        ([100, 110], "CC", "all 2 shots perforated"),
        ([100, 110], "PP", "all 2 shots stopped"),
        ([], "", "all 0 shots stopped"),
    ],
)
def test_shots_that_determine_no_v50_say_why(velocities, outcomes, told):
    hit = np.array([letter == "C" for letter in outcomes], bool)
    for link in probit.LINKS:
        curve = probit.fit(velocities, hit, link=link)
        assert told in curve.reason
        assert np.isnan([curve.V50, curve.s, curve.V0, curve.V100]).all()
    assert protocol.series(curve).share == 0


def test_separated_shots_have_the_likelihood_of_a_public_answer():
    """R-help, 2003: by the profile likelihood of a logistic curve s up to 0.8 is consistent with the data; the
    posterior, which does not take a step for certain, leaves more."""
    stops = [-5.8, -4.8, -2.8667, -1.6667, -0.8667, -0.7333]
    V = 10 + np.array([*stops, -0.1333, 1.2, 1.3333])
    for end in (9.10, 10.42):
        fall = probit.fallen(V, V > 9.5, end, link="logit")
        assert fall == pytest.approx(0.5 * chi2.ppf(0.95, 1), rel=0.02)
    curve = probit.fit(V, V > 9.5, link="logit")
    low, high = curve.intervals["V50"]
    assert low < 9.10
    assert high > 10.42
    assert curve.by_prior


def test_drawn_strengths(fabric):
    """Mean of the fabric's strength at the gauge length, the known deviation, and weaker by length^(-1/m)."""
    m = 14.3
    n = 200_000
    short, long = draw_strengths(YarnStrength(m), 0, (n, n), (0.2, 0.4))
    deviation = (gamma(1 + 2 / m) / gamma(1 + 1 / m) ** 2 - 1) ** 0.5
    assert short.mean() == pytest.approx(1.0, abs=1e-3)
    assert short.std() == pytest.approx(deviation, rel=0.01)
    assert long.mean() == pytest.approx(0.5 ** (1 / m), abs=1e-3)
    plain = draw_strengths(YarnStrength(np.inf), 0, (3, 4), (0.2, 0.2))
    assert all((part == 1).all() for part in plain)


@pytest.mark.parametrize("per", [1, 2])
def test_each_yarn_has_its_own_strength(panel, per):
    """Against a plain loop over yarns; the weakest decides from where on failures are looked for."""
    random = np.random.default_rng(2)
    panel = replace(panel, elements_per_crossover=per)
    factors = tuple(random.uniform(0.5, 1.5, count) for count in panel.yarn_counts)
    panel = replace(panel, strength_factors=factors)
    const = panel.constants()
    state = panel.state(1.0)
    strengths = tuple(yarn.strength * part for yarn, part in zip(panel.weave.yarns, factors))
    assert (const.half_strength1, const.half_strength2) == tuple(
        0.5 * each.min() for each in strengths
    )
    for family, lines in enumerate((const.warp_lines, const.weft_lines)):
        yarns = panel.nearest_yarns[1 - family]
        assert_allclose(lines.strength, strengths[family][yarns], rtol=1e-15)
        state.T[family][:] = panel.weave.yarns[family].strength
        for _ in range(100):
            failure_kernels.find_failures(const, state, family, 0, const.ni + family)
        failed = by_node(state.failed[family], const)
        assert_array_equal(failed.any(axis=family), factors[family][yarns] < 0.999)


@pytest.mark.parametrize("name", ["S-720", "S-726"])  # of equal and of unlike spacings
def test_a_graded_panel_has_the_yarns_of_the_uniform_one(name):
    """The same draws; where elements are one crossover long each line has the strength of its yarn."""
    fabric = catalogue.load(name).with_effective_density()
    uniform, graded = (
        strengths.draw_panel(
            setup_of(fabric, 0.08, grading=zones), inputs.read_scatter(), 1, 3
        ).pack.plies[0]
        for zones in (None, ((12, 1), (np.inf, 2)))
    )
    for family, (all_yarns, lines) in enumerate(
        zip(uniform.strength_factors, graded.strength_factors)
    ):
        half = all_yarns.size // 2
        places = np.rint(graded.lines()[1 - family] / (2 * graded.weave.w[1 - family]))
        near = abs(places) < 12
        assert np.count_nonzero(near) == 23
        assert_array_equal(lines[near], all_yarns[half - 11 : half + 12])
        # the outermost line may stand a little beyond the last yarn
        far = ~near & (abs(places) < half)
        assert np.all(lines[far] <= all_yarns[half + places[far].astype(int)])
    one, other = (
        v50.fire(setup_of(fabric, OPENING, grading=zones), inputs.read_scatter(), 1, 3, 150.0)
        for zones in (((np.inf, 1),), None)
    )
    assert one == other


def test_slow_projectiles_that_count_as_stopped_do_stop(fabric):
    """Eight drawn panels about the limit: outcomes and residual velocities are the same to the bit with and without,
    and most of what is stopped takes less time."""
    spared = []
    for number, velocity in enumerate(np.linspace(40.0, 70.0, 8)):
        panel = strengths.draw_panel(setup_of(fabric, 0.06), inputs.read_scatter(), 5, number).pack
        one, two = (
            ballistic_limit.shoot(panel, (velocity,), stops_below=x)[0]
            for x in (0.0, v50.STOPS_BELOW)
        )
        assert one.outcome == two.outcome
        assert one.residual_velocity == two.residual_velocity
        assert two.time == one.time if one.perforated else two.time <= one.time
        spared += [] if one.perforated else [1 - two.time / one.time]
    assert 2 <= len(spared) <= 6
    assert np.median(spared) > 0


@pytest.mark.parametrize("link", probit.LINKS)
def test_the_curve_is_that_of_statsmodels(link):
    """The same likelihood and its maximum; and intervals of V50 a little wider than its normal ones, where shots are
    many."""
    models = pytest.importorskip("statsmodels.api")
    random = np.random.default_rng(1)
    V = random.uniform(80.0, 120.0, 200)
    hit = random.uniform(size=V.size) < probit.LINKS[link].cdf((V - 100.0) / 3.0)
    ours = probit.fit(V, hit, link=link)
    model = {"probit": models.Probit, "logit": models.Logit}[link]
    found = model(hit.astype(float), models.add_constant(V - 100.0)).fit(disp=0, tol=1e-12)
    b0, b1 = found.params
    assert (ours.V50, ours.s, ours.likelihood) == pytest.approx(
        (100.0 - b0 / b1, 1 / b1, found.llf), rel=1e-5
    )
    slope = np.array([-1 / b1, b0 / b1**2])
    half = 1.96 * np.sqrt(slope @ found.cov_params() @ slope)
    low, high = ours.intervals["V50"]
    assert half < 0.5 * (high - low) < 1.1 * half
    assert 0.5 * (low + high) == pytest.approx(ours.V50, abs=0.1)


def test_shots_are_those_of_their_numbers_whatever_the_workers(fabric, tmp_path):
    scatter = inputs.read_scatter()
    setup = setup_of(fabric, OPENING)
    arguments = {"shots": 8, "batch": 4}
    alone = v50.study(setup, scatter, folder=tmp_path / "a", **arguments)
    with ThreadPoolExecutor(3) as workers:
        beside = v50.study(setup, scatter, folder=tmp_path / "b", executor=workers, **arguments)
    assert alone.shots == beside.shots
    assert alone.summary() == beside.summary()
    told = []
    again = v50.study(
        setup,
        scatter,
        folder=tmp_path / "a",
        report=lambda done, total: told.append(done / total),
        **arguments,
    )
    assert again.shots == alone.shots
    # nothing was run again: a report of each round as it is found on disk
    assert told == [
        0.5,
        1.0,
    ]


def test_short_series_of_tests_find_the_curve_they_are_fired_on():
    """Their mean is V50 and 95 % of them lie in the range; on a steep curve they differ by the steps alone, and where
    the zone of mixed outcomes is far wider than the span fewer have a result."""
    random = np.random.default_rng(3)
    V = random.uniform(150.0, 250.0, 400)
    curve = probit.fit(
        V, random.uniform(size=V.size) < probit.LINKS["probit"].cdf((V - 200.0) / 8.0)
    )
    found = protocol.series(curve)
    assert found == protocol.series(curve)
    assert found != protocol.series(curve, seed=2)
    assert found.mean == pytest.approx(curve.V50, abs=1.0)
    assert found.low < curve.V50 < found.high
    assert 6 <= found.shots <= protocol.MOST
    assert found.share > 0.9
    steep = protocol.series(replace(curve, s=0.1))
    assert steep.deviation < found.deviation
    assert protocol.series(replace(curve, s=200.0)).share < found.share


def test_one_series_by_hand():
    """Sure outcomes: steps of 30 m/s until the outcome changes, of 15 m/s after it; three and three within 40 m/s."""

    class Sure:
        V50 = 200.0

        def probability(self, velocity):
            return float(velocity > 200.0)

    class Draws:
        def uniform(self, low, high):
            return high

        def random(self):
            return 0.5

    # 230 P, 200 S, 215 P, 200 S, 215 P, 200 S: stops 200 x 3, perforations 215, 215, 230
    assert protocol.one_series(Sure(), Draws()) == (
        pytest.approx((3 * 200 + 215 + 215 + 230) / 6),
        6,
    )


def test_the_ends_of_a_lay_up_are_those_of_each_of_its_fabrics(fabric):
    other = catalogue.load("S-728").with_effective_density()
    plies = (Ply(fabric, fabric.laws), Ply(other, other.laws))
    setup = setup_of(fabric, 0.08, plies=2, lay_up=plies)
    low, high = (
        unknown.put_all(setup, unknown.ALIKE, {"failure length": share}) for share in (0.0, 1.0)
    )
    for k, own in enumerate((fabric, other)):
        lengths = [end.lay_up[k].fabric.failure_length for end in (low, high)]
        assert lengths == pytest.approx([0.5 * own.failure_length, 2 * own.failure_length])
    assert low.fabric == low.lay_up[0].fabric
    drawn = unknown.find_drawn(setup, unknown.ALIKE)
    assert {"strength after weaving", "friction between plies"} < set(drawn)


BEETLES = {  # dose, number, dead: C. I. Bliss, The calculation of the dosage-mortality curve (1935)
    1.6907: (59, 6),
    1.7242: (60, 13),
    1.7552: (62, 18),
    1.7842: (56, 28),
    1.8113: (63, 52),
    1.8369: (59, 53),
    1.8610: (62, 61),
    1.8839: (60, 60),
}


def test_the_probit_of_bliss():
    """V50 and s of 481 outcomes, as a generalised linear model finds them in public."""
    V = np.concatenate([np.full(number, 100 * dose) for dose, (number, _) in BEETLES.items()])
    hit = np.concatenate([np.arange(number) < dead for number, dead in BEETLES.values()])
    found = probit.fit(V, hit)
    assert (found.V50, found.s) == pytest.approx((177.0852, 5.069), abs=1e-3)


def test_outcomes_that_do_not_mix_have_an_interval_once_shots_are_enough():
    V = np.arange(90.0, 120.0, 2.5)
    more = probit.fit(V, V > 101)
    low, high = more.intervals["V50"]
    assert V[0] < low < 97.5
    assert 102.5 < high < V[-1]
    assert more.intervals["s"][0] == 0
    assert more.span() == f"{low:.1f} to {high:.1f} m/s"


@pytest.mark.parametrize("link", probit.LINKS)
def test_the_penalty_is_half_the_logarithm_of_the_determinant_of_the_information(link):
    """I of b0 and b1 by its definition; differences of two curves, as a constant is left out."""
    V = np.array([91.0, 97.0, 104.0, 112.0])
    law = probit.LINKS[link]
    likelihood = {p: probit._Likelihood(V, V > 100, link, penalised=p) for p in (True, False)}

    def ours(at, beta):
        return likelihood[True](at, beta) - likelihood[False](at, beta)

    def slow(at, beta):
        eta = beta * (V - at)
        w = law.pdf(eta) ** 2 / (law.cdf(eta) * law.sf(eta))
        return 0.5 * np.log(np.linalg.det(np.array([w, w * V, w * V**2])[[[0, 1], [1, 2]]].sum(-1)))

    assert ours(98.0, 0.3) - ours(103.0, 0.1) == pytest.approx(
        slow(98.0, 0.3) - slow(103.0, 0.1), rel=1e-9
    )
    # where the weights of all but one shot are less than any number
    assert np.isfinite(ours(92.0, 50.0))


def series_of(shots, s, random):
    """(velocities, outcomes) of shots at panels that fail at 500 +- s m/s, placed up and down."""
    failing = 500 + s * random.standard_normal(shots)
    velocity, step = 500 + random.uniform(-30, 30), 30
    velocities, hit = [], []
    for limit in failing:
        velocities.append(velocity)
        hit.append(bool(velocity > limit))
        if any(hit) and not all(hit):
            step = 15
        velocity += -step if hit[-1] else step
    return velocities, hit


@pytest.mark.slow(9)
def test_intervals_of_forty_drawn_series_hold_v50():
    """Of the 95 % intervals of 40 series 34 or more hold the true V50: fewer have a chance of 1 % if the intervals
    are right. The likelihood by itself holds it in fewer."""
    random = np.random.default_rng(5)
    held = without = 0
    fall = 0.5 * chi2.ppf(0.95, 1)
    for number in range(40):
        V, hit = series_of(24, (10.0, 25.0)[number % 2], random)
        curve = probit.fit(V, hit)
        low, high = curve.intervals["V50"]
        held += low <= 500 <= high
        assert low <= curve.V50 <= high
        assert curve.by_prior != probit.bounds_V50(V, hit, curve.V50)
        without += probit.fallen(V, hit, 500.0) <= fall
    assert held >= 34
    assert without < held


def test_the_band_of_a_curve_is_the_intervals_of_its_named_velocities():
    """Of shots that bound V50 on their own: V0, V50 and V100 are shares of 1, 50 and 99 %."""
    V, hit = series_of(24, 25.0, np.random.default_rng(3))
    curve = probit.fit(V, hit)
    assert not curve.by_prior
    found = probit.band(V, hit, curve, probit.NAMED.values())
    wanted = [curve.intervals[name] for name in probit.NAMED]
    assert found == pytest.approx(np.array(wanted), abs=1e-3)


# drawn outcomes, velocity [m/s] and P or C, with V50 and s of a generalised linear model (statsmodels)
SETS = (
    (
        "128C 120P 109C 112C 111P 114C 129C 103P 113C 128C 127C 122C",
        108.535,
        11.008,
    ),
    (
        "225P 257C 219P 237C 215P 241P 220P 217P 260C 227P 260P 230P 260C 240C 253C 270C 227P "
        "250C 220P 241P",
        244.369,
        12.583,
    ),
    (
        "395C 447C 446C 428C 430C 420C 428P 382P 448C 431C 436C 355P 376P 384P 440C 407C 420C "
        "403P 399P 397C 406C 438C 436C 446C 432C 357P 380P 382P 364P 449C 437C 395P 360P 391P "
        "372P 390P 398P 451C 396C 359P",
        403.7,
        15.816,
    ),
)


@pytest.mark.parametrize("outcomes, V50, s", SETS)
def test_drawn_sets_have_the_answers_of_a_linear_model(outcomes, V50, s):
    velocities = [float(outcome[:-1]) for outcome in outcomes.split()]
    hit = [outcome.endswith("C") for outcome in outcomes.split()]
    found = probit.fit(velocities, hit)
    assert (found.V50, found.s) == pytest.approx((V50, s), abs=2e-3)
