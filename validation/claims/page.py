"""docs/reports/data/claims.csv, a row of texts a claim, and what is made of it: docs/reports/claims.md and the counts
of README and validation.md (`tools/pages.py`)."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from fabrics.base import files
from validation import study
from validation.claims import claims as data
from validation.claims import judge
from validation.claims.claims import Claim
from validation.claims.judge import BROKEN, MISSED, NOT_TESTABLE, REPRODUCED, VERDICTS, Record
from validation.claims.runner import VARIANTS

Table = list[dict[str, str]]  # of texts by COLUMNS
DATA = "data/claims.csv"
COLUMNS = (
    "id",
    "topic",
    "origin",
    "section",
    "verdict",
    "computed",
    "published",
    "cause",
    "variants",
)
MOST_TOPICS = 11  # that have a row of their own in the table of missed claims
_PAGE = """\
# Claims of the thesis and computed values

*Which statements of the thesis does the code reproduce, and which does it miss?*

Computed at commit {commit} on {date} by `{command}`. Not to be edited by hand. [data/claims.csv](data/claims.csv) has
every claim with its computed and its published value, and the cause of each miss as far as it is known.

A claim is a statement of the thesis that a computation can confirm or contradict: a number, an order, a trend, a
shape or an outcome. `validation/claims/claims.toml` has for each its runs, what of them would bear it out, and the
tolerance with its reason; `validation/claims/readers.py` has the names that its expressions use. Tolerances were set
before the comparison; an audit has narrowed some since. Nothing is fitted to a claim, and no tolerance is widened to
turn a miss. A test holds each claim to its recorded verdict.

## Counts

{counts}
## Missed claims

{missed}
## Variants

A claim on impacts on one ply is judged with a rigid projectile, the variational cell formulation, the linear density
that the tables of the thesis imply (erratum E-07) and one element per crossover, and again in four variants: {names}.
"Holds in 5 of 5" means that its conditions are met in all five. Packs are not varied. {varied}.
"""


def rows(claims: Sequence[Claim], records: Sequence[Record]) -> Table:
    """One row a claim."""
    return [_row(claim, record) for claim, record in zip(claims, records, strict=True)]


def _row(claim, record):
    why = claim.against or claim.data or claim.incomparable or record.note
    if record.verdict == MISSED:
        why = claim.cause or record.note
    elif record.verdict == REPRODUCED:
        why = ""
    found = []
    if record.found:
        found = [judge.computed(c, record.found[c.name]) for c in claim.conditions]
    texts = (
        claim.id,
        claim.topic,
        claim.origin,
        claim.source,
        record.verdict,
        "; ".join(found),
        "; ".join(map(judge.expected, claim.conditions)),
        why,
        _in_variants(record),
    )
    return {column: " ".join(text.split()) for column, text in zip(COLUMNS, texts, strict=True)}


def _in_variants(record):
    """ "holds in 4 of 5; missed with nominal denier"; "" for a claim without variants."""
    if not record.variants or record.verdict == NOT_TESTABLE:
        return ""
    verdicts = [record.verdict]
    changed = ""
    for name in VARIANTS:
        verdict = record.variants.get(name, record.verdict)
        verdicts.append(verdict)
        if verdict != record.verdict:
            changed += f", {verdict} with {name}"
    held = verdicts.count(REPRODUCED) + verdicts.count(judge.WRONG)
    return f"holds in {held} of {len(verdicts)}{changed.replace(',', ';', 1)}"


def counts(table: Table) -> Counter[str]:
    """{verdict: number of rows}."""
    return Counter(row["verdict"] for row in table)


def of_thesis(table: Table, own: bool = True) -> Table:
    """The rows of the claims of the thesis, or those of the additional claims."""
    added = {entry["id"] for entry in data.entries(data.FILES[1])}
    return [row for row in table if (row["id"] not in added) is own]


def variants_sentence(table: Table) -> str:
    """In how many claims on shots a variant changes the result, in words, as validation.md has it."""
    varied = [row["variants"] for row in table if row["variants"]]
    whole = varied.count("holds in 5 of 5")
    changed = sum("; " in text for text in varied)
    return f"Of {len(varied)} such claims {whole} hold in 5 of 5, and a variant changes the result of {changed}"


def lines(table: Table, command: str, commit: str, date: str) -> str:
    """The page."""
    thesis = counts(of_thesis(table))
    others = counts(of_thesis(table, False))
    told: list[list[object]] = [["verdict", "of the thesis", "additional", "meaning"]]
    for name, meaning in VERDICTS.items():
        if name != BROKEN:
            told.append([name, thesis[name], others[name], meaning])
    return _PAGE.format(
        command=command,
        commit=commit,
        date=date,
        counts=study.markdown(told),
        missed=study.markdown(_missed(table)),
        names=", ".join(VARIANTS),
        varied=variants_sentence(table),
    )


def _missed(table):
    """Claims missed by topic, most first; the topics with the fewest in one row."""
    parts: dict[str, Table] = {topic: [] for topic in data.topics()}
    for row in table:
        parts[row["topic"]].append(row)
    ranked = sorted(parts, key=lambda topic: -counts(parts[topic])[MISSED])
    named = [(data.topics()[topic], parts[topic]) for topic in ranked[:MOST_TOPICS]]
    rest = list(chain(*map(parts.get, ranked[MOST_TOPICS:])))
    found: list[list[object]] = [["topic", "decided", "missed", "which"]]
    for title, own in [*named, ("all other topics", rest)]:
        missed = [f"`{row['id']}`" for row in own if row["verdict"] == MISSED]
        found.append([title, counts(own)[REPRODUCED] + len(missed), len(missed), ", ".join(missed)])
    return found


def read(path: Path) -> Table:
    """The rows that `write` has stored."""
    return list(csv.DictReader(path.read_text("utf-8").splitlines()))


def write(path: Path, table: Table, **stamp: str) -> None:
    """Write the page, and its rows to data/ beside it; `stamp` as of `lines`."""
    study.write(path.parent / DATA, table)
    files.write(path, lines(table, **stamp))
