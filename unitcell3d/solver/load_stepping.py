"""Adaptive load stepping of a crossover model along a straight load path, with hooks.

Steps are 10 % of the path; a step that needs few iterations lets the next one grow, a failed one is halved. Each step
starts from the guess that leaves the least residual: the last state, its linear continuation, or the secant. Where even
the least step fails, the contact is softened, the state carried over, and the contact brought back in stages at the
same load; only a state of the full contact stiffness enters the history. A hook is called as hook(share of the path,
row) after each step.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import UnstableError
from fabrics.record import columns
from unitcell3d.model.crossover import CrossoverModel, Load, YarnsModel
from unitcell3d.solver.history import MEANINGS, History
from unitcell3d.solver.newton import ROUGH, Equilibrium, Newton

Hook: TypeAlias = Callable[
    [float, dict[str, Any]], object
]  # called as hook(share of the path, row)


@dataclass(frozen=True)
class Steps:
    """Shares of the path: the first step, the largest and the least; iterations below which a step may grow."""

    first: float = 0.10
    largest: float = 0.10
    least: float = 1e-3
    easy_iterations: int = 12


SOFTENINGS = (0.01, 0.05, 0.2, 0.5, 1.0)


def solve_load_path(
    model: CrossoverModel,
    start: Load,
    end: Load,
    *,
    case: str = "",
    stop: Callable[[dict], float] | None = None,
    steps: Steps | None = None,
    hooks: Sequence[Hook] = (),
) -> History:
    """Load a model from rest along `start` .. `end`.

    Parameters
    ----------
    model : model.crossover.CrossoverModel
    start, end : model.crossover.Load
    stop : function of a row giving a number that reaches 1 where the path is to end; that state is solved for
    steps : Steps
    hooks : called after each step

    Returns
    -------
    History, whose `failed` says why the path ended early if it did
    """
    steps = Steps() if steps is None else steps
    solver = Newton(model)
    try:
        return _solve_load_path(model, solver, start, end, case, stop, steps, hooks)
    finally:
        solver.close()


def _solve_load_path(model, solver, start, end, case, stop, steps, hooks):
    begun = time.perf_counter()
    failed = ""
    states, rows = [], []
    rest = rest_state(model, solver, start)
    model.commit(rest.q, start)
    states.append((0.0, rest.q))
    rows.append(_row(model, rest, start, 0.0, time.perf_counter() - begun))
    step, inside = steps.first, False
    while states[-1][0] < 1:
        share = min(states[-1][0] + step, 1.0)
        if 1 - share < 0.1 * step and not inside:
            share = 1.0
        begun = time.perf_counter()
        try:
            found = _advance(model, solver, states, start, end, share, step <= steps.least)
        except UnstableError as problem:
            if step <= steps.least:
                failed = str(problem)
                break
            step = max(0.5 * step, steps.least)
            continue
        row = _row(model, found, start.towards(end, share), share, time.perf_counter() - begun)
        if stop is not None and stop(row) > 1 + STOP_TOLERANCE:
            # the end is inside this step: take the step again, up to where the secant says it lies
            before, after = stop(rows[-1]), stop(row)
            step, inside = (
                max((share - states[-1][0]) * (1 - before) / (after - before), 1e-6),
                True,
            )
            continue
        model.commit(found.q, start.towards(end, share))
        rows.append(row)
        states = [states[-1], (share, found.q)]
        for hook in hooks:
            hook(share, row)
        if stop is not None and stop(row) >= 1 - STOP_TOLERANCE:
            break
        if found.iterations <= steps.easy_iterations:
            step = min(1.5 * step, steps.largest)
    share, q = states[-1]
    # the gaps belong to the last state, not to the last trial
    model.forces(q, start.towards(end, share))
    last = {"u": model.constraints.displacement(q, start.towards(end, share).d)}
    last |= dict(zip(("gaps_warp", "gaps_weft"), model.surfaces.gaps))
    return History(
        columns(rows), MEANINGS, {"fabric": model.fabric.name, "case": case}, last, failed
    )


STOP_TOLERANCE = 2e-3  # of the quantity that ends a path


def continue_to(
    model: YarnsModel, solver: Newton, q: FloatArray, start: Any, end: Any, shares: Iterable[float]
) -> Iterator[tuple[float, Equilibrium]]:
    """Equilibria at given shares of a straight load path, from a state on it; yields (share, Equilibrium).

    Parameters
    ----------
    solver : newton.Newton
    q : (size,) unknowns in equilibrium at `start`
    shares : rising, from 0 on

    Raises
    ------
    UnstableError : no equilibrium even in the least step, with contact softened
    """
    states, least = [(0.0, q)], Steps().least
    for share in shares:
        step = share - states[-1][0]
        while True:
            goal = min(states[-1][0] + step, share)
            try:
                found = _advance(model, solver, states, start, end, goal, step <= least)
            except UnstableError:
                if step <= least:
                    raise
                step = max(0.5 * step, least)
                continue
            states = [states[-1], (goal, found.q)] if goal > states[-1][0] else [(goal, found.q)]
            if goal == share:
                break
        yield share, found


def _advance(model, solver, states, start, end, share, last_resort):
    """Equilibrium at `share` of the path from the guess that leaves the least residual there."""
    load = start.towards(end, share)
    s1, held = states[-1]
    guesses = [held, solver.linear_guess(held, start.towards(end, s1), load)]
    if len(states) > 1:
        s0, q0 = states[0]
        guesses.append(held + (share - s1) / (s1 - s0) * (held - q0))
    best = solver.best([guess for guess in guesses if guess is not None], load)
    try:
        return solver.approach(best, load)
    except UnstableError:
        if best is not held and not last_resort:
            return solver.approach(held, load)
        if not last_resort:
            raise
    return _penalty_continuation(model, solver, held, load)


def rest_state(model: YarnsModel, solver: Newton, load: Any) -> Equilibrium:
    """Equilibrium of the undeformed crossover, whose sections may overlap by what the mesh leaves of their curves.

    It is taken roughly, to 0.1 mN: a state to start from, with nothing in it but slack yarns.

    Raises
    ------
    UnstableError : none is found
    """
    start = np.zeros(model.size)
    try:
        return solver.solve(start, load, ROUGH)
    except UnstableError:
        pass
    try:
        return _penalty_continuation(model, solver, start, load)
    except UnstableError as problem:
        raise UnstableError(
            "the crossover is not in equilibrium at rest", where=problem.where
        ) from problem


def _penalty_continuation(model, solver, guess, load):
    """Equilibrium by way of softer contacts."""
    full = model.numerics
    try:
        for factor in SOFTENINGS:
            model.numerics = full.softened(factor)
            found = solver.solve(guess, load)
            guess = found.q
        return found
    finally:
        model.numerics = full


def crossover_row(model: Any, state: Equilibrium, load: Any) -> dict[str, Any]:
    """What every case of a crossover records of a state: loads, tensions, contact forces, heights, compression.

    Parameters
    ----------
    model : a model.crossover.YarnsModel with `heights`
    state : newton.Equilibrium
    load : of the model, with `d` and `plates`
    """
    heights, rest = model.heights(model.positions(state.q, load)), model.heights(model.points)
    T1, T2 = model.tensions(state.forces)
    return {
        "d1": load.d[0],
        "d2": load.d[1],
        "plates": load.plates,
        "T1": T1,
        "T2": T2,
        "F_c": model.copies[1] * state.contact,
        "F_plate": model.copies[1] * state.plates,
        "h1": heights[0],
        "h2": heights[1],
        "d_c": 0.5 * (rest.sum() - heights.sum()),
    }


def _row(model, state, load, share, seconds):
    x = model.positions(state.q, load)
    strains, mean = model.fibre_strains(x)
    return {
        "path": share,
        **crossover_row(model, state, load),
        "d_yarns": model.half_thicknesses(model.points) - model.half_thicknesses(x),
        "fibre_strain_max": np.array([strains[model.bar_yarn == yarn].max() for yarn in (0, 1)]),
        "fibre_strain_mean": mean,
        "iterations": state.iterations,
        "seconds": seconds,
    }
