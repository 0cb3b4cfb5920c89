"""What the options of the cell change in the biaxial curves: the toe of the yarns, their straight segments, and both.

The thesis names both as causes of its misfit (section 5.3): the tests on single glass yarns are not linear at low
strain, and straight segments suit open weaves better than a cosine. Held against the thesis's own cell, at the same
strains, in two ways:

- with the same constants a and b, which shows what the option itself does;
- with a and b fitted anew to the k = 1 curve of the thesis's cell, which stands in for the test that the thesis fitted.
  What then is left at k = 0.5 and 2 is what the option would change in the thesis's predictions.

And the other way round, as the thesis has it: a weave whose yarns have a toe and the fabric's constants, to whose
k = 1 curve a and b are fitted as if its yarns were linear.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FloatArray
from fabrics.compression import CompressionLaw
from meshing.pictures_style import BLUE, INK, PURPLE, RED
from shellfabric.cell.model import CellModel
from validation.marked_page import markdown
from validation.published.biaxial_glass import fit
from validation.published.biaxial_glass.curves import RATIOS, Curve, at_ratio, curves
from validation.published.biaxial_glass.measured import Test

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

BASE = "cosine, linear yarns"
TAKEN = "taken for linear"
TOE = 1e-3  # [-] assumed: the thesis says that its yarns have one, and not how long it is
SAMPLES = 40  # of the k = 1 curve, to fit to


@dataclass(frozen=True)
class Difference:
    """Of one yarn's tension in one test from that of the thesis's cell, where both have a value.

    Parameters
    ----------
    variant, test, yarn : names
    rms, largest : [N]
    share : [-] rms over the yarn's strength
    """

    variant: str
    test: str
    yarn: str
    rms: float
    largest: float
    share: float


def variants(toe: float = TOE) -> dict[str, dict[str, Any]]:
    """{name: options of CellModel}."""
    straight = {"profile": "straight"}
    return {BASE: {}, "toe": {"toe": toe}, "straight segments": straight, "both": {"toe": toe, **straight}}


def same_constants(fabric: Fabric, toe: float = TOE) -> dict[str, list[Curve]]:
    """{variant: [Curve]} with the fabric's own constants."""
    return {name: curves(fabric, **options) for name, options in variants(toe).items()}


def fitted_anew(
    fabric: Fabric, toe: float = TOE
) -> tuple[dict[str, list[Curve]], dict[str, CompressionLaw], dict[str, float]]:
    """{variant: [Curve]} at the three ratios, {variant: CompressionLaw}, {variant: residual at k = 1 over strength}.

    The constants of each variant are fitted to the k = 1 curve of the thesis's cell.
    """
    source = at_ratio(CellModel(fabric, form="equilibrium"), 1.0, SAMPLES)
    found, laws, residuals = {}, {}, {}
    for name, options in variants(toe).items():
        laws[name], residuals[name] = fabric.laws[0], 0.0
        if name != BASE:
            done = fit.fit(fabric, Test(source.strain, source.tension), **options)
            laws[name] = CompressionLaw(done.law.a, done.law.b, provenance="fitted to the thesis's curve, k = 1")
            residuals[name] = done.residual
        cell = CellModel(fabric, (laws[name],) * 2, form="equilibrium", **options)
        found[name] = [at_ratio(cell, k) for k in RATIOS]
    return found, laws, residuals


def mistaken(fabric: Fabric, toe: float = TOE) -> tuple[dict[str, list[Curve]], CompressionLaw, float]:
    """The thesis's way with a weave whose yarns have a toe: ({name: [Curve]}, CompressionLaw, residual)."""
    weave = CellModel(fabric, form="equilibrium", toe=toe)
    truth = at_ratio(weave, 1.0, SAMPLES)
    done = fit.fit(fabric, Test(truth.strain, truth.tension))
    linear = CellModel(fabric, (done.law, done.law), form="equilibrium")
    found = {name: [at_ratio(cell, k) for k in RATIOS] for name, cell in (("the weave", weave), (TAKEN, linear))}
    return found, done.law, done.residual


def differences(fabric: Fabric, found: dict[str, list[Curve]], base_name: str = BASE) -> list[Difference]:
    """[Difference] of each variant's curves from those of the base, the thesis's cell, at the same strains."""
    rows = []
    for name, tests in found.items():
        if name == base_name:
            continue
        for base, other in zip(found[base_name], tests):
            for m, (yarn, strength) in enumerate(zip(("warp", "weft"), (y.strength for y in fabric.weave.yarns))):
                if np.isnan(base.strain[:, m]).any():
                    continue
                e = np.linspace(0, min(base.strain[-1, m], other.strain[-1, m]), 241)
                one, two = (np.interp(e, curve.strain[:, m], curve.tension[:, m]) for curve in (base, other))
                rms = float(np.sqrt(np.mean((two - one) ** 2)))
                off = float((two - one)[np.argmax(np.abs(two - one))])
                rows.append(Difference(name, base.label, yarn, rms, off, rms / strength))
    return rows


def table(rows: Any) -> str:
    """The differences in Markdown, a row a test and yarn, a column a variant: rms and largest [N], rms in %."""
    names = list(dict.fromkeys(row.variant for row in rows))
    lines = [["test", "yarn", *names]]
    for test, yarn in dict.fromkeys((row.test, row.yarn) for row in rows):
        cells = [
            f"{row.rms:.1f} ({100 * row.share:.1f} %), {row.largest:+.1f}"
            for name in names
            for row in rows
            if (row.test, row.yarn, row.variant) == (test, yarn, name)
        ]
        lines.append([test, yarn, *cells])
    return markdown(lines)


LOOKS = ((INK, "-"), (BLUE, "-"), (RED, "--"), (PURPLE, "-."))
FREE = ("free weft", "free warp")  # test in which the crossing yarns of warp and weft are free


def chart(pyplot: Any, fabric: Fabric, found: Any) -> Any:
    """What each variant of the cell, {name: [Curve]}, changes of the tension: a column a test, a row a yarn.

    The first variant is the reference. Differences at equal strain are over the largest tension of the reference.
    """
    reference, *others = found
    columns = [curve.label for curve in found[reference] if curve.label not in FREE] + ["cross yarns free"]
    figure, grid = pyplot.subplots(2, len(columns), figsize=(11.4, 5.8), sharex=True, sharey="row")
    for m, direction in enumerate(("warp", "weft")):
        for axes, column in zip(grid[m], columns):
            wanted = FREE[m] if column == columns[-1] else column
            known = {name: next(test for test in tests if test.label == wanted) for name, tests in found.items()}
            strain, tension = known[reference].strain[:, m], known[reference].tension[:, m]
            for name, (colour, dash) in zip(others, LOOKS[1:]):
                change = relative(strain, tension, known[name].strain[:, m], known[name].tension[:, m])
                axes.plot(100 * strain, 100 * change, dash, color=colour, lw=1.8, label=name)
            axes.axhline(0, color=LOOKS[0][0], lw=1)
            axes.set_title(f"{direction}, {column}", fontsize=11)
        grid[m, 0].set_ylabel("difference of tension\n[% of the largest]")
    grid[0, 0].set_xlim(left=0)  # after all is drawn: the axes are shared
    for axes in grid[1]:
        axes.set_xlabel("strain of the yarn [%]", fontsize=11)
    figure.suptitle(f'{fabric.name}: tension less that of "{reference}", same constants', fontsize=13)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def relative(strain: FloatArray, tension: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """(n,) [-] tension y at strain x less that of the reference at its strains, over the reference's largest; nan
    beyond the end of either curve."""
    order = np.argsort(x)
    other = np.interp(strain, x[order], y[order], right=np.nan)
    return (other - tension) / tension.max()
