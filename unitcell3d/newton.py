"""Equilibrium at one load: Newton's method in pseudo-time.

    (K + mu I) dq = -r,   mu <- mu |r_new| / |r_old|

Slack fibres leave soft modes (below 1 N/m against 1e5 N/m of the contact): the tip of a slack yarn buckles and snaps. A
plain Newton step then throws nodes by a tenth of a millimetre, and a line search that insists on a falling residual
stalls, because the residual is that of the stiff contact. The shift mu (backward Euler in a pseudo-time, Kelley and
Keyes 1998) holds the soft modes while the stiff ones settle and dies out with the residual, so the last iterations are
quadratic; no node moves by more than `LARGEST_STEP` in one iteration.

Converged when |r| <= 1e-8 of the largest of the forces that hold the crossover together (end tensions, contact,
plates), each taken on the meshed part: without tension the plate force is the measure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.errors import UnstableError
from unitcell3d.linear import DirectSolver

TOLERANCE = 1e-8
LEAST_FORCE = 1e-2  # N: scale of the convergence test where nothing is loaded yet
MAX_ITERATIONS = 40
LARGEST_STEP = 5e-6  # m
SHIFT = 300.0  # N/m at the first iteration; 30 to 1000 take the same number of iterations within a tenth
LEAST_SHIFT = 1e-3  # N/m: none below


@dataclass(frozen=True)
class Equilibrium:
    """A converged state: unknowns `q`, nodal forces, contact force and plate forces [N] of the meshed part."""

    q: np.ndarray
    forces: np.ndarray
    contact: float
    plates: np.ndarray
    iterations: int


class Newton:
    """Solves one model's equilibrium; keeps its linear solver from one load to the next."""

    def __init__(self, model):
        self.model = model
        self._solver = None

    def solve(self, q, load):
        """Equilibrium at `load` from the guess `q` : (size,).

        Raises
        ------
        UnstableError : no convergence, a singular tangent, or an element that inverts
        """
        state, shift = self._evaluate(q, load), SHIFT
        if not np.isfinite(state.norm):
            self._refuse("the first guess", q, load)
        for iteration in range(MAX_ITERATIONS):
            if state.norm <= TOLERANCE * state.scale:
                return Equilibrium(state.q, state.forces, state.contact, state.plates, iteration)
            step = self._step(state, load, shift)
            if step is None:
                self._refuse("a singular tangent", state.q, load)
            found = self._move(state, step, load)
            if found is None:
                self._refuse("forces that are not finite", state.q + step, load)
            shift = min(shift * np.clip(found.norm / state.norm, 0.05, 2.0), 30 * SHIFT)
            shift = shift if shift > LEAST_SHIFT else 0.0
            state = found
        self._refuse(f"no convergence in {MAX_ITERATIONS} iterations", state.q, load)

    def close(self):
        """Give the factorisation back."""
        if self._solver is not None:
            self._solver.close()
            self._solver = None

    def _evaluate(self, q, load):
        model = self.model
        forces, contact, plates = model.forces(q, load)
        residual = model.constraints.reduce(forces)
        norm = np.linalg.norm(residual)
        ends = [abs(model.constraints.end_force(forces, yarn)) for yarn in (0, 1)]
        return _State(q, forces, residual, contact, plates, norm, max(*ends, abs(contact), *plates, LEAST_FORCE))

    def _step(self, state, load, shift):
        model = self.model
        if model.system(state.q, load) or self._solver is None:
            self.close()
            pattern = model.pattern
            self._solver = DirectSolver(pattern.starts, pattern.columns, pattern.entries)
        model.pattern.entries[model.pattern.diagonal] += shift
        self._solver.factor()
        return self._solver.solve(-state.residual)

    def _move(self, state, step, load):
        """The state after the step, shortened to the largest allowed, and further while an element inverts."""
        share = min(1.0, LARGEST_STEP / np.abs(step).max())
        for _ in range(5):
            found = self._evaluate(state.q + share * step, load)
            if np.isfinite(found.norm):
                return found
            share *= 0.3
        return None

    def _refuse(self, what, q, load):
        x = self.model.positions(q, load)
        cell, ratio = self.model.worst_element(x)
        yarn = "warp" if self.model.crossover.yarn[cell] == 0 else "weft"
        inverted = ", inverted" if ratio <= 0 else ""
        raise UnstableError(
            f"the crossover found no equilibrium: {what}",
            where=f"{yarn} element {cell} (least volume ratio {ratio:.3g}{inverted})",
            when=f"d1 = {load.d[0] * 1e3:.5g} mm, d2 = {load.d[1] * 1e3:.5g} mm"
            + (f", plates {2e3 * load.plates:.5g} mm apart" if np.isfinite(load.plates) else ""),
        )


@dataclass(frozen=True)
class _State:
    q: np.ndarray
    forces: np.ndarray
    residual: np.ndarray
    contact: float
    plates: np.ndarray
    norm: float
    scale: float
