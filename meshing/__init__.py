"""The yarn crossover of a plain weave in hexahedra: sections that close, mesh, quality, files and pictures.

The public names are loaded when they are first used; `write` needs gmsh and meshio.
"""

from __future__ import annotations

import importlib
from typing import Any

__all__ = [
    "Crossover",
    "Patch",
    "YarnMesh",
    "build",
    "build_patch",
    "write",
]

# Public name: its module, and its name there. For callers alone: no module of ours takes these names from here, so
# that no digest of code follows them.
_NAMES = {
    "Crossover": ("meshing.crossover", "Crossover"),
    "build": ("meshing.crossover", "build"),
    "write": ("meshing.formats.export", "write"),
    "YarnMesh": ("meshing.mesh", "YarnMesh"),
    "Patch": ("meshing.patch", "Patch"),
    "build_patch": ("meshing.patch", "build"),
}


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module 'meshing' has no attribute {name!r}")
    module, attribute = _NAMES[name]
    return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
