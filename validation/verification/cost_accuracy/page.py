"""The charts as a page of the documentation, every number and judgement in it from what was run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from validation.verification.cost_accuracy import tables
from validation.verification.cost_accuracy.core import AIMED
from validation.verification.study import write_page
from weavecell.report.marked_page import markdown

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Chart

TITLE = "Cost against error of the methods"
QUESTION = "Which method and mesh reach a given error at the least CPU time, and how far is the default from them?"
TEXT = """\
Each standard case is solved by every method of the project. The error of a method is the largest of the errors in its
quantities, against the limit to which the meshes of the case extrapolate. Beside it stands how well that limit is known
(scatter of the extrapolation, a quarter of its step beyond the finest mesh, and the effect of a finer table, time step
or tolerance). Errors inside that band are equal: of those the cheapest counts. Cost is CPU time of one thread from the
data of the case to the answer, with the filling of the cell's table, after compilation; the median of up to five runs,
one where it took more than 0.6 s. A more expensive method is listed only if it reduces the error by 10 %.

The error is numerical, not physical: the reference is the compressible cell in its variational form with the
regularised law. Another cell or form is another model, whose distance from the reference the chart shows.

Names of methods: "table 51" is a table of the cell with 51 stretches on each side (201 by default); "graded from
1/2 crossover" is a mesh whose elements are half a crossover long about the impact point and longer outside;
"printed law" and "equilibrium form" are the compression law and the cell of the thesis; "half" and "whole" are the
part of the panel."""

CAPTION = f"""\
*Filled: the default, the cheapest method within {100 * AIMED:g} % and the most accurate one. Circles: all other
methods. Errors inside the shaded band are equal; of those the cheapest method is marked.*"""
WITHIN = 0.1, 0.05, 0.02, 0.01  # [-] errors whose least cost is listed
COSTS = """The cheapest method whose error is at most the one in the heading, and the methods that dominate the default:
those that cost less and whose error is no larger, or within what the reference is known to."""

DEFAULT = """\
"default of version 0.2" is the default before tables of cells were filled by Newton's method, of coupons before
their tolerance was 1e-3, of the struck yarn before its Courant factor was 0.8. In the cases of one ply, meshes that
are graded from 1/1 crossover dominate the default, a uniform mesh of one element per crossover: they give the same
errors at less cost. They are not the default because they are further off in other cases, such as fast shots at
S-745 and at a pack of S-731 ([graded.md](graded.md), "Instead of the uniform mesh"). A graded panel also records
less of its outer region (histories along yarns, snapshots and failed segments are those of its longer elements),
cannot have edges held by friction or sliding crossovers, and ends the run where a projectile slides out of the fine
region. With `[accuracy]` an input file leaves the choice of the mesh to the code ([fidelity.md](fidelity.md)).
Coupons keep their load steps, which are the points of the recorded curve, and the 3D crossover keeps its load step
of 10 %, since the compression law is fitted to points interpolated between load steps: longer ones save less than a
tenth of the cost and change the law."""


def write(charts: Sequence[tuple[Chart, str]], path: Path, command: str) -> None:
    """Write the page; its pictures are in figures/ beside it.

    Parameters
    ----------
    charts : pairs (core.Chart, when, where and by which version it was run)
    command : that makes it
    """
    all_charts = [chart for chart, _ in charts]
    overview = "## In short", summary(all_charts), "## Cost of an error", COSTS, costs(all_charts), DEFAULT
    sections = [(_section(chart), made) for chart, made in charts]
    write_page(path, TITLE, QUESTION, TEXT, command, "case by case", overview, sections)


def summary(charts: list[Chart]) -> str:
    """One row a scene and group: default, cheapest within 5 %, and lowest error."""
    rows = []
    for chart in charts:
        for group, quantities in chart.scene.groups.items():
            front, first = chart.fronts[group], chart.entries[0]
            good = [entry for entry in front if entry.worst(quantities) <= AIMED]
            rows.append([
                chart.scene.title, group, _as_text(first, quantities, name=False),
                _as_text(good[0], quantities) if good else "none", _as_text(front[-1], quantities),
                f"{100 * chart.unsure(group):.2g}",
            ])  # fmt: skip
    cheapest = f"cheapest within {100 * AIMED:g} %"
    head = ["case", "quantities", "the default", cheapest, "lowest error", "reference known to ± [%]"]
    return markdown([head, *rows])


def costs(charts: Sequence[Chart]) -> str:
    """One row a scene and group: the cheapest method within each of WITHIN, and what dominates the default."""
    rows = []
    for chart in charts:
        for group, quantities in chart.scene.groups.items():
            known, first = chart.unsure(group), chart.entries[0]
            by_cost = sorted(chart.entries, key=lambda entry: entry.sample.cpu)
            cheapest = [next((e for e in by_cost if e.worst(quantities) <= error), None) for error in WITHIN]
            least = max(first.worst(quantities), known)
            better = [
                entry.method.name
                for entry in chart.fronts[group]
                if entry.sample.cpu < first.sample.cpu and max(entry.worst(quantities), known) <= least
            ]
            texts = ("not reached" if entry is None else _as_text(entry, quantities) for entry in cheapest)
            rows.append([chart.scene.title, group, *texts, "; ".join(better) or "none"])
    heads = (f"error of {100 * error:g} %" for error in WITHIN)
    return markdown([["case", "quantities", *heads, "the default is dominated by"], *rows])


def _as_text(entry, quantities, name=True):
    cost = f"{entry.sample.cpu:.2g} s, {100 * entry.worst(quantities):.2g} %"
    return f"{entry.method.name} ({cost})" if name else cost


def _section(chart):
    scene = chart.scene
    fronts = "\n".join(
        f"- **{group}**: Pareto-optimal, from the cheapest to the lowest error: "
        + "; ".join(_as_text(entry, scene.groups[group]) for entry in front)
        + "."
        for group, front in chart.fronts.items()
    )
    picture = f"![CPU time and largest error of each method, {scene.title}](figures/chart-{scene.key}.png)"
    return [
        f"## {scene.title}", scene.text, f"{picture}\n\n{CAPTION}", fronts,
        tables.reference_table(chart), tables.method_table(chart),
    ]  # fmt: skip
