"""One impact on a pack of plies: set-up, run, result."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from fabrics.errors import InputError
from shellfabric.backing.coupling import BackingResult
from shellfabric.impact import single_ply
from shellfabric.impact.single_ply import ImpactSetup
from shellfabric.output import checkpoint_pack
from shellfabric.output import snapshots as output_snapshots
from shellfabric.output.hooks import Every
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.plies.solver import PACK_ENERGIES, PLY_SAMPLES, PackMarch
from shellfabric.projectile import dynamics


@dataclass(frozen=True)
class PackSetup:
    """A projectile that strikes the middle of a pack.

    Parameters
    ----------
    ply : ImpactSetup of the first ply; its histories along yarns (`measure`) are of a single ply alone
    plies : number of plies
    stacking : "aligned" or "alternating"
    gap : [m] between plies at rest; None takes the fabric's (see `plies.model.fabric_gap`)
    contact : PlyContact, numerical knobs of the contact between plies

    Raises
    ------
    InputError : a set-up that records along yarns
    """

    ply: ImpactSetup
    plies: int
    stacking: str = "aligned"
    gap: float | None = None
    contact: PlyContact = field(default_factory=PlyContact)

    def __post_init__(self):
        if self.ply.measure is not None:
            raise InputError(key="measure", allowed="left out for a pack of plies")

    def pack(self) -> Pack:
        """The pack that this set-up describes; fills the cells' tables.

        Raises
        ------
        InputError : as ImpactSetup.panel and Pack.stacked
        """
        panel = self.ply.panel()
        return Pack.stacked(panel, self.plies, stacking=self.stacking, gap=self.gap, contact=self.contact)


@dataclass(frozen=True)
class PackResult(single_ply.Outcome):
    """What an impact on a pack came to. Energies, forces and counts are those of the whole plies.

    Parameters
    ----------
    setup, pack : what was run
    outcome, residual_velocity, velocity, t, v, z, fine, bar, backing, nose, steps, wall_time, ns_per_element_step,
        max_deflection, checks : as ImpactResult
    energies : {name: (n,)} [J] with the names of plies.solver.PACK_ENERGIES
    plies : {name: (n, plies)} with the names of plies.solver.PLY_SAMPLES
    peak_tension : (plies, 2) [N] over the run, of each ply's own warp and weft
    deepest, held_apart : (plies - 1,) and (2,) [-] see PackMarch
    last : (plies,) snapshots.Snapshot at the end, each from its own plane at rest
    snapshots : tuple of such tuples
    """

    setup: PackSetup
    pack: Pack
    outcome: str
    residual_velocity: float
    velocity: np.ndarray
    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    energies: dict
    plies: dict
    peak_tension: np.ndarray
    deepest: np.ndarray
    held_apart: np.ndarray
    fine: np.ndarray
    bar: dynamics.BarHistory | None
    backing: BackingResult | None
    nose: np.ndarray
    last: tuple
    snapshots: tuple
    steps: int
    wall_time: float
    ns_per_element_step: float
    max_deflection: float
    checks: tuple

    @property
    def struck(self):
        return self.setup.ply

    @property
    def failed(self):
        """(n,) failed yarn segments of all plies."""
        return self.plies["failed_yarns"].sum(axis=1)


class Snapshots(Every):
    """Keep a snapshot of every ply every interval, in march.snapshots."""

    def __call__(self, march):
        if self.due(march):
            march.snapshots.append(shots(march))


def shots(march):
    """(plies,) snapshots.Snapshot of the present, counted from the plane of the first ply at rest."""
    found = []
    for ply, state, z in zip(march.pack.plies, march.states, march.pack.places):
        shot = output_snapshots.snapshot(ply, state, march.time)
        shot.nodes[..., 2] += z
        found.append(replace(shot, z=shot.z + z, nose=march.stack.places[0].copy()))
    return tuple(found)


def run(setup: PackSetup, *, hooks=(), resume=None) -> PackResult:
    """Run an impact on a pack; parameters, exceptions and resuming as `single_ply.run`."""
    march = PackMarch(setup.pack(), setup.ply.strike_velocity, setup.ply.end_time, interval=setup.ply.audit_interval)
    if resume is not None:
        checkpoint_pack.read(march, resume)
    own = single_ply.snapshots(setup.ply, Snapshots)
    return single_ply.carried_out(march, (*own, *hooks), lambda: result_of(setup, march))


def result_of(setup: PackSetup, march: PackMarch) -> PackResult:
    """Gather what a march has recorded."""
    return PackResult(
        setup=setup,
        pack=march.pack,
        energies={name: march.sample(name) for name in PACK_ENERGIES},
        plies={name: march.ply_sample(name) for name in PLY_SAMPLES},
        peak_tension=march.peaks,
        deepest=march.deepest,
        held_apart=march.held_apart,
        nose=march.stack.places[0].copy(),
        last=shots(march),
        **single_ply.of_projectile(march, march.pack.elements),
    )
