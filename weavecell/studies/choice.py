"""What pinned yarns do not decide."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup


def doubt_order(setups: Sequence[ImpactSetup]) -> list[str]:
    """Write a line if targets of several weaves are compared with pinned yarns, which do not decide
    which weave stops more."""
    weaves = {fabric.weave.pattern.rows for setup in setups for fabric in setup.fabrics}
    if len(weaves) == 1 or all(setup.crossovers is not None for setup in setups):
        return []
    return ["which weave stops more is not decided by pinned yarns: crossovers = yarns"]
