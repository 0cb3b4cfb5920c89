"""python -m validation.published.pencilling [CASE ...] [--edge free] [--out FOLDER] [--page docs/reports/pencilling.md]

The runs of thesis Table 6-2 before the block of Table 6-1, and the bare block. Writes pencilling.csv, depths.png and
craters.png, and keeps each shot in shots/, so that --resume goes on with those that are missing. With --page the
table goes into that page, between the marks of its edges, the pictures beside it.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError, UnstableError
from validation.program import program, write_csv
from validation.published.pencilling import pictures
from validation.published.pencilling.study import CASES, Case, bare, shoot
from weavecell.report.marked_page import markdown, put

END = "<!-- end of the table -->"
BARE, TEXT = "bare block", "4 plies, 924 g/m²"
SHOTS = "shots"


def name_of(number: int) -> str:
    """A case in words."""
    case = CASES[number]
    plies = "1 ply" if case.plies == 1 else f"{case.plies} plies"
    return f"{number}: {plies}, {96 * case.modulus:.0f} GPa, {1e3 * case.mass:.0f} g/m²"


def key_of(case: Any, edge: str, elements: int) -> str:
    """Key of a shot; `case` None is the bare block, whose shot does not depend on the options."""
    inputs = "bare" if case is None else (case, edge, elements)
    return run_cache.key(inputs, "validation.published.pencilling.study")


def table(shots: Any) -> list[Any]:
    """A header, and a row a shot."""
    rows = [("target", "outcome", "after, µs", "depth of the projectile, mm", "crater, mm", "half-width, mm",
             "wall against the face, deg", "hexahedra eroded", "energy error, %",
             "hourglass of the block, %")]  # fmt: skip
    for name, shot in shots.items():
        eroded = "-" if shot.block is None else str(int(shot.block.gone.sum()))
        glass = shot.energies.get("backing_hourglass", shot.energies.get("hourglass"))
        lost = shot.energies.get("kinetic_projectile", shot.energies.get("projectile"))
        rows.append((
            name, shot.outcome, f"{1e6 * shot.t[-1]:.0f}", f"{1e3 * shot.depth:.1f}", f"{1e3 * shot.crater_depth:.1f}",
            f"{1e3 * shot.half_width:.1f}", f"{np.degrees(shot.steepness):.0f}", eroded, f"{100 * shot.balance:.2f}",
            f"{100 * float(glass[-1]) / float(lost[0] - lost[-1]):.1f}",
        ))  # fmt: skip
    return rows


def write_page(rows: Sequence[Sequence[str]], page: Path, edge: str) -> None:
    """Put the table between its marks of a page."""
    put(page, f"<!-- table of validation.published.pencilling, {edge} edges -->", END, f"\n\n{markdown(rows)}\n")


def main(
    cases: Sequence[int] = (4, 5, 2, 1, 3),
    *,
    edge: Literal["clamped", "free"] = "clamped",
    elements: int = 2,
    no_bare: bool = False,
    text: bool = False,
    resume: bool = False,
    out: Path = Path("results/pencilling"),
    page: Path | None = None,
) -> None:
    if unknown := [number for number in cases if number not in CASES]:
        raise InputError(key="CASE", value=unknown[0], allowed=f"one of {', '.join(map(str, CASES))}")
    kept = run_cache.RunCache(out / SHOTS)
    if not resume:
        kept.clear()
    wanted = {name_of(n): CASES[n] for n in cases}
    if text:
        wanted[TEXT] = Case(4, 1.0, 0.924)
    if not no_bare:
        wanted[BARE] = None
    shots, problem = {}, None
    for name, case in wanted.items():
        key = key_of(case, edge, elements)
        if key in kept:
            shots[name] = kept[key]
            continue
        begun = time.perf_counter()
        try:
            shots[name] = bare() if case is None else shoot(case, edge=edge, elements=elements)
        except UnstableError as found:
            problem = found
            print(f"{name}: {found}", flush=True)
            continue
        shot = shots[name]
        print(
            f"{name}: {shot.outcome}, {1e3 * shot.depth:.1f} mm after {1e6 * shot.t[-1]:.0f} µs, "
            f"balance {100 * shot.balance:.2f} %, {time.perf_counter() - begun:.0f} s",
            flush=True,
        )
        kept[key] = shot
    if not shots:
        raise problem
    shots = {name: shots[name] for name in sorted(shots)}
    rows = table(shots)
    write_csv(out / "pencilling.csv", rows)
    for folder in [out] + ([page.parent / "figures"] if page else []):
        prefix = "" if folder == out else {"clamped": "pencilling-", "free": "pencilling-free-"}[edge]
        pictures.depths(shots, folder / f"{prefix}depths.png")
        pictures.craters(shots, folder / f"{prefix}craters.png")
    if page is not None:
        write_page(rows, page, edge)
    if problem is not None:
        raise problem


if __name__ == "__main__":
    program(
        main,
        elements="along each side of a crossover",
        no_bare="leave the bare block out",
        text="also four plies of 924 g/m², as the text has it",
        resume="take shots of this code that are done from the folder",
    )
