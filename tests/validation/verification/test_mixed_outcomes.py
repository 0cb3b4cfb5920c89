"""S-745 on one element per crossover: outcomes are mixed, because the first stress wave breaks a yarn."""

import pytest

from validation.verification.mesh_convergence import mixed_outcomes as study


def rows(*outcomes):
    names = {"s": "stopped", "p": "perforated"}
    return [{"strike velocity [m/s]": 100 + 4 * k, "outcome": names[o]} for k, o in enumerate(outcomes)]


def test_outcomes_in_words():
    assert study.runs_of_outcomes(rows(*"sspps")) == "stops 100 to 104, perforates 108 to 112, stops 116"
    assert study.mixed_zone(rows(*"sspps")) == (108, 116)
    assert study.mixed_zone(rows(*"sspp")) is None


@pytest.fixture(scope="module")
def panel():
    return study.setup(1).panel()


def test_a_faster_shot_stops(panel):
    """Slower: the yarns under the nose fail, late. Faster: the first wave breaks the middle weft far from the nose."""
    slow, under = study.fire(panel, 216.0)
    fast, ahead = study.fire(panel, 224.0)
    assert (slow.outcome, fast.outcome) == ("perforated", "stopped")
    assert under.distance < 3
    assert under.time > 100e-6
    assert ahead.family == "weft"
    assert ahead.yarn == 0.0
    assert ahead.distance > 5
    assert ahead.time < 10e-6


def test_first_wave_exceeds_the_strength_on_one_element_alone(panel):
    strength = panel.weave.weft.strength
    peaks = [study.first_wave(elements, panel.table, 224.0)[0] / strength for elements in (1, 2)]
    assert peaks[0] > 1.0 > 0.7 > peaks[1]


def test_tables():
    shots = [
        {"elements per crossover": n, "strike velocity [m/s]": v, "outcome": "stopped", "failed segments": 0,
         "first failure [us]": "", "family": "", "distance along the yarn [crossovers]": ""}
        for n in study.MESHES for v in study.STRIKES
    ]  # fmt: skip
    for shot in shots:
        if shot["strike velocity [m/s]"] in (220, 232):
            shot["outcome"] = "perforated"
    assert study.outcome_table(shots).count("220 to 272") == len(study.MESHES)
    wave = {"elements per crossover": 1, "strike velocity [m/s]": 224, "peak over strength": 1.01,
            "distance [crossovers]": 10.5}  # fmt: skip
    assert "| 1 | 224 | 1.01 | 10.5 | - | - | - | stopped | 0 |" in study.mechanism_table(shots, [wave])
