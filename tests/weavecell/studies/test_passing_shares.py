"""Shares of shots that pass: from shots at places whose limits differ, without a curve."""

import json
from dataclasses import replace
from math import isnan

import numpy as np
import pytest

import weavecell as wc
from weavecell.api.scatter import V50Result
from weavecell.api.target import resolve_target
from weavecell.report import installed
from weavecell.studies import ballistic_limit, passing_shares, probit, v50
from weavecell.studies.inputs import read_scatter
from weavecell.studies.passing_shares import PassingShares

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
SPHERE = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}
# limits [m/s] of eight spread places of a slippery fabric
LIMITS = [36.0, 44.0, 49.0, 55.0, 58.0, 71.0, 94.0, 109.0]


def strike(count, seed):
    """(velocities, whether it perforated) of shots at these places in turn."""
    velocities = np.random.default_rng(seed).uniform(20.0, 130.0, count)
    limits = np.resize(LIMITS, count)
    return velocities, velocities > limits


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_pooled_shares_are_the_greatest_of_the_least_means(seed):
    """Of a share that rises, the maximum likelihood at i is the max over a <= i of the min over b >= i of the mean
    from a to b."""
    velocities, perforated = strike(23, seed)
    velocities[5] = velocities[11]
    V, share = passing_shares.pool_shares(velocities, perforated)
    hits = [perforated[velocities == one].sum() for one in V]
    shots = [np.sum(velocities == one) for one in V]
    means = lambda a, b: sum(hits[a : b + 1]) / sum(shots[a : b + 1])  # noqa: E731
    n = len(V)
    slow = [max(min(means(a, b) for b in range(i, n)) for a in range(i + 1)) for i in range(n)]
    assert n == 22
    np.testing.assert_allclose(share, slow, rtol=1e-12)


def test_quantiles_of_many_shots_are_those_of_the_places():
    found = PassingShares.of_shots(*strike(4000, 4)).velocities
    # one of eight places is below 44, half of them below 58, seven below 109
    assert 36.0 <= found[0.1] <= 44.0
    assert 54.0 <= found[0.5] <= 60.0
    assert 92.0 <= found[0.9] <= 112.0


def test_words_name_the_shares_that_the_shots_know():
    velocities = [40.0, 50.0, 60.0, 70.0, 80.0, 90.0]
    known = PassingShares.of_shots(velocities, [0, 0, 1, 0, 1, 1])
    assert known.words() == "1 in 10 and half at 55.0, 9 in 10 at 75.0 m/s"
    late = PassingShares.of_shots(velocities, [1, 0, 1, 1, 0, 0])
    assert isnan(late.velocities[0.1])
    assert late.words() == "no share is determined by shots at 40.0 to 90.0 m/s"
    half = PassingShares.of_shots(velocities, [1, 0, 1, 0, 1, 1])
    assert half.words() == "9 in 10 at 75.0 m/s"


def result(friction):
    shot = {"opening": "60 mm", "projectile": SPHERE, "crossovers": "yarns"}
    target = resolve_target("S-728", shot | {"crossover_friction": friction}, "v50", function="v50")
    rows = []
    for number, (V, hit) in enumerate(zip(*strike(12, 6))):
        drawn = {"modulus": 1.02, "crimp_warp": 0.97, "crimp_weft": 1.04, "weakest": (0.9, 0.8)}
        point = {"impact_point": (1e-4, 3e-4), "balance": 1e-3}
        rows.append(v50.Shot(number, float(V), 0.3 * float(V), bool(hit), **drawn, **point))
    outcomes = [row.velocity for row in rows], [row.perforated for row in rows]
    curves = {link: probit.fit(*outcomes, link=link) for link in probit.LINKS}
    study = v50.Study((57.0, 59.0), tuple(rows), curves, read_scatter())
    return V50Result(study, target, 1, 6, 0.0)


def test_shots_whose_zone_was_too_small_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    plain = result(0.1)
    assert "widened" not in plain.summary()
    assert "widened" not in plain.to_dataframe()
    assert "fired again" not in str(plain)
    rows = list(plain.study.shots)
    for number in (2, 7, 11):
        rows[number] = replace(rows[number], widened=f"a yarn slipped by 0.{number}")
    found = replace(plain, study=replace(plain.study, shots=tuple(rows)))
    told = "3 of 12 shots fired again with all yarns resolved: their zone was too small"
    assert f"{told}." in found.lines()
    found.save(tmp_path / "r")
    assert json.loads((tmp_path / "r/v50.json").read_text())["widened"] == told
    column = wc.load(tmp_path / "r").to_dataframe()["widened"]
    assert list(column[column != ""]) == [rows[number].widened for number in (2, 7, 11)]


def test_a_fired_shot_says_why_it_was_fired_again(monkeypatch):
    fired = ballistic_limit.Shot(
        70.0, 12.0, "perforated", 1e-4, 3.0, (90.0, 70.0), 0.003, 0.5, (), "cut outside the zone"
    )
    monkeypatch.setattr(ballistic_limit, "shoot", lambda *_, **__: (fired,))
    shot = v50.fire(wc.setup("S-728", 60, opening="30 mm"), read_scatter(), 3, 4, 70.0)
    assert (shot.widened, shot.residual) == ("cut outside the zone", 12.0)


def test_yarns_that_may_slip_have_shares_in_place_of_v50(tmp_path, monkeypatch):
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    slip = result(0.1)
    label, value = slip.headline
    assert label == "Passing"
    assert value.startswith(slip.passing_shares.words())
    text = str(slip)
    assert "V50 (probit)" not in text
    assert "the limit differs from place to place" in text
    slip.save(tmp_path / "r")
    kept = json.loads((tmp_path / "r/v50.json").read_text())
    assert kept["passing_50_percent_m_s"] == slip.passing_shares.velocities[0.5]
    assert wc.load(tmp_path / "r").headline == slip.headline
    # friction that holds them leaves V50
    hold = result(0.6)
    assert hold.passing_shares is None
    assert hold.headline[0] == "V50"
    assert "V50 (probit)" in str(hold)
