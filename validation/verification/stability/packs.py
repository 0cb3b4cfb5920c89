"""Shots at a pack: time step and form of the contact between plies (`shellfabric.plies.contact_kernels`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from fabrics import catalogue
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.panel import quality
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.solver.pack_solver import PackSolver
from validation.verification.stability import shots
from validation.verification.stability.core import STABLE, WRONG, Outcome

FABRIC, VELOCITY, OPENING, PLIES, END = "S-728", 91.0, 0.12, 4, 170e-6


@dataclass(frozen=True)
class Beyond(PlyContact):
    """Knobs that nobody checks."""

    def __post_init__(self):
        pass


@dataclass(frozen=True)
class Answer(shots.Answer):
    """Of a shot at a pack, with its deepest penetration [-]."""

    deepest: float = 0.0


@cache
def ply() -> Panel:
    """A ply of the pack."""
    cell = CellModel(catalogue.load(FABRIC).with_effective_density())
    return Panel(cell.table(shots.TABLE), (OPENING, OPENING), numerics=Numerics(threads=1))


def fire(**knobs: Any) -> Answer:
    """Shoot with knobs of `PlyContact`; raises UnstableError as `PackSolver`."""
    stiffest = PlyLaw.solid(ply().fabric)  # other laws reach the stiffness that bounds the step only at high pressures
    march = PackSolver(Pack.stacked(ply(), PLIES, contact=Beyond(**knobs), law=stiffest), VELOCITY, END).run()
    peak = tuple(float(tension) for tension in march.peak_tensions[..., 0].max(axis=0))
    cut = float(march.sample("cut_yarns")[-1])
    checks = quality.of_solver(march)
    return Answer(peak, float(march.sample("v")[-1]), cut, checks, float(march.deepest.max()))


def pack(*, allowed: float, reference: Mapping[str, Any], **knobs: Any) -> Outcome:
    """STABLE where peaks and velocity are those of the reference, no yarn fails and no ply goes through the next."""
    found = fire(**knobs)
    off = found.off(shots.compared_with(fire, tuple(reference.items())), VELOCITY)
    good = off <= allowed and found.cut_yarns == 0 and found.deepest < 1
    message = f"{found.cut_yarns:.1f} cut yarns" if found.cut_yarns else ""
    message = message or (f"{found.deepest:.2g} of a ply's thickness deep" if found.deepest >= 1 else "")
    return Outcome(STABLE if good else WRONG, 100 * off, message, found.checks)
