"""The yarn crossover of a plain weave in hexahedra: sections that close, mesh, quality, files and pictures.

The public names are loaded when they are first used; `write` needs gmsh and meshio.
"""

from __future__ import annotations

from fabrics import lazy

__getattr__, __dir__ = lazy.public(__name__, __file__)
