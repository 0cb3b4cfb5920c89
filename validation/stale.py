"""The golden rows of studies, computed again: whether the CSVs in docs/reports/data are still what the code computes.

    python -m validation stale [NAME ...] [--within SECONDS] [--known REASON]

The cheapest study is first. A row is the same, has moved (row, column, kept and present value), or has moved as
validation/moved.csv lists it: known since a day, for a reason, until the study is computed again. The exit code is 1
where a row has moved otherwise, where one that is listed is the same again, and where the study's file is no longer
that of the CSV. `--known` writes what has moved today to the list.

The ledger of claims stands as a study (`claims.golden_rows`). Rows of measured.csv have no golden rows: they are long.
`python -m validation measured ... --known REASON` lists those that are of earlier code, with no present value, and
leave it when they are computed. Pages say what is listed.
"""

from __future__ import annotations

import csv
import sys
from collections import Counter
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from fabrics.base.errors import InputError
from fabrics.base.files import write_whole
from validation import again, csv_file, golden, origin, study
from validation.again import Cell, Outcome
from validation.claims import golden_rows
from validation.csv_file import DATA
from validation.golden import Golden
from validation.study import Study

LIST = Path(__file__).parent / "moved.csv"
HEADINGS = ("study", "row", "column", "kept", "now", "since", "reason")
CLAIMS = golden_rows.STUDY
SAME = "same"
KNOWN = "known"
MOVED = "MOVED"
AGAIN = "AGAIN"  # listed as moved, and the same
NO_ROW = "no row"
WRONG = (MOVED, AGAIN)
MEASURED = "measured"  # in place of a study: a row of measured.csv, which is of earlier code
INPUTS = "inputs"  # in place of a column: the study's file is not that of the CSV
NOTES = {
    "names": "of studies, or claims; all by default",
    "within": "seconds of CPU time: the cheapest studies that take no more in all",
    "known": "reason for which what moves now is listed in validation/moved.csv",
}
Listed = dict[str, str]  # a row of LIST


@dataclass(frozen=True)
class Verdict:
    """What is said of a study: its state, CPU time [s], and a line for each thing that there is to tell."""

    name: str
    state: str
    seconds: float
    lines: list[str]


def main(names: Sequence[str] = (), *, within: float = 0.0, known: str = "") -> int:
    """Compute golden rows; returns 1 where one has moved that is not listed, else 0.

    Raises
    ------
    InputError : a study that there is not, or one whose golden rows are not in its CSV
    """
    chosen = [named(name) for name in names or (CLAIMS.name, *study.all_names())]
    cheap, dear = in_order(chosen, within)
    listed = read()
    verdicts = []
    without = [this for this in chosen if golden.table(this).none]
    for this in [*cheap, *without]:
        made, records = csv_file.read(DATA / f"{this.name}.csv")
        if this is CLAIMS:
            outcome = golden_rows.compare(records)
        else:
            outcome = again.compare(this, records)
            outcome.moves.extend(changed_inputs(this, made))
        if known:
            listed = relisted(this, outcome.moves, listed, known)
        verdicts.append(judge(this, outcome, listed))
        tell(verdicts[-1])
    if known:
        write(listed)
    counts = Counter(verdict.state for verdict in verdicts)
    told = ", ".join(f"{count} {state}" for state, count in counts.items())
    seconds = sum(verdict.seconds for verdict in verdicts)
    print(f"{told}, {len(dear)} not computed; {seconds:.0f} CPU s")
    return int(any(verdict.state in WRONG for verdict in verdicts))


def named(name: str) -> Study:
    """Read a study by its name; the ledger of claims stands as one."""
    if name == CLAIMS.name:
        return CLAIMS
    return study.load(name)


def in_order(chosen: Sequence[Study], within: float) -> tuple[list[Study], list[Study]]:
    """Order studies with golden rows by their CPU time: those that take no more than `within` [s] together, and others.

    Without `within` none is left out.
    """
    costs = {this.name: golden.table(this).cpu_s for this in chosen if golden.table(this).rows}
    ordered = sorted(
        (this for this in chosen if this.name in costs), key=lambda this: costs[this.name]
    )
    if not within:
        return ordered, []
    spent = 0.0
    for number, this in enumerate(ordered):
        spent += costs[this.name]
        if spent > within:
            return ordered[:number], ordered[number:]
    return ordered, []


def changed_inputs(this: Study, made: str) -> list[Cell]:
    """Compare the file of a study with the digest in the first line of its CSV: a cell if it is another one."""
    kept = origin.read(made).get("inputs", origin.UNKNOWN)
    now = origin.inputs_of(this)
    if kept in (origin.UNKNOWN, now):
        return []
    return [Cell("", INPUTS, kept, now)]


def judge(this: Study, outcome: Outcome, listed: Sequence[Listed]) -> Verdict:
    """Judge a study by what has moved, and by the list."""
    entries = [entry for entry in listed if entry["study"] == this.name]
    rules = golden.table(this)
    lines = []
    state = SAME
    if rules.none:
        state = NO_ROW
        lines.append(rules.none)
    known = 0
    for move in outcome.moves:
        entry = find(move, entries, rules)
        line = f"{move.row}: {move.column}: {move.kept} -> {csv_file.text(move.now)}"
        if entry is not None:
            known += 1
            line += f" (since {entry['since']}: {entry['reason']})"
        lines.append(line)
    if outcome.moves:
        state = KNOWN
    if len(entries) > known:
        state = AGAIN
        lines.append("validation/moved.csv lists what has not moved so: take it off, by --known")
    if len(outcome.moves) > known:
        state = MOVED
    return Verdict(this.name, state, outcome.seconds, lines)


def find(move: Cell, entries: Sequence[Listed], of_study: Golden) -> Listed | None:
    """Find the entry of the list that has a move, with the values that it has today."""
    for entry in entries:
        place = (entry["row"], entry["column"], entry["kept"])
        if place == (move.row, move.column, move.kept) and holds(entry["now"], move, of_study):
            return entry
    return None


def holds(listed: str, move: Cell, of_study: Golden) -> bool:
    """Say whether a listed value is that of today; a digest is no number."""
    if move.column == INPUTS:
        return listed == move.now
    return again.agrees(listed, move, of_study)


def relisted(
    this: Study, moves: Sequence[Cell], listed: Sequence[Listed], reason: str
) -> list[Listed]:
    """Return the list with the moves of a study in place of those that it had; what stays keeps its day and reason."""
    others = [entry for entry in listed if entry["study"] != this.name]
    own = [entry for entry in listed if entry["study"] == this.name]
    today = datetime.now(UTC).strftime("%Y-%m-%d")
    for move in moves:
        entry = find(move, own, golden.table(this))
        if entry is None:
            values = (
                this.name,
                move.row,
                move.column,
                move.kept,
                csv_file.text(move.now),
                today,
                reason,
            )
            entry = dict(zip(HEADINGS, values))
        others.append(entry)
    return others


def with_measured(values: Mapping[str, str], reason: str, listed: Sequence[Listed]) -> list[Listed]:
    """Return the list with rows of measured.csv, {id: kept value}, that are of earlier code."""
    today = datetime.now(UTC).strftime("%Y-%m-%d")
    found = without_measured(values, listed)
    for id, kept in values.items():
        row = (MEASURED, id, "computed", kept, "", today, reason)
        found.append(dict(zip(HEADINGS, row)))
    return found


def without_measured(ids: Container[str], listed: Sequence[Listed]) -> list[Listed]:
    """Return the list without rows of measured.csv, which are computed."""
    return [entry for entry in listed if entry["study"] != MEASURED or entry["row"] not in ids]


def tell(verdict: Verdict) -> None:
    """Print a verdict."""
    print(f"{verdict.seconds:6.1f} s  {verdict.state:6}  {verdict.name}")
    for line in verdict.lines:
        print(f"                  {line}")
    sys.stdout.flush()


def read() -> list[Listed]:
    """Read what is known to have moved.

    Raises
    ------
    InputError : other headings
    """
    with open(LIST, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if tuple(reader.fieldnames or ()) != HEADINGS:
            raise InputError("has other headings", file=LIST, allowed=", ".join(HEADINGS))
        return list(reader)


def write(listed: Sequence[Listed]) -> None:
    """Write what is known to have moved, by study."""
    with write_whole(LIST) as file:
        writer = csv.DictWriter(file, HEADINGS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(listed, key=lambda entry: entry["study"]))
