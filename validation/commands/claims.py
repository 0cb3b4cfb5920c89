"""The ledger of the thesis's claims: every claim that is a number, an order, a trend, a shape or an outcome, checked.

    python -m validation claims --topics impact1 cell

A missed claim is a result, not an error; a result other than the recorded one ends with exit code 1. Claims that rest
on shots at one ply are checked as computed and in four variants: the cell formulation of the thesis, nominal denier, 2
elements per crossover, elastic-plastic bored projectile.

Topics: geom, compr, yarn, cell, shear, wave, impact1, impactN, gap, biaxial, bias, sens, slip, pencil, cost, failmode,
future.

The folder
    ledger.csv     every claim with its verdict, our number beside the thesis's
    ledger.json    shares by topic, claims that are missed, provenance
    runs/, records/  what is done, from which --resume goes on
"""

from __future__ import annotations

import resource
import time
from collections.abc import Sequence
from pathlib import Path

from fabrics.errors import InputError
from validation.claims import claims as data
from validation.claims import page as claims_page
from validation.claims import runner, summary, variants
from validation.claims.judge import DATA, MISSED, NOT_BUILT, NOT_COMPARABLE, NOT_TESTABLE, WRONG
from weavecell.cli.from_signature import CORES
from weavecell.results import json_file, out_folder, progress, provenance

NOTES = {"topics": "those to check; all if none is given", "slow": "also the checks that take minutes each",
         "no_variants": "as computed alone, not in the variants"}  # fmt: skip
_COLUMNS_OF_VERDICTS = (MISSED, WRONG, DATA, NOT_COMPARABLE, NOT_BUILT, NOT_TESTABLE)


def main(
    *, topics: Sequence[str] = (), slow: bool = False, no_variants: bool = False, jobs: int = CORES,
    executor: str = "local", resume: bool = False, out: Path = Path("results/validate"), page: Path | None = None,
) -> int:  # fmt: skip
    """Run the ledger; returns the exit code: 1 where a verdict is not the recorded one, else 0, for a miss is a result.

    Raises
    ------
    InputError : an unknown topic, or a page of some topics; nothing has been written
    """
    vary = not no_variants
    chosen, left_out = data.select(data.load(), topics, slow)
    if page is not None and topics:
        raise InputError(key="--page", value=page, allowed="without --topics: the page has the claims of all topics")
    out_folder.claim(out, resume)
    began, cpu = time.perf_counter(), _cpu_time()
    with progress.bar(f"{len(chosen)} claims") as advance:
        records = runner.validate(
            chosen, out, left_out=left_out, vary=vary, jobs=jobs, executor=executor, resume=resume, report=advance
        )
    seconds, cpu = time.perf_counter() - began, _cpu_time() - cpu
    claims = [claim for claim in data.load() if claim in chosen or claim in left_out]
    shares, stamp = summary.shares(claims, records), provenance.stamp()
    summary.write_csv(claims, records, out / "ledger.csv")
    json_file.write(out / "ledger.json", _summary(claims, records, shares, stamp, seconds, cpu))
    if page is not None:
        options = ["--slow"] * slow + ["--no-variants"] * (not vary)
        command = " ".join(["python -m validation claims", *options, f"--page {page}"])
        cost = f"{seconds / 60:.0f} minutes with {jobs} processes, {cpu / 60:.0f} minutes of processor time"
        cost = "taken up from stored runs (--resume)" if resume else cost
        rows = claims_page.rows(claims, records)
        claims_page.write(page, rows, command=command, commit=stamp["commit"], date=stamp["date"], cost=cost)
    _tell(shares, records, out)
    changed = summary.changed(claims, records)
    if changed:
        print(f"{len(changed)} verdicts are not those that are recorded (validation/claims/*.toml):")
    for name, how in changed.items():
        print(f"  {name}: {how}")
    return 1 if changed else 0


def _cpu_time():
    """[s] of processor time of this process and of those that it has started and that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _summary(claims, records, shares, stamp, seconds, cpu):
    causes = {claim.id: claim.cause for claim in claims}

    def table(rows):
        return {
            share.topic or "all": {**share.counts, "compared": share.compared, "share reproduced": share.reproduced}
            for share in rows
        }

    return {
        "topics": table(shares),
        "kinds": table(summary.shares(claims, records, by="kind")),
        "missed": [
            {"id": record.id, "by": record.miss, "cause": causes[record.id]}
            for record in records
            if record.verdict == MISSED
        ],
        "variants": {
            record.id: {"verdict": record.verdict, "changed": variants.changes(record)}
            for record in records
            if record.variants
        },
        "wall_time": seconds,
        "cpu_time": cpu,
        "provenance": stamp,
    }


def _tell(shares, records, out):
    """The shares on the terminal, and the claims whose verdict a variant changes."""
    print(f"{'':26} reproduced   missed   source wrong   data   not comparable   not built   not testable")
    for share in (*shares[1:], shares[0]):
        name = data.TOPICS[share.topic] if share.topic else "all"
        of = f"{share.counts['reproduced']:3d} of {share.compared:<3d}"
        rest = [share.counts[verdict] for verdict in _COLUMNS_OF_VERDICTS]
        print(f"{name:26} {of}   " + "   ".join(f"{n:{w}d}" for n, w in zip(rest, (6, 12, 4, 14, 9, 12))))
    varied = [record for record in records if record.variants]
    changed = [record for record in varied if variants.changes(record)]
    if varied:
        print(f"{len(varied)} claims rest on shots; a variant changes the verdict of {len(changed)}:")
    for record in changed:
        print(f"  {record.id}: {record.verdict}, {variants.summary(record)}")
    print(f"written to {out}/ledger.csv", flush=True)
