"""The slip threshold of a crossover: its fit, its group in law.json, and what is refused."""

import json

import numpy as np
import pytest

from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.friction.pull_out import PullOutLaw

FORCES = (2.0, 5.0, 11.0, 17.0)


@pytest.fixture
def law_file(tmp_path):
    path = tmp_path / "law.json"
    CompressionLaw(4.5e-5, 5.8e-5, provenance="3D").to_json(path)
    return path


def test_a_line_is_fitted_exactly():
    law = PullOutLaw.fit(FORCES, 0.05 + 0.21 * np.array(FORCES), friction=0.2, provenance="here")
    assert (law.c0, law.mu_eff) == (pytest.approx(0.05), pytest.approx(0.21))
    assert law.residual_rms < 1e-12
    assert law.threshold([0.0, 10.0, -1.0]) == pytest.approx([0.05, 2.15, 0.05])


def test_a_threshold_is_never_negative():
    assert PullOutLaw(-0.1, 0.2).threshold([0.1, 1.0]) == pytest.approx([0.0, 0.1])


def test_it_is_kept_beside_the_compression_law(law_file):
    before = CompressionLaw.from_json(law_file)
    assert PullOutLaw.from_json(law_file) is None
    law = PullOutLaw.fit(FORCES, 0.05 + 0.21 * np.array(FORCES), provenance="here")
    for _ in range(2):
        law.add_to(law_file)
        assert PullOutLaw.from_json(law_file) == law
    assert CompressionLaw.from_json(law_file) == before
    group = json.loads(law_file.read_text())["pull_out"]
    assert group["c0"].endswith(" N")
    assert (group["status"], group["friction_range"]) == ("literature", [0.15, 0.25])


@pytest.mark.parametrize(("change", "key"), [
    ({"c0": "3 m"}, "pull_out.c0"), ({"mu_eff": -0.1}, "pull_out.mu_eff"), ({"mu_eff": "much"}, "pull_out"),
    ({"friction_range": [0.3, 0.2]}, "pull_out.friction_range"), ({"T_f_N": [1.0]}, "pull_out.T_f"),
    ({"F_c_N": [-1.0] * 4}, "pull_out.F_c"), ({"friction": None}, "pull_out"),
])  # fmt: skip
def test_a_bad_group_is_one_line(law_file, change, key):
    PullOutLaw.fit(FORCES, 0.2 * np.array(FORCES)).add_to(law_file)
    content = json.loads(law_file.read_text())
    content["pull_out"] |= change
    law_file.write_text(json.dumps(content))
    with pytest.raises(InputError) as caught:
        PullOutLaw.from_json(law_file)
    assert str(caught.value).startswith(f"{law_file}: {key}")
    assert "\n" not in str(caught.value)


def test_missing_keys_and_files(law_file, tmp_path):
    PullOutLaw(0.1, 0.2).add_to(law_file)
    content = json.loads(law_file.read_text())
    del content["pull_out"]["mu_eff"]
    law_file.write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"pull_out.mu_eff.*is missing"):
        PullOutLaw.from_json(law_file)
    with pytest.raises(InputError, match="cannot be read"):
        PullOutLaw(0.1, 0.2).add_to(tmp_path / "none.json")


@pytest.mark.parametrize("forces", [(), (3.0,), (3.0, 3.0)])
def test_a_fit_needs_two_contact_forces(forces):
    with pytest.raises(InputError, match="two different"):
        PullOutLaw.fit(forces, forces)
