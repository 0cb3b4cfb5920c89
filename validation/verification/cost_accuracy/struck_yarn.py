"""A lone straight yarn struck across at constant velocity: the cable model beside Smith's closed form."""

from __future__ import annotations

import time
import tomllib
from dataclasses import dataclass
from importlib import resources

from fabrics import catalogue
from fabrics.units import si
from validation.models.cable import smith
from validation.models.cable.model import CableNumerics
from validation.verification.cost_accuracy.core import Method, Quantity, Scene

QUANTITIES = (
    Quantity("tension", "N", "tension and force"),
    Quantity("force", "N", "tension and force"),
    Quantity("kink speed", "m/s", "wave speeds"),
    Quantity("front speed", "m/s", "wave speeds"),
)


@dataclass(frozen=True)
class Yarn:
    """A yarn by `smith.strike`: bars along its half, share of the time step's bound, viscosity."""

    fabric: str
    velocity: float
    length: float
    bars: int = 2000
    cfl: float = smith.STRAIGHT.cfl
    viscosity: float = CableNumerics.viscosity


def run(case: Yarn) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]})."""
    begun = time.process_time()
    numerics = CableNumerics(cfl=case.cfl, viscosity=case.viscosity)
    yarn = catalogue.load(case.fabric).weave.warp
    found = smith.strike(yarn, case.velocity, length=case.length, bars=case.bars, numerics=numerics).computed
    return _values(found), {"march": time.process_time() - begun}


def _values(wave):
    return {"tension": wave.tension, "force": wave.force, "kink speed": wave.U, "front speed": wave.c}


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` has none but short runs."""
    content = tomllib.loads(
        (resources.files("validation.verification.cost_accuracy") / "scenes.toml").read_text("utf-8")
    )["yarn"]
    fabric, velocity = content["fabric"], si(content["velocity"], "m/s", key="velocity")
    given = fabric, velocity, si(content["length"], "m", key="length")
    numbers = (125, 250, 500, 1000) if quick else (125, 250, 500, 1000, 4000)
    methods = [Method("default", "default: 2000 bars", Yarn(*given))]
    methods += [Method("default", "default of version 0.2: Courant factor 0.4", Yarn(*given, cfl=0.4))]
    methods += [Method("elements", f"{n} bars", Yarn(*given, bars=n)) for n in numbers]
    methods += [
        Method("time step", f"{n} bars, Courant factor {s:g}", Yarn(*given, bars=n, cfl=s))
        for n, s in ((500, 0.2), (500, 0.4), (2000, 0.2))
    ]
    methods += [
        Method("viscosity", f"{n} bars, viscosity {x:g}", Yarn(*given, bars=n, viscosity=x))
        for n in (500, 2000)
        for x in (0.0, 0.03)
    ]
    exact = _values(smith.smith(catalogue.load(fabric).weave.warp, velocity))
    text = (
        f"Half of a straight warp of {fabric}, {1e3 * given[2]:g} mm long, is struck across at {velocity:g} m/s by the "
        "cable model. The reference is the closed form of Smith, McCrackin and Schiefer, which is exact."
    )
    return Scene(
        "struck-yarn", f"Struck yarn: {fabric} at {velocity:g} m/s", text, QUANTITIES, tuple(methods), run,
        lambda case: Yarn(*given, bars=60), exact=exact,
    )  # fmt: skip
