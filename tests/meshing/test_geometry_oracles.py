"""Volume, length, crimp and section of the meshed yarns by VTK, which cuts the file."""

import numpy as np
import pytest

from fabrics import catalogue
from meshing import crossover
from meshing.files import write_vtu

pyvista = pytest.importorskip("pyvista")
CASES = [("S-720", "sine"), ("S-720", "ellipse"), ("S-731", "conforming")]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: "-".join(case))
def mesh(request):
    name, section = request.param
    return crossover.build(catalogue.load(name), size=(20, 16, 4), section=section, domain="whole")


def cuts(path, yarn, axis, places):
    """Area [m2] and centroid (3,) [m] of the yarn's sections at places along it, by VTK from the written file."""
    grid = pyvista.read(path)
    body = grid.extract_cells(
        np.flatnonzero((grid["yarn"] == yarn) & (grid.celltypes == pyvista.CellType.HEXAHEDRON))
    )
    assert body.compute_cell_sizes()["Volume"].min() > 0
    found = []
    for place in places:
        origin = np.zeros(3)
        origin[axis] = place
        section = body.slice(normal=np.eye(3)[axis], origin=origin).triangulate()
        area = section.compute_cell_sizes()["Area"]
        found.append((area.sum(), np.average(section.cell_centers().points, axis=0, weights=area)))
    areas, centroids = zip(*found)
    return np.array(areas), np.array(centroids), body.volume


@pytest.mark.parametrize("yarn", [0, 1])
def test_vtk_finds_volume_section_and_crimp(mesh, yarn, tmp_path):
    write_vtu(mesh, tmp_path / "a.vtu")
    weave = catalogue.load(mesh.fabric).weave
    w, S0 = mesh.w[yarn], mesh.S0[yarn]
    places = np.linspace(-w, w, 62)[1:-1]
    areas, line, volume = cuts(tmp_path / "a.vtu", yarn, yarn, places)
    area = mesh.sections[yarn].area
    assert areas == pytest.approx(area, rel=6e-3)  # the polygon's chords; the volume loses as much
    assert volume == pytest.approx(mesh.fibre_area[yarn] * S0 / mesh.Vf0[yarn], rel=6e-3)
    assert volume == pytest.approx(areas.mean() * 2 * w, rel=1e-3)
    sign = 1 if yarn == 0 else -1
    z = sign * (mesh.h0[yarn] * np.cos(np.pi * places / (2 * w)) + mesh.shift / 2)
    assert np.allclose(line[:, 2], z, rtol=0, atol=0.01 * mesh.h0[yarn])
    assert np.allclose(line[:, 1 - yarn], 0, atol=1e-9)
    ends = (
        np.concatenate([[-w], places, [w]]),
        np.concatenate([[sign * mesh.shift / 2], line[:, 2], [sign * mesh.shift / 2]]),
    )
    length = np.hypot(*np.diff(ends)).sum()
    assert length / (2 * w) - 1 == pytest.approx(weave.yarns[yarn].crimp, rel=0.02)
