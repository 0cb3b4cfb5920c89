"""A patch of fabric that is struck by a sphere, by each of the models: solid yarns, resolved yarns, pinned panel."""

from __future__ import annotations

import time
from math import inf
from typing import Any

import numpy as np

from fabrics import catalogue
from meshing import patch
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.solids.mesh import SolidMesh
from shellfabric.solids.model import SolidPatch
from shellfabric.solids.solver import SolidSolver
from shellfabric.yarns.model import YarnZone
from validation.values import Values

# [spacings] of an even patch of solids, whose middle is between yarns; that of a panel is a crossover
OFF = {"gap": 0.0, "crossover": 0.5}
SPHERE = Projectile(mass=0.11e-3, radius=1.5e-3, shape="sphere")


def struck(
    *,
    model: str,
    place: str,
    friction: float = 0.2,
    fabric: str = "S-720",
    crossings: int = 12,
    size: tuple[int, int, int] = (2, 2, 1),
    velocity: float = 60.0,
    duration: float = 50e-6,
) -> Values:
    """Strike a clamped patch whose fibres do not fail.

    Parameters
    ----------
    model : "solids", "yarns" or "pinned"
    place : "gap" or "crossover", which is struck
    friction : Coulomb's coefficient between yarns
    fabric : name
    crossings : of each family; an even number
    size : of the mesh of solids, see `meshing.patch`
    velocity, duration : [m/s], [s]

    Returns
    -------
    t, v, z (n,) [s], [m/s], [m] of the nose since it touched; error, the largest of the energy over the
    strike energy; steps; cpu [s]
    """
    known = catalogue.load(fabric)
    off = OFF[place] if model == "solids" else 0.5 - OFF[place]
    aim = tuple(2 * off * w for w in known.weave.w)
    if model == "solids":
        return _solids(known, crossings, size, aim, friction, velocity, duration)
    return _panel(model, known, crossings, aim, friction, velocity, duration)


def _solids(fabric, crossings, size, aim, friction, velocity, duration):
    mesh = patch.build(fabric, (crossings, crossings), size=size)
    patched = SolidPatch(
        SolidMesh.of(mesh),
        fabric,
        SPHERE,
        aim=aim,
        friction=friction,
        fibre_fractions=tuple(mesh.Vf0),
        failure=False,
    )
    solver = SolidSolver(patched, velocity, duration)
    start = time.process_time()
    solver.run()
    return {
        "t": solver.sample("t"),
        "v": solver.sample("v"),
        "z": solver.sample("z") - solver.sample("z")[0],
        "error": np.abs(solver.sample("error")).max() / solver.strike_energy,
        "steps": solver.steps,
        "cpu": time.process_time() - start,
    }


def _panel(model, fabric, crossings, aim, friction, velocity, duration):
    choices: dict[str, Any] = {}
    if model == "yarns":
        choices["crossovers"] = YarnZone(half_width=inf, friction=friction)
    side = 2 * crossings * fabric.weave.w1
    scene = ImpactSetup(
        fabric,
        velocity,
        projectile=SPHERE,
        opening=side,
        symmetry="whole",
        end_time=duration,
        yarn_failure=False,
        elements_per_crossover=1,
        impact_point=aim,
        **choices,
    )
    start = time.process_time()
    result = run_impact(scene)
    return {
        "t": result.time,
        "v": result.velocity,
        "z": result.nose_position - result.nose_position[0],
        "error": result.energy_error_max,
        "steps": len(result.step_history),
        "cpu": time.process_time() - start,
    }
