"""Hourglass coefficient of the brick of the solid patch (`shellfabric.backing.hex8`), against its time step.

The brick has one integration point and so four modes without energy; a stiffness of their own holds them, 1 being what
the full rule would give at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from meshing import patch
from shellfabric.backing.hex8 import PATTERNS, Bricks
from shellfabric.panel import quality
from validation.models.solid.model import SolidPatch
from validation.models.solid.numerics import PatchNumerics
from validation.models.solid.solver import SolidSolver
from validation.verification.stability.core import STABLE, WRONG, Outcome

FABRIC, VELOCITY, END = "S-720", 60.0, 6e-6


@dataclass(frozen=True)
class Beyond(PatchNumerics):
    """Numerics that nobody checks."""

    def __post_init__(self):
        pass


@cache
def mesh() -> patch.Patch:
    """A small coarse patch."""
    return patch.build(catalogue.load(FABRIC), (4, 4), size=(2, 2, 1))


def hourglass_amplitude(mesh: Any, x: FloatArray) -> float:
    """[-] largest amplitude of a brick's hourglass modes over the cube root of its volume, at the places x (n, 3).

    The modes h are freed of their linear part, gamma = h - (h . X) B, so that stretch and turning leave them alone.
    """
    made = Bricks.of(mesh.points[mesh.hexes])
    modes = PATTERNS - np.einsum("mhi,mai->mha", made.twist, made.gradient)
    moved = np.einsum("mha,mai->mhi", modes, (x - mesh.points)[mesh.hexes]) / 8
    return float((np.linalg.norm(moved, axis=2).max(axis=1) / np.cbrt(made.volume)).max())


def hourglass(*, hourglass: float, cfl: float, folded: float, share: float) -> Outcome:
    """STABLE where no brick is folded by its hourglass modes, and these hold little energy.

    Parameters
    ----------
    hourglass, cfl : as of `PatchNumerics`
    folded : [-] largest amplitude over a brick's size
    share : [-] largest hourglass energy over that of the solids
    """
    numerics = Beyond(hourglass=hourglass, cfl=cfl)
    march = SolidSolver(SolidPatch(mesh(), catalogue.load(FABRIC), numerics=numerics), VELOCITY, END, threads=1)
    march.run()
    off = hourglass_amplitude(march.patch.mesh, march.state.x)
    held = float(march.sample("hourglass")[-1] / march.sample("solids")[-1])
    message = f"hourglass energy {100 * held:.2g} % of the solids'" if held > share else ""
    kind = STABLE if off <= folded and held <= share else WRONG
    error = float(np.max(np.abs(march.sample("error")))) / march.strike_energy
    values = {"time step": cfl, "energy error": error, "hourglass energy": held, "hourglass amplitude": off}
    return Outcome(kind, 100 * off, message, tuple(quality.indicator(*each) for each in values.items()))
