"""How often a survey keeps what it promises: each of its scenes answered by what the others teach.

A scene is answered as `select.answer` does, from the runs of the survey: the cheapest model whose bounds are within the
target and which its partner does not contradict, else the full model. Nothing is run. The scenes are of one kind, so
that this is no trial of scenes unlike the survey's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from validation.verification.fidelity import fit_error_database
from weavecell.analysis.fidelity import error_database, quantities
from weavecell.analysis.fidelity.ladder import Model, partner, scouts

TARGETS = (0.02, 0.05, 0.1)


@dataclass(frozen=True)
class Row:
    """One scene at one target.

    Parameters
    ----------
    target : [-] of all four quantities
    model : the name of that which answers
    full : whether it is the full model
    error : [-] the largest against the full model
    cost : [-] of scouts and answer over the full model
    """

    target: float
    model: str
    full: bool
    error: float
    cost: float

    @property
    def met(self) -> bool:
        """Whether all errors are within the target."""
        return self.error <= self.target


def rows(survey: Sequence[dict[str, Any]], models: Sequence[Model]) -> list[Row]:
    """A Row of each scene and target.

    Parameters
    ----------
    survey : [{model: {"values", "seconds"}}] of all scenes
    models : the ladder, the full model last
    """
    found = []
    for number, scene in enumerate(survey):
        known = fit_error_database.of([*survey[:number], *survey[number + 1 :]], models)
        book = error_database.Book(**known, others={}, made={})
        found += [_answered(scene, models, book, target) for target in TARGETS]
    return found


def _answered(scene, models, book, target):
    two, full = scouts(scene), models[-1]
    seen = tuple(scene[model.name]["values"] for model in reversed(two))
    ladder = sorted((m for m in models[:-1] if m.answers and m.name in scene), key=book.cost)
    chosen = next((model for model in ladder if _fits(model, scene, two, seen, book, target)), full)
    values, answer = scene[chosen.name]["values"], scene[full.name]["values"]
    if chosen is not full:
        weight = book.weight(chosen, quantities.regime(values))
        values = quantities.mixed(values, scene[partner(chosen, two).name]["values"], weight)
    errors = [fit_error_database.error(values, answer, name) for name in quantities.NAMES]
    spent = {model.name for model in two} | {chosen.name}
    cost = sum(scene[name]["seconds"] for name in spent) / scene[full.name]["seconds"]
    return Row(target, chosen.name, chosen is full, max((e for e in errors if isfinite(e)), default=0.0), cost)


def _fits(model, scene, two, seen, book, target):
    """Whether the bounds of a model are within the target, and its partner is as near as in the survey."""
    values, other = scene[model.name]["values"], scene[partner(model, two).name]["values"]
    if quantities.regime(values) != quantities.regime(other):
        return False
    apart = quantities.differences(values, other)
    return all(
        book.bound(model, name, seen) <= target and not apart[name] > book.apart(model, name, seen)
        for name in quantities.NAMES
    )


def table(found: Sequence[Row]) -> list[str]:
    """Lines of Markdown: for each target how many scenes are met, by which models, at which median cost."""
    lines = [
        "| target of all four | cases | met | answered by the full model | median cost |",
        "|---:|---:|---:|---:|---:|",
    ]
    for target in TARGETS:
        alike = [row for row in found if row.target == target]
        lines.append(
            f"| {100 * target:g} % | {len(alike)} | {sum(row.met for row in alike)} "
            f"| {sum(row.full for row in alike)} | {np.median([row.cost for row in alike]):.2f} |"
        )
    return lines
