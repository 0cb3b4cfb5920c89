"""python -m validation.published.bias_extension.sliding [--page docs/reports/sliding.md] [--length 57 --width 29.6 ...]

The bias extension test with sliding crossovers: explicit, clamps at a constant speed, the strip of
`quasistatic.bias_coupon` cut out of a panel whose grid lines are the yarns. Segments outside the strip are removed,
half a spacing of yarn stands out beyond the last crossover on its long sides, and nothing slips in the clamps. With an
infinite threshold it is the explicit test of pinned crossovers.

The angles of the three zones at each elongation answer whether slip explains the three missed claims of this test
(docs/reports/claims.md): that the zones lie apart, and that the middle one is the mean of its neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isinf, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.checks import FloatArray, IntArray
from shellfabric.cell.model import CellModel
from shellfabric.cloth.membrane_kernels import WARP_FAILED
from shellfabric.coupon import quasistatic
from shellfabric.coupon.model import Coupon
from shellfabric.panel.element_kernels import DAMAGED
from shellfabric.panel.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.sliding.contact_force import bending_bounds
from shellfabric.sliding.flow_kernels import PULLED_OUT
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel, grid
from shellfabric.solver.pack_solver import PackSolver
from validation.program import program
from validation.published.bias_extension.cases import cloth
from weavecell.report.marked_page import markdown, put
from weavecell.results import provenance

BEGIN, END = "<!-- table of validation.published.bias_extension.sliding -->\n", "<!-- end of bias extension -->"
SPEED = 1.0  # [m/s] of each clamp
SIZE = 57.0, 29.6, 3.0  # [mm] length, width, elongation: a strip of 0.4 times the thesis's, at 3/4 of its strain
LOOKS, AVERAGED = 4, 25  # states in the table, and samples before each over which the load is averaged
COEFFICIENTS = (inf, 0.3, 0.2, 0.1)


@dataclass(frozen=True)
class Pulled:
    """A strip that has been pulled.

    Parameters
    ----------
    mu : [-] coefficient of friction
    stiff : whether the contact force is that of yarns that resist bending
    elongation : (k,) [m]
    angles : (k, 3) [rad] mean angle between warp and weft in the zones A, B, C
    load : (k,) [N] mean over the time since the look before
    passed : [m] longest length of yarn that has passed through a crossover
    left : segments that a yarn's end has left
    friction_work : [J]
    """

    mu: float
    stiff: bool
    elongation: FloatArray
    angles: FloatArray
    load: FloatArray
    passed: float
    left: int
    friction_work: float

    @property
    def title(self) -> str:
        """What is written in the table."""
        if isinf(self.mu):
            return "pinned"
        return f"mu = {self.mu:g}, {'bending' if self.stiff else 'flexible'}"


class ObliqueStrip(PackSolver):
    """A strip at 45 degrees to the yarns of a panel, its clamps pulled apart.

    Parameters
    ----------
    coupon, grips : of `quasistatic.bias_coupon`
    friction : CrossoverFriction
    speed : [m/s] of each clamp
    elongation : [m] at the end
    """

    struck = False

    def __init__(
        self, coupon: Coupon, grips: IntArray, friction: CrossoverFriction, speed: float, elongation: float
    ) -> None:
        dx, dy = coupon.spacing
        x, y = coupon.points.T
        along, across = (x + y) / sqrt(2), (y - x) / sqrt(2)
        self.place = tuple(
            np.rint((part - part.min()) / side).astype(int) for part, side in ((along, dx), (across, dy))
        )
        self.coupon, self.grips, self.speed = coupon, grips, speed
        cells = [2 * (int(place.max()) // 2 + 1) for place in self.place]
        small = Projectile(radius=0.2 * min(dx, dy), edge_radius=0.05 * min(dx, dy))
        opening = ((cells[0] + 0.5) * dx, (cells[1] + 0.5) * dy)
        panel = SlidingPanel(
            coupon.table, opening, small, "whole", 1, "free", Numerics(threads=1), trellis=coupon.trellis,
            failure=False, friction=friction,
        )  # fmt: skip
        end = elongation / (2 * speed)
        super().__init__(panel, 1.0, end, interval=end / (100 * LOOKS), energy_error_limit=inf)
        self.exchange = inf

    def set_up(self) -> None:
        """Cut the strip, hold the clamps and set them in motion before the first sample."""
        const, state = self.const, self.state
        state.contact_window[:] = 0
        state.active_rows[:] = 0, const.ni
        slots = self.place[0] * const.row_stride + self.place[1]
        for family, edges in enumerate(self.coupon.edges):
            there = np.zeros(state.yarn_length[family].size, bool)
            there[slots[edges].min(axis=1)] = True
            state.yarn_length[family][~there] = 0.0
            state.intact_fraction[family][~there] = 0.0
        state.block_damage[:], state.element_flag[:] = DAMAGED, WARP_FAILED
        free = np.zeros(state.mass.size, bool)
        free[slots[self.grips == 0]] = True
        for array in (state.inverse_mass, state.dt_over_mass):
            array[~free] = 0.0
        for grip, sign in ((1, 1.0), (2, -1.0)):
            for c in range(2):
                state.v[c][slots[self.grips == grip]] = sign * self.speed / sqrt(2)
        self.slips = self.pack.slips(self.states)
        (self.slip,) = self.slips
        for mobility in self.slip.mobility:
            mobility[~free] = 0.0
        self.slots = slots

    def positions(self) -> FloatArray:
        """(n, 2) [m] nodes of the coupon, in its own directions."""
        u, v = (self.state.u[c][self.slots] for c in range(2))
        return self.coupon.points + np.stack([(u - v) / sqrt(2), (u + v) / sqrt(2)], axis=1)

    def load(self) -> float:
        """[N] of a clamp, the mean of both."""
        state, total = self.state, 0.0
        for grip, sign in ((1, -1.0), (2, 1.0)):
            at = self.slots[self.grips == grip]
            total += sign * sum(float((state.f_int[c][at] + state.f_int_above[c][at]).sum()) for c in range(2))
        return total / (2 * sqrt(2))


def pull(
    mu: float, *, length: float = 0.057, width: float = 0.0296, elongation: float = 0.003, speed: float = SPEED,
    cohesion: float = 0.0, stiff: bool = False, table_size: int = 121, name: str = "locking",
) -> Pulled:  # fmt: skip
    """Pull a strip of one of `cases.CLOTHS` with the coefficient of friction `mu`; lengths in m, the cohesion in N.

    stiff : whether the contact force in the threshold is that of yarns that resist bending, as their fibres alone do
    """
    fabric, model, trellis = cloth(name)
    table = CellModel(fabric, model=model, form="variational").table(table_size)
    coupon, grips, (length, width) = quasistatic.bias_coupon(table, length, width, 1, trellis)
    zone = quasistatic.zones(coupon, length, width)
    warp, weft = fabric.weave.yarns
    bending = (bending_bounds(warp)[0], bending_bounds(weft)[0]) if stiff else (0.0, 0.0)
    solver = ObliqueStrip(coupon, grips, CrossoverFriction(mu, cohesion, bending), speed, elongation)
    loads: list[float] = []
    looks: list[tuple[float, list[float], float]] = []

    def look(strip: ObliqueStrip) -> None:
        loads.append(strip.load())
        if strip.time >= (len(looks) + 1) / LOOKS * strip.end_time or (strip.ended and len(looks) < LOOKS):
            gamma = coupon.shear_angles(strip.positions())
            means = [float(np.pi / 2 - gamma[zone == k].mean()) for k in range(3)]
            looks.append((2 * speed * strip.time, means, float(np.mean(loads[-AVERAGED:]))))

    solver.run((look,))
    moved, angles, mean = (np.array(part) for part in zip(*looks))
    slip = solver.slip
    passed = float(max(np.abs(grid(part, solver.panel)).max() for part in slip.passed))
    return Pulled(mu, stiff, moved, angles, mean, passed, int(slip.counter[PULLED_OUT]), float(slip.work[0]))


def table(runs: Sequence[Pulled], command: str) -> str:
    """The section: a row a coefficient and elongation."""
    cells = [(
        "crossovers", "elongation, mm", "A, deg", "B, deg", "C, deg", "B less the mean of A and C, deg",
        "C less A, deg", "load, N",
    )]  # fmt: skip
    for run in runs:
        for moved, (A, B, C), load in zip(run.elongation, np.degrees(run.angles), run.load):
            cells.append((
                run.title, f"{1e3 * moved:.1f}", f"{A:.2f}", f"{B:.2f}", f"{C:.2f}", f"{B - 0.5 * (A + C):+.2f}",
                f"{C - A:+.2f}", f"{load:.0f}",
            ))  # fmt: skip
    lines = [
        f"{run.title}: at most {1e3 * run.passed:.2g} mm of yarn through a crossover, {run.left} segments left by\n"
        f"a yarn's end, {1e3 * run.friction_work:.3g} mJ of friction"
        for run in runs
        if not isinf(run.mu)
    ]
    made = f"Made by `{command}` at commit {provenance.stamp()['commit']}.\n\n"
    return made + markdown(cells) + "\nAt the end: " + ";\n".join(lines) + ".\n"


def main(
    *,
    page: Path | None = None,
    length: float = SIZE[0],
    width: float = SIZE[1],
    elongation: float = SIZE[2],
    mu: Sequence[float] = COEFFICIENTS,
) -> None:
    """Run it."""
    size: dict[str, Any] = {"length": 1e-3 * length, "width": 1e-3 * width, "elongation": 1e-3 * elongation}
    runs = []
    for friction, stiff in [(each, stiff) for stiff in (False, True) for each in mu if not (stiff and isinf(each))]:
        runs.append(pull(friction, stiff=stiff, **size))
        print(
            runs[-1].title, np.degrees(runs[-1].angles[-1]), runs[-1].load, runs[-1].passed, runs[-1].left, flush=True
        )
    text = table(runs, f"python -m validation.published.bias_extension.sliding --page {page}")
    print(text)
    if page:
        put(page, BEGIN, END, text)


if __name__ == "__main__":
    program(main, length="[mm]", width="[mm]", elongation="[mm]", mu="coefficients of friction")
