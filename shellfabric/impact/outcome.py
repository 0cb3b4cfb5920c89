"""What follows from an impact's set-up and energies, whatever the number of plies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics.errors import InputError
from shellfabric.panel.model import SYMMETRIES
from shellfabric.projectile.bar import Rigidity, contact_time, held_force, rigid_is_enough

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup


class Outcome:
    """What follows from an impact's set-up and energies, whose `setup` is the ImpactSetup."""

    setup: ImpactSetup
    energies: dict
    step_history: np.ndarray

    @property
    def strike_energy(self) -> float:
        """[J]"""
        return self.setup.projectile.energy(self.setup.strike_velocity)

    @property
    def energy_error_max(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["error"]))) / self.strike_energy

    @property
    def mirrored(self) -> tuple[bool, bool]:
        """(x, y) whether the modelled part continues mirrored beyond x = 0 and y = 0."""
        return SYMMETRIES[self.setup.symmetry]

    @property
    def rigidity(self) -> Rigidity | None:
        """Whether a rigid projectile is enough, its contact held against the period of the bar that it is, or would be
        if it were of steel; None where it is no flat cylinder of steel, or where it was never touched."""
        shot = self.setup.projectile
        try:
            bar = shot.bar or (shot.steel_bar() if shot.shape == "flat" else None)
            if bar is None:
                return None
            t, force = self.step_history[:, 0], self.step_history[:, 3]
            held = held_force(t, force, 0.5 * bar.period)
            return rigid_is_enough(
                contact_time(t, force, bar.period),
                bar.period,
                held,
                bar.yield_force,
                elastic=shot.bar is not None,
            )
        except InputError:
            return None
