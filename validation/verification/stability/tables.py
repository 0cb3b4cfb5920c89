"""A map as tables: one CSV of its points, one of its edges; written, and read again."""

from __future__ import annotations

import csv
from pathlib import Path

from validation.program import write_csv
from validation.verification.stability.core import Edge, Found, Map, Outcome


def write(found: Found, folder: Path, made: str = "") -> None:
    """NAME.csv, one row a point, and NAME-edges.csv, one row an edge; `made` says when, where and by which version."""
    chart = found.map
    points = [[chart.x.name, chart.y.name, "outcome", chart.number or "number", "message", "made"]]
    for (x, y), outcome in found.outcomes.items():
        value = "" if outcome.value is None else repr(outcome.value)
        points.append([x, y, outcome.kind, value, outcome.message, made])
    write_csv(folder / f"{chart.key}.csv", points)
    edges = [["y", "side", "default", "edge", "edge met", "margin", "beyond", "message"]]
    for edge in found.edges:
        beyond = ("", "") if edge.beyond is None else (edge.beyond.kind, edge.beyond.message)
        edges.append([edge.y, edge.side, chart.default[0], repr(edge.value), edge.met, repr(edge.margin), *beyond])
    write_csv(folder / f"{chart.key}-edges.csv", edges)


def kept(key: str, folder: Path) -> bool:
    """Whether the tables of a map are in a folder."""
    return all((folder / f"{key}{part}.csv").exists() for part in ("", "-edges"))


def read(chart: Map, folder: Path) -> tuple[Found, str]:
    """(Found, made) from the tables of a map in a folder."""
    outcomes, made = {}, ""
    places = {str(x): x for x in chart.x.values}, {str(y): y for y in chart.y.values}
    with (folder / f"{chart.key}.csv").open(encoding="utf-8") as file:
        rows = csv.reader(file)
        next(rows)
        for x, y, kind, value, message, stamp in rows:
            outcomes[_place(places[0], x), _place(places[1], y)] = Outcome(kind, _number(value), message)
            made = stamp
    edges = []
    with (folder / f"{chart.key}-edges.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            beyond = Outcome(row["beyond"], None, row["message"]) if row["beyond"] else None
            edges.append(
                Edge(_place(places[1], row["y"]), row["side"], float(row["edge"]), row["edge met"] == "True",
                     float(row["margin"]), beyond)
            )  # fmt: skip
    return Found(chart, outcomes, tuple(edges)), made


def _place(known, text):
    return known[text] if text in known else float(text)


def _number(text):
    if not text:
        return None
    return int(text) if text.lstrip("-").isdigit() else float(text)
