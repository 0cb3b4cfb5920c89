"""Golden rows of claims.csv: the claims that `python -m validation stale claims` computes again, and compares with it.

They are those that take no run, but for the two that count iterations over thousands of states, and one claim of each
kind of model (OF_RUNS). A claim of which a number is nothing but rounding is none, nor one of CPU times.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from validation.again import Cell, Outcome
from validation.claims import claims, runner, table, turns
from validation.study import Study

# sections of the mesh, one brick, a lone yarn in 3D, a 3D crossover, a shot, a struck yarn
OF_RUNS = (
    "geom-3d-voided-area",
    "yarn-axial-modulus-rule",
    "yarn-taut-first-weft",
    "cell-2d-3d-tension",
    "cell-yarn-failure-flag",
    "wave-single-yarn-C",
)
DEAR = ("cost-iterations-edge", "failmode-newton-contact-loss")
ROUNDING = "e-"  # in a text: a number below 1e-4
STUDY = Study("claims", {"golden": {"rows": [{"run": "none"}], "cpu_s": 14.0}})  # as `stale` has it


def is_golden(row: Mapping[str, str]) -> bool:
    """Say whether a row of claims.csv is golden."""
    claim = by_id()[row["id"]]
    if not row["computed"] or ROUNDING in row["computed"]:
        return False
    if claim.id in (*DEAR, *turns.OF_CLOCKS):
        return False
    return not claim.run or claim.id in OF_RUNS


def by_id() -> dict[str, claims.Claim]:
    """Return {id: claim}."""
    return {claim.id: claim for claim in claims.load()}


def compare(rows: Sequence[dict[str, str]]) -> Outcome:
    """Compute the golden rows again, and compare verdicts and numbers with the rows of claims.csv."""
    began = time.process_time()
    kept = [row for row in rows if is_golden(row)]
    chosen = [by_id()[row["id"]] for row in kept]
    with TemporaryDirectory() as folder:
        now = table.rows(chosen, runner.validate(chosen, Path(folder), jobs=1))
    cells = [
        Cell(row["id"], column, row[column], new[column])
        for row, new in zip(kept, now, strict=True)
        for column in ("verdict", "computed")
    ]
    moves = [cell for cell in cells if cell.kept != cell.now]
    return Outcome(cells, moves, time.process_time() - began)
