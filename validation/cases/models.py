"""One scene by each model that can run it: what the cheaper ones leave off the richest, and at which cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import nan, sqrt

import numpy as np

from fabrics import catalogue
from fabrics.base.units import si
from validation.cases import impact, patches
from validation.filling import merged
from validation.values import Values
from weavecell.studies import model_choice

# of each model, in words of the table: changes of the scene
OF_MODELS: Mapping[str, Values] = {
    "membrane, 1 element": {"elements_per_crossover": 1},
    "membrane, 3 elements": {},
    "resolved yarns": {"crossovers": "yarns"},
    "rigid nose": {"projectile": {"body": "rigid"}},
    "bar": {"projectile": {"body": "rigid"}, "bar_of": "lead-antimony"},
    "body of metal": {},
}
# models of a patch, as `patches.struck` calls them
OF_A_PATCH = {
    "membrane, 3 elements": "pinned",
    "resolved yarns": "yarns",
    "woven solids": "solids",
}


def compare(
    *,
    models: Sequence[str],
    velocities: Sequence[float],
    at: float | str | None = None,
    friction: float | None = None,
    patch: Values | None = None,
    **scene: object,
) -> Values:
    """Run a scene in models, of which the last is the richest.

    Parameters
    ----------
    models : of OF_MODELS, or of a patch of OF_A_PATCH
    velocities : [m/s] of the shots, over which the energy is averaged: which yarn is cut next differs by chance
    at : [s] after which the energy taken from the projectile is compared, and its way; None compares the energy that
        a perforated target has absorbed
    friction : [-] between yarns where they are resolved
    patch : of a patch of woven solids, keywords of `patches.struck`, in place of a scene of `impact.setup`
    scene : keywords of `impact.setup`

    Returns
    -------
    dict with off {model: [%]}, the larger difference from the richest of the energy taken from the projectile and, with
    `at`, its way; known [%], the largest standard error of the difference of two means; cpu {model: [s]} of all shots;
    cheapest, the cheapest model that is within NEAR with this error, with off_of_cheapest and
    cost_over_richest; richest; the numbers of `model_choice.SceneNumbers`; and what `_judge_advice` returns
    """
    found = {}
    if isinstance(at, str):
        at = si(at, "s", key="at")
    for name in models:
        if patch is None:
            found[name] = _fire(name, velocities, at, friction, scene)
        else:
            found[name] = _strike(name, velocities[0], at, friction, patch)
    richest, scatter, _ = found[models[-1]]
    off = {}
    known = {}
    cpu = {}
    for name, (values, error, seconds) in found.items():
        off[name] = 100 * float(np.max(np.abs(values / richest - 1)))
        known[name] = 0.0
        if name != models[-1]:
            known[name] = 100 * float(np.hypot(error, scatter)) / richest[0]
        cpu[name] = seconds
    near = [name for name in models if off[name] + known[name] <= model_choice.NEAR]
    cheapest = min(near, key=cpu.__getitem__)
    numbers = _describe(scene, velocities, friction, patch)
    return {
        "off": off,
        "known": max(known.values()),
        "cpu": cpu,
        "cheapest": cheapest,
        "richest": models[-1],
        "off_of_cheapest": off[cheapest],
        "cost_over_richest": cpu[cheapest] / cpu[models[-1]],
        **vars(numbers),
        **_judge_advice(model_choice.find_advice(numbers), near, cheapest, off, cpu),
    }


def _judge_advice(advice, near, cheapest, off, cpu):
    """What `impact --check` advises for a scene (None: none is like it), beside what the runs show: the nearest
    scene, the model, and a verdict. "hit" is the cheapest model within NEAR, "dearer" another one within NEAR,
    "miss" one that is not."""
    if advice is None:
        return {
            "like": "",
            "advised": "",
            "verdict": "none is like it",
            "off_of_advised": nan,
            "cost_of_advised": nan,
        }
    advised = advice.model
    if advised == cheapest:
        verdict = "hit"
    elif advised in near:
        verdict = "dearer"
    else:
        verdict = "miss"
    return {
        "like": advice.like.name,
        "advised": advised,
        "verdict": verdict,
        "off_of_advised": off[advised],
        "cost_of_advised": cpu[advised] / cpu[cheapest],
    }


def _fire(name, velocities, at, friction, scene):
    """(energy [J] and way [m] of a model, as an array; standard error of the energy; CPU time [s])."""
    keywords = merged(dict(scene), OF_MODELS[name])
    if name == "resolved yarns" and friction is not None:
        keywords["crossover_friction"] = friction
    # compiles
    impact.shot(velocity=velocities[0], **keywords | {"end_time": "5 us", "table_size": 11})
    energies = []
    ways = []
    seconds = 0.0
    for velocity in velocities:
        shot = impact.shot(velocity=velocity, **keywords)
        seconds += shot["cpu_s"]
        if at is None:
            energies.append(float(shot["absorbed"][-1]))
        else:
            energies.append(float(np.interp(at, shot["t"], shot["absorbed"])))
            ways.append(float(np.interp(at, shot["t"], shot["z"])))
    values = [float(np.mean(energies))]
    if ways:
        values.append(float(np.mean(ways)))
    error = 0.0
    if len(energies) > 1:
        error = float(np.std(energies, ddof=1)) / sqrt(len(energies))
    return np.array(values), error, seconds


def _strike(name, velocity, at, friction, patch):
    """The same of a patch that is struck."""
    keywords = dict(patch)
    if friction is not None:
        keywords["friction"] = friction
    shot = patches.struck(model=OF_A_PATCH[name], velocity=velocity, **keywords)
    v = float(np.interp(at, shot["t"], shot["v"]))
    way = float(np.interp(at, shot["t"], shot["z"]))
    energy = 0.5 * patches.SPHERE.mass * (velocity**2 - v**2)
    return np.array([energy, way]), 0.0, shot["cpu"]


def _describe(scene, velocities, friction, patch):
    """The numbers by which a user's scene finds this one."""
    if patch is not None:
        scene = scene | {"fabric": patch["fabric"]}
    setup = impact.setup(velocity=float(np.median(velocities)), **scene)
    if patch is not None:
        setup = replace(setup, fabric=catalogue.load(patch["fabric"]), projectile=patches.SPHERE)
    numbers = model_choice.describe(setup, setup.target(setup.plain_table()))
    if friction is not None:
        numbers = replace(numbers, friction=friction)
    return numbers
