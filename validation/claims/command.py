"""The ledger of the thesis's claims: every claim that is a number, an order, a trend, a shape or an outcome, judged.

    python -m validation claims --topics impact1 cell

A missed claim is a result, not an error; a result other than the recorded one ends with exit code 1. Claims that rest
on shots at one ply are judged as computed and in four variants: the cell formulation of the thesis, nominal denier, 2
elements per crossover, elastic-plastic bored projectile.

claims.csv has every claim with its verdict, our number beside the thesis's. `--out docs/reports/data` renews that of
the documentation; then `python tools/pages.py`. What is computed is kept in results/claims, and taken from there by the
same code.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from fabrics.base.errors import InputError
from validation import origin, study
from validation.claims import claims as data
from validation.claims import judge, runner, table
from weavecell.cli.from_signature import CORES
from weavecell.results import progress

NOTES = {
    "topics": "those to judge; all if none is given",
    "slow": "also those that take minutes each",
    "no_variants": "as computed alone, not in the variants",
    "out": "folder of the CSV",
}
KEPT = Path("results/claims")


def main(
    *,
    topics: Sequence[str] = (),
    slow: bool = False,
    no_variants: bool = False,
    jobs: int = CORES,
    executor: str = "local",
    out: Path = KEPT,
) -> int:
    """Run the ledger; returns the exit code: 1 where a verdict is not the recorded one, else 0, for a miss is a result.

    Raises
    ------
    InputError : an unknown topic; nothing has been written
    """
    for topic in set(topics) - set(data.topics()):
        raise InputError(key="--topics", value=topic, allowed=", ".join(data.topics()))
    claims = [claim for claim in data.load() if not topics or claim.topic in topics]
    with progress.bar(f"{len(claims)} claims") as advance:
        records = runner.validate(
            claims,
            KEPT / "runs",
            slow=slow,
            vary=not no_variants,
            jobs=jobs,
            executor=executor,
            report=lambda done, total: advance(done / max(total, 1)),
        )
    options = " --slow" * slow + " --no-variants" * no_variants
    inputs = origin.digest_of_files(*Path(__file__).parent.glob("*.toml"))
    made = origin.write(f"claims{options}", inputs, origin.spent())
    study.write(out / "claims.csv", table.rows(claims, records), made)
    counts = Counter(record.verdict for record in records)
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    print(f"written to {out}/claims.csv", flush=True)
    code = 0
    for claim, record in zip(claims, records):
        if judge.changed(claim, record.verdict):
            told = f"{record.verdict}, where {claim.verdict} is recorded (validation/claims/*.toml)"
            print(f"{claim.id}: {told}")
            code = 1
    return code
