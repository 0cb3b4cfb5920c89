"""The five runs of thesis Table 6-2, and the bare block: how deep the projectile goes, and the shape of its crater.

S-728 of one or four plies, changed in modulus and mass, before the block of Table 6-1; a rigid flat cylinder of 8.1 g
at 300 m/s; yarns do not fail. Not given in the thesis, and chosen here: the edges of the 203 mm opening, clamped as in
all of its other shots, or free, as the plies that bunch up around the projectile in section 6.5 must be (the claims
ledger has both, and its main runs are free); the ply resting on the block; two elements a crossover, since at the angle
at which cloth hangs from the nose the chord of a whole one cuts through its rim. Yarns that are bunched up bear on each
other (`jamming_kernels`). Mass is 1155 g/m2 in the table (5 x 231), four times 231 in the text (erratum E-19): both can
be run.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shellfabric.backing.block import Backing
from shellfabric.backing.coupling import BackingResult, radius_at, wall_angle
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import Numerics
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from shellfabric.solver.pack_solver import PackSolver
from validation.claims.runs import cloth
from validation.models import bare_impact

FABRIC, VELOCITY, PROJECTILE = "S-728", 300.0, Projectile(mass=8.1e-3)
JAM = (1000.0, 0.6)  # [N], [-]: a tenth of a yarn's EA, from three fifths of its length on
# half the usual time step: where stiff yarns snap taut a step loses with its square (`panel.model.Numerics`), in the
# first target with free edges 0.5 % of the shot's energy at the usual one
SAFETY = 0.45
BLOCK = Backing(min_size=1.5e-3, refined_depth=9e-3, growth=1.25, points=1)


@dataclass(frozen=True)
class Case:
    """A target: plies, factor on the fibre modulus, total areal density [kg/m2]."""

    plies: int
    modulus: float
    mass: float


CASES = {
    1: Case(1, 5.0, 1.155),
    2: Case(1, 1.0, 1.155),
    3: Case(1, 5.0, 0.231),
    4: Case(1, 1.0, 0.231),
    5: Case(4, 1.0, 1.155),
}


@dataclass(frozen=True)
class Penetration:
    """What a shot came to.

    Parameters
    ----------
    outcome : "stopped", "in flight" or what went wrong
    t, z, v : (n,) [s], [m], [m/s] of the projectile
    crater : (k, 2) [m] radius and depth along the warp
    steepness : [rad] of its wall against the face
    half_width : [m] radius at half of its depth
    energies : {name: (n,)} [J]
    balance : [-] worst error of the energy balance over the strike energy
    seconds : [s] of marching
    block : BackingResult; None of the bare block
    """

    outcome: str
    t: np.ndarray
    z: np.ndarray
    v: np.ndarray
    crater: np.ndarray
    steepness: float
    half_width: float
    energies: dict
    balance: float
    seconds: float
    block: BackingResult | None = None

    @property
    def depth(self) -> float:
        """[m] of the projectile at its deepest."""
        return float(self.z.max())

    @property
    def crater_depth(self) -> float:
        """[m]"""
        return float(self.crater[:, 1].max())


def march(
    case: Case, *, block: Backing = BLOCK, elements: int = 2, edge: str = "clamped", jam: tuple[float, float] = JAM,
    end_time: float = 1e-3, velocity: float = VELOCITY, opening: float = 0.203, layer: Any = None,
) -> PackSolver:  # fmt: skip
    """The march of a shot at a target before a block.

    `layer`, if given, is a factor on the shear angles at which the ply next to the block touches and locks.
    """
    fabric = cloth(FABRIC, modulus=case.modulus)
    fabric = cloth(FABRIC, modulus=case.modulus, mass=case.mass / case.plies / fabric.weave.areal_density)
    setup = ImpactSetup(
        fabric, velocity, projectile=PROJECTILE, edge=edge, failure=False, elements_per_crossover=elements, jam=jam,
        backing=block, opening=opening, numerics=Numerics(cfl=SAFETY),
    )  # fmt: skip
    pack = Pack.stacked(setup.panel(), case.plies)
    if layer is not None:
        law = fabric.shear
        law = replace(law, gamma1=layer * law.gamma1, gamma2=layer * law.gamma2)
        last = replace(setup, fabric=replace(fabric, shear=law)).panel()
        pack = replace(pack, plies=(*pack.plies[:-1], last))
    return PackSolver(pack, velocity, end_time)


def shoot(case: Case, **options: Any) -> Penetration:
    """Fire at a target before a block, until the projectile turns back; options are those of `march`.

    Raises
    ------
    UnstableError : as PackSolver
    """
    run = march(case, **options).run()
    block = run.backing.result()
    energies = {name: run.sample(name) for name in run.energy_names}
    balance = float(np.abs(energies["error"]).max()) / run.strike_energy
    return Penetration(
        run.outcome, run.sample("t"), run.sample("z"), run.sample("v"), block.crater, block.steepness, block.half_width,
        energies, balance, run.wall_time, block,
    )  # fmt: skip


def bare(block: Any = BLOCK, velocity: float = VELOCITY, end_time: float = 2e-3) -> Penetration:
    """Fire at the block alone."""
    found = bare_impact.strike(block, PROJECTILE, velocity, end_time)
    crater, energy = found.crater, PROJECTILE.energy(velocity)
    return Penetration(
        "stopped" if found.v[-1] <= 0 else "in flight", found.t, found.z, found.v, crater, wall_angle(crater),
        radius_at(crater, 0.5), found.energies, float(np.abs(found.energies["error"]).max()) / energy, np.nan,
    )  # fmt: skip


def fire(case: Case | None, edge: str, elements: int) -> Penetration:
    """A shot of the study; without a case at the bare block, whose shot does not depend on the rest."""
    return bare() if case is None else shoot(case, edge=edge, elements=elements)
