"""Time step of the shell against its bound, 2 / w (sqrt(1 + xi^2) - xi) of the highest mode, of which `pace` takes
what form, crimp and viscosity leave (`shellfabric.panel.model`).

The contact is given in units of nodal mass / dt^2: it would be four times as stiff at half the step, which moves peaks
by some per cent and has nothing to do with the step. Here it is held, at the stiffness that the default has at twice
the default step, so that it is not the first to fail beyond that.

Without viscosity crimped yarns ring, and their peaks are an extreme of chance: they jump by up to a tenth from one step
to the next. There an answer is the median over some steps next to each other, the longest of which is the one that
counts.
"""

from __future__ import annotations

from functools import cache
from statistics import median
from typing import TYPE_CHECKING

from shellfabric.panel.model import Numerics
from validation.verification.stability import shots
from validation.verification.stability.core import ABOVE, STABLE, WRONG, Axis, Map, Outcome, guarded

if TYPE_CHECKING:
    from validation.verification.stability.shots import Answer

CLOTHS = {
    "S-720, default": {},
    "equilibrium form": {"form": "equilibrium"},
    "no viscosity": {"stretch_viscosity": 0.0},
    "equilibrium, no viscosity": {"form": "equilibrium", "stretch_viscosity": 0.0},
    "straight yarns": {"straight": True},
    "straight, no viscosity": {"straight": True, "stretch_viscosity": 0.0},
    "straight, equilibrium, no viscosity": {"straight": True, "form": "equilibrium", "stretch_viscosity": 0.0},
}
ALLOWED = 0.05  # what the guard allows the energy balance: an answer that is further off has no other warning
RINGS = 0.1  # allowed where yarns ring, as in the maps of viscosity and penalty: such peaks move by 5 % with any step
SAFETY = (0.3, 0.6, 0.9, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.4)
RINGING = ("no viscosity", "equilibrium, no viscosity")
NEIGHBOURS = tuple(1 - 0.01 * n for n in range(11))
_SOFT = 2 * Numerics.cfl


def shot(cfl: float, name: str) -> Answer:
    """Answer of a shot; yarns do not fail, so that a wild one does not end for that."""
    choices = dict(CLOTHS[name])  # type: ignore[call-overload]
    cell = shots.table(choices.pop("form", "variational"), choices.pop("straight", False))
    penalty = Numerics.penalty * (cfl / _SOFT) ** 2
    return shots.fire(cell, failure=False, cfl=cfl, penalty=penalty, **choices)


def answer(cfl: float, name: str) -> Answer:
    """Answer of a shot, or of the median of its neighbours where yarns ring."""
    found = [shot(part * cfl, name) for part in (NEIGHBOURS if name in RINGING else (1.0,))]
    peak = tuple(map(median, zip(*(one.peak for one in found))))
    velocity, failed = (median(getattr(one, name) for one in found) for name in ("velocity", "failed"))
    return shots.Answer(peak, velocity, failed, found[0].checks)


quiet = cache(lambda name: answer(0.3, name))


def point(cfl: float, name: str) -> Outcome:
    """STABLE where peaks and velocity are those of a third of the bound."""

    def run():
        found = answer(cfl, name)
        off = found.off(quiet(name))
        kind = STABLE if off <= (RINGS if name in RINGING else ALLOWED) else WRONG
        return Outcome(kind, 100 * off, checks=found.checks)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "time-step", "Time step against its bound",
        f"{shots.FABRIC}, {1e3 * shots.OPENING:g} mm wide, is struck at {shots.VELOCITY:g} m/s. The step is given as a "
        "share of what the code allows: the bound from the stiffest state of the cell, the wave speed over the element "
        "when yarns are straight, times what form, crimp and viscosity leave of it. The variational form sees half of "
        "its stiffness through means over two elements, so that a bound that takes the whole leaves it room; the "
        "equilibrium form has none and gets 1 / √2 of the step, cloth that is taut at rest 0.965, and crimped cloth "
        "without viscosity, whose yarns ring when they snap taut, 0.63. The stiffness of the contact, which the code "
        "gives in units of nodal mass / dt², is held, so that only the step changes: the errors left are those of the "
        "step. With that they stay below 2 % up to the edge, and the limit can be what the guard allows the energy "
        "balance, 5 %. Where nothing damps the ring, peaks are chance and move by 5 % with any step: there an answer "
        "is the median over eleven steps within 10 % of each other, and the limit 10 %, as in the next map, which "
        "calls cloth without viscosity wrong at any step.",
        Axis("time step over what is allowed", (0.6, 0.9, 1.5, 2.4) if quick else SAFETY),
        Axis("cloth", tuple(CLOTHS)[:2] if quick else tuple(CLOTHS)), point,
        "difference from a third of the step [%]",
        f"peaks or velocity off by more than {100 * ALLOWED:g} %, {100 * RINGS:g} % where crimped yarns ring",
        "drift of the energy balance, numbers that are not finite, nodes that outrun their element",
        (Numerics.cfl, "S-720, default"), (ABOVE,), tuple(CLOTHS)[:2] if quick else tuple(CLOTHS),
    )  # fmt: skip
