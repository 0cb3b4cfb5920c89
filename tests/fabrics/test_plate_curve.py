"""The measured plate curve: the built-in law, and a user's file."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.plate_curve import PlateCurve

OWN = "# one ply\nthickness [mm], pressure [kPa]\n0.40, 30\n0.35, 100\n0.31, 400\n0.29, 1500\n0.28, 6000\n"


def test_pressure_law_is_eq_2_5_with_the_constants_of_erratum_e_03():
    """K'' of S-720 is 1.920e-7 Pa m3; the platen goes from 10 N to 7 kN."""
    curve = PlateCurve.pressure_law(catalogue.load("S-720").areal_density_measured)
    assert curve.pressure[[0, -1]] == pytest.approx([10 / 0.019**2, 7000 / 0.019**2], rel=1e-12)
    above = (1.920e-7 / curve.pressure) ** (1 / 3)  # t - t_min
    assert curve.closure == pytest.approx(above[0] - above, rel=1e-3, abs=1e-9)
    # thickness above the least at 10 N, erratum E-04
    assert above[0] == pytest.approx(191e-6, rel=3e-3)


def test_packs_close_somewhat_less_than_as_many_plies():
    """Erratum E-04: b_N / (N b_1) is 0.83 to 0.88 for 4 plies of the six fabrics, 0.77 to 0.90 for 16."""
    areal_density = catalogue.load("S-720").areal_density_measured
    one, four, sixteen = (
        PlateCurve.pressure_law(areal_density, plies).closure[-1] for plies in (1, 4, 16)
    )
    assert 0.83 < four / (4 * one) < 0.88
    assert 0.77 < sixteen / (16 * one) < 0.90


@pytest.mark.parametrize("text", [OWN, "\ufeff" + OWN.replace(",", ";")])
def test_users_file(tmp_path, text):
    path = tmp_path / "curve.csv"
    path.write_text(text)
    curve = PlateCurve.read(path)
    assert curve.pressure == pytest.approx(np.array([30, 100, 400, 1500, 6000]) * 1e3)
    assert curve.closure == pytest.approx(np.array([0, 0.05, 0.09, 0.11, 0.12]) * 1e-3, abs=1e-12)
    assert curve.source == "curve.csv"
    assert curve.at(100e3) == pytest.approx(0.05e-3)
    path.write_text(text + 131_073 * "1")
    with pytest.raises(
        InputError, match=r"curve.csv: line 8: cannot be read \(field larger than field limit"
    ):
        PlateCurve.read(path)
