"""Maps as tables: one CSV of all points, one of all edges."""

from __future__ import annotations

import csv

from fabrics.files import write_whole


def write_points(maps, path):
    """One row a point."""
    with write_whole(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["map", "x", "value of x", "y", "value of y", "outcome", "number", "what it is", "message"])
        for found in maps:
            chart = found.map
            for (x, y), outcome in found.outcomes.items():
                value = "" if outcome.value is None else f"{outcome.value:.4g}"
                rows.writerow(
                    [chart.key, chart.x.name, x, chart.y.name, y, outcome.kind, value, chart.number, outcome.told]
                )


def write_edges(maps, path):
    """One row an edge."""
    with write_whole(path) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["map", "x", "y", "default", "side", "edge", "edge met", "margin", "as asked", "beyond"])
        for found in maps:
            for edge in found.edges:
                beyond = "" if edge.beyond is None else edge.beyond.told or edge.beyond.kind
                rows.writerow([
                    found.map.key, found.map.x.name, edge.y, found.map.default[0], edge.side, f"{edge.value:.5g}",
                    edge.met, f"{edge.margin:.4g}", edge.enough, beyond,
                ])  # fmt: skip
