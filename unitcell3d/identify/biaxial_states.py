"""Loads of a crossover along the strains of biaxial tests, for one trial of the solid's constants after
another. A test is followed at `STATIONS` equal parts of its largest strain. Each equilibrium gives the
derivatives of both loads by the constants x and the end displacements d, from Newton's own tangent,

    dq/dp = -K^-1 dr/dp,    dT/dp = (dT/dq) dq/dp + (dT/dp at fixed q),    p in x, d,

so that a trial has its Jacobian. Loads at the measured strains are those of monotone cubics between the
stations, and of the derivatives by d for what a strain is off the straight line. The first trial is loaded
from rest; the next begin, station by station, with equilibria of an earlier one and their derivatives. One
too far for this has no equilibria, and a shorter step is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from unitcell3d.identify.platen_states import DIFFERENCE, FAR, STEP
from unitcell3d.material.numerics import Numerics
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Equilibrium, Newton

STATIONS = 12
# of the forces: residual of a trial that begins near equilibrium. Loads are compared to 1e-3
TRIAL_TOLERANCE = 1e-6
# of the largest strain of a test: how far its states may lie off a straight line
OFF_LINE = 0.15


@dataclass(frozen=True, eq=False)
class PulledTest:
    """A measured biaxial test.

    Parameters
    ----------
    name : of the test
    strain : (n, 2) [-] of the fabric along warp and weft
    load : (n, 2) [N] of a yarn of warp and weft; nan where it was not measured

    Raises
    ------
    InputError : a direction that is free, no strain that stretches, or strains of more than one ratio
    """

    name: str
    strain: FloatArray
    load: FloatArray

    def __post_init__(self) -> None:
        key = f"test {self.name}"
        if not np.isfinite(self.strain).all():
            raise InputError(
                key=key, value="a free direction", allowed="strains of both directions"
            )
        if not self.strain.max() > 0:
            raise InputError(key=key, value=float(self.strain.max()), allowed="a strain above 0")
        off = abs(self.strain - self.along[:, None] * self.end).max()
        if off > OFF_LINE * self.strain.max():
            text = f"strains {100 * off:.2g} % off a straight line"
            allowed = f"at most {100 * OFF_LINE:g} % of the largest, which is one ratio of strains"
            raise InputError(key=key, value=text, allowed=allowed)

    @property
    def end(self) -> FloatArray:
        """(2,) [-] the largest strain, along the direction in which the test goes."""
        at = self.strain[np.abs(self.strain).max(axis=1).argmax()]
        direction = at / np.sqrt(np.sum(at**2))
        return np.max(np.sum(self.strain * direction, axis=1)) * direction

    @property
    def along(self) -> FloatArray:
        """(n,) [-] place of each state on the way to `end`."""
        return np.sum(self.strain * self.end, axis=1) / np.sum(self.end**2)


@dataclass(frozen=True, eq=False)
class PulledStates:
    """Equilibria of one trial and test, k of them; the first is at rest.

    Parameters
    ----------
    q, q_x : (k, size), (k, size, p) unknowns [m] and their derivatives by x
    load, load_x, load_d : (k, 2) [N], (k, 2, p), (k, 2, 2) [N/m] loads and their derivatives
    """

    q: FloatArray
    q_x: FloatArray
    load: FloatArray
    load_x: FloatArray
    load_d: FloatArray

    def at(self, test: PulledTest, w: Sequence[float]) -> tuple[FloatArray, FloatArray]:
        """Compute loads (n, 2) [N] at the strains of a test, and their derivatives (n, 2, p)."""
        places = np.linspace(0, 1, len(self.load))
        along = np.clip(test.along, 0, 1)
        off = (test.strain - test.along[:, None] * test.end) * np.asarray(w)
        slopes = PchipInterpolator(places, self.load_d)(along)
        load = PchipInterpolator(places, self.load)(along) + np.sum(slopes * off[:, None], axis=2)
        return load, PchipInterpolator(places, self.load_x)(along)


class BiaxialSolver:
    """The equilibria of one mesh along tests, for trial after trial; call `close` at the end.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric, with solid laws
    with_constants : function of x : (p,) giving the fabric with these constants
    tests : of PulledTest
    """

    def __init__(
        self,
        crossover: Crossover,
        fabric: Fabric,
        with_constants: Callable[[FloatArray], Fabric],
        tests: Sequence[PulledTest],
    ) -> None:
        # the V_c that is fitted belongs to the fraction of the mesh
        self.model = CrossoverModel(crossover, fabric, Numerics(fibre_fraction="mesh"))
        self._solver = Newton(self.model)
        self._with = with_constants
        self._tests = tests
        self._rest: Equilibrium | None = None
        self._known: list[tuple[FloatArray, list[PulledStates]]] = []
        self._x = np.empty(0)
        self.loaded = 0  # trials loaded from rest
        self.equilibria = 0
        self.tangents = 0  # factorisations

    def close(self) -> None:
        """Give the factorisation back."""
        self._solver.close()

    def loads(
        self, x: FloatArray, *, from_rest: bool = False
    ) -> list[tuple[FloatArray, FloatArray]]:
        """Solve a trial: loads (n, 2) [N] of each test at its strains, and derivatives (n, 2, p).

        Parameters
        ----------
        from_rest : load it from rest where it is too far from earlier trials

        Raises
        ------
        UnstableError : a test finds no equilibrium up to its last strain
        """
        w = self.model.fabric.weave.w
        return [states.at(test, w) for test, states in zip(self._tests, self.at(x, from_rest))]

    def at(self, x: FloatArray, from_rest: bool = False) -> list[PulledStates]:
        """Solve the equilibria of a trial, of each test; `from_rest` as of `loads`.

        Raises
        ------
        UnstableError : a test finds no equilibrium up to its last strain, or a trial is too far from an
            earlier one
        """
        x = np.asarray(x, float)
        near = min(self._known, key=lambda known: abs(known[0] - x).max(), default=None)
        if near is not None and np.allclose(near[0], x, rtol=0, atol=1e-12):
            return near[1]
        if near is not None and abs(near[0] - x).max() > FAR:
            if not from_rest:
                raise UnstableError("a trial too far from those that are known", when=str(x))
            near = None
        self._x = x
        self.model.take_solid_laws(self._with(x))
        self.loaded += near is None
        found = []
        for number, test in enumerate(self._tests):
            before = None
            if near is not None:
                before = near[1][number].q + near[1][number].q_x @ (x - near[0])
            found.append(self._follow(test, before))
        self._known.append((x, found))
        return found

    def _follow(self, test, before):
        """Return the states of a test; `before` : (k, size) are guesses."""
        rest = Load()
        end = Load(tuple(map(float, test.end * self.model.fabric.weave.w)))
        size = len(self._x)
        # at rest a trial has what the earlier one had: nothing is loaded
        q = rest_state(self.model, self._solver, rest).q if before is None else before[0]
        rows = [
            {
                "q": q,
                "q_x": np.zeros((self.model.size, size)),
                "load": np.zeros(2),
                "load_x": np.zeros((2, size)),
                "load_d": np.zeros((2, 2)),
            }
        ]
        last = rest
        for number in range(1, STATIONS + 1):
            load = rest.towards(end, number / STATIONS)
            if before is None:
                ((_, found),) = continue_to(
                    self.model, self._solver, rows[-1]["q"], last, load, (1.0,)
                )
            else:
                found = self._solver.approach(before[number], load, TRIAL_TOLERANCE)
            rows.append(self._row(found, load))
            last = load
        return PulledStates(**{key: np.array([row[key] for row in rows]) for key in rows[0]})

    def _row(self, found, load):
        """Return the equilibrium with its derivatives."""
        self.equilibria += 1
        self.tangents += found.iterations + 1
        model = self.model
        x = self._x
        q = found.q
        reduce = model.constraints.reduce
        base = model.forces(q, load)[0]
        residuals = []
        changes = []
        for unit in np.eye(len(x)):
            model.take_solid_laws(self._with(x + DIFFERENCE * unit))
            change = (model.forces(q, load)[0] - base) / DIFFERENCE
            changes.append(model.tensions(change))
            residuals.append(reduce(change))
        model.take_solid_laws(self._with(x))
        for unit in np.eye(2):
            ends = [model.forces(q, _moved(load, s * STEP * unit))[0] for s in (-1, 1)]
            residuals.append(reduce((ends[1] - ends[0]) / (2 * STEP)))
        model.forces(q, load)
        moves = self._solver.linear_changes(q, load, residuals)
        load_x = [own + self._along(q, dq, load, np.zeros(2)) for own, dq in zip(changes, moves)]
        load_d = [self._along(q, dq, load, unit) for unit, dq in zip(np.eye(2), moves[len(x) :])]
        return {
            "q": q,
            "q_x": np.stack(moves[: len(x)], axis=1),
            "load": model.tensions(found.forces),
            "load_x": np.stack(load_x, axis=1),
            "load_d": np.stack(load_d, axis=1),
        }

    def _along(self, q, dq, load, dd):
        """Return the derivative (2,) of the loads along (dq, dd), a central difference short beside the
        contact's toe."""
        part = STEP / max(abs(dq).max(), abs(dd).max(), 1e-30)
        ends = [
            self.model.tensions(
                self.model.forces(q + s * part * dq, _moved(load, s * part * dd))[0]
            )
            for s in (-1, 1)
        ]
        return (ends[1] - ends[0]) / (2 * part)


def _moved(load, by):
    """Return the load with end displacements further by (2,) [m]."""
    return Load((load.d[0] + float(by[0]), load.d[1] + float(by[1])), load.plates)
