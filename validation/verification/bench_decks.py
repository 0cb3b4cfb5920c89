"""Four shots for other codes: their decks, and what this code computes of them with its cell and with the cards' laws.

    python -m validation.verification.bench_decks [--out results/bench-decks] [--page docs/reports/cards.md]

No yarn fails in these shots. Beside the cell stand the laws of the cards, which this code runs too: the potential
nearest to the law's stresses takes the place of the cell's, tension only. Another code with the same card should
agree with that column. The uncertainty is of the mesh alone, from this mesh and one of half the side
(`weavecell.studies.mesh_uncertainty`); the decks have the coarser one.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

import weavecell as wc
from shellfabric.cell import coefficients
from shellfabric.cell.model import CellTable
from shellfabric.cell.surface_cell import potential
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactSetup
from validation.marked_page import markdown
from validation.program import program, publish
from weavecell.decks.cloth import MATCHES, Cloth
from weavecell.decks.laws import CrimpExchange, Law, UncoupledCurves
from weavecell.results import provenance
from weavecell.studies import mesh_uncertainty

END, TIMES, TABLE, FLOOR = 200e-6, (50e-6, 100e-6, 200e-6), 201, 0.05
SHOTS = {  # title: fabric, velocity [m/s], cell; those of the catalogue at three quarters of their critical velocity
    "bench": ("S-720", 100.0, "decoupled"), "S-720": ("S-720", 110.0, "compressible"),
    "S-726": ("S-726", 90.0, "compressible"), "S-728": ("S-728", 105.0, "compressible"),
}  # fmt: skip
LAWS: dict[str, Any] = {"curves (FORM 14)": UncoupledCurves, "LAW58": CrimpExchange}
CODES: tuple[Literal["lsdyna"], Literal["radioss"]] = "lsdyna", "radioss"
MARKS = "<!-- table of validation.verification.bench_decks -->", "<!-- end of bench_decks -->"


def setup_of(name: str) -> ImpactSetup:
    """The set-up of a shot: 3 g, flat cylinder of 5.5 mm, 203 mm clamped, one element per crossover."""
    fabric, velocity, cell = SHOTS[name]
    options: Any = {"cell_model": cell, "elements_per_crossover": 1, "end_time": END, "yarn_failure": False}
    return wc.setup(fabric, velocity, **options)


def card_table(setup: ImpactSetup, law: Law) -> CellTable:
    """A card's law in place of the cell: its nominal stresses over the range of the cell, none below 0."""
    model: Any = setup.cell()
    x, y = (coefficients.grid(low, high, TABLE) for low, high in model.range())
    N = np.maximum(law.stress(*np.meshgrid(x, y, indexing="ij")), 0.0) / Cloth(model).smear[:, None, None]
    per = [2 * w * (axis[1] - axis[0]) for w, axis in zip(model.fabric.weave.w, (x, y))]
    floor = np.array([FLOOR * p * yarn.strength for p, yarn in zip(per, model.fabric.weave.yarns)])
    W, fx, fy, residual = potential(N[0] * per[0], N[1] * per[1], floor, np.ones_like(N[0]))
    values = {"T1": N[0], "T2": N[1], "W": W, "N1": fx / per[0], "N2": fy / per[1]}
    # no contact force between yarns: that is not in the law
    return CellTable.of(replace(model, model="decoupled"), x, y, values, fx, fy, residual)


def numbers(result: Any) -> list[float]:
    """Velocity at TIMES [m/s], largest deflection [mm], peak tensions of warp and weft [N] of a shot."""
    return [*np.interp(TIMES, result.t, result.v), 1e3 * result.max_deflection, *result.peak_tension]


def row_names() -> list[str]:
    """The quantities of `numbers`."""
    velocities = [f"velocity at {1e6 * t:.0f} µs, m/s" for t in TIMES]
    return [*velocities, "largest deflection, mm", "peak tension of the warp, N", "peak tension of the weft, N"]


def rows_of(name: str) -> list[list[str]]:
    """Rows of the table of a shot."""
    setup = setup_of(name)
    table = setup.table()
    found = [simulation.run(setup, table=table), simulation.run(mesh_uncertainty.finer(setup, table), table=table)]
    model: Any = setup.cell()
    cloth = Cloth(model)
    for law in LAWS.values():
        found += [simulation.run(setup, table=card_table(setup, law.of(cloth, match))) for match in MATCHES]
    fabric, velocity, cell = SHOTS[name]
    title = f"{fabric}{', decoupled' * (cell == 'decoupled')}, {velocity:g} m/s"
    return [
        [title if k == 0 else "", words, f"{values[0]:.4g}",
         f"{mesh_uncertainty.index(abs(values[1] - values[0])):.2g}", *(f"{value:.4g}" for value in values[2:])]
        for k, (words, values) in enumerate(zip(row_names(), zip(*map(numbers, found))))
    ]  # fmt: skip


def main(*, out: Path = Path("results/bench-decks"), page: Path | None = None) -> None:
    heads = [f"{law}, {match}" for law in LAWS for match in MATCHES]
    table = [["shot", "quantity", "cell", "uncertainty of the mesh", *heads]]
    for name in SHOTS:
        table += rows_of(name)
        for to in CODES:
            wc.export(setup_of(name), to, out / to / name)
    made = f"Made by `python -m validation.verification.bench_decks`, commit {provenance.stamp()['commit']}."
    publish(markdown(table), page, MARKS, f"\n{made}\n\n")


if __name__ == "__main__":
    program(main)
