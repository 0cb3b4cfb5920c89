"""A small patch of woven solid yarns under a rigid projectile, in one call.

It answers "may I pin the crossovers for my nose?" with a model that neither the pinned panel nor the
resolved yarns were built from: strike the same patch with all three, and compare the velocities of
the first tens of microseconds.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from fabrics import catalogue
from fabrics.assumed import friction_between_yarns
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from meshing import patch
from shellfabric.loop import checkpoint
from shellfabric.loop.driver import Hook, run_to_end
from shellfabric.projectile.projectile import Projectile
from validation.models.solids.mesh import SolidMesh
from validation.models.solids.model import SolidPatch
from validation.models.solids.numerics import SolidNumerics
from validation.models.solids.solver import SolidSolver

FEWEST = 3
MOST = 40  # crossings of a side: 40 x 40 of the coarsest mesh are 50,000 hexahedra
LONGEST = 100e-6  # [s]: a patch is clamped all round, and tears as one point of a brick sees it


@dataclass(frozen=True)
class SolidShot:
    """A patch that has been struck.

    Parameters
    ----------
    patch : SolidPatch
    t : (n,) [s]
    v : (n,) [m/s] of the projectile
    z : (n,) [m] way of the projectile since it touched
    force : (n,) [N] on the projectile
    energies : {name: (n,) [J]}; "error" is the sum of the others less that at the start
    failed_bars : (n,) number of fibre bars that have failed, in the modelled part
    strike_energy : [J]
    """

    patch: SolidPatch
    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    force: np.ndarray
    energies: dict[str, np.ndarray]
    failed_bars: np.ndarray
    strike_energy: float

    @property
    def energy_error(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.abs(self.energies["error"]).max()) / self.strike_energy

    @property
    def edge_time(self) -> float:
        """[s] at which the wave along the yarns is back from the clamped ends: until then the patch
        is as good as a large one."""
        fastest = max(yarn.wave_speed for yarn in self.patch.fabric.weave.yarns)
        points = self.patch.mesh.points
        return float(2 * np.abs(points[:, :2]).max() / fastest)


def strike(
    fabric: Fabric | str,
    strike_velocity: float,
    projectile: Projectile,
    *,
    crossings: int = 12,
    size: Sequence[int] = (3, 3, 1),
    friction: float | None = None,
    duration: float = 50e-6,
    failure: bool = True,
    numerics: SolidNumerics | None = None,
    hooks: Iterable[Hook] = (),
    resume: FilePath | None = None,
) -> SolidShot:
    """Strike a square patch of solid yarns, clamped all round, in its middle.

    Parameters
    ----------
    fabric : Fabric with solid laws, or the name of one of the catalogue
    strike_velocity : [m/s]
    projectile : Projectile, rigid, straight on; its friction is that on the yarns
    crossings : number of yarns of each family. Of an even number the gap between four yarns is
        struck; of an odd number a crossover, of which a quarter is computed
    size : hexahedra along, across and through a quarter of a yarn in one crossing
    friction : Coulomb's coefficient between yarns; that of `fabrics.assumed.friction_between_yarns`
        if not given
    duration : [s]
    failure : whether fibres fail
    numerics : SolidNumerics
    hooks : called with the solver after each sample, such as `loop.checkpoint.Checkpoints`
    resume : a checkpoint of the same shot, from which it goes on

    Raises
    ------
    InputError : a number that is not allowed, a projectile that is not modelled, a fabric without
        solid laws or that cannot be meshed, or a checkpoint of another shot
    UnstableError : a brick turned over, or energy lost; `error.result` has the shot up to then
    """
    known = catalogue.load(fabric) if isinstance(fabric, str) else fabric
    if not FEWEST <= crossings <= MOST:
        raise InputError(key="crossings", value=crossings, allowed=f"from {FEWEST} to {MOST}")
    if not 0 < duration <= LONGEST:
        raise InputError(
            key="duration",
            value=duration,
            allowed=f"above 0 and at most {LONGEST:g} s: a patch is for the first microseconds",
        )
    if friction is None:
        friction = friction_between_yarns(known).value
    mesh = patch.build(known, (crossings, crossings), size=tuple(size))
    model = SolidPatch(
        SolidMesh.of(mesh, quarter=crossings % 2 == 1),
        known,
        projectile,
        friction=friction,
        fibre_fractions=mesh.Vf0,
        numerics=numerics or SolidNumerics(),
        failure=failure,
    )
    solver = SolidSolver(model, strike_velocity, duration)
    if resume is not None:
        checkpoint.read(solver, resume)
    return run_to_end(solver, hooks, lambda: collect(solver))


def collect(solver: SolidSolver) -> SolidShot:
    """Return what a solver has recorded."""
    z = solver.sample("z")
    return SolidShot(
        patch=solver.patch,
        t=solver.sample("t"),
        v=solver.sample("v"),
        z=z - z[0],
        force=solver.sample("force"),
        energies={name: solver.sample(name) for name in solver.energy_names},
        failed_bars=solver.sample("failed_bars"),
        strike_energy=solver.strike_energy,
    )
