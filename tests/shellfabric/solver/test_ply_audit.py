"""The audit of one ply on states that are set by hand."""

from math import inf

import pytest
from conftest_tools import grid

from shellfabric.panel import boundary
from shellfabric.solver import ply_audit

ZONES = ((6, 1), (inf, 2))


@pytest.mark.parametrize("symmetry", ["quarter", "half", "whole"])
def test_yarns_on_a_plane_of_symmetry_count_by_half(small, symmetry):
    """Two segments of every warp and one of every weft fail: 2 x 25 and 25 of the whole panel of 24 x 24 crossovers,
    whose warp segments lie in pairs on either side of x = 0."""
    panel = small(symmetry=symmetry)
    const, state = panel.constants(), panel.state(100.0)
    warp, weft = grid(const, state.failed[0]), grid(const, state.failed[1])
    warp[[const.ni // 2 - 1, const.ni // 2] if symmetry == "whole" else 0] = 1
    assert ply_audit.failed_segments(panel, const, state) / panel.share == 2 * 25
    warp[:] = 0
    weft[:, 3] = 1
    assert ply_audit.failed_segments(panel, const, state) / panel.share == (2 * 25 if symmetry == "quarter" else 25)


def test_a_line_of_a_graded_panel_stands_for_its_yarns(small):
    """All warp segments: as on the plain panel, but for the outermost lines, which stand for the two yarns of their
    last element (`Panel.segments`)."""
    counts = []
    for zones in (None, ZONES):
        panel = small(grading=zones)
        const, state = panel.constants(), panel.state(100.0)
        grid(const, state.failed[0])[:-1] = 1
        counts.append(ply_audit.failed_segments(panel, const, state) / panel.share)
    assert counts == pytest.approx([24 * 25, 24 * (25 + 2 * 0.5)])


def test_reactions_are_the_tension_of_the_yarn_nearest_the_impact_point(small):
    """A force f on the node at the end of the middle warp is that of the yarns of the line: f over their number."""
    for symmetry in ("quarter", "whole"):
        panel = small(symmetry=symmetry)
        const, state = panel.constants(), panel.state(100.0)
        (i, j), _ = ends = boundary.ends(panel)
        share = 0.5 if const.mirror_y else 1.0  # of the yarn that is modelled
        state.f_int[0][i * const.row_stride + j] = -30.0 * share
        assert ply_audit.edge_reactions(panel, const, state, ends) == pytest.approx((30.0, 0.0))
