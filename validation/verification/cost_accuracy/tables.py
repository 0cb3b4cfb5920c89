"""A judged scene as tables: CSV for programs and readers, and rows for the page."""

from __future__ import annotations

import csv
from pathlib import Path

from fabrics.errors import InputError
from validation.marked_page import markdown
from validation.program import write_csv
from validation.verification.cost_accuracy.core import Chart, Entry, Quantity, Reference, Sample, Scene, fronts
from validation.verification.richardson import Extrapolation

SCALES = {"s": (1e6, "µs"), "m": (1e3, "mm"), "-": (1e2, "%"), "deg": (1.0, "°")}


def shown(quantity: Quantity, value: float) -> str:
    """A value as a reader wants it."""
    scale, _ = SCALES.get(quantity.unit, (1.0, quantity.unit))
    return f"{scale * value:.4g}"


def heading(quantity: Quantity) -> str:
    """Name and unit of a quantity, as `shown`."""
    return f"{quantity.name} [{SCALES.get(quantity.unit, (1.0, quantity.unit))[1]}]"


def write(chart: Chart, folder: Path, made: str = "") -> None:
    """NAME.csv, one row a method, and NAME-references.csv, one row a quantity; `made` as of `write_references`."""
    write_methods(chart, folder / f"{chart.key}.csv")
    write_references(chart, folder / f"{chart.key}-references.csv", made)


def write_methods(chart: Chart, path: Path) -> None:
    """One row a method: cost, values (SI), errors [-], and on which fronts it is."""
    quantities = chart.scene.quantities
    rows: list[list[object]] = [[
        "scene", "choice", "method", "cpu [s]", "wall [s]", "repeats", "table [s]", "march [s]",
        *(f"{q.name} [{q.unit}]" for q in quantities), *(f"error of {q.name} [-]" for q in quantities),
        "Pareto-optimal in", "failed",
    ]]  # fmt: skip
    for entry in chart.entries:
        sample, method = entry.sample, entry.method
        rows.append([
            chart.scene.key, method.choice, method.name, f"{sample.cpu:.4g}", f"{sample.wall:.4g}", sample.repeats,
            *(f"{sample.parts[part]:.4g}" if part in sample.parts else "" for part in ("table", "march")),
            *(f"{sample.values[q.name]:.7g}" if q.name in sample.values else "" for q in quantities),
            *(f"{entry.errors[q.name]:.3g}" if q.name in entry.errors else "" for q in quantities),
            "; ".join(group for group, front in chart.fronts.items() if entry in front), sample.failed,
        ])  # fmt: skip
    write_csv(path, rows)


def write_references(chart: Chart, path: Path, made: str = "") -> None:
    """One row a quantity: reference (SI), half width, where from; `made` says when, where and by which version."""
    rows = [["scene", "quantity", "unit", "group", "reference", "half width", "basis", "order", "remark", "made"]]
    for quantity in chart.scene.quantities:
        found = chart.references[quantity.name]
        basis = found.basis
        order = "" if basis is None or basis.order is None else f"{basis.order:.2f}"
        basis_text = ("closed form", "", "") if basis is None else (basis.basis, order, basis.remark)
        rows.append([
            chart.scene.key, quantity.name, quantity.unit, quantity.group, f"{found.value:.7g}",
            f"{found.half_width:.3g}", *basis_text, made,
        ])  # fmt: skip
    write_csv(path, rows)


def kept(key: str, folder: Path) -> bool:
    """Whether the tables of a scene are in a folder."""
    return all((folder / f"{key}{part}.csv").exists() for part in ("", "-references"))


def read(scene: Scene, folder: Path) -> tuple[Chart, str]:
    """(Chart, made) from the tables of a scene in a folder; methods that the scene no longer has are left out.

    Raises
    ------
    InputError : tables of other quantities
    """
    path = folder / f"{scene.key}-references.csv"
    with path.open(encoding="utf-8") as file:
        rows = {row["quantity"]: row for row in csv.DictReader(file)}
    if rows.keys() != {q.name for q in scene.quantities}:
        raise InputError(file=path, key="quantity", value=", ".join(rows), allowed="those of the scene: run it again")
    references = {name: _reference(row) for name, row in rows.items()}
    entries, there = [], {method.name: method for method in scene.methods}
    with (folder / f"{scene.key}.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["method"] in there:
                entries.append(_entry(scene, there[row["method"]], row))
    return Chart(scene, references, entries, fronts(scene, references, entries)), next(iter(rows.values()))["made"]


def _reference(row):
    basis = None
    if row["basis"] != "closed form":
        order = float(row["order"]) if row["order"] else None
        basis = Extrapolation(float(row["reference"]), order, row["basis"], row["remark"], float("nan"))
    return Reference(float(row["reference"]), float(row["half width"]), basis)


def _entry(scene, method, row):
    values = {q.name: row[f"{q.name} [{q.unit}]"] for q in scene.quantities}
    errors = {q.name: row[f"error of {q.name} [-]"] for q in scene.quantities}
    parts = {part: row[f"{part} [s]"] for part in ("table", "march")}
    found = [{name: float(text) for name, text in column.items() if text} for column in (values, errors, parts)]
    sample = Sample(
        found[0], float(row["cpu [s]"]), float(row["wall [s]"]), found[2], int(row["repeats"]), row["failed"]
    )
    return Entry(method, sample, found[1])


def reference_table(chart: Chart) -> str:
    """References with what they are unsure of."""
    rows = []
    for quantity in chart.scene.quantities:
        found = chart.references[quantity.name]
        if found.basis is None:
            basis_text = "closed form"
        elif found.basis.basis == "Richardson":
            basis_text = f"Richardson, order {found.basis.order:.1f}"
        else:
            basis_text = f"{found.basis.basis}: {found.basis.remark}"
        rows.append([heading(quantity), shown(quantity, found.value), f"{100 * found.share:.2f}", basis_text])
    return markdown([["quantity", "reference", "± [%]", "from"], *rows], numbers=True)


def method_table(chart: Chart) -> str:
    """Every method with its cost and its errors in per cent; in bold where none beats it."""
    quantities = chart.scene.quantities
    best = [entry for front in chart.fronts.values() for entry in front]
    rows = []
    for entry in chart.entries:
        name = f"**{entry.method.name}**" if entry in best else entry.method.name
        errors = [f"{100 * entry.errors[q.name]:.2g}" if q.name in entry.errors else "–" for q in quantities]
        rows.append([name, f"{entry.sample.cpu:.3g}", *errors, entry.sample.failed.split(":")[0]])
    if not any(row[-1] for row in rows):
        rows = [row[:-1] for row in rows]
    columns = ["method", "CPU [s]", *(f"{q.name} [%]" for q in quantities)]
    return markdown([columns + ["failed"] * (len(rows[0]) > len(columns)), *rows], numbers=True)
