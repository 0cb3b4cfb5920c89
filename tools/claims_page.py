"""What pages say of the claims of the thesis, from docs/reports/data/claims.csv (`validation.claims.command`)."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from validation.claims import claims, judge
from validation.claims.judge import BROKEN, MISSED, REPRODUCED, VERDICTS
from validation.study import read

DATA = Path(__file__).parents[1] / "docs" / "reports" / "data" / "claims.csv"
MOST_TOPICS = 11  # that have a row of their own in the table of missed claims
Table = list[dict[str, str]]


def markdown(rows: Sequence[Sequence[object]]) -> str:
    """Format rows, the first of which is the head, as a table in Markdown."""
    rows = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
    return "".join("| " + " | ".join(map(str, row)) + " |\n" for row in rows)


def counts(table: Table) -> Counter[str]:
    """Count the rows of each verdict: {verdict: number}."""
    return Counter(row["verdict"] for row in table)


def of_thesis(table: Table, own: bool = True) -> Table:
    """Select the rows of the claims of the thesis, or those of the additional claims."""
    added = {entry["id"] for entry in claims.entries(claims.FILES[1])}
    return [row for row in table if (row["id"] not in added) is own]


def decided_and_reproduced() -> tuple[int, int]:
    """Count the claims of the thesis that are decided, and those of these that are reproduced."""
    found = counts(of_thesis(read(DATA)[1]))
    return found[REPRODUCED] + found[MISSED], found[REPRODUCED]


def in_short() -> str:
    """Say in short how many claims of the thesis are reproduced."""
    decided, reproduced = decided_and_reproduced()
    share = f"{100 * reproduced / decided:.0f} %"
    return f"of the {decided} that are decided, {reproduced} are reproduced ({share}) and {decided - reproduced} missed"


def in_words() -> str:
    """Write the counts of the ledger in words."""
    _, rows = read(DATA)
    thesis, others = of_thesis(rows), of_thesis(rows, False)
    n, more = counts(thesis), counts(others)
    text = f"""`python -m validation claims --slow` checks {len(thesis)} claims of the thesis.
    {in_short().capitalize()}. The percentage leaves out
    {n[judge.DATA]} that compare input data or a closed form with themselves,
    {n[judge.WRONG]} that are evidence of an error of the thesis, {n[judge.NOT_COMPARABLE]} that are not comparable,
    {n[judge.NOT_BUILT]} that is not built yet, and {n[judge.NOT_TESTABLE]} that cannot be tested.
    Of {len(others)} additional claims, which the project adds, {more[REPRODUCED]} are reproduced and {more[MISSED]}
    missed. Claims on shots at one ply are checked in four variants of the model as well. {_in_variants(rows)}."""
    return "\n\n" + textwrap.fill(" ".join(text.split()), 118, break_on_hyphens=False) + "\n\n"


def _in_variants(table):
    """In how many claims on shots a variant changes the result, in words."""
    varied = [row["variants"] for row in table if row["variants"]]
    whole = varied.count("holds in 5 of 5")
    changed = sum("; " in text for text in varied)
    return f"Of {len(varied)} such claims {whole} hold in 5 of 5, and a variant changes the result of {changed}"


def made() -> str:
    """Say how the file of claims was made."""
    return f" {read(DATA)[0]}"


def verdicts() -> str:
    """Tabulate how many claims have each verdict."""
    _, rows = read(DATA)
    thesis, others = counts(of_thesis(rows)), counts(of_thesis(rows, False))
    told = [["verdict", "of the thesis", "additional", "meaning"]]
    for name, meaning in VERDICTS.items():
        if name not in (BROKEN, judge.LEFT_OUT):
            told.append([name, thesis[name], others[name], meaning])
    return f"\n\n{markdown(told)}\n"


def missed() -> str:
    """Tabulate the missed claims by topic, most first; the topics with the fewest in one row."""
    parts: dict[str, Table] = {topic: [] for topic in claims.topics()}
    for row in read(DATA)[1]:
        parts[row["topic"]].append(row)
    ranked = sorted(parts, key=lambda topic: -counts(parts[topic])[MISSED])
    named = [(claims.topics()[topic], parts[topic]) for topic in ranked[:MOST_TOPICS]]
    rest = list(chain(*map(parts.get, ranked[MOST_TOPICS:])))
    found = [["topic", "decided", "missed", "which"]]
    for title, own in [*named, ("all other topics", rest)]:
        which = [f"`{row['id']}`" for row in own if row["verdict"] == MISSED]
        found.append([title, counts(own)[REPRODUCED] + len(which), len(which), ", ".join(which)])
    return f"\n\n{markdown(found)}\n"
