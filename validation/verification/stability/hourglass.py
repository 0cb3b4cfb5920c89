"""Hourglass coefficient of the brick of the solid patch (`shellfabric.solid.hex8`), against its time step.

The brick has one integration point and so four modes without energy; a stiffness of their own holds them, 1 being what
the full rule would give at rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from fabrics import catalogue
from meshing import patch
from shellfabric.panel import quality
from shellfabric.solid.model import SolidPatch
from shellfabric.solid.numerics import PatchNumerics
from shellfabric.solid.solver import SolidSolver
from validation.verification.stability.core import ABOVE, BELOW, STABLE, WRONG, Axis, Map, Outcome, guarded

FABRIC, VELOCITY, END = "S-720", 60.0, 6e-6
FACTORS = (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0)
SAFETY = (0.8, 1.0, 1.5)
FOLDED = 0.5  # of a brick's size
MOST = 0.1  # of the solids' energy: the usual rule


@dataclass(frozen=True)
class Beyond(PatchNumerics):
    """Numerics that nobody checks."""

    def __post_init__(self):
        pass


@cache
def mesh() -> patch.Patch:
    """A small coarse patch."""
    return patch.build(catalogue.load(FABRIC), (4, 4), size=(2, 2, 1))


def point(factor: float, cfl: float) -> Outcome:
    """STABLE where no brick is folded by its hourglass modes, and these hold little energy."""

    def run():
        numerics = Beyond(hourglass=factor, cfl=cfl)
        march = SolidSolver(SolidPatch(mesh(), catalogue.load(FABRIC), numerics=numerics), VELOCITY, END, threads=1)
        march.run()
        off = quality.hourglass_amplitude(march.patch.mesh, march.state.x)
        share = float(march.sample("hourglass")[-1] / march.sample("solids")[-1])
        message = f"hourglass energy {100 * share:.2g} % of the solids'" if share > MOST else ""
        return Outcome(
            STABLE if off <= FOLDED and share <= MOST else WRONG, 100 * off, message, quality.of_patch(march)
        )

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "hourglass", "Hourglass stiffness of the brick of the solid patch",
        f"4 x 4 yarns of {FABRIC} as solids with fibre bars, struck at {VELOCITY:g} m/s, {1e6 * END:g} µs. The shell "
        "has no hourglass modes; the brick of the solid patch has four, held by a stiffness. Its bound on the time "
        "step counts that stiffness, so that a greater coefficient costs time, not stability.",
        Axis("hourglass coefficient", (0.0, 1.0) if quick else FACTORS),
        Axis("time step over its bound", SAFETY[:1] if quick else SAFETY), point,
        "hourglass amplitude [% of a brick's size]",
        f"too soft, an amplitude above {100 * FOLDED:g} %, or too stiff, hourglass energy above {100 * MOST:g} % of "
        "the solids'", "drift of the energy balance (2 %), numbers that are not finite, inverted bricks; the input "
        "refuses steps beyond 1",
        (PatchNumerics.hourglass, PatchNumerics.cfl), (ABOVE, BELOW),
    )  # fmt: skip
