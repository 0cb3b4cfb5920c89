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

from fabrics.base.checks import FilePath
from meshing.mesh import YarnMesh
from meshing.session import gmsh_session

LINE, QUADRILATERAL, HEXAHEDRON = 1, 3, 5  # gmsh's numbers of its element types


def write_msh(mesh: YarnMesh, path: FilePath) -> None:
    """Write .msh: gmsh is given the mesh as discrete entities with physical names, and writes.

    Elements are numbered in the order of the file: bars, faces, bricks. Their data follow in the
    order of the numbers, and readers that take them in the order of the elements are right too.
    """
    with gmsh_session(mesh.fabric) as gmsh:
        volumes = [gmsh.model.addDiscreteEntity(3) for _ in mesh.names]
        for volume, nodes in zip(volumes, mesh.grids):
            places = mesh.points[nodes.ravel()].ravel()
            gmsh.model.mesh.addNodes(3, volume, nodes.ravel() + 1, places)
        for name, bars in zip(mesh.names, mesh.bars):
            curve = gmsh.model.addDiscreteEntity(1)
            _add_elements(gmsh, (1, curve), LINE, bars, f"{name}_fibre")
        for name, quads in mesh.faces.items():
            surface = gmsh.model.addDiscreteEntity(2)
            _add_elements(gmsh, (2, surface), QUADRILATERAL, quads, name)
        for number, (volume, name) in enumerate(zip(volumes, mesh.names)):
            bricks = mesh.hexes[mesh.yarn == number]
            _add_elements(gmsh, (3, volume), HEXAHEDRON, bricks, name)
        gmsh.write(str(path))
        areas = np.concatenate(mesh.bar_area)
        others = sum(map(len, mesh.faces.values())) + len(mesh.hexes)
        values = np.concatenate([areas, np.zeros(others)])
        view = gmsh.view.add("bar_area")
        tags = np.arange(len(values)) + 1
        gmsh.view.addHomogeneousModelData(
            view, 0, mesh.fabric, "ElementData", tags, values, numComponents=1
        )
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
        gmsh.view.write(view, str(path), append=True)


def _add_elements(gmsh, entity, kind, nodes, name):
    """Add elements to an entity (dimension, tag), and name it."""
    dimension, tag = entity
    gmsh.model.mesh.addElementsByType(tag, kind, [], (nodes + 1).ravel())
    group = gmsh.model.addPhysicalGroup(dimension, [tag])
    gmsh.model.setPhysicalName(dimension, group, name)


def write_vtu(mesh: YarnMesh, path: FilePath) -> None:
    """Write .vtu: hexahedra, bars, end shells, with their data."""
    marks = {}
    for name, members in mesh.collected.items():
        marks[name] = np.zeros(len(mesh.points), np.int8)
        for member in members:
            marks[name][mesh.faces[member]] = 1
    bars = np.concatenate(mesh.bars)
    cells = [("hexahedron", mesh.hexes), ("line", bars)]
    yarn = [mesh.yarn, np.repeat(np.arange(len(mesh.bars)), list(map(len, mesh.bars)))]
    along = mesh.points[bars[:, 1]] - mesh.points[bars[:, 0]]
    fibre = [mesh.fibre, along / np.linalg.norm(along, axis=1, keepdims=True)]
    area = [np.zeros(len(mesh.hexes)), np.concatenate(mesh.bar_area)]
    quality = [mesh.scaled_jacobian, np.full(len(bars), np.nan)]
    for name, quads in mesh.shells.items():
        none = np.zeros(len(quads))
        cells.append(("quad", quads))
        yarn.append(none + mesh.names.index(name.rsplit("_", 1)[0]))
        fibre.append(np.zeros((len(quads), 3)))
        area.append(none)
        quality.append(none + np.nan)
    data = {
        "yarn": [part.astype(np.int32) for part in yarn],
        "fibre": fibre,
        "bar_area": area,
        "scaled_jacobian": quality,
    }
    meshio.Mesh(mesh.points, cells, point_data=marks, cell_data=data).write(path)
