"""python -m validation.published.edge_slip [--out results/edges_study] [--page docs/reports/edges.md] [--no-limits]

Slip of S-728 in its clamps: edges with a prescribed pull-in (thesis section 6.4.3), and friction clamps. Writes
edges.csv, led.png, gripped.png. With --page the tables go into that page, between its marks, the pictures beside it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from validation.program import program, write_tables
from validation.published.edge_slip import pictures
from validation.published.edge_slip.study import VELOCITY, ZONE_I, Shot, departs, gripped, led, limits, slow
from weavecell.report.marked_page import markdown, put

MARKS = "<!-- tables of validation.published.edge_slip -->", "<!-- end of the tables -->"
LATE = 200e-6
_PICTURES = {
    "led": "Velocity of the projectile with edges that are pulled in",
    "gripped": "Velocity and slip with friction clamps",
}


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


def write_page(tables: dict[str, Any], page: Path) -> None:
    """Put tables between the marks of a page."""
    parts = [f"{title}\n\n{markdown(rows)}" for title, rows in tables.items()]
    content = "\n".join([*parts, *(f"![{caption}](figures/edges-{name}.png)\n" for name, caption in _PICTURES.items())])
    put(page, *MARKS, f"\n\n{content}\n")


def main(*, out: Path = Path("results/edges_study"), page: Path | None = None, no_limits: bool = False) -> None:
    fast, late, held = led(), slow(), gripped(VELOCITY)
    velocities = {} if no_limits else limits()
    tables = {
        "**Prescribed pull-in, 100 m/s.**": led_rows(fast),
        "**Prescribed pull-in, 36 m/s.**": led_rows(late),
        "**Friction clamps, 100 m/s.**": gripped_rows(held, velocities),
    }
    write_tables(out / "edges.csv", tables)
    folders = [out] + ([page.parent / "figures"] if page else [])
    for folder in folders:
        prefix = "" if folder == out else "edges-"
        pictures.led(fast, late, folder / f"{prefix}led.png")
        pictures.gripped(held, folder / f"{prefix}gripped.png")
    if page is not None:
        write_page(tables, page)


if __name__ == "__main__":
    program(main, no_limits="leave the critical velocities out")
