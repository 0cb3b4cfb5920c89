"""Result of an impact, and how it is collected from a solver that has run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.block.coupling import result_of
from shellfabric.impact.data import ImpactData
from shellfabric.impact.proposals import with_remedies
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import histories
from shellfabric.loop import snapshots as output_snapshots
from shellfabric.loop.pack_solver import PLY_SAMPLES, PackSolver
from shellfabric.loop.snapshots import Snapshot
from shellfabric.membrane import quality
from shellfabric.membrane.grid import SYMMETRIES
from shellfabric.membrane.model import Panel
from shellfabric.plies.model import Pack
from shellfabric.projectile import dynamics


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
    """Gather what a run has recorded.

    Parameters
    ----------
    setup : that was fired
    step_factor : of `impact.attempts.Attempt`
    """
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
    plies = dict(zip(PLY_SAMPLES, map(solver.ply_sample, PLY_SAMPLES)))
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
        deflection=plies["deflection"][:, -1],
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
        max_deflection=solver.largest_deflection,
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
    return result_of(
        part.block,
        solver.sample("t"),
        solver.sample("dent"),
        solver.alone_from,
        part.gauge_radius,
    )
