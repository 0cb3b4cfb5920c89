"""What is known of an impact when it has run, and when its file is read again. No solver is loaded
for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray

if TYPE_CHECKING:
    from shellfabric.block.coupling import BackingResult
    from shellfabric.loop import histories
    from shellfabric.metal.body import MetalHistory
    from shellfabric.projectile import dynamics


@dataclass(frozen=True, kw_only=True)
class ImpactData:
    """What the result of a solver and the file of a shot have in common. Energies, forces and counts
    are those of the whole panel, whatever the symmetry.

    Parameters
    ----------
    outcome : "stopped", "perforated", "in flight" (end time reached) or "unstable"; a projectile
        has stopped when it no longer moves along the panel's normal, though it may slide on
    residual_velocity : [m/s] of the projectile at the end, along the normal; 0 of one that has
        stopped
    time, velocity, nose_position : (n,) [s, m/s, m] of the samples; velocity along the normal,
        foremost point of the projectile
    contact_force : (n,) [N] on the projectile along the normal, mean since the sample before
        (PackSolver)
    deflection : (n,) [m] largest of the last ply, along the normal (`ply_audit.deflection`)
    max_deflection : [m] largest entry of `deflection`; NaN of a panel that is perforated
    energies : {name: (n,)} [J] with the names of the solver's energy_names; error is the sum less
        the energy at the start
    plies : {name: (n, plies)} with the names of loop.pack_solver.PLY_SAMPLES
    max_penetration_ratio : (plies - 1,) [-] deepest penetration into the next ply, over thickness
    guard_impulses : number of impulses that kept plies from passing through each other
    measured : tuple of histories.Histories of each ply that has been followed; empty where nothing
        was to be recorded
    bar : dynamics.BarHistory of tip, tail and centre of mass; None of another projectile
    metal : metal.body.MetalHistory of a body of metal at the end; None of another projectile
    backing : block.coupling.BackingResult, the block behind the fabric at the end, or None
    checks : tuple of Indicator
    steps, wall_time, ns_per_element_step : cost of the run, [s] and [ns]
    step_factor : [-] 0.7 or 0.5 of a run that was made again with a shorter step, else 1
    """

    outcome: str
    residual_velocity: float
    time: np.ndarray
    velocity: np.ndarray
    nose_position: np.ndarray
    contact_force: np.ndarray
    deflection: np.ndarray
    max_deflection: float
    energies: dict
    plies: dict
    max_penetration_ratio: np.ndarray
    guard_impulses: int
    measured: tuple[histories.Histories, ...] = ()
    bar: dynamics.BarHistory | None = None
    metal: MetalHistory | None = None
    backing: BackingResult | None = None
    checks: tuple = ()
    steps: int
    wall_time: float
    ns_per_element_step: float
    step_factor: float = 1.0

    @property
    def strike_energy(self) -> float:
        """[J] kinetic energy of the projectile at the start."""
        raise NotImplementedError

    @property
    def energy_error_max(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["error"]))) / self.strike_energy

    @property
    def absorbed_energy(self) -> float:
        """[J] energy that the projectile has lost."""
        return self.strike_energy - float(self.energies["kinetic_projectile"][-1])

    @property
    def cut_yarns(self) -> FloatArray:
        """(n,) cut yarns of all plies (`ply_audit.cut_yarns`)."""
        return self.plies["cut_yarns"].sum(axis=1)
