# Types of the public names, which __init__.py loads when they are first used.
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
