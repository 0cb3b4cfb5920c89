"""The discretisation uncertainty of a scene's results (`weavecell impact --uncertainty`): words, summary, section."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from weavecell.analysis.discretisation import Discretisation


def summary(pair: Discretisation | None) -> dict[str, Any]:
    """For summary.json."""
    if pair is None:
        return {}
    results = {
        one.name: {"unit": one.unit, "value": one.value, "finer": one.finer, "uncertainty": one.uncertainty}
        for one in pair.intervals
    }
    meshes, outcomes = list(pair.meshes), list(pair.outcomes)
    return {"discretisation": {"meshes": meshes, "outcomes": outcomes, "results": results}}


def words(pair: Discretisation) -> str:
    """The uncertainties, one line a result."""
    found = [f"discretisation uncertainty, from {pair.meshes[0]} and {pair.meshes[1]}:"]
    if not pair.same_outcome:
        found.append(f"  the outcome depends on the mesh: {pair.outcomes[0]}, and {pair.outcomes[1]} on the finer one")
    for one in pair.intervals:
        value = f"{one.name} {one.value:.4g} +- {one.uncertainty:.2g} {one.unit}"
        found.append(f"  {value} ({one.finer:.4g} on the finer mesh)")
    return "\n".join(found)


def section(pair: Discretisation) -> Section:
    """For the report."""
    rows = tuple(
        (f"{one.name} [{one.unit}]", f"{one.value:.4g}", f"{one.finer:.4g}", f"{one.uncertainty:.2g}")
        for one in pair.intervals
    )
    lead = (
        "Uncertainty of the results on the scene's mesh by the grid convergence index of ASME V&V 20, from two meshes "
        "with an assumed order of 2 and a safety factor of 3, of the largest difference of their histories."
    )
    if not pair.same_outcome:
        lead = f"The outcome depends on the mesh: {pair.outcomes[0]} on the scene's, {pair.outcomes[1]} on the finer."
    columns = ("result", pair.meshes[0], pair.meshes[1], "uncertainty")
    tables = (Table(columns, rows, numeric=columns[1:]),) if rows else ()
    return Section("discretisation", "Discretisation uncertainty", lead, (), tables)
