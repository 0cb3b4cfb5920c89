"""Outcomes of random scenes: a table of all, and what is said about them."""

from __future__ import annotations

import csv
from collections import Counter

from fabrics.files import write_whole

FIRST = (
    "seed", "index", "outcome", "end", "energy_error", "message", "cpu_time", "steps", "time_us", "failed_yarns",
    "residual_velocity", "warnings",
)  # fmt: skip
ENERGY_ERROR_LIMIT = 0.005  # of the strike energy, at normal termination
WRONG = ("traceback", "crash", "timeout", "time")


def write(rows, path):
    """Write the rows as CSV, the outcome's columns first and the scene's own after them."""
    names = [*FIRST, *sorted({name for row in rows for name in row} - set(FIRST))]
    with write_whole(path) as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: (row["seed"], row["index"])))


def beyond_limit(rows):
    """Rows of runs that terminated normally with an energy error beyond the limit, or not a number."""
    return [row for row in rows if row["outcome"] == "ok" and not row["energy_error"] <= ENERGY_ERROR_LIMIT]


def failures(rows, guards_allowed):
    """Sentences about what must not be, empty where all is well."""
    count, found = Counter(row["outcome"] for row in rows), []
    found += [f"{count[name]} scenes ended as {name}" for name in WRONG if count[name]]
    wrong = beyond_limit(rows)
    if wrong:
        found.append(f"{len(wrong)} terminated normally with an energy error above {100 * ENERGY_ERROR_LIMIT:g} %")
    if count["guard"] > guards_allowed:
        found.append(f"{count['guard']} were stopped by a guard, {guards_allowed} are allowed")
    return found


def summary(rows) -> str:
    """Counts, energy errors and cost, and every scene that did not end well, in lines."""
    count = Counter(row["outcome"] for row in rows)
    lines = [f"{len(rows)} scenes: " + ", ".join(f"{n} {name}" for name, n in count.most_common())]
    ends = Counter(row["end"] for row in rows if row["outcome"] == "ok")
    lines.append("normal terminations: " + ", ".join(f"{n} {name}" for name, n in ends.most_common()))
    torn = sum(bool(row.get("failed_yarns")) for row in rows)
    lines.append(f"with failed yarns: {torn}")
    errors = sorted(row["energy_error"] for row in rows if row["outcome"] == "ok")
    if errors:
        lines.append("energy error: " + _quantiles([100 * e for e in errors], "%"))
    cost = sorted(row["cpu_time"] for row in rows if "cpu_time" in row)
    if cost:
        lines.append("CPU time: " + _quantiles(cost, "s") + f", {sum(cost):.4g} s in all")
    wrong = [row for row in rows if row["outcome"] not in ("ok", "rejected")] + beyond_limit(rows)
    lines += [describe(row) for row in sorted(wrong, key=lambda row: (row["outcome"], row["index"]))]
    refused = Counter(row["message"].split(": ")[-1] for row in rows if row["outcome"] == "rejected")
    lines += [f"rejected {n} times: must be {message}" for message, n in refused.most_common(8)]
    return "\n".join(lines)


def describe(row) -> str:
    """One line about a scene that did not end well."""
    error = row.get("energy_error")
    told = f", energy error {100 * error:.3g} %" if error is not None else ""
    return f"  (seed {row['seed']}, index {row['index']}) {row['outcome']} {row['message'] or row['end']}{told}"


def _quantiles(values, unit):
    pick = lambda share: values[min(int(share * len(values)), len(values) - 1)]  # noqa: E731
    mean = sum(values) / len(values)
    return f"mean {mean:.3g}, median {pick(0.5):.3g}, 95 % {pick(0.95):.3g}, largest {values[-1]:.3g} {unit}"
