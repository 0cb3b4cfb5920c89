"""Resolved yarns as pictures show them: sections about chains, what is torn, and the grid of files and pages."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial import cKDTree

from fabrics import catalogue
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.loop.snapshots import of_plies, quads
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns import drawn
from shellfabric.yarns.model import YarnZone, aim
from weavecell.report import pictures3d
from weavecell.results import vtk
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Shape
from weavecell.results.result_folder import read_record

FABRIC = catalogue.load("S-726")
SETUP = ImpactSetup(
    FABRIC,
    250.0,
    projectile=Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere"),
    opening=0.04,
    symmetry="whole",
    impact_point=aim(FABRIC.weave),
    crossovers=YarnZone(8e-3, 0.2),
    table_size=51,
    end_time=30e-6,
    snapshot_interval=10e-6,
)


@pytest.fixture(scope="module")
def struck():
    return run_impact(SETUP)


def at_rest(**changes):
    panel = replace(SETUP, **changes).target().plies[0]
    return panel, panel.zone()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_sections_turn_with_the_fabric(seed):
    """As high and wide as given, about the chain and across it; those of turned chains are turned."""
    rng = np.random.default_rng(seed)
    yarns, nodes, apart = 5, 9, 1.2e-3
    place = np.zeros((yarns, nodes, 3))
    place[..., 0] = 0.7e-3 * np.arange(nodes)
    place[..., 1] = apart * np.arange(yarns)[:, None]
    place[..., 2] = rng.uniform(-1e-4, 1e-4, nodes)
    tension = rng.uniform(1.0, 9.0, (yarns, nodes))
    sections = drawn._sections(place, tension, 0, (0.9e-3, 0.2e-3), apart)
    assert_allclose(sections.mean(axis=2), place, atol=1e-15)
    assert_allclose(np.linalg.norm(sections[:, :, 0] - sections[:, :, 3], axis=-1), 0.9e-3)
    along = np.gradient(place, axis=1)
    across = ((sections - place[:, :, None]) * along[:, :, None]).sum(axis=-1)
    assert_allclose(across, 0, atol=1e-18)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    turned = drawn._sections(place @ turn.T, tension, 0, (0.9e-3, 0.2e-3), apart)
    assert_allclose(turned, sections @ turn.T, atol=1e-15)


def test_a_section_beside_a_torn_yarn_lies_along_the_family_that_crosses():
    """Of three yarns apart in height the middle one has lost its third segment: there it says of no yarn how
    it lies, nor do its neighbours of it; elsewhere they do."""
    place = np.zeros((3, 6, 3))
    place[..., 0] = 0.7e-3 * np.arange(6)
    place[..., 1] = 1.2e-3 * np.arange(3)[:, None]
    place[..., 2] = 0.3e-3 * np.arange(3)[:, None]
    tension = np.full((3, 6), 4.0)
    tension[1, 2] = np.nan
    tension[:, -1] = np.nan
    sections = drawn._sections(place, tension, 0, (0.9e-3, 0.2e-3), 1.2e-3)
    side = sections[:, :, 0] - sections[:, :, 3]
    flat = np.abs(side[..., 2]) < 1e-9
    torn = np.zeros((3, 6), bool)
    torn[:, 2] = True
    assert_array_equal(flat, torn)


@pytest.mark.parametrize("width", [8e-3, 12e-3, inf])
def test_yarns_at_rest_stand_for_the_elements_that_they_cover(width):
    """Each yarn of the zone at its place; beyond FURTHEST the membrane stays."""
    panel, zone = at_rest(crossovers=YarnZone(width, 0.2), opening=0.08)
    found = drawn.draw_yarns(zone, panel)
    low, high = (found["yarn_surface"].min(axis=(0, 1)), found["yarn_surface"].max(axis=(0, 1)))
    reach = min(width, drawn.FURTHEST)
    for axis in range(2):
        covered = np.flatnonzero(found["resolved"].any(axis=1 - axis))
        lines = panel.lines()[axis][[covered[0], covered[-1] + 1]]
        assert np.all(np.abs(np.abs(lines) - reach) < 2 * panel.spacing[axis])
        # half a yarn stands out beyond the last line
        beyond = 0.5 * zone.touch_distance.max() + 1e-9
        assert lines[0] - beyond <= low[axis] < lines[0] + 1e-9
        assert lines[1] - 1e-9 < high[axis] <= lines[1] + beyond
    tension = found["yarn_tension"].reshape(-1)
    assert_array_equal(np.unique(tension[np.isfinite(tension)]), [0.0])
    # a gap behind each yarn, and no other: at the last node of a chain, from which none goes on
    yarns = np.isnan(tension).sum()
    centres = found["yarn_surface"].mean(axis=1)
    after = np.linalg.norm(np.diff(centres, axis=0), axis=1)
    assert_array_equal(np.isnan(tension[:-1]), after > 1.5 * max(panel.spacing))
    crossing = [np.ptp(np.flatnonzero(found["resolved"].any(axis=k))) + 2 for k in (0, 1)]
    assert yarns == sum(crossing)
    nodes = [count * (2 * other - 1) for count, other in zip(crossing, crossing[::-1])]
    assert len(tension) == sum(nodes)


def test_each_ply_of_a_pack_is_drawn_where_its_own_yarns_are():
    """Plies of two fabrics, one at an angle: about the nodes of each chain, at the place of the ply, as wide as a yarn
    of the family and half as high as the ply."""
    plies = (Ply(FABRIC), Ply(catalogue.load("S-728"), angle=0.5), Ply(FABRIC))
    setup = replace(SETUP, plies=3, lay_up=plies, snapshot_interval=None)
    pack = setup.target()
    solver = PackSolver(pack, 250.0, 1e-6)
    zones = [part.zone for parts in solver.parts for part in parts if part.name == "yarns"]
    shots = of_plies(solver)
    widths = set()
    for panel, zone, shot, place in zip(pack.plies, zones, shots, pack.places):
        assert_allclose(shot.nodes[..., 2], place, atol=1e-12)
        nodes = panel.in_pack(zone.x.T.copy())
        nodes[:, 2] += place
        apart, _ = cKDTree(nodes).query(shot.yarn_surface.mean(axis=1))
        assert apart.max() < 1e-7
        across = np.linalg.norm(shot.yarn_surface[:, 0] - shot.yarn_surface[:, 3], axis=-1)
        up = np.linalg.norm(shot.yarn_surface[:, 1] - shot.yarn_surface[:, 5], axis=-1)
        for family in range(2):
            own = shot.yarn_family == family
            assert_allclose(across[own], zone.touch_distance[family], rtol=1e-5)
            widths.add(round(float(zone.touch_distance[family]), 9))
        assert_allclose(up, np.sin(np.pi / 3) * 0.5 * panel.weave.thickness, rtol=1e-4)
    assert len(widths) == 4
    assert np.diff(pack.places).min() > 1e-4


def test_a_torn_yarn_has_a_gap_and_every_instant_the_same_cells(struck):
    grids = []
    for (shot,) in (*struck.snapshots, struck.last):
        shape = Shape.from_snapshot(shot)
        grid = vtk.panel([shape], [quads(struck.panel)])
        grids.append(grid)
        covered = shot.resolved.sum()
        assert grid.n_cells == shot.resolved.size - covered + 6 * (len(shape.yarn_tension) - 1)
        for family, name in enumerate(("tension_warp_N", "tension_weft_N"), 1):
            own = grid["resolved_yarn"] == family
            segments = shape.yarn_tension[:-1][shape.yarn_family[:-1] == family - 1]
            assert_allclose(grid[name][own], np.repeat(np.nan_to_num(segments), 6))
            assert_array_equal(grid["failed_yarns"][own] == 2, np.repeat(np.isnan(segments), 6))
    assert struck.cut_yarns[-1] > 0
    gone = [(grid["failed_yarns"] == 2).sum() for grid in grids]
    assert gone[-1] > gone[0]
    for grid in grids[1:]:
        assert_array_equal(grid.cells, grids[0].cells)
    assert grids[-1].n_points == len(grids[-1]["area_m2"])
    # elements that are gone are left out of pictures
    whole = pictures3d.colour_grid(grids[-1], np.array([200.0, 250.0]), (False, False))
    assert whole.n_cells == grids[-1].n_cells - gone[-1]


def test_a_record_keeps_the_yarns_at_the_end(struck, tmp_path):
    ImpactRecord.from_result(struck, "yarns", "a law").write(tmp_path / "histories.h5")
    (shape,) = read_record(tmp_path / "histories.h5").final
    (shot,) = struck.last
    assert shape.yarn_surface.shape[1:] == (drawn.AROUND, 3)
    for name in ("yarn_surface", "yarn_tension", "yarn_family"):
        assert_array_equal(getattr(shape, name), getattr(shot, name))
    assert_array_equal(shape.resolved, shot.resolved.ravel())
