"""Viscosity on the stretch rate: without it crimped yarns ring when they snap taut, with too much the wave is "
"smeared."""

from __future__ import annotations

from functools import cache

from shellfabric.panel.model import Numerics
from validation.verification.stability import shots
from validation.verification.stability.core import ABOVE, BELOW, STABLE, WRONG, Axis, Map, Outcome, guarded

ALLOWED = 0.1
RATIOS = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
VELOCITIES = (50.0, 92.5, 130.0)


def shot(viscosity: float, velocity: float) -> shots.Answer:
    """Answer of a shot."""
    return shots.fire(stretch_viscosity=viscosity, velocity=velocity, failure=False)


usual = cache(lambda velocity: shot(Numerics.stretch_viscosity, velocity))


def point(viscosity: float, velocity: float) -> Outcome:
    """STABLE where peaks and velocity are those of the default."""

    def run():
        found = shot(viscosity, velocity)
        off = found.off(usual(velocity))
        return Outcome(STABLE if off <= ALLOWED else WRONG, 100 * off, checks=found.checks)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "viscosity", "Viscosity on the stretch rate",
        f"{shots.FABRIC}, {1e3 * shots.OPENING:g} mm wide, for {1e6 * shots.END:g} µs. The element of the shell has "
        "its yarns on the sides and its crossovers at the nodes: it has no hourglass modes, and viscosity on the "
        "stretch rate is all the damping there is. Wrong is what differs from the default: the plateau about it is "
        "the target. (The map of the time step compares each run with its own small step, by which runs without "
        "viscosity are stable.)",
        Axis("damping ratio of the highest mode", (0.0, 0.05, 0.1, 0.8) if quick else RATIOS),
        Axis("strike velocity [m/s]", VELOCITIES[1:2] if quick else VELOCITIES), point,
        "difference from the default [%]", f"peaks or velocity off by more than {100 * ALLOWED:g} %",
        "drift of the energy balance, numbers that are not finite, nodes that outrun their element",
        (Numerics.stretch_viscosity, shots.VELOCITY), (ABOVE, BELOW),
    )  # fmt: skip
