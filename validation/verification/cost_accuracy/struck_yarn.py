"""A lone straight yarn struck across at constant velocity: the cable model beside Smith's closed form."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

from fabrics import catalogue
from fabrics.units import si
from validation.models.cable import smith
from validation.models.cable.model import CableNumerics


@dataclass(frozen=True)
class Yarn:
    """A yarn by `smith.strike`: bars along its half, share of the time step's bound, viscosity."""

    fabric: str
    velocity: float
    length: float
    bars: int = 2000
    cfl: float = smith.STRAIGHT.cfl
    viscosity: float = CableNumerics.viscosity

    def changed(self, **changes: Any) -> Yarn:
        return replace(self, **changes)


def run(case: Yarn) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]})."""
    begun = time.process_time()
    numerics = CableNumerics(cfl=case.cfl, viscosity=case.viscosity)
    yarn = catalogue.load(case.fabric).weave.warp
    found = smith.strike(yarn, case.velocity, length=case.length, bars=case.bars, numerics=numerics).computed
    return _values(found), {"march": time.process_time() - begun}


def _values(wave):
    return {"tension": wave.tension, "force": wave.force, "kink speed": wave.U, "front speed": wave.c}


def read(case: dict[str, Any]) -> Yarn:
    """The default case."""
    return Yarn(case["fabric"], si(case["velocity"], "m/s", key="velocity"), si(case["length"], "m", key="length"))


def exact(case: Yarn) -> dict[str, float]:
    """Values of Smith's closed form."""
    return _values(smith.smith(catalogue.load(case.fabric).weave.warp, case.velocity))


def warm(case: Yarn) -> Yarn:
    """A short case of the same kernels."""
    return Yarn(case.fabric, case.velocity, case.length, bars=60)
