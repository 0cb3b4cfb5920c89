"""python -m validation.buet_gautier [--out results/biaxial] [FABRIC ...]: curves as CSV and PNG."""

import argparse
import csv
import sys
from pathlib import Path

from fabrics import catalogue
from fabrics.errors import WeavecellError
from fabrics.files import write_whole
from validation.buet_gautier.curves import curves
from validation.buet_gautier.pictures import picture


def write_csv(results, path):
    """One row a sample: test, strains, tensions."""
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow(["test", "warp strain", "weft strain", "warp tension N", "weft tension N"])
        for curve in results:
            for strain, tension in zip(curve.strain, curve.tension):
                rows.writerow([curve.label, *(f"{value:.6g}" for value in (*strain, *tension))])


def main():
    parser = argparse.ArgumentParser(prog="python -m validation.buet_gautier", description=__doc__)
    parser.add_argument("fabrics", nargs="*", default=["glass-balanced", "glass-unbalanced"], metavar="FABRIC")
    parser.add_argument("--out", type=Path, default=Path("results/biaxial"))
    options = parser.parse_args()
    for name in options.fabrics:
        fabric = catalogue.load(name)
        results = curves(fabric)
        write_csv(results, options.out / f"{fabric.name}.csv")
        picture(fabric, results, options.out / f"{fabric.name}.png")
        for curve in results:
            warp, weft = curve.tension[-1]
            loads = f"warp {warp:6.1f} N, weft {weft:6.1f} N"
            print(f"{fabric.name:17} {curve.label:10} ends with the {curve.failed} at {loads}")


if __name__ == "__main__":
    try:
        main()
    except WeavecellError as problem:
        print(f"error: {problem}", file=sys.stderr)
        sys.exit(problem.exit_code)
