"""The energy of a crossover over its strains, and the path of a shot on it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

import weavecell as wc
from shellfabric.cell.model import CellModel
from shellfabric.loop import ply_audit, snapshots
from shellfabric.loop.pack_solver import PackSolver
from tests import unlike
from tests.shellfabric.panels import make_panel
from weavecell.report.shot import chapters_shot
from weavecell.studies.biaxial_path import to_strength
from weavecell.studies.energy_map import map_energy

# warp and weft have no number in common
FABRIC = unlike.fabric()


def test_the_energy_is_the_work_of_the_forces_over_the_area():
    """Warp first, then weft: the sums of force times way, over the area of a crossover at rest."""
    model = CellModel(FABRIC)
    found = map_energy(model)
    i, j = 60, 40
    w1, w2 = 0.5 / FABRIC.weave.weft_count, 0.5 / FABRIC.weave.warp_count
    assert abs(w1 / w2 - 1) > 0.1
    warp = np.linspace(1, 1 + found.strain_warp[i], 400)
    weft = np.linspace(1, 1 + found.strain_weft[j], 400)
    first = trapezoid(model.solve(warp, 1.0)["N1"], 2 * w1 * warp)
    then = trapezoid(model.solve(warp[-1], weft)["N2"], 2 * w2 * weft)
    assert min(first, then) > 0.1 * (first + then)
    area = 1 / (FABRIC.weave.warp_count * FABRIC.weave.weft_count)
    assert found.energy[i, j] == pytest.approx((first + then) / area, rel=1e-4)
    assert found.energy[0, 0] == 0.0


def test_no_yarn_has_failed_in_the_zone_up_to_its_edge():
    """Where a path of strains 3:2 meets its first strength the share is 1, of the same family."""
    model = CellModel(FABRIC)
    found = map_energy(model)
    path = to_strength(model, (3, 2))
    warp, weft = path.strain[-1]
    i = int(np.searchsorted(found.strain_warp, warp))
    j = int(np.searchsorted(found.strain_weft, weft))
    at_edge = found.share[i - 1 : i + 1, j - 1 : j + 1].max(axis=2)
    assert at_edge.min() < 1 < at_edge.max()
    family = ("warp", "weft").index(path.failed)
    assert found.share[i, j].argmax() == family
    most, *strains = found.most
    within = found.share.max(axis=2) < 1
    assert most == found.energy[within].max()
    assert 0 < strains[0] < found.strain_warp[-1]
    assert 0 < strains[1] < found.strain_weft[-1]


def test_critical_strains_are_those_of_the_element_nearest_to_failure():
    """By the places of its four nodes in the last snapshot."""
    panel = make_panel(symmetry="whole", impact_point=(0.4e-3, 1.1e-3))
    solver = PackSolver(panel, 120.0, 12e-6)
    solver.run()
    (_, const, state) = solver.plies[0]
    shot = snapshots.snapshot(panel, state, solver.time)
    strengths = [yarn.strength for yarn in panel.weave.yarns]
    shares = (shot.tension / strengths).max(axis=2)
    i, j = np.unravel_index(shares.argmax(), shares.shape)
    corners = shot.nodes[i : i + 2, j : j + 2]
    along_warp = np.linalg.norm(corners[1] - corners[0], axis=-1) / const.dx - 1
    along_weft = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1) / const.dy - 1
    expected = along_warp.mean(), along_weft.mean()
    assert min(np.abs(expected)) > 1e-4
    assert abs(expected[0] - expected[1]) > 1e-5
    assert ply_audit.critical_strains(panel, const, state) == pytest.approx(expected, rel=1e-6)
    assert solver.ply_sample("critical_strain_warp")[-1] == pytest.approx(expected[0], rel=1e-6)
    assert solver.ply_sample("critical_strain_weft")[-1] == pytest.approx(expected[1], rel=1e-6)


@pytest.fixture(scope="module")
def perforated():
    return wc.impact(
        "S-731", "190 m/s", opening="60 mm", plies=2, stacking="alternating", crossovers="pinned"
    )


def test_the_path_of_a_shot_ends_before_a_yarn_fails(perforated):
    record = perforated
    for ply in (0, 1):
        warp, weft = chapters_shot.critical_path(record, ply)
        cut = record.plies["cut_yarns"][:, ply]
        assert 2 < len(warp) == len(weft) < len(cut)
        assert cut[len(warp) - 1] == 0 < cut[len(warp)]
        assert max(warp[-1], weft[-1]) > 0.01


def test_the_path_of_a_turned_ply_is_drawn_along_its_own_warp(perforated, monkeypatch):
    """The picture of the second ply has its warp on the weft of the fabric."""
    drawn = {}
    monkeypatch.setattr(
        chapters_shot.chapters, "energy", lambda found, paths, more: drawn.update(paths)
    )
    for ply in (0, 1):
        shares = np.where(np.arange(2) == ply, 1.0, 0.5)
        tension = perforated.strength * shares[:, None]
        record = replace(perforated, peak_tension=tension)
        drawn.clear()
        chapters_shot.critical(record, perforated.target.setup.meshed)
        ((label, path),) = drawn.items()
        assert f"ply {ply + 1}" in label
        expected = chapters_shot.critical_path(record, ply)
        for along, strains in zip(path[:2], expected[::-1] if ply else expected):
            np.testing.assert_array_equal(along, strains)
        assert 0 < path[2] < len(path[0])
        assert not np.array_equal(*expected)
