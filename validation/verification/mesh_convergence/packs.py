"""Convergence of packs of four plies with the mesh.

    python -m validation.verification.mesh_convergence.packs [FABRIC ...] [--out FOLDER] [--page docs/convergence.md]

The mesh of level n has elements with sides of 1/n crossover to f crossovers from the impact point, all that can come
under the nose, then of one crossover to 2 f, and of two beyond. All levels share the outer mesh. A shot that is stopped
gives the highest tensions of warp and weft in any ply, a fast one its residual velocity and absorbed energy. Limit,
order and uncertainty are those of one ply (`study`). Runs are kept in the folder.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import ceil, inf
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics import catalogue, run_cache
from fabrics.errors import InputError, run_program
from shellfabric.impact.ballistic_limit import UNDECIDED
from shellfabric.impact.single_ply import ImpactSetup
from shellfabric.panel.numerics import Numerics
from shellfabric.plies.model import Pack
from shellfabric.plies.solver import PackSolver
from validation.verification.mesh_convergence.study import LEVELS, Quantity, quantity
from validation.verification.mesh_convergence.tables import counts, table
from weavecell.report.marked_page import put
from weavecell.results import provenance

if TYPE_CHECKING:
    from shellfabric.panel.model import Panel

PLIES, LEAST = 4, 10  # LEAST [crossovers] of the first zone
# [m/s] a shot that the thesis captions as stopped by four plies, and one well above the critical velocity of all meshes
STRIKES = {"S-726": (158.0, 300.0), "S-728": (91.0, 300.0), "S-731": (136.0, 400.0)}
MARKS = "<!-- table of mesh_convergence.packs -->", "<!-- end of packs -->"


@cache
def _uniform(name: str) -> Panel:
    fabric = catalogue.load(name).with_effective_density()
    setup = ImpactSetup(fabric, 100.0, elements_per_crossover=1, numerics=Numerics(threads=1))
    return setup.panel(setup.table())


def ply(name: str, level: int) -> Panel:
    """The first ply on the mesh of a level."""
    panel = _uniform(name)
    first = max(LEAST, *(ceil(far / step) + 1 for far, step in zip(panel.reach(), panel.spacing)))
    inner = ((first, 1 / level),) if level > 1 else ()
    return replace(panel, grading=(*inner, (2 * first, 1), (inf, 2)))


def shot(name: str, level: int, velocity: float) -> tuple[str, float, float, float, float, int, float]:
    """(outcome, residual velocity [m/s], absorbed energy [J], peak tension of the warp, of the weft [N], elements,
    error of the energy balance [-]) of a pack."""
    pack = Pack.stacked(ply(name, level), PLIES)
    solver = PackSolver(pack, velocity, UNDECIDED, interval=10e-6).run()
    left, (warp, weft) = float(solver.sample("v")[-1]), solver.peaks.max(axis=0)
    left = 0.0 if solver.outcome == "stopped" else left
    absorbed = 0.5 * pack.plies[0].projectile.mass * (velocity**2 - left**2)
    error = float(abs(solver.sample("error")).max()) / solver.strike_energy
    return solver.outcome, left, absorbed, float(warp), float(weft), PLIES * pack.plies[0].elements, error


def quantities(name: str, levels: Sequence[int], rows: Sequence[tuple]) -> list[Quantity]:
    """The quantities of a fabric, from the rows of the shots: those that are stopped at all levels, then the others.

    Raises
    ------
    InputError : a shot of another outcome on one of the meshes
    """
    stops, fast = STRIKES[name]
    slow, through = rows[: len(levels)], rows[len(levels) :]
    for found, velocity, outcome in ((slow, stops, "stopped"), (through, fast, "perforated")):
        other = [f"{row[0]} at level {n}" for n, row in zip(levels, found) if row[0] != outcome]
        if other:
            raise InputError(f"{name}: {', '.join(other)}", key="velocity", value=velocity, allowed=f"{outcome} on all")
    return [
        quantity(name, f"{what} at {V:.0f} m/s", unit, levels, [row[k] for row in found])
        for what, unit, found, k, V in (
            ("residual velocity", "m/s", through, 1, fast), ("absorbed energy", "J", through, 2, fast),
            ("peak tension of the warp", "N", slow, 3, stops), ("peak tension of the weft", "N", slow, 4, stops),
        )
    ]  # fmt: skip


def main() -> None:
    name = "python -m validation.verification.mesh_convergence.packs"
    parser = argparse.ArgumentParser(prog=name, description=__doc__.splitlines()[0])
    parser.add_argument("fabrics", nargs="*", default=list(STRIKES), metavar="FABRIC")
    parser.add_argument("--elements", nargs="+", type=int, default=list(LEVELS), metavar="N")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("results/convergence-packs"))
    parser.add_argument("--page", type=Path, help="put the tables into this page")
    options = parser.parse_args()
    unknown = [fabric for fabric in options.fabrics if fabric not in STRIKES]
    if unknown:
        raise InputError(key="FABRIC", value=unknown[0], allowed=f"one of {', '.join(STRIKES)}")
    found: list[Quantity] = []
    sizes: list[str] = []
    errors: list[float] = []
    for fabric in options.fabrics:
        places = [(fabric, n, V) for V in STRIKES[fabric] for n in options.elements]
        rows = run_cache.results(shot, places, folder=options.out, jobs=options.jobs)
        found += quantities(fabric, options.elements, rows)
        sizes.append(f"{fabric} {', '.join(str(row[5]) for row in rows[: len(options.elements)])}")
        errors += [row[6] for row in rows]
    text = (
        f"{counts(found)}\n{table(found)}\nElements of the modelled quarter: {'; '.join(sizes)}. Error of the energy "
    )
    text += f"balance at most {100 * max(errors):.2g} % of the strike energy.\n"
    print(text)
    if options.page is not None:
        put(options.page, *MARKS, f"\n\n{text}\nMade by `{name}`, commit {provenance.stamp()['commit']}.\n\n")


if __name__ == "__main__":
    run_program(main)
