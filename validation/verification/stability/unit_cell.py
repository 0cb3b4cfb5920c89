"""The 3D crossover and its yarn: fibre bars and integration (thesis Figure 3-4), and the load step of equilibria."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from fabrics import catalogue
from fabrics.errors import UnstableError
from meshing import crossover
from shellfabric.panel import quality
from unitcell3d.cases import single_yarn
from unitcell3d.material import solid_law
from validation.verification.crossover_convergence import cases, study
from validation.verification.stability.core import STABLE, WRONG, Outcome

FABRIC = "S-720"
YARN = 8, 10, 3  # elements
SIZE = (8, 6, 2)  # on 4 x 3 x 1 one step over the whole path converges, with a thousand times the penalty even
LINES = 44  # of fibres in each half of a yarn


@cache
def mesh() -> crossover.Crossover:
    """A quarter crossover with LINES fibre lines in each half of a yarn."""
    return crossover.build(catalogue.load(FABRIC), size=YARN)


def bars(*, bars: int, reduced: bool, allowed: float) -> Outcome:
    """STABLE where a crimped yarn of solids is pulled straight and no node strays from its neighbours along the yarn.

    Parameters
    ----------
    bars : fibre lines that carry bars
    reduced : one-point integration, which leaves modes without energy, or full
    allowed : [-] amplitude from node to node over the thickness
    """
    integration = solid_law.ONE_POINT if reduced else solid_law.FULL
    record = single_yarn.pull(
        mesh(), catalogue.load(FABRIC), 0, bars=None if bars == LINES else bars, integration=integration, rows=12
    )
    if record.failed:
        raise UnstableError(record.failed)
    thickness = 2 * catalogue.load(FABRIC).weave.h01
    off = float(max(record["astray"])) / thickness
    found = quality.of_yarn(record["astray"], thickness)
    return Outcome(STABLE if off <= allowed else WRONG, 100 * off, checks=found)


def equilibria(step: float, path: str) -> tuple[dict[str, float], int]:
    """Forces at the end of a path, and tangents, without the halving of steps that the code falls back on."""
    fabric, paths = study.scene()
    only = (("first", step), ("largest", step), ("least", step))
    found = cases.solve(fabric, {path: paths[path]}, cases.Case(size=SIZE, steps=only))
    if found["failed"]:
        raise UnstableError(found["failed"][path])
    return found["values"], found["tangents"]


@cache
def _forces(step: float, path: str) -> dict[str, float]:
    return equilibria(step, path)[0]


def load_step(*, step: float, path: str, allowed: float, reference: Mapping[str, Any]) -> Outcome:
    """STABLE where the path reaches its end, with the forces that small steps give."""
    values, tangents = equilibria(step, path)
    right = _forces(**reference)
    off = max(abs(value / right[name] - 1) for name, value in values.items())
    message = f"forces off by {100 * off:.1g} %" if off > allowed else ""
    return Outcome(STABLE if off <= allowed else WRONG, tangents, message)
