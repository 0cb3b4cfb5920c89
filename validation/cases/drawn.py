"""Random shots held against finer meshes: the intervals of `--uncertainty`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fabrics.base.errors import InputError, UnstableError
from shellfabric.impact.run import run_impact_or_partial
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.grid import SYMMETRIES
from validation.cases import drawn_shots
from validation.values import Values
from weavecell.studies import mesh_uncertainty, window

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


def intervals(*, number: int, seed: int) -> Values:
    """Fire a random shot at one ply or, every third, at a pack of two to four.

    The first two meshes are those of `weavecell impact --uncertainty`. All elements of the reference have half the
    side of those of the results.

    Returns
    -------
    dict with shot, in words; outcomes on all meshes; outside, the results of the reference that are not in the
    intervals
    """
    draw_shot = drawn_shots.drawn
    if number % 3 == 2:
        draw_shot = drawn_shots.drawn_pack
    scene: Any = draw_shot(number, seed)
    opening: Any = tuple(SMALLER[scene.plies > 1] * side for side in scene.opening)
    scene = _smallest_part(replace(scene, opening=opening, end_time=END))
    shots: list[Any] = []

    def shoot(setup: ImpactSetup, table: Any, _: str = "") -> Any:
        result, problem = run_impact_or_partial(setup, table=table)
        failure = None
        if problem:
            failure = UnstableError(problem)
        shots.append(mesh_uncertainty.Shot(result, failure, window.fire_window(result)))
        return shots[-1]

    mesh_uncertainty.run_pair(scene, shoot)
    finest = shots[-1].result.setup
    reference = shoot(mesh_uncertainty.halve_elements(finest), finest.table())
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
    plies = ""
    if scene.plies > 1:
        plies = f"{scene.plies} plies, "
    return {
        "shot": f"{plies}{scene.fabric.name}, {scene.projectile.shape}, {scene.strike_velocity:g} m/s",
        "outcomes": outcomes,
        "outside": outside,
    }
