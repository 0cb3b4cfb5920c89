"""The study of shots with the laws of the calibration chain: laws about the fitted one, and intervals as squares."""

import json

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from validation.published import calibration_chain as study


@pytest.fixture
def chain(tmp_path):
    """A folder as `weavecell calibrate --all --fit-solid` leaves it; its ends are of a mesh with 2 a and 4 b."""
    folder = tmp_path / "S-720"
    (folder / "solid-of-the-file").mkdir(parents=True)
    CompressionLaw(4e-5, 5e-5, "regularised").to_json(folder / "solid-of-the-file" / "law.json")
    CompressionLaw(3e-5, 4e-5, "regularised").to_json(folder / "law.json")
    end = lambda a, b: {"a_m": 2 * a, "b_m_N^(1/3)": 4 * b}  # noqa: E731
    content = {
        "law_of_their_middle": end(3e-5, 4e-5),
        "laws_of_the_limits_of_solid.json": [[end(2e-5, 4e-5), end(5e-5, 4e-5)], [None, end(3e-5, 6e-5)]],
    }
    (folder / "law-interval.json").write_text(json.dumps(content))
    return tmp_path


def test_laws_of_the_ends_are_taken_about_the_fitted_one(chain):
    named, ends = study.laws(chain, "S-720")
    published = catalogue.load("S-720").laws[0]
    assert named == {"published": (published.a, published.b), study.FILE: (4e-5, 5e-5), study.FITTED: (3e-5, 4e-5)}
    assert ends[0] == (pytest.approx((2e-5, 4e-5)), pytest.approx((5e-5, 4e-5)))
    assert ends[1] == (None, pytest.approx((3e-5, 6e-5)))


def test_the_row_of_the_intervals(chain):
    """Critical velocity 1e6 a, residual 1e6 b: changes -10 and 20 m/s; 20 m/s."""
    named, ends = study.laws(chain, "S-720")
    pairs = [*named.values(), *(end for pair in ends for end in pair if end)]
    shots = {(a, b): {"critical": 1e6 * a, "residual": 1e6 * b} for a, b in pairs}
    *_, last = study.table(named, ends, shots)
    assert last[1:] == ["0.0200 .. 0.0500", "0.0400 .. 0.0600", "20.0 .. 50.0", "40.0 .. 60.0"]
    assert np.all([len(row) == len(study.HEAD) for row in study.table(named, ends, shots)])


def test_a_folder_without_a_chain(tmp_path):
    with pytest.raises(InputError, match="no calibration chain of S-720"):
        study.laws(tmp_path, "S-720")
