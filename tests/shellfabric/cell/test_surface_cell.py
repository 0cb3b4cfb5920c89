"""Cells straight from a response surface: against the law they were sampled from, extension, potential, an impact."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fabrics.surface import ResponseSurface
from shellfabric.cell.model import CellModel
from shellfabric.cell.surface_cell import SurfaceCell, potential
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup


def sampled(fabric, d1, d2, form="variational"):
    """The surface that the cell of the fabric's own law has."""
    state = CellModel(fabric, cell_formulation=form).solve(
        1 + d1[:, None] / fabric.weave.w1, 1 + d2[None, :] / fabric.weave.w2
    )
    return ResponseSurface(
        d1, d2, *(state[name] for name in ("N1", "N2", "F", "h1", "h2")), fabric=fabric.name
    )


def axis(lowest, highest, n):
    return np.linspace(lowest, highest, n) * 1e-6


def inside(table, cell):
    """Nodes of a table that lie in the surface's region, as indices."""
    return np.ix_(
        *((a <= x) & (x <= b) for x, (a, b) in zip((table.stretch1, table.stretch2), cell.region))
    )


@pytest.mark.parametrize("form", ["variational", "direct"])
def test_surface_of_a_law_gives_the_table_of_the_law(fabric, form):
    """Sampled at 25 x 25 places the forces are within 0.3 % of the strength everywhere, 0.05 % rms; none at rest."""
    cell = SurfaceCell(fabric, sampled(fabric, axis(-12, 36, 25), axis(-12, 30, 29)), form)
    table = cell.table(121)
    law = CellModel(fabric).table(121)
    assert_array_equal(table.stretch1, law.stretch1)
    part = inside(table, cell)
    strength = fabric.weave.warp.strength
    for name in ("N1", "N2", "T1", "T2"):
        off = (table.values[name] - law.values["N" + name[1]])[part]
        assert abs(off).max() < 3e-3 * strength
        assert np.sqrt(np.mean(off**2)) < 5e-4 * strength
    at_rest = tuple(np.argmin(abs(stretch - 1)) for stretch in (table.stretch1, table.stretch2))
    assert all(table.values[name][at_rest] == 0.0 for name in ("T1", "T2", "N1", "N2", "W"))
    assert table.residual < 1e-3
    assert table.values["W"][part] == pytest.approx(
        law.values["W"][part], abs=5e-3 * law.values["W"].max()
    )


def test_a_force_counts_as_none_below_a_share_of_the_strength_of_its_own_yarn(fabric):
    """1.5 shares of the strength of the weaker yarn, half of one of the other's, three times as strong."""
    warp, weft = fabric.weave.yarns
    strong = replace(warp, failure_strain=3 * warp.failure_strain)
    unlike = replace(fabric, weave=replace(fabric.weave, warp=strong))
    small = 1.5e-4 * weft.strength
    assert small < 1e-4 * unlike.weave.warp.strength
    d = axis(0, 30, 5)
    forces = [np.full((5, 5), small) for _ in range(5)]
    found = SurfaceCell(unlike, ResponseSurface(d, d, *forces, fabric=fabric.name)).solve(
        *(1 + d / w for w in fabric.weave.w)
    )
    assert_array_equal(found["T1"], 0.0)
    assert_allclose(found["T2"], small)


def test_potential_of_a_gradient_is_found():
    """W = x^2 y + y^3 from its slopes, to the error of the trapezoid's end term; a curl is left over."""
    x, y = np.meshgrid(np.linspace(0, 1, 31), np.linspace(0, 1, 41), indexing="ij")
    fx = 2 * x * y / 30
    fy = (x**2 + 3 * y**2) / 40
    W, wx, wy, residual = potential(fx, fy, (1e-3, 1e-3), np.ones_like(x))
    assert np.ptp(W - x**2 * y - y**3) < 1e-4
    assert residual < 1e-3
    assert_allclose(wx, fx, atol=1e-4)
    assert_allclose(wy, fy, atol=1e-4)
    assert (
        potential(fx + 0.01 * (y - 0.5), fy - 0.01 * (x - 0.5), (1e-3, 1e-3), np.ones_like(x))[3]
        > 0.02
    )


@pytest.mark.parametrize("lowest", [0, -12])
def test_extension_is_continuous(fabric, lowest):
    """Forces go on over the edge of the region, to slack yarns below and stiff ones above it."""
    cell = SurfaceCell(fabric, sampled(fabric, axis(lowest, 24, 13), axis(lowest, 24, 13)))
    low, high = cell.region[0]
    strength = fabric.weave.warp.strength
    x = np.sort(np.r_[low - 1e-7, low, high, high + 1e-7, 0.94, 1.06])
    y = np.linspace(0.945, 1.045, 41)
    T1 = cell.solve(x, y)["T1"]
    T2 = cell.solve(x, y)["T2"]
    for T in (T1, T2):
        assert abs(T[2] - T[1]).max() < 1e-3 * strength
        assert abs(T[4] - T[3]).max() < 1e-3 * strength
    assert np.all(T1[0] == 0.0)
    assert_allclose(T2[0], cell._alone(1, y), atol=1e-9)
    stiff = fabric.weave.warp.EA * 2 * fabric.weave.w1 / fabric.weave.S01
    assert (T1[5] - T1[4]) / (x[5] - x[4]) == pytest.approx(np.full(41, stiff), rel=1e-6)


@pytest.mark.slow(4)
def test_surface_of_the_3d_crossover(fabric):
    """A coarse 9 x 9 surface (`weavecell surface S-720 --mesh coarse`) stops the published shot as the law does.

    Its forces are a gradient to 0.15 %, although the solid of the yarns has secant moduli and no potential.
    """
    surface = ResponseSurface.read(Path(__file__).parent / "data" / "S-720-coarse-9x9.h5")
    setup = ImpactSetup(fabric, 92.5, surface=surface)
    result = run_impact(setup)
    assert result.outcome == "stopped"
    assert result.energy_error_max < 5e-4
    assert result.panel.table.residual < 2e-3
    # 18.56 mm with the published law
    assert result.nose_position[-1] == pytest.approx(18.56e-3, rel=0.02)
