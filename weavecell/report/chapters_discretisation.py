"""The discretisation uncertainty of a scene's results (`--uncertainty`, [accuracy]): words, summary, section."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from weavecell.report.page import Section, Table
from weavecell.results import display

if TYPE_CHECKING:
    from weavecell.studies.mesh_uncertainty import Discretisation

_INDEX = (
    "Uncertainty of the results {} by the grid convergence index of ASME V&V 20, from two meshes with an assumed order "
    "of 2 and a safety factor of 3, of the largest difference of their histories."
)


def summary(pair: Discretisation | None) -> dict[str, Any]:
    """For summary.json."""
    if pair is None:
        return {}
    other = "coarser" if pair.targets else "finer"
    results = {
        one.name: {"unit": one.unit, "value": one.value, other: one.other, "uncertainty": one.uncertainty}
        for one in pair.intervals
    }
    meshes = list(pair.meshes)
    entries: dict[str, Any] = {
        "discretisation": {"meshes": meshes, "outcomes": list(pair.outcomes), "results": results}
    }
    if pair.targets:
        entries["accuracy"] = {
            "targets": dict(pair.targets),
            "model": meshes[-1],
            "symmetry": pair.setup.symmetry,
            "projectile": pair.setup.projectile.body,
            "compared_with": "".join(meshes[-2:-1]),
            "models_run": meshes,
            "confirmed": pair.confirmed,
            "estimated_errors": {name: pair.errors.get(name) for name in pair.targets},
        }
    return entries


def words(pair: Discretisation) -> str:
    """The uncertainties, one line a result; of targets whether they are met."""
    found = [f"discretisation uncertainty, from {' and '.join(pair.meshes[-2:])}:"]
    found += [f"  {line}" for line in _outcomes(pair)]
    other = "coarser" if pair.targets else "finer"
    for one in pair.intervals:
        value = f"{one.name} {one.value:.4g} +- {one.uncertainty:.2g} {one.unit}"
        found.append(f"  {value} ({one.other:.4g} on the {other} mesh)")
    return "\n".join([*found, *_verdict(pair)])


def _outcomes(pair):
    """A line where the outcome depends on the mesh."""
    first, last = (pair.outcomes[-2:] if pair.targets else pair.outcomes)[0], pair.outcomes[-1]
    return [] if pair.same_outcome else [f"the outcome depends on the mesh: {first}, and {last} on the finer one"]


def _verdict(pair):
    """A line that says whether the targets are met."""
    if not pair.targets:
        return []
    errors = ", ".join(
        f"{name.replace('_', ' ')} {_percent(pair.errors.get(name, inf))} (target {_percent(share)})"
        for name, share in pair.targets.items()
    )
    verdict = "confirmed" if pair.confirmed else "NOT confirmed, on the finest mesh that there is"
    return [f"accuracy {verdict}: {pair.meshes[-1]}, {pair.setup.symmetry} panel; {errors}"]


def _percent(share):
    return "not known" if share == inf else display.text(share, "1", "share", ".2g")


def section(pair: Discretisation) -> Section:
    """For the report."""
    from pandas import DataFrame

    meshes, tables = pair.meshes[-1:-3:-1] if pair.targets else pair.meshes, []
    lead = " ".join(line[0].upper() + line[1:] + "." for line in (*_verdict(pair), *_outcomes(pair)))
    if pair.intervals:
        lead = f"{lead} {_INDEX.format('on the finer mesh' if pair.targets else 'on the mesh of the scene')}".strip()
        rows = [(f"{one.name} [{one.unit}]", one.value, one.other, one.uncertainty) for one in pair.intervals]
        tables.append(Table.of(DataFrame(rows, columns=["result", *meshes, "uncertainty"])))
    if pair.targets:
        runs = DataFrame({"mesh": pair.meshes, "outcome": pair.outcomes})
        tables.append(Table.of(runs, "Meshes that were run"))
    return Section("discretisation", "Discretisation uncertainty", lead, (), tuple(tables))
