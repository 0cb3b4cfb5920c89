"""Cuts, pictures and movies of a panel show the block behind it, with the dent of their time."""

import base64
import json
import zlib
from dataclasses import replace

import numpy as np
import pytest
import pyvista

from fabrics import backings, catalogue
from shellfabric.block.block import Backing
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from weavecell.report import pictures3d
from weavecell.report.pictures_figure import plots
from weavecell.report.pictures_style import CLAY as BROWN
from weavecell.report.shot import moving, pictures_shot, view
from weavecell.report.shot.chapters_shot import cut_view
from weavecell.results import vtk
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Cut, Shape
from weavecell.results.result_folder import read_record

CLAY = backings.load("Roma Plastilina No. 1")
BLOCK = Backing(CLAY, size=(0.06, 0.06, 0.03), min_size=3e-3, refined_depth=6e-3, growth=1.5)
QUICK = {"opening": 0.0305, "table_size": 61, "end_time": 30e-6, "snapshot_interval": 10e-6}


@pytest.fixture(
    scope="module", params=["quarter", pytest.param("whole", marks=pytest.mark.slow(6))]
)
def struck(request):
    fabric = catalogue.load("S-728").with_effective_density()
    setup = ImpactSetup(fabric, 150.0, plies=2, backing=BLOCK, symmetry=request.param, **QUICK)
    return run_impact(setup)


@pytest.fixture(scope="module")
def record(struck, tmp_path_factory):
    path = tmp_path_factory.mktemp("clay") / "histories.h5"
    ImpactRecord.from_result(struck, "clay", "a law").write(path)
    return read_record(path)


def test_cuts_have_the_face_of_their_time(struck, record):
    depths = [cut.face[..., 2].max() for cut in record.cuts]
    assert len(depths) == 3
    assert np.all(np.diff(depths) > 1e-5)
    block = struck.backing
    face = record.cuts[-1].face - [0, 0, struck.target.places[-1] + block.face]
    assert face == pytest.approx(block.depth_map, abs=1e-12)
    # before the strike the face touches the back of the last ply
    assert block.face == pytest.approx(0.5 * struck.panels[-1].weave.thickness, rel=1e-9)
    line = record.cuts[-1].face_line
    middle = np.argmin(np.hypot(*np.moveaxis(block.depth_map[..., :2], -1, 0)))
    assert line[:, 1].max() == record.cuts[-1].face.reshape(-1, 3)[middle, 2]
    assert np.ptp(line[:, 0]) == pytest.approx(BLOCK.size[0] * (0.5 if record.mirror_x else 1))


def test_a_block_at_an_angle_is_cut_where_it_stands():
    x, y = np.meshgrid(np.linspace(-0.1, 0.1, 41), np.linspace(-0.1, 0.1, 41), indexing="ij")
    c, s = np.cos(0.4), np.sin(0.4)
    z = 0.01 * np.exp(-(x**2 + 2 * y**2) / 0.05**2)
    face = np.stack([c * x - s * y, s * x + c * y, z], axis=-1)
    line = Cut(0.0, 0.0, (), face=face).face_line
    expected = 0.01 * np.exp(-((c * line[:, 0]) ** 2 + 2 * (s * line[:, 0]) ** 2) / 0.05**2)
    assert line[:, 1] == pytest.approx(expected, abs=1e-4)
    assert np.ptp(line[:, 0]) > 0.18


def test_pictures_show_clay_behind_the_fabric(record):
    panel = view.ViewedShot(record, [])
    grid = vtk.panel(record.final, record.quads)
    end = record.final[-1].time
    drawn = panel.face(end)
    # nodes of a whole block's middle move by nanometres, as its fabric does
    assert drawn[..., 1].min() == pytest.approx(0.0, abs=1e-8)
    assert drawn[..., 0].min() == pytest.approx(-drawn[..., 0].max())
    assert drawn[..., 2].max() == record.cuts[-1].face[..., 2].max()
    image = panel.image(grid, end).reshape(-1, 3).astype(float)
    clay = np.array([int(BROWN[k : k + 2], 16) for k in (1, 3, 5)], float)
    alike = image / np.linalg.norm(image, axis=1)[:, None] @ clay / np.linalg.norm(clay)
    brown = (alike > 0.999) & (np.ptp(image, axis=1) > 40)
    assert brown.sum() > 20_000
    with plots() as pyplot:
        row = cut_view(record, record.cuts[-1], "")
        whole, near = pictures_shot.cuts(pyplot, [row], 15e-3).axes
        colours = [patch.get_facecolor()[:3] for patch in near.patches]
        assert any(np.allclose(colour, clay / 255, atol=5e-3) for colour in colours)
        assert whole.get_ylim()[1] > 1e3 * record.cuts[-1].face[..., 2].max()


def test_beside_a_pack_that_has_left_it_the_block_is_drawn_as_it_was_then(record):
    """Its dent goes on, pack and projectile do not: later faces would stand through the fabric."""
    first, left, last = record.cuts
    alone = replace(record, backing=replace(record.backing, alone_from=left.time + 1e-9))
    for t, expected in ((first.time, first), (left.time, left), (last.time, left)):
        assert np.array_equal(alone.face_at(t), expected.face), t
    caption = view.ViewedShot(alone, []).caption(last.time)
    assert caption.startswith(f"{1e6 * left.time:.0f} µs")
    assert "alone" in caption
    assert "alone" not in view.ViewedShot(record, []).caption(last.time)


def test_the_view_in_motion_has_the_face_of_each_instant(struck, record):
    shapes = [tuple(map(Shape.from_snapshot, plies)) for plies in struck.snapshots]
    head = json.loads(moving.moving(record, moving.collect_instants(record, shapes)))
    packed = zlib.decompress(base64.b64decode(head["data"]))
    count = head["instants"] * head["faceRows"] * head["faceColumns"] * 3
    assert head["rings"] == 0  # a rigid nose, of which the triangles stand before the faces
    start = 12 * head["bodyVertices"]
    faces = np.frombuffer(packed[start : start + 4 * count], "<f4").reshape(
        head["instants"], head["faceRows"], head["faceColumns"], 3
    )
    for face, plies in zip(faces, struck.snapshots):
        assert face[..., 2].max() == pytest.approx(plies[0].face[..., 2].max(), rel=1e-6)


def test_paraview_has_the_face_beside_the_panel(record, tmp_path):
    vtk.write_faces(tmp_path, record.faces())
    series = vtk.read_series(tmp_path / "block.pvd")
    assert [time for _, time in series] == pytest.approx([cut.time for cut in record.cuts])
    points = pyvista.read(series[-1][0]).points
    assert points[:, 2].max() == pytest.approx(record.cuts[-1].face[..., 2].max(), rel=1e-6)


def test_without_a_block_nothing_is_drawn(tmp_path):
    face = np.empty((0, 0, 3))
    assert pictures3d.open_faces([face], (True, True), 0.1)[0].size == 0
    assert Cut(0.0, 0.0, ()).face_line.size == 0
    vtk.write_faces(tmp_path, [])
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("front", [False, True])
def test_a_picture_holds_whole_fabric_however_far_it_goes(struck, front, monkeypatch):
    """The last ply thrown 40 mm out of a panel of 30 mm, to either side: nothing is cut off by the edge of the picture,
    and one side is nearly reached; torn fabric leaves it."""
    record = ImpactRecord.from_result(struck, "thrown", "Kevlar")
    nodes = record.final[-1].nodes * [1, 1, 0]
    nodes[:, 2] = 0.04 * np.exp(-(nodes[:, 0] ** 2) / 6e-3**2 - nodes[:, 1] ** 2 / 9e-3**2)
    nodes[:, 2] += record.z_rest[-1]
    final = *record.final[:-1], replace(record.final[-1], nodes=nodes)
    thrown = replace(
        record, final=final, backing=None, outcome="stopped" if front else "perforated"
    )
    assert thrown.seen_from_front is front
    for cut, whole in ((0.0, True), (1.0, False)):
        monkeypatch.setattr(ImpactRecord, "cut_yarns", np.array([0.0, cut]))
        image = view.ViewedShot(thrown, []).image(vtk.panel(final, record.quads), struck.time[-1])
        drawn = np.argwhere((image < 250).any(axis=-1))
        margins = [*drawn.min(axis=0), *(np.array(image.shape[:2]) - 1 - drawn.max(axis=0))]
        assert bool(min(margins) > 0) is whole
        if whole:
            assert min(margins) < 0.05 * image.shape[0]
