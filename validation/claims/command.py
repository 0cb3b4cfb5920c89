"""The ledger of the thesis's claims: every claim that is a number, an order, a trend, a shape or an outcome, judged.

    python -m validation claims --topics impact1 cell
    python -m validation claims biaxial-balanced-free --turned

A missed claim is a result; one other than the recorded one ends with exit code 1. Claims on shots at one ply are
judged as computed and in four variants: the thesis's cell formulation, nominal denier, 2 elements per crossover,
elastic-plastic bored projectile. claims.csv has every claim with its verdict and the commit of the code that computed
it; `--out docs/reports/data` renews that of the documentation, then `python tools/pages.py`: rows of claims that are
not judged now stay. `--find-turns` looks for an input whose change by a tenth turns each verdict (`turns`), into
claims-turns.csv; `--turned` judges with that change. What is computed is kept in results/claims.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fabrics.base.errors import InputError, nearest
from validation import csv_file, origin
from validation.claims import claims as data
from validation.claims import golden_rows, judge, runner, table, turns
from weavecell.cli.from_signature import CORES
from weavecell.results import progress

NOTES = {
    "ids": "of claims to judge alone",
    "turned": "judge with the changed input of each claim that one turns",
    "find_turns": "look for the change that turns each; of claims that are named, or take no run",
    "topics": "those to judge; all if none is given",
    "slow": "also those that take minutes each",
    "no_variants": "as computed alone, not in the variants",
    "out": "folder of the CSV, results/claims where no claims are named; rows of other claims stay",
}
KEPT = Path("results/claims")


def main(
    ids: Sequence[str] = (),
    *,
    turned: bool = False,
    find_turns: bool = False,
    topics: Sequence[str] = (),
    slow: bool = False,
    no_variants: bool = False,
    jobs: int = CORES,
    executor: str = "local",
    out: Path | None = None,
) -> int:
    """Run the ledger; returns the exit code: 1 where a verdict is not the recorded one, else 0, for a miss is a result.

    Raises
    ------
    InputError : an unknown topic or claim; nothing has been written
    """
    known = [claim.id for claim in data.load()]
    for name in ids:
        if name not in known:
            near = nearest(name, known)
            raise InputError(key="claim", value=name, allowed=f"an id, such as {near or known[0]}")
    for topic in set(topics) - set(data.topics()):
        raise InputError(key="--topics", value=topic, allowed=", ".join(data.topics()))
    claims = [claim for claim in data.load() if not topics or claim.topic in topics]
    if ids:
        claims = [claim for claim in claims if claim.id in ids]
    if find_turns:
        return write_turns(claims, out or KEPT, bool(ids), jobs=jobs, executor=executor)
    if out is not None:
        origin.refuse_changes(out)
    if turned:
        claims = turns.turned(claims)
    with progress.bar(f"{len(claims)} claims") as advance:
        records = runner.validate(
            claims,
            KEPT / "runs",
            slow=slow or bool(ids),
            vary=not no_variants,
            jobs=jobs,
            executor=executor,
            report=lambda done, total: advance(done / max(total, 1)),
        )
    if out is None and not (ids or turned):
        out = KEPT
    options = " --slow" * slow + " --no-variants" * no_variants
    if out is not None and not turned:
        write_rows(out / table.FILE, table.rows(claims, records), options)
    if ids or turned:
        return tell(claims, records)
    counts = Counter(record.verdict for record in records)
    print(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
    return tell_changed(claims, records)


def write_rows(path: Path, rows: Sequence[table.Row], options: str) -> None:
    """Write the rows of claims, each with the commit of the code; rows of claims that were not judged stay as they
    are."""
    kept = {}
    if path.exists():
        kept = {row["id"]: row for row in csv_file.read(path)[1]}
    commit = origin.commit()
    for row in rows:
        before = kept.get(row["id"], {})
        if row["verdict"] == judge.LEFT_OUT and before:
            continue
        stated = {"variants": row["variants"] or before.get("variants", ""), "commit": commit}
        kept[row["id"]] = row | stated
    ordered = [table.explained(claim, kept[claim.id]) for claim in data.load() if claim.id in kept]
    inputs = origin.digest_of_files(*Path(__file__).parent.glob("*.toml"))
    checked = [number for number, row in enumerate(ordered, 1) if golden_rows.is_golden(row)]
    made = origin.write(f"claims{options}", inputs, origin.spent(), checked)
    csv_file.write(path, ordered, made)
    print(f"written to {path}", flush=True)


def write_turns(claims: Sequence[data.Claim], out: Path, named: bool, **pool: Any) -> int:
    """Look for the changes that turn claims and write claims-turns.csv, in which rows of other
    claims stay; return the exit code."""
    chosen = [claim for claim in claims if named or not claim.run]
    path = out / turns.FILE
    kept = {}
    if path.exists():
        kept = {row["id"]: row for row in csv_file.read(path)[1]}
    with progress.bar(f"{len(chosen)} claims") as advance:
        rows = turns.search(
            chosen,
            KEPT / "runs",
            lambda done, total: advance(done / max(total, 1)),
            **pool,
        )
    kept |= {row["id"]: row for row in rows}
    reproduced = [claim.id for claim in data.load() if claim.verdict == judge.REPRODUCED]
    inputs = origin.digest_of_files(*Path(__file__).parent.glob("*.toml"))
    made = origin.write("claims --find-turns", inputs, origin.spent())
    csv_file.write(path, [kept[name] for name in reproduced if name in kept], made)
    found = sum(row["change"] != turns.NONE for row in kept.values())
    print(f"{found} of {len(kept)} claims are turned by a tenth of an input; written to {path}")
    return 0


def tell(claims: Sequence[data.Claim], records: Sequence[judge.Record]) -> int:
    """Print what each claim states and what was computed; return the exit code as `main`."""
    for row in table.rows(claims, records):
        print(f"{row['id']}: {row['verdict']}")
        for name in ("published", "computed", "because", "cause"):
            print(f"  {name:<10} {row[name]}")
    return tell_changed(claims, records)


def tell_changed(claims: Sequence[data.Claim], records: Sequence[judge.Record]) -> int:
    """Print the claims that did not end with the recorded verdict; return 1 if there are any."""
    code = 0
    for claim, record in zip(claims, records):
        if judge.changed(claim, record.verdict):
            told = f"{record.verdict}, where {claim.verdict} is recorded (validation/claims/*.toml)"
            print(f"{claim.id}: {told}")
            code = 1
    return code
