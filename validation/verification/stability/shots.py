"""A shot at a small panel of S-720, with numerical knobs that are allowed to be out of their range."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

from fabrics import catalogue, variants
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.panel import quality
from shellfabric.panel.model import Numerics, Panel
from shellfabric.panel.solver import PanelSolver
from shellfabric.projectile.projectile import Projectile

FABRIC, OPENING, VELOCITY, END = "S-720", 0.1, 92.5, 100e-6
TABLE = 51  # stretches: the peaks differ from those of 201 by 0.1 %


@dataclass(frozen=True)
class Beyond(Numerics):
    """Numerics that nobody checks: a map has to go where the code refuses to."""

    def __post_init__(self):
        pass


@dataclass(frozen=True)
class Answer:
    """What is read off a shot: peak tension (warp, weft) [N], velocity left [m/s], failed yarn segments, quality
    indicators."""

    peak: tuple
    velocity: float
    failed: int
    checks: tuple = ()

    def off(self, other: Answer) -> float:
        """[-] largest difference from another shot, peaks over the peaks and velocities over the strike velocity."""
        peaks = [abs(a / b - 1) for a, b in zip(self.peak, other.peak)]
        return max(*peaks, abs(self.velocity - other.velocity) / VELOCITY)


@cache
def table(form: str = "variational", straight: bool = False) -> CellTable:
    """Table of the cell; of straight yarns: neither crimp nor coupling."""
    fabric = catalogue.load(FABRIC).with_effective_density()
    if not straight:
        return CellModel(fabric, form=form).table(TABLE)
    fabric = variants.with_yarns(fabric, crimp=variants.NEARLY_STRAIGHT)
    return CellModel(fabric, form=form, model="decoupled").table(TABLE)


def fire(
    cell: CellTable | None = None, *, elements: int = 1, edge_radius: float = 0.3e-3, end: float = END,
    velocity: float = VELOCITY, failure: bool = True, **knobs: Any,
) -> Answer:  # fmt: skip
    """Shoot; raises UnstableError as `PanelSolver`."""
    panel = Panel(
        cell or table(), (OPENING, OPENING), Projectile(edge_radius=edge_radius), elements_per_crossover=elements,
        numerics=Beyond(threads=1, **knobs), failure=failure,
    )  # fmt: skip
    march = PanelSolver(panel, velocity, end).run()
    peak = tuple(float(tension) for tension in march.state.peak_tension)
    return Answer(peak, float(march.sample("v")[-1]), int(march.sample("failed_yarns")[-1]), quality.of_solver(march))
