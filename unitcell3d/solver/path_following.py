"""Following a path of loads with a row at each state that is requested, and the failure of fibres on the way.

A path is a chain of straight legs, so it may turn round and come back. Where a quantity that is watched (the worst
fibre's strain over its failure strain, or what ends the path) first passes 1 inside a step, the state at 1 is found by
the secant and gets a row of its own. Where a state overstrains fibres, their damage is raised, those first that are
overstrained by more than half as much as the worst, and the equilibrium at the same load is sought again, until no
more fail: what they held is handed on to their neighbours, or lost, at one load.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.errors import InputError, UnstableError
from unitcell3d.model.crossover import YarnsModel
from unitcell3d.solver.load_stepping import Hook, continue_to, rest_state
from unitcell3d.solver.newton import Equilibrium, Newton

CLOSE = 5e-4  # to the 1 of a watched quantity
MOST_TRIALS = 12  # of a secant
MOST_ROUNDS = 400  # of failing at one load


@dataclass(frozen=True)
class Followed:
    """rows : list of dicts; x : (n, 3) [m] positions of the last state; q : its unknowns; failed : why it ended."""

    rows: list
    x: np.ndarray
    q: np.ndarray
    failed: str


def follow(
    model: YarnsModel,
    loads: Sequence[Any],
    row: Callable[[Equilibrium, Any], dict[str, Any]],
    *,
    rows: int | Sequence[int] = 25,
    stop: Callable[[dict], float] | None = None,
    hooks: Sequence[Hook] = (),
) -> Followed:
    """Follow a path from rest.

    Parameters
    ----------
    model : model.crossover.YarnsModel
    loads : corners of the path, the first of them at rest
    row : function (state, load) giving a dict
    rows : of the whole path, at least; a leg has its share of them by its number alone, or a sequence, one per leg
    stop : function (row) giving a number that reaches 1 where the path is to end
    hooks : called as hook(share of the path, row) after each row

    Raises
    ------
    InputError : fewer than two loads
    """
    if len(loads) < 2:
        raise InputError(key="loads", value=len(loads), allowed="at least two, the first at rest")
    legs = len(loads) - 1
    counts = list(rows) if isinstance(rows, Sequence) else [max(1, -(-rows // legs))] * legs
    solver = Newton(model)
    try:
        return _Walk(model, solver, row, stop, hooks).along(loads, counts)
    finally:
        solver.close()


class _Walk:
    def __init__(self, model, solver, row, stop, hooks):
        self.model, self.solver, self._row, self._stop, self._hooks = (
            model,
            solver,
            row,
            stop,
            hooks,
        )
        self.rows, self.ended, self._met_overload = [], False, False

    def along(self, loads, counts):
        begun = time.perf_counter()
        rest, load, failed = rest_state(self.model, self.solver, loads[0]), loads[0], ""
        state = rest
        self._keep(state, load, 0.0, begun)
        done, total = 0, sum(counts)
        try:
            for start, end, count in zip(loads, loads[1:], counts):
                for share, state, load in self._leg(state, start, end, count):  # noqa: B020
                    self._keep(state, load, (done + share * count) / total, begun)
                    begun = time.perf_counter()
                    if self.ended:
                        return self._result(state, load, "")
                done += count
        except UnstableError as problem:
            failed = str(problem)
        return self._result(state, load, failed)

    def _leg(self, state, start, end, count):
        """Yields (share of the leg, state, load) from the state at its start."""
        at, shares = 0.0, list(np.arange(1, count + 1) / count)
        while shares:
            here = start.towards(end, at)
            for inner in continue_to(
                self.model, self.solver, state.q, here, end, [(s - at) / (1 - at) for s in shares]
            ):
                before, state = state, inner[1]
                share = shares.pop(0)
                load = start.towards(end, share)
                located = self._locate(before, at, state, share, start, end)
                if located is not None:
                    shares.insert(0, share)
                    share, state = located
                    load = start.towards(end, share)
                broken, state = self._fail(state, load)
                yield share, state, load
                if self.ended:
                    return
                at = share
                if broken or located is not None:
                    break

    def _watched(self, state, load):
        """Quantities whose passing of 1 is located: the fibres' overload until it is first met, and the end."""
        watched = []
        if not self._met_overload:
            watched.append(
                self.model.fibres.overload(
                    self.model.fibre_strains(self.model.positions(state.q, load))[0]
                )
            )
        if self._stop is not None:
            watched.append(self._stop(self._row(state, load)))
        return np.array(watched)

    def _locate(self, before, at, state, share, start, end):
        """(share, state) where a watched quantity is 1, if it passes 1 between two states by more than `CLOSE`."""
        low, high = (
            self._watched(s, start.towards(end, where))
            for s, where in ((before, at), (state, share))
        )
        if not high.size or high.max() < 1 - CLOSE:
            return None
        found, first, last = (share, state), (at, before, low), (share, high)
        for _ in range(MOST_TRIALS):
            if last[1].max() <= 1 + CLOSE:
                break
            crossing = last[1] > 1 + CLOSE
            parts = (1 - first[2][crossing]) / (last[1][crossing] - first[2][crossing])
            trial = first[0] + np.clip(parts.min(), 0.02, 0.98) * (last[0] - first[0])
            here = start.towards(end, first[0])
            _, inner = next(
                continue_to(
                    self.model, self.solver, first[1].q, here, start.towards(end, trial), [1.0]
                )
            )
            values = self._watched(inner, start.towards(end, trial))
            if values.max() < 1 - CLOSE:
                first = (trial, inner, values)
            else:
                found, last = (trial, inner), (trial, values)
        self.ended = self._stop is not None and last[1][-1] >= 1 - CLOSE
        if not self._met_overload and last[1][0] >= 1 - CLOSE:
            self._met_overload = True
        return found if found[0] < share else None

    def _fail(self, state, load):
        """Damage the fibres that the state overstrains until equilibrium overstrains no more."""
        broken = False
        for _ in range(MOST_ROUNDS):
            if not self.model.fibres.fail(self.model.positions(state.q, load)):
                return broken, state
            broken = True
            _, state = next(continue_to(self.model, self.solver, state.q, load, load, [1.0]))
        raise UnstableError("fibres go on failing at one load", when=str(load))

    def _keep(self, state, load, share, begun):
        self.model.commit(state.q, load)
        row = self._row(state, load)
        row |= {
            "path": share,
            "iterations": state.iterations,
            "seconds": time.perf_counter() - begun,
        }
        self.rows.append(row)
        for hook in self._hooks:
            hook(share, row)

    def _result(self, state, load, failed):
        model = self.model
        model.forces(state.q, load)  # the gaps belong to the last state, not to the last trial
        return Followed(self.rows, model.positions(state.q, load), state.q, failed)
