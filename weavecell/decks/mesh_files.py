"""Files of a mesh, by their suffix: .msh, .geo, .vtu (`meshing.files`), and the input files of other
solvers.

.k    LS-DYNA keyword file (`mesh_ls_dyna`)
.inp  Abaqus input file (`mesh_abaqus`)
.rad  OpenRadioss starter file (`mesh_radioss`), which that program wants named NAME_0000.rad
"""

from __future__ import annotations

from pathlib import Path

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import replace_whole
from fabrics.fabric import Fabric
from meshing import files
from meshing.mesh import YarnMesh
from weavecell.decks import mesh_abaqus, mesh_ls_dyna, mesh_radioss

WRITERS = {".msh": files.write_msh, ".geo": files.write_geo, ".vtu": files.write_vtu}
DECKS = {".k": mesh_ls_dyna.texts, ".inp": mesh_abaqus.texts, ".rad": mesh_radioss.texts}


def write(mesh: YarnMesh, fabric: Fabric, path: FilePath) -> None:
    """Write a `Crossover` or `Patch` whole, or not at all, in the format that the suffix of `path`
    names.

    Parameters
    ----------
    mesh : YarnMesh
    fabric : Fabric that was meshed, whose linear materials the input files hold
    path : of the file, which ends in .msh, .geo, .vtu, .k, .inp or .rad

    Raises
    ------
    InputError : there is no such format; nothing is written
    """
    path = Path(path)
    known = WRITERS | DECKS
    if path.suffix not in known:
        allowed = " or ".join(f"*{suffix}" for suffix in known)
        raise InputError(key="mesh file", value=str(path), allowed=f"named {allowed}")
    with replace_whole(path) as beside:
        if path.suffix in WRITERS:
            WRITERS[path.suffix](mesh, beside)
        else:
            with open(beside, "w", encoding="ascii") as file:
                file.writelines(DECKS[path.suffix](mesh, fabric))
