"""No ply passes through another, torn or whole: counted without the contact."""

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack
from shellfabric.solver.pack_solver import PackSolver
from validation.published.packs import passages

NEAR = 9


@pytest.fixture(scope="module")
def ply():
    fabric = catalogue.load("S-726").with_effective_density()
    return Panel(CellModel(fabric).table(101), (0.08, 0.08), numerics=Numerics(threads=1))


@pytest.mark.parametrize("velocity", [243.0, 300.0])
def test_torn_plies_do_not_pass_through_each_other(ply, velocity):
    march = PackSolver(Pack.stacked(ply, 4, gap=0.12e-3), velocity, 1.0)
    found, _ = passages.count(march, 50e-6, NEAR, begin=12e-6)
    failed = sum(np.count_nonzero(family) for state in march.states for family in state.failed)
    assert failed > 50
    assert march.deepest.max() < 1.0
    assert found == []


def test_a_passage_is_seen(ply):
    """A ply that is laid through another crosses it; through a hole it does not."""
    march = PackSolver(Pack.stacked(ply, 2, gap=0.0), 1.0, 1.0)
    front, rear = (passages.nodes(march, p, NEAR) for p in (0, 1))
    lift = np.array([0.0, 0.0, 2.0 * ply.weave.thickness])
    (before, held), (after, _) = (passages.points(march, 0, x) for x in (front, front + lift))
    *both, cloth = passages.surfaces(march, 1, rear)
    for below in both:
        found = passages.crossings((before, after), held, (below, below), cloth)
        assert [tuple(point) for point, *_ in found] == [(i, j) for i in range(NEAR) for j in range(NEAR)]
        assert all(np.all(facet // 2 == point) for point, facet, _ in found)
        back = passages.crossings((after, before), held, (below, below), cloth)
        assert {way for *_, way in found} == {-one for *_, one in back} == {found[0][2]}
    state, const = march.states[1], march.consts[1]
    for family in (0, 1):
        state.intact_fraction[family][: (const.ni + 1) * const.row_stride] = 0.0
    assert passages.crossings((before, after), held, (below, below), passages.surfaces(march, 1, rear)[2]) == []
