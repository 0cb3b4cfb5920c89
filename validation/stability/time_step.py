"""Time step of the shell against its bound, 2 / w (sqrt(1 + xi^2) - xi) of the highest mode (`shellfabric.panel`)."""

from functools import cache

from shellfabric.panel import Numerics
from validation.stability import shots
from validation.stability.core import ABOVE, STABLE, WRONG, Axis, Map, Outcome, guarded

CLOTHS = {
    "S-720, default": {},
    "equilibrium form": {"form": "equilibrium"},
    "no viscosity": {"stretch_viscosity": 0.0},
    "straight yarns": {"straight": True},
    "straight, no viscosity": {"straight": True, "stretch_viscosity": 0.0},
    "straight, equilibrium, no viscosity": {"straight": True, "form": "equilibrium", "stretch_viscosity": 0.0},
}
ALLOWED = 0.15  # the contact is stiffer with the step's square, which moves peaks by some per cent
SAFETY = (0.3, 0.6, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0)


def shot(safety, name):
    """Answer of a shot; yarns do not fail, so that a wild one does not end for that."""
    choices = dict(CLOTHS[name])
    cell = shots.table(choices.pop("form", "variational"), choices.pop("straight", False))
    return shots.fire(cell, failure=False, safety=safety, **choices)


quiet = cache(lambda name: shot(0.3, name))


def point(safety, name):
    """STABLE where peaks and velocity are those of a third of the bound."""

    def run():
        off = shot(safety, name).off(quiet(name))
        return Outcome(STABLE if off <= ALLOWED else WRONG, 100 * off)

    return guarded(run)


def chart(quick=False):
    """The map."""
    return Map(
        "time-step", "Time step against its bound",
        f"{shots.FABRIC}, {1e3 * shots.OPENING:g} mm wide, is struck at {shots.VELOCITY:g} m/s. The step is given as a "
        "share of the bound that the code computes from the stiffest state of the cell, the wave speed over the "
        "element when yarns are straight. The variational form sees half of its stiffness through means over two "
        "elements, which leaves room.",
        Axis("time step over its bound", (0.6, 0.9, 1.5, 2.0) if quick else SAFETY),
        Axis("cloth", tuple(CLOTHS)[:2] if quick else tuple(CLOTHS)), point,
        "difference from a third of the step [%]", f"peaks or velocity off by more than {100 * ALLOWED:g} %",
        "drift of the energy balance, numbers that are not finite, nodes that outrun their element",
        (Numerics.safety, "S-720, default"), (ABOVE,), tuple(CLOTHS)[:2] if quick else tuple(CLOTHS),
    )  # fmt: skip
