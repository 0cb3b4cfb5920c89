"""Mesh files read back by other programs; nothing is left of a failed one."""

import meshio
import numpy as np
import pytest
from hexahedra import volumes

from fabrics import catalogue
from fabrics.errors import InputError
from meshing import patch
from meshing.crossover import build
from meshing.formats import export
from meshing.session import gmsh_session


@pytest.fixture(scope="module", params=["quarter", "whole"])
def crossover(request):
    return build(catalogue.load("S-720"), size=(5, 4, 2), domain=request.param)


def cells(mesh, name):
    """Connectivity of a physical group as meshio read it."""
    tag, dim = mesh.field_data[name]
    blocks = zip(mesh.cells, mesh.cell_data["gmsh:physical"])
    return np.concatenate([b.data[t == tag] for b, t in blocks if np.any(t == tag)]), dim


def of_group(mesh, name, data):
    """Cell data of a physical group."""
    tag, _ = mesh.field_data[name]
    blocks = zip(mesh.cell_data[data], mesh.cell_data["gmsh:physical"])
    return np.concatenate([values[t == tag].ravel() for values, t in blocks if np.any(t == tag)])


def test_msh_read_by_meshio(crossover, tmp_path):
    path = tmp_path / "a.msh"
    export.write(crossover, path)
    mesh = meshio.read(path)
    assert np.allclose(mesh.points, crossover.points, rtol=1e-15, atol=0)  # gmsh writes 16 digits
    for index, yarn in enumerate(("warp", "weft")):
        hexes, dim = cells(mesh, yarn)
        assert dim == 3
        assert np.array_equal(hexes, crossover.hexes[crossover.yarn == index])
        bars, dim = cells(mesh, f"{yarn}_fibre")
        assert dim == 1
        assert np.array_equal(bars, crossover.bars[index])
        assert np.allclose(of_group(mesh, f"{yarn}_fibre", "bar_area"), crossover.bar_area[index], rtol=1e-15, atol=0)
        assert not of_group(mesh, yarn, "bar_area").any()
    for name, expected in crossover.faces.items():
        quads, dim = cells(mesh, name)
        assert dim == 2
        assert np.array_equal(quads, expected)


def test_msh_read_by_gmsh(crossover, tmp_path):
    path = tmp_path / "a.msh"
    export.write(crossover, path)
    with gmsh_session("read") as gmsh:
        gmsh.open(str(path))
        groups = {gmsh.model.getPhysicalName(*group): group[0] for group in gmsh.model.getPhysicalGroups()}
        _, coordinates, _ = gmsh.model.mesh.getNodes()
        places, weights = gmsh.model.mesh.getIntegrationPoints(5, "Gauss4")
        _, determinants, _ = gmsh.model.mesh.getJacobians(5, places)
    assert groups == {"warp": 3, "weft": 3, "warp_fibre": 1, "weft_fibre": 1} | dict.fromkeys(crossover.faces, 2)
    assert len(coordinates) == crossover.points.size
    determinants = np.reshape(determinants, (-1, len(weights)))
    assert np.min(determinants) > 0
    ours = volumes(crossover.points, crossover.hexes)
    assert sorted(determinants @ weights) == pytest.approx(sorted(ours), rel=1e-10)


def test_vtu_read_by_meshio(crossover, tmp_path):
    path = tmp_path / "folder" / "a.vtu"
    export.write(crossover, path)
    mesh = meshio.read(path)
    assert np.array_equal(mesh.points, crossover.points)
    assert np.array_equal(mesh.cells_dict["hexahedron"], crossover.hexes)
    assert np.array_equal(mesh.cell_data["yarn"][0], crossover.yarn)
    assert np.array_equal(mesh.cell_data["fibre"][0], crossover.fibre)
    assert np.array_equal(mesh.cell_data["scaled_jacobian"][0], crossover.scaled_jacobian)
    assert np.array_equal(mesh.cells_dict["line"], np.concatenate(crossover.bars))
    assert np.array_equal(mesh.cell_data["bar_area"][1], np.concatenate(crossover.bar_area))
    assert not mesh.cell_data["bar_area"][0].any()
    assert np.array_equal(mesh.cell_data["yarn"][1], np.repeat([0, 1], [len(bars) for bars in crossover.bars]))
    for name, quads in crossover.faces.items():
        assert np.array_equal(np.flatnonzero(mesh.point_data[name]), np.unique(quads))


def test_files_of_a_patch_with_end_shells(tmp_path):
    mesh = patch.build(catalogue.load("S-728"), (2, 3), size=(3, 2, 1), end_shells=2e-5)
    export.write(mesh, tmp_path / "a.msh")
    export.write(mesh, tmp_path / "a.vtu")
    msh, vtu = (meshio.read(tmp_path / name) for name in ("a.msh", "a.vtu"))
    for number, name in enumerate(mesh.names):
        assert np.array_equal(cells(msh, name)[0], mesh.hexes[mesh.yarn == number])
        assert np.array_equal(cells(msh, f"{name}_fibre")[0], mesh.bars[number])
        assert np.allclose(of_group(msh, f"{name}_fibre", "bar_area"), mesh.bar_area[number], rtol=1e-15, atol=0)
        assert np.array_equal(cells(msh, f"{name}_end")[0], mesh.shells[f"{name}_end"])
    assert np.array_equal(
        np.concatenate([b.data for b in vtu.cells if b.type == "quad"]), np.concatenate(list(mesh.shells.values()))
    )
    assert np.array_equal(np.concatenate(vtu.cell_data["yarn"])[: len(mesh.hexes)], mesh.yarn)
    for name in mesh.collected:
        assert np.array_equal(np.flatnonzero(vtu.point_data[name]), np.unique(mesh.groups[name]))


def test_another_suffix_is_refused(crossover, tmp_path):
    with pytest.raises(InputError) as caught:
        export.write(crossover, tmp_path / "a.stl")
    assert str(caught.value) == (
        f"mesh file = '{tmp_path / 'a.stl'}': must be named *.msh or *.vtu or *.k or *.inp or *.rad"
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", sorted(export.WRITERS))
def test_a_failed_file_leaves_the_old_one(crossover, tmp_path, monkeypatch, suffix):
    path = tmp_path / f"a{suffix}"
    path.write_text("old")

    def fails(crossover, beside):
        beside.write_text("half a mesh")
        raise OSError("disk full")

    monkeypatch.setitem(export.WRITERS, suffix, fails)
    with pytest.raises(OSError, match="disk full"):
        export.write(crossover, path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
