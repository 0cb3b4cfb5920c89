"""Pictures of a bullet show it in the shape that it has at their time."""

import numpy as np
import pytest
import pyvista

import weavecell as wc
from fabrics import catalogue
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from weavecell.report.shot.chapters_shot import cut_view
from weavecell.report.shot.view import Panel
from weavecell.results import vtk
from weavecell.results.impact import ImpactRecord

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
    record = ImpactRecord.read(path)
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
    panel = Panel(record, [])
    for cut, length in zip(record.cuts, lengths):
        surface = panel.surface(cut.time)
        assert np.ptp(surface[..., 2]) == pytest.approx(length, rel=1e-12)
        assert surface.shape[2] == 3


def test_a_rigid_nose_is_drawn_as_at_rest():
    record = ImpactRecord.from_result(shoot(), "a nose", "a law")
    assert all(cut.outline.size == 0 for cut in record.cuts)
    assert record.surfaces() == []
    last = cut_view(record, record.cuts[-1], "").projectile
    assert np.ptp(last[:, 1]) == pytest.approx(12e-3, rel=1e-3)
    assert Panel(record, []).surface(8e-6) is record.projectile


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
    tips = [pyvista.read(file).points[:, 2].max() for file, _ in bodies]
    noses = [pyvista.read(file).field_data["projectile_z_m"][0] for file, _ in panels]
    assert tips == pytest.approx(noses, rel=1e-5)
    low, high = pyvista.read(bodies[-1][0]).points.min(axis=0), 0.5 * shot.metal.width
    assert -low[:2] == pytest.approx([high, high], rel=1e-3)
    assert tips[-1] - low[2] == pytest.approx(shot.metal.length, rel=1e-5)
