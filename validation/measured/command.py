"""Compute the rows of validation/measured/rows.csv and hold them against the tests.

Writes measured.csv (measured, computed, E and u_val of each row) and measured-quantities.csv (bias and scatter) to
docs/reports/data, and what `weavecell impact --uncertainty` prints of tests to weavecell/report.
A V50 is that of drawn shots, in scored.csv.
Rows that are not computed anew stay as they are; --known lists those that are of earlier code (`validation.stale`).
The site draws the scatter plots (tools/measured_plots.py).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from math import hypot, isnan
from pathlib import Path

import numpy as np

from fabrics.base.errors import InputError
from validation import csv_file, origin, stale
from validation.measured import statistics
from validation.measured.rows import DRAWN, SOLIDS, Row, compute, number, read
from validation.values import Values, compute_each
from weavecell.report.chapters_discretisation import AGAINST_TESTS

NOTES = {
    "quick": "the cheap run of each row alone, at most 10 minutes on two cores; its files go to results/measured",
    "only": "the id of the row that is computed, or a part of the ids of several",
    "known": "reason for which the rows are listed in validation/moved.csv as of earlier code; none is computed",
    "parts": "of crossover, ply, pack, backing, projectile, or stored: what is computed; all by default",
    "out": "folder of the CSVs; docs/reports/data by default",
}
PARTS = ("crossover", "ply", "pack", "backing", "projectile")
KEPT = Path("results/measured")
RUN = ("computed", "coarse", "error", "energy_error", "commit")  # columns that a run fills
VALIDATION = ("E", "u_num", "u_input", "u_val", "E_over_u_val")


def main(
    parts: Sequence[str] = (),
    *,
    only: str = "",
    quick: bool = False,
    jobs: int = 1,
    out: Path | None = None,
    known: str = "",
) -> None:
    """Compute the rows of measured.csv, and write them with their summary; or list them as old.

    Raises
    ------
    InputError : rows for the documentation by code that is not as committed
    """
    folder = out or csv_file.DATA
    if quick:
        folder = out or KEPT
    parts = parts or PARTS
    options: Values = {"folder": KEPT / "runs", "jobs": jobs}
    words = f"measured {' '.join(parts)}"
    if only:
        words += f' --only "{only}"'
    rows = read()
    wanted = choose([row.id for row in rows], only)
    cases = {}
    for row in rows:
        pair = (None if quick else row.case, row.coarse_case)
        if row.level in parts and row.id in wanted and any(pair) and not _is_drawn(row):
            cases[row.id] = pair
    kept = {row["id"]: row for row in csv_file.read(csv_file.DATA / "measured.csv")[1]}
    if known:
        values = {id: value_of(kept[id]) for id in cases if id in kept}
        old = {id: value for id, value in values.items() if value}
        stale.write(stale.with_measured(old, known, stale.read()))
        return
    origin.refuse_changes(folder)
    commit = origin.commit()
    found = compute_each(compute, filter(None, chain(*cases.values())), **options)
    for id, pair in cases.items():
        kept[id] = _ran(found, *pair, commit)
    predicted = {row["id"]: row for row in csv_file.read(csv_file.DATA / "scored.csv")[1]}
    for row in filter(_is_drawn, rows):
        kept[row.id] = drawn(predicted.get(row.id, {}))
    table = [held(row, kept.get(row.id, {})) for row in rows]
    here = Path(__file__).parent
    inputs = origin.digest_of_files(here / "rows.csv", *here.glob("inputs/**/*.toml"), SOLIDS)
    made = origin.write(words, inputs, origin.spent())
    csv_file.write(folder / "measured.csv", table, made)
    quantities = summary(table)
    csv_file.write(folder / "measured-quantities.csv", quantities, made)
    if folder == csv_file.DATA:
        csv_file.write(AGAINST_TESTS, quantities, made)
        stale.write(stale.without_measured(cases, stale.read()))


def choose(ids: Sequence[str], only: str) -> list[str]:
    """Choose the id that a text is, or else all of which it is a part.

    Raises
    ------
    InputError : it is part of none
    """
    if only in ids:
        return [only]
    found = [id for id in ids if only in id]
    if not found:
        raise InputError(key="only", value=only, allowed=f"part of one of {', '.join(ids)}")
    return found


def _is_drawn(row):
    return row.case is not None and row.case.measure == DRAWN


def drawn(row: Mapping[str, str]) -> dict[str, str]:
    """Take the columns of RUN from a row of scored.csv: the middle of what was drawn, and a standard error of which
    its 90 % interval is 3.29 wide; nothing where no shots are drawn."""
    if not row.get("50 %"):
        return {}
    low, middle, high = (float(row[f"{level} %"]) for level in (5, 50, 95))
    error = (high - low) / (2 * statistics.COVERAGE)
    return dict(zip(RUN, map(csv_file.text, (middle, None, error, None, row["commit"]))))


def _ran(found, case, coarse, commit):
    """The columns of RUN from the results of a row's two cases."""
    value, error, balance = found[case or coarse]
    if case is None:
        value = None
    cheap = None
    if coarse is not None:
        cheap = found[coarse][0]
    return dict(zip(RUN, map(csv_file.text, (value, cheap, error, balance, commit))))


def held(row: Row, ran: Mapping[str, str]) -> Values:
    """Make a row of measured.csv: with E, u_num, u_input and u_val if a number is computed.

    u_num is the difference of the two runs of the row and its standard error, where both runs are there; of closures
    the spread of five solids (`rows`).
    """
    known: Values = {key: getattr(row, key) for key in ("id", "level", "quantity", "unit")}
    known |= {"measured": row.value, "sigma": row.sigma}
    known |= dict.fromkeys((*RUN, *VALIDATION), "")
    known |= {key: ran[key] for key in RUN if key in ran}
    computed = number(value_of(known))
    E = computed - number(row.value)
    if not isnan(E):
        step = abs(number(known["computed"]) - number(known["coarse"]))
        u_num = hypot(number(known["error"]), np.nan_to_num(step))
        u_input = float(row.u_input or 0) * abs(computed)
        u_val = hypot(u_num, u_input, float(row.sigma))
        known |= dict(zip(VALIDATION, map(csv_file.text, (E, u_num, u_input, u_val, E / u_val))))
    return known | {"source": row.source, "assumed": row.assumed}


def value_of(row: Values) -> str:
    """Return the computed value of a row of measured.csv: that of the cheap run if there is no
    other."""
    return row["computed"] or row["coarse"]


def summary(table: Sequence[Values]) -> list[Values]:
    """Summarise each quantity that is computed in a row: what --uncertainty prints, n, rows within
    (`statistics.is_within`), bias, sigmas. Numbers that may be 0 have no bias.
    """
    of_quantity: Values = {}
    for row in table:
        if value_of(row):
            of_quantity.setdefault(row["quantity"], []).append(row)
    return [_summary(rows) for rows in of_quantity.values()]


def _summary(rows):
    within = sum(map(statistics.is_within, rows))
    first = rows[0]
    words = f"{within} of {len(rows)} within"
    measured = [number(row["measured"]) for row in rows]
    computed = [number(value_of(row)) for row in rows]
    known = dict.fromkeys(("bias", "sigma_model", "sigma_test"))
    if min(*measured, *computed) > 0:
        sigmas = [float(row["sigma"]) for row in rows]
        of = statistics.of(measured, computed, sigmas)
        known = {key: round(value, 3) for key, value in vars(of).items()}
        words += f", bias {of.bias:.2f}"
        if not isnan(of.sigma_model):
            words += f", sigma {of.sigma_model:.0%}"
    return {
        "level": first["level"],
        "quantity": first["quantity"],
        "words": words,
        "n": len(rows),
        statistics.WITHIN: within,
        **known,
    }
