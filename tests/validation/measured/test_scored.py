"""Predictions by drawn shots, held against tests: scores of made data, and what a row of scored.csv has."""

from dataclasses import replace
from math import exp, pi, sqrt
from types import SimpleNamespace as Given

import numpy as np
import pytest
from scipy.special import ndtr

from fabrics.base.errors import InputError
from validation.measured import predictions, rows, scored, scores
from validation.measured.predictions import Prediction
from weavecell.runs import go_no_go, v50
from weavecell.runs.go_no_go import Outcomes
from weavecell.runs.table import Shot

ROWS = {row.id: row for row in rows.read()}


@pytest.mark.parametrize("z", [0.0, -1.3, 2.1])
def test_crps_is_that_of_a_normal_distribution(z):
    """sigma (z (2 Phi(z) - 1) + 2 phi(z) - pi^(-1/2)), Gneiting and Raftery (2007), eq. 21."""
    draws = 100 + 5 * np.random.default_rng(3).standard_normal(20000)
    density = exp(-0.5 * z * z) / sqrt(2 * pi)
    expected = 5 * (z * (2 * ndtr(z) - 1) + 2 * density - 1 / sqrt(pi))
    found = scores.score(draws, 100 + 5 * z, 0.0)
    assert found.crps == pytest.approx(expected, rel=0.03)
    assert found.rank == pytest.approx(ndtr(z), abs=0.01)


def test_a_single_run_is_scored_by_how_far_it_is_off():
    assert scores.score(np.array([117.0]), 103.0, 0.0) == scores.Score(0.0, 14.0)


@pytest.mark.parametrize("error", [0.0, 3.0])
def test_numbers_drawn_as_the_prediction_and_its_test_lie_in_its_intervals(error):
    draw = np.random.default_rng(1)
    found = []
    for _ in range(400):
        truth = 100 + 5 * draw.standard_normal() + error * draw.standard_normal()
        found.append(scores.score(100 + 5 * draw.standard_normal(200), truth, error))
    assert np.mean([one.is_inside(0.5) for one in found]) == pytest.approx(0.5, abs=0.08)
    assert np.mean([one.is_inside(0.9) for one in found]) == pytest.approx(0.9, abs=0.05)


def test_a_coin_has_a_quarter_and_the_bold_lose_more():
    assert scores.brier(0.5, True) == scores.brier(0.5, False) == scores.COIN
    assert scores.brier(0.9, True) == pytest.approx(0.01)
    assert scores.brier(0.9, False) == pytest.approx(0.81)


NAMES = ("friction between yarns", "strength after weaving")


def made_test(draw, shots):
    """Fit the limits of made shots of a made truth, and test one cloth of it: (V50 of cloths, that of the cloth)."""
    middle = 100 * exp(0.2 * draw.standard_normal())
    slopes = 0.12 * draw.standard_normal(2)
    known = draw.random((shots, 2)) - 0.5
    limits = middle * (1 + known @ slopes + 0.05 * draw.standard_normal(shots))
    velocity = middle * (1 + 0.15 * (2 * draw.random(shots) - 1))
    outcomes = Outcomes(NAMES, known, velocity, velocity > limits)
    posterior = go_no_go.fit(outcomes, 110.0, draw.random((32, 2)) - 0.5, draws=512)
    return predictions.pair_cloths(posterior), middle * (1 + (draw.random(2) - 0.5) @ slopes)


def test_made_cloths_lie_in_the_interval_of_their_v50():
    draw = np.random.default_rng(5)
    ranks = [scores.score(*made_test(draw, 16), 0.0).rank for _ in range(40)]
    inside = np.mean([abs(rank - 0.5) <= 0.45 for rank in ranks])
    assert 0.8 <= inside <= 1.0
    assert 0.3 < np.mean(ranks) < 0.7


def test_all_that_is_common_to_a_cloth_spreads_its_v50(monkeypatch):
    """Limits of made shots go with the strength after weaving, of which `v50` itself knows nothing."""
    monkeypatch.setattr(v50, "POPULATION", 64)
    setup = ROWS["S-726 V50"].case.resolved()
    known = predictions.list_known(setup, 96, 1)
    # one of each is drawn anew for each shot, and no property of a cloth
    assert {"strength after weaving", "crimp of the weft", "friction on the nose"} <= set(known)
    assert "strength of yarns" not in known
    limits = 104 * (1 + 0.3 * known["strength after weaving"])
    velocity = 104 + 18 * np.sin(np.arange(96.0))
    shots = [
        Shot(float(V), 0.0, bool(V > limit), number=n)
        for n, (V, limit) in enumerate(zip(velocity, limits))
    ]
    monkeypatch.setattr(v50, "study", lambda *_, **__: Given(shots=shots))
    monkeypatch.setattr(predictions.ballistic_limit, "first_guess", lambda _: 120.0)
    found, posterior = predictions.fit_cloths(setup, len(shots), 1, {})
    assert found == shots
    slope = dict(zip(posterior.names, np.median(posterior.slopes, axis=0)))
    assert max(slope, key=lambda name: abs(slope[name])) == "strength after weaving"
    assert slope["strength after weaving"] == pytest.approx(0.3, rel=0.25)
    low, high = np.quantile(predictions.pair_cloths(posterior), (0.05, 0.95))
    assert high - low > 0.7 * 0.9 * 0.3 * 104


def test_a_growth_is_of_the_same_cloths():
    """Two packs whose limits go alike with what is common to a cloth: their ratio does not."""
    known = np.linspace(-0.5, 0.5, 32)[:, None]
    posterior = go_no_go.fit(
        Outcomes(NAMES[:1], known, np.full(32, 200.0), known[:, 0] < 0), 200.0, known, draws=256
    )
    alike = replace(posterior, middle=np.full(256, 200.0), slopes=np.full((256, 1), 0.4))
    below = replace(alike, middle=np.full(256, 130.0))
    ratio = predictions.pair_cloths(alike) / predictions.pair_cloths(
        below, np.random.default_rng(2)
    )
    assert ratio == pytest.approx(200 / 130)


DRAWS = Prediction(np.linspace(90, 130, 401), 16, 7, "place drawn", 12.5)


def test_a_number_is_scored_and_an_outcome_told(monkeypatch):
    monkeypatch.setattr(scored.origin, "commit", lambda: "0123456789ab")
    number = scored.score_row(ROWS["S-726 V50"], DRAWS)
    assert [number[name] for name in scores.QUANTILES] == ["92", "100", "110", "120", "128"]
    assert (number["inside 90 %"], number["inside 50 %"], number["Brier"]) == ("yes", "yes", "")
    seen = scored.score_row(
        ROWS["S-726 at 110 m/s"], replace(DRAWS, values=np.array([0.3, 0.4, 0.6]))
    )
    assert float(seen["perforated [%]"]) == pytest.approx(100 * 7.5 / 17, rel=1e-3)
    assert float(seen["Brier"]) == pytest.approx((1 - 7.5 / 17) ** 2, rel=1e-3)
    assert seen["rank"] == ""
    none = scored.score_row(ROWS["S-726 V50"], replace(DRAWS, values=np.zeros(0), perforated=0))
    assert none["why none"] == "all 16 shots stop: the limit is not known"
    assert none["rank"] == none["CRPS [%]"] == ""


def test_the_sentence_counts_what_is_drawn():
    blank = dict.fromkeys((*scored.DRAWN, "quantity", "cloth", "measured"), "")
    ply = blank | {"quantity": "V50 of one ply", "measured": "100", "50 %": "112", "shots": "16"}
    table = [
        ply
        | {"cloth": "A", "rank": "0.02", "inside 90 %": "no", "inside 50 %": "no", "CRPS [%]": "9"},
        ply
        | {
            "cloth": "A",
            "quantity": "other",
            "rank": "0.4",
            "inside 90 %": "yes",
            "inside 50 %": "yes",
            "CRPS [%]": "2",
        },
        blank | {"quantity": "inferred outcome", "shots": "4", "Brier": "0.05"},
        blank | {"quantity": "outcome", "shots": "4", "Brier": "0.35"},
    ]
    text = scores.write_sentence(table)
    assert text == (
        "Of 2 numbers from 1 cloth 1 lies in the 90 % interval; 2 outcomes (1 inferred) by Brier 0.20 (coin 0.25); "
        "one ply is 12 % too strong."
    )
    assert scores.write_sentence([*table, blank]).endswith("4 of 5 rows, 4 shots or more each.")
    assert scores.write_sentence([blank]) == "Nothing is drawn yet. Drawn so far: 0 of 1 rows."


def test_rows_are_written_one_by_one_and_kept(monkeypatch, tmp_path):
    """A run that ends in its second row leaves the first, and keeps what stood there before."""
    done = []

    def predict(case, shots, folder, jobs):
        if done:
            raise KeyboardInterrupt
        done.append(case)
        return replace(DRAWS, shots=shots)

    monkeypatch.setattr(scored, "predict", predict)
    with pytest.raises(KeyboardInterrupt):
        scored.main(["S-726 at"], quick=True, out=tmp_path)
    first = {row["id"]: row for row in scored.csv_file.read(tmp_path / "scored.csv")[1]}
    assert [id for id, row in first.items() if row["shots"]] == ["S-726 at 96 m/s"]
    done.clear()
    with pytest.raises(KeyboardInterrupt):
        scored.main(["S-726 at 1"], shots=5, out=tmp_path)
    second = {row["id"]: row for row in scored.csv_file.read(tmp_path / "scored.csv")[1]}
    assert second["S-726 at 96 m/s"] == first["S-726 at 96 m/s"]
    assert second["S-726 at 110 m/s"]["shots"] == "5"
    with pytest.raises(InputError, match="at least 4"):
        scored.main(shots=3, out=tmp_path)
    with pytest.raises(InputError, match="moon"):
        scored.main(["moon"], out=tmp_path)


def test_every_test_of_plies_and_packs_names_its_cloth():
    for row in ROWS.values():
        if row.case and row.level in scored.LEVELS:
            assert row.cloth, row.id
            assert row.case.measure in {*rows.OF_SHOTS, "v50", "limit", "growth"}
            if row.case.measure == "outcome":
                inferred = row.quantity.startswith(scores.INFERRED)
                assert inferred == row.assumed.startswith("that the "), row.id


def test_the_picture_sorts_numbers_by_rank_and_tells_inferred_outcomes(tool):
    blank = dict.fromkeys((*scored.DRAWN, "unit", "cloth", "single run"), "")
    levels = ("80", "95", "104", "112", "131")
    spread = dict(zip(scores.QUANTILES, levels)) | {"measured": "100", "sigma": "4", "shots": "16"}
    shares = dict(zip(scores.QUANTILES, ("0.1", "0.2", "0.3", "0.4", "0.6")))
    seen = shares | {"measured": "stopped", "Brier": "0.09", "shots": "4"}
    table = [
        blank | spread | {"id": "high", "rank": "0.9", "inside 90 %": "yes", "single run": "97"},
        blank | spread | {"id": "low", "rank": "0.02", "inside 90 %": "no"},
        blank | seen | {"id": "told", "quantity": "outcome of one ply"},
        blank | seen | {"id": "guessed", "quantity": "inferred outcome of one ply"},
        blank | {"id": "not fired", "quantity": "outcome of one ply"},
    ]
    above, below = tool("scored_plots").draw(table).axes
    names = [label.get_text().split()[0] for label in above.get_yticklabels()]
    assert names == ["low", "high"]
    medians = [line for line in above.lines if line.get_marker() == "o"]
    assert [float(line.get_xdata()[0]) for line in medians] == [1.04, 1.04]
    diamonds = [line.get_markerfacecolor() for line in below.lines if line.get_marker() == "D"]
    assert sorted(color == "none" for color in diamonds) == [False, True]


def test_a_growth_fires_both_packs_at_cloths_that_are_drawn_alike(monkeypatch):
    """Eight plies over two, each with its own limit; a pack whose shots are all alike has none."""
    packs = []
    posterior = go_no_go.fit(
        Outcomes(
            NAMES[:1], np.array([[0.2], [-0.3]]), np.array([90.0, 210.0]), np.array([False, True])
        ),
        150.0,
        draws=64,
    )

    def fit_cloths(setup, shots, stride, runs):
        packs.append((setup.plies, setup.strike_velocity, shots, stride))
        limits = replace(posterior, middle=np.full(64, {8: 330.0, 2: 220.0}[setup.plies]))
        known = limits if blind != setup.plies else None
        return [Shot(200.0, 12.0, True, cpu_time=3.0)] * shots, known

    monkeypatch.setattr(predictions, "fit_cloths", fit_cloths)
    monkeypatch.setattr(predictions.table, "as_fired", lambda setup: setup)
    case = ROWS["Prosser, rounded .22"].case
    blind = 0
    found = predictions.predict(case, 5, None)
    assert packs == [(8, 300.0, 5, 8), (2, 240.0, 5, 8)]
    assert (found.shots, found.perforated, found.cpu_time) == (10, 10, 30.0)
    assert np.median(found.values) == pytest.approx(1.5, rel=0.1)
    blind = 2
    assert predictions.predict(case, 5, None).values.size == 0


def test_the_share_of_drawn_shots_has_the_mean_and_ends_of_jeffreys_prior(monkeypatch):
    """Of 6 shots with an outcome 2 perforate: Beta(2.5, 4.5)."""
    shots = [Shot(110.0, 8.0, number < 2, number, cpu_time=1.5) for number in range(6)]
    shots.append(Shot(110.0, 8.0, True, 6, failure="neither"))
    fired = []

    def run(rows, **runs):
        fired.extend(rows)
        return shots

    monkeypatch.setattr(predictions.table, "run", run)
    found = predictions.predict(ROWS["S-726 at 110 m/s"].case, 7, None)
    assert len(fired) == 7
    assert {row.velocity for row in fired} == {110.0}
    assert (found.shots, found.perforated, found.cpu_time) == (6, 2, 9.0)
    assert found.share == pytest.approx(2.5 / 7)
    assert found.values.mean() == pytest.approx(2.5 / 7, rel=0.01)
    low, high = np.quantile(found.values, (0.05, 0.95))
    assert (low, high) == pytest.approx((0.106, 0.656), abs=0.01)
