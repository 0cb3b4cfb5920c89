"""Shots at one ply of the six Kevlar fabrics: the quantities that the thesis reports of its own (chapter 5).

Panel and projectile are those of the thesis: 203 mm square, clamped, a flat cylinder of 3 g and 5.5 mm at normal
incidence, rigid, struck at the middle. Nothing is fitted to an outcome.

Residual velocities. Each fabric is shot at multiples of its computed critical velocity; the Lambert-Jonas curve is
fitted to the shots, with the computed critical velocity as its limit.

Captions. The twelve shots of thesis Figures 5-4 to 5-15, with the histories of the projectile, of the yarns through the
impact point and of the edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellTable
from shellfabric.impact import ballistic_limit, lambert_jonas
from shellfabric.impact.ballistic_limit import Limit, Shot
from shellfabric.impact.lambert_jonas import LambertJonas
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.output.histories import Histories, HistoryRequest
from shellfabric.output.wave_fronts import Front, fronts
from validation.published.shots import CAPTIONS

MULTIPLES = (1.01, 1.03, 1.06, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0)  # of the critical velocity
TOLERANCE = 0.25  # [m/s] between a stop and a perforation
INTERVAL = 1e-6  # [s] of the histories


@dataclass(frozen=True)
class Curve:
    """Residual velocities of one fabric.

    Parameters
    ----------
    fabric : name
    limit : Limit, the bisection
    shots : tuple of Shot, at MULTIPLES of the critical velocity
    fit : LambertJonas, with the critical velocity as its limit
    """

    fabric: str
    limit: Limit
    shots: tuple[Shot, ...]
    fit: LambertJonas


@dataclass(frozen=True)
class Caption:
    """One shot of a caption, with what was recorded of it.

    Parameters
    ----------
    fabric : name
    expected : outcome in the thesis's simulation, "stopped" or "perforated"
    result : ImpactResult
    """

    fabric: str
    expected: str
    result: ImpactResult

    @property
    def velocity(self) -> float:
        """[m/s] strike velocity."""
        return self.result.setup.strike_velocity

    @property
    def histories(self) -> Histories:
        """Histories along the yarns through the impact point and at the edges."""
        return self.result.histories[0]

    @property
    def fronts(self) -> tuple[Front, ...]:
        """Fronts of the longitudinal and the transverse wave, along warp and weft."""
        return fronts(self.histories)

    @property
    def kinetic_over_internal(self) -> float:
        """[-] kinetic energy of the cloth over its internal energy, mean over the last half of the shot."""
        energies, t = self.result.energies, self.result.t
        stored = energies["yarn_strain"] + energies["shear"]
        late = (t > 0.5 * t[-1]) & (stored > 0)
        return float(np.mean(energies["kinetic_fabric"][late] / stored[late]))


@cache
def table(fabric: str) -> CellTable:
    """The cell's table of one fabric."""
    return setup(fabric, 100.0).table()


def setup(fabric: str, velocity: float, history: HistoryRequest | None = None) -> ImpactSetup:
    """One shot at the thesis's panel."""
    return ImpactSetup(catalogue.load(fabric).with_effective_density(), velocity, history=history)


def curve(fabric: str) -> Curve:
    """Critical velocity and residual velocities of one fabric.

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.critical_velocity`
    """
    panel = setup(fabric, 100.0).panel(table(fabric))
    limit = ballistic_limit.critical_velocity(panel, tolerance=TOLERANCE)
    strikes = [multiple * limit.velocity for multiple in MULTIPLES]
    shots = ballistic_limit.shoot(panel, strikes)
    through = [shot for shot in shots if shot.perforated]
    fit = lambert_jonas.fit(
        [shot.strike_velocity for shot in through],
        [shot.residual_velocity for shot in through],
        limit=limit.velocity,
    )
    return Curve(fabric, limit, shots, fit)


def captions() -> tuple[Caption, ...]:
    """The twelve shots of the captions, in the order of the thesis.

    Raises
    ------
    UnstableError : as `simulation.run`
    """
    found = []
    for fabric, velocities in CAPTIONS.items():
        for velocity, expected in zip(velocities, ("stopped", "perforated")):
            shot = setup(fabric, velocity, HistoryRequest(interval=INTERVAL))
            found.append(Caption(fabric, expected, run(shot, table=table(fabric))))
    return tuple(found)
