"""Mesh files of a crossover or a patch by gmsh and meshio. Lengths are in metres.

.msh  gmsh's own format, of the geometry that gmsh meshed: physical volumes with the names of the
      yarns, physical surfaces with the names of `YarnMesh.faces`, physical curves "warp_fibre",
      "weft_3_fibre" ... (the fibre bars), and the element data bar_area [m2], 0 where there is no
      bar. End shells are the surfaces of the yarn ends. Nodes have the numbers of the `YarnMesh`.
.geo  the geometry itself as a gmsh script (`meshing.geometry`), to be changed and meshed in gmsh.
.vtu  for ParaView, written by meshio: hexahedra, fibre bars and end shells with the cell data yarn
(its number),
      fibre (unit vectors; 0 in shells), bar_area [m2] and scaled_jacobian (not a number outside
      hexahedra), and for every part of a family ("warp_contact", ...) a point data array that is 1
      on its nodes.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from fabrics.base.checks import FilePath
from meshing.generate import ELEMENTS, named_entities, read_groups, run_script
from meshing.mesh import YarnMesh, numbering
from meshing.session import gmsh_session

LINE = 1  # gmsh's number of its element type


def write_geo(mesh: YarnMesh, path: FilePath) -> None:
    """Write .geo: the script from which gmsh made the mesh."""
    Path(path).write_text(mesh.script, encoding="ascii")


def write_msh(mesh: YarnMesh, path: FilePath) -> None:
    """Write .msh: gmsh meshes the geometry again, takes the node numbers of `mesh`, and writes.

    Elements are numbered in the order of the file: bars, faces, bricks. Their data follow in the
    order of the numbers, and readers that take them in the order of the elements are right too.
    """
    with gmsh_session(mesh.fabric) as gmsh:
        run_script(gmsh, mesh.script)
        _number_again(gmsh, mesh)
        gmsh.write(str(path))
        areas = np.concatenate(mesh.bar_area)
        others = sum(map(len, mesh.faces.values())) + len(mesh.hexes)
        values = np.concatenate([areas, np.zeros(others)])
        view = gmsh.view.add("bar_area")
        tags = np.arange(len(values)) + 1
        gmsh.view.addHomogeneousModelData(
            view, 0, gmsh.model.getCurrent(), "ElementData", tags, values, numComponents=1
        )
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
        gmsh.view.write(view, str(path), append=True)


def _number_again(gmsh, mesh):
    """Give gmsh's nodes the numbers of `mesh` and its elements their corners in the order of
    `mesh`, and add the bars on a curve for each yarn, which the geometry has not."""
    groups = read_groups(gmsh)
    taken = numbering(groups, mesh.names, mesh.families, mesh.quarter)
    # the points of a spline have nodes too, which no element takes
    number = np.full(len(groups.points), -1)
    number[taken] = np.arange(len(taken))
    elements = []
    volumes = {}
    for name, (dimension, tag) in named_entities(gmsh):
        if dimension == 2:
            ordered = mesh.faces[name]
        else:
            volumes.setdefault(name, tag)
            ordered = mesh.hexes[mesh.yarn == mesh.names.index(name)]
        kind, count = ELEMENTS[dimension]
        _, corners = gmsh.model.mesh.getElementsByType(kind, tag)
        corners = number[corners.astype(np.int64) - 1].reshape(-1, count)
        row_of = {frozenset(row): row for row in ordered.tolist()}
        rows = np.array([row_of[frozenset(row)] for row in corners.tolist()])
        elements.append((tag, kind, rows))
    gmsh.model.mesh.clear()
    # on the first volume of a yarn all together: readers then take them in the order of `mesh`
    for name, grid in zip(mesh.names, mesh.grids):
        nodes = grid.ravel()
        gmsh.model.mesh.addNodes(3, volumes[name], nodes + 1, mesh.points[nodes].ravel())
    added = 0
    for name, bars in zip(mesh.names, mesh.bars):
        curve = gmsh.model.addDiscreteEntity(1)
        tags = np.arange(added, added + len(bars)) + 1
        gmsh.model.mesh.addElementsByType(curve, LINE, tags, (bars + 1).ravel())
        added += len(bars)
        group = gmsh.model.addPhysicalGroup(1, [curve])
        gmsh.model.setPhysicalName(1, group, f"{name}_fibre")
    for tag, kind, rows in elements:
        tags = np.arange(added, added + len(rows)) + 1
        gmsh.model.mesh.addElementsByType(tag, kind, tags, (rows + 1).ravel())
        added += len(rows)


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
