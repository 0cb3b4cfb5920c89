"""Which change of an input turns the verdict of a reproduced claim: looked for once, kept in claims-turns.csv.

A condition that holds whatever goes in says little. Of each reproduced claim the inputs of CHANGES are changed by a
tenth, in all fabrics of the catalogue and in all of its runs, one after the other, until its verdict is another. A row
has the change, or "none of N", and what was computed with it. Statements on order and sign, and identities, which hold
of any fabric, are turned by none: mutants (tools/mutants.py) show that they can fail.

Claims that take runs are looked through by name alone (`python -m validation claims ID --find-turns`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from validation import csv_file
from validation.claims import judge, runner, table
from validation.claims.claims import Claim
from validation.values import Values

FILE = "claims-turns.csv"
TENTH = (1.1, 0.9)
ONE_FAMILY: tuple[Values, ...] = tuple({"crimp": [1.0, factor]} for factor in TENTH)
OF_YARNS = ("crimp", "E", "failure_strain", "linear_density", "count")
OF_LAWS = ("a", "b", "shear moduli", "shear angles")
VELOCITY = "velocity"
# inputs that are changed of claims without runs; and of those with some, which take seconds each
CHANGES: tuple[Values, ...] = (
    *({name: factor} for name in (*OF_YARNS, *OF_LAWS) for factor in TENTH),
    *ONE_FAMILY,
)
OF_RUNS: tuple[Values, ...] = (
    {VELOCITY: 0.9},
    {VELOCITY: 1.1},
    {"crimp": 0.9},
    {"crimp": 1.1},
    {"E": 0.9},
)
NONE = "none"
# claims of CPU times, which differ by more than a tenth from run to run
OF_CLOCKS = ("future-lut-equals-iteration",)


def search(
    claims: Sequence[Claim], folder: Path, report: Callable[[int, int], object], **pool: Any
) -> list[Values]:
    """Look for the change that turns each reproduced claim.

    Parameters
    ----------
    claims : any; those that are not reproduced are passed over
    folder, **pool : of `runner.validate`
    report : told (done, all)

    Returns
    -------
    A row a claim: id, change, factors as JSON, tried, computed and published.
    """
    wanted = [
        claim for claim in claims if claim.verdict == judge.REPRODUCED and claim.id not in OF_CLOCKS
    ]
    rows = []
    for number, claim in enumerate(wanted):
        report(number, len(wanted))
        rows.append(_search_one(claim, folder, pool))
    return rows


def _search_one(claim, folder, pool):
    changes = CHANGES
    if claim.run:
        changes = OF_RUNS
    row = {"id": claim.id, "change": NONE, "factors": "", "tried": len(changes), "computed": ""}
    for number, factors in enumerate(changes, 1):
        (record,) = runner.validate([replace(claim, factors=factors)], folder, **pool)
        # an error is no other verdict: that input is not allowed
        if record.verdict != judge.MISSED or record.note:
            continue
        row["change"] = describe(factors)
        row["factors"] = json.dumps(factors)
        row["tried"] = number
        row["computed"] = record.miss
        break
    row["published"] = table.rows([claim], [judge.Record(claim.id, judge.REPRODUCED)])[0][
        "published"
    ]
    return row


def describe(factors: Values) -> str:
    """Write a change in words: "crimp + 10 %", "crimp of the weft + 10 %"."""
    words = []
    for name, factor in factors.items():
        if isinstance(factor, list):
            name = f"{name} of the weft"
            factor = factor[1]
        words.append(f"{name} {100 * (factor - 1):+.0f} %")
    return ", ".join(words)


def stored() -> dict[str, Values]:
    """Read {id of a claim: the factors that turn it} from the data of the documentation."""
    _, rows = csv_file.read(csv_file.DATA / FILE)
    return {row["id"]: json.loads(row["factors"]) for row in rows if row["factors"]}


def turned(claims: Sequence[Claim]) -> list[Claim]:
    """Return the claims that a stored change turns, each with that change and the verdict that it
    then has."""
    known = stored()
    return [
        replace(claim, factors=known[claim.id], verdict=judge.MISSED)
        for claim in claims
        if claim.id in known
    ]
