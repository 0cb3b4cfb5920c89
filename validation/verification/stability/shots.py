"""Shots at a small panel of S-720, with numerical knobs that are allowed to be out of their range, and what a shot is
compared with."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from statistics import median
from typing import Any

from fabrics import catalogue, variants
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.panel import quality
from shellfabric.panel.model import Numerics, Panel
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver
from validation.models import variants as comparison
from validation.verification.stability.core import STABLE, WRONG, Outcome

FABRIC, OPENING, VELOCITY, END = "S-720", 0.1, 92.5, 100e-6
TABLE = 51  # stretches: the peaks differ from those of 201 by 0.1 %
SOFT = 2 * Numerics.cfl  # Courant factor at which the default contact is as stiff as that of `step`


@dataclass(frozen=True)
class Beyond(Numerics):
    """Numerics that nobody checks: a map has to go where the code refuses to."""

    def __post_init__(self):
        pass


@dataclass(frozen=True)
class Answer:
    """What is read off a shot: peak tension (warp, weft) [N] of any ply, velocity left [m/s], cut yarns, quality
    indicators."""

    peak: tuple
    velocity: float
    cut_yarns: float
    checks: tuple = ()

    def off(self, other: Answer, strike: float = VELOCITY) -> float:
        """[-] largest difference from another shot, peaks over the peaks and velocities over a strike velocity."""
        peaks = [abs(a / b - 1) for a, b in zip(self.peak, other.peak)]
        return max(*peaks, abs(self.velocity - other.velocity) / strike)


@cache
def table(form: str = "variational", straight: bool = False, crossovers: int = 1) -> CellTable:
    """Table of the cell of an element of so many crossovers, squared; of straight yarns: neither crimp nor coupling."""
    fabric = catalogue.load(FABRIC).with_effective_density()
    if straight:
        fabric = variants.with_yarns(fabric, crimp=comparison.NEARLY_STRAIGHT)
        return CellModel(fabric, form=form, model="decoupled").table(TABLE)
    return CellModel(comparison.homogenised(fabric, crossovers) if crossovers > 1 else fabric, form=form).table(TABLE)


def fire(
    *, form: str = "variational", straight: bool = False, crossovers: int = 1, elements: int = 1,
    contact_points: int | None = None, edge_radius: float = 0.3e-3, end: float = END, velocity: float = VELOCITY,
    failure: bool = True, **knobs: Any,
) -> Answer:  # fmt: skip
    """Shoot; raises UnstableError as `PackSolver`.

    Parameters
    ----------
    form, straight, crossovers : as of `table`; tensions are those of one yarn
    elements, contact_points : along a crossover
    knobs : of `Numerics`
    """
    points = None if contact_points is None else contact_points * crossovers
    panel = Panel(
        table(form, straight, crossovers), (OPENING, OPENING), Projectile(edge_radius=edge_radius),
        elements_per_crossover=elements, numerics=Beyond(threads=1, contact_points=points, **knobs), failure=failure,
    )  # fmt: skip
    march = PackSolver(panel, velocity, end).run()
    peak = tuple(float(tension) / crossovers for tension in march.state.peak_tension)
    return Answer(peak, float(march.sample("v")[-1]), float(march.sample("cut_yarns")[-1]), quality.of_solver(march))


def step(*, cfl: float, neighbours: int = 1, **scene: Any) -> Answer:
    """Shoot with a time step over its bound, 2 / w (sqrt(1 + xi^2) - xi) of the highest mode, of which
    `shellfabric.panel.time_step` takes what form, crimp and viscosity leave.

    The contact is given in units of nodal mass / dt^2: it would be four times as stiff at half the step, which moves
    peaks by some per cent and has nothing to do with the step. Here it is held, at the stiffness that the default has
    at twice the default step, so that it is not the first to fail beyond that.

    Without viscosity crimped yarns ring, and their peaks are an extreme of chance: they jump by up to a tenth from one
    step to the next. There an answer is the median over some `neighbours`, steps each 1 % of the longest apart; the
    longest is the one that counts.
    """
    steps = [cfl * (1 - 0.01 * n) for n in range(neighbours)]
    found = [fire(cfl=each, penalty=Numerics.penalty * (each / SOFT) ** 2, **scene) for each in steps]
    peak = tuple(map(median, zip(*(one.peak for one in found))))
    velocity, cut = (median(getattr(one, name) for one in found) for name in ("velocity", "cut_yarns"))
    return Answer(peak, velocity, cut, found[0].checks)


@cache
def compared_with(shoot: Callable[..., Any], scene: tuple[tuple[str, Any], ...]) -> Any:
    """The answer that others are compared with, shot once."""
    return shoot(**dict(scene))


def shot(*, allowed: float, reference: Mapping[str, Any], **scene: Any) -> Outcome:
    """STABLE where peaks and velocity are those of the reference, and no yarn fails that does not there."""
    found, fine = fire(**scene), compared_with(fire, tuple(reference.items()))
    off = found.off(fine)
    good = off <= allowed and (found.cut_yarns == 0) == (fine.cut_yarns == 0)
    cut = f"{found.cut_yarns:.1f} cut yarns, {fine.cut_yarns:.1f} on the finest mesh"
    cut = cut if found.cut_yarns or fine.cut_yarns else ""
    return Outcome(STABLE if good else WRONG, 100 * off, cut, found.checks)


def time_step(*, allowed: float, allowed_ringing: float, reference: Mapping[str, Any], **scene: Any) -> Outcome:
    """STABLE where peaks and velocity are those of the reference; `allowed_ringing` where yarns ring."""
    found = step(**scene)
    off = found.off(compared_with(step, tuple(reference.items())))
    limit = allowed_ringing if "neighbours" in scene else allowed
    return Outcome(STABLE if off <= limit else WRONG, 100 * off, checks=found.checks)
