"""The ledger of the thesis's claims: every claim that is a number, an order, a trend, a shape or an outcome, judged.

    python -m validation claims --topics impact1 cell

A missed claim is a result, not an error; a result other than the recorded one ends with exit code 1. Claims that rest
on shots at one ply are judged as computed and in four variants: the cell formulation of the thesis, nominal denier, 2
elements per crossover, elastic-plastic bored projectile.

The folder
    ledger.csv     every claim with its verdict, our number beside the thesis's
    runs/          what is done, from which --resume goes on
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics.base.errors import InputError
from validation import study
from validation.claims import claims as data
from validation.claims import judge, runner
from validation.claims import page as pages
from weavecell.cli.from_signature import CORES
from weavecell.results import out_folder, progress, provenance

NOTES = {
    "topics": "those to judge; all if none is given",
    "slow": "also those that take minutes each",
    "no_variants": "as computed alone, not in the variants",
}


def main(
    *,
    topics: Sequence[str] = (),
    slow: bool = False,
    no_variants: bool = False,
    jobs: int = CORES,
    executor: str = "local",
    resume: bool = False,
    out: Path = Path("results/validate"),
    page: Path | None = None,
) -> int:
    """Run the ledger; returns the exit code: 1 where a verdict is not the recorded one, else 0, for a miss is a result.

    Raises
    ------
    InputError : an unknown topic, or a page of some topics; nothing has been written
    """
    for topic in set(topics) - set(data.topics()):
        raise InputError(key="--topics", value=topic, allowed=", ".join(data.topics()))
    if page is not None and topics:
        raise InputError(
            key="--page",
            value=page,
            allowed="without --topics: the page has the claims of all topics",
        )
    claims = [claim for claim in data.load() if not topics or claim.topic in topics]
    out_folder.claim(out, resume)
    with progress.bar(f"{len(claims)} claims") as advance:
        records = runner.validate(
            claims,
            out / "runs",
            slow=slow,
            vary=not no_variants,
            jobs=jobs,
            executor=executor,
            resume=resume,
            report=lambda done, total: advance(done / max(total, 1)),
        )
    table = pages.rows(claims, records)
    stamp = provenance.stamp()
    study.write(out / "ledger.csv", table)
    if page is not None:
        options = " --slow" * slow + " --no-variants" * no_variants
        command = f"python -m validation claims{options} --page {page}"
        pages.write(page, table, command=command, commit=stamp["commit"], date=stamp["date"])
    print(", ".join(f"{count} {verdict}" for verdict, count in pages.counts(table).items()))
    print(f"written to {out}/ledger.csv", flush=True)
    code = 0
    for claim, record in zip(claims, records):
        if judge.changed(claim, record.verdict):
            told = f"{record.verdict}, where {claim.verdict} is recorded (validation/claims/*.toml)"
            print(f"{claim.id}: {told}")
            code = 1
    return code
