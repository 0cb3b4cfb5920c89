"""Shots on one ply of S-728 whose edges slip: led in as in the thesis (section 6.4.3), or gripped by friction.

Led. The weft ends are drawn in over a triangle of 60 mm; the pull-ins of Figure 6-39 and the intervals of Figure 6-41
are lost (erratum E-31) and are 1, 2, 3 mm and 50, 100, 150 µs after the strike here.
Gripped. All four sides hold each yarn up to a force: how far yarns slip, and how many of them do, follows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from shellfabric.impact.ballistic_limit import critical_velocity
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.panel.boundary import Grip, PullIn

FABRIC, VELOCITY, SLOW = "S-728", 100.0, 36.0  # of section 6.4.3 (36.9 m/s in Figure 6-36, 36 in the text)
ZONE_I = 60e-6  # [s] end of zone I, before which the clamps are not felt
PULLS = (1e-3, 2e-3, 3e-3)
STARTS = (50e-6, 100e-6, 150e-6)
GRIPS = (20.0, 40.0, 80.0, 160.0)
SLIPPED = 50e-6  # [m] from which on a yarn counts as slipped


@dataclass(frozen=True)
class Shot:
    """A shot with one kind of edge.

    Parameters
    ----------
    name, edge : of the sides of the panel
    outcome : as ImpactResult
    t, v : (n,) [s], [m/s]
    end, depth : [s], [m] when it ended, and how far the projectile had come
    reaction : (n,) [N] of the weft yarn nearest the impact point, at its end
    slip, place : {family: (k,)} [m] how far each yarn's end has moved in at the end of the run, and the yarn's distance
        from the impact point
    gripped, external, strike : [J] work on the grips, of led edges, and the strike energy
    balance : [-] worst error of the energy balance
    """

    name: str
    edge: object
    outcome: str
    t: np.ndarray
    v: np.ndarray
    end: float
    depth: float
    reaction: np.ndarray
    slip: dict
    place: dict
    gripped: float
    external: float
    strike: float
    balance: float

    def pulled(self, family: str) -> float:
        """[m] slip of the yarn of a family that slipped furthest."""
        return float(self.slip[family].max())

    def width(self, family: str) -> float:
        """[m] whole width of the zone whose yarns have slipped."""
        moved = self.place[family][self.slip[family] > SLIPPED]
        return 2 * float(moved.max()) if moved.size else 0.0

    def lead(self, other: Shot, t: Any) -> FloatArray:
        """[m/s] how much faster the projectile is at the times t than with other edges."""
        return np.interp(t, self.t, self.v) - np.interp(t, other.t, other.v)


def of(name: str, result: ImpactResult) -> Shot:
    """What is kept of an impact on a quarter of a panel."""
    panel = result.panel
    X, Y = panel.coordinates()
    nodes = result.last[0].nodes
    energies = result.energies
    return Shot(
        name, panel.edge, result.outcome, result.t, result.v, float(result.t[-1]), float(result.nose_position.max()),
        result.reactions["weft"],
        {"warp": X[-1] - nodes[-1, :, 0], "weft": Y[:, -1] - nodes[:, -1, 1]}, {"warp": Y[-1], "weft": X[:, -1]},
        float(energies["clamp_friction"][-1]), float(energies["boundary_work"][-1]), result.strike_energy,
        result.energy_error_max,
    )  # fmt: skip


def setup(edge: Any = "clamped", velocity: float = VELOCITY, end_time: float = 700e-6) -> ImpactSetup:
    """A shot at the thesis's panel."""
    return ImpactSetup(catalogue.load(FABRIC).with_effective_density(), velocity, edge=edge, end_time=end_time)


def weft(length: float, start: float, end: float) -> tuple[str, PullIn]:
    """The edges of a panel whose weft ends are led in."""
    return ("clamped", PullIn(length, start, end))


def led(report: Callable[..., object] | None = print) -> dict[str, Shot]:
    """{name: Shot} of the shots of section 6.4.3 at 100 m/s: clamped, three pull-ins, three beginnings."""
    edges: dict[str, Any] = {"clamped": "clamped"}
    edges |= {f"{1e3 * pull:g} mm, 0 to 200 µs": weft(pull, 0.0, 200e-6) for pull in PULLS}
    edges |= {f"3 mm, from {1e6 * start:g} µs": weft(3e-3, start, start + 150e-6) for start in STARTS}
    return _shots(edges, VELOCITY, report)


def slow(report: Callable[..., object] | None = print) -> dict[str, Shot]:
    """{name: Shot} at 36 m/s: clamped, and 5 mm over 200 to 650 µs (Figure 6-42)."""
    return _shots({"clamped": "clamped", "5 mm, 200 to 650 µs": weft(5e-3, 200e-6, 650e-6)}, SLOW, report)


def gripped(velocity: float, report: Callable[..., object] | None = print) -> dict[str, Shot]:
    """{name: Shot} with grips of GRIPS on all sides, and clamped."""
    edges = {f"{force:g} N": Grip(force) for force in GRIPS} | {"clamped": "clamped"}
    return _shots(edges, velocity, report)


def _shots(edges, velocity, report):
    table, found = None, {}
    for name, edge in edges.items():
        shot_setup = setup(edge, velocity)
        table = table or shot_setup.table()
        found[name] = of(name, run(shot_setup, table=table))
        report(f"{velocity:g} m/s, {name}: {found[name].outcome} after {1e6 * found[name].end:.0f} µs")
    return found


def limits(report: Callable[..., object] | None = print, tolerance: float = 1.0) -> dict[str, float]:
    """{name: critical velocity [m/s]} with each grip, and clamped."""
    found, table = {}, setup().table()
    edges = {f"{force:g} N": Grip(force) for force in GRIPS[1:]} | {"clamped": "clamped"}
    for name, edge in edges.items():
        limit = critical_velocity(setup(edge).panel(table), tolerance=tolerance, guess=115.0)
        found[name] = limit.velocity
        report(f"{name}: critical velocity {limit.velocity:.1f} m/s")
    return found


def departs(shot: Shot, clamped: Shot, by: float = 0.5) -> float:
    """[s] when a shot is first faster than the clamped one by so much [m/s]."""
    t = np.arange(0.0, min(shot.end, clamped.end), 1e-6)
    away = np.flatnonzero(shot.lead(clamped, t) > by)
    return float(t[away[0]]) if away.size else float("nan")
