"""docs/reports/claims.md: counts by verdict, and every claim with its computed and its published value.

The page is made from rows of texts, which are stored beside it (data/claims.csv). `tools/pages.py` takes the counts of
README and of validation.md from there.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fabrics.errors import InputError
from fabrics.files import write_whole
from validation.claims import judge, variants
from validation.claims.claims import TOPICS
from validation.claims.judge import MISSED, REPRODUCED, VERDICTS
from validation.marked_page import markdown

Table = Sequence[dict[str, str]]
DATA = "data/claims.csv"
COLUMNS = ("id", "topic", "origin", "section", "verdict", "computed", "published", "cause", "shots", "variants")
_LEAD = """\
# Claims of the thesis and computed values

*Which statements of the thesis does the code reproduce, which does it miss, and why?*

Computed at commit {commit} on {date} by `{command}` ({cost}). Not to be edited by hand; the rows are in
[data/claims.csv](data/claims.csv) too.

A claim is a statement of the thesis that a computation can confirm or contradict: a number, an order, a trend, a
shape or an outcome. "Published" is the value of the thesis, or the condition that follows from its statement, with
its tolerance. Tolerances were set before the comparison; an audit has narrowed some of them since. "Computed" is
the value of this software. Nothing is fitted to a claim, and no tolerance is widened to turn a miss.
"""
_VARIANTS = """\
A claim on impacts on one ply is checked with a rigid projectile, the variational cell formulation, the linear density
that the tables of the thesis imply (erratum E-07) and one element per crossover, and again in four variants: {names}.
"Holds in 5 of 5" means that its conditions are met in all five. Packs are not varied.
"""


def rows(claims: Sequence[Any], records: Sequence[Any]) -> list[dict[str, str]]:
    """One row of texts a claim, with the keys COLUMNS."""
    by_id = {record.id: record for record in records}
    found = []
    for claim in claims:
        record = by_id[claim.id]
        why = claim.against or claim.data or claim.incomparable or record.note
        if record.verdict == MISSED:
            why = claim.cause or (record.text if not record.found else "")
        elif record.verdict == REPRODUCED:
            why = ""
        texts = (
            claim.id, claim.topic, claim.origin, claim.source, record.verdict,
            "; ".join(judge.computed(condition, record.found) for condition in claim.conditions if record.found),
            "; ".join(judge.expected(condition) for condition in claim.conditions),
            why, record.setting, variants.summary(record),
        )  # fmt: skip
        found.append(dict(zip(COLUMNS, (" ".join(text.split()) for text in texts), strict=True)))
    return found


def counts(table: Table) -> Counter[str]:
    """{verdict: number of rows}."""
    return Counter(row["verdict"] for row in table)


def sentence(table: Table) -> str:
    """The counts in words, as README has them; those of the thesis alone, then the additional ones."""
    thesis, others = _split(table)
    n, more = counts(thesis), counts(others)
    decided = n[REPRODUCED] + n[MISSED]
    return (
        f"{len(thesis)} claims of the thesis: of the {decided} that are decided, "
        f"{n[REPRODUCED]} are reproduced ({100 * n[REPRODUCED] / max(decided, 1):.0f} %) and {n[MISSED]} missed; "
        f"{n[judge.DATA]} compare input data or a closed form with themselves and are in no percentage; "
        f"{n[judge.WRONG]} are evidence of an error of the thesis; {n[judge.NOT_COMPARABLE]} are not comparable; "
        f"{n[judge.NOT_BUILT]} not built yet; {n[judge.NOT_TESTABLE]} cannot be tested; "
        f"{n[judge.LEFT_OUT]} slow ones are left out. Of {len(others)} additional claims, which the project adds, "
        f"{more[REPRODUCED]} are reproduced, {more[MISSED]} missed and {more[judge.LEFT_OUT]} left out"
    )


def variants_sentence(table: Table) -> str:
    """In how many claims on shots a variant changes the result, in words, as validation.md has it."""
    varied = [row for row in table if row["variants"]]
    changed = [row for row in varied if "; " in row["variants"]]
    whole = sum(row["variants"] == "holds in 5 of 5" for row in varied)
    return f"Of {len(varied)} such claims {whole} hold in 5 of 5, and a variant changes the result of {len(changed)}"


def of_thesis(table: Table) -> list[dict[str, str]]:
    """The rows of the claims of the thesis, without the additional ones."""
    return _split(table)[0]


def _split(table):
    """(rows of the claims of the thesis, rows of the additional ones)"""
    from validation.claims import claims as data

    added = {entry["id"] for entry in data.entries(data.FILES[1])}
    return tuple([row for row in table if (row["id"] in added) is own] for own in (False, True))


def lines(table: Table, command: str, commit: str, date: str, cost: str) -> str:
    """The page."""
    parts = [_LEAD.format(command=command, commit=commit, date=date, cost=cost), "## Counts\n"]
    parts += [f"{sentence(table)[0].upper()}{sentence(table)[1:]}.\n", _count_table(table)]
    parts += ["".join(f"- {verdict}: {meaning}\n" for verdict, meaning in VERDICTS.items())]
    changed = [row for row in table if "; " in row["variants"]]
    parts += ["## Variants\n", _VARIANTS.format(names=", ".join(variants.VARIANTS)), f"{variants_sentence(table)}:\n"]
    parts += [markdown([["claim", "variants"], *([f"`{row['id']}`", row["variants"]] for row in changed)])]
    for topic, title in TOPICS.items():
        own = [row for row in table if row["topic"] == topic]
        if own:
            parts += [f"## {title}\n", _claim_table(own)]
    return "\n".join(parts)


def _count_table(table):
    """Counts of the claims of the thesis by topic, of all of them, and of the additional ones."""
    thesis, others = _split(table)
    parts = [(title, [row for row in thesis if row["topic"] == topic]) for topic, title in TOPICS.items()]
    parts += [("claims of the thesis", thesis), ("additional claims", others)]
    found = [["topic", *VERDICTS]]
    for title, own in parts:
        n = counts(own)
        if n:
            found.append([title, *(str(n[verdict]) for verdict in VERDICTS)])
    return markdown(found)


def _claim_table(own):
    shots = any(row["variants"] for row in own)
    head = ["claim", "thesis", "result", "computed", "published", "cause or remark"] + ["variants"] * shots
    keys = ("section", "verdict", "computed", "published", "cause") + ("variants",) * shots
    return markdown([head, *([f"`{row['id']}`", *(row[key].replace("|", "/") for key in keys)] for row in own)])


def read(path: Path) -> list[dict[str, str]]:
    """The rows that `write` has stored."""
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(path: Path, table: Table, **stamp: str) -> None:
    """Write the page, and its rows beside it.

    Parameters
    ----------
    path : of the page; the rows go to data/ beside it
    table : of `rows`
    stamp : command, commit, date and cost, as texts

    Raises
    ------
    InputError : the folder of the page does not exist
    """
    if not path.parent.is_dir():
        raise InputError(key="--page", value=path, allowed="a file in a folder that exists")
    (path.parent / DATA).parent.mkdir(exist_ok=True)
    with write_whole(path.parent / DATA) as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(table)
    with write_whole(path) as file:
        file.write(lines(table, **stamp))
