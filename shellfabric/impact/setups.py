"""Set-ups of one ply and of a pack alike. The solver of packs is loaded with the first pack; one ply needs none."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

from fabrics.errors import UnstableError
from shellfabric.impact import single_ply
from shellfabric.impact.single_ply import ImpactSetup

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.impact.pack import PackSetup
    from shellfabric.panel.model import Panel
    from shellfabric.plies.model import Pack

Setup: TypeAlias = "ImpactSetup | PackSetup"


def first_ply(setup: Setup) -> ImpactSetup:
    """The set-up of the first ply, or of the one there is."""
    return setup if isinstance(setup, ImpactSetup) else setup.ply


def plies_of(setup: Setup) -> int:
    """Number of plies."""
    return 1 if isinstance(setup, ImpactSetup) else setup.plies


def with_ply(setup: Setup, **changes: Any) -> Setup:
    """The same with other fields of its plies' ImpactSetup."""
    if isinstance(setup, ImpactSetup):
        return replace(setup, **changes)
    return replace(setup, ply=replace(setup.ply, **changes))


def panel_of(setup: Setup, table: CellTable | None = None) -> Panel | Pack:
    """What the projectile strikes: the panel of a single ply, or the pack; parameters and exceptions as theirs."""
    return setup.panel(table) if isinstance(setup, ImpactSetup) else setup.pack(table)


def run(setup: Setup, table: CellTable | None = None, **others: Any) -> Any:
    """The result of `single_ply.run` or `pack.run`, with a table of the first ply's cell; others as theirs."""
    if isinstance(setup, ImpactSetup):
        return single_ply.run(setup, table=table, **others)
    from shellfabric.impact import pack

    return pack.run(setup, table=table, **others)


def fired(setup: Setup, **others: Any) -> tuple[Any, str]:
    """(result of `run`, why it became unstable or ""); of an unstable run the result is what it had computed.

    Raises
    ------
    UnstableError : a run that became unstable before it had a result
    """
    try:
        return run(setup, **others), ""
    except UnstableError as problem:
        if problem.result is None:
            raise
        return problem.result, str(problem)
