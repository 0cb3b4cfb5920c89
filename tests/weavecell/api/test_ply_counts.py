"""`weavecell plies`, on outcomes that are drawn and not computed."""

import json

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from weavecell.report import installed
from weavecell.runs import table

pytestmark = pytest.mark.usefixtures("drawn_once")
THREAT = {"stop": "FSP 1.10 g", "at": "250 m/s", "opening": "60 mm"}
fired = []


def fake_fire(setup, velocity, draw):
    """Limits grow by the root of the plies; S-720 is stronger than its mass says."""
    fired.append((setup.fabric.name, setup.plies, draw.number))
    of_fabric = {"S-728": 112.0, "S-720": 137.0}[setup.fabric.name]
    rest = (0.61803 * (draw.number + 1) % 1.0) - 0.5
    limit = of_fabric * setup.plies**0.45 * (1 + 0.15 * rest)
    hit = velocity > limit
    more = {"drawn": {"modulus": 1 + rest}, "weakest": (0.9, 0.8), "balance": 1e-4}
    return table.Shot(velocity, 0.5 * velocity if hit else 0.0, bool(hit), draw.number, **more)


@pytest.fixture(autouse=True)
def drawn_outcomes(monkeypatch):
    fired.clear()
    monkeypatch.setattr(table, "fire", fake_fire)


LINE = 'plies S-728 S-720 --stop "FSP 1.10 g" --at "250 m/s" --opening "60 mm" --shots 12 --jobs 1 --out r'


@pytest.mark.slow(30)
def test_the_plies_of_two_fabrics_and_a_resumed_study(tmp_path, succeed):
    out = succeed(LINE)
    lines = out.splitlines()
    assert len(lines) <= 8
    assert max(map(len, lines)) <= 120
    content = json.loads((tmp_path / "r/plies.json").read_text())
    # (250 / (.94 112))^(1 / .45) = 6.8 and 4.4 plies stop nine in ten
    for name, true in (("S-728", 7), ("S-720", 5)):
        plies, low, high = content["plies_by_model"][name]
        assert low <= true <= high
        assert abs(plies - true) <= 2
    for name in ("S-728", "S-720"):
        wide, narrow = (content[key][name] for key in ("plies", "plies_by_model"))
        assert wide[2] - wide[1] > narrow[2] - narrow[1]
        assert f"{name} {wide[0]} ({wide[1]} to {wide[2]})" in out
    assert content["answer"]["value"] in out
    assert len(fired) == 24
    assert {number for *_, number in fired} == set(range(12))
    assert succeed(f"{LINE} --resume") == out
    assert len(fired) == 24
    succeed(f"{LINE} --resume".replace("--shots 12", "--shots 14"))
    assert len(fired) == 28
    loaded = wc.load(tmp_path / "r")
    assert loaded.shots["fabric"].tolist().count("S-720") == 14
    assert loaded.answer.value in str(loaded)


def test_a_test_of_the_fabric_narrows_its_count_alone():
    found = wc.plies(["S-728", "S-720"], shots=12, **THREAT)
    plies = found.counts["S-728"].plies
    velocity = found.found[0].v50(plies).value
    tested = wc.plies(
        ["S-728", "S-720"], test=f"S-728, {plies} plies: {velocity:.1f} m/s", shots=12, **THREAT
    )
    before, after = (one.counts["S-728"] for one in (found, tested))
    assert after.high - after.low < before.high - before.low
    assert tested.counts["S-720"] == found.counts["S-720"]
    assert tested.by_model == found.by_model
    assert found.found[0].by_tests == found.counts["S-728"]
    table = found.to_dataframe()
    weave = wc.fabric("S-720").weave
    assert table["areal_density_kg_m2"][1] == pytest.approx(table["plies"][1] * weave.areal_density)
    assert table["thickness_m"][1] == pytest.approx(table["plies"][1] * weave.thickness)


def test_what_is_loaded_has_the_picture_of_the_live_result(tmp_path, monkeypatch):
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    live = wc.plies(["S-728", "S-720"], shots=8, **THREAT, out=tmp_path / "r")
    loaded = wc.load(tmp_path / "r")
    drawn, again = live.plot(), loaded.plot()
    assert [one.get_title() for one in drawn.axes] == [one.get_title() for one in again.axes]
    lines = [line for one in drawn.axes for line in one.lines]
    for line, same in zip(lines, [line for one in again.axes for line in one.lines], strict=True):
        np.testing.assert_allclose(line.get_xydata(), same.get_xydata())
    plies = live.counts["S-720"].plies
    (row,) = live.shares.query(f"fabric == 'S-720' and plies == {plies}").to_dict("records")
    assert row["tested"] >= 0.9
    assert row["tested_low"] < row["tested"] < row["tested_high"]
    assert row["model_high"] - row["model_low"] < row["tested_high"] - row["tested_low"]


def test_all_outcomes_alike_are_not_determined(monkeypatch):
    monkeypatch.setattr(table, "fire", lambda *a: table.Shot(a[1], 0.0, False, a[2].number))
    found = wc.plies("S-728", shots=4, **THREAT)
    assert "not determined: all outcomes are alike" in str(found)
    assert found.counts == {}


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"sure": 1.0}, "sure = 1.0: must be a probability"),
        ({"test": "290 m/s"}, "test = '290 m/s': must be PLIES plies: V50"),
        ({"test": "S-720, 5 plies: 290 m/s"}, "must be of one of S-728"),
        ({"plies": 4}, "plies = 4: must be left out"),
        ({"projectile": "sphere 5.5 mm"}, "must be given as stop"),
        ({"fabrics": ["S-728", "S-728"]}, "each once"),
        (
            {"fabrics": "Dyneema HB26 laminate"},
            "fabrics = 'Dyneema HB26 laminate': is no woven fabric",
        ),
        ({"fabrics": ["S-728", "Kevlar UD"]}, "is no woven fabric"),
    ],
)
def test_what_cannot_be_asked_is_refused(changes, words):
    given = {"fabrics": "S-728", **THREAT, **changes}
    with pytest.raises(InputError) as problem:
        wc.plies(given.pop("fabrics"), **given)
    assert words in str(problem.value)
    assert "\n" not in str(problem.value)
    assert fired == []
