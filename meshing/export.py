"""Mesh files of a crossover, whole or not at all. Lengths are in metres.

.msh  gmsh's own format, written by gmsh: physical volumes "warp" and "weft", physical surfaces with the names of
      `Crossover.faces`, physical curves "warp_fibre" and "weft_fibre" (the fibre bars).
.vtu  for ParaView, written by meshio: hexahedra with the cell data yarn, fibre (unit vectors) and scaled_jacobian, and
      for every name of `Crossover.faces` a point data array that is 1 on its nodes.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole
from meshing.inputs import YARNS
from meshing.session import gmsh_session

LINE, QUADRILATERAL, HEXAHEDRON = 1, 3, 5  # gmsh's numbers of its element types


def write(crossover, path):
    """Write the mesh in the format that the suffix of `path` names.

    Raises
    ------
    InputError : the suffix is not .msh or .vtu; nothing is written
    """
    path = Path(path)
    if path.suffix not in WRITERS:
        raise InputError(key="mesh file", value=str(path), allowed=f"named {' or '.join('*' + s for s in WRITERS)}")
    with replace_whole(path) as beside:
        WRITERS[path.suffix](crossover, beside)


def _write_msh(crossover, path):
    """Give gmsh the finished mesh as discrete entities with physical names, and let it write."""
    with gmsh_session(crossover.fabric) as gmsh:
        count = [nodes.size for nodes in crossover.grids]
        for index, yarn in enumerate(YARNS):
            volume = gmsh.model.addDiscreteEntity(3)
            tags = np.arange(count[index]) + 1 + index * count[0]
            gmsh.model.mesh.addNodes(3, volume, tags, crossover.points[tags - 1].ravel())
            _add(gmsh, 3, volume, HEXAHEDRON, crossover.hexes[crossover.yarn == index], yarn)
        for name, quads in crossover.faces.items():
            _add(gmsh, 2, gmsh.model.addDiscreteEntity(2), QUADRILATERAL, quads, name)
        for yarn, bars in zip(YARNS, crossover.bars):
            _add(gmsh, 1, gmsh.model.addDiscreteEntity(1), LINE, bars, f"{yarn}_fibre")
        gmsh.write(str(path))


def _add(gmsh, dim, entity, kind, nodes, name):
    gmsh.model.mesh.addElementsByType(entity, kind, [], (nodes + 1).ravel())
    gmsh.model.setPhysicalName(dim, gmsh.model.addPhysicalGroup(dim, [entity]), name)


def _write_vtu(crossover, path):
    marks = {}
    for name, quads in crossover.faces.items():
        marks[name] = np.zeros(len(crossover.points), np.int8)
        marks[name][quads] = 1
    data = {
        "yarn": [crossover.yarn.astype(np.int32)],
        "fibre": [crossover.fibre],
        "scaled_jacobian": [crossover.scaled_jacobian],
    }
    meshio.Mesh(crossover.points, [("hexahedron", crossover.hexes)], point_data=marks, cell_data=data).write(path)


WRITERS = {".msh": _write_msh, ".vtu": _write_vtu}
