"""python -m validation.published.platen [--out results/platen] [--page docs/reports/platens.md] [--jobs N]

S-720 between platens with the published solid constants: what each modelling choice changes, one at a time (thesis
section 3.4.3.2). Writes platen.csv and platen.png. With --page the tables go into that page, the picture beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from validation.program import program, write_tables
from validation.published.platen import pictures, study
from validation.published.platen.study import Outcome
from weavecell.report.marked_page import markdown, put

MARKS = "<!-- tables of validation.published.platen -->", "<!-- end of the tables -->"
HEAD = (
    "factor", "variant", "Vf0 of the mesh", "misfit of closure, µm", "misfit of pressure, %",
    "closure below 1 MPa, µm", "closure above 1 MPa, µm",
)  # fmt: skip


def closures(pressure: FloatArray, law: FloatArray) -> tuple[float, float]:
    """[m] closures of the law below and above `study.PACKING`."""
    loose = float(np.interp(np.log(study.PACKING), np.log(pressure), law))
    return loose, float(law[-1]) - loose


def factor_rows(outcomes: Sequence[Outcome], law: FloatArray) -> list[Any]:
    """A header, the law, and a row a variant."""
    loose, packed = closures(outcomes[0].pressure, law)
    rows = [HEAD, ("", "**platen law**", "", "", "", f"{1e6 * loose:.1f}", f"{1e6 * packed:.1f}")]
    for each in outcomes:
        failed = f" (ended early: {each.failed})" if each.failed else ""
        rows.append((
            each.variant.group, each.variant.name + failed, " / ".join(f"{value:.3f}" for value in each.Vf0),
            f"{1e6 * each.closure_rms:.1f}", f"{100 * each.pressure_rms:.0f}", f"{1e6 * each.loose:.1f}",
            f"{1e6 * each.packed:.1f}",
        ))  # fmt: skip
    return rows


def range_rows(ranges: Sequence[tuple[float, ...]]) -> list[Any]:
    """A header, and a row for each range of pressures."""
    rows = [("pressures from, MPa", "misfit of closure, µm", "misfit of pressure, %")]
    return rows + [(f"{1e-6 * P:.3f}", f"{1e6 * closure:.1f}", f"{100 * ratio:.0f}") for P, closure, ratio in ranges]


def main(*, out: Path = Path("results/platen"), page: Path | None = None, jobs: int = 1) -> None:
    found = list(study.outcomes(jobs=jobs))
    law = study.curve(catalogue.load(study.FABRIC)).at(found[0].pressure)
    tables = {
        "**One factor at a time.**": factor_rows(found, law),
        "**Published constants, range of the comparison.**": range_rows(study.ranges()),
    }
    write_tables(out / "platen.csv", tables)
    of_law = closures(found[0].pressure, law)
    pictures.draw(found, *of_law, out / "platen.png")
    if page is not None:
        pictures.draw(found, *of_law, page.parent / "figures" / "platen-factors.png")
        parts = [f"{title}\n\n{markdown(rows)}" for title, rows in tables.items()]
        picture = "![Misfit of the pressure and closures, one factor changed at a time](figures/platen-factors.png)\n"
        put(page, *MARKS, "\n\n" + "\n".join([*parts, picture]) + "\n")


if __name__ == "__main__":
    program(main)
