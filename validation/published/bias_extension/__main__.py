"""python -m validation.published.bias_extension [--out results/bias_extension] [--steps 20] [--elements 1] [--dynamic]

Zones as CSV and PNG, with so many elements a crossover. With --dynamic the test is run as the thesis ran it as well:
explicit, with our element and with the thesis's.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from validation.program import program, write_csv
from validation.published.bias_extension import dynamic
from validation.published.bias_extension.cases import CLOTHS, Case, asymmetry, run
from validation.published.bias_extension.pictures import picture

COLUMNS = ["cloth", "elongation mm", "load N", "angle A deg", "angle B deg", "angle C deg", "not stretching C deg",
           "B less mean of A and C deg", "shear concentration", "residual", "iterations"]  # fmt: skip


def rows(case: Case) -> Iterator[list[Any]]:
    """One row a load step."""
    for k, (state, moved, load) in enumerate(zip(case.result.states, case.result.prescribed, case.result.force(1, 1))):
        A, B, C = case.means(k)
        values = (1e3 * moved, abs(load), A, B, C, case.inextensible(k), B - 0.5 * (A + C), case.concentration(k))
        yield [case.name, *(f"{value:.5g}" for value in values), f"{state.residual:.2g}", state.iterations]


def pulled() -> Iterator[list[Any]]:
    """Rows of the dynamic runs, each printed when it ends."""
    for element in ("yarns", "one point"):
        for name in ("locking", "soft", "none"):
            run = dynamic.pull(name, element=element)
            for k, moved in enumerate(run.elongation):
                A, B, C = np.degrees(run.angles[k])
                row = [f"{value:.5g}" for value in (1e3 * moved, A, B, C, B - 0.5 * (A + C), run.concentration[k])]
                yield [element, name, *row]
            print(
                f"explicit, {element:9} {CLOTHS[name]:27} {1e3 * moved:5.2f} mm: A {A:.1f}, B {B:.1f}, C {C:.1f} deg; "
                f"concentration {run.concentration[-1]:.2f}",
                flush=True,
            )


def main(
    *, out: Path = Path("results/bias_extension"), steps: int = 20, elements: int = 1, dynamic: bool = False
) -> None:
    cases = [run(name, steps=steps, elements_per_crossover=elements) for name in CLOTHS]
    write_csv(out / "zones.csv", [COLUMNS, *(row for case in cases for row in rows(case))])
    picture(cases, out / "coupons.png")
    for case in cases:
        if case.problem is not None:
            print(f"{CLOTHS[case.name]}: {case.problem}")
            continue
        for moved in (0.005, 0.010):
            k = int(np.argmin(np.abs(case.result.prescribed - moved)))
            (A, B, C), extension = case.means(k), 1e3 * case.result.prescribed[k]
            print(
                f"{CLOTHS[case.name]:27} {extension:5.2f} mm: A {A:.1f}, B {B:.1f}, C {C:.1f} deg; "
                f"not stretching C {case.inextensible(k):.1f}; B less mean {B - 0.5 * (A + C):+.2f}; "
                f"concentration {case.concentration(k):.2f}"
            )
        print(f"{'':27} asymmetry {asymmetry(case.result):.1e} of the width")
    if dynamic:
        head = ["element", "cloth", *COLUMNS[1:2], *COLUMNS[3:6], *COLUMNS[7:9]]
        write_csv(out / "dynamic.csv", [head, *pulled()])


if __name__ == "__main__":
    program(main, elements="a crossover, along each side", dynamic="explicit as well, with two elements")
