"""Records of compression and of flight: what was put in comes out, with intervals that hold it."""

import numpy as np
import pytest

from fabrics.base.errors import InputError
from weavecell.studies import compression_records as compression
from weavecell.studies import displacement_record as displacement
from weavecell.studies.compression_records import CompressionRecord, PressureLaw

AREA = 0.019**2
PEAK = 7000.0
TRIALS = 40


def record(K, n, start, noise, seed, rows=120):
    """A record of P = K / (t - t_min)^n, zeroed at its first load, with noise on it."""
    load = np.geomspace(start, PEAK, rows)
    left = (K * AREA / load) ** (1 / n)
    off = noise * np.random.default_rng(seed).standard_normal(rows)
    return CompressionRecord(load, left[0] - left + off, "made")


@pytest.mark.parametrize("K, n, start", [(1.1e-7, 3.0, 10.0), (6.4e-12, 4.5, 25.0)])
def test_a_law_with_noise_comes_back_within_its_intervals(K, n, start):
    """95 % intervals hold the law of 33 to 40 of 40 records."""
    true = {"stiffness": K, "exponent": n, "full": (K * AREA / start) ** (1 / n)}
    inside = dict.fromkeys(true, 0)
    for seed in range(TRIALS):
        law = PressureLaw.fit(record(K, n, start, 1e-6, seed), AREA, 1)
        for name, (low, high) in law.intervals().items():
            inside[name] += low <= true[name] <= high
        assert law.rms == pytest.approx(1e-6, rel=0.3)
    assert min(inside.values()) >= 33


def test_without_noise_the_law_is_exact():
    law = PressureLaw.fit(record(2.4e-7, 3.3, 14.0, 0.0, 0), AREA, 1)
    assert law.stiffness == pytest.approx(2.4e-7, rel=1e-6)
    assert law.exponent == pytest.approx(3.3, rel=1e-7)
    pressure, closed = law.curve()
    assert closed[0] == 0
    assert np.all(np.diff(closed) > 0)
    assert pressure[[0, -1]] * AREA == pytest.approx([14.0, PEAK])


def test_the_rig_is_taken_off_at_each_load(tmp_path):
    """A rig that closes by a law of its own, measured at other loads; unloading is left out; other units."""

    def rig(F):
        return 3e-8 * F + 2e-6 * np.log1p(F / 70)

    ply = record(1.1e-7, 3.0, 12.0, 0.0, 0)
    load = np.concatenate([ply.load, np.linspace(6500, 50, 9)])
    closed = np.concatenate([ply.closed, np.full(9, 1e-4)]) + rig(load)
    rows = "\n".join(f"{1e-3 * F:.12g}, {1e6 * d:.12g}" for F, d in zip(load, closed))
    (tmp_path / "one.csv").write_text("# unloading too\nforce [kN], displacement [um]\n" + rows)
    at = np.geomspace(5, 8000, 4000)
    bare = CompressionRecord(at, rig(at), "rig")
    read = CompressionRecord.read(tmp_path / "one.csv")
    assert len(read.load) == len(ply.load)
    assert read.without(bare).closed == pytest.approx(ply.closed, abs=2e-10)
    mixed = np.random.default_rng(4).permutation(len(at))  # a rig that was loaded more than once
    unsorted = CompressionRecord(at[mixed], rig(at[mixed]), "rig")
    assert read.without(unsorted).closed == pytest.approx(ply.closed, abs=2e-10)
    short = CompressionRecord(at[at < 3000], rig(at[at < 3000]), "rig")
    with pytest.raises(InputError, match="force = '12 to 7000 N': must be within those of the rig"):
        read.without(short)


def test_gap_and_force_law_are_those_of_the_equations():
    """Eqs. 5-4 and 2-7 to 2-9, of records that begin at other loads."""
    K1, K4 = 1.14e-7, 4.6e-6
    one = PressureLaw.fit(record(K1, 3.0, 9.0, 0.0, 0), AREA, 1, 3.0)
    four = PressureLaw.fit(record(K4, 3.0, 15.0, 0.0, 0), AREA, 4, 3.0)
    span = (15.0 / AREA) ** (-1 / 3) - (PEAK / AREA) ** (-1 / 3)
    gap = compression.gap_between(one, four)
    assert gap.value == pytest.approx((np.cbrt(K4) - np.cbrt(K1)) * span / 3, rel=1e-6)
    cell = 1.5e-3 * 1.3e-3
    law = compression.force_law(one, cell)
    for F in (0.5, 8.0):
        closed = law["a"].value - law["b"].value / np.cbrt(F)
        assert closed == pytest.approx(one.at(F / cell), rel=1e-6)


@pytest.mark.parametrize(
    "rows, line",
    [
        ("1, 1\n2, 2\n", "rows = 2: must be at least 10 up to the largest force"),
        ("".join(f"{n}, {n}\n" for n in range(12)), "line 2, force = '0 N': must be above 0"),
    ],
)
def test_a_record_that_cannot_be_reduced_is_refused(tmp_path, rows, line):
    path = tmp_path / "one.csv"
    path.write_text("force [N], displacement [mm]\n" + rows)
    with pytest.raises(InputError, match=line):
        CompressionRecord.read(path)


MASS = 3e-3
TIME = np.arange(0, 300e-6, 1e-6)


def flight(t):
    """(displacement, velocity, acceleration): a drag that rises and falls, and a slow oscillation."""
    slow, fast = 2 * np.pi / 1.1e-3, 2 * np.pi * 6e3
    z = 90 * np.sin(slow * t) / slow + 5e-5 * (1 - np.cos(fast * t))
    v = 90 * np.cos(slow * t) + 5e-5 * fast * np.sin(fast * t)
    return z, v, -90 * slow * np.sin(slow * t) + 5e-5 * fast**2 * np.cos(fast * t)


@pytest.mark.parametrize("bandwidth", [None, 25e3])
def test_a_flight_with_noise_comes_back_within_its_errors(bandwidth):
    """Velocity, energy and force of nine in ten instants, over five records; no error is needlessly large."""
    z, v, a = flight(TIME)
    inside = []
    for seed in range(5):
        noise = 1e-5 * np.random.default_rng(seed).standard_normal(len(TIME))
        motion = displacement.reduce(TIME, z + noise, MASS, bandwidth)
        assert motion.noise == pytest.approx(1e-5, rel=0.15)
        energy = 0.5 * MASS * v**2
        inside.append(
            [
                np.mean(abs(motion.velocity - v) <= motion.velocity_error),
                np.mean(abs(motion.energy - energy) <= motion.energy_error),
                np.mean(abs(motion.force + MASS * a) <= motion.force_error),
            ]
        )
    assert np.mean(inside, axis=0).min() > 0.9
    assert motion.velocity_error[150] < 1.0


def test_half_of_an_oscillation_of_the_bandwidth_passes():
    """And the bandwidth that cross-validation chose is that of its curve: given, it makes the same one."""
    frequency = 9e3
    z = 1e-3 * np.sin(2 * np.pi * frequency * TIME)
    motion = displacement.reduce(TIME, z, MASS, frequency)
    middle = slice(100, 200)
    assert np.ptp(motion.displacement[middle]) / np.ptp(z[middle]) == pytest.approx(0.5, abs=0.03)
    noise = 1e-5 * np.random.default_rng(3).standard_normal(len(TIME))
    chosen = displacement.reduce(TIME, flight(TIME)[0] + noise, MASS)
    given = displacement.reduce(TIME, flight(TIME)[0] + noise, MASS, chosen.bandwidth)
    assert given.velocity == pytest.approx(chosen.velocity, rel=1e-3)


def test_a_bandwidth_that_the_record_does_not_resolve_is_refused():
    for wrong in (1e3, 1e6):
        with pytest.raises(InputError, match=r"bandwidth = .* Hz': must be between 3.34e"):
            displacement.reduce(TIME, flight(TIME)[0], MASS, wrong)
