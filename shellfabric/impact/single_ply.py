"""One impact on one ply: set-up, run, result."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import ceil
from typing import Any

import numpy as np

from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from shellfabric.backing.block import Backing
from shellfabric.backing.coupling import BackingResult
from shellfabric.cell import table_cache
from shellfabric.cell.model import FILL, CellModel, CellTable
from shellfabric.cell.surface_cell import SurfaceCell
from shellfabric.driver.solver import Hook, run_to_end
from shellfabric.impact.outcome import Outcome
from shellfabric.output import checkpoint, histories
from shellfabric.output import snapshots as output_snapshots
from shellfabric.output.hooks import Snapshots
from shellfabric.panel import quality
from shellfabric.panel.boundary import Grip, PullIn
from shellfabric.panel.model import Numerics, Panel
from shellfabric.panel.solver import ClothSolver, PanelSolver
from shellfabric.projectile import dynamics
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel
from shellfabric.sliding.solver import SlidingSolver, SlipSummary, slip_summary, solver_of

ELEMENT_SIDE = 0.8  # [projectile radii] of an element at most, by default: longer ones miss what a narrow nose cuts
MOST_ELEMENTS = 8  # a crossover, by default
UNFAILING = 20.0  # reach of the table, see CellModel, of yarns that do not fail: 60 % of strain in Kevlar


@dataclass(frozen=True)
class ImpactSetup:
    """A projectile that strikes the middle of a panel.

    Parameters
    ----------
    fabric : Fabric; its linear densities are used as they are (see Fabric.effective)
    strike_velocity : [m/s] along the projectile's line of flight
    laws : (CompressionLaw, CompressionLaw) of warp and weft; None takes the fabric's published ones
    projectile : Projectile
    opening : [m] side of the square opening, or both sides: along warp and weft, but for an oblique weave
    edge : "clamped", "free" or a slipping side, for all sides or each on its own (see `boundary`)
    weave_angle : [rad] of the warp against the first side of the opening
    symmetry : "quarter", "half" or "whole"
    grading : ((until, side), ...) [crossovers] longer elements further from the impact point, or None (see `grading`)
    end_time : [s] at the latest; a run ends when the projectile stops or has passed
    elements_per_crossover : along each side; None takes 1, or as many as put an element's longer side within
        ELEMENT_SIDE of the projectile's radius, at most MOST_ELEMENTS. Longer ones absorb less than shorter
        ones do
    cell_model, form, gap, profile : see CellModel
    bending : [N m2] bending stiffness of a yarn, or of (warp, weft); see Panel
    jam : (stiffness [N], stretch) of yarns that are bunched up; see Panel
    surface : ResponseSurface to make the cell from instead of laws, or None; see surface_cell.SurfaceCell
    table_size : stretches along each side of the cell's table; 201 puts its tensions within 0.2 % of the yarn's
        strength of the cell's
    audit_interval, snapshot_interval : [s]; no snapshots where None
    failure : whether yarns fail. Where they do not, the table goes to UNFAILING times their failure strain
    backing : Backing, the block behind the cloth, or None
    history : histories.HistoryRequest, what to record along yarns and at the edges; None for nothing
    numerics : Numerics
    crossovers : sliding.model.CrossoverFriction of yarns that slide through their crossovers; None pins them
    """

    fabric: Fabric
    strike_velocity: float
    laws: tuple[CompressionLaw, CompressionLaw] | None = None
    projectile: Projectile = field(default_factory=Projectile)
    opening: float | tuple[float, float] = 0.203
    edge: str | PullIn | Grip | tuple = "clamped"
    weave_angle: float = 0.0
    symmetry: str = "quarter"
    end_time: float = 800e-6
    elements_per_crossover: int | None = None
    cell_model: str = "compressible"
    form: str = "variational"
    gap: float = 0.0
    profile: str = "cosine"
    bending: float | tuple[float, float] = 0.0
    jam: tuple[float, float] = (0.0, 1.0)
    surface: ResponseSurface | None = None
    table_size: int = 201
    audit_interval: float = 2e-6
    snapshot_interval: float | None = None
    failure: bool = True
    backing: Backing | None = None
    history: histories.HistoryRequest | None = None
    numerics: Numerics = field(default_factory=Numerics)
    grading: tuple | None = None
    crossovers: CrossoverFriction | None = None

    @property
    def resolved_elements_per_crossover(self) -> int:
        """Elements per crossover that are given, or those of the default."""
        if self.elements_per_crossover is not None:
            return self.elements_per_crossover
        needed = 2 * max(self.fabric.weave.w) / (ELEMENT_SIDE * self.projectile.radius)
        return 1 if self.grading is not None else min(max(1, ceil(needed)), MOST_ELEMENTS)

    @property
    def sample_interval(self) -> float:
        """[s] between samples, which are as frequent as what is recorded."""
        return min(self.audit_interval, self.history.interval) if self.history else self.audit_interval

    def cell(self) -> CellModel | SurfaceCell:
        """The crossover's cell."""
        if self.surface is not None:
            return SurfaceCell(self.fabric, self.surface, self.form)
        reach = 1.0 if self.failure else UNFAILING
        return CellModel(self.fabric, self.laws, self.gap, self.cell_model, self.form, self.profile, reach=reach)

    def table(self, kept: bool = False, method: str = FILL) -> CellTable:
        """The cell's table. Set-ups that differ in panel, shot or mesh alone can share it.

        Parameters
        ----------
        kept : whether to take it from the user's cache folder, and to keep it there (`cell.table_cache`)
        method : how it is filled, see CellTable.fill; of a cell with compression laws

        Raises
        ------
        InputError : as CellModel, SurfaceCell and CellTable
        """
        cell = self.cell()
        if self.surface is not None:
            return cell.table(self.table_size)
        return table_cache.table(cell, self.table_size, method) if kept else cell.table(self.table_size, method)  # type: ignore[arg-type, call-arg]

    def panel(self, table: CellTable | None = None) -> Panel:
        """The panel that this set-up describes, with its own table or one that a like set-up has filled.

        Raises
        ------
        InputError : as `table` and Panel
        """
        opening = self.opening if np.ndim(self.opening) else (self.opening, self.opening)
        kind: type[Panel]
        more: dict[str, Any]
        kind, more = (Panel, {}) if self.crossovers is None else (SlidingPanel, {"friction": self.crossovers})
        return kind(
            table or self.table(),
            tuple(opening),  # type: ignore[arg-type]
            self.projectile,
            self.symmetry,
            self.resolved_elements_per_crossover,
            self.edge,
            self.numerics,
            failure=self.failure,
            backing=self.backing,
            jam=self.jam,
            weave_angle=self.weave_angle,
            bending=tuple(self.bending) if np.ndim(self.bending) else (self.bending, self.bending),  # type: ignore[arg-type]
            grading=self.grading,
            **more,
        )


@dataclass(frozen=True)
class ImpactResult(Outcome):
    """What an impact came to. Energies, forces and counts are those of the whole panel, whatever the symmetry.

    Parameters
    ----------
    setup, panel : what was run
    outcome : "stopped", "perforated", "in flight" (end time reached) or "unstable"; a projectile has stopped when it no
        longer moves along the panel's normal, though it may slide on
    residual_velocity : [m/s] of the projectile at the end, along the normal; 0 of one that has stopped
    velocity : (3,) [m/s] of the projectile at the end, along warp, weft and normal
    t, v, nose_position : (n,) [s, m/s, m] of the samples; velocity along the normal, foremost point of the projectile
    contact_force : (n,) [N] on the projectile along the normal, mean since the sample before (ClothSolver)
    deflection : (n,) [m] largest of the cloth, along the normal (`ply_audit.deflection`); of a pack, of its last ply
    energies : {name: (n,)} [J] with the names of panel.solver.ENERGIES; error is the sum less the energy at the start
    reactions : {"warp", "weft": (n,)} [N] tension at the clamped end of the yarn nearest the impact point
    failed_segments : (n,) number of failed yarn segments
    peak_tension : (warp, weft) [N] over the run
    peak_tension_time, peak_tension_place : (2,) [s] and (2, 2) [m] when, and where at rest along warp and weft from the
        impact point; NaN where there was none
    step_history : (steps, 4) time [s], foremost point [m], velocity [m/s] at half steps, force on the projectile [N]
    bar : dynamics.BarHistory of tip, tail and centre of mass; None of a rigid projectile
    backing : backing.coupling.BackingResult, the block behind the cloth at the end, or None
    projectile_position : (3,) [m] position of its nose at the end
    nodes, quads : (k, 3) [m], (m, 4) the panel (or its modelled part) at the end
    tension : (m, 2) [N] of warp and weft at the end
    failed : (m, 3) bool at the end: warp failed, weft failed, element eroded
    snapshots : tuple of snapshots.Snapshot
    histories : histories.Histories, or None where nothing was to be recorded
    steps, wall_time, ns_per_element_step : cost of the run, [s] and [ns]
    max_deflection : [m] largest entry of `deflection`
    checks : tuple of quality.Indicator
    slip : sliding.solver.SlipSummary of sliding crossovers, None of pinned ones
    """

    setup: ImpactSetup
    panel: Panel
    outcome: str
    residual_velocity: float
    velocity: np.ndarray
    t: np.ndarray
    v: np.ndarray
    nose_position: np.ndarray
    contact_force: np.ndarray
    deflection: np.ndarray
    energies: dict
    reactions: dict
    failed_segments: np.ndarray
    peak_tension: tuple[float, float]
    peak_tension_time: np.ndarray
    peak_tension_place: np.ndarray
    step_history: np.ndarray
    bar: dynamics.BarHistory | None
    backing: BackingResult | None
    projectile_position: np.ndarray
    nodes: np.ndarray
    quads: np.ndarray
    tension: np.ndarray
    failed: np.ndarray
    snapshots: tuple
    histories: histories.Histories | None
    steps: int
    wall_time: float
    ns_per_element_step: float
    max_deflection: float
    checks: tuple
    slip: SlipSummary | None = None

    @property
    def first_ply_setup(self) -> ImpactSetup:
        return self.setup


def run(
    setup: ImpactSetup, *, hooks: Iterable[Hook] = (), resume: FilePath | None = None, table: CellTable | None = None,
    panel: Panel | None = None,
) -> ImpactResult:  # fmt: skip
    """Run an impact.

    Parameters
    ----------
    setup : ImpactSetup
    hooks : called as hook(solver) after every audit
    resume : path of a checkpoint of the same set-up to go on from; the result is that of the uninterrupted run, bit
        for bit
    table : CellTable that a set-up of the same cell has filled, or None
    panel : that of the set-up with changes of its own, such as strengths of its yarns; None makes it

    Raises
    ------
    InputError : a set-up or checkpoint that cannot be used
    UnstableError : the run became unphysical; its attribute `result` holds what was computed
    """
    solver = solver_of(
        panel or setup.panel(table), setup.strike_velocity, setup.end_time, interval=setup.sample_interval
    )
    own = (*recorder(solver, setup), *snapshot_hooks(setup))
    if resume is not None:
        checkpoint.read(solver, resume)
    return run_to_end(solver, (*own, *hooks), lambda: collect_result(setup, solver))


def recorder(solver: ClothSolver, setup: ImpactSetup) -> tuple[Hook, ...]:
    """The hook that records along yarns and at edges, in a tuple; none where nothing is to be recorded."""
    solver.history_request = setup.history
    plies = [panel for panel, _, _ in solver.parts]
    return (histories.Recorder(plies, setup.history),) if setup.history else ()


def snapshot_hooks(setup: ImpactSetup, take: Callable[..., object] | None = None) -> tuple[Hook, ...]:
    """The hook that takes the set-up's snapshots, in a tuple; see hooks.Snapshots. InputError for a bad interval."""
    if setup.snapshot_interval is None:
        return ()
    if not setup.snapshot_interval > 0:
        raise InputError(key="snapshot_interval", value=setup.snapshot_interval, allowed="above 0")
    return (Snapshots(setup.snapshot_interval, take),)


def collect_result(setup: ImpactSetup, solver: PanelSolver | SlidingSolver) -> ImpactResult:
    """Gather what a run has recorded."""
    last = output_snapshots.snapshot(solver.panel, solver.state, solver.time)
    return ImpactResult(
        setup=setup,
        panel=solver.panel,
        energies={name: solver.sample(name) for name in solver.energy_names},
        reactions={"warp": solver.sample("reaction_warp"), "weft": solver.sample("reaction_weft")},
        failed_segments=solver.sample("failed_yarns"),
        peak_tension=(float(solver.state.peak_tension[0]), float(solver.state.peak_tension[1])),
        peak_tension_time=solver.peak_tensions[0, :, 1],
        peak_tension_place=solver.peak_tensions[0, :, 2:],
        projectile_position=last.projectile_position,
        nodes=last.nodes.reshape(-1, 3),
        quads=output_snapshots.quads(solver.panel),
        tension=last.tension.reshape(-1, 2),
        failed=last.failed.reshape(-1, 3),
        histories=histories.unpack(solver.histories, (solver.panel,), setup.history)[0]
        if setup.history and solver.histories
        else None,
        slip=slip_summary(solver),
        **projectile_result(solver, solver.panel.elements),
    )


def projectile_result(solver: ClothSolver, elements: int) -> dict[str, Any]:
    """Entries of a result that are the same for one ply and a pack: the projectile's, the block's, and the cost."""
    fine = np.concatenate([np.empty((0, solver.history_columns)), *solver.step_history])
    clock, bar = solver.const.dt * np.arange(1, len(fine) + 1), solver.panel.projectile.bar
    deflection = solver.ply_sample("deflection")[:, -1]
    return {
        "outcome": solver.outcome,
        "residual_velocity": solver.residual_velocity,
        "velocity": dynamics.velocity(solver.state, solver.const),
        "t": solver.sample("t"),
        "v": solver.sample("v"),
        "nose_position": solver.sample("z"),
        "contact_force": solver.contact_force,
        "deflection": deflection,
        "step_history": np.column_stack([clock, fine[:, :2], fine[:, 2] / solver.panel.share]),
        "bar": None if bar is None else dynamics.history(clock, fine, solver.state, bar),
        "backing": solver.backing.result() if solver.backing else None,
        "snapshots": tuple(solver.snapshots),
        "max_deflection": float(deflection.max()),
        "checks": quality.of_solver(solver),
        "steps": solver.steps,
        "wall_time": solver.wall_time,
        "ns_per_element_step": 1e9 * solver.wall_time / max(1, solver.steps * elements),
    }
