"""What a study says of its cases beside their quantities: maps of stability, and charts of cost against error.

A map, [map] of a study: x and y are the keys of `each` that span it. A point is "failed" where a check stopped the run,
"stable" where the expression `stable` holds of its result, and "wrong" otherwise. From `default` (x, y) outwards, to
the `sides` "above" or "below", the edge of the stable region is found by bisection of the ratio between the last stable
value of the axis and the first that is not; in every row y with `every_row`. The margin is the ratio of edge and
default, above 1.

A chart, [cost]: the reference of the quantities of each of `groups` is the limit to which the runs of `meshes`, pairs
(element size, changes of [base]), extrapolate, or `exact`, the name of a case. It is known to the scatter of the
extrapolation, a quarter of its step beyond the finest mesh, and what the changes of `finer` move the first mesh by. The
error of a method is the largest of its group. Methods are Pareto-optimal which no cheaper one matches; an error within
what is known of the reference counts as that, and a dearer method has to take a tenth off. Costs are the CPU time of
one thread, after compilation (`study.solve`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isnan, nan, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from validation.richardson import extrapolate
from validation.study import Record, Row, Study, evaluated, merged, record
from validation.values import Values

Solver: TypeAlias = Callable[[Sequence[Row]], list[tuple[Values, Values]]]

STABLE = "stable"
WRONG = "wrong"
FAILED = "failed"
ABOVE = "above"
BELOW = "below"
HALVINGS = 5  # of the ratio between a stable value and one that is not
GAIN = 0.1  # of the error, that a dearer method has to take off
ALIKE = 1e-4  # [-] errors below are all alike


def mapped(study: Study, rows: Sequence[Row], solver: Solver) -> list[Record]:
    """Records of a map: its points, those of the bisections, and the edges with their margins.

    Parameters
    ----------
    study, rows : Study, and its cases
    solver : gives a pair (result, result of the reference) for each of some rows
    """
    entry = study.content["map"]
    records = list[Record]()

    def judge(row, result, reference):
        found = record(row, result, reference)
        stable = "problem" not in found and evaluated(entry["stable"], result, reference)
        records.append(
            found | {"outcome": FAILED if "problem" in found else STABLE if stable else WRONG}
        )
        return records[-1]["outcome"]

    x = entry["x"]
    y = entry["y"]
    start, home = entry.get("default", (None, None))
    outcomes = {
        (row.labels[x], row.labels[y]): judge(row, *pair) for row, pair in zip(rows, solver(rows))
    }

    def at(place, line):
        if (place, line) not in outcomes:
            row = study.row_at({x: place, y: line})
            outcomes[place, line] = judge(row, *solver([row])[0])
        return outcomes[place, line]

    lines = [home]
    if entry.get("every_row"):
        lines = dict.fromkeys(line for _, line in outcomes)
    edges = []
    for side in entry.get("sides", ()):
        for line in lines:
            places = [place for place, of_line in outcomes if of_line == line]
            edge, beyond = _edge(places, start, side, lambda place, line=line: at(place, line))
            margin = edge / start if side == ABOVE else start / edge
            edges.append({x: edge, y: line, "outcome": f"edge {side}: {beyond}", "margin": margin})
    return records + edges


def _edge(places, start, side, at):
    """(edge of the stable region about `start`, outcome beyond it)."""
    if at(start) != STABLE:
        return start, at(start)
    further = sorted(
        (v for v in places if (v > start if side == ABOVE else v < start)), reverse=side == BELOW
    )
    count = next((n for n, value in enumerate(further) if at(value) != STABLE), len(further))
    inside = start
    if count:
        inside = further[count - 1]
    if count == len(further):
        return inside, "none on the axis"
    outside = further[count]
    beyond = at(outside)
    for _ in range(HALVINGS if outside > 0 else 0):
        middle = sqrt(inside * outside)
        if at(middle) == STABLE:
            inside = middle
        else:
            outside = middle
            beyond = at(middle)
    return inside, beyond


def charted(study: Study, rows: Sequence[Row], solver: Solver) -> list[Record]:
    """Records of a chart: its methods with their errors by group; last the reference, with what it is known to.

    Parameters as of `mapped`; results have "cpu_s".
    """
    entry = study.content["cost"]
    first = next(iter(rows[0].labels))
    quantities = rows[0].quantities
    records = [
        record(row, *pair) | {"CPU [s]": pair[0].get("cpu_s", nan)}
        for row, pair in zip(rows, solver(rows))
    ]
    if "exact" in entry:
        values = next(found for found in records if found[first] == entry["exact"])
        known = dict.fromkeys(quantities, 0.0)
        records.remove(values)
    else:
        values, known = _reference(study, entry, quantities, solver)
    last = {first: "reference"} | {name: values[name] for name in quantities}
    for group, names in entry["groups"].items():
        column = f"error of {group} [%]"
        least = max(ALIKE, *(known[name] for name in names))
        for found in records:
            off = [
                nan if found[name] is None else abs(found[name] / values[name] - 1)
                for name in names
            ]
            found[column] = nan if any(map(isnan, off)) else 100 * max(off)
        errors = [max(0.01 * found[column], least) for found in records]
        best = non_dominated([found["CPU [s]"] for found in records], errors, GAIN)
        for number, found in enumerate(records):
            found["Pareto-optimal in"] = found.get("Pareto-optimal in", "") + f"{group}; " * (
                number in best
            )
        last[column] = 100 * max(known[name] for name in names)
    return [*records, last]


def _reference(study, entry, quantities, solver):
    """({quantity: limit}, {quantity: [-] what it is known to})."""
    base = entry.get("reference", {})
    meshes = [study.row_of(merged(base, changes)) for _, changes in entry["meshes"]]
    coarsest = merged(base, entry["meshes"][0][1])
    finer = [study.row_of(merged(coarsest, changes)) for changes in entry.get("finer", ())]
    found = [record(row, *pair) for row, pair in zip([*meshes, *finer], solver([*meshes, *finer]))]
    limits = {}
    known = {}
    for name in quantities:
        values = [one[name] for one in found[: len(meshes)]]
        limit = extrapolate([size for size, _ in entry["meshes"]], values)
        moved = sum(abs(one[name] - values[0]) for one in found[len(meshes) :])
        limits[name] = limit.limit
        known[name] = (limit.scatter + 0.25 * abs(limit.limit - values[-1]) + moved) / abs(
            limit.limit
        )
    return limits, known


def non_dominated(cost: ArrayLike, error: ArrayLike, margin: float = 0.0) -> list[int]:
    """Numbers of the methods of which none other is at most as dear and at most as wrong, and better in one of the two.

    Parameters
    ----------
    cost, error : (n,) of each method; one that is not a number dominates nothing and is left out
    margin : share of the error that a dearer method has to take off the next cheaper one's to be named

    Returns
    -------
    list of int, from the cheapest to that of the lowest error
    """
    cost = np.asarray(cost, float)
    error = np.asarray(error, float)
    good = [int(i) for i in np.flatnonzero(np.isfinite(cost) & np.isfinite(error))]
    kept = []
    least = np.inf
    for i in sorted(good, key=lambda i: (cost[i], error[i])):
        if error[i] < least:
            kept.append(i)
            least = (1 - margin) * error[i]
    return kept
