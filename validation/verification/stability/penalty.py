"""Stiffness and damping of the contact between nose and cloth (`shellfabric.projectile.contact_kernels`)."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from shellfabric.panel.model import Numerics
from validation.verification.stability import shots
from validation.verification.stability.core import ABOVE, BELOW, STABLE, WRONG, Axis, Map, Outcome, guarded

if TYPE_CHECKING:
    from validation.verification.stability.shots import Answer

ALLOWED = 0.1
PENALTIES = (0.02, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0)
DAMPINGS = (0.0, 0.25, 0.5, 0.75, 1.0)


def shot(penalty: float, damping: float) -> Answer:
    """Answer of a shot."""
    return shots.fire(penalty=penalty, contact_damping=damping, failure=False)


usual = cache(lambda: shot(Numerics.penalty, Numerics.contact_damping))


def point(penalty: float, damping: float) -> Outcome:
    """STABLE where peaks and velocity are those of the default."""

    def run():
        found = shot(penalty, damping)
        off = found.off(usual())
        return Outcome(STABLE if off <= ALLOWED else WRONG, 100 * off, checks=found.checks)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "penalty", "Stiffness of the contact with the nose",
        f"{shots.FABRIC}, {1e3 * shots.OPENING:g} mm wide, struck at {shots.VELOCITY:g} m/s. Too soft, the rim presses "
        "itself in; too stiff for the time step, yarns bounce off the nose, and in the end the contact feeds energy "
        "in.",
        Axis("penalty over nodal mass / dt²", (0.05, 0.6, 1.0, 4.0) if quick else PENALTIES),
        Axis("damping ratio of the contact", (0.5,) if quick else DAMPINGS), point,
        "difference from the default [%]", f"peaks or velocity off by more than {100 * ALLOWED:g} %",
        "a contact that gives energy it never took, beyond 1 % of the strike energy",
        (Numerics.penalty, Numerics.contact_damping), (ABOVE, BELOW),
    )  # fmt: skip
