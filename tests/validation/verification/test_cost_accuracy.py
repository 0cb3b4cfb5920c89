"""Coarse elements, what cannot change an answer, and coupons that converge."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.models.variants import homogenised
from validation.verification.cost_accuracy import coupons, shots, study


@pytest.mark.parametrize("n", [2, 4])
def test_coarse_cell_is_n_cells(n):
    """Same stretches: n-fold tensions, contact force and heights; n^2 cells' energy times n, the thickness."""
    fabric = catalogue.load("S-720").with_effective_density()
    thick = homogenised(fabric, n)
    x = np.linspace(0.97, 1.03, 7)
    s1, s2 = np.meshgrid(x, x)
    one, many = CellModel(fabric).solve(s1, s2), CellModel(thick).solve(s1, s2)
    for name in ("T1", "T2", "F", "N1", "N2"):
        assert many[name] == pytest.approx(n * one[name], rel=1e-9, abs=1e-6), name
    assert many["h1"] == pytest.approx(n * one["h1"], rel=1e-9)
    assert many["W"] == pytest.approx(n**2 * one["W"], rel=1e-9, abs=1e-12)
    assert thick.weave.areal_density == pytest.approx(fabric.weave.areal_density, rel=1e-12)
    stiff = [cloth.shear.stress(0.4) * cloth.weave.thickness for cloth in (fabric, thick)]
    assert stiff[1] == pytest.approx(stiff[0], rel=1e-12)


SHOT = shots.Shot("S-720", 0.0815, (92.5,), 40e-6, "in flight", 20e-6)
SMALL = shots.Shell(SHOT, table=21)


def test_what_cannot_change_an_answer():
    """Rows that no wave has reached, and the images of a symmetry, are no model: to the last bit, to rounding."""
    base = shots.run(SMALL)[0]
    assert shots.run(replace(SMALL, awake=True))[0] == base
    for symmetry in ("half", "whole"):
        assert shots.run(replace(SMALL, symmetry=symmetry))[0] == pytest.approx(base, rel=1e-6)


@pytest.mark.parametrize("key", ["bias-extension", "biaxial-coupon"])
def test_coupons_converge(key):
    """One element a crossover and two agree within 2 %; a finer table and smaller load steps move nothing.

    With a tenth of the default tolerance, by which alone the load of the bias coupon moves by 0.15 %.
    """
    base = coupons.read(study.case_of(key))
    base = replace(base, table=51, steps=1, tolerance=0.1 * base.tolerance)
    one, two = (coupons.run(replace(base, elements=n))[0] for n in (1, 2))
    assert two == pytest.approx(one, rel=0.02)
    assert coupons.run(replace(base, table=101))[0] == pytest.approx(one, rel=1e-3)
    assert coupons.run(replace(base, steps=2))[0] == pytest.approx(one, rel=1e-3)
