"""The rows of docs/reports/data/claims.csv: what is claimed and what was computed, a row of texts a claim."""

from __future__ import annotations

from collections.abc import Sequence

from validation.claims import judge
from validation.claims.claims import Claim
from validation.claims.judge import MISSED, NOT_TESTABLE, REPRODUCED, Record
from validation.claims.runner import VARIANTS

FILE = "claims.csv"
Row = dict[str, str]


def rows(claims: Sequence[Claim], records: Sequence[Record]) -> list[Row]:
    """Make one row a claim."""
    return [
        explained(claim, _row(claim, record)) for claim, record in zip(claims, records, strict=True)
    ]


def explained(claim: Claim, row: Row) -> Row:
    """Give a missed row the cause that the ledger has today, which takes no computation."""
    if row["verdict"] != MISSED:
        return row | {"because": ""}
    cause = " ".join(claim.cause.split())
    return row | {"because": claim.because, "cause": cause or row["cause"]}


def _row(claim, record):
    why = claim.against or claim.data or claim.incomparable or claim.undecided or record.note
    if claim.double:
        why = f"counted as {claim.double}"
    if record.verdict == MISSED:
        why = record.note
    elif record.verdict == REPRODUCED:
        why = ""
    found = []
    if record.found:
        found = [judge.computed(c, record.found[c.name]) for c in claim.conditions]
    texts = {
        "id": claim.id,
        "topic": claim.topic,
        "origin": claim.origin,
        "section": claim.source,
        "verdict": record.verdict,
        "computed": "; ".join(found),
        "published": "; ".join(map(judge.expected, claim.conditions)),
        "cause": why,
        "variants": _in_variants(record),
    }
    return {column: " ".join(text.split()) for column, text in texts.items()}


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
