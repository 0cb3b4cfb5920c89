"""python -m validation.published.edge_slip [--out results/edges_study] [--page docs/reports/edges.md] [--no-limits]

Slip of S-728 in its clamps: edges with a prescribed pull-in (thesis section 6.4.3), and friction clamps. Writes
edges.csv, led.png, gripped.png. With --page the tables go into that page, between its marks, the pictures beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, RED, SKY
from shellfabric.impact.ballistic_limit import critical_velocity
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.panel.boundary import Grip, PullIn
from validation.marked_page import markdown
from validation.program import program, publish, save, write_tables

MARKS = "<!-- tables of validation.published.edge_slip -->", "<!-- end of the tables -->"
LATE = 200e-6


def led_rows(shots: dict[str, Shot]) -> list[Any]:
    """A header, and a row a shot."""
    clamped = shots["clamped"]
    rows = [("weft ends", "outcome", "after, µs", "depth, mm", "excess velocity in zone I, m/s",
             "excess velocity after 200 µs, m/s", "above 0.5 m/s after, µs", "work on the edges, J",
             "energy error, %")]  # fmt: skip
    early = np.linspace(0, ZONE_I, 61)
    for name, shot in shots.items():
        rows.append((
            name, shot.outcome, f"{1e6 * shot.end:.0f}", f"{1e3 * shot.depth:.2f}",
            f"{np.abs(shot.lead(clamped, early)).max():.2f}", f"{float(shot.lead(clamped, LATE)):.2f}",
            "-" if np.isnan(departs(shot, clamped)) else f"{1e6 * departs(shot, clamped):.0f}",
            f"{shot.external:.3f}", f"{100 * shot.balance:.3f}",
        ))  # fmt: skip
    return rows


def gripped_rows(shots: dict[str, Shot], velocities: dict[str, float]) -> list[Any]:
    """A header, and a row a grip."""
    rows = [("clamp force per yarn", "outcome", "after, µs", "depth, mm", "slip of warp / weft, mm",
             "slipped width at the warp / weft ends, mm", "work of the clamps, J", "of the strike energy, %",
             "energy error, %", "critical velocity, m/s")]  # fmt: skip
    for name, shot in shots.items():
        rows.append((
            name, shot.outcome, f"{1e6 * shot.end:.0f}", f"{1e3 * shot.depth:.2f}",
            f"{1e3 * shot.pulled('warp'):.2f} / {1e3 * shot.pulled('weft'):.2f}",
            f"{1e3 * shot.width('warp'):.0f} / {1e3 * shot.width('weft'):.0f}", f"{shot.gripped:.2f}",
            f"{100 * shot.gripped / shot.strike:.1f}", f"{100 * shot.balance:.3f}",
            f"{velocities[name]:.1f}" if name in velocities else "-",
        ))  # fmt: skip
    return rows


def main(*, out: Path = Path("results/edges_study"), page: Path | None = None, no_limits: bool = False) -> None:
    fast, late, held = led(), slow(), gripped(VELOCITY)
    velocities = {} if no_limits else limits()
    tables = {
        "**Prescribed pull-in, 100 m/s.**": led_rows(fast),
        "**Prescribed pull-in, 36 m/s.**": led_rows(late),
        "**Friction clamps, 100 m/s.**": gripped_rows(held, velocities),
    }
    write_tables(out / "edges.csv", tables)
    folder, prefix = (page.parent / "figures", "edges-") if page else (out, "")
    save(draw_led, fast, late, to=folder / f"{prefix}led.png", dpi=110)
    save(draw_gripped, held, to=folder / f"{prefix}gripped.png", dpi=110)
    publish("\n".join(f"{title}\n\n{markdown(rows)}" for title, rows in tables.items()), page, MARKS)


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


def led() -> dict[str, Shot]:
    """{name: Shot} of the shots of section 6.4.3 at 100 m/s: clamped, three pull-ins, three beginnings."""
    edges: dict[str, Any] = {"clamped": "clamped"}
    edges |= {f"{1e3 * pull:g} mm, 0 to 200 µs": weft(pull, 0.0, 200e-6) for pull in PULLS}
    edges |= {f"3 mm, from {1e6 * start:g} µs": weft(3e-3, start, start + 150e-6) for start in STARTS}
    return _shots(edges, VELOCITY)


def slow() -> dict[str, Shot]:
    """{name: Shot} at 36 m/s: clamped, and 5 mm over 200 to 650 µs (Figure 6-42)."""
    return _shots({"clamped": "clamped", "5 mm, 200 to 650 µs": weft(5e-3, 200e-6, 650e-6)}, SLOW)


def gripped(velocity: float) -> dict[str, Shot]:
    """{name: Shot} with grips of GRIPS on all sides, and clamped."""
    edges = {f"{force:g} N": Grip(force) for force in GRIPS} | {"clamped": "clamped"}
    return _shots(edges, velocity)


def _shots(edges, velocity):
    table, found = None, {}
    for name, edge in edges.items():
        shot_setup = setup(edge, velocity)
        table = table or shot_setup.table()
        found[name] = of(name, run(shot_setup, table=table))
        print(f"{velocity:g} m/s, {name}: {found[name].outcome} after {1e6 * found[name].end:.0f} µs")
    return found


def limits(tolerance: float = 1.0) -> dict[str, float]:
    """{name: critical velocity [m/s]} with each grip, and clamped."""
    found, table = {}, setup().table()
    edges = {f"{force:g} N": Grip(force) for force in GRIPS[1:]} | {"clamped": "clamped"}
    for name, edge in edges.items():
        limit = critical_velocity(setup(edge).panel(table), tolerance=tolerance, guess=115.0)
        found[name] = limit.velocity
        print(f"{name}: critical velocity {limit.velocity:.1f} m/s")
    return found


def departs(shot: Shot, clamped: Shot, by: float = 0.5) -> float:
    """[s] when a shot is first faster than the clamped one by so much [m/s]."""
    t = np.arange(0.0, min(shot.end, clamped.end), 1e-6)
    away = np.flatnonzero(shot.lead(clamped, t) > by)
    return float(t[away[0]]) if away.size else float("nan")


_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, RED, SKY, INK)


def draw_led(pyplot: Any, shots: Any, slow: Any) -> Any:
    """Velocity with pulled-in edges at 100 and at 36 m/s, and its difference to that of the clamped panel."""
    figure, grid = pyplot.subplots(2, 2, figsize=(11.4, 7.4), sharex="col", height_ratios=(1.4, 1))
    for column, (group, title) in enumerate(((shots, "100 m/s"), (slow, "36 m/s"))):
        clamped = group["clamped"]
        for (name, shot), colour in zip(group.items(), (INK, *_COLOURS)):
            dash = "--" if name.startswith("3 mm, from") else "-"
            grid[0, column].plot(1e6 * shot.t, shot.v, dash, color=colour, lw=1.8, label=name)
            t = np.linspace(0, min(shot.end, clamped.end), 400)
            if shot is not clamped:
                grid[1, column].plot(1e6 * t, shot.lead(clamped, t), dash, color=colour, lw=1.8)
        for axes in grid[:, column]:
            axes.axvline(1e6 * ZONE_I, color=FAINT, lw=1.2, ls=":", label="end of zone I of the thesis")
        grid[0, column].set_title(f"S-728, {title}, weft ends pulled in")
        grid[1, column].set(xlabel="time after strike [µs]", xlim=(0, None))
        grid[0, column].legend(fontsize=9.5)
    grid[0, 0].set_ylabel("velocity [m/s]")
    grid[1, 0].set_ylabel("difference to clamped [m/s]")
    return figure


def draw_gripped(pyplot: Any, shots: Any) -> Any:
    """Velocity with friction clamps, and the slip of the ends of the weft yarns over their place along the edge."""
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.4, 4.6))
    for number, (name, shot) in enumerate(shots.items()):
        clamped = name == "clamped"
        colour, dash = (INK, ":") if clamped else (_COLOURS[number % len(_COLOURS)], "-")
        left.plot(1e6 * shot.t, shot.v, dash, color=colour, lw=1.8, label=name, zorder=3 if clamped else 2)
        if not clamped:
            right.plot(1e3 * shot.place["weft"], 1e3 * shot.slip["weft"], color=colour, lw=1.8, label=name)
    left.set(title="S-728, 100 m/s, all sides", xlabel="time after strike [µs]", ylabel="velocity [m/s]")
    right.set(title="slip at the end", xlabel="yarn's distance from the impact point [mm]")
    right.set(ylabel="slip of weft ends [mm]", xlim=(0, None), ylim=(0, None))
    left.set_xlim(left=0)
    left.legend(title="clamp force per yarn")
    return figure


if __name__ == "__main__":
    program(main, no_limits="leave the critical velocities out")
