"""The discretisation uncertainty of a scene's results (`--uncertainty`, [accuracy]): words, summary, section."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.files import read_csv
from weavecell.report.page import Section, Table
from weavecell.results import display

if TYPE_CHECKING:
    from weavecell.studies.mesh_uncertainty import Discretisation

_INDEX = (
    "Uncertainty of the results {} by the grid convergence index of ASME V&V 20, from two meshes with an assumed order "
    "of 2 and a safety factor of 3, of the largest difference of their histories{}."
)
AGAINST_TESTS = Path(__file__).with_name(
    "against_tests.csv"
)  # written by `python -m validation measured`
_MEANS = "; of means that of the means, to which their standard errors are added"


def summary(pair: Discretisation | None) -> dict[str, Any]:
    """For summary.json."""
    if pair is None:
        return {}
    other = "coarser" if pair.targets else "finer"
    meshes, window = list(pair.meshes), pair.windows[0]
    errors = () if window is None else ("standard_error", f"{other}_standard_error")
    results: dict[str, Any] = {
        one.name: {
            "unit": one.unit,
            "value": one.value,
            other: one.other,
            "uncertainty": one.uncertainty,
        }
        | dict(zip(errors, one.standard_errors))
        for one in pair.intervals
    }
    entries: dict[str, Any] = {} if window is None else {"window": window.summary()}
    entries["discretisation"] = {
        "meshes": meshes,
        "outcomes": list(pair.outcomes),
        "results": results,
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
    """Means over the window and uncertainties, one line a result; of targets whether they are met."""
    found, window = [], pair.windows[0]
    if window is not None:
        found = [f"mean and standard error, {_of_window(window)}:"]
        found += [
            f"  {' '.join(row[:-1])} ({row[-1]} at {window.strike_velocity:g} m/s)"
            for row in _means(window)
        ]
    found.append(f"discretisation uncertainty, from {' and '.join(pair.meshes[-2:])}:")
    found += [f"  {line}" for line in _outcomes(pair)]
    other = "coarser" if pair.targets else "finer"
    for one in pair.intervals:
        value = f"{'mean ' * bool(window)}{one.name} {one.value:.4g} +- {one.uncertainty:.2g} {one.unit}"
        found.append(f"  {value} ({one.other:.4g} on the {other} mesh; no test)")
    return "\n".join([*found, *_verdict(pair), *_against_tests(pair)])


def _of_window(window):
    """Velocities and outcomes of a window."""
    low, *_, high = (shot["strike_velocity_m_s"] for shot in window.shots)
    mixed = ": MIXED outcomes" if len(window.outcomes) > 1 else ""
    return f"{len(window.shots)} shots at {low:.4g} to {high:.4g} m/s, {_counts(window)}{mixed}"


def _counts(window):
    return ", ".join(f"{count} {outcome}" for outcome, count in window.outcomes.items())


def _means(window):
    """(quantity, mean with standard error and unit, value at the one velocity) of each quantity."""
    from weavecell.studies.window import QUANTITIES

    shot = next(
        shot for shot in window.shots if shot["strike_velocity_m_s"] == window.strike_velocity
    )
    for name, (key, words, unit) in QUANTITIES.items():
        mean, error = window.mean(name)
        yield words, f"{mean:.4g} +- {error:.2g} {unit}".rstrip(), f"{shot[key]:.4g}"


def _outcomes(pair):
    """A line where the outcome, or that of shots of the window, depends on the mesh."""
    first, last = (pair.outcomes[-2:] if pair.targets else pair.outcomes)[0], pair.outcomes[-1]
    if not pair.same_outcome:
        return [f"the outcome depends on the mesh: {first}, and {last} on the finer one"]
    one, other = (window and _counts(window) for window in (pair.windows[0], pair.windows[-1]))
    mesh = "coarser" if pair.targets else "finer"
    return (
        []
        if one == other
        else [f"outcomes in the window depend on the mesh: {one}, and {other} on the {mesh} one"]
    )


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


def _against_tests(pair):
    """A line of each quantity of such a shot that was compared with tests."""
    levels = {"ply" if pair.setup.plies == 1 else "pack", "backing" if pair.setup.backing else ""}
    rows = read_csv(AGAINST_TESTS, "level, quantity, words")
    return [f"against tests, {cells[1]}: {cells[2]}" for _, cells in rows if cells[0] in levels]


def _percent(share):
    return "not known" if share == inf else display.text(share, "1", "share", ".2g")


def section(pair: Discretisation) -> Section:
    """For the report."""
    from pandas import DataFrame

    meshes, tables, window = (
        pair.meshes[-1:-3:-1] if pair.targets else pair.meshes,
        [],
        pair.windows[0],
    )
    lead = " ".join(
        line[0].upper() + line[1:] + "."
        for line in (*_verdict(pair), *_outcomes(pair), *_against_tests(pair))
    )
    if pair.intervals:
        counts, of_means = (
            "on the finer mesh" if pair.targets else "on the mesh of the scene",
            _MEANS * bool(window),
        )
        lead = f"{lead} {_INDEX.format(counts, of_means)}".strip()
        rows = [
            (f"{one.name} [{one.unit}]", one.value, one.other, one.uncertainty)
            for one in pair.intervals
        ]
        tables.append(Table.of(DataFrame(rows, columns=["result", *meshes, "uncertainty"])))
    if window is not None:
        heads = ["result", "mean and standard error", f"at {window.strike_velocity:g} m/s"]
        tables.append(
            Table.of(DataFrame(_means(window), columns=heads), f"Means: {_of_window(window)}")
        )
    if pair.targets:
        runs = DataFrame({"mesh": pair.meshes, "outcome": pair.outcomes})
        tables.append(Table.of(runs, "Meshes that were run"))
    return Section("discretisation", "Discretisation uncertainty", lead, (), tuple(tables))
