"""Runs the ledger: first the computations that the checks share, each once, then the checks, side by side.

Any executor of concurrent.futures will do; processes are the default. What is done is on disk before the next begins,
so that an interrupted run goes on where it was.

A claim that rests on shots can be checked in variants of these too (`variants`): its record then holds their verdicts.

The folder: runs/ what the shared computations left, records/ one JSON file a claim.
"""

from __future__ import annotations

import json
import shutil
import time
import traceback
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import run_cache
from fabrics.errors import WeavecellError
from fabrics.executors import as_done, open_executor
from fabrics.files import write_whole
from validation.claims import judge, variants
from validation.claims.checks import CHECKS
from validation.claims.claims import Claim
from validation.claims.judge import BROKEN, LEFT_OUT, MISSED, NOT_TESTABLE, Record

if TYPE_CHECKING:
    from validation.claims.registry import Run, RunResult

RUNS_FOLDER, RECORDS_FOLDER = "runs", "records"


def validate(
    claims: Sequence[Claim], out: Path, *, left_out: Sequence[Claim] = (), vary: bool = False, executor: str = "local",
    jobs: int = 1, resume: bool = False, report: Callable[..., object] | None = None,
) -> tuple[Record, ...]:  # fmt: skip
    """Run the checks of the claims.

    Parameters
    ----------
    claims : of `claims.load`
    out : folder
    left_out : claims that get a record of their own as being left out
    vary : also check each claim that rests on shots in its variants
    executor, jobs : as of `fabrics.executors.open_executor`
    resume : keep what is in the folder and still holds; else it is emptied
    report : called as report(share of the work done, text)

    Returns
    -------
    One record a claim, in the order of the claims, those left out at the end.
    """
    out, report = Path(out), report or (lambda share, text: None)
    if not resume:
        for part in (RUNS_FOLDER, RECORDS_FOLDER):
            shutil.rmtree(out / part, ignore_errors=True)
    for part in (RUNS_FOLDER, RECORDS_FOLDER):
        (out / part).mkdir(parents=True, exist_ok=True)
    records = {claim.id: record for claim in claims if (record := _kept(claim, out, vary)) is not None}
    waiting = [claim for claim in claims if claim.id not in records]
    for claim in (claim for claim in waiting if not claim.check):
        records[claim.id] = _keep(claim, judge.unchecked(claim), out, vary)
    waiting = [claim for claim in waiting if claim.check]
    tasks = [(claim, name) for claim in waiting for name in (None, *(variants.varied(claim) if vary else ()))]
    runs = wanted(tasks, out)
    total, done = sum(cost(run) for run in runs) + len(tasks), 0.0
    found: dict[str, dict] = {claim.id: {} for claim in waiting}
    with open_executor(executor, jobs) as pool:
        for index, _ in as_done(pool, _make, [(run, str(out), digest(run)) for run in runs]):
            run = runs[index]
            done += cost(run)
            report(done / total, f"{run.name} {_brief(run)}")
        given = [(claim, str(out), _names(claim, name), name) for claim, name in tasks]
        for index, record in as_done(pool, check, given):
            claim, name = tasks[index]
            done += 1
            found[claim.id][name] = record
            if len(found[claim.id]) == 1 + (len(variants.varied(claim)) if vary else 0):
                records[claim.id] = _keep(claim, _with_variants(claim, found[claim.id], vary), out, vary)
            report(done / total, claim.id)
    for claim in left_out:
        records[claim.id] = Record(claim.id, LEFT_OUT, note="slow: run with --slow")
    return tuple(records[claim.id] for claim in (*claims, *left_out))


def _with_variants(claim, found, vary):
    """The record of a claim, from {None: its record as computed, variant: its record there}.

    A variant that changes no run of the claim has the verdict of the claim as computed.
    """
    record = replace(found[None], setting=variants.setting(claim))
    if not (vary and record.setting):
        return record
    return replace(record, variants={name: found.get(name, record).verdict for name in variants.VARIANTS})


def wanted(tasks: Iterable[tuple[Claim, str | None]], out: Path) -> list[Run]:
    """Runs that the checks of (claim, variant or None) read and that the folder does not hold; the longest first."""
    runs = {run for claim, name in tasks for run in variants.runs(claim, name).values()}
    missing = [run for run in runs if not _holds(run, out)]
    return sorted(missing, key=lambda run: (-cost(run), run))


def _holds(run, out):
    """Whether the folder has a run that came to an end; one that broke, or lacked a package, is tried again."""
    return digest(run) in _runs(out) and load(run, out).get("kind", "unstable") == "unstable"


def _names(claim, variant=None):
    """{run: name of its file} of the runs that the check of a claim reads, in a variant.

    Names are settled in one process, at the start: were a package edited meanwhile, another's would differ.
    """
    return {run: digest(run) for run in variants.runs(claim, variant).values()}


def check(claim: Claim, out: Path, names: Any = None, variant: str | None = None) -> Record:
    """Do the check of one claim, with the runs of the folder; `names` of their files, if settled before.

    variant : of `variants.VARIANTS`, or None for the claim as computed
    """
    entry, arguments, begun = CHECKS[claim.check], claim.arguments or {}, time.perf_counter()
    try:
        names = names or _names(claim, variant)
        runs = {name: _runs(out)[names[run]] for name, run in variants.runs(claim, variant).items()}
        for run in runs.values():
            if "error" in run:
                verdict = {"missing": NOT_TESTABLE, "unstable": MISSED}.get(run["kind"], BROKEN)
                return Record(
                    claim.id,
                    verdict,
                    text=run["error"],
                    miss=run["error"] if verdict == MISSED else "",
                    note=run["error"],
                )
        found = entry.function(**runs, **arguments)
        note = found.pop("note", "")
    except WeavecellError as problem:
        return Record(claim.id, MISSED, text=str(problem), miss=str(problem))
    except Exception:
        return Record(claim.id, BROKEN, note=traceback.format_exc(limit=-3))
    return judge.judge(claim, found, note, time.perf_counter() - begun)


def load(run: Run, out: Path) -> RunResult:
    """What a run left in the folder."""
    return _runs(out)[digest(run)]


def _runs(out):
    return run_cache.RunCache(Path(out) / RUNS_FOLDER)


def cost(run: Run) -> float:
    """Rough cost of a run, only for order and progress; elements per side enter with their third power."""
    return _registry()[run.name][1] * run.keywords.get("elements", 1) ** 3


def digest(run: Run) -> str:
    """Key of a run: of what is run with what, and of the code."""
    return run_cache.key((run.name, run.keywords), _registry()[run.name][0].__module__)


def _registry():
    from validation.claims import runs, runs3d, runs_extra, runs_studies

    return runs.RUNS | runs_extra.RUNS | runs_studies.RUNS | runs3d.RUNS


def _make(run, out, name):
    """Do a run and keep what it leaves; what goes wrong is kept too, for the checks to tell."""
    function, _ = _registry()[run.name]
    try:
        content = function(**run.keywords)
    except ModuleNotFoundError as problem:
        content = {"error": f"{problem.name} is not installed", "kind": "missing"}
    except WeavecellError as problem:
        content = {"error": f"{run.name} {_brief(run)}: {problem}", "kind": "unstable"}
    except Exception:
        content = {"error": f"{run.name} {_brief(run)}: {traceback.format_exc(limit=-3)}", "kind": "broken"}
    _runs(out)[name] = content


def make(run: Run, out: Path) -> None:
    """Do a run and keep what it leaves in the folder."""
    _make(run, out, digest(run))


def _brief(run):
    return " ".join(str(value) for value in run.keywords.values() if not isinstance(value, (list, dict)))


def _stamp(claim, vary):
    """Key of a claim's record: of the claim, of the program that checks it, and of whether variants were selected."""
    return run_cache.key((claim, vary and variants.varied(claim)), __name__)


def _keep(claim, record, out, vary):
    with write_whole(out / RECORDS_FOLDER / f"{claim.id}.json") as file:
        json.dump({"stamp": _stamp(claim, vary), **record.as_dict()}, file, indent=1)
        file.write("\n")
    return record


def _kept(claim, out, vary):
    """The record of a claim, if it is in the folder and neither claim nor program has changed since."""
    try:
        content = json.loads((out / RECORDS_FOLDER / f"{claim.id}.json").read_text("utf-8"))
    except (OSError, ValueError):
        return None
    if content.pop("stamp", None) != _stamp(claim, vary) or content["verdict"] == BROKEN:
        return None
    return Record(**content)
