"""Scores of numbers that were predicted as draws, held against what tests report.

The rank of a measured number is the share of draws below it, of draws to which the error of the test is added. Ranks
of good predictions are even from 0 to 1: half of them lie in the 50 % interval. The continuous ranked probability
score (Gneiting and Raftery, J. Am. Stat. Assoc. 102 (2007) 359) of draws x against a measured y,

    CRPS = mean |x - y| - mean |x - x'| / 2

is |x - y| of a single run: the lower the better, in the unit of the number. A shot whose outcome was seen has the Brier
score (P - outcome)^2, 1/4 of a coin. Numbers of one cloth share what is unknown of it: groups are counted too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.counted import counted
from validation.values import Values

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
QUANTILES = tuple(f"{100 * level:.0f} %" for level in LEVELS)  # columns of scored.csv
WIDE, NARROW = "inside 90 %", "inside 50 %"
INTERVALS = {NARROW: 0.5, WIDE: 0.9}
ERRORS = 64  # draws of the test's error for each draw of the prediction
COIN = 0.25
INFERRED = "inferred"  # first word of the quantity of an outcome that no text states


@dataclass(frozen=True)
class Score:
    """Of a measured number.

    Parameters
    ----------
    rank : [-] share of the draws below it
    crps : [unit of the number]
    """

    rank: float
    crps: float

    def is_inside(self, share: float) -> bool:
        """Tell whether the number lies in the middle interval that has this share of the draws."""
        return abs(self.rank - 0.5) <= 0.5 * share


def score(draws: FloatArray, measured: float, sigma: float) -> Score:
    """Score draws against a measured number.

    Parameters
    ----------
    draws : (n,) equally likely values
    measured, sigma : the number, and the standard uncertainty of its test
    """
    x = np.sort(np.asarray(draws, float))
    error = sigma * np.random.default_rng(0).standard_normal((x.size, ERRORS))
    seen = x[:, None] + error
    rank = float(np.mean(seen < measured) + 0.5 * np.mean(seen == measured))
    # half of the mean distance of two draws, of sorted ones
    apart = float((2 * np.arange(1, x.size + 1) - x.size - 1) @ x) / x.size**2
    return Score(rank, float(np.abs(x - measured).mean()) - apart)


def brier(share: float, perforated: bool) -> float:
    """Compute the Brier score of a share of drawn shots that perforate."""
    return (share - perforated) ** 2


def summarise(table: Sequence[Mapping[str, str]]) -> Values:
    """Summarise rows of scored.csv.

    Returns
    -------
    dict with rows and drawn, how many there are and have draws; numbers, cloths and both INTERVALS, counts of those
    with a rank; CRPS [%], their mean; outcomes, inferred and Brier; strong [%], by how much the medians of V50 of one
    ply are above the tests. What has no row is NaN
    """
    drawn = [row for row in table if row["shots"]]
    numbers = [row for row in drawn if row["rank"]]
    outcomes = [row for row in drawn if row["Brier"]]
    plies = [row for row in numbers if row["quantity"] == "V50 of one ply"]
    inside = {name: sum(row[name] == "yes" for row in numbers) for name in INTERVALS}
    return {
        "rows": len(table),
        "drawn": len(drawn),
        "numbers": len(numbers),
        "cloths": len({row["cloth"] for row in numbers}),
        **inside,
        "CRPS [%]": _mean(float(row["CRPS [%]"]) for row in numbers),
        "outcomes": len(outcomes),
        "inferred": sum(row["quantity"].startswith(INFERRED) for row in outcomes),
        "Brier": _mean(float(row["Brier"]) for row in outcomes),
        "strong [%]": _mean(
            100 * (float(row["50 %"]) / float(row["measured"]) - 1) for row in plies
        ),
    }


def _mean(values):
    """Return the mean; NaN of none."""
    listed = [*values]
    return sum(listed) / len(listed) if listed else nan


def write_sentence(table: Sequence[Mapping[str, str]]) -> str:
    """Write what rows of scored.csv come to, and how many have no draws yet."""
    of = summarise(table)
    parts = []
    if of["numbers"]:
        cloths = counted(of["cloths"], "cloth")
        inside = of[WIDE] or "none"
        verb = "lie" if of[WIDE] > 1 else "lies"
        parts.append(
            f"of {counted(of['numbers'], 'number')} from {cloths} {inside} {verb} in the 90 % interval"
        )
    if of["outcomes"]:
        words = f"{counted(of['outcomes'], 'outcome')} ({of['inferred']} inferred) by Brier {of['Brier']:.2f}"
        parts.append(f"{words} (coin {COIN})")
    if of["strong [%]"] == of["strong [%]"]:
        side = "strong" if of["strong [%]"] > 0 else "weak"
        parts.append(f"one ply is {abs(of['strong [%]']):.0f} % too {side}")
    words = "; ".join(parts) or "nothing is drawn yet"
    if of["drawn"] < of["rows"]:
        shots = sorted(int(row["shots"]) for row in table if row["shots"])
        fewest = f", {shots[0]} shots or more each" if shots else ""
        words += f". Drawn so far: {of['drawn']} of {of['rows']} rows{fewest}"
    return f"{words[0].upper()}{words[1:]}."
