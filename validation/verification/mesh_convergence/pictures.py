"""Picture of the study: each quantity over its limit against the size of the elements, one panel a quantity.

    python -m validation.verification.mesh_convergence.pictures docs/reports/data/convergence.csv FIGURE.png

draws it from the table of an earlier study.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from meshing.pictures_style import COLOURS, FAINT
from validation.program import program, save
from validation.verification.mesh_convergence.study import FACTORS, TARGETS

if TYPE_CHECKING:
    from validation.verification.mesh_convergence.study import Quantity

MARKERS = ("o", "s", "^", "D", "v", "P")


def compose(pyplot: Any, quantities: Sequence[Quantity]) -> Any:
    """Deviation of every fabric from its own limit, one panel a quantity; hollow where the limit is no Richardson
    extrapolation. The scale is linear within the target and logarithmic beyond."""
    kind = {id(entry): entry.name.partition(" at ")[0] for entry in quantities}
    ranks = [_rank(entry, quantities) for entry in quantities if entry.fabric == quantities[0].fabric]
    fabrics = list(dict.fromkeys(entry.fabric for entry in quantities))
    figure, grid = pyplot.subplots(2, 4, figsize=(13, 8), squeeze=False)
    for axes, (name, rank) in zip(grid.flat, ranks):
        chosen = [entry for entry in quantities if _rank(entry, quantities) == (name, rank)]
        target = 100 * TARGETS[chosen[0].unit]
        axes.axhspan(-target, target, color="#e8eef4", lw=0)
        for entry in chosen:
            k = fabrics.index(entry.fabric)
            regular = entry.extrapolation.basis in ("Richardson", "no change")
            axes.plot(
                1 / np.array(entry.elements), 100 * np.array(entry.deviations), color=COLOURS[k % 6],
                marker=MARKERS[k % 6], ms=6, lw=1.6, label=entry.fabric, clip_on=False, ls="-" if regular else "--",
                mfc=COLOURS[k % 6] if regular else "white",
            )  # fmt: skip
        axes.axhline(0, color=FAINT, lw=0.8)
        factor = f"\nat {FACTORS[rank]} × critical velocity" if rank >= 0 else "\n"
        axes.set_title(kind[id(chosen[0])] + factor, fontsize=11)
        axes.set_yscale("symlog", linthresh=target)
        axes.set_ylim(-100, 100)
        axes.set_yticks([-100, -10, -target, 0, target, 10, 100], labels=[f"{tick:g}" for tick in
                        (-100, -10, -target, 0, target, 10, 100)])  # fmt: skip
        axes.set_xlim(0, 1.09)
        axes.set_xticks([1 / n for n in chosen[0].elements], [str(n) for n in chosen[0].elements])
    for axes in grid.flat[len(ranks) :]:
        axes.axis("off")
    for axes in grid[:, 0]:
        axes.set_ylabel("deviation from the limit [%]")
    for axes in grid.flat[: len(ranks)]:
        axes.set_xlabel("elements per crossover", fontsize=11)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=6,
                  title="shaded: target; dashed, open: limit by least squares, no regular order")  # fmt: skip
    return figure


def _rank(entry, quantities):
    """(kind of quantity, how many of the same fabric and kind precede it; -1 where it is alone)."""
    kind = entry.name.partition(" at ")[0]
    alike = [one for one in quantities if one.fabric == entry.fabric and one.name.partition(" at ")[0] == kind]
    return kind, (-1 if len(alike) == 1 else [one.name for one in alike].index(entry.name))


def read(path: Path) -> list[Any]:
    """What `compose` needs of each quantity in the convergence.csv of a study."""
    found = []
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            names = [name for name in row if name.endswith(" per crossover")]
            limit = float(row["limit"])
            found.append(SimpleNamespace(
                fabric=row["fabric"], name=row["quantity"], unit=row["unit"],
                elements=[int(name.split()[0]) for name in names],
                deviations=[float(row[name]) / limit - 1 for name in names],
                extrapolation=SimpleNamespace(basis=row["basis"]),
            ))  # fmt: skip
    return found


def main(table: Path, figure: Path) -> None:
    save(compose, read(table), to=figure)


if __name__ == "__main__":
    program(main, table="convergence.csv of a study", figure="to write, a PNG")
