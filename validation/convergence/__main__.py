"""python -m validation.convergence [FABRIC ...] [--out results/convergence] [--figure docs/figures/convergence.png]

Writes convergence.csv and convergence.png: critical velocity and peak tensions with 1, 2, 3 elements a crossover, the
limit that they extrapolate to, and the order observed.
"""

import argparse
import csv
import sys
from pathlib import Path

from fabrics import catalogue
from fabrics.errors import InputError, WeavecellError
from fabrics.files import write_whole
from validation.convergence.pictures import picture
from validation.convergence.study import TOLERANCE, study, velocities


def write_csv(quantities, path):
    """One row a fabric and quantity."""
    elements = quantities[0].elements
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow([
            "fabric", "quantity", "unit", *(f"{n} a crossover" for n in elements), "limit", "observed order", "basis",
            "remark", "scatter", *(f"{n} a crossover, deviation %" for n in elements), "as asked",
        ])  # fmt: skip
        for entry in quantities:
            found = entry.extrapolation
            rows.writerow([
                entry.fabric, entry.name, entry.unit, *(f"{value:.4f}" for value in entry.values),
                f"{found.limit:.4f}", "" if found.order is None else f"{found.order:.2f}", found.basis, found.remark,
                f"{found.scatter:.4f}", *(f"{100 * value:+.2f}" for value in entry.deviations),
                "yes" if entry.met else "no",
            ])  # fmt: skip


def tell(entry):
    """One line a quantity."""
    values = "  ".join(f"{value:7.2f}" for value in entry.values)
    deviations = "  ".join(f"{100 * value:+5.2f}" for value in entry.deviations)
    found = entry.extrapolation
    why = f" ({found.remark})" if found.remark else f" {found.order:.2f}"
    missed = "" if entry.met else "  NOT AS ASKED"
    print(f"{entry.fabric:6} {entry.name:18} {values} -> {found.limit:7.2f} {entry.unit:4} ", end="")
    print(f"deviations {deviations} %  {found.basis}{why}{missed}", flush=True)


def main():
    speeds = velocities()
    parser = argparse.ArgumentParser(prog="python -m validation.convergence", description=__doc__.splitlines()[2])
    parser.add_argument("fabrics", nargs="*", default=list(speeds), metavar="FABRIC")
    parser.add_argument("--elements", nargs="+", type=int, default=[1, 2, 3], metavar="N")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="of the critical velocity, m/s")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("results/convergence"))
    parser.add_argument("--figure", type=Path, help="also write the picture here")
    options = parser.parse_args()
    unknown = [name for name in options.fabrics if name not in speeds]
    if unknown:
        raise InputError(key="FABRIC", value=unknown[0], allowed=f"one of {', '.join(speeds)}")
    quantities = []
    for name in options.fabrics:
        fabric = catalogue.load(name).effective()
        found = study(
            fabric, speeds[name], elements=options.elements, tolerance=options.tolerance, workers=options.workers
        )
        quantities += found
        for entry in found:
            tell(entry)
        write_csv(quantities, options.out / "convergence.csv")  # after each fabric: the fine meshes take minutes
    for path in filter(None, (options.out / "convergence.png", options.figure)):
        picture(quantities, path)


if __name__ == "__main__":
    try:
        main()
    except WeavecellError as problem:
        print(f"error: {problem}", file=sys.stderr)
        sys.exit(problem.exit_code)
