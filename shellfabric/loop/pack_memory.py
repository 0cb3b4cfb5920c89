"""Memory of a run of one ply or several, estimated from the numbers of its elements before any of
its arrays is made.

The bytes are of resident memory: growth of the peak beyond that of a small panel, per element, of
whole panels of S-720 of two sizes in each case (tests/shellfabric/impact/test_memory.py repeats one
of them).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from shellfabric.block.coupling import bricks_of
from shellfabric.loop import memory
from shellfabric.membrane.model import Panel
from shellfabric.yarns.model import crossings_of

ELEMENT = 385.0  # [bytes] of an element of one ply, with its grid of ghosts
CROSSING = 1300.0  # [bytes] of a crossing of resolved yarns with its four nodes
PACK = 740.0  # [bytes] of an element of a pack: 390 to 539, and 192 of the memory of its points where plies touch
SNAPSHOT = 70.0  # [bytes] of an element in a snapshot: 57 in one ply, 69 in a pack
CROSSING_SHOWN = (
    310.0  # [bytes] of a crossing in a snapshot: four nodes with six points and a tension each
)
WRITTEN = 1100.0  # [bytes] of an element of the largest ply while pictures and files are made, after the run: 1090
BRICK = 1270.0  # [bytes] of an element of the block behind the panel: 1266


def needed(plies: Sequence[Panel], snapshots: int = 0, written: bool = False) -> float:
    """Estimate the memory [bytes] that a run needs.

    Parameters
    ----------
    plies : all of them
    snapshots : how many are kept
    written : whether pictures and files are made of the results
    """
    counts = [ply.elements for ply in plies]
    element = ELEMENT
    if len(plies) > 1:
        element = PACK
    run = sum(counts) * element
    run += BRICK * bricks_of(plies[0])
    run += CROSSING * sum(map(crossings_of, plies))
    if written:
        run = max(run, WRITTEN * max(counts))
    shown = SNAPSHOT * sum(counts) + CROSSING_SHOWN * sum(map(crossings_of, plies))
    return run + snapshots * shown


def check(plies: Sequence[Panel], snapshots: int = 0, written: bool = False) -> None:
    """Refuse a run that needs more memory than is free; parameters as in `needed`.

    Raises
    ------
    InputError : with the numbers of elements and both amounts of memory
    """
    opening = plies[0].opening
    bricks = bricks_of(plies[0])
    content = f"{sum(ply.elements for ply in plies):,} elements"
    if bricks:
        content += f" with a block of {bricks:,}"
    without = needed(plies, 0, written)
    whole = needed(plies, snapshots, written)
    # what takes the larger part is to be changed
    if whole > 2 * without:
        content += f" with {snapshots:,} snapshots"
        memory.check(whole, content, "snapshot_interval", way="longer")
        return
    value: Any = opening
    if opening[0] == opening[1]:
        value = opening[0]
    memory.check(whole, content, "opening", value)
