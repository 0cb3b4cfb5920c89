"""The ledger of the thesis's claims: every claim that is a number, an order, a trend, a shape or an outcome, checked.

    python -m validation claims --topics impact1 cell

A missed claim is a result, not an error. Claims that rest on shots at one ply are checked as computed and in four
variants: the thesis's cell formulation, nominal denier, 2 elements per crossover, and an elastic-plastic bored
projectile.

Topics: geom, compr, yarn, cell, shear, wave, impact1, impactN, gap, biaxial, bias, sens, slip, pencil, cost, failmode,
future.

The folder
    ledger.html    every claim with its verdict, our number beside the thesis's, and pictures
    ledger.csv     the same as a table
    ledger.json    shares by topic, provenance
    runs/, records/  what is done, from which --resume goes on
"""

from __future__ import annotations

import resource
import time
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

from fabrics.errors import InputError
from fabrics.files import write_whole
from validation.claims import claims as data
from validation.claims import page as claims_page
from validation.claims import runner, summary, variants
from validation.claims.judge import BROKEN, DATA, MISSED, NOT_BUILT, NOT_COMPARABLE, NOT_TESTABLE, VERDICTS, WRONG
from weavecell.commands.options import CORES
from weavecell.report import pictures
from weavecell.report.page import Figure
from weavecell.results import json_file, out_folder, progress, provenance

TEMPLATE = "ledger.html.j2"
NOTES = {"topics": "those to check; all if none is given", "slow": "also the checks that take minutes each",
         "no_variants": "as computed alone, not in the variants"}  # fmt: skip
_COLUMNS_OF_VERDICTS = (MISSED, WRONG, DATA, NOT_COMPARABLE, NOT_BUILT, NOT_TESTABLE)
_SUBTITLE = (
    "Every claim of the thesis that is a number, an order, a trend, a shape or an outcome, with our number "
    "beside it. Tolerances come from the printed digits or were set before the comparison, and none has been widened "
    "to turn a miss; nothing is fitted to a claim."
)


def main(
    *, topics: Sequence[str] = (), slow: bool = False, no_variants: bool = False, jobs: int = CORES,
    executor: str = "local", resume: bool = False, out: Path = Path("results/validate"), page: Path | None = None,
) -> int:  # fmt: skip
    """Run the ledger; returns the exit code: 1 where a check broke, else 0, for a miss is a result.

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
    with progress.bar("Page") as advance:
        _write_page(out, claims, records, shares, stamp)
    if page is not None:
        options = ["--slow"] * slow + ["--no-variants"] * (not vary)
        command = " ".join(["python -m validation claims", *options, f"--page {page}"])
        cost = f"{seconds / 60:.0f} minutes with {jobs} processes, {cpu / 60:.0f} minutes of processor time"
        cost = "taken up from stored runs (--resume)" if resume else cost
        rows = claims_page.rows(claims, records)
        claims_page.write(page, rows, command=command, commit=stamp["commit"], date=stamp["date"], cost=cost)
    _tell(shares, records, out)
    broken = [record.id for record in records if record.verdict == BROKEN]
    if broken:
        print(f"{len(broken)} checks did not come to an end: {', '.join(broken)}")
    return 1 if broken else 0


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


def _write_page(out, claims, records, shares, stamp):
    import jinja2

    by_id = {record.id: record for record in records}
    parts = []
    for share in shares[1:]:
        rows = tuple((claim, by_id[claim.id]) for claim in claims if claim.topic == share.topic)
        counts = ", ".join(f"{count} {verdict}" for verdict, count in share.counts.items() if count)
        part = {"key": share.topic, "title": data.TOPICS[share.topic], "lead": f"{counts}.", "rows": rows}
        parts.append(part | {"figures": _figures(share.topic, out)})
    own, shared = resources.files("validation.claims"), resources.files("weavecell.report") / "templates"
    loader = jinja2.FunctionLoader(lambda name: (own if name == TEMPLATE else shared).joinpath(name).read_text("utf-8"))
    environment = jinja2.Environment(
        loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    page = environment.get_template(TEMPLATE).render(
        title="The claims of the thesis, put to the test",
        subtitle=_SUBTITLE,
        shares=shares,
        parts=parts,
        topics=data.TOPICS,
        verdicts=VERDICTS,
        sensitivity=variants.summary,
        footer=f"weavecell {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}; {stamp['processor']}; "
        f"{stamp['packages']}.",
    )
    with write_whole(out / "ledger.html") as file:
        file.write(page)


def _figures(topic, out):
    """Pictures of a topic whose runs are in the folder."""
    from validation.claims import pictures as claims_pictures

    found = []
    for draw, needed, caption, wide in claims_pictures.PICTURES.get(topic, ()):
        try:
            runs = {name: runner.load(run, out) for name, run in needed().items()}
        except FileNotFoundError:
            continue
        if not any("error" in run for run in runs.values()):
            found.append(Figure(pictures.render(draw, runs), "svg", caption, draw.__name__, wide))
    return tuple(found)


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
    print(f"written to {out}/ledger.html", flush=True)
