"""The study of packs: its bisection, its files, its page."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from validation.published.packs import study
from validation.published.packs.__main__ import draw
from validation.published.packs.page import by_ply, page
from validation.published.packs.study import Case, Results, onset


class Fake:
    """Packs whose first yarn fails at a known velocity."""

    def __init__(self, limit):
        self.limit, self.asked = limit, []

    def __call__(self, case):
        self.asked.append(case.velocity)
        assert case.until_failure
        return {"failed": [4.0, 0.0] if case.velocity > self.limit else [0.0, 0.0], "outcome": "in flight"}


@pytest.mark.parametrize("guess", [None, 100.0, 166.0, 250.0])
@pytest.mark.parametrize("limit", [45.0, 165.0, 240.0])
def test_onset_is_bracketed_with_or_without_a_guess(limit, guess):
    results = Fake(limit)
    assert onset(results, Case("S-726", 4, 0.0), guess=guess) == pytest.approx(limit, abs=study.TOLERANCE / 2)
    if guess is not None and abs(guess / limit - 1) < 0.04:
        assert len(results.asked) < 8


def test_what_breaks_down_has_failed():
    assert study.failed({"failed": [0.0], "outcome": "unstable"})
    assert not study.failed({"failed": [0.0], "outcome": "stopped"})


def test_shots_are_kept_and_not_fired_again(tmp_path, monkeypatch):
    fired = []
    monkeypatch.setattr(
        study, "shoot", lambda case: fired.append(case) or {"failed": [0.0], "outcome": "stopped", "time": 1e-4}
    )
    case = Case("S-728", 2, 50.0)
    for _ in range(2):
        assert Results(tmp_path, report=lambda *_, **__: None)(case)["outcome"] == "stopped"
    assert fired == [case]


def test_numbers_of_neighbouring_plies_are_drawn_together():
    assert by_ply([0.0, 0.0]) == "none"
    assert by_ply([88.0, 2.0, 2.0, 2.0, 0.0]) == "88, 3 x 2, 0"


def made_up(outcome="stopped", plies=4):
    t = np.linspace(0, 3e-4, 400)
    return {
        "outcome": outcome, "time": 2e-4, "residual_velocity": 10.0, "deflection": 0.01, "failed": [0.0] * plies,
        "peaks": [0.5] * plies, "balance": 1e-3, "deepest": 0.2, "t": t.tolist(), "v": (100 - 3e5 * t).tolist(),
        "force": (-2e3 * np.sin(2e4 * t) ** 2).tolist(), "instants": t.tolist(), "absorbed": (5e4 * t).tolist(),
    }  # fmt: skip


def test_page_and_pictures_from_results(tmp_path):
    found = {
        "outcomes": [(*row, made_up(plies=row[1])) for row in study.PUBLISHED],
        "torn": [
            {
                "case": asdict(study.Case(*row[:3])),
                "time": 1e-4,
                "failed": [7],
                "held": 3.0,
                "missed": 0.0,
                "taken": 2e-3,
                "back": [{}] * 2,
                "passages": [{}] * (row[:2] == ("S-728", 8)),
            }
            for row in study.TORN
        ],
        "stackings": {name: made_up() for name in study.STACKINGS},
        "gaps": {gap: made_up() for gap in study.GAPS},
    }
    text = page(json.loads(json.dumps({"outcomes": found["outcomes"]})) | found)
    assert "| 16 | S-726 | 243 | perforates (undecided, E-21) | **stops** |" in text
    assert "| 8 | S-728 | 340 | 100 | 7 | 3 | 0.20 | 0 | 2 | **1** |" in text
    assert (
        "**5 of the 9 computed outcomes differ from the captions.** 9 of 9 shots stop; no yarn of these fails." in text
    )
    draw(found, tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"packs-gaps.png", "packs-gap-forces.png", "packs-stacking.png"}
    assert all(f"figures/{name}" in text for name in names)
