"""Equilibrium at one load: Newton's method with a line search on the residual.

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
MAX_ITERATIONS = 25
SEARCH = (1.0, 0.5, 0.25, 0.1, 0.03, 0.01)


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
        state = self._evaluate(q, load)
        if not np.isfinite(state.norm):
            self._refuse("the first guess", q, load)
        for iteration in range(MAX_ITERATIONS):
            if state.norm <= TOLERANCE * state.scale:
                return Equilibrium(state.q, state.forces, state.contact, state.plates, iteration)
            step = self._step(state, load)
            if step is None:
                self._refuse("a singular tangent", state.q, load)
            state = self._search(state, step, load)
            if state is None:
                self._refuse(f"a stalled line search in iteration {iteration + 1}", q, load)
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

    def _step(self, state, load):
        model = self.model
        if model.system(state.q, load) or self._solver is None:
            self.close()
            pattern = model.pattern
            self._solver = DirectSolver(pattern.starts, pattern.columns, pattern.entries)
        self._solver.factor()
        return self._solver.solve(-state.residual)

    def _search(self, state, step, load):
        """The first trial that lowers the residual, else None."""
        for share in SEARCH:
            trial = self._evaluate(state.q + share * step, load)
            if trial.norm < (1 - 1e-3 * share) * state.norm:  # False for NaN
                return trial
            if trial.norm <= TOLERANCE * trial.scale:
                return trial
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
