"""The charts as a page of the documentation, every number and judgement in it from what was run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from validation.marked_page import markdown
from validation.verification.cost_accuracy import tables
from validation.verification.cost_accuracy.core import AIMED
from validation.verification.cost_accuracy.study import PAGE
from validation.verification.study import write_page

if TYPE_CHECKING:
    from validation.verification.cost_accuracy.core import Chart

WITHIN = 0.1, 0.05, 0.02, 0.01  # [-] errors whose least cost is listed


def write(charts: Sequence[tuple[Chart, str]], path: Path, command: str) -> None:
    """Write the page; its pictures are in figures/ beside it.

    Parameters
    ----------
    charts : pairs (core.Chart, when, where and by which version it was run)
    command : that makes it
    """
    all_charts = [chart for chart, _ in charts]
    overview = (
        "## In short",
        summary(all_charts),
        "## Cost of an error",
        PAGE["costs"],
        costs(all_charts),
        PAGE["default"],
    )
    sections = [(_section(chart), made) for chart, made in charts]
    write_page(path, PAGE, command, "case by case", overview, sections)


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
        f"## {scene.title}", scene.text, f"{picture}\n\n{PAGE['caption']}", fronts,
        tables.reference_table(chart), tables.method_table(chart),
    ]  # fmt: skip
