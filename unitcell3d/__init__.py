"""The quasi-static crossover of two yarns in three dimensions (dolfinx, PETSc), and the compression law it yields.

The public names are loaded when they are first used; `calibrate` needs dolfinx.
"""

from __future__ import annotations

from fabrics import lazy

__getattr__, __dir__ = lazy.public(__name__, __file__)
