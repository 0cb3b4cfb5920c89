"""What a study says of its cases beside their quantities: maps of stability, and charts of cost against error.

A map, [map]: x and y are the keys of `each` that span it. A point is "failed" where a check stopped the run, "stable"
where the expression `stable` holds, else "wrong". From `default` outwards, to the `sides` "above" or "below", the
edge is found by bisection; in every row y with `every_row`. The margin is edge over default, above 1.

A chart, [cost]: the reference of each of `groups` is what the runs of `meshes` (element size, changes of [base])
extrapolate to, or `exact`, a case; it is known to the scatter of that, a quarter of its step beyond the finest mesh,
and what the changes of `finer` move the first mesh by. The error of a method is the largest of its group.
Pareto-optimal are those that no cheaper one matches; an error within what is known of the reference counts as that,
and a dearer method has to take a tenth off. Costs are the CPU time of one thread, after compilation (`runner.solve`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import nan, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from validation.csv_file import Record
from validation.filling import merged
from validation.richardson import extrapolate
from validation.study import Row, Study, evaluated, record
from validation.values import Values

Solver: TypeAlias = Callable[[Sequence[Row]], list[tuple[Row, Values, Values]]]

STABLE = "stable"
WRONG = "wrong"
FAILED = "failed"
ABOVE = "above"
BELOW = "below"
HALVINGS = 5  # of the ratio between a stable value and one that is not
GAIN = 0.1  # of the error, that a dearer method has to take off
ALIKE = 1e-4  # [-] errors below are all alike


def mapped(study: Study, rows: Sequence[Row], solver: Solver) -> list[Record]:
    """Make the records of a map: its points, those of the bisections, and the edges with their
    margins.

    Parameters
    ----------
    study, rows : Study, and its cases
    solver : gives (row, result, result of the reference) for each of some rows
    """
    entry = study.content["map"]
    x = entry["x"]
    y = entry["y"]
    start, home = entry.get("default", (None, None))
    records: list[Record] = []
    outcomes = {}

    def judge(row, result, reference):
        found = record(row, result, reference)
        found["outcome"] = outcome_of_point(study, found, result, reference)
        records.append(found)
        outcomes[row.labels[x], row.labels[y]] = found["outcome"]

    def outcome_at(line, place):
        if (place, line) not in outcomes:
            judge(*solver([study.row_at({x: place, y: line})])[0])
        return outcomes[place, line]

    for case in solver(rows):
        judge(*case)
    lines = [home]
    if entry.get("every_row"):
        lines = list(dict.fromkeys(line for _, line in outcomes))
    edges = []
    for side in entry.get("sides", ()):
        for line in lines:
            places = [place for place, of_line in outcomes if of_line == line]
            edge, beyond = _edge(places, start, side, partial(outcome_at, line))
            margin = edge / start
            if side == BELOW:
                margin = start / edge
            edges.append({x: edge, y: line, "outcome": f"edge {side}: {beyond}", "margin": margin})
    return records + edges


def outcome_of_point(study: Study, found: Record, result: Values, reference: Values) -> str:
    """Judge a point of a map by its record, its result and that of its reference."""
    if "problem" in found:
        return FAILED
    if evaluated(study.content["map"]["stable"], result, reference):
        return STABLE
    return WRONG


def _edge(places, start, side, outcome_at):
    """(edge of the stable region about `start`, outcome beyond it)."""
    beyond = outcome_at(start)
    if beyond != STABLE:
        return start, beyond
    if side == ABOVE:
        further = sorted(place for place in places if place > start)
    else:
        further = sorted((place for place in places if place < start), reverse=True)
    inside = start
    for outside in further:
        beyond = outcome_at(outside)
        if beyond != STABLE:
            break
        inside = outside
    else:
        return inside, "none on the axis"
    if outside <= 0:
        return inside, beyond
    for _ in range(HALVINGS):
        middle = sqrt(inside * outside)
        outcome = outcome_at(middle)
        if outcome == STABLE:
            inside = middle
        else:
            outside = middle
            beyond = outcome
    return inside, beyond


def charted(study: Study, rows: Sequence[Row], solver: Solver) -> list[Record]:
    """Make the records of a chart: its methods with their errors by group; last the reference, with
    what it is known to.

    Parameters as in `mapped`; results have "cpu_s".
    """
    entry = study.content["cost"]
    quantities = rows[0].quantities
    first = next(iter(rows[0].labels))
    records = []
    for row, result, reference in solver(rows):
        records.append(record(row, result, reference) | {"CPU [s]": result.get("cpu_s", nan)})
    if "exact" in entry:
        exact = next(found for found in records if found[first] == entry["exact"])
        known = dict.fromkeys(quantities, 0.0)
        records.remove(exact)
    else:
        exact, known = _reference(study, entry, quantities, solver)
    last = {first: "reference"} | _chosen(exact, quantities)
    costs = [found["CPU [s]"] for found in records]
    for group, names in entry["groups"].items():
        column = f"error of {group} [%]"
        largest_known = max(_chosen(known, names).values())
        limits = np.array([*_chosen(exact, names).values()])
        errors = []
        for found in records:
            # a case that ended with an error has no numbers, but None
            values = np.array([*_chosen(found, names).values()], float)
            errors.append(abs(values / limits - 1).max())
            found[column] = 100 * errors[-1]
            found.setdefault("Pareto-optimal in", "")
        for number in non_dominated(costs, np.maximum(errors, max(ALIKE, largest_known)), GAIN):
            records[number]["Pareto-optimal in"] += f"{group}; "
        last[column] = 100 * largest_known
    return [*records, last]


def _chosen(values, names):
    return {name: values[name] for name in names}


def _reference(study, entry, quantities, solver):
    """({quantity: limit}, {quantity: [-] what it is known to})."""
    sizes, changes = zip(*entry["meshes"])
    base = entry.get("reference", {})
    meshes = [merged(base, change) for change in changes]
    finer = [merged(meshes[0], change) for change in entry.get("finer", ())]
    found = [record(*case) for case in solver([*map(study.row_of, [*meshes, *finer])])]
    limits = {}
    known = {}
    for name in quantities:
        values = np.array([one[name] for one in found])
        of_meshes = values[: len(meshes)]
        limit = extrapolate(sizes, of_meshes)
        moved = abs(values[len(meshes) :] - values[0]).sum()
        off = limit.scatter + 0.25 * abs(limit.limit - of_meshes[-1]) + moved
        limits[name] = limit.limit
        known[name] = off / abs(limit.limit)
    return limits, known


def non_dominated(cost: ArrayLike, error: ArrayLike, margin: float = 0.0) -> list[int]:
    """Select the methods of which none other is at most as dear and at most as wrong, and better in
    one of the two: their numbers.

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
    kept = []
    least = np.inf
    for number in np.lexsort((error, cost)):
        if np.isfinite(cost[number]) and error[number] < least:
            kept.append(int(number))
            least = (1 - margin) * error[number]
    return kept
