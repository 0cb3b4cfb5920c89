"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers.

The public names are loaded when they are first used; `run` fires one shot.
"""

from __future__ import annotations

from fabrics import lazy

__getattr__, __dir__ = lazy.public(__name__, __file__)
