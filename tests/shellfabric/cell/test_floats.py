"""The cell of a weave with floats: against its centreline in pieces, its energy, and its table."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from fabrics import catalogue
from fabrics.pattern import Pattern
from shellfabric.cell.model import CellModel

BASE = catalogue.load("S-728")
STRETCHES = 1.021, 1.013


def woven(text):
    """S-728 in another weave: its warp and weft differ in crimp, count and yarn."""
    return replace(BASE, weave=replace(BASE.weave, pattern=Pattern.read(text)))


def length_by_pieces(w, h):
    """Mean length over a spacing of a yarn that changes sides over every other one: straight from the height
    h to -h, then level."""
    return 0.5 * (2 * np.hypot(w, h) + 2 * w)


def length_at_rest(w, h):
    """The same of the weave at rest, whose changes of sides are cosines: its yarns are slack until they are
    straight."""
    k = 0.5 * np.pi / w
    cosine = quad(lambda x: np.hypot(1.0, k * h * np.sin(k * x)), -w, w, epsabs=0, epsrel=1e-12)[0]
    return 0.5 * (cosine + 2 * w)


@pytest.mark.parametrize("form", ["variational", "equilibrium"])
def test_a_crossing_closes_with_the_lengths_of_a_centreline_in_pieces(form):
    """By nested roots over lengths by quadrature: tensions, force and heights of 2/2 twill."""
    fabric = woven("twill 2/2")
    weave = fabric.weave
    law = fabric.laws
    w0 = weave.w
    rest = [brentq(lambda h, m=m: length_at_rest(w0[m], h) - weave.S0[m], 0, w0[m]) for m in (0, 1)]
    w = [half * stretch for half, stretch in zip(w0, STRETCHES)]

    def force_of(m, h):
        T = weave.yarns[m].EA * (length_by_pieces(w[m], h) / weave.S0[m] - 1)
        step = 1e-5 * w[m]
        slope = (length_by_pieces(w[m], h + step) - length_by_pieces(w[m], h - step)) / (2 * step)
        # a yarn pulls at every second side of its crossings, along its straight way
        return T * slope, T

    def height(m, F):
        free = 0.0
        if 2 * w[m] < weave.S0[m]:
            free = brentq(lambda h: length_by_pieces(w[m], h) - weave.S0[m], 0, w[m])
        return brentq(lambda h: force_of(m, h)[0] - F, free, 2 * w[m], xtol=1e-14)

    def left_open(F):
        closed = sum(height(m, F) + float(law[m].d(F)) for m in (0, 1))
        return closed - sum(rest)

    F = brentq(left_open, 1e-3, 100.0, xtol=1e-9)
    found = CellModel(fabric, cell_formulation=form).solve(*STRETCHES)
    assert float(found["F"]) == pytest.approx(F, rel=1e-6)
    for m, name in enumerate(("1", "2")):
        h = height(m, F)
        assert float(found[f"h{name}"]) == pytest.approx(h, rel=1e-6)
        assert float(found[f"T{name}"]) == pytest.approx(force_of(m, h)[1], rel=1e-5)


def test_forces_are_the_slopes_of_the_energy():
    """Also of yarns that withstand compression more as they are stretched, and that have a foot."""
    cell = CellModel(woven("basket 2x2"), stiffening=4.0, slack=(1e-3, 2e-3))
    forces = cell.solve(*STRETCHES)
    step = 1e-6
    for m, name in enumerate(("N1", "N2")):
        up, down = (
            cell.solve(*np.array(STRETCHES) + sign * step * np.eye(2)[m])["W"] for sign in (1, -1)
        )
        slope = (up - down) / (2 * step * 2 * cell.fabric.weave.w[m])
        assert float(forces[name]) == pytest.approx(float(slope), rel=1e-6)


def test_a_table_has_what_single_cells_have():
    """Newton's method along the rows against nested iterations, from where contact is lost on."""
    cell = CellModel(woven("twill 2/2"))
    table = cell.table(21)
    nested = cell.solve(table.stretch1[:, None], table.stretch2)
    for name, values in nested.items():
        apart = abs(table.values[name] - values).max()
        assert apart < 2e-12 * abs(values).max(), name
    (low1, _), (low2, _) = cell.range()
    lost = cell.solve([low1 - 1e-4, 1.02], [1.02, low2 - 1e-4])
    touching = cell.solve([low1 + 1e-3, 1.02], [1.02, low2 + 1e-3])
    assert (lost["F"] == 0).all()
    assert (touching["F"] > 0).all()
