# Public names and their modules: `fabrics.lazy.public` loads each when it is first used.
from meshing.crossover import Crossover, build
from meshing.formats.export import write
from meshing.mesh import YarnMesh
from meshing.patch import Patch
from meshing.patch import build as build_patch

__all__ = [
    "Crossover",
    "Patch",
    "YarnMesh",
    "build",
    "build_patch",
    "write",
]
