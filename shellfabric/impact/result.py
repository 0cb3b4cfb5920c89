"""Result of an impact, and how it is collected from a solver that has run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.block.coupling import BackingResult, result_of
from shellfabric.impact.proposals import with_remedies
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import histories
from shellfabric.loop import snapshots as output_snapshots
from shellfabric.loop.pack_solver import PLY_SAMPLES, PackSolver
from shellfabric.loop.snapshots import Snapshot
from shellfabric.membrane import quality
from shellfabric.membrane.grid import SYMMETRIES
from shellfabric.membrane.model import Panel
from shellfabric.metal.body import MetalHistory
from shellfabric.plies.model import Pack
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
    max_deflection : [m] largest entry of `deflection`
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
    checks : tuple of quality.Indicator
    steps, wall_time, ns_per_element_step : cost of the run, [s] and [ns]
    step_factor : [-] 0.7 of a run that was made again with a shorter step, else 1
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


@dataclass(frozen=True, kw_only=True)
class ImpactResult(ImpactData):
    """What a solver has computed of an impact, with the objects that it ran.

    Parameters
    ----------
    setup : what was run
    target : Pack, of one ply or several
    final_velocity : (3,) [m/s] of the projectile at the end, along warp, weft and normal
    projectile_position : (3,) [m] position of its nose at the end
    peaks : (plies, 2, 4) highest tension [N] of warp and weft of each ply over the run, its time
        [s], and its place at rest along warp and weft from the impact point [m]; NaN but for the
        tension where there was none
    step_history : (steps, 4) time [s], foremost point [m], velocity [m/s] at half steps, force on
        the projectile [N]
    last : (plies,) snapshots.Snapshot at the end, counted from the plane of the first ply at rest
    snapshots : tuple of such tuples
    failures : (plies, 2) State.failed_segments and State.loads_at_failure of each ply
    """

    setup: ImpactSetup
    target: Pack
    final_velocity: np.ndarray
    projectile_position: np.ndarray
    peaks: np.ndarray
    step_history: np.ndarray
    last: tuple[Snapshot, ...]
    snapshots: tuple[tuple[Snapshot, ...], ...]
    failures: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))

    @property
    def strike_energy(self) -> float:
        """[J] kinetic energy of the projectile at the start."""
        return self.setup.projectile.energy(self.setup.strike_velocity)

    @property
    def mirrored(self) -> tuple[bool, bool]:
        """(x, y), True if the modelled part continues mirrored beyond x = 0 or y = 0."""
        return SYMMETRIES[self.setup.symmetry]

    @property
    def panels(self) -> tuple[Panel, ...]:
        """(plies,) the Panel of each ply."""
        return self.target.plies

    @property
    def panel(self) -> Panel:
        """The first ply."""
        return self.panels[0]

    @property
    def peak_tension(self) -> tuple[float, float]:
        """(warp, weft) [N] the highest of any ply over the run, each in its own weave."""
        warp, weft = self.peaks[..., 0].max(axis=0)
        return float(warp), float(weft)

    @property
    def reactions(self) -> dict[str, FloatArray]:
        """{"warp", "weft": (n,)} [N] tension at the clamped end of the yarn nearest the impact
        point, of all plies."""
        return {family: self.plies[f"reaction_{family}"].sum(axis=1) for family in ("warp", "weft")}


def collect_result(
    setup: ImpactSetup, solver: PackSolver, step_factor: float = 1.0
) -> ImpactResult:
    """Gather what a run has recorded."""
    panels = solver.pack.plies
    elements = sum(panel.elements for panel in panels)
    fine = np.concatenate([np.empty((0, solver.history_columns)), *solver.step_history])
    clock = solver.const.dt * np.arange(1, len(fine) + 1)
    of_parts: dict[str, Any] = {}
    for part in (part for parts in solver.parts for part in parts):
        of_parts |= part.result(clock, fine)
    recorded: tuple[histories.Histories, ...] = ()
    if setup.history and solver.histories:
        recorded = histories.unpack(solver.histories, panels, setup.history)
    plies = {name: solver.ply_sample(name) for name in PLY_SAMPLES}
    deflection = plies["deflection"][:, -1]
    speed = dynamics.velocity(solver.state, solver.const, solver.stack.motion)
    last = output_snapshots.of_plies(solver)
    return ImpactResult(
        setup=setup,
        target=solver.pack,
        outcome=solver.outcome,
        residual_velocity=solver.residual_velocity,
        final_velocity=panels[0].in_pack(speed),
        time=solver.sample("t"),
        velocity=solver.sample("v"),
        nose_position=solver.sample("z"),
        contact_force=solver.contact_force,
        deflection=deflection,
        energies={name: solver.sample(name) for name in solver.energy_names},
        plies=plies,
        peaks=solver.peak_tensions,
        max_penetration_ratio=solver.deepest,
        guard_impulses=solver.held_apart,
        step_history=np.column_stack([clock, fine[:, :2], fine[:, 2] / solver.share]),
        bar=of_parts.get("bar"),
        metal=of_parts.get("metal"),
        backing=_block_of(solver),
        projectile_position=last[0].projectile_position.copy(),
        last=last,
        snapshots=tuple(solver.snapshots),
        measured=recorded,
        steps=solver.steps,
        wall_time=solver.wall_time,
        ns_per_element_step=1e9 * solver.wall_time / max(1, solver.steps * elements),
        max_deflection=float(deflection.max()),
        checks=with_remedies(quality.of_solver(solver), setup),
        failures=np.array(
            [(state.failed_segments, state.loads_at_failure) for state in solver.states]
        ),
        step_factor=step_factor,
    )


def _block_of(solver):
    """The result of the block behind the last ply, or None."""
    part = solver.part("block")
    if part is None:
        return None
    return result_of(part.block, solver.sample("t"), solver.sample("dent"), solver.alone_from)
