"""Friction between yarns from pull-outs: a slow march makes the peaks, and the reduction finds what went in."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.coupon.pull_out import PullOut, follow
from weavecell.api import coupons
from weavecell.studies import pull_out_tests as studies
from weavecell.studies.pull_out_tests import PullOutTest

MU = 0.2
COHESION = 0.05  # [N]
TENSION = 2.0  # [N] of each crossing yarn
USUAL = (0.15, 0.2, 0.25)
PLACES = np.linspace(0, 1, 201)


def length(height, half):
    """[m] of a cosine over the length 2 `half`, by a sum over chords."""
    x = 2 * half * PLACES
    y = height * np.cos(np.pi * PLACES)
    return np.hypot(np.diff(x), np.diff(y)).sum()


def push(height, half):
    """[-] slope of that length in the height, by a difference."""
    step = 1e-5 * half
    return (length(height + step, half) - length(height - step, half)) / (2 * step)


def closed(law, force):
    """[m] that a yarn gives under a contact force."""
    return law.a - law.b * (force + (law.b / law.a) ** 3) ** (-1 / 3)


def contact_force(tension, fabric):
    """[N] at a crossover of a warp yarn of a tension, whose weft is held at the length that it has
    under TENSION: both are perfectly flexible cosines."""
    warp, weft = fabric.weave.yarns
    w = fabric.weave.w
    S = [2 * half * (1 + yarn.crimp) for yarn, half in zip((warp, weft), w)]
    rest = [
        brentq(lambda h, m=m: length(h, w[m]) - S[m], 1e-9, 3 * w[m], xtol=1e-12) for m in (0, 1)
    ]
    held = 0.5 * S[1] * (1 + TENSION / weft.EA)

    def state(height):
        half = brentq(
            lambda half: length(height, half) - S[0] * (1 + tension / warp.EA), 0.5 * w[0], S[0]
        )
        force = 4 / np.pi * tension * push(height, half)
        other = brentq(
            lambda h: weft.EA * (length(h, held) / S[1] - 1) * push(h, held) - np.pi / 4 * force,
            0.0,
            3 * held,
            xtol=1e-12,
        )
        pressed = sum(closed(law, force) for law in fabric.laws)
        return height + other + pressed - sum(rest), force

    return state(brentq(lambda h: state(h)[0], 0.1 * rest[0], sum(rest), xtol=1e-12))[1]


@cache
def true_peak(crossings):
    """[N] by a march from the tail, crossover by crossover, with the mean tension at each."""
    tensions, forces = forces_of()
    tension = 0.0
    for number in range(crossings):
        ahead = tension
        for _ in range(60):
            pressed = ahead if number == 0 else 0.5 * (tension + ahead)
            ahead = tension + COHESION + MU * np.interp(pressed, tensions, forces)
        tension = ahead
    return tension


@cache
def forces_of():
    tensions = np.geomspace(0.01, 40, 10)
    fabric = wc.fabric("S-728")
    forces = [contact_force(tension, fabric) for tension in tensions]
    return np.append(0, tensions), np.append(0, forces)


@pytest.fixture(scope="module")
def cell():
    """The pull-out whose cell all tests here have in common."""
    keys = {"displacement": "5 mm", "crossover_cohesion": "0.1 N"}
    case = coupons.case_of("S-728", "pull_out", keys)
    found = PullOut(coupons.table_of(case), pre_tension=TENSION, mu=0.1)
    assert found.contact_forces.size
    return found


def repeated(noise, lengths=(10, 20), repeats=5):
    """Repeats of each length, whose peaks have the noise of a seed."""
    rng = np.random.default_rng(noise)
    return [
        PullOutTest(f"{n}.{k}", "warp", n, TENSION, true_peak(n) * np.exp(0.1 * rng.normal()))
        for n in lengths
        for k in range(repeats)
    ]


def groups_of(tests, cell):
    """As `group_tests`, of one cell: its own forces are those of the module's fixture."""
    found = []
    for crossings in sorted({test.crossings for test in tests}):
        alike = tuple(test for test in tests if test.crossings == crossings)
        found.append(studies.PullOutGroup(cell.changed(crossings=crossings), alike))
    return tuple(found)


def test_the_friction_of_noisy_peaks_is_within_its_interval(cell):
    """Five repeats of 10 % at 10 and 20 crossings; of 100 noises 89 intervals have the truth."""
    fits = [studies.fit(groups_of(repeated(noise), cell), USUAL) for noise in range(50, 54)]
    mus = np.array([fit.mu for fit in fits])
    assert abs(mus.mean() - MU) < 0.015
    assert all(0.006 < fit.mu_error < 0.022 for fit in fits)
    inside = [fit.mu_interval[0] < MU < fit.mu_interval[1] for fit in fits]
    assert sum(inside) >= 3
    held = [fit.cohesion_interval[0] < COHESION < fit.cohesion_interval[1] for fit in fits]
    assert sum(held) >= 3
    assert fits[0].is_flexible
    for group in fits[0].groups:
        assert np.exp(group.logs) == pytest.approx([test.peak for test in group.tests])
    assert not fits[0].doubts


def test_the_peak_is_that_of_the_curve(cell):
    """And the fitted friction meets the peaks of the march, of three lengths, without noise."""
    tests = [PullOutTest("", "warp", n, TENSION, true_peak(n)) for n in (10, 16, 24)]
    fit = studies.fit(groups_of(tests, cell), USUAL)
    assert fit.mu == pytest.approx(MU, rel=0.01)
    assert fit.cohesion == pytest.approx(COHESION, rel=0.02)
    coupon = fit.groups[1].coupon.changed(mu=fit.mu, cohesion=fit.cohesion)
    assert follow(coupon, 0.01, samples=400).peak == pytest.approx(coupon.peak, rel=1e-9)
    assert coupon.peak == pytest.approx(true_peak(16), rel=5e-3)


def test_one_length_tells_pairs_alone(cell):
    """Each of which meets the peak; two lengths that are nearly one do not tell more."""
    for lengths in ((20,), (20, 21)):
        fit = studies.fit(groups_of(repeated(3, lengths, 2), cell), USUAL)
        assert fit.mu is None
        assert "not both friction and c0" in fit.doubts[0]
        mu, cohesion = fit.pairs[1]
        met = fit.groups[0].coupon.changed(mu=mu, cohesion=cohesion).peak
        assert met == pytest.approx(fit.groups[0].mean, rel=1e-3)
        # the true pair is among them
        assert cohesion == pytest.approx(COHESION, rel=0.3)


def test_doubts_name_what_they_doubt(cell):
    def doubts(tests):
        return "; ".join(studies.fit(groups_of(tests, cell), USUAL).doubts)

    assert "no test was repeated" in doubts(repeated(1, repeats=1))
    wild = [PullOutTest("", "warp", n, None, 2 * n**1.4 * f) for n in (4, 20) for f in (0.6, 1.5)]
    found = doubts([PullOutTest("", "warp", t.crossings, None, 0.02 * t.peak) for t in wild])
    assert "repeats scatter by 65 %" in found
    assert "4 crossings: below 5" in found
    assert "tension of the crossing yarns is not given" in found
    bent = [
        PullOutTest("", "warp", n, TENSION, p * f)
        for n, p in ((8, 1), (14, 6), (20, 7))
        for f in (1, 1.02)
    ]
    assert "no one friction meets all peaks" in doubts(bent)


def test_peaks_that_no_friction_makes_are_refused(cell):
    flat = [PullOutTest("", "warp", n, TENSION, 1 + 0.01 * k) for n in (10, 20) for k in range(3)]
    with pytest.raises(InputError, match="must be growing at least as the number of crossings"):
        studies.fit(groups_of(flat, cell), USUAL)
    strong = [PullOutTest("a", "warp", 10, TENSION, 1e4)]
    with pytest.raises(InputError, match="peak load of test a = '1e"):
        studies.group_tests(strong, {"warp": cell})


def record(slack, peak, scale=1.0, end=4.0):
    """(displacement [mm], load) of a record with machine slack, a rise over 1 mm and a slow fall."""
    moved = np.linspace(0, end, 81)
    way = np.maximum(moved - slack, 0)
    load = peak * np.where(way < 1, way, np.maximum(1 - 0.1 * (way - 1), 0.2))
    return moved, scale * load


def test_records_one_below_the_other(tmp_path):
    """Decimal commas, units in a row of their own, a spike, slack, pounds; two tests of one name."""
    rows = [
        "Tester;7",
        "Specimen;Crossings;Fill or warp;Extension;Load;Transverse force",
        ";;;(mm);(lbf);(gf)",
    ]
    for crossings, slack, peak in ((10, 0.3, 1.2), (10, 0.7, 1.1), (24, 0.5, 5.0)):
        for number, (moved, load) in enumerate(zip(*record(slack, peak, 1 / 4.4482216))):
            spike = 3.0 if number == 60 else 1.0
            rows.append(f"A;{crossings};x;{moved:.4f};{load * spike:.6f};{crossings * 250}")
    file = tmp_path / "records.csv"
    file.write_text("\n".join(rows).replace(".", ","))
    found = studies.read(file, {"warp": 1e-3, "weft": 1.1e-3}, pulled="weft")
    assert [one.crossings for one in found] == [10, 10, 24]
    assert {one.pulled for one in found} == {"weft"}
    assert [one.peak for one in found] == pytest.approx([1.2, 1.1, 5.0], rel=0.01)
    assert [one.slack for one in found] == pytest.approx([3e-4, 7e-4, 5e-4], abs=3e-5)
    assert [one.at_peak for one in found] == pytest.approx(3 * [1e-3], abs=6e-5)
    assert found[0].tension == pytest.approx(250 * 9.80665e-3)
    assert not [doubt for one in found for doubt in one.doubts]


def test_a_table_of_peaks_by_lengths(tmp_path):
    file = tmp_path / "peaks.csv"
    file.write_text(
        "pulled,length [mm],Max. load [gf],tension [N]\nWarp,20.4,100,1.5\nfill,20.4,90,\n"
    )
    found = studies.read(file, {"warp": 1e-3, "weft": 2e-3})
    assert [one.group for one in found] == [("warp", 20, 1.5), ("weft", 10, None)]
    assert found[1].peak == pytest.approx(0.8826, rel=1e-4)
    assert found[0].slack is None


@pytest.mark.parametrize(
    "text, words",
    [
        ("crossings, peak load [N]\n", "has no pull-out"),
        ("crossings, force [N]\n10, 3\n", "must be displacement beside force"),
        ("crossings, peak load [N]\n10.5, 3\n", "crossings = '10.5': must be a whole number"),
        ("crossings, peak load [N]\n10, 0\n", "peak = '0': must be above 0"),
        ("pulled, crossings, peak [N]\nbias, 9, 3\n", "pulled = 'bias': must be warp or weft"),
        ("peak load [N]\n3\n", "crossings: must be given for each test"),
        (
            "crossings, displacement [mm], force [N]\n5, 0, 0\n",
            "rows of test 1 = 1: must be at least 10",
        ),
    ],
)
def test_tables_that_are_refused(tmp_path, text, words):
    file = tmp_path / "t.csv"
    file.write_text(text)
    with pytest.raises(InputError) as refused:
        studies.read(file, {"warp": 1e-3, "weft": 1e-3})
    assert words in str(refused.value)


def test_a_record_that_ends_at_its_peak_or_begins_loaded():
    moved, load = record(0.2, 3.0, end=1.1)
    found = PullOutTest("7", "warp", 10, 1.0, 3.0, 1e-3 * moved, load + 0.4)
    assert [doubt.partition(":")[0] for doubt in found.doubts] == ["test 7", "test 7"]
    assert "end of the record" in " ".join(found.doubts)
    assert "begins at 0.4 N" in " ".join(found.doubts)
