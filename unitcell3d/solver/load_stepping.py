"""Equilibria along a straight leg of a load path: guesses, halved steps, and softer contact where
nothing else helps.

Each step starts from the guess that leaves the least residual: the last state, its linear
continuation, or the secant. A step that finds no equilibrium is halved. Where even the least step
fails, the contact is softened, the state carried over, and the contact brought back in stages at
the same load; only a state of the full contact stiffness is returned.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import UnstableError
from unitcell3d.model.crossover import YarnsModel
from unitcell3d.solver.newton import ROUGH, Equilibrium, Newton

SOFTENINGS = (0.01, 0.05, 0.2, 0.5, 1.0)  # of the penalty, stage after stage


@dataclass(frozen=True)
class Steps:
    """How a path is stepped.

    Parameters
    ----------
    first, largest, least : [-] shares of a leg
    easy_iterations : factorisations up to which the next step may grow
    close : [-] how far beyond the 1 of a quantity that ends the path its last state may lie
    """

    first: float = 0.10
    largest: float = 0.10
    least: float = 1e-3
    easy_iterations: int = 12
    close: float = 2e-3


def advance(
    model: YarnsModel,
    solver: Newton,
    states: Sequence[tuple[float, FloatArray]],
    start: Any,
    end: Any,
    share: float,
    last_resort: bool,
) -> Equilibrium:
    """Find the equilibrium at `share` of the leg from `start` to `end`, from the guess that leaves
    the least residual there.

    Parameters
    ----------
    states : (share, unknowns) of the last one or two states of this leg
    last_resort : soften the contact if nothing else finds it

    Raises
    ------
    UnstableError : none is found
    """
    load = start.towards(end, share)
    here, held = states[-1]
    guesses = [held, solver.linear_guess(held, start.towards(end, here), load)]
    if len(states) > 1:
        before, q = states[0]
        guesses.append(held + (share - here) / (here - before) * (held - q))
    best = solver.best([guess for guess in guesses if guess is not None], load)
    try:
        return solver.approach(best, load)
    except UnstableError:
        if best is held and not last_resort:
            raise
    if not last_resort:
        return solver.approach(held, load)
    return _penalty_continuation(model, solver, held, load)


def continue_to(
    model: YarnsModel, solver: Newton, q: FloatArray, start: Any, end: Any, shares: Iterable[float]
) -> Iterator[tuple[float, Equilibrium]]:
    """Yield equilibria (share, Equilibrium) at given shares of a straight leg, from a state on it.

    Parameters
    ----------
    solver : newton.Newton
    q : (size,) unknowns in equilibrium at `start`
    shares : rising, from 0 on

    Raises
    ------
    UnstableError : no equilibrium even in the least step, with contact softened
    """
    states = [(0.0, q)]
    least = Steps().least
    for share in shares:
        step = share - states[-1][0]
        while True:
            at = states[-1][0]
            goal = min(at + step, share)
            try:
                found = advance(model, solver, states, start, end, goal, step <= least)
            except UnstableError:
                if step <= least:
                    raise
                step = max(0.5 * step, least)
                continue
            states = [states[-1], (goal, found.q)] if goal > at else [(goal, found.q)]
            if goal == share:
                break
        yield share, found


def rest_state(model: YarnsModel, solver: Newton, load: Any) -> Equilibrium:
    """Find the equilibrium of the undeformed crossover, whose sections may overlap by what the mesh
    leaves of their curves.

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
    """Equilibrium by penalty continuation: softer contacts first."""
    full = model.numerics
    try:
        for factor in SOFTENINGS:
            model.numerics = full.softened(factor)
            found = solver.solve(guess, load)
            guess = found.q
        return found
    finally:
        model.numerics = full
