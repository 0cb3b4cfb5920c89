"""Mesh files of a crossover or a patch by gmsh and meshio. Lengths are in metres.

.msh  gmsh's own format, written by gmsh: physical volumes with the names of the yarns, physical
surfaces with the names
      of `YarnMesh.faces`, physical curves "warp_fibre", "weft_3_fibre" ... (the fibre bars), and
      the element data bar_area [m2], 0 where there is no bar. End shells are the surfaces of the
      yarn ends.
.vtu  for ParaView, written by meshio: hexahedra, fibre bars and end shells with the cell data yarn
(its number),
      fibre (unit vectors; 0 in shells), bar_area [m2] and scaled_jacobian (not a number outside
      hexahedra), and for every part of a family ("warp_contact", ...) a point data array that is 1
      on its nodes.
"""

from __future__ import annotations

import meshio
import numpy as np

from fabrics.checks import FilePath
from meshing.mesh import YarnMesh
from meshing.session import gmsh_session

LINE, QUADRILATERAL, HEXAHEDRON = 1, 3, 5  # gmsh's numbers of its element types


def write_msh(mesh: YarnMesh, path: FilePath) -> None:
    """Write .msh: give gmsh the finished mesh as discrete entities with physical names, and let it
    write.

    Elements are numbered in the order of the file: bars, faces, bricks. Their data follow in the
    order of the numbers, and readers that take them in the order of the elements are right too.
    """
    with gmsh_session(mesh.fabric) as gmsh:
        volumes = [gmsh.model.addDiscreteEntity(3) for _ in mesh.names]
        for volume, nodes in zip(volumes, mesh.grids):
            gmsh.model.mesh.addNodes(
                3, volume, nodes.ravel() + 1, mesh.points[nodes.ravel()].ravel()
            )
        for name, bars in zip(mesh.names, mesh.bars):
            _add(gmsh, 1, gmsh.model.addDiscreteEntity(1), LINE, bars, f"{name}_fibre")
        for name, quads in mesh.faces.items():
            _add(gmsh, 2, gmsh.model.addDiscreteEntity(2), QUADRILATERAL, quads, name)
        for number, (volume, name) in enumerate(zip(volumes, mesh.names)):
            _add(gmsh, 3, volume, HEXAHEDRON, mesh.hexes[mesh.yarn == number], name)
        gmsh.write(str(path))
        areas = np.concatenate(mesh.bar_area)
        values = np.zeros(len(areas) + sum(len(q) for q in mesh.faces.values()) + len(mesh.hexes))
        values[: len(areas)] = areas
        view, tags = gmsh.view.add("bar_area"), np.arange(len(values)) + 1
        gmsh.view.addHomogeneousModelData(
            view, 0, mesh.fabric, "ElementData", tags, values, numComponents=1
        )
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
        gmsh.view.write(view, str(path), append=True)


def _add(gmsh, dim, entity, kind, nodes, name):
    gmsh.model.mesh.addElementsByType(entity, kind, [], (nodes + 1).ravel())
    gmsh.model.setPhysicalName(dim, gmsh.model.addPhysicalGroup(dim, [entity]), name)


def write_vtu(mesh: YarnMesh, path: FilePath) -> None:
    """Write .vtu."""
    marks = {}
    for name, members in mesh.collected.items():
        marks[name] = np.zeros(len(mesh.points), np.int8)
        for member in members:
            marks[name][mesh.faces[member]] = 1
    cells = [("hexahedron", mesh.hexes), ("line", np.concatenate(mesh.bars))]
    yarn = [mesh.yarn, np.repeat(np.arange(len(mesh.bars)), [len(bars) for bars in mesh.bars])]
    along = np.diff(mesh.points[cells[1][1]], axis=1)[:, 0]
    fibre = [mesh.fibre, along / np.linalg.norm(along, axis=1, keepdims=True)]
    for name, quads in mesh.shells.items():
        cells.append(("quad", quads))
        yarn.append(np.full(len(quads), mesh.names.index(name.rsplit("_", 1)[0])))
        fibre.append(np.zeros((len(quads), 3)))
    areas = [
        np.concatenate(mesh.bar_area) if kind == "line" else np.zeros(len(nodes))
        for kind, nodes in cells
    ]
    quality = [mesh.scaled_jacobian, *(np.full(len(nodes), np.nan) for _, nodes in cells[1:])]
    data = {
        "yarn": [part.astype(np.int32) for part in yarn],
        "fibre": fibre,
        "bar_area": areas,
        "scaled_jacobian": quality,
    }
    meshio.Mesh(mesh.points, cells, point_data=marks, cell_data=data).write(path)
