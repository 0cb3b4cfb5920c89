"""Compute the rows of validation/measured/rows.csv and hold them against the tests.

Writes measured.csv (measured, computed, E and u_val of each row), measured-quantities.csv (bias and scatter) and
measured-clamps.csv to docs/reports/data, and what `weavecell impact --uncertainty` prints of tests to weavecell/report.
Rows that are not computed anew stay as they are. The site draws the scatter plots (tools/measured_plots.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, isnan
from pathlib import Path

from fabrics import run_cache
from validation import study
from validation.measured import clamps, statistics
from validation.measured.rows import Row, compute, number, read
from validation.values import Values
from weavecell.report.chapters_discretisation import AGAINST_TESTS
from weavecell.results import provenance

NOTES = {
    "quick": "the cheap run of each row alone, at most 10 minutes on two cores; its files go to results/measured",
    "parts": "of crossover, ply, pack, backing, clamps, or stored: what is computed; all by default",
    "out": "folder of the CSVs; docs/reports/data by default",
}
PARTS = ("crossover", "ply", "pack", "backing", "clamps")
KEPT = Path("results/measured")
RUN = ("computed", "coarse", "error", "energy_error", "commit")  # columns that a run fills
VALIDATION = ("E", "u_num", "u_input", "u_val", "E_over_u_val")


def main(
    parts: Sequence[str] = (), *, quick: bool = False, jobs: int = 1, out: Path | None = None
) -> None:
    parts = parts or PARTS[: -1 if quick else None]
    stamp = provenance.stamp()
    rows = read()
    folder = out or (KEPT if quick else study.DATA)
    runs: Values = {"folder": KEPT / "runs", "jobs": jobs}
    cases = {
        row.id: (None if quick else row.case, row.coarse_case) for row in rows if row.level in parts
    }
    wanted = list(
        dict.fromkeys(case for pair in cases.values() for case in pair if case is not None)
    )
    found = dict(zip(wanted, run_cache.results(compute, [(case,) for case in wanted], **runs)))
    kept = {row["id"]: row for row in study.read(study.DATA / "measured.csv")[1]}
    new = {id: _ran(found, *pair, stamp["commit"]) for id, pair in cases.items() if any(pair)}
    table = [held(row, new.get(row.id) or kept.get(row.id, {})) for row in rows]
    made = f"python -m validation measured {' '.join(parts)}, commit {stamp['commit']}, {stamp['date']}"
    study.write(folder / "measured.csv", table, made)
    quantities = summary(table)
    study.write(folder / "measured-quantities.csv", quantities, made)
    if folder == study.DATA:
        study.write(AGAINST_TESTS, quantities, made)
    if "clamps" in parts:
        varied, each = zip(*clamps.shots())
        fired = run_cache.results(clamps.fire, [(case,) for case in each], **runs)
        study.write(folder / "measured-clamps.csv", clamps.settings(varied, fired), made)


def _ran(found, case, coarse, commit):
    """The columns of RUN from the results of a row's two cases."""
    value, error, balance = found[case or coarse]
    cheap = None
    if coarse is not None:
        cheap = found[coarse][0]
    return {
        key: study.text(cell)
        for key, cell in zip(RUN, (None if case is None else value, cheap, error, balance, commit))
    }


def held(row: Row, ran: Mapping[str, str]) -> Values:
    """A row of measured.csv: with E, u_num, u_input and u_val where a number is computed.

    u_num is the difference of the two runs of the row and its standard error, where both runs are there.
    """
    known: Values = {key: getattr(row, key) for key in ("id", "level", "quantity", "unit")}
    known |= {"measured": row.value, "sigma": row.sigma} | {key: ran.get(key, "") for key in RUN}
    known |= dict.fromkeys(VALIDATION, "")
    computed = number(known["computed"] or known["coarse"])
    measured = number(row.value)
    if not isnan(computed - measured):
        step = abs(number(known["computed"]) - number(known["coarse"]))
        u_num = hypot(number(known["error"]), 0.0 if isnan(step) else step)
        u_input = float(row.u_input or 0) * abs(computed)
        E = computed - measured
        u_val = hypot(u_num, u_input, float(row.sigma))
        known |= dict(zip(VALIDATION, map(study.text, (E, u_num, u_input, u_val, E / u_val))))
    return known | {"source": row.source, "assumed": row.assumed}


def summary(table: Sequence[Mapping[str, str]]) -> list[Values]:
    """A row a quantity that is computed: what --uncertainty prints, n, rows within 2 u_val, bias, sigmas.

    An outcome is within where it is the same. Numbers that may be 0 have no bias.
    """
    found = []
    for name in dict.fromkeys(row["quantity"] for row in table if row["computed"] or row["coarse"]):
        rows = [
            row for row in table if row["quantity"] == name and (row["computed"] or row["coarse"])
        ]
        values = [row["computed"] or row["coarse"] for row in rows]
        met = [
            row["measured"] == value or abs(number(row["E_over_u_val"])) <= 2
            for row, value in zip(rows, values)
        ]
        one: Values = {
            "level": rows[0]["level"],
            "quantity": name,
            "words": f"{sum(met)} within the uncertainty",
        }
        one |= {
            "n": len(rows),
            "within 2 u_val": sum(met),
            "bias": None,
            "sigma_model": None,
            "sigma_test": None,
        }
        measured, computed = (
            [*map(number, each)] for each in ((row["measured"] for row in rows), values)
        )
        if min(*measured, *computed) > 0:
            of = statistics.of(measured, computed, [float(row["sigma"]) for row in rows])
            one |= {key: round(value, 3) for key, value in vars(of).items()}
            one["words"] = f"bias {of.bias:.2f}" + (
                "" if isnan(of.sigma_model) else f", sigma {of.sigma_model:.0%}"
            )
        one["words"] += f", n = {len(rows)}"
        found.append(one)
    return found
