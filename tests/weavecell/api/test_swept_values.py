"""No value of a sweep is lost and none is fired twice: rows are the product of the values, or one line refuses."""

from math import prod
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.scene_text import impact_scene
from weavecell.api import sweeps

# key = values that differ, some of them written in two ways
VALUES = {
    "projectile.mass": ["1 g", "2 g", "3 g", "0.002 kg"],
    "projectile.strike_velocity": ["100 m/s", "150 m/s", "0.15 km/s"],
    "panel.plies": ["1", "2", "3"],
    "panel.opening": ["50 mm", "60 mm", "5 cm"],
    "run.end_time": ["20 us", "30 us", "0.02 ms"],
    "numerics.cfl": ["0.9", "0.8", "0.90"],
    "modulus": ["1", "1.1", "0.9", "1.10"],
}
SAME = {
    "0.002 kg": "2 g",
    "0.15 km/s": "150 m/s",
    "5 cm": "50 mm",
    "0.02 ms": "20 us",
    "0.90": "0.9",
    "1.10": "1.1",
}


@pytest.fixture
def planned(monkeypatch, tmp_path):
    """Plan a sweep of a small shot: its combinations; without a forecast."""
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(impact_scene())
    monkeypatch.setattr(sweeps.SweepPlan, "forecast", lambda plan: plan.combinations, raising=True)

    def plan(over, **options):
        return wc.sweep("s.toml", over=over, check=True, **options)

    return plan


def test_rows_are_the_product_of_the_values(planned):
    """Random lists of --over: keys that come again, values that come again as the same number in another unit."""
    rng = np.random.default_rng(11)
    outcomes = set()
    for _ in range(14):
        keys = rng.choice(list(VALUES), 2, replace=False).tolist()
        over = []
        given = {key: [] for key in keys}
        for key in [*keys, keys[0]][: rng.integers(1, 4)]:
            values = rng.choice(VALUES[key], rng.integers(1, 3), replace=False).tolist()
            over.append(f"{key}={','.join(values)}")
            given[key] += values
        given = {key: values for key, values in given.items() if values}
        plain = {key: [SAME.get(value, value) for value in values] for key, values in given.items()}
        repeats = any(len(set(values)) < len(values) for values in plain.values())
        outcomes.add(repeats)
        if repeats:
            with pytest.raises(InputError, match=r"^over, ") as caught:
                planned(over)
            assert caught.value.key.removeprefix("over, ") in given
        else:
            assert len(planned(over)) == prod(map(len, given.values()))
    assert outcomes == {True, False}


def test_values_of_a_key_that_is_given_again_are_all_there(planned):
    rows = planned(["projectile.mass=1 g,2 g", "panel.plies=1,2", "projectile.mass=3 g"])
    assert [row["projectile.mass"] for row in rows] == [
        m for m in ("1 g", "2 g", "3 g") for _ in (1, 2)
    ]


@pytest.mark.parametrize(
    "over, options, line",
    [
        ("panel.plies=1,1", {}, "over, panel.plies = 1: is given twice"),
        ("panel.plies=1,2;modulus=1.1,1.10", {}, "over, modulus = 1.1: is given twice"),
        ("title=a,b", {}, "over, title = ['a', 'b']: must be left out: shot does not read it"),
        ("run.outputs=report,pictures", {}, "over, run.outputs = "),
        (
            "projectile.mass=2 g,0.002 kg",
            {},
            "over, projectile.mass = '0.002 kg': makes the same set-up as projectile mass 2 g",
        ),
        (
            "projectile.strike_velocity=100 m/s,200 m/s",
            {"quantity": "critical-velocity"},
            "over, projectile.strike_velocity = ",
        ),
        ("run.end_time=100 us,200 us", {"quantity": "v50"}, "over, run.end_time = "),
        ("numerics.threads=1,2", {}, "over, numerics.threads = 2: makes the same set-up as"),
    ],
)
def test_what_makes_no_difference_is_refused_by_name(planned, over, options, line):
    with pytest.raises(InputError) as caught:
        planned(over.split(";"), **options)
    assert str(caught.value).startswith(line)


@pytest.mark.parametrize(
    "key, number, text",
    [
        ("projectile.mass", 0.002, "2 g"),
        ("projectile.strike_velocity", 150, "0.15 km/s"),
        ("panel.opening", [0.05, 0.06], ["5 cm", "60 mm"]),
        ("projectile.obliquity", 0.25, "0.25 rad"),
        ("run.end_time", 3e-5, "3e-5 s"),
    ],
)
def test_numbers_of_python_are_in_si_units_and_those_of_a_text_need_their_unit(
    planned, key, number, text
):
    """The digests of both are the same; a text names `over`, for no line of the file has its value."""
    assert len(planned({key: [number]})) == 1
    with pytest.raises(InputError, match=f"^over, {key} = .*makes the same set-up as"):
        planned({key: [number, text]})
    if not isinstance(number, list):
        with pytest.raises(InputError, match=f"^over, {key} = .*: has no unit; must be "):
            planned([f"{key}={number}"])


def test_equal_set_ups_are_refused():
    setups = [
        wc.setup("S-720", speed, opening="20 mm", end_time="10 us") for speed in (90, 120, 90)
    ]
    with pytest.raises(InputError, match="set-up 3 is the same as set-up 1"):
        wc.sweep(setups)
