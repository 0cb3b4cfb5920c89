"""Equilibrium at one load: Newton's method in pseudo-time, with Broyden's updates between factorisations.

    (K + mu I) dq = -r,   mu <- mu |r_new| / |r_old|

Slack fibres leave soft modes (below 1 N/m against 1e5 N/m of the contact), which the shift mu (backward Euler
in a pseudo-time, Kelley and Keyes 1998) holds while the stiff ones settle: it dies out with the residual. No
node moves by more than `LARGEST_STEP` in one iteration. A step is shortened where it overshoots.

Converged when |r| <= 1e-8 of the largest of the forces that hold the crossover together (end tensions,
contact, plates), each taken on the meshed part: without tension the plate force is the measure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from fabrics.base.errors import UnstableError
from unitcell3d.assembly.linear_solver import DirectSolver
from unitcell3d.model.crossover import YarnsModel

TOLERANCE = 1e-8
# N: scale of the convergence test where nothing is loaded yet
LEAST_FORCE = 1e-2
MAX_ITERATIONS = 40  # factorisations
LARGEST_STEP = 5e-6  # m
# of the forces: residual from which the shift starts at its full size, and the contact soft
FAR = 0.1
SOFTER = 0.2  # factor of the penalty on the way from a guess that is far away
ROUGH = 1e-2  # of the forces: how far the softer contact is followed
# N/m at the first iteration; 30 to 1000 take the same number of iterations within a tenth
SHIFT = 300.0
MOST_SHIFT = 1e5  # N/m: as stiff as the contact
LEAST_SHIFT = 1e-3  # N/m: none below
NEAR = 1e-2  # of the forces; 1e-3 to 1e-2 take the same time within a tenth
SLOW = 0.8  # thirty steps at this rate do what one good Newton step does
# such steps, or steps that let the residual grow: at a slack kink it does before it falls
MOST_SLOW = 2
LINE = 5  # evaluations along a step that overshoots
# share of the pull at the start of a step that may be left at its end
OVERSHOT = 0.5
GROWTH = 2.0  # of the residual in a step with an old factorisation
MOST_UPDATES = 20


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A state of the meshed part, in equilibrium when `Newton.solve` returns it.

    Parameters
    ----------
    q, residual : (size,) unknowns [m], forces on them [N]
    forces : (n, 3) [N] at the nodes
    contact, plates : [N] contact force, (2,) [N] forces of the plates
    norm, scale : [N] of the residual, and largest of the forces that it is compared with
    iterations : tangents that were factorised on the way
    """

    q: FloatArray
    forces: FloatArray
    residual: FloatArray
    contact: float
    plates: FloatArray
    norm: float
    scale: float
    iterations: int = 0

    def within(self, tolerance: float) -> bool:
        """Tell whether the residual is at most `tolerance` times the forces."""
        return self.norm <= tolerance * self.scale


class Newton:
    """Solves one model's equilibrium; keeps its linear solver and last factorisation from one load
    to the next.

    A plain Newton step throws nodes of slack yarns by a tenth of a millimetre, and a line search
    that insists on a falling residual stalls, because the residual is that of the stiff contact.
    Where a step is cut to the largest the shift grows by as much. Where a guess is far from
    equilibrium the contact is soft at first (`approach`).

    A step overshoots where the residual's pull along it has turned round, r(q + dq) . dq > -1/2 r .
    dq, and is shortened to where that has gone (false position and bisection in turn). The law is
    all but a potential (its tangent is unsymmetric by 4e-4 at most), so that this is nearly the
    least energy on the line: a residual that grows on the way, as where yarns swing taut, does not
    stop it. Fibres at their slack kink and contact that closes otherwise send
    Newton's method round in cycles. The shift grows with the inverse root of the rest of a step.

    A factorisation costs as much as thirty back substitutions. Once the residual is below `NEAR` of
    the forces, the last one is used on and corrected by the steps since (Kelley, Iterative Methods
    for Linear and Nonlinear Equations, 1995, section 7.3), until `MOST_SLOW` steps have taken off
    less than 1 - `SLOW` of the residual. The state that is found is the same.

    Parameters
    ----------
    model : model.crossover.CrossoverModel
    """

    def __init__(self, model: YarnsModel) -> None:
        self.model = model
        self._solver: DirectSolver | None = None
        self._taken: list[FloatArray] = []  # steps since the last factorisation
        # the state that the model's contact search belongs to
        self._latest = None

    def solve(self, q: FloatArray, load: Any, tolerance: float = TOLERANCE) -> Equilibrium:
        """Solve for the equilibrium at `load` from the guess `q` : (size,), to a residual of
        `tolerance` times the forces.

        Raises
        ------
        UnstableError : no convergence, a singular tangent, or an element that inverts
        """
        state = self._evaluate(q, load)
        if not np.isfinite(state.norm):
            self._refuse("the first guess", q, load)
        shift = SHIFT * min(1.0, state.norm / state.scale / FAR)
        iterations = 0
        self._taken = []
        while True:
            before = state.norm
            if state.norm < NEAR * state.scale and self._solver is not None:
                state = self._reuse(state, load, tolerance)
            if state.within(tolerance):
                # what the model's contact has found belongs to the state that is returned
                state = self._at(state, load)
                return replace(state, iterations=iterations)
            if iterations == MAX_ITERATIONS:
                self._refuse(f"no convergence in {MAX_ITERATIONS} iterations", state.q, load)
            step = self._factor(state, load, shift).solve(-state.residual)
            iterations += 1
            if step is None:
                self._refuse("a singular tangent", state.q, load)
            found, share = self._move(state, step, load)
            if found is None:
                self._refuse("forces that are not finite", state.q + step, load)
            cut = LARGEST_STEP / abs(step).max()
            if cut < 1:
                shift = min(shift / cut, MOST_SHIFT)
            elif share < 1:
                shift = min(shift / share**0.5, MOST_SHIFT)
            else:
                shift = _next_shift(shift, found.norm / before)
            state = found

    def approach(self, q: FloatArray, load: Any, tolerance: float = TOLERANCE) -> Equilibrium:
        """Approach the equilibrium at `load` from a guess that may be far from it: by way of a
        softer contact, taken roughly; `tolerance` as of `solve`.

        Slack yarns that a guess presses into each other are thrown apart by the full contact and
        come back to it several times over.

        Raises
        ------
        UnstableError : as `solve`
        """
        full = self.model.numerics
        spent = 0
        if not self._evaluate(q, load).within(FAR):
            try:
                self.model.numerics = full.softened(SOFTER)
                found = self.solve(q, load, ROUGH)
                q = found.q
                spent = found.iterations
            finally:
                self.model.numerics = full
        found = self.solve(q, load, tolerance)
        return replace(found, iterations=found.iterations + spent)

    def best(self, guesses: Sequence[FloatArray], load: Any) -> FloatArray:
        """Choose the guess : (size,) that leaves the least residual at `load`."""
        norms = np.array([self._evaluate(q, load).norm for q in guesses])
        return guesses[int(np.argmin(np.where(np.isfinite(norms), norms, np.inf)))]

    def linear_guess(self, q: FloatArray, before: Any, load: Any) -> FloatArray | None:
        """Guess the unknowns at `load` from those `q` in equilibrium at `before`, by the last
        factorisation; None without one.

        The load's part of the tangent is a difference over a thousandth of the load's step.
        """
        if self._solver is None:
            return None
        part = 1e-3
        rest, moved = (
            self._evaluate(q, at).residual for at in (before, before.towards(load, part))
        )
        step = self._solver.solve((rest - moved) / part)
        if step is None:
            return None
        return q + step

    def linear_changes(
        self, q: FloatArray, load: Any, residuals: Sequence[FloatArray]
    ) -> list[FloatArray]:
        """Compute the changes (size,) of the unknowns that undo small residuals (size,) about the
        equilibrium `q` at `load`.

        Raises
        ------
        UnstableError : a singular tangent
        """
        solver = self._factor(self._evaluate(q, load), load, 0.0)
        changes = [solver.solve(-residual) for residual in residuals]
        if any(change is None for change in changes):
            self._refuse("a singular tangent", q, load)
        return [change for change in changes if change is not None]

    def close(self) -> None:
        """Give the factorisation back."""
        if self._solver is not None:
            self._solver.close()
            self._solver = None
        self._taken = []

    def _evaluate(self, q, load):
        model = self.model
        forces, contact, plates = model.forces(q, load)
        residual = model.constraints.reduce(forces)
        norm = float(sums.norm(residual))
        ends = [abs(model.constraints.end_force(forces, yarn)) for yarn in (0, 1)]
        scale = max(*ends, abs(contact), *plates, LEAST_FORCE)
        self._latest = Equilibrium(q, forces, residual, contact, plates, norm, scale)
        return self._latest

    def _at(self, state, load):
        """The state, evaluated again unless it was the last one that was."""
        if state is self._latest:
            return state
        return self._evaluate(state.q, load)

    def _factor(self, state, load, shift):
        model = self.model
        self._at(state, load)  # the tangent is laid out for the contact met last
        if model.system(state.q, load) or self._solver is None:
            self.close()
            pattern = model.pattern
            self._solver = DirectSolver(pattern.starts, pattern.columns, pattern.entries)
        model.pattern.entries[model.pattern.diagonal] += shift
        self._solver.factor()
        self._taken = []
        return self._solver

    def _reuse(self, state, load, tolerance):
        """The best state that steps with the last factorisation and Broyden's updates reach from
        `state`."""
        best = state
        slow = 0
        while len(self._taken) < MOST_UPDATES and not best.within(tolerance):
            step = self._solver.solve(-state.residual)
            if step is not None:
                step = _corrected(step, self._taken)
            if step is None or abs(step).max() > LARGEST_STEP:
                break
            found = self._evaluate(state.q + step, load)
            if not found.norm < GROWTH * state.norm:
                break
            self._taken.append(step)
            if found.norm < best.norm:
                best = found
            slow += found.norm > SLOW * state.norm
            state = found
            if slow > MOST_SLOW:
                break
        return best

    def _move(self, state, step, load):
        """The state after a step, shortened to the largest allowed, while an element inverts, and
        if it overshoots.

        Returns
        -------
        state : None where none is finite
        share : of the step that an overshoot has left
        """
        share = min(1.0, LARGEST_STEP / abs(step).max())
        for _ in range(5):
            found = self._evaluate(state.q + share * step, load)
            if np.isfinite(found.norm):
                break
            share *= 0.3
        else:
            return None, share
        left, kept = self._along(state, share * step, found, load)
        if share == kept == 1 and found.norm < state.norm:
            self._taken = [step]
        return left, kept

    def _along(self, state, step, found, load):
        """The state on the way from `state` to `found`, a `step` further, where the pull along it
        is gone; its share.

        `found` itself where the pull has not turned round by much, or where the step went uphill.
        """
        pull = -sums.dot(state.residual, step)
        end = sums.dot(found.residual, step)
        if pull <= 0 or end <= OVERSHOT * pull:
            return found, 1.0
        low = (0.0, -pull)
        high = (1.0, end)
        share = 1.0
        for turn in range(LINE):
            # every other time in the middle: false position alone creeps up to a kink
            part = 0.5 if turn % 2 else np.clip(low[1] / (low[1] - high[1]), 0.1, 0.9)
            at = low[0] + (high[0] - low[0]) * part
            trial = self._evaluate(state.q + at * step, load)
            there = np.inf
            if np.isfinite(trial.norm):
                found = trial
                share = at
                there = sums.dot(trial.residual, step)
            if there > 0:
                high = (at, there)
            else:
                low = (at, there)
            if abs(there) <= OVERSHOT * pull:
                break
        return found, share

    def _refuse(self, what, q, load):
        x = self.model.positions(q, load)
        cell, ratio = self.model.worst_element(x)
        mesh = self.model.crossover
        yarn = mesh.names[mesh.yarn[cell]]
        inverted = ""
        if ratio <= 0:
            inverted = ", inverted"
        when = f"d1 = {load.d[0] * 1e3:.5g} mm, d2 = {load.d[1] * 1e3:.5g} mm"
        if np.isfinite(load.plates):
            when += f", plates {2e3 * load.plates:.5g} mm apart"
        raise UnstableError(
            f"the {self.model.called} found no equilibrium: {what}",
            where=f"{yarn} element {cell} (least volume ratio {ratio:.3g}{inverted})",
            when=when,
        )


def _next_shift(shift, ratio):
    """The shift after the residual has changed by `ratio`."""
    shift = min(shift * np.clip(ratio, 0.05, 2.0), 30 * SHIFT)
    return shift if shift > LEAST_SHIFT else 0.0


def _corrected(step, taken):
    """Broyden's step from the step of the factorised tangent and those `taken` since; None where it
    is singular."""
    for before, after in pairwise(taken):
        step = step + after * sums.dot(before, step) / sums.dot(before, before)
    if taken:
        last = taken[-1]
        share = 1 - sums.dot(last, step) / sums.dot(last, last)
        if abs(share) < 0.1:
            return None
        step = step / share
    return step
