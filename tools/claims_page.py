"""What pages say of the claims of the thesis, from docs/reports/data/claims.csv (`validation.claims.command`)."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from validation.claims import claims, judge, turns
from validation.claims.judge import BROKEN, MISSED, REPRODUCED, VERDICTS
from validation.csv_file import read

DATA = Path(__file__).parents[1] / "docs" / "reports" / "data" / "claims.csv"
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


@dataclass(frozen=True)
class Share:
    """How many claims of a kind are decided, and how many of these are reproduced."""

    decided: int
    reproduced: int

    @property
    def missed(self) -> int:
        """How many are missed."""
        return self.decided - self.reproduced


def shares() -> dict[str, Share]:
    """Return {"equations" or "behaviour": Share} of the claims of the thesis."""
    analytic = {claim.id for claim in claims.load() if claim.basis == "analytic"}
    found = {}
    for name, of_equations in (("equations", True), ("behaviour", False)):
        rows = [row for row in of_thesis(read(DATA)[1]) if (row["id"] in analytic) is of_equations]
        n = counts(rows)
        found[name] = Share(n[REPRODUCED] + n[MISSED], n[REPRODUCED])
    return found


def in_short() -> str:
    """Say the three counts of the ledger in short."""
    found = shares()
    n = counts(of_thesis(read(DATA)[1]))
    equations = found["equations"]
    behaviour = found["behaviour"]
    return (
        f"{equations.reproduced} of {equations.decided} equations and closed forms are implemented as the thesis has "
        f"them, {behaviour.reproduced} of {behaviour.decided} statements on behaviour are reproduced and "
        f"{behaviour.missed} missed, and {n[judge.DATA]} repeat data"
    )


def in_words() -> str:
    """Write the counts of the ledger in words."""
    _, rows = read(DATA)
    thesis, others = of_thesis(rows), of_thesis(rows, False)
    n, more = counts(thesis), counts(others)
    text = f"""`python -m validation claims --slow` checks {len(thesis)} claims of the thesis:
    {in_short()}. {n[judge.OPEN]} are open, since the text does not say which of several readings it means and they
    differ. {n[judge.WRONG]} are evidence of an error of the thesis, {n[judge.NOT_COMPARABLE]} are not comparable,
    {n[judge.DOUBLE]} say what another one says, {n[judge.NOT_BUILT]} is not built yet, and {n[judge.NOT_TESTABLE]}
    cannot be tested.
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
    return " " + read(DATA)[0].partition(";")[0]


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
    """Tabulate each claim of the thesis that is missed, with its cause in a line, after what causes there are."""
    rows = [row for row in of_thesis(read(DATA)[1]) if row["verdict"] == MISSED]
    of = Counter(row["because"] for row in rows)
    kinds = [["because", "claims", "meaning"]]
    kinds += [[name, of[name], meaning] for name, meaning in judge.CAUSES.items()]
    found = [["claim", "thesis", "here", "because", "cause"]]
    for row in rows:
        told = [row["published"], row["computed"], row["because"], _sentence(row["cause"])]
        found.append([f"`{row['id']}`", *told])
    return f"\n\n{markdown(kinds)}\n{markdown(found)}\n"


def open_claims() -> str:
    """Tabulate each open claim, with what the text leaves open and the number of each reading."""
    found = [["claim", "thesis", "readings", "what the text leaves open"]]
    for row in of_thesis(read(DATA)[1]):
        if row["verdict"] == judge.OPEN:
            found.append(
                [f"`{row['id']}`", row["published"], row["computed"], _sentence(row["cause"])]
            )
    return f"\n\n{markdown(found)}\n"


def turned() -> str:
    """Say how many of the reproduced claims a tenth of an input turns, and how many have not been looked through."""
    looked = read(DATA.parent / turns.FILE)[1]
    reproduced = counts(read(DATA)[1])[REPRODUCED]
    known = {row["id"] for row in looked}
    left = [
        claim for claim in claims.load() if claim.verdict == REPRODUCED and claim.id not in known
    ]
    take_runs = sum(bool(claim.run) for claim in left)
    by_clock = sum(claim.id in turns.OF_CLOCKS for claim in left)
    found = [row for row in looked if row["change"] != turns.NONE]
    by = Counter(row["change"].rsplit(" ", 2)[0] for row in found)
    inputs = ", ".join(f"{name} {number}" for name, number in by.most_common())
    solved = len(left) - take_runs - by_clock
    return (
        f" {len(looked)} of the {reproduced} reproduced claims have been looked through; of {len(found)} a change of "
        f"an input by a tenth turns the verdict ({inputs}), of {len(looked) - len(found)} none does. {len(left)} have "
        f"not: {take_runs} take shots or the 3D crossover, up to {len(turns.OF_RUNS)} times each; {by_clock} compares "
        f"CPU times, which differ by more; {solved} solve many cells and are not finished "
    )


def _sentence(text):
    """The first sentence of a text."""
    return re.split(r"(?<=[a-z0-9)%])\. (?=[A-Z])", text, maxsplit=1)[0].rstrip(".")
