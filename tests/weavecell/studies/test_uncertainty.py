"""Scatter: likelihoods against closed forms, draws, rounds, and the limit without scatter."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import gamma

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.impact.strengths import draw_strengths
from shellfabric.membrane import failure_kernels
from shellfabric.membrane.model import Panel
from shellfabric.membrane.slots import by_node
from weavecell.runs import table, v50
from weavecell.studies import ballistic_limit, inputs, strengths, unknown

OPENING = 0.03048


def setup_of(fabric, opening, **others):
    return ImpactSetup(fabric, 1.0, opening=opening, **({"elements_per_crossover": 1} | others))


def shot_of(number, velocity, perforated):
    """At a panel that differs in nothing from the fabric."""
    return table.Shot(velocity, 0.0, perforated, number, balance=0.0)


def test_the_mesh_of_a_study(fabric):
    """Graded where nothing is said; what is said counts, and free edges have elements that are all alike."""
    plain = ImpactSetup(fabric, 1.0)
    near, *_ = table.grade_mesh(plain).grading
    assert near[1] * 2 * max(fabric.weave.w) <= fabric.failure_length
    assert table.grade_mesh(plain).grading[-1] == (np.inf, 4)
    drawn = strengths.draw_panel(table.grade_mesh(plain), inputs.read_scatter(), 1, 5).pack.plies[0]
    assert max(far / step for far, step in zip(drawn.reach(), drawn.spacing)) < near[0] / near[1]
    stepped = (
        {"round": True},
        {"impact_point": (5e-3, 0.0), "symmetry": "whole"},
        {"weave_angle": 0.3},
    )
    for changes in ({"elements_per_crossover": 1}, {"grading": ((np.inf, 1),)}):
        assert table.grade_mesh(replace(plain, **changes)) == replace(plain, **changes)
    for changes in stepped:
        assert table.grade_mesh(replace(plain, **changes)).grading[0][1] == near[1]
    free = table.grade_mesh(replace(plain, boundary="free"))
    assert free.grading is None
    assert free.elements_per_crossover * near[1] == 1
    pack = replace(plain, plies=2)
    assert table.grade_mesh(pack) is pack


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


def test_drawn_strengths():
    """Scatter alone: of mean 1 and the known deviation, whatever the length of the yarns."""
    m = 14.3
    n = 200_000
    warp, weft = draw_strengths(m, 0, 0, (n, n))
    deviation = (gamma(1 + 2 / m) / gamma(1 + 1 / m) ** 2 - 1) ** 0.5
    for factors in (warp, weft):
        assert factors.mean() == pytest.approx(1.0, abs=1e-3)
        assert factors.std() == pytest.approx(deviation, rel=0.01)
    assert not np.array_equal(warp, weft)
    plain = draw_strengths(np.inf, 0, 0, (3, 4))
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
    strengths = tuple(mean * part for mean, part in zip(panel.strengths, factors))
    assert (const.half_strength1, const.half_strength2) == tuple(
        0.5 * each.min() for each in strengths
    )
    for family, lines in enumerate((const.warp_lines, const.weft_lines)):
        yarns = panel.nearest_yarns[1 - family]
        assert_allclose(lines.strength, strengths[family][yarns], rtol=1e-15)
        state.T[family][:] = panel.strengths[family]
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
    draw = table.Draw(inputs.read_scatter(), 1, 3)
    one, other = (
        table.fire(setup_of(fabric, OPENING, grading=zones), 150.0, draw)
        for zones in (((np.inf, 1),), None)
    )
    assert one == other


def test_slow_projectiles_that_count_as_stopped_do_stop(fabric):
    """Four drawn panels about the limit: outcomes and residual velocities are the same to the bit with and without,
    and most of what is stopped takes less time."""
    spared = []
    for number, velocity in enumerate((40.0, 44.3, 48.6, 52.9)):
        panel = strengths.draw_panel(setup_of(fabric, 0.06), inputs.read_scatter(), 5, number).pack
        one, two = (
            ballistic_limit.shoot(panel, (velocity,), stops_below=x)[0]
            for x in (0.0, table.STOPS_BELOW)
        )
        assert one.outcome == two.outcome
        assert one.residual_velocity == two.residual_velocity
        assert two.time == one.time if one.perforated else two.time <= one.time
        spared += [] if one.perforated else [1 - two.time / one.time]
    assert 2 <= len(spared) <= 3
    assert np.median(spared) > 0


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
    assert told[-1] == 1.0
    assert set(told) <= {0.5, 1.0}


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
