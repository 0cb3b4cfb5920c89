"""The study as a table (CSV) and as a page (Markdown), both from the same entries."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from validation.program import write_csv
from validation.verification.crossover_convergence.axes import METHOD
from validation.verification.crossover_convergence.study import LAW, Study, measured, quantities
from validation.verification.richardson import Extrapolation

UNITS = {"a": ("a [mm]", 1e3, "{:.4f}"), "b": ("b [mm N^(1/3)]", 1e3, "{:.4f}")}


def write(study: Study, path: Path) -> None:
    """One row an entry: values, changes from the base, error against the reference, cost."""
    names = list(study.reference)
    rows: list[list[Any]] = [[
        "choice", "value", "goes to zero", *(heading(name) for name in names), "rms of the law [um]",
        "largest error in the forces [%]", *(f"{name}, change from the base [%]" for name in names), "cpu [s]",
        "wall [s]", "load steps", "tangents", "unknowns", "failed",
    ]]  # fmt: skip
    for entry in study.entries:
        result, values = entry.result, quantities(entry.result)
        rows.append([
            entry.axis, entry.label, "" if entry.x is None else f"{entry.x:.4g}",
            *(text(name, values.get(name)) for name in names),
            "" if result["law"] is None else f"{1e6 * result['law']['rms']:.3f}",
            "" if entry.error is None else f"{100 * entry.error:.3f}",
            *("" if name not in entry.change else f"{100 * entry.change[name]:+.3f}" for name in names),
            f"{result['cpu']:.2f}", f"{result['wall']:.2f}", result["steps"], result["tangents"], result["unknowns"],
            "; ".join(f"{path}: {why}" for path, why in result["failed"].items()),
        ])  # fmt: skip
    write_csv(path, rows)


def write_orders(study: Study, path: Path) -> None:
    """One row a choice with a limit and quantity: limit, observed order, and how far the base is from the limit."""
    head = ["choice", "quantity", "limit", "observed order", "basis", "remark", "scatter", "base off by [%]"]
    rows = [
        [name, heading(quantity), text(quantity, limit.limit), "" if limit.order is None else f"{limit.order:.2f}",
         limit.basis, limit.remark, text(quantity, limit.scatter), f"{100 * off(study, quantity, limit):+.3f}"]
        for name, found in study.limits.items() for quantity, limit in found.items()
    ]  # fmt: skip
    write_csv(path, [head, *rows])


def off(study: Study, quantity: str, limit: Extrapolation) -> float:
    """[-] of the base from a limit, over the limit."""
    return quantities(study.base.result)[quantity] / limit.limit - 1


def heading(name: str) -> str:
    """A quantity with its unit."""
    return UNITS[name][0] if name in LAW else f"{name} [N]"


def text(name: str, value: float) -> str:
    if value is None:
        return ""
    _, scale, form = UNITS.get(name, ("", 1.0, "{:.3f}"))
    return form.format(scale * value)


def rows(study: Study, axis: str) -> Iterator[list[str]]:
    """Rows of one choice: label, forces, a, b, largest error or none, CPU time, tangents."""
    names = [*filter(measured, study.reference), *LAW]
    method = next(a for a in study.axes if a.name == axis).kind == METHOD
    for entry in study.of(axis):
        values = quantities(entry.result)
        label = f"**{entry.label}**" if entry.case == study.base.case else entry.label
        if entry.result["failed"]:
            yield [label, *["–"] * len(names), *(["–"] if method else []), f"{entry.result['cpu']:.1f}", "failed"]
            continue
        error = [f"{100 * entry.error:.2f}"] if method else []
        cost = [f"{entry.result['cpu']:.1f}", entry.result["tangents"]]
        yield [label, *(text(name, values.get(name)) for name in names), *error, *cost]


def columns(study: Study, axis: str) -> list[str]:
    """Headings of `rows`."""
    names = [*filter(measured, study.reference), *LAW]
    method = next(a for a in study.axes if a.name == axis).kind == METHOD
    return [axis, *map(heading, names), *(["largest error [%]"] if method else []), "CPU [s]", "tangents"]


def order_rows(study: Study, axis: str) -> Iterator[list[str]]:
    """Rows of one choice with a limit: quantity, limit, order, basis, how far the base is off."""
    for quantity, limit in study.limits.get(axis, {}).items():
        if not measured(quantity) and quantity not in LAW:
            continue
        order = "none" if limit.order is None else f"{limit.order:.2f}"
        basis = limit.basis if not limit.remark else f"{limit.basis}: {limit.remark}"
        yield [
            heading(quantity),
            text(quantity, limit.limit),
            order,
            basis,
            f"{100 * off(study, quantity, limit):+.2f}",
        ]


ORDERS = ["quantity", "limit", "observed order", "basis", "base off by [%]"]
