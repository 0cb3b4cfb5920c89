"""The study of friction between plies: its bisection, its table, its page and picture."""

import pytest

from fabrics.errors import UndecidedError
from validation.program import save
from validation.published import ply_friction as study
from validation.published.ply_friction import answer, change


class Fake:
    """Packs whose first failure and ballistic limit rise with friction."""

    def __init__(self, onset=150.0, limit=230.0, outcome=None):
        self.onset, self.limit, self.outcome, self.fired = onset, limit, outcome, []

    def __call__(self, case):
        rise = 1 + 0.3 * case.friction
        self.fired.append(case)
        if case.until_failure:
            return {"failed": [float(case.velocity > rise * self.onset)], "outcome": "in flight"}
        through = case.velocity > rise * self.limit
        return {
            "case": {"velocity": case.velocity}, "outcome": self.outcome or ("perforated" if through else "stopped"),
            "time": 1e-3, "rubbed": 0.1 * case.friction, "balance": 1e-3,
        }  # fmt: skip


@pytest.mark.parametrize("guess", [100.0, 228.0, 232.0, 390.0])
def test_the_ballistic_limit_is_bracketed_from_any_guess(guess):
    fired = study.bracket(Fake(), study.Case("S-726", 4, 0.0), guess)
    stop = max(one["case"]["velocity"] for one in fired if one["outcome"] == "stopped")
    through = min(one["case"]["velocity"] for one in fired if one["outcome"] == "perforated")
    assert stop <= 230.0 < through
    assert through - stop <= study.TOLERANCE
    assert len(fired) < 16


def test_a_guard_counts_as_a_perforation_and_a_shot_in_flight_as_nothing():
    assert study.perforates({"outcome": "unstable"})
    assert not study.perforates({"outcome": "stopped"})
    with pytest.raises(UndecidedError, match="neither stopped nor perforated"):
        study.bracket(Fake(outcome="in flight"), study.Case("S-726", 4, 0.0), 100.0)


def test_page_and_picture(tmp_path):
    fake = Fake()
    found = {"S-726": study.study(fake, "S-726")}
    assert [one.friction for one in found["S-726"]] == list(study.FRICTIONS)
    last = found["S-726"][-1]
    assert last.onset == pytest.approx(1.09 * 150, abs=1.0)
    assert last.limit == pytest.approx(1.09 * 230, abs=0.6 * study.STRIDE * 230)
    assert last.perforation - last.stop == pytest.approx(study.STRIDE * 230, abs=0.3)
    assert found["S-726"][0].limit == pytest.approx(230, abs=0.6 * study.STRIDE * 230)
    assert last.rubbed == pytest.approx(0.03)
    text = f"{study.rows(found)}{answer(found)}"
    assert "| S-726 | 0 | 150." in text
    assert "3.00 | 0.10 | 0 |" in text
    assert change(163.5, 150.0) == "+9.0 %"
    assert "which reproduces it" in text  # +9 % at a coefficient of 0.3
    save(study.chart, found, to=tmp_path / "chart.png")
    assert (tmp_path / "chart.png").stat().st_size > 10_000


def test_a_small_change_of_the_limit_does_not_reproduce_the_literature():
    still = study.Found(0.0, 150.0, 230.0, 232.0, 228.0, 0.0, 1e-3, 0)
    moved = study.Found(0.3, 150.0, 233.0, 235.0, 231.0, 0.0, 1e-3, 0)
    assert "which does not reproduce it" in answer({"S-726": [still, moved]})
    lowered = study.Found(0.3, 150.0, 210.0, 212.0, 208.0, 0.0, 1e-3, 0)
    text = answer({"S-726": [still, lowered]})
    assert "which has the opposite sign" in text
    assert "+53.3 % without friction, +40.0 % at 0.3" in text


def test_a_zone_of_mixed_outcomes_has_its_limit_in_the_middle():
    outcomes = ["stopped"] * 5 + ["perforated", "stopped", "unstable", "stopped"] + ["perforated"] * 5
    fired = [
        {"case": {"velocity": 100.0 + 2 * n}, "outcome": outcome, "rubbed": 0.01 * n, "balance": 1e-3}
        for n, outcome in enumerate(outcomes)
    ]
    found = study.summed(0.2, 90.0, fired)
    assert (found.perforation, found.stop, found.unstable) == (110.0, 116.0, 1)
    assert found.limit == pytest.approx(113.0)
    assert found.rubbed == pytest.approx(0.08)
