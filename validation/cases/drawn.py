"""Random shots held against finer meshes: the intervals of `--uncertainty`, and the target of [accuracy]."""

from __future__ import annotations

import time
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from fabrics.base.errors import InputError, UnstableError
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.grid import SYMMETRIES
from validation.cases import drawn_shots
from validation.values import Values
from weavecell.studies import mesh_uncertainty, window

TARGETS = (0.02, 0.05, 0.1)
QUANTITIES = {
    "residual velocity": "residual_velocity",
    "absorbed energy": "absorbed_energy",
    "peak deflection": "deflection",
    "peak tension, warp": "peak_tension",
    "peak tension, weft": "peak_tension",
}
# a smaller opening, over that of a drawn ply and of a pack, and an early end [s]: shots of seconds
SMALLER = (0.5, 0.35)
END = 250e-6


def _reference(setup: ImpactSetup, finer: ImpactSetup) -> ImpactSetup:
    """The set-up with a quarter of the scene's element side near the impact point, and half of it around that."""
    count = setup.resolved_elements_per_crossover
    if finer.grading is None:
        return replace(setup, elements_per_crossover=4 * count)
    reach = finer.grading[0][0]
    grading = ((reach, 1 / (4 * count)), (2 * reach, 1 / (2 * count)), (inf, 1 / count))
    return replace(setup, elements_per_crossover=None, grading=grading)


def _smallest_part(scene: ImpactSetup) -> ImpactSetup:
    """The set-up with the smallest part of the panel that shot, edges and weave let stand for all of it, one thread."""
    scene = replace(scene, numerics=replace(scene.numerics, threads=1))
    for symmetry in SYMMETRIES:
        part = replace(scene, symmetry=symmetry)
        try:
            part.panel(part.plain_table())
        except InputError:
            continue
        return part
    return scene


def interval(*, number: int, seed: int) -> Values:
    """A random scene on its own mesh, the finer one of `weavecell impact --uncertainty`, and a reference.

    Returns
    -------
    dict with fabric, velocity [m/s]; outcomes on the three meshes; decided, whether the pair has one outcome; covered,
    whether the reference has it too and lies in all intervals; outside, the results that do not; widths and errors
    {result: [-] of the value}; cost [-] of the pair over that of the scene
    """
    scene = drawn_shots.drawn(number, seed)
    setup: Any = _smallest_part(scene)
    table = setup.table()
    refined: Any = mesh_uncertainty.finer(setup, table)
    shots: list[Any] = []
    seconds: list[float] = []
    for this in (setup, refined, _reference(setup, refined)):
        began = time.process_time()
        result = simulation.run(this, table=table)
        shots.append(mesh_uncertainty.Shot(result, window=window.about(result)))
        seconds.append(time.process_time() - began)
    pair = mesh_uncertainty.compare(*shots[:2])
    finest = {one.name: one.other for one in mesh_uncertainty.compare(shots[0], shots[2]).intervals}
    known = [one for one in pair.intervals if one.name in finest]
    outcomes = [shot.result.outcome for shot in shots]
    outside = [one.name for one in known if abs(finest[one.name] - one.value) > one.uncertainty]
    return {
        "fabric": setup.fabric.name,
        "velocity": setup.strike_velocity,
        "outcomes": outcomes,
        "decided": outcomes[0] == outcomes[1],
        "covered": len(set(outcomes)) == 1 and not outside,
        "outside": outside,
        "widths": {one.name: one.uncertainty / abs(one.value) for one in known if one.value},
        "errors": {one.name: abs(finest[one.name] / one.value - 1) for one in known if one.value},
        "cost": (seconds[0] + seconds[1]) / seconds[0],
    }


def targets(*, number: int, seed: int) -> Values:
    """A random shot at one ply or, every third, at a pack of two to four, with a target for one quantity.

    All elements of the reference have half the side of those of the results.

    Returns
    -------
    dict with shot, in words; quantity, its target [-] and its error [-] against the reference; outcomes of both;
    mesh of the results; confirmed, by the command; met, whatever it says; cost [-] of all meshes over that of the first
    """
    draw = np.random.default_rng((seed, number, 1))
    quantity = str(draw.choice(sorted(set(QUANTITIES.values()))))
    target = float(draw.choice(TARGETS))
    draw_shot = drawn_shots.drawn
    if number % 3 == 2:
        draw_shot = drawn_shots.drawn_pack
    scene: Any = draw_shot(number, seed)
    opening: Any = tuple(SMALLER[scene.plies > 1] * side for side in scene.opening)
    scene = _smallest_part(replace(scene, opening=opening, end_time=END))
    shots: list[Any] = []
    seconds: list[float] = []

    def shoot(setup: ImpactSetup, table: Any, _: str = "") -> Any:
        began = time.process_time()
        result, problem = simulation.fired(setup, table=table)
        failure = None
        if problem:
            failure = UnstableError(problem)
        shots.append(mesh_uncertainty.Shot(result, failure, window.about(result)))
        seconds.append(time.process_time() - began)
        return shots[-1]

    _, found = mesh_uncertainty.refine(scene, quantity, target, shoot)
    answer = shots[-1]
    cost = sum(seconds) / seconds[0]
    shoot(mesh_uncertainty.halved(found.setup), found.setup.table())
    strike = {
        "residual velocity": scene.strike_velocity,
        "absorbed energy": answer.result.strike_energy,
    }
    error = 0.0  # of what is not there
    for one in mesh_uncertainty.compare(answer, shots[-1]).intervals:
        if QUANTITIES[one.name] == quantity:
            share = abs(one.other - one.value) / strike.get(one.name, one.other)
            error = max(error, share)
    outcomes = [answer.result.outcome, shots[-1].result.outcome]
    same = outcomes[0] == outcomes[1]
    plies = ""
    if scene.plies > 1:
        plies = f"{scene.plies} plies, "
    return {
        "shot": f"{plies}{scene.fabric.name}, {scene.projectile.shape}, {scene.strike_velocity:g} m/s",
        "quantity": quantity,
        "target": target,
        "error": error,
        "outcomes": outcomes,
        "mesh": found.meshes[-1],
        "confirmed": found.confirmed,
        "met": same and error <= target,
        "cost": cost,
    }
