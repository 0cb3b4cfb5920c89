"""python -m validation.published.bias_extension [--out results/bias_extension] [--steps 20] [--elements 1] [--dynamic]

Angles of the zones as CSV, with so many elements a crossover. With --dynamic the test is run as the thesis ran it as
well: explicit, with our element and with the thesis's.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from validation.program import program, write_csv
from validation.published.bias_extension import dynamic as explicit
from validation.published.bias_extension.cases import CLOTHS, Case, run

COLUMNS = ["cloth", "elongation mm", "load N", "angle A deg", "angle B deg", "angle C deg", "not stretching C deg",
           "B less mean of A and C deg", "shear concentration", "residual", "iterations"]  # fmt: skip


def rows(case: Case) -> Iterator[list[Any]]:
    """One row a load step."""
    for k, (state, moved, load) in enumerate(zip(case.result.states, case.result.prescribed, case.result.force(1, 1))):
        A, B, C = case.means(k)
        values = (1e3 * moved, abs(load), A, B, C, case.inextensible(k), B - 0.5 * (A + C), case.concentration(k))
        yield [case.name, *(f"{value:.5g}" for value in values), f"{state.residual:.2g}", state.iterations]


def pulled(element: str, name: str) -> Iterator[list[Any]]:
    """Rows of a dynamic run."""
    run = explicit.pull(name, element=element)
    for moved, angles, concentration in zip(run.elongation, np.degrees(run.angles), run.concentration):
        A, B, C = angles
        row = [f"{value:.5g}" for value in (1e3 * moved, A, B, C, B - 0.5 * (A + C), concentration)]
        yield [element, name, *row]


def main(
    *, out: Path = Path("results/bias_extension"), steps: int = 20, elements: int = 1, dynamic: bool = False
) -> None:
    table = [COLUMNS]
    for name in CLOTHS:
        case = run(name, steps=steps, elements_per_crossover=elements)
        table += rows(case)
        print(*(table[-1] if case.problem is None else (name, case.problem)), flush=True)
    write_csv(out / "zones.csv", table)
    if dynamic:
        table = [["element", "cloth", *COLUMNS[1:2], *COLUMNS[3:6], *COLUMNS[7:9]]]
        for element in ("yarns", "one point"):
            for name in ("locking", "soft", "none"):
                table += pulled(element, name)
                print(*table[-1], flush=True)
        write_csv(out / "dynamic.csv", table)


if __name__ == "__main__":
    program(main, elements="a crossover, along each side", dynamic="explicit as well, with two elements")
