"""One line of a response surface: a path of continuation at a fixed end displacement of one yarn.

Each line is a case of its own, with a model of its own, so that it comes out the same to the last
bit whichever process solves it, and when. With friction an equilibrium depends on where the yarns
stuck before: a line then takes that over from the state it starts from, and goes on from every
place it has come to.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from fabrics.fabric import Fabric
from meshing import crossover as mesher
from meshing.inputs import Size
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Newton

# share of the way from rest to the first place of a line in one step
FROM_REST = 0.02


@dataclass(frozen=True)
class Line:
    """A solved line of the grid.

    Parameters
    ----------
    along : (n,) [m] places
    values : (n, 5) T1, T2, F_c [N], h1, h2 [m]
    states : (n, size) unknowns [m], or (0, 0) where no other line starts from this one
    stick_state : (n, s) where the points of contact stick with friction, or (0, 0) like the states
    seconds : [s] wall time
    iterations : tangents factorised
    """

    along: np.ndarray
    values: np.ndarray
    states: np.ndarray
    stick_state: np.ndarray
    seconds: float
    iterations: int


@dataclass(frozen=True)
class Case:
    """A line to be solved, along `axis` (0: d1, 1: d2) at `fixed` of the other [m], at the places
    `along` [m].

    start : (d1, d2) [m] on the edge, where the line begins; None: at rest
    q, stick_state : (size,) [m] unknowns, and (s,) where the points of contact stick
        (`model.crossover.YarnsModel.stick_state`), in the equilibrium at `start`
    keep : whether other lines will start from its states
    friction : [-] Coulomb's coefficient
    """

    axis: int
    fixed: float
    along: np.ndarray
    start: tuple | None = None
    q: np.ndarray | None = None
    stick_state: np.ndarray | None = None
    keep: bool = False
    friction: float = 0.0

    @property
    def name(self) -> str:
        """Name of the line."""
        return f"d{2 - self.axis} = {1e6 * self.fixed:.6f} um"

    def at(self, place: float) -> tuple[float, float]:
        """Return the end displacements (d1, d2) [m] of a place on the line."""
        place = float(place)
        fixed = float(self.fixed)
        if self.axis == 0:
            return place, fixed
        return fixed, place


def solve_line(fabric: Fabric, size: Size, case: Case) -> Line:
    """Solve one line.

    Raises
    ------
    UnstableError : no equilibrium at a place
    """
    begun = time.perf_counter()
    model = CrossoverModel(
        mesher.build(fabric, size=size), fabric, Numerics(friction=case.friction)
    )
    solver = Newton(model)
    values = []
    states = []
    stick_states = []
    iterations = 0
    try:
        q, spent = _begin(model, solver, case)
        first, last = (Load(case.at(case.along[i])) for i in (0, -1))
        shares = (case.along - case.along[0]) / (case.along[-1] - case.along[0])
        for share, found in continue_to(model, solver, q, first, last, shares):
            iterations += found.iterations
            model.commit(found.q, first.towards(last, share))
            heights = model.heights(model.positions(found.q, first.towards(last, share)))
            T1, T2 = model.tensions(found.forces)
            values.append((T1, T2, model.copies[1] * found.contact, *heights))
            states.append(found.q)
            stick_states.append(model.stick_state)
    finally:
        solver.close()
    kept = kept_sticks = np.empty((0, 0))
    if case.keep:
        kept = np.array(states)
        if case.friction:
            kept_sticks = np.array(stick_states)
    seconds = time.perf_counter() - begun
    return Line(case.along, np.array(values), kept, kept_sticks, seconds, iterations + spent)


def _begin(model, solver, case):
    """Unknowns at the first place of a line, and the tangents factorised on the way to it."""
    corner = Load(case.at(case.along[0]))
    if case.q is None:
        start = Load()
        found = rest_state(model, solver, start)
        q = found.q
        spent = found.iterations
        model.commit(q, start)
        steps = np.linspace(FROM_REST, 1, round(1 / FROM_REST))
    else:
        start = Load(tuple(map(float, case.start)))
        q = case.q
        spent = 0
        steps = (1.0,)
        if case.stick_state is not None:
            model.stick_state = case.stick_state
    if start.d != corner.d:
        for share, found in continue_to(model, solver, q, start, corner, steps):
            q = found.q
            spent = spent + found.iterations
            model.commit(q, start.towards(corner, share))
    return q, spent
