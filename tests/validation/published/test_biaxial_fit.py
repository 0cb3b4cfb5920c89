"""The inverse fit of a and b to a biaxial test: finds what made the test, says how well, predicts other ratios."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.cell.model import CellModel
from validation.published.biaxial_glass.curves import at_ratio
from validation.published.biaxial_glass.fit import fit, write
from validation.published.biaxial_glass.measured import Test

FABRIC = catalogue.load("glass-balanced")
LAW = FABRIC.laws[0]


def made_up(k, noise=0.0, seed=0, shift=0.0, n=40, fabric=FABRIC):
    """A made-up test: the cell with the catalogue's law, and noise of a share of the strength."""
    curve = at_ratio(CellModel(fabric, form="equilibrium"), k, n=n)
    strength = np.array([yarn.strength for yarn in fabric.weave.yarns])
    rng = np.random.default_rng(seed)
    return Test(curve.strain - shift, curve.tension + noise * strength * rng.standard_normal(curve.tension.shape))


@pytest.mark.parametrize(("name", "close"), [("glass-balanced", 1e-4), ("glass-unbalanced", 1e-3)])
def test_constants_are_found_again(name, close):
    fabric = catalogue.load(name)
    fitted = fit(fabric, made_up(1.0, fabric=fabric))
    assert (fitted.law.a, fitted.law.b) == pytest.approx((fabric.laws[0].a, fabric.laws[0].b), rel=close)
    assert fitted.residual < 1e-6


def test_intervals_cover_what_made_the_test():
    inside = []
    for seed in range(40):
        law = fit(FABRIC, made_up(1.0, noise=0.01, seed=seed, n=25)).law
        inside.append([law.a_interval[0] < LAW.a < law.a_interval[1], law.b_interval[0] < LAW.b < law.b_interval[1]])
    assert np.all(np.mean(inside, axis=0) > 0.85)


def test_other_ratios_are_predicted_within_the_band():
    found = fit(FABRIC, made_up(1.0, noise=0.01, seed=4))
    for k in (0.5, 2.0):
        other = made_up(k)
        low, high = found.band(other.strain)
        slack = 1e-3 * FABRIC.weave.warp.strength
        assert np.mean((low - slack <= other.tension) & (other.tension <= high + slack)) > 0.8
        assert np.abs(found.tension(other.strain) - other.tension).max() < 0.05 * FABRIC.weave.warp.strength


def test_a_shifted_origin_is_found():
    shifted = made_up(1.0, shift=5e-4)
    found = fit(FABRIC, shifted, origin=True)
    assert found.shift[0] == pytest.approx(5e-4, rel=0.02)
    assert found.law.a == pytest.approx(LAW.a, rel=0.02)
    assert fit(FABRIC, shifted).residual > 100 * found.residual


def test_one_tension_is_enough():
    whole = made_up(1.0)
    half = Test(whole.strain, np.stack([whole.tension[:, 0], np.full(len(whole.strain), np.nan)], axis=1))
    assert fit(FABRIC, half).law.a == pytest.approx(LAW.a, rel=1e-3)


def test_a_test_without_contact_tells_nothing():
    strain = np.stack([np.linspace(-0.02, -0.01, 12)] * 2, axis=1)
    with pytest.raises(InputError, match="no a and b"):
        fit(FABRIC, Test(strain, np.zeros((12, 2))))


def test_files(tmp_path):
    path = tmp_path / "k1.csv"
    sample = made_up(1.0, n=12)
    rows = "\n".join(f"{100 * e[0]},{100 * e[1]},{T[1]}" for e, T in zip(sample.strain, sample.tension))
    path.write_text(f"# made up\nwarp strain [%], weft strain [%], weft tension [N]\n{rows}\n")
    read = Test.read(path)
    assert np.allclose(read.strain, sample.strain)
    assert np.isnan(read.tension[:, 0]).all()
    assert read.ratio == pytest.approx(1.0)
    found = fit(FABRIC, read)
    write(found, {"k1": read}, tmp_path / "fit.csv")
    assert len((tmp_path / "fit.csv").read_text().splitlines()) == 13


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("warp strain [%], warp tension [N]\n" + "0,0\n" * 9, "columns"),
        ("warp strain [%], weft strain [%], load [N]\n" + "0,0,0\n" * 9, "heading"),
        ("warp strain [%], weft strain [%], warp tension [mm]\n" + "0,0,0\n" * 9, "warp tension"),
        ("warp strain [%], weft strain [%], warp tension [N]\n" + "0,0,0\n" * 3, "at least 8"),
        ("warp strain [%], weft strain [%], warp tension [N]\n" + "0,0,0\n" * 9 + "0,0\n", "line 11"),
        ("warp strain [%], weft strain [%], warp tension [N]\n" + "0,0,0\n" * 9 + "0,nan,0\n", "finite"),
        ("warp strain [%], weft strain [%]\n" + "0,0\n" * 9, "tension"),
    ],
)
def test_bad_files_are_refused(tmp_path, text, told):
    path = tmp_path / "k1.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=told) as caught:
        Test.read(path)
    assert "k1.csv" in str(caught.value)
