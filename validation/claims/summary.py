"""The ledger in short: verdicts by topic, the share that is reproduced, and the table as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from fabrics.files import write_whole
from validation.claims import variants
from validation.claims.claims import KINDS, TOPICS, Claim
from validation.claims.judge import BROKEN, LEFT_OUT, MISSED, NOT_TESTABLE, REPRODUCED, VERDICTS, Record, expected

COLUMNS = ("id", "topic", "kind", "basis", "origin", "source", "quantity", "verdict", "computed against target",
           "missed by", "cause", "why", "erratum", "reason of the tolerance", "remark", "seconds", "shots",
           "variants")  # fmt: skip


@dataclass(frozen=True)
class Share:
    """Verdicts of one topic or kind, or of all.

    Parameters
    ----------
    topic : of TOPICS (or of KINDS), or "" for all
    counts : {verdict: number}
    """

    topic: str
    counts: dict

    @property
    def compared(self) -> int:
        """Claims of which our number says whether they hold here."""
        return self.counts[REPRODUCED] + self.counts[MISSED]

    @property
    def reproduced(self) -> float | None:
        """[-] of those, or None where there are none."""
        return self.counts[REPRODUCED] / self.compared if self.compared else None

    @property
    def total(self) -> int:
        return sum(self.counts.values())


def shares(claims: Sequence[Claim], records: Sequence[Record], by: str = "topic") -> list[Share]:
    """Of all claims, then of each topic (or kind, `by`) that has some."""
    verdicts = {record.id: record.verdict for record in records}
    chosen = [claim for claim in claims if claim.id in verdicts]
    found = []
    for name in ("", *(TOPICS if by == "topic" else KINDS)):
        own = [verdicts[claim.id] for claim in chosen if not name or getattr(claim, by) == name]
        if own:
            found.append(Share(name, {verdict: own.count(verdict) for verdict in VERDICTS}))
    return found


def changed(claims: Sequence[Claim], records: Sequence[Record]) -> dict[str, str]:
    """{id: "recorded -> found"} of the claims whose check ended with another verdict than is recorded for it.

    Nothing is said of checks that were left out, that need a package which is not installed, or that have no recorded
    verdict and came to an end.
    """
    found = {}
    by_id = {record.id: record.verdict for record in records}
    for claim in (claim for claim in claims if claim.check and claim.id in by_id):
        verdict, expected = by_id[claim.id], claim.turned.partition(":")[0] or claim.verdict
        if verdict == BROKEN or (expected and verdict not in (expected, LEFT_OUT, NOT_TESTABLE)):
            found[claim.id] = f"{expected} -> {verdict}"
    return found


def targets(claim: Claim) -> str:
    """What would bear a claim out, in words."""
    return "; ".join(f"{condition.name} {expected(condition)}" for condition in claim.conditions)


def rows(claims: Sequence[Claim], records: Sequence[Record]) -> Iterator[tuple[str, ...]]:
    """One row of texts a claim, in the order of COLUMNS."""
    by_id = {record.id: record for record in records}
    for claim in claims:
        record = by_id.get(claim.id)
        if record is None:
            continue
        yield (
            claim.id, claim.topic, claim.kind, claim.basis, claim.origin, claim.source, claim.quantity, record.verdict,
            record.text or targets(claim), record.miss, claim.cause if record.verdict == MISSED else "",
            claim.against or claim.data or claim.incomparable or claim.untestable or claim.unbuilt, claim.erratum,
            claim.reason, record.note, f"{record.seconds:.2f}", record.setting, variants.summary(record),
        )  # fmt: skip


def write_csv(claims: Sequence[Claim], records: Sequence[Record], path: Path) -> None:
    """Write the ledger as a table, whole or not at all."""
    with write_whole(path) as file:
        table = csv.writer(file)
        table.writerow(COLUMNS)
        table.writerows(rows(claims, records))
