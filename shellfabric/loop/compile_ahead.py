"""The kernels of a run, compiled by two processes where the cache is cold.

Units do not depend on each other. This process compiles those that every run calls from the front
of one list, a child from its end. Both look into the cache before each, so that they meet in the
middle.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from fabrics.base.kernel_cache import one_compiler_a_node
from shellfabric.jit.compile import UNITS, Cell
from shellfabric.loop import loop
from shellfabric.membrane import quality_kernels

OF_A_PLY = (
    "shellfabric.loop",
    "shellfabric.membrane",
    "shellfabric.surface",
    "shellfabric.contact",
    "shellfabric.projectile",
)
OF_A_PACK = ("shellfabric.plies",)
ENTRIES = loop.advance, quality_kernels.sample  # their files know all units
_CHILD = "from shellfabric.loop.compile_ahead import cells; [cell.fill() for cell in cells({}, {})[::-1]]"


def cells(grid: int, several: bool) -> list[Cell]:
    """List the cells of the units that each run calls of a ply, or of several, on a uniform or a
    graded grid."""
    found = _cells_in(OF_A_PLY, grid)
    if several:
        found += _cells_in(OF_A_PACK, grid)
    return found


def _cells_in(folders, grid):
    """List the cells of the units of some folders that each run calls."""
    usual = [unit for unit in UNITS if not unit.later]
    return [unit.cell(grid) for unit in usual if unit.py_func.__module__.startswith(folders)]


def fill(grid: int, several: bool) -> None:
    """Compile what `cells` has, beside a child process; nothing if the first unit of a ply, and of
    several the first of a pack, is in the cache."""
    if one_compiler_a_node.cache_info().currsize:
        return
    is_missing = _cells_in(OF_A_PLY, grid)[0].fill()
    if several:
        is_missing = _cells_in(OF_A_PACK, grid)[0].fill() or is_missing
    if not is_missing:
        return
    with _child(_CHILD.format(grid, several)):
        for cell in cells(grid, several):
            cell.fill()


@contextmanager
def _child(code: str) -> Iterator[None]:
    """A process that runs code beside what is done in this block, where there can be one."""
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    # -P: the folder that the user is in is not among the paths, if it is not here
    command = [sys.executable, "-P", "-c", code]
    child = None
    with suppress(OSError):
        child = subprocess.Popen(
            command,
            env=os.environ | {"PYTHONPATH": paths},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
    try:
        yield
    finally:
        if child is not None:
            child.terminate()
            child.wait()
