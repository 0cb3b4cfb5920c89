"""One yarn pulled straight: closed forms, fibre lines, and the zero-energy modes of one-point integration."""

import numpy as np
import pytest
from equations import matrix

from meshing import crossover as mesher
from unitcell3d.cases import single_yarn as cases_single_yarn
from unitcell3d.cases.single_yarn import YarnModel
from unitcell3d.material import solid_law
from unitcell3d.model import submeshes
from unitcell3d.model.crossover import Load


@pytest.fixture(scope="module")
def pulled(coarse, s720):
    return cases_single_yarn.pull(coarse, s720, rows=12)


def taut_line(pulled):
    """Slope and start [N] of the tension against the strain."""
    taut = pulled["T"] > 50
    return np.polyfit(pulled["strain"][taut], pulled["T"][taut], 1)


def test_taut_yarn_has_the_stiffness_of_its_fibres(pulled, s720):
    """dT/d(strain) = E A_s / (1 + crimp) within 0.1 % (found 0.01 %)."""
    slope, _ = taut_line(pulled)
    assert slope * (1 + s720.weave.warp.crimp) == pytest.approx(s720.weave.warp.EA, rel=1e-3)
    assert pulled.failed == ""


def test_yarn_is_straight_where_its_fibres_are_as_long_as_the_mesh_makes_them(pulled, coarse, s720):
    """Back to no tension, the taut line leads to the length of the polygon of nodes, and from it to S0 as h^2."""
    slope, start = taut_line(pulled)
    axis = coarse.points[coarse.grids[0][:, 0, 1]]
    polygon = np.linalg.norm(np.diff(axis, axis=0), axis=1).sum() / coarse.w[0] - 1
    assert -start / slope == pytest.approx(polygon, rel=5e-3)
    assert polygon == pytest.approx(s720.weave.warp.crimp, rel=5e-3)
    # slack until then: 0.5 % of the strength at the crimp's end
    slack = pulled["strain"] < 0.98 * polygon
    assert pulled["T"][slack].max() < 5e-3 * pulled["T"].max()


def test_whole_yarn_equals_the_quarter(s720):
    mesh = {
        domain: mesher.build(s720, size=(3, 2, 2), domain=domain) for domain in ("quarter", "whole")
    }
    T = [cases_single_yarn.pull(mesh[domain], s720, 1, rows=4)["T"] for domain in mesh]
    assert T[1] == pytest.approx(T[0], rel=1e-6, abs=1e-6)


def test_few_fibre_lines_carry_as_much_as_all(tiny, s720):
    """Those of the middle layer, or that and pairs above and below: the same fibre area, the same taut stiffness."""
    last = []
    for bars in (4, 8, None):
        record = cases_single_yarn.pull(tiny, s720, bars=bars, rows=4)
        last.append(record["T"][-1] - record["T"][-2])
    assert last[0] == pytest.approx(last[2], rel=2e-3)
    assert last[1] == pytest.approx(last[2], rel=2e-3)
    none = cases_single_yarn.pull(tiny, s720, bars=0, strain=0.01, rows=2)
    assert none["T"][-1] < 1e-2


def test_lines_are_spread_over_the_section(coarse):
    mesh = submeshes.single_yarn_mesh(coarse, 0)
    for lines in (1, 5, 7, 13, 21):
        kept = submeshes.with_bars(mesh, lines)
        nodes = len(coarse.bars[0]) // 21
        assert len(kept.bars[0]) == lines * nodes
        section = kept.bar_area[0][:lines].sum()
        assert section == pytest.approx(mesh.bar_area[0][:21].sum())


def test_zero_energy_modes_counted(coarse, s720):
    """One point: 29 of 485 unknowns without bars, 13 with slack ones, in each yarn; full integration: none."""
    full = solid_law.FULL
    one = solid_law.ONE_POINT
    for points, bars, modes in ((full, 0, 0), (full, None, 0), (one, 0, 29), (one, None, 13)):
        model = YarnModel(coarse, s720, 0, bars=bars, integration=points)
        q = np.zeros(model.size)
        model.forces(q, Load())
        model.system(q, Load())
        size = abs(np.linalg.eigvals(matrix(model.pattern).toarray()))
        assert np.sum(size < 1e-9 * size.max()) == modes
