"""Reduction of displacement records: exact where it can be, and within its stated error where there is noise."""

import csv

import numpy as np
import pytest

from fabrics.errors import InputError
from weavecell.analysis.displacement_record.__main__ import write, write_shots
from weavecell.analysis.displacement_record.record import Record
from weavecell.analysis.displacement_record.reduction import reduce

MASS = 3e-3


def arrested(dt=1e-6, V=100.0, time=120e-6, end=450e-6):
    """(t, x, v, a) of a projectile that flies, is decelerated smoothly, and stops."""
    t = np.arange(-60e-6, end, dt)
    s = np.maximum(t, 0) / time
    v = V * (1 + s + s**2 / 2) * np.exp(-s)
    x = V * time * (3 - (3 + 2 * s + s**2 / 2) * np.exp(-s)) + V * np.minimum(t, 0)
    a = -V / time * s**2 / 2 * np.exp(-s)
    return t, x, v, a


def test_a_cubic_is_reduced_exactly():
    t = np.arange(400) * 1e-6
    x = 100 * t - 2e5 * t**2 + 3e8 * t**3
    found = reduce(Record(t, x), MASS, window=40e-6)
    assert np.allclose(found.v, 100 - 4e5 * t + 9e8 * t**2, rtol=1e-9)
    assert np.allclose(found.a, -4e5 + 18e8 * t, rtol=1e-6, atol=1)
    assert found.v_smoothing.max() < 1e-6
    assert found.noise < 1e-12


@pytest.mark.parametrize("noise", [2e-6, 20e-6, 100e-6])
def test_errors_cover_what_noise_and_smoothing_do(noise):
    t, x, v, a = arrested()
    rng = np.random.default_rng(11)
    inside_v, inside_a = [], []
    for _ in range(8):
        found = reduce(Record(t, x + noise * rng.standard_normal(t.size)), MASS)
        assert found.noise == pytest.approx(noise, rel=0.2)
        inside_v.append(np.mean(np.abs(found.v - v) <= found.v_error))
        inside_a.append(np.mean(np.abs(found.a - a) <= found.a_error))
    assert 0.90 < np.mean(inside_v) <= 1.0
    assert 0.88 < np.mean(inside_a) <= 1.0


def test_the_window_widens_with_noise_and_beats_fixed_ones():
    t, x, v, _ = arrested()
    rng = np.random.default_rng(5)
    quiet, loud = (reduce(Record(t, x + s * rng.standard_normal(t.size)), MASS) for s in (2e-6, 100e-6))
    assert loud.windows[0] > 1.5 * quiet.windows[0]
    record = Record(t, x + 20e-6 * rng.standard_normal(t.size))
    best = np.sqrt(np.mean((reduce(record, MASS).v - v) ** 2))
    for window in (15e-6, 240e-6):
        assert np.sqrt(np.mean((reduce(record, MASS, window=window).v - v) ** 2)) > best


def test_a_window_that_is_too_wide_is_told():
    """A step of velocity cannot be followed: the smoothing error has to say so."""
    t = np.arange(-200, 400) * 1e-6
    x = np.where(t < 100e-6, 100 * t, 0.01 + 40 * (t - 100e-6))
    found = reduce(Record(t, x), MASS, window=60e-6)
    v = np.where(t < 100e-6, 100.0, 40.0)
    near = np.abs(t - 100e-6) < 15e-6
    assert found.v_smoothing[near].max() > 5
    assert found.v_smoothing[t < 0].max() < 1e-3
    assert np.mean(np.abs(found.v - v)[~near] <= found.v_error[~near] + 1e-9) > 0.85


def test_strike_residual_and_energies():
    t, x, _, _ = arrested(end=1500e-6)
    rng = np.random.default_rng(3)
    found = reduce(Record(t, x + 10e-6 * rng.standard_normal(t.size)), MASS)
    assert abs(found.strike[0] - 100) <= 1.5 * found.strike[1]
    assert found.stopped
    assert found.absorbed[-100:].mean() == pytest.approx(0.5 * MASS * 100**2, rel=1e-2)
    through = reduce(Record(t, 150 * t + 10e-6 * rng.standard_normal(t.size)), MASS)
    assert not through.stopped
    assert abs(through.residual[0] - 150) <= through.residual[1]
    assert abs(through.absorbed[500]) <= through.absorbed_error[500]


def test_force_is_what_decelerates():
    t, x, _, a = arrested()
    found = reduce(Record(t, x), MASS)
    assert np.abs(found.a - a).max() < 0.03 * np.abs(a).max()


def test_records_are_read_with_their_units(tmp_path):
    path = tmp_path / "shot.csv"
    rows = "\n".join(f"{k * 0.5},{k * 0.05}" for k in range(60))
    path.write_text(f"# a comment\ntime [us], displacement [mm]\n{rows}\n")
    record = Record.read(path)
    assert record.dt == pytest.approx(0.5e-6)
    assert record.x[10] == pytest.approx(0.5e-3)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("time [us], displacement [mm]\n0,0\n1,1\n", "50"),
        ("time [us], displacement [kg]\n" + "0,0\n" * 60, "displacement"),
        ("time [us], height [mm]\n" + "0,0\n" * 60, "heading"),
        ("time [us], displacement [mm]\n" + "".join(f"{k},{k}\n" for k in range(60)) + "60,x\n", "line 62"),
        ("time [us], displacement [mm]\n" + "".join(f"{k},{k}\n" for k in range(60)) + "75,60\n", "even"),
        ("time [us], displacement [mm]\n" + "".join(f"{k},{k}\n" for k in range(60)) + "60,nan\n", "finite"),
    ],
)
def test_bad_records_are_refused(tmp_path, text, told):
    path = tmp_path / "shot.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        Record.read(path)
    assert "shot.csv" in str(caught.value)


def test_bad_arguments_are_refused():
    record = Record(*arrested()[:2])
    with pytest.raises(InputError, match="mass"):
        reduce(record, 0.0)
    for window in (1e-6, 1e-3):
        with pytest.raises(InputError, match="window"):
            reduce(record, MASS, window=window)


def test_tables_are_written(tmp_path):
    t, x, _, _ = arrested(end=1500e-6)
    found = reduce(Record(t, x + 10e-6 * np.random.default_rng(2).standard_normal(t.size)), MASS)
    write(found, tmp_path / "reduced.csv")
    write_shots({"one": found}, tmp_path / "shots.csv")
    rows = list(csv.reader((tmp_path / "reduced.csv").read_text("utf-8").splitlines()))
    assert len(rows) == t.size + 1
    assert float(rows[100][2]) == pytest.approx(found.v[99], rel=1e-6)
    shots = list(csv.DictReader((tmp_path / "shots.csv").read_text("utf-8").splitlines()))
    assert shots[0]["outcome"] == "stopped"
    assert float(shots[0]["strike energy [J]"]) == pytest.approx(15.0, rel=1e-2)
