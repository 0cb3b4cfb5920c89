"""python -m validation.published.biaxial_glass [--out results/biaxial] [--profile P] [--toe STRAIN] [FABRIC ...]

Curves as CSV and PNG. With --options also what each option of the cell changes, as CSV, PNG and a table (`options`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from fabrics import catalogue
from meshing.pictures_style import BLUE, FAINT, GREEN, RED
from validation.marked_page import markdown
from validation.program import program, save, write_csv
from validation.published.biaxial_glass import options as studied
from validation.published.biaxial_glass.curves import TOE, curves, toe_of

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


def write_curves(results: Any, path: Path) -> None:
    """One row a sample: test, strains, tensions."""
    rows = [["test", "warp strain", "weft strain", "warp tension N", "weft tension N"]]
    for curve in results:
        for strain, tension in zip(curve.strain, curve.tension):
            rows.append([curve.label, *(f"{value:.6g}" for value in (*strain, *tension))])
    write_csv(path, rows)


COLOURS = {"k = 0.5": BLUE, "k = 1": GREEN, "k = 2": RED, "free weft": FAINT, "free warp": FAINT}


def picture(pyplot: Any, fabric: Fabric, curves: Any) -> Any:
    """Draw the curves of one weave; a cross marks the failure of the yarn."""
    figure, axes = pyplot.subplots(1, 2, figsize=(10.4, 4.6))
    for index, (axis, direction) in enumerate(zip(axes, ("warp", "weft"))):
        for curve in curves:
            if curve.label == f"free {direction}":
                continue
            x, y = 100 * curve.strain[:, index], curve.tension[:, index]
            style = {"color": COLOURS[curve.label], "linestyle": "--" if "free" in curve.label else "-"}
            label = "cross yarns free" if "free" in curve.label else curve.label
            axis.plot(x, y, label=label, **style)
            if curve.failed == direction:
                axis.plot(x[-1], y[-1], "x", color=style["color"], markersize=9, markeredgewidth=2)
        axis.set(xlabel=f"{direction} strain [%]", title=f"{fabric.name}, {direction}", xlim=(0, None))
        axis.set_ylim(bottom=0)
    axes[0].set_ylabel("tension per yarn [N]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4,
                  title="warp strain / weft strain (x: the yarn fails)")  # fmt: skip
    return figure


def study(fabric: Fabric, toe: Any, out: Path) -> None:
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
    save(studied.chart, fabric, same, to=out / f"{fabric.name}-options.png")
    for constants, found in rows.items():
        print(f"\n{fabric.name}, constants: {constants}; rms N (of the strength), largest N\n")
        print(studied.table(found))
    laws, residuals = laws | {studied.TAKEN: wrong_law}, residuals | {studied.TAKEN: wrong_residual}
    fits = [["variant", "a, mm", "b, mm uN^(1/3)", "rms at k = 1 over the strength"]]
    for name, law in laws.items():
        fits.append([name, f"{1e3 * law.a:.4f}", f"{1e5 * law.b:.2f}", f"{100 * residuals[name]:.2f} %"])
    print(markdown(fits))


def main(
    fabrics: Sequence[str] = ("glass-balanced", "glass-unbalanced"),
    *,
    profile: Literal["cosine", "straight"] = "cosine",
    toe: str = "0",
    options: bool = False,
    out: Path = Path("results/biaxial"),
) -> None:
    slack = toe_of(toe)
    for name in fabrics:
        fabric = catalogue.load(name)
        results = curves(fabric, profile=profile, toe=slack)
        write_curves(results, out / f"{fabric.name}.csv")
        save(picture, fabric, results, to=out / f"{fabric.name}.png")
        for curve in results:
            warp, weft = curve.tension[-1]
            loads = f"warp {warp:6.1f} N, weft {weft:6.1f} N"
            print(f"{fabric.name:17} {curve.label:10} ends with the {curve.failed} at {loads}")
        if options:
            study(fabric, slack or studied.TOE, out)


if __name__ == "__main__":
    program(
        main,
        profile="of the yarns",
        toe=TOE,
        options="what the toe (0.1 % if none is given), straight segments and both change",
    )
