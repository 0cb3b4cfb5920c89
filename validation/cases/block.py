"""Blocks of tissue simulant: how deep the projectile of thesis Table 6-2 goes into that of Table 6-1, and its crater.

S-728 of one or four plies, changed in modulus and mass, before the block of Table 6-1; a rigid flat cylinder of 8.1 g
at 300 m/s; yarns do not fail. Not given in the thesis, and chosen here: the edges of the 203 mm opening, clamped as in
all of its other shots, or free, as the plies that bunch up around the projectile in section 6.5 must be (the claims
ledger has both, and its main runs are free); the ply resting on the block; two elements a crossover, since at the angle
at which fabric hangs from the nose the chord of a whole one cuts through its rim. Fabric that bunches up keeps the
area of its packed yarns (`packing_kernels`). Mass is 1155 g/m2 in the table (5 x 231), four times 231 in the text
(erratum E-19): both can be run.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fabrics import catalogue, variants
from shellfabric.block.block import Backing
from shellfabric.block.coupling import result_of
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from validation.models import bare_impact
from validation.values import Values, largest

VELOCITY = 300.0
PROJECTILE = Projectile(mass=8.1e-3)
# half the usual time step: where stiff yarns snap taut a step loses with its square
# (`membrane.numerics.Numerics`), in the first target with free edges 0.5 % of the shot's energy at the usual one
SAFETY = 0.45
BLOCK = Backing(min_size=1.5e-3, refined_depth=9e-3, growth=1.25, points=1)


def march(
    plies: int,
    modulus: float,
    mass: float,
    *,
    boundary: str = "free",
    elements: int = 2,
    layer: float | None = None,
    block: Backing = BLOCK,
    opening: float = 0.203,
) -> PackSolver:
    """Set up the time integration of a shot at a target before a block.

    Parameters
    ----------
    plies, modulus, mass : number, factor on the fibre modulus, areal density of all [kg/m2]
    boundary, elements, block, opening : of `ImpactSetup`; elements along each side of a crossover
    layer : factor on the shear angles at which the ply next to the block touches and locks
    """
    fabric = variants.scale_yarns(catalogue.load("S-728").with_effective_density(), E=modulus)
    fabric = variants.scale_areal_density(fabric, mass / plies / fabric.weave.areal_density)
    setup = ImpactSetup(
        fabric,
        VELOCITY,
        projectile=PROJECTILE,
        boundary=boundary,
        yarn_failure=False,
        length_effect=False,
        elements_per_crossover=elements,
        backing=block,
        opening=opening,
        numerics=Numerics(cfl=SAFETY),
    )
    pack = Pack.stacked(setup.panel(), plies)
    if layer is not None:
        law = fabric.shear
        law = replace(law, gamma1=layer * law.gamma1, gamma2=layer * law.gamma2)
        last = replace(setup, fabric=replace(fabric, shear=law)).panel()
        pack = replace(pack, plies=(*pack.plies[:-1], last))
    return PackSolver(pack, VELOCITY, 1e-3)


def target(plies: int, modulus: float = 1.0, mass: float = 0.0, **options: Any) -> Values:
    """Fire a shot at a target before its block, or at the bare block without plies, until the
    projectile turns back.

    Parameters
    ----------
    plies, modulus, mass, **options : of `march`

    Returns
    -------
    dict with outcome, end [s], depth, crater, half_width [m], wall [deg] against the face, eroded hexahedra, error,
    hourglass [-] of the energy lost

    Raises
    ------
    UnstableError : as PackSolver
    """
    if plies:
        run = march(plies, modulus, mass, **options).run()
        t = run.sample("t")
        z = run.sample("z")
        energies = {name: run.sample(name) for name in run.energy_names}
        block = result_of(run.part("block").block)
        outcome = run.outcome
        eroded = int(block.gone.sum())
        lost = energies["kinetic_projectile"]
        hourglass = energies["backing_hourglass"]
    else:
        bare = bare_impact.strike(BLOCK, PROJECTILE, VELOCITY, 2e-3)
        t = bare.t
        z = bare.z
        energies = bare.energies
        block = bare.block
        eroded = None
        outcome = "in flight"
        if bare.v[-1] <= 0:
            outcome = "stopped"
        lost = energies["projectile"]
        hourglass = energies["hourglass"]
    return {
        "outcome": outcome,
        "end": float(t[-1]),
        "depth": float(z.max()),
        "crater": block.depth,
        "half_width": block.half_width,
        "wall": float(np.degrees(block.steepness)),
        "error": largest(energies["error"]) / PROJECTILE.energy(VELOCITY),
        "eroded": eroded,
        "hourglass": float(hourglass[-1] / (lost[0] - lost[-1])),
    }
