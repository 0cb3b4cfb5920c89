"""One impact on a pack of plies: set-up, run, result."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil, inf
from typing import TYPE_CHECKING, cast

import numpy as np

from fabrics.checks import FilePath, IntArray
from shellfabric.backing.coupling import BackingResult
from shellfabric.driver.solver import Hook, run_to_end
from shellfabric.impact import single_ply
from shellfabric.impact.outcome import Outcome
from shellfabric.impact.single_ply import ImpactSetup
from shellfabric.output import checkpoint, histories
from shellfabric.output import snapshots as output_snapshots
from shellfabric.output.snapshots import Snapshot
from shellfabric.panel import boundary
from shellfabric.panel.solver import PLY_SAMPLES
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.plies.solver import PackSolver
from shellfabric.projectile import dynamics
from shellfabric.sliding.solver import SlipSummary
from shellfabric.sliding_plies.solver import pack_of, slip_summaries, solver_of

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable

ELEMENTS, NEAR = 2, 10  # per crossover about the impact point, and to how many crossovers from it at least
_SMALL = 11  # samples a side of a cell's table that no run uses


@dataclass(frozen=True)
class PackSetup:
    """A projectile that strikes the middle of a pack.

    Parameters
    ----------
    ply : ImpactSetup of the first ply
    plies : number of plies
    stacking : "aligned" or "alternating"
    gap : [m] between plies at rest; None takes that of `plies.gap.ply_gap`
    contact : PlyContact, numerical knobs of the contact between plies
    friction : [-] Coulomb's coefficient between plies
    """

    ply: ImpactSetup
    plies: int
    stacking: str = "aligned"
    gap: float | None = None
    contact: PlyContact = field(default_factory=PlyContact)
    friction: float = 0.0

    @cached_property
    def meshed_ply(self) -> ImpactSetup:
        """The first ply with the mesh that is used: the given one, or the default of packs.

        That has two elements per crossover, more for a small projectile, as far as anything can come under it, then
        elements of one crossover to twice that distance, and of two beyond. One element per crossover overestimates the
        first wave in the rear plies (docs/theory.md). Where the projectile may leave the first zone, in an oblique
        shot or with edges that are not clamped, the short elements are everywhere; sliding crossovers have one per
        crossover.

        Raises
        ------
        InputError : as ImpactSetup.panel
        """
        ply = self.ply
        if self.plies == 1 or not (ply.grading is None and ply.elements_per_crossover is None) or ply.crossovers:
            return ply
        sides = max(ELEMENTS, ply.resolved_elements_per_crossover)
        panel = replace(ply, elements_per_crossover=1, table_size=_SMALL).panel()  # for its reach
        clamped = all(side == "clamped" for pair in boundary.sides(ply.edge) for side in pair)
        if not clamped or ply.projectile.obliquity != 0:
            return replace(ply, elements_per_crossover=sides)
        near = max(NEAR, *(ceil(far / side) + 1 for far, side in zip(panel.reach(), panel.spacing)))
        return replace(ply, grading=((near, 1 / sides), (2 * near, 1), (inf, 2)))

    def pack(self, table: CellTable | None = None) -> Pack:
        """The pack that this set-up describes, with its own table of the first ply's cell or one that a like set-up has
        filled.

        Raises
        ------
        InputError : as ImpactSetup.panel and Pack.stacked
        """
        panel = self.meshed_ply.panel(table)
        return pack_of(
            panel, self.plies, stacking=self.stacking, gap=self.gap, contact=self.contact, friction=self.friction
        )


@dataclass(frozen=True)
class PackResult(Outcome):
    """What an impact on a pack came to. Energies, forces and counts are those of the whole plies.

    Parameters
    ----------
    setup, pack : what was run
    outcome, residual_velocity, velocity, t, v, nose_position, contact_force, deflection, step_history, bar, backing,
        projectile_position, steps, wall_time, ns_per_element_step, max_deflection, checks : as ImpactResult
    energies : {name: (n,)} [J] with the names of the solver's energies: plies.solver.PACK_ENERGIES, and with sliding
        crossovers sliding_plies.solver.SLIDING_PACK_ENERGIES
    plies : {name: (n, plies)} with the names of panel.solver.PLY_SAMPLES
    peak_tension, peak_tension_time : (plies, 2) [N, s] over the run, of each ply's own warp and weft
    peak_tension_place : (plies, 2, 2) [m] as ImpactResult's
    deepest, held_apart : (plies - 1,) and (2,) [-] see PackSolver
    last : (plies,) snapshots.Snapshot at the end, each from its own plane at rest
    snapshots : tuple of such tuples
    histories : tuple of histories.Histories of each ply that has been followed, empty where none has
    slips : (plies,) sliding.solver.SlipSummary of sliding crossovers; empty of pinned ones
    """

    setup: PackSetup
    pack: Pack
    outcome: str
    residual_velocity: float
    velocity: np.ndarray
    t: np.ndarray
    v: np.ndarray
    nose_position: np.ndarray
    contact_force: np.ndarray
    deflection: np.ndarray
    energies: dict
    plies: dict
    peak_tension: np.ndarray
    peak_tension_time: np.ndarray
    peak_tension_place: np.ndarray
    deepest: np.ndarray
    held_apart: np.ndarray
    step_history: np.ndarray
    bar: dynamics.BarHistory | None
    backing: BackingResult | None
    projectile_position: np.ndarray
    last: tuple
    snapshots: tuple
    histories: tuple
    steps: int
    wall_time: float
    ns_per_element_step: float
    max_deflection: float
    checks: tuple
    slips: tuple[SlipSummary, ...] = ()

    @property
    def first_ply_setup(self) -> ImpactSetup:
        return self.setup.ply

    @property
    def failed_segments(self) -> IntArray:
        """(n,) failed yarn segments of all plies."""
        return self.plies["failed_yarns"].sum(axis=1)


def shots(solver: PackSolver) -> tuple[Snapshot, ...]:
    """(plies,) snapshots.Snapshot of the present, counted from the plane of the first ply at rest."""
    found = []
    for ply, state, z in zip(solver.pack.plies, solver.states, solver.pack.places):
        shot = output_snapshots.snapshot(ply, state, solver.time)
        shot.nodes[..., 2] += z
        found.append(
            replace(
                shot,
                nose_position=shot.nose_position + z,
                projectile_position=solver.stack.projectile_position[0].copy(),
            )
        )
    return tuple(found)


def run(
    setup: PackSetup, *, hooks: Iterable[Hook] = (), resume: FilePath | None = None, table: CellTable | None = None,
    pack: Pack | None = None,
) -> PackResult:  # fmt: skip
    """Run an impact on a pack; parameters, exceptions and resuming as `single_ply.run`, with a `pack` for its panel."""
    ply = setup.ply
    solver = cast(
        PackSolver,
        solver_of(pack or setup.pack(table), ply.strike_velocity, ply.end_time, interval=ply.sample_interval),
    )
    own = (*single_ply.recorder(solver, ply), *single_ply.snapshot_hooks(ply, shots))
    if resume is not None:
        checkpoint.read(solver, resume)
    return run_to_end(solver, (*own, *hooks), lambda: collect_result(setup, solver))


def collect_result(setup: PackSetup, solver: PackSolver) -> PackResult:
    """Gather what a run has recorded."""
    plies = solver.pack.plies
    return PackResult(
        setup=setup,
        pack=solver.pack,
        energies={name: solver.sample(name) for name in solver.energy_names},
        plies={name: solver.ply_sample(name) for name in PLY_SAMPLES},
        peak_tension=solver.peaks,
        peak_tension_time=solver.peak_tensions[..., 1],
        peak_tension_place=solver.peak_tensions[..., 2:],
        deepest=solver.deepest,
        held_apart=solver.held_apart,
        slips=slip_summaries(solver),
        projectile_position=solver.stack.projectile_position[0].copy(),
        last=shots(solver),
        histories=histories.unpack(solver.histories, plies, setup.ply.history)
        if setup.ply.history and solver.histories
        else (),
        **single_ply.projectile_result(solver, solver.pack.elements),
    )
