"""python -m validation.published.biaxial_glass [--out results/biaxial] [--profile P] [--toe STRAIN] [FABRIC ...]

Curves as CSV and PNG. With --options also what each option of the cell changes, as CSV, PNG and a table (`options`).
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import catalogue
from fabrics.errors import run_program
from validation.program import write_csv
from validation.published.biaxial_glass import options as studied
from validation.published.biaxial_glass import pictures
from weavecell.analysis.biaxial_test.curves import curves
from weavecell.analysis.biaxial_test.options import add_options
from weavecell.report.marked_page import markdown

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


def write_curves(results: Any, path: Path) -> None:
    """One row a sample: test, strains, tensions."""
    rows = [["test", "warp strain", "weft strain", "warp tension N", "weft tension N"]]
    for curve in results:
        for strain, tension in zip(curve.strain, curve.tension):
            rows.append([curve.label, *(f"{value:.6g}" for value in (*strain, *tension))])
    write_csv(path, rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m validation.published.biaxial_glass", description=__doc__.splitlines()[2]
    )
    parser.add_argument("fabrics", nargs="*", default=["glass-balanced", "glass-unbalanced"], metavar="FABRIC")
    add_options(parser)
    parser.add_argument("--options", action="store_true", help="what the toe (0.1 %% if none is given), straight "
                        "segments and both change")  # fmt: skip
    parser.add_argument("--out", type=Path, default=Path("results/biaxial"))
    options = parser.parse_args()
    for name in options.fabrics:
        fabric = catalogue.load(name)
        results = curves(fabric, profile=options.profile, toe=options.toe)
        write_curves(results, options.out / f"{fabric.name}.csv")
        pictures.picture(fabric, results, options.out / f"{fabric.name}.png")
        for curve in results:
            warp, weft = curve.tension[-1]
            loads = f"warp {warp:6.1f} N, weft {weft:6.1f} N"
            print(f"{fabric.name:17} {curve.label:10} ends with the {curve.failed} at {loads}")
        if options.options:
            study(fabric, options.toe or studied.TOE, options.out)


def study(fabric: Fabric, toe: float, out: Path) -> None:
    """Write and print what the cell's options change."""
    same = studied.same_constants(fabric, toe)
    anew, laws, residuals = studied.fitted_anew(fabric, toe)
    wrong, wrong_law, wrong_residual = studied.mistaken(fabric, toe)
    rows = {"same": studied.differences(fabric, same), "fitted to k = 1": studied.differences(fabric, anew),
            "of a weave with a toe, fitted to its k = 1": studied.differences(fabric, wrong, "the weave")}  # fmt: skip
    table = [["constants", "variant", "test", "yarn", "rms N", "largest N", "rms over strength"]]
    for constants, found in rows.items():
        for row in found:
            values = (f"{value:.5g}" for value in (row.rms, row.largest, row.share))
            table.append([constants, row.variant, row.test, row.yarn, *values])
    write_csv(out / f"{fabric.name}-options.csv", table)
    pictures.options(fabric, same, out / f"{fabric.name}-options.png")
    for constants, found in rows.items():
        print(f"\n{fabric.name}, constants: {constants}; rms N (of the strength), largest N\n")
        print(studied.table(found))
    laws, residuals = laws | {studied.TAKEN: wrong_law}, residuals | {studied.TAKEN: wrong_residual}
    fits = [["variant", "a, mm", "b, mm uN^(1/3)", "rms at k = 1 over the strength"]]
    for name, law in laws.items():
        fits.append([name, f"{1e3 * law.a:.4f}", f"{1e5 * law.b:.2f}", f"{100 * residuals[name]:.2f} %"])
    print(markdown(fits))


if __name__ == "__main__":
    run_program(main)
