"""Yarn pull-out coupon: one yarn pulled through its crossovers, under a pre-tension of the yarns that it crosses.

The crossovers are held in place: what moves is the yarn. Its end is drawn out at a constant velocity by a crosshead, so
heavy that nothing slows it. All crossovers take part one after the other, as the front of slip reaches them at the
wave speed of the yarn; the load is then the sum of their thresholds, until the tail of the yarn comes to them.

The contact force of the cell is that of perfectly flexible yarns: without a tension of the pulled yarn there is none,
however much the crossing yarns are stretched. With mu alone the load is therefore that of a capstan, which multiplies
the tension at each crossover and begins at nothing; the cohesion is what it begins with.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellTable
from shellfabric.driver.solver import RUNNING, Hook
from shellfabric.panel.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding import contact_force
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel, grid
from shellfabric.solver.pack_solver import PackSolver
from shellfabric.state import Slip

CROSSHEAD = 1e3  # [kg]: a load of 100 N for 1 ms changes its velocity by 1e-4 m/s
DAMPING = (
    0.5  # 1 / transit of the wave: a crimped yarn, ten times softer, is just critically damped
)
BESIDE = 4  # crossovers on each side of the yarn, which nothing happens in


@dataclass(frozen=True)
class PullOut:
    """A yarn of the warp pulled out of held crossovers.

    Parameters
    ----------
    table : CellTable of the fabric, variational
    crossings : crossovers that the yarn is pulled through
    velocity : [m/s] of the crosshead
    pre_tension : [N] of each crossing yarn, before the yarn is pulled
    friction : CrossoverFriction
    numerics : Numerics
    together : whether all yarns of the family are pulled, each by the same; otherwise one alone. In the panel half of a
        segment's energy follows from the mean stretch of neighbouring yarns: one alone is 3/4 as stiff as it is

    Raises
    ------
    InputError : a value out of its range, or a pre-tension beyond the strength of the crossing yarns
    """

    table: CellTable
    crossings: int = 20
    velocity: float = 2.0
    pre_tension: float = 0.0
    friction: CrossoverFriction = field(default_factory=CrossoverFriction)
    numerics: Numerics = field(default_factory=Numerics)
    together: bool = False

    def __post_init__(self):
        if self.crossings < 8 or self.crossings % 2:
            raise InputError(
                key="crossings", value=self.crossings, allowed="an even number of at least 8"
            )
        if not 0 < self.velocity < inf:
            raise InputError(key="velocity", value=self.velocity, allowed="above 0")
        if not 0 <= self.pre_tension < self.table.model.fabric.weave.weft.strength:
            allowed = "at least 0 and below the strength of the crossing yarns"
            raise InputError(key="pre_tension", value=self.pre_tension, allowed=allowed)

    def panel(self) -> SlidingPanel:
        """The panel: `crossings` + 1 nodes along the warp, the last of them the crosshead's; all sides free."""
        w1, w2 = self.table.model.fabric.weave.w
        opening = ((self.crossings + 0.5) * 2 * w1, (2 * BESIDE + 0.5) * 2 * w2)
        small = Projectile(radius=0.4 * min(w1, w2), edge_radius=0.1 * min(w1, w2))
        return SlidingPanel(
            self.table,
            opening,
            small,
            "whole",
            1,
            "free",
            self.numerics,
            trellis=False,
            yarn_failure=False,
            friction=self.friction,
        )

    @property
    def transit(self) -> float:
        """[s] of a wave along the yarn."""
        weave = self.table.model.fabric.weave
        wave = (weave.warp.EA / weave.warp.linear_density) ** 0.5
        return self.crossings * 2 * weave.w1 / wave

    def stretch(self) -> float:
        """[-] stretch of the crossing yarns under the pre-tension: the pulled yarn without tension, where yarns resist
        bending, and at its length at rest where they do not."""
        table, bending = self.table, self.friction.bending
        if self.pre_tension == 0:
            return 1.0
        if any(bending):
            tension = contact_force.crossing_tension(table, bending)
        else:
            tension = table.values["T2"][int(np.argmin(np.abs(table.stretch1 - 1)))]
        loaded = (table.stretch2 >= 1) & (np.gradient(tension) > 0)
        return float(np.interp(self.pre_tension, tension[loaded], table.stretch2[loaded]))

    def drawn_in(self) -> float:
        """[-] share of yarn at which the pulled yarn has no tension, its ends loose while the others are stretched;
        1 where yarns do not resist bending."""
        table, stretch = self.table, self.stretch()
        if stretch == 1 or not any(self.friction.bending):
            return 1.0
        column = int(np.argmin(np.abs(table.stretch2 - stretch)))
        slack = np.flatnonzero(table.values["N1"][:, column] <= 0)
        return 1 / min(float(table.stretch1[slack[-1]]), 1.0)


@dataclass(frozen=True)
class PullOutResult:
    """Load and displacement of a pull-out.

    Parameters
    ----------
    coupon : what was run
    time, displacement, load : (n,) [s], [m], [N] of the crosshead
    sliding : (n,) crossovers that the yarn slides through
    energy_error : [-] largest error of the energy balance over the work of the crosshead
    """

    coupon: PullOut
    time: np.ndarray
    displacement: np.ndarray
    load: np.ndarray
    sliding: np.ndarray
    energy_error: float

    @property
    def peak(self) -> float:
        """[N] highest load."""
        return float(self.load.max())


class PullOutSolver(PackSolver):
    """A pull-out: PackSolver with held nodes, and a crosshead at the end of the middle warp.

    Parameters
    ----------
    coupon : PullOut
    end_time, interval : [s] as ExplicitSolver
    start : [s] in which the crosshead comes to its velocity, and the sliding is damped from then on, for a load that
        is quasi-static; 0 starts it with all of its velocity, and damps nothing
    """

    struck = False

    def __init__(
        self, coupon: PullOut, end_time: float, *, interval: float = 1e-6, start: float = 0.0
    ) -> None:
        panel = coupon.panel()
        self.coupon, self.start = coupon, start
        super().__init__(panel, 1.0, end_time, interval=interval, energy_error_limit=1.0)

    def set_up(self) -> tuple[Slip, ...]:
        """Hold the nodes, stretch the crossing yarns and set the crosshead in motion before the first sample."""
        panel, const, state = self.parts[0]
        for array in (state.inverse_mass, state.dt_over_mass):
            array[:] = 0
        state.contact_window[:] = 0
        state.active_rows[:] = 0, const.ni
        stretch = self.coupon.stretch()
        grid(state.u[1], panel)[:] = (stretch - 1) * panel.coordinates()[1]
        (self.slip,) = slips = super().set_up()
        grid(self.slip.x[1], panel)[:, :-1] = stretch
        grid(state.stretch[1], panel)[:, :-1] = stretch
        nodes = grid(np.arange(self.slip.q[0].size), panel)[-1]
        self.node, middle = const.ni * const.row_stride + const.nj // 2, const.nj // 2
        warp, weft = (
            grid(mobile, panel) for mobile in self.slip.mobility
        )  # other yarns stay where they are
        pulled = slice(None) if self.coupon.together else slice(middle, middle + 1)
        self.held = nodes[pulled]
        yarns = warp[:, pulled].copy()
        warp[:], weft[:] = 0, 0
        warp[:, pulled], grid(self.slip.part, panel)[:, pulled] = yarns, 1
        for array, value in (
            (self.slip.mass[0], CROSSHEAD),
            (self.slip.mobility[0], 1 / CROSSHEAD),
            (self.slip.part, 0),
            (self.slip.q[0], self.crosshead_velocity()),
            (self.slip.q_before[0], self.crosshead_velocity()),
        ):
            grid(array, panel)[-1, pulled] = value
        share, inverse, x = (
            grid(each[0], panel)[:-1, pulled]
            for each in (self.slip.share, self.slip.inv_share, self.slip.x)
        )
        share[:], inverse[:], x[:] = (
            self.coupon.drawn_in(),
            1 / self.coupon.drawn_in(),
            1 / self.coupon.drawn_in(),
        )
        self.slip.row_slips[const.ni] = True
        return slips

    def crosshead_velocity(self) -> float:
        """[m/s] that is prescribed now; smooth at both ends of the start."""
        x = 1.0
        if self.time < self.start:
            x = self.time / self.start
        return self.coupon.velocity * x**3 * (10 - 15 * x + 6 * x * x)

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """See ExplicitSolver. With a start one step at a time, each after the crosshead has been accelerated."""
        if self.start == 0 or not len(history):
            return super().advance(history)
        made, reason = 0, RUNNING
        while made < len(history) and reason == RUNNING:
            if made:
                self._start_workers()
            self._accelerate()
            _, reason = super().advance(history[made : made + 1])
            made += 1
        return made, reason

    def _accelerate(self):
        """Give the crosshead the velocity that is prescribed now, and damp what slides towards it: the yarn does not
        ring, and what slides with the crosshead is not touched.

        What the kinetic energy changes by, mass x q_before x q / 2 of a leapfrog, comes from outside.
        """
        slip, velocity = self.slip, self.crosshead_velocity()
        q, q_before, mass = slip.q[0], slip.q_before[0], slip.mass[0]
        share = DAMPING * self.const.dt / self.coupon.transit
        change = np.where(q == 0, 0.0, share * (velocity - q))
        change[self.held] = velocity - q[self.held]
        stored = 0.5 * mass * q_before * q
        q += change
        q_before += change
        self.energy_at_start += float(np.sum(0.5 * mass * q_before * q - stored))

    def load(self) -> float:
        """[N] of the crosshead."""
        behind = self.node - self.const.row_stride
        return float(self.slip.config[0][behind])

    def sliding_crossovers(self) -> int:
        """Crossovers that the yarn slides through, at half of the crosshead's velocity or more."""
        flux = grid(self.slip.q[0], self.panel)[:-1, self.const.nj // 2]
        return int(np.count_nonzero(np.abs(flux) > 0.5 * self.coupon.velocity))


def run(coupon: PullOut, end_time: float, *, interval: float = 1e-6) -> PullOutResult:
    """Pull the yarn until `end_time` [s]; a sample every `interval` [s].

    Raises
    ------
    InputError : a time that is not positive
    UnstableError : as ExplicitSolver.run
    """
    solver = PullOutSolver(coupon, end_time, interval=interval)
    rows: list[tuple[float, float, float, int]] = []

    def record(running: PullOutSolver) -> None:
        moved = float(running.slip.passed[0][running.node])
        rows.append((running.time, moved, running.load(), running.sliding_crossovers()))

    hooks: tuple[Hook, ...] = (record,)
    solver.run(hooks)
    table: FloatArray = np.array(rows)
    mean, moved = 0.5 * (table[1:, 2] + table[:-1, 2]), np.diff(table[:, 1])
    work = max(float(np.sum(mean * moved)), 1e-30)
    error = float(np.max(np.abs(solver.sample("error")))) / work
    return PullOutResult(
        coupon, table[:, 0], table[:, 1], table[:, 2], table[:, 3].astype(int), error
    )
