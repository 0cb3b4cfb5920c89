"""No ply passes through another, torn or whole: counted without the contact."""

from dataclasses import replace

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


def test_nodes_of_a_graded_ply_are_on_its_lines(ply):
    graded = replace(ply, grading=((12, 0.5), (16, 1), (np.inf, 2)))
    march, near = PackSolver(Pack.stacked(graded, 2, gap=0.0), 1.0, 1.0), passages.elements_within(graded, 14)
    assert near == 26  # 24 of half a crossover, 2 of one
    at = passages.nodes(march, 1, near)
    for axis, lines in enumerate(graded.lines()):
        np.testing.assert_allclose(np.moveaxis(at[..., axis], axis, 0)[:, 0], lines[: near + 1], atol=1e-12)
    assert passages.elements_within(ply, 14) == 14


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


@pytest.mark.parametrize(("net", "times"), [((1, 1), 1), ((1, 0), 0), ((1, -1), 0), ((-1, -2), -1), ((2, 3), 2)])
def test_a_point_is_through_when_it_has_crossed_both_surfaces(net, times):
    assert passages.gone(net) == times


def test_what_is_back_at_once_has_not_passed(ply):
    march = PackSolver(Pack.stacked(ply, 2, gap=0.0), 1.0, 1.0)
    march.advance(np.empty((0, 3)))
    told, z = passages.Passages(march, NEAR), march.states[0].u[2]
    count, march.stack.awake[:] = march.const.row_stride * (march.const.ni + 1), True
    for place, found, back in ((2.0, NEAR**2, 0), (0.0, 0, NEAR**2)):
        z[:count] = place * ply.weave.thickness
        told.step()
        assert (len([one for one in told.found if one.ply == 0]), len([one for one in told.back if one.ply == 0])) == (
            found, back,
        )  # fmt: skip
    z[:count] = 2.0 * ply.weave.thickness
    told.step()
    march.stack.counter[0] += passages.AT_ONCE + 1
    z[:count] = 0.0
    told.step()
    assert len([one for one in told.found if one.ply == 0]) == NEAR**2
