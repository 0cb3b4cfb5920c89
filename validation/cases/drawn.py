"""Random shots held against finer meshes: the intervals of `--uncertainty`, and the target of [accuracy]."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np

from fabrics.base.errors import InputError, UnstableError
from shellfabric.impact.run import run_impact_or_partial
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.grid import SYMMETRIES
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


def targets(*, number: int, seed: int) -> Values:
    """Fire a random shot at one ply or, every third, at a pack of two to four, with a target for
    one quantity.

    The first two meshes are those of `weavecell impact --uncertainty`. All elements of the reference have half the
    side of those of the results.

    Returns
    -------
    dict with shot, in words; quantity, its target [-] and its error [-] against the reference; outcomes on all meshes;
    outside, the results of the reference that are not in the intervals of the first mesh; mesh of the results;
    confirmed, by the command; met, whatever it says; cost [-] of the command's meshes over that of the first
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
        result, problem = run_impact_or_partial(setup, table=table)
        failure = None
        if problem:
            failure = UnstableError(problem)
        shots.append(mesh_uncertainty.Shot(result, failure, window.fire_window(result)))
        seconds.append(time.process_time() - began)
        return shots[-1]

    answer, found = mesh_uncertainty.refine(scene, quantity, target, shoot)
    cost = sum(seconds) / seconds[0]
    reference = shoot(mesh_uncertainty.halve_elements(found.setup), found.setup.table())
    outcomes = [shot.result.outcome for shot in shots]
    reference_values = {}
    for interval in mesh_uncertainty.compare(shots[0], reference).intervals:
        reference_values[interval.name] = interval.other
    outside = []
    for interval in mesh_uncertainty.compare(*shots[:2]).intervals:
        # a reference with another outcome has no values
        value = reference_values.get(interval.name, interval.value)
        if abs(value - interval.value) > interval.uncertainty:
            outside.append(interval.name)
    strike = {
        "residual velocity": scene.strike_velocity,
        "absorbed energy": answer.result.strike_energy,
    }
    error = 0.0  # of what is not there
    for interval in mesh_uncertainty.compare(answer, reference).intervals:
        if QUANTITIES[interval.name] == quantity:
            scale = strike.get(interval.name, interval.other)
            share = abs(interval.other - interval.value) / scale
            error = max(error, share)
    plies = ""
    if scene.plies > 1:
        plies = f"{scene.plies} plies, "
    return {
        "shot": f"{plies}{scene.fabric.name}, {scene.projectile.shape}, {scene.strike_velocity:g} m/s",
        "quantity": quantity,
        "target": target,
        "error": error,
        "outcomes": outcomes,
        "outside": outside,
        "mesh": found.meshes[-1],
        "confirmed": found.confirmed,
        "met": outcomes[-2] == outcomes[-1] and error <= target,
        "cost": cost,
    }
