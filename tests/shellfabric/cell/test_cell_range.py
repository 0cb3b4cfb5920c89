"""The range of the cell's table, in fabrics of high crimp and of cells far from square."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.fabric import Fabric
from fabrics.weave import Weave, arc_length, height_from_length
from fabrics.yarn import Yarn
from shellfabric.cell import coefficients
from shellfabric.cell.crossover_kernels import free_height
from shellfabric.cell.model import CellModel

LAWS = catalogue.load("S-728").laws
# crimps of warp and weft [-], counts of warp and weft [1/m] of 100 tex: even and uneven cells; the warp
# of the last two cannot fill the cell
WEAVES = {
    "even": (0.15, 0.15, 1200, 1200),
    "one yarn": (0.15, 0.0005, 900, 1500),
    "uneven": (0.13, 0.14, 750, 1500),
    "most uneven": (0.0005, 0.15, 750, 1500),
}
FOLDED = ("uneven", "most uneven")


def fabric(name):
    crimp1, crimp2, count1, count2 = WEAVES[name]
    warp, weft = (Yarn(100e-6, 1440.0, 90e9, 0.03, crimp) for crimp in (crimp1, crimp2))
    return Fabric("crimped", Weave(warp, weft, count1, count2), laws=LAWS)


@pytest.mark.parametrize("name", WEAVES)
def test_contact_is_lost_where_the_free_height_fills_the_cell(name):
    """With closed forms: the height of a free yarn against that of the cell; half its length where the cell is shut."""
    weave = fabric(name).weave
    cell = CellModel(fabric(name), cell_model="incompressible")
    for family, (w, S0) in enumerate(zip(weave.w, weave.S0)):
        full = sum(cell.h0)
        lowest = cell.range()[family][0]
        assert free_height(1e-9 * w, S0) == pytest.approx(S0 / 2, rel=1e-6)
        dense = np.sqrt(4 * weave.yarns[1 - family].A_s / np.pi) / (2 * w)
        if name in FOLDED and family == 0:
            assert S0 / 2 < full
        if free_height(dense * w, S0) < full:
            assert lowest == pytest.approx(dense)
        else:
            assert lowest > dense
            assert free_height(lowest * w, S0) == pytest.approx(full, rel=1e-9)


@pytest.mark.parametrize("name", WEAVES)
def test_decoupled_yarns_follow_the_length_of_their_arc(name):
    weave = fabric(name).weave
    cell = CellModel(fabric(name), cell_model="decoupled")
    table = cell.table(61)
    for family, stretch in enumerate((table.stretch1, table.stretch2)):
        w = weave.w[family]
        S0 = weave.S0[family]
        yarn = weave.yarns[family]
        T, h = (np.take(table.values[f"{key}{family + 1}"], 7, axis=1 - family) for key in "Th")
        assert T == pytest.approx(
            yarn.EA * np.maximum(2 * w * stretch / S0 - 1, 0), rel=1e-12, abs=1e-12
        )
        assert arc_length(stretch * w, h) == pytest.approx(
            np.maximum(S0, 2 * w * stretch), rel=1e-12
        )
        slack = 2 * w * stretch < S0
        assert h[slack] == pytest.approx(
            [height_from_length(x * w, S0) for x in stretch[slack]], rel=1e-9
        )


@pytest.mark.parametrize("name", FOLDED)
def test_a_folded_yarn_stays_in_contact(name):
    """Of a crossing yarn pulled straight the folded one has the height of the cell, and the tension of that arc."""
    weave = fabric(name).weave
    cell = CellModel(fabric(name), cell_model="incompressible")
    full = sum(cell.h0)
    w = weave.w1
    S0 = weave.S01
    straight = weave.S02 / (2 * weave.w2)
    for stretch in (0.01, 0.1, cell.range()[0][0], 0.9):
        found = cell.solve(stretch, straight * 1.02)
        assert found["F"] > 0
        h = found["h1"]
        assert h + found["h2"] == pytest.approx(full, rel=1e-9)
        assert found["T1"] == pytest.approx(
            weave.warp.EA * (arc_length(stretch * w, h) / S0 - 1), rel=1e-9
        )


def test_range_where_heights_vanish_in_rounding():
    """A gap that leaves the yarns a height of a rounding error: contact begins where the yarn is straight."""
    for crimp in np.linspace(0.0005, 0.15, 40):
        base = fabric("even")
        weave = replace(base.weave, warp=replace(base.weave.warp, crimp=crimp))
        base = replace(base, weave=weave)
        cell = CellModel(base, LAWS, crossover_gap=sum(weave.h0) * (1 - 3e-16))
        assert sum(weave.h0) > cell.crossover_gap
        for (lowest, _), yarn in zip(cell.range(), weave.yarns):
            assert lowest == pytest.approx(1 + yarn.crimp)
    assert np.isfinite(cell.table(21).values["T1"]).all()


@pytest.mark.parametrize("lowest", [1.0, 0.9997, 0.983])
def test_the_grid_of_a_table_has_rest_and_reaches_its_ends(lowest):
    """Also if what lies below rest is less than a step."""
    found = coefficients.grid(lowest, 1.06, 23)
    step = found[1] - found[0]
    assert found.shape == (23,)
    np.testing.assert_allclose(np.diff(found), step, rtol=1e-9)
    assert abs(found - 1).min() < 1e-12
    assert lowest - step <= found[0] <= lowest + 1e-12
    assert found[-1] >= 1.06 - 1e-12
