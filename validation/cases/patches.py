"""A patch of fabric that is struck by a sphere, by each of the models: solid yarns, resolved yarns, pinned panel."""

from __future__ import annotations

import time
from dataclasses import replace

from fabrics import catalogue
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from validation.cases.small_patch import Place, SmallPatch, StepClock
from validation.models.cable.net import CableNet
from validation.values import Values

SPHERE = Projectile(mass=0.11e-3, radius=1.5e-3, shape="sphere")


def struck(
    *,
    model: str,
    place: Place,
    friction: float = 0.2,
    fabric: str = "S-720",
    crossings: int = 12,
    size: tuple[int, int, int] = (2, 2, 1),
    velocity: float = 60.0,
    duration: float = 32e-6,
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
    strike energy; steps; cpu [s] of these
    """
    shot = ImpactSetup(
        catalogue.load(fabric),
        velocity,
        projectile=SPHERE,
        crossovers=YarnZone(friction=friction),
        yarn_failure=False,
    )
    patch = SmallPatch(shot, crossings, place, size, duration)
    found = getattr(patch, f"strike_{model}")()
    return {
        "t": found.t,
        "v": found.v,
        "z": found.z,
        "error": found.energy_error,
        "steps": found.steps,
        "cpu": found.cpu,
    }


def timed(
    *,
    model: str,
    fabric: str = "S-720",
    crossings: int = 20,
    size: tuple[int, int, int] = (2, 2, 1),
    velocity: float = 60.0,
    duration: float = 42e-6,
) -> Values:
    """Time a patch that is struck on a crossover by a flat cylinder, whose fibres do not fail (thesis Table 4-3:
    25.4 mm of S-720 for 42 us by solids, a quarter of 203 mm for 250 us by cables and shells).

    Parameters
    ----------
    model : "cable" or "shell", with an element a crossover, of which a quarter is computed; "pinned" panel on the
        default mesh, "yarns" or "solids"
    fabric, crossings, size, velocity, duration : as in `struck`; "cable" and "shell" take any even number of crossings

    Returns
    -------
    cpu [s] of the steps of a whole patch; ns [ns] of that a crossover and us; lost [m/s] in the duration
    """
    shot = ImpactSetup(catalogue.load(fabric), velocity, yarn_failure=False)
    if model in ("cable", "shell"):
        weave = shot.fabric.weave
        side = 2 * weave.w1 * crossings, 2 * weave.w2 * crossings
        scene = replace(shot, opening=side, elements_per_crossover=1, end_time=duration)
        run = {"cable": _cable, "shell": _shell}[model]
        cpu, history = run(scene)
        cpu *= 4
        simulated = history[-1, 0]
        lost = velocity - history[-1, 2]
    else:
        patch = SmallPatch(shot, crossings, "crossover", size, duration)
        found = getattr(patch, f"strike_{model}")()
        cpu = found.cpu
        simulated = duration
        lost = velocity - found.v[-1]
    return {"cpu": cpu, "ns": 1e9 * cpu / (crossings**2 * simulated * 1e6), "lost": float(lost)}


def _cable(scene):
    """CPU time [s] of a quarter of a cable net, and the rows of its steps: time, position and velocity of the nose."""
    CableNet(replace(scene, end_time=1e-6)).run()  # compiles
    net = CableNet(scene)
    began = time.process_time()
    history = net.run().step_history
    return time.process_time() - began, history


def _shell(scene):
    """CPU time [s] of a quarter of a panel, and the rows of its steps as of `_cable`."""
    clock = StepClock()
    history = run_impact(scene, hooks=[clock]).step_history
    return clock.seconds, history
