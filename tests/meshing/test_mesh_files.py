"""Mesh files of gmsh and ParaView read back by other programs."""

import meshio
import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from meshing.files import write_msh, write_vtu


def of_group(read, name, values):
    """Dimension of a physical group as meshio read it, and what `values` holds for its cells, a list of blocks."""
    tag, dim = read.field_data[name]
    tags = read.cell_data["gmsh:physical"]
    return dim, np.concatenate(
        [block[t == tag] for block, t in zip(values, tags) if np.any(t == tag)]
    )


def test_msh_read_by_meshio(mesh, tmp_path):
    path = tmp_path / "a.msh"
    write_msh(mesh, path)
    read = meshio.read(path)
    nodes = [block.data for block in read.cells]
    areas = read.cell_data["bar_area"]
    assert_allclose(read.points, mesh.points, rtol=1e-15, atol=0)  # gmsh writes 16 digits
    expected = {name: (2, quads) for name, quads in mesh.faces.items()}
    for number, name in enumerate(mesh.names):
        expected |= {
            name: (3, mesh.hexes[mesh.yarn == number]),
            f"{name}_fibre": (1, mesh.bars[number]),
        }
        assert_allclose(
            of_group(read, f"{name}_fibre", areas)[1].ravel(),
            mesh.bar_area[number],
            rtol=1e-15,
            atol=0,
        )
        assert not of_group(read, name, areas)[1].any()
    assert set(read.field_data) == set(expected)
    for name, (dim, cells) in expected.items():
        found_dim, found = of_group(read, name, nodes)
        assert found_dim == dim
        assert sorted(found.tolist()) == sorted(cells.tolist()), name


def test_vtu_read_by_meshio(mesh, tmp_path):
    path = tmp_path / "a.vtu"
    write_vtu(mesh, path)
    read = meshio.read(path)
    assert_array_equal(read.points, mesh.points)
    bars = np.repeat(np.arange(len(mesh.bars)), [len(pairs) for pairs in mesh.bars])
    expected = {
        "hexahedron": (mesh.hexes, mesh.yarn, np.zeros(len(mesh.hexes))),
        "line": (np.concatenate(mesh.bars), bars, np.concatenate(mesh.bar_area)),
    }
    for block, yarn, area in zip(read.cells, read.cell_data["yarn"], read.cell_data["bar_area"]):
        if block.type in expected:
            for found, wanted in zip((block.data, yarn, area), expected.pop(block.type)):
                assert np.array_equal(found, wanted), block.type
    assert expected == {}
    assert_array_equal(read.cell_data["fibre"][0], mesh.fibre)
    assert_array_equal(read.cell_data["scaled_jacobian"][0], mesh.scaled_jacobian)
    shells = [quad for quads in mesh.shells.values() for quad in quads]
    assert_array_equal(read.cells_dict.get("quad", []), shells)
    for name in mesh.collected:
        assert_array_equal(np.flatnonzero(read.point_data[name]), np.unique(mesh.groups[name]))
