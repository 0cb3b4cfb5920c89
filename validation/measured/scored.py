"""Predict each measured row of plies and packs by drawn shots, and score what the tests report.

Writes scored.csv to docs/reports/data, a row a test, again after each row: one that is not drawn now stays as it is, or
has no shots. What was fired is kept, shot by shot; one ply comes first.
tools/scored_plots.py draws the picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from fabrics.base.errors import InputError
from validation import csv_file, origin
from validation.measured import command, scores
from validation.measured.predictions import Prediction, predict
from validation.measured.rows import HERE, Row, number, read
from validation.values import Values

NOTES = {
    "ids": "parts of the ids of rows; all by default",
    "shots": "shots of a row; of each of two packs for a growth",
    "quick": "4 shots a row; scored.csv goes to results/scored",
    "out": "folder of scored.csv; docs/reports/data by default",
}
LEVELS = ("ply", "pack")
KEPT = Path("results/scored")
QUICK = 4
USUAL = 16
NAME = "scored.csv"
# columns that a prediction fills; of an outcome the quantiles are of the share that perforates
DRAWN = (
    *scores.QUANTILES, "rank", *scores.INTERVALS, "CRPS [%]", "perforated [%]", "Brier",
    "shots", "drawn over", "commit", "CPU [s]", "why none",
)  # fmt: skip


def main(
    ids: Sequence[str] = (),
    *,
    shots: int = USUAL,
    quick: bool = False,
    jobs: int = 1,
    out: Path | None = None,
) -> None:
    """Draw rows, the cheapest first, and write scored.csv after each.

    Raises
    ------
    InputError : rows for the documentation by code that is not as committed, too few shots, or no such row
    """
    if shots < QUICK:
        raise InputError(key="shots", value=shots, allowed=f"at least {QUICK}")
    folder = out or csv_file.DATA
    words = f"scored {' '.join(map(repr, ids))}".strip()
    if quick:
        shots, folder = QUICK, out or KEPT
        words += " --quick"
    origin.refuse_changes(folder)
    rows = [row for row in read() if row.level in LEVELS and row.case]
    every = [row.id for row in rows]
    wanted = {id for part in ids or [""] for id in command.choose(every, part)}
    nominal = {row["id"]: row for row in csv_file.read(csv_file.DATA / "measured.csv")[1]}
    path = folder / NAME
    kept = {}
    if path.is_file():
        kept = {row["id"]: row for row in csv_file.read(path)[1]}
    inputs = origin.digest_of_files(HERE / "rows.csv", *HERE.glob("inputs/**/*.toml"))
    for row in sorted(rows, key=lambda row: LEVELS.index(row.level)):
        if row.id in wanted:
            kept[row.id] = score_row(row, predict(row.case, shots, KEPT / "runs", jobs))
            table = [
                _identify(one, nominal.get(one.id, {})) | _drawn(kept.get(one.id, {}))
                for one in rows
            ]
            csv_file.write(path, table, origin.write(words, inputs, origin.spent()))
            print(f"{row.id}: {tell(kept[row.id])}", flush=True)
    print(scores.write_sentence(csv_file.read(path)[1]))
    print(f"{path}; picture: python tools/scored_plots.py scored.svg {path}")


def _identify(row: Row, computed: Values) -> Values:
    """Return what a row is: the test, and the single run of measured.csv."""
    found: Values = {"id": row.id, "quantity": row.quantity, "cloth": row.cloth, "unit": row.unit}
    found |= {"measured": row.value, "sigma": row.sigma}
    return found | {"single run": command.value_of(computed) if computed else ""}


def _drawn(row: Mapping[str, str]) -> Values:
    return {name: row.get(name, "") for name in DRAWN}


def score_row(row: Row, prediction: Prediction) -> dict[str, str]:
    """Score a prediction: the columns DRAWN as texts."""
    found: Values = {
        "shots": prediction.shots,
        "drawn over": prediction.drawn,
        "commit": origin.commit(),
        "CPU [s]": prediction.cpu_time,
    }
    if len(prediction.values):
        quantiles = np.quantile(prediction.values, scores.LEVELS)
        found |= dict(zip(scores.QUANTILES, map(float, quantiles)))
    else:
        same = "perforate" if prediction.perforated else "stop"
        found["why none"] = f"all {prediction.shots} shots {same}: the limit is not known"
    measured = number(row.value)
    if row.case.measure == "outcome":
        perforated = row.value == "perforated"
        found["perforated [%]"] = 100 * prediction.share
        found["Brier"] = scores.brier(prediction.share, perforated)
    elif len(prediction.values):
        of = scores.score(prediction.values, measured, float(row.sigma))
        found |= {"rank": of.rank}
        found |= {name: of.is_inside(share) for name, share in scores.INTERVALS.items()}
        # nothing is a share of a measured 0: the error of the test is
        found["CRPS [%]"] = 100 * of.crps / (abs(measured) or float(row.sigma))
    return {name: csv_file.text(found.get(name)) for name in DRAWN}


def tell(row: Mapping[str, str]) -> str:
    """Say in one line what a row of scored.csv has."""
    if row["why none"]:
        return row["why none"]
    low, *_, high = (row[name] for name in scores.QUANTILES)
    if row["Brier"]:
        return f"P {row['50 %']} ({low} to {high}), Brier {row['Brier']}"
    return f"{row['50 %']} ({low} to {high}), rank {row['rank']}, CRPS {row['CRPS [%]']} %"
