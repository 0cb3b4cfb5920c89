"""Pictures of a bullet show it in the shape that it has at their time."""

import base64
import json
import zlib
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from weavecell.answers.shot import ShotResult
from weavecell.report.shot import moving
from weavecell.report.shot.chapters_shot import cut_view
from weavecell.results import vtk
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Shape, TurnedBody
from weavecell.results.result_folder import read_record

QUICK = {"opening": 0.0508, "table_size": 61, "end_time": 16e-6, "snapshot_interval": 4e-6}
DRAWN = {"shape": "ogive", "radius": 2.75e-3, "length": 12e-3, "nose_length": 5e-3}


def shoot(**changes):
    shot = Projectile(mass=2.86e-3, edge_radius=0.2e-3, **DRAWN | changes)
    setup = ImpactSetup(
        catalogue.load("S-720").with_effective_density(), 300.0, projectile=shot, plies=2, **QUICK
    )
    return run_impact(setup)


@pytest.fixture(scope="module")
def struck():
    return shoot(body="metal", core="lead")


def test_cuts_have_the_outline_of_their_time(struck, tmp_path):
    path = tmp_path / "histories.h5"
    ImpactRecord.from_result(struck, "a bullet", "a law").write(path)
    record = read_record(path)
    widths, lengths = [], []
    for cut in record.cuts:
        view = cut_view(record, cut, "")
        assert view.projectile[:, 1].max() == 0
        widths.append(np.ptp(view.projectile[:, 0]))
        lengths.append(np.ptp(view.projectile[:, 1]))
    assert len(record.cuts) >= 4
    body = struck.metal
    assert 11.9e-3 < lengths[0] < 12e-3  # the first snapshot is after the strike
    assert (widths[-1], lengths[-1]) == pytest.approx((body.width, body.length), rel=1e-12)
    assert np.all(np.diff(lengths) < 0)
    assert widths[-1] > 5.5e-3
    # the panel in motion has the same bodies
    for cut, length in zip(record.cuts, lengths):
        surface = record.surface(cut.time)
        assert np.ptp(surface[..., 2]) == pytest.approx(length, rel=1e-12)
        assert surface.shape[2] == 3


def test_a_rigid_nose_is_drawn_as_at_rest():
    record = ImpactRecord.from_result(shoot(), "a nose", "a law")
    assert all(cut.body.size == cut.plastic.size == 0 for cut in record.cuts)
    assert record.bodies() == []
    with pytest.raises(InputError, match="no mushroom"):
        ShotResult.plot_mushroom.__wrapped__(record)
    last = cut_view(record, record.cuts[-1], "").projectile
    assert np.ptp(last[:, 1]) == pytest.approx(12e-3, rel=1e-3)
    assert record.surface(8e-6) is record.projectile


def test_paraview_has_the_bullet_beside_the_panel(tmp_path):
    shot = wc.impact(
        "S-720",
        "300 m/s",
        plies=2,
        projectile={"name": ".22 LR 2.6 g"},
        opening="50.8 mm",
        end_time="12 us",
        snapshot_interval="4 us",
    )
    shot.to_vtk(tmp_path)
    panels, bodies = (vtk.read_series(tmp_path / f"{name}.pvd") for name in ("panel", "body"))
    assert [time for _, time in bodies] == [time for _, time in panels]
    assert len(bodies) >= 3
    grids = [pyvista.read(file) for file, _ in bodies]
    tips = [grid.points[:, 2].max() for grid in grids]
    noses = [pyvista.read(file).field_data["projectile_z_m"][0] for file, _ in panels]
    assert tips == pytest.approx(noses, rel=1e-5)
    low, high = grids[-1].points.min(axis=0), 0.5 * shot.metal.width
    assert -low[:2] == pytest.approx([high, high], rel=1e-3)
    assert tips[-1] - low[2] == pytest.approx(shot.metal.length, rel=1e-5)
    # its elements have the strains, and as much volume as before but for what is compressed
    plastic = [grid["plastic_strain"].max() for grid in grids]
    assert plastic[-1] == pytest.approx(shot.metal.core_strain, rel=1e-6)
    assert np.all(np.diff(plastic) > 0)
    assert set(grids[-1]["jacket"]) == {0}
    # pressed one way alone: the whole strain is the plastic one and what is elastic, of 180 MPa over 3 G
    assert 0 < grids[-1]["strain"].max() - plastic[-1] < 0.011
    volumes = [grid.compute_cell_sizes()["Volume"].sum() for grid in grids]
    assert volumes == pytest.approx([volumes[0]] * len(volumes), rel=0.02)
    assert volumes[0] == pytest.approx(2.6e-3 / 11340, rel=0.03)  # a polygon for a circle


STRETCH = 0.9
SHEAR = 0.4


@pytest.mark.parametrize(
    "moved, strain",
    [
        # without a change of volume: logarithms l, l and -2 l
        (lambda r, z: (STRETCH * r, z / STRETCH**2), -2 * np.log(STRETCH)),
        # principal logarithms +-asinh(shear / 2), none around
        (lambda r, z: (r, z + SHEAR * r), 2 / np.sqrt(3) * np.arcsinh(SHEAR / 2)),
        # all alike: no deviator
        (lambda r, z: (1.1 * r, 1.1 * z), 0.0),
    ],
)
def test_the_equivalent_strain_is_the_textbook_one(moved, strain):
    drawing = Projectile(
        mass=2.86e-3, edge_radius=0.2e-3, body="metal", core="lead", **DRAWN
    ).turned
    drawn = SimpleNamespace(rest=drawing.places, corners=drawing.corners)
    now = np.stack(moved(*drawing.places.T), axis=-1)
    body = TurnedBody(drawn, now, np.zeros(len(drawing.corners)), np.zeros(3))
    assert body.strain == pytest.approx(np.full(len(drawing.corners), strain), abs=1e-12)


def test_the_page_in_motion_has_the_mushroom(struck):
    """Rings r, z and plastic strain of each instant, which the script of the page turns about the axis."""
    record = ImpactRecord.from_result(struck, "a bullet", "a law")
    shapes = [tuple(map(Shape.from_snapshot, shots)) for shots in struck.snapshots]
    instants = moving.collect_instants(record, shapes)
    head = json.loads(moving.moving(record, instants))
    rings = len(record.metal.outline)
    assert (head["rings"], head["instants"]) == (rings, len(instants))
    data = zlib.decompress(base64.b64decode(head["data"]))
    body = np.frombuffer(data, "<f4", 3 * rings * len(instants)).reshape(-1, rings, 3)
    last = record.cuts[-1]
    assert body[-1, :, :2] == pytest.approx(last.body[record.metal.outline], abs=1e-9)
    assert np.all(np.diff([np.ptp(one[:, 1]) for one in body]) < 0)
    assert 0 < body[-1, :, 2].max() == pytest.approx(head["mostPlastic"], rel=1e-6)
    assert body[-1, :, 2].max() < record.metal.core_strain
    section = moving.section(record, instants)
    assert f"plastic strain of {head['mostPlastic']:.2g}" in section.lead
