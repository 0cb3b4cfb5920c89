"""Equilibria of a crossover between platens at given pressures, for one trial of the solid's constants after
another. Without friction an equilibrium depends on load and constants alone: only the first trial is loaded
from rest; the next starts, pressure by pressure, from that of an earlier trial x and its derivatives

    dq/dx = -K^-1 dr/dx at a fixed distance of the platens,    dq/dh = -K^-1 dr/dh,

K being Newton's tangent, dr/dx and dr/dh differences of the residual. They give those of the pressure, and so

    dc/dx = 2 (d ln P/dx) / (d ln P/dh),    c = 2 (h_rest - h),

the Jacobian of the closures. A step in x that is too long is halved; where an eighth fails, it is loaded from rest.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import UnstableError
from fabrics.fabric import Fabric
from meshing.crossover import Crossover
from unitcell3d.material.numerics import Numerics
from unitcell3d.model.crossover import CrossoverModel, Load
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Newton

# of an unknown constant (a logarithm), in the residual's difference
DIFFERENCE = 1e-3
# m of the platens' half distance, and of the largest displacement, in differences
STEP = 1e-10
LEVEL = 0.1  # of ln P: how far from its pressure an equilibrium may lie
CORRECTIONS = 6  # of the platens' distance towards a pressure
# of the distance at rest: steps of the first loading
LARGEST = 0.02
LEAST = 1e-5
JUMPS = 2  # of the largest step, over a snap
# of that at rest: soft trial yarns close further than real ones
LEAST_DISTANCE = 0.2
FAR = 1.5  # between trials: beyond this a loading from rest is cheaper
HALVINGS = 3  # of a step in the constants
# of the lowest pressure: where ln P is worth extrapolating
FIRST_PRESSED = 0.02


@dataclass(frozen=True, eq=False)
class PlatenStates:
    """Equilibria of one trial, n of them, from the lowest pressure up.

    Parameters
    ----------
    x : (p,) logarithms of the constants
    half_distance : (n,) [m] of the platens
    pressure : (n,) [Pa] on the area of the cell
    q : (n, size) [m] unknowns
    q_x, q_h : (n, size, p), (n, size) derivatives of the unknowns
    pressure_x, pressure_h : (n, p), (n,) [1/m] derivatives of ln P
    rest : [m] half distance at which the platens just touch
    failed : why the highest pressures were not reached, or ""
    """

    x: FloatArray
    half_distance: FloatArray
    pressure: FloatArray
    q: FloatArray
    q_x: FloatArray
    q_h: FloatArray
    pressure_x: FloatArray
    pressure_h: FloatArray
    rest: float
    failed: str = ""

    def closures(self, pressure: FloatArray) -> FloatArray:
        """Compute the closures (n,) [m] at pressures [Pa] beside those of the equilibria, straight
        in ln P from the nearest."""
        i = self._nearest(pressure)
        offset = (np.log(pressure) - np.log(self.pressure[i])) / self.pressure_h[i]
        return 2 * (self.rest - self.half_distance[i] - offset)

    def jacobian(self, pressure: FloatArray) -> FloatArray:
        """Compute the derivatives (n, p) [m] of `closures` by x."""
        i = self._nearest(pressure)
        return 2 * self.pressure_x[i] / self.pressure_h[i, None]

    def _nearest(self, pressure):
        return np.argmin(abs(np.log(self.pressure)[None] - np.log(pressure)[:, None]), axis=1)


class PlatenSolver:
    """The equilibria of one mesh at given pressures, for trial after trial; call `close` at the
    end.

    Parameters
    ----------
    crossover : meshing.crossover.Crossover
    fabric : Fabric, with solid laws
    with_constants : function of x : (p,) giving the fabric with these constants
    pressure : (n,) [Pa] rising
    """

    def __init__(
        self,
        crossover: Crossover,
        fabric: Fabric,
        with_constants: Callable[[FloatArray], Fabric],
        pressure: FloatArray,
    ) -> None:
        # the V_c that is fitted belongs to the fraction of the mesh
        self.model = CrossoverModel(crossover, fabric, Numerics(fibre_fraction="mesh"))
        self._solver = Newton(self.model)
        self._with = with_constants
        self.pressure = np.asarray(pressure, float)
        self._known: list[PlatenStates] = []
        self._x = np.empty(0)
        self.loaded = 0  # trials loaded from rest
        self.equilibria = 0
        self.tangents = 0  # factorisations

    def close(self) -> None:
        """Give the factorisation back."""
        self._solver.close()

    def at(self, x: FloatArray) -> PlatenStates:
        """Solve the equilibria of a trial.

        Raises
        ------
        UnstableError : the yarns find no equilibrium at the lowest pressure
        """
        x = np.asarray(x, float)
        for states in self._known:
            if np.allclose(states.x, x, rtol=0, atol=1e-12):
                return states
        usable = [states for states in self._known if not states.failed]
        found = None
        if usable:
            nearest = min(usable, key=lambda states: _distance(states.x, x))
            if _distance(nearest.x, x) < FAR:
                with suppress(UnstableError):
                    found = self._from(nearest, x, HALVINGS)
        if found is None:
            found = self._load(x)
        self._known.append(found)
        return found

    def _from(self, states, x, halvings):
        """The equilibria at x from those of another trial."""
        try:
            self._take(x)
            step = x - states.x
            rows = []
            for i, wanted in enumerate(np.log(self.pressure)):
                ahead = np.log(states.pressure[i]) + states.pressure_x[i] @ step
                change = (wanted - ahead) / states.pressure_h[i]
                h = states.half_distance[i] + change
                guesses = [states.q[i] + states.q_x[i] @ step + states.q_h[i] * change, states.q[i]]
                try:
                    rows.append(
                        self._correct(h, self._solver.best(guesses, self._load_at(h)), wanted)
                    )
                except UnstableError:
                    if not rows:
                        raise
                    rows.append(self._press_on(rows[-1], wanted))
            return self._states(x, rows)
        except UnstableError:
            if halvings == 0:
                raise
        middle = self._from(states, 0.5 * (states.x + x), halvings - 1)
        return self._from(middle, x, halvings - 1)

    def _take(self, x):
        self._x = x
        self.model.take_solid_laws(self._with(x))

    def _press_on(self, row, wanted):
        """The equilibrium at a pressure, loaded from one at a lower pressure."""
        h = row["half_distance"] + (wanted - np.log(row["pressure"])) / row["pressure_h"]
        ends = self._load_at(row["half_distance"]), self._load_at(h)
        ((_, found),) = continue_to(self.model, self._solver, row["q"], *ends, (1.0,))
        return self._correct(h, found.q, wanted)

    def _correct(self, h, q, wanted):
        """The equilibrium within `LEVEL` of ln P from a guess (h, q)."""
        for _ in range(CORRECTIONS):
            found = self._solver.approach(q, self._load_at(h))
            row = self._row(h, found)
            miss = wanted - np.log(row["pressure"])
            if abs(miss) < LEVEL:
                return row
            if not row["pressure_h"] < 0:
                break
            largest = LARGEST * self.model.plates.at_rest
            change = np.clip(miss / row["pressure_h"], -largest, largest)
            h = h + change
            q = found.q + row["q_h"] * change
        raise UnstableError(
            "no equilibrium near a pressure",
            where=self.model.fabric.name,
            when=f"ln P = {wanted:.3f}",
        )

    def _load(self, x):
        """The equilibria at x, loaded from rest."""
        self.loaded += 1
        self._take(x)
        model = self.model
        rest = model.plates.at_rest
        levels = list(np.log(self.pressure))
        rows = []
        failed = ""
        h = rest
        q = rest_state(model, self._solver, self._load_at(rest)).q
        step = LARGEST
        before = None
        try:
            while levels:
                goal = max(h - step * rest, LEAST_DISTANCE * rest)
                h, found = self._close_to(goal, h, q)
                self._count(found)
                q = found.q
                P = self._pressure(found.plates)
                now = np.log(P) if P > 0 else -np.inf
                while levels and now > levels[0] - LEVEL:
                    row = self._row(h, found)
                    if now > levels[0] + LEVEL:
                        row = self._correct(h, q, levels[0])
                    rows.append(row)
                    levels.pop(0)
                if not levels or h <= LEAST_DISTANCE * rest:
                    break
                step = self._next_step(now, before, levels[0], h, step)
                before = (now, h)
        except UnstableError as problem:
            failed = str(problem)
        if levels and not failed:
            failed = f"the platens are at {LEAST_DISTANCE:g} of their first distance"
        if not rows:
            raise UnstableError(f"no platen curve: {failed}")
        return self._states(x, rows, failed)

    def _close_to(self, goal, h, q):
        """(half distance, Equilibrium) of the next step from the equilibrium (h, q), past a snap
        where there is one."""
        try:
            ((_, found),) = continue_to(
                self.model, self._solver, q, self._load_at(h), self._load_at(goal), (1.0,)
            )
            return goal, found
        except UnstableError:
            # a slack tip that snaps through has its next equilibrium some way further on
            for jump in range(1, JUMPS + 1):
                beyond = h - jump * LARGEST * self.model.plates.at_rest
                with suppress(UnstableError):
                    return beyond, self._solver.approach(q, self._load_at(beyond))
            raise

    def _next_step(self, now, before, level, h, step):
        """Share of the distance at rest to the next pressure by the secant, within bounds."""
        if (
            before is None
            or not np.isfinite(before[0])
            or now < level + np.log(FIRST_PRESSED)
            or now <= before[0]
        ):
            return LARGEST
        slope = (now - before[0]) / (before[1] - h)
        share = (level - now) / slope / self.model.plates.at_rest
        return float(np.clip(share, LEAST, min(LARGEST, 2 * step)))

    def _row(self, h, found):
        """The equilibrium with its derivatives."""
        self._count(found)
        self.tangents += 1
        model = self.model
        load = self._load_at(h)
        x = self._x
        base = self._residual(found.q, load)
        changes = []
        for unit in np.eye(len(x)):
            model.take_solid_laws(self._with(x + DIFFERENCE * unit))
            changes.append((self._residual(found.q, load) - base) / DIFFERENCE)
        model.take_solid_laws(self._with(x))
        # central: the platens' penalty is far stiffer than the yarns, so that an error of its slope
        # would count
        ends = [self._residual(found.q, self._load_at(h + s * STEP)) for s in (-1, 1)]
        changes.append((ends[1] - ends[0]) / (2 * STEP))
        *q_x, q_h = self._solver.linear_changes(found.q, load, changes)
        P = self._pressure(found.plates)
        return {
            "half_distance": h,
            "pressure": P,
            "q": found.q,
            "q_x": np.stack(q_x, axis=1),
            "q_h": q_h,
            "pressure_x": np.array([self._slope(found.q, dq, h, 0.0, P) for dq in q_x]),
            "pressure_h": self._slope(found.q, q_h, h, 1.0, P),
        }

    def _slope(self, q, dq, h, dh, P):
        """d ln P along (dq, dh), a central difference short beside the contact's toe."""
        part = STEP / max(abs(dq).max(), dh, 1e-12)
        ends = [self._plates(q + s * part * dq, self._load_at(h + s * part * dh)) for s in (-1, 1)]
        return (ends[1] - ends[0]) / (2 * part * P)

    def _plates(self, q, load):
        model = self.model
        x = model.positions(q, load)
        spare = np.zeros_like(x), None, model.pattern.values
        return self._pressure(model.plates.press(x, load.plates, model.numerics, *spare))

    def _residual(self, q, load):
        return self.model.constraints.reduce(self.model.forces(q, load)[0])

    def _pressure(self, plates):
        return float(self.model.copies[1] * np.mean(plates) / self.model.fabric.weave.cell_area)

    def _load_at(self, h):
        return Load(plates=float(h))

    def _count(self, found):
        self.equilibria += 1
        self.tangents += found.iterations

    def _states(self, x, rows, failed=""):
        columns = {key: np.array([row[key] for row in rows]) for key in rows[0]}
        return PlatenStates(x=x, rest=self.model.plates.at_rest, failed=failed, **columns)


def _distance(x, other):
    return float(abs(x - other).max())
