"""The audit of one ply on states that are set by hand."""

from math import inf

import numpy as np
import pytest
from conftest_tools import grid

from shellfabric.loop import ply_audit
from shellfabric.membrane import edges

ZONES = ((6, 1), (inf, 2))
FINE = ((4, 1 / 3), (inf, 1))


def cut(panel, *cuts):
    """`ply_audit.cut_yarns` after cuts (family, place along it, low, high) [crossovers from the impact point]: of the
    edges on both sides at this place whose lines lie between low and high across the family."""
    const = panel.constants()
    state = panel.state(100.0)
    for family, along, low, high in cuts:
        failed = np.moveaxis(grid(const, state.failed[family]), family, 0)
        x, y = (panel.lines()[n] / (2 * panel.weave.w[n]) for n in (family, 1 - family))
        near, far = np.sort(np.abs([x[:-1], x[1:]]), axis=0)
        failed[:-1][np.ix_((near < along) & (along < far), (abs(y) > low) & (abs(y) < high))] = 1
    return ply_audit.cut_yarns(panel, const, state)


@pytest.mark.parametrize("symmetry", ["quarter", "half", "whole"])
@pytest.mark.parametrize(
    "mesh", [{}, {"elements_per_crossover": 3}, {"grading": FINE}, {"grading": ZONES}]
)
def test_one_cut_is_the_same_number_of_yarns_on_all_meshes_and_parts(small, symmetry, mesh):
    """From 2.5 crossovers on one side to 2.5 on the other: five yarns, however often and on how many sides cut."""
    panel = small(symmetry=symmetry, **mesh)
    assert cut(panel) == 0.0
    for family in (0, 1):
        assert cut(panel, (family, 0.9, -1, 2.5)) == pytest.approx(5.0)
        assert cut(panel, (family, 0.9, -1, 2.5), (family, 3.1, 0.5, 1.5)) == pytest.approx(5.0)
        assert cut(panel, (family, 0.9, 1.5, 2.5), (1 - family, 0.9, -1, 1.5)) == pytest.approx(
            2.0 + 3.0
        )
        # a line at an edge is half a yarn
        assert cut(panel, (family, 0.9, -1, 99.0)) == pytest.approx(24.0)


def test_reactions_are_the_tension_of_the_yarn_nearest_the_impact_point(small):
    """A force f on the node at the end of the middle warp is that of the yarns of the line: f over their number."""
    for symmetry in ("quarter", "whole"):
        panel = small(symmetry=symmetry)
        const = panel.constants()
        state = panel.state(100.0)
        (i, j), _ = ends = edges.ends(panel)
        share = 0.5 if const.mirror_y else 1.0  # of the yarn that is modelled
        state.f_int[0][i * const.row_stride + j] = -30.0 * share
        assert ply_audit.edge_reactions(panel, const, state, ends) == pytest.approx((30.0, 0.0))
