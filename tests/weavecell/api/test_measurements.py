"""`weavecell next`: what to measure first, on outcomes whose limits are made."""

import json
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.door import open_terminal
from fabrics.base.errors import InputError
from weavecell.report import installed
from weavecell.runs import go_no_go, table
from weavecell.runs.measurement import Count, Measurement
from weavecell.runs.span import Span
from weavecell.studies import strengths

SMALL = {"opening": "50 mm", "elements_per_crossover": 1}
SLOPES = {"friction on the nose": 0.5, "friction between yarns": 0.08, "place": 0.05}
MIDDLE = 104.0


def fake_fire(setup, velocity, draw):
    """Limits follow from the friction on the nose above all."""
    known = strengths.draw_known(setup, draw.seed, draw.number)
    moved = sum(slope * known.get(name, 0.0) for name, slope in SLOPES.items())
    middle = MIDDLE * setup.plies**0.45
    limit = middle * (1 + moved + 0.03 * np.sin(40.0 * draw.number + 1))
    hit = bool(velocity > limit)
    return table.Shot(velocity, 0.4 * velocity if hit else 0.0, hit, draw.number, balance=1e-4)


@pytest.fixture(autouse=True)
def made_limits(monkeypatch, tmp_path):
    monkeypatch.setattr(table, "fire", fake_fire)
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    monkeypatch.chdir(tmp_path)


def check_one_truth(result, succeed):
    """Live, loaded, JSON, terminal and the line `next` of the answer have one list."""
    live = wc.measure_first(result)
    read = wc.measure_first("r")
    assert read.found == live.found
    assert read.answer == live.answer
    (content,) = (
        json.loads(path.read_text())
        for path in Path("r").glob("*.json")
        if "measure_first" in path.read_text()
    )
    assert [Measurement.read(one) for one in content["measure_first"]] == list(live.found)
    assert read.to_dataframe().to_dict("list") == live.to_dataframe().to_dict("list")
    printed = succeed("next r").splitlines()
    assert len(printed) <= 8
    assert max(map(len, printed)) <= 120
    with open_terminal():
        assert printed[:-1] == str(live).splitlines()
    lefts = [one.left for one in live.found]
    assert lefts == sorted(lefts)
    assert wc.measure_first(wc.load("r")).found == live.found
    told = next(iter(result.answer.advice), "")
    assert (live.found[0].is_worth and told == live.found[0].advice) or not told
    return live


def test_what_moves_v50_most_is_measured_first(succeed):
    result = wc.v50("S-728", shots=24, **SMALL, out="r")
    live = check_one_truth(result, succeed)
    first, second = live.found
    assert (first.quantity, first.key) == ("friction on the nose", "projectile.friction")
    assert (second.quantity, second.command) == ("friction between yarns", "reduce pull-out")
    assert first.known == pytest.approx(0.1 * 0.2)
    assert first.known_words == "± 0.02"
    # over cloths, by the plane itself
    uniform = np.random.default_rng(1).uniform(-0.5, 0.5, (2, 20_000))
    weights = np.array([[SLOPES["friction on the nose"]], [SLOPES["friction between yarns"]]])
    widths = [
        np.ptp(np.quantile((weights * share * uniform).sum(axis=0), (0.05, 0.95)))
        for share in (np.ones((2, 1)), np.array([[0.2], [1.0]]))
    ]
    assert 2 * first.now.half == pytest.approx(MIDDLE * widths[0], rel=0.25)
    assert first.left == pytest.approx(widths[1] / widths[0], abs=0.2)
    assert second.left > 0.9


def test_what_moves_the_share_of_drawn_shots_is_measured_first(succeed):
    options = {"opening": "20 mm", "end_time": "6 us", "elements_per_crossover": 1}
    result = wc.impact("S-728", f"{MIDDLE} m/s", draws=24, **options, out="r")
    live = check_one_truth(result, succeed)
    first = live.found[0]
    assert (first.quantity, first.unit) == ("friction on the nose", "")
    assert 0 <= first.now.low < first.then.low < first.then.value < first.then.high <= 1
    assert first.words(Span(0.25, 0.031, 0.8)) == "25 % (3 to 80)"


def test_an_own_test_of_v50_and_frictions_of_a_pack(succeed):
    threat = {"stop": "FSP 1.10 g", "at": "150 m/s", "opening": "50 mm", "shots": 8}
    result = wc.plies("S-728", **threat, out="r")
    live = check_one_truth(result, succeed)
    plies = result.counts["S-728"].plies
    own = next(one for one in live.found if one.quantity.startswith("V50"))
    assert own.now == Span(*result.counts["S-728"])
    assert own.command == f"plies --test 'S-728, {plies} plies: V50'"
    text = f"S-728, {plies} plies: {result.found[0].v50(plies).value} m/s"
    again = wc.plies("S-728", test=text, **threat).counts["S-728"]
    assert Span(*again) == own.then
    assert own.words(Span(*again)) == Count(*again).words()


def test_the_share_of_a_cloth_that_passes_is_that_of_its_shots():
    """Of made panels: places differ from shot to shot, frictions do not."""
    rows = np.random.default_rng(2).uniform(-0.5, 0.5, (4000, 2))
    names = ("place", "friction on the nose")
    middle, slopes, scatter = np.full(1, 90.0), np.array([[0.1, 0.3]]), np.full(1, 0.05)
    posterior = go_no_go.LimitPosterior(names, middle, slopes, scatter, rows, (False, True), 1.0)
    found = posterior.cloths_passed(84.0)
    random = np.random.default_rng(3)
    limits = 90 * (
        1
        + 0.3 * rows[:400, 1:]
        + 0.1 * random.uniform(-0.5, 0.5, (400, 2000))
        + 0.05 * random.standard_normal((400, 2000))
    )
    shares = (84.0 > limits).mean(axis=1)
    assert found == pytest.approx(np.quantile(shares, (0.5, 0.05, 0.95)), abs=0.04)
    assert posterior.narrow("place", 0.2).cloths() == pytest.approx(posterior.cloths())


def test_outcomes_that_are_all_alike_tell_nothing(monkeypatch, succeed):
    monkeypatch.setattr(table, "fire", lambda _, v, draw: table.Shot(v, 0.0, False, draw.number))
    wc.v50("S-728", shots=4, **SMALL, out="r")
    assert wc.measure_first("r").found == ()
    assert "not determined" in succeed("next r")


def test_what_has_no_drawn_shots_is_refused():
    shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", out="shot")
    for wrong in (shot, "shot", wc.biaxial("S-720", ratio=["1:1"])):
        with pytest.raises(InputError, match="must be a result of v50 or plies"):
            wc.measure_first(wrong)
    with pytest.raises(InputError, match="is not there"):
        wc.measure_first("nowhere")


@pytest.mark.parametrize("fabrics", [1, 3])
@pytest.mark.parametrize("found", [1, 3, 4, 9])
def test_what_is_printed_is_short_however_many_narrow_an_answer(fabrics, found):
    now, then = Span(103.0, 83.0, 126.0), Span(103.0, 93.0, 113.0)
    made = [
        Measurement(
            f"V50 of fabric {number % fabrics}", now, then, "m/s", "friction between plies",
            0.01, "", "sled of fabric on fabric", key="panel.ply_friction",
        )
        for number in range(found)
    ]  # fmt: skip
    lines = str(wc.MeasureFirst("plies that stop FSP 1.10 g at 70 m/s", tuple(made))).splitlines()
    assert len(lines) <= 8
    assert max(map(len, lines)) <= 120
    assert sum(len(line.split()) for line in lines) <= 110
    unlisted = found - 3
    assert (f"{unlisted} more narrow it less" in lines[1]) == (unlisted > 0)
