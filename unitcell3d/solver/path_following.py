"""Following a path of loads from rest, with a row for each converged state, and the failure of
fibres on the way.

A path is a chain of straight legs, so it may turn round and come back. Its steps adapt, or lead to
equal shares of each leg; one that finds no equilibrium is halved. Where a quantity that is watched
(the worst fibre's strain over its failure strain, or what ends the path) passes 1 inside a step,
the step is taken again up to where the secant says that it passes. Where a state overstrains
fibres, their damage is raised, those first that are overstrained by more than half as much as the
worst, and the equilibrium at the same load is sought again, until no more fail: what they held is
handed on to their neighbours, or lost, at one load.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from unitcell3d.model.crossover import YarnsModel
from unitcell3d.solver.load_stepping import Steps, advance, continue_to, rest_state
from unitcell3d.solver.newton import Equilibrium, Newton
from unitcell3d.solver.recorded import record

# called as hook(share of the path, row) after each step
Hook: TypeAlias = Callable[[float, dict[str, Any]], object]
CLOSE = 5e-4  # to the 1 of a watched quantity, on paths of given rows
MOST_TRIALS = 12  # of a step that passes it
SHORTEST = 1e-6  # of a leg, of such a step
MOST_ROUNDS = 400  # of failing at one load


def follow(
    model: YarnsModel,
    corners: Sequence[Any],
    row: Callable[[Equilibrium, Any], dict[str, Any]],
    *,
    steps: Steps | None = None,
    rows: int | Sequence[int] | None = None,
    stop: Callable[[dict], float] | None = None,
    facts: Mapping[str, Any] | None = None,
    hooks: Sequence[Hook] = (),
) -> Record:
    """Follow a path from rest.

    Parameters
    ----------
    model : model.crossover.YarnsModel
    corners : loads, the first of them at rest
    row : function (state, load) giving a dict, whose keys are names of `recorded.MEANINGS`
    steps : load_stepping.Steps, of each leg, if no rows are given
    rows : of the whole path, at least; each leg has an equal share of them, or a sequence, one
        number a leg
    stop : function (row) giving a number that reaches 1 where the path is to end; that state is
        solved for
    facts : of the record, besides the fabric
    hooks : called after each step

    Returns
    ------- Record, whose `failed` says why the path ended early if it did, and whose `last` has the
    displacements u and, of one crossing, the gaps of the nodes of both contact faces

    Raises
    ------
    InputError : fewer than two loads
    UnstableError : no equilibrium at rest
    """
    if len(corners) < 2:
        raise InputError(key="loads", value=len(corners), allowed="at least two, the first at rest")
    steps = steps or Steps()
    legs = len(corners) - 1
    counts: list[int] = []
    if isinstance(rows, int):
        counts = [max(1, -(-rows // legs))] * legs
    elif rows is not None:
        counts = list(rows)
    if counts:
        steps = replace(steps, close=CLOSE)
    solver = Newton(model)
    try:
        walk = _Walk(model, solver, row, steps, stop, hooks)
        failed = walk.along(corners, counts)
    finally:
        solver.close()
    facts = {"fabric": model.fabric.name, **(facts or {})}
    return record(walk.rows, facts, walk.last(), failed)


class _Walk:
    """A path on its way: the last state with its load, and the rows so far."""

    def __init__(self, model, solver, row, steps, stop, hooks):
        self._model = model
        self._solver = solver
        self._row = row
        self._stop = stop
        self._hooks = hooks
        self._steps = steps
        self._met_overload = False
        self.rows = []

    def along(self, corners, counts):
        """Walk from rest to the last corner; returns why the path ended before, or ""."""
        self._begun = time.perf_counter()
        self._load = corners[0]
        self._state = rest_state(self._model, self._solver, self._load)
        self._model.commit(self._state.q, self._load)
        self._keep(self._measure(self._state, self._load, 0.0))
        weights = counts or [1] * (len(corners) - 1)
        done = 0
        try:
            for start, end, weight in zip(corners, corners[1:], weights):
                part = (done / sum(weights), weight / sum(weights))
                if self._leg(start, end, weight if counts else None, part):
                    break
                done += weight
        except UnstableError as problem:
            return str(problem)
        return ""

    def _leg(self, start, end, count, part):
        """Walk one leg, in `count` equal steps or in steps that adapt; returns whether the path has
        come to its end.

        part : (share of the path before this leg, share of this leg)
        """
        steps = self._steps
        states = [(0.0, self._state.q)]
        step = steps.first if count is None else 1.0
        trials = 0
        shortened = False
        while states[-1][0] < 1:
            at = states[-1][0]
            target = 1.0 if count is None else (np.floor(at * count + 1e-9) + 1) / count
            step = min(step, target - at)
            goal = min(at + step, target)
            if target - goal < 0.1 * step and not shortened:
                goal = target  # no sliver of a step at the end
            load = start.towards(end, goal)
            try:
                found = advance(
                    self._model, self._solver, states, start, end, goal, step <= steps.least
                )
            except UnstableError:
                if step <= steps.least:
                    raise
                step = max(0.5 * step, steps.least)
                continue
            row = self._measure(found, load, part[0] + part[1] * goal)
            levels = self._levels(found, load, row)
            if max(levels, default=0.0) > 1 + steps.close and trials < MOST_TRIALS:
                step = max(self._length_to_pass(goal - at, levels), SHORTEST)
                trials += 1
                shortened = True
                continue
            trials = 0
            states = [states[-1], (goal, found.q)]
            if self._accept(found, load, row):
                states = [(goal, self._state.q)]
            if self._stop is not None and self._stop(self.rows[-1]) >= 1 - steps.close:
                return True
            if count is None and found.iterations <= steps.easy_iterations:
                step = min(1.5 * step, steps.largest)
            elif count is not None and goal == target:
                step = 1.0
        return False

    def _measure(self, state, load, share):
        """The row of a state."""
        seconds = time.perf_counter() - self._begun
        spent = {"iterations": state.iterations, "seconds": seconds}
        return {"path": share, **self._row(state, load), **spent}

    def _levels(self, state, load, row):
        """Quantities whose passing of 1 is located: the fibres' overload until it is first met, and
        the end."""
        levels = []
        if not self._met_overload:
            levels.append(self._overload(state, load))
        if self._stop is not None:
            levels.append(self._stop(row))
        return levels

    def _overload(self, state, load):
        strains, _ = self._model.fibre_strains(self._model.positions(state.q, load))
        return self._model.fibres.overload(strains)

    def _length_to_pass(self, length, levels):
        """Length of the step that brings the first of the watched quantities to 1, by the
        secant."""
        before = self._levels(self._state, self._load, self.rows[-1])
        return min(
            length * (1 - low) / (high - low)
            for low, high in zip(before, levels)
            if high > 1 + self._steps.close
        )

    def _accept(self, state, load, row):
        """Take a state up as the last one; returns whether fibres have failed in it."""
        if not self._met_overload and self._overload(state, load) >= 1 - self._steps.close:
            self._met_overload = True
        settled = self._fail(state, load)
        if settled is not state:
            row = self._measure(settled, load, row["path"])
        self._model.commit(settled.q, load)
        self._state = settled
        self._load = load
        self._keep(row)
        for hook in self._hooks:
            hook(row["path"], row)
        return settled is not state

    def _fail(self, state, load):
        """Damage the fibres that the state overstrains until equilibrium overstrains no more."""
        for _ in range(MOST_ROUNDS):
            if not self._model.fibres.fail(self._model.positions(state.q, load)):
                return state
            _, found = next(continue_to(self._model, self._solver, state.q, load, load, [1.0]))
            state = replace(found, iterations=state.iterations + found.iterations)
        raise UnstableError("fibres go on failing at one load", when=str(load))

    def _keep(self, row):
        self.rows.append(row)
        self._begun = time.perf_counter()

    def last(self):
        """Displacements (n, 3) [m] of the last state, and the gaps [m] of the faces of a single
        crossing."""
        model = self._model
        q = self._state.q
        load = self._load
        model.forces(q, load)  # the gaps belong to the last state, not to the last trial
        u = model.constraints.displacement(q, load.drive)
        last = {"u": u[: len(model.crossover.points)]}
        if len(model.surfaces.gaps) == 2:
            last |= dict(zip(("gaps_warp", "gaps_weft"), model.surfaces.gaps))
        return last
