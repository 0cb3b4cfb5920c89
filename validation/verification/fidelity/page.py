"""Tables of survey and trials for the documentation."""

from __future__ import annotations

from math import inf, isfinite, isnan
from typing import TYPE_CHECKING

import numpy as np

from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import BY_NAME, FULL

if TYPE_CHECKING:
    from validation.verification.fidelity.trial import Row
    from weavecell.analysis.fidelity.error_database import Book


def survey_table(book: Book) -> list[str]:
    """Lines of Markdown: each model's cost, and errors that four scenes in five stay below, of a Book."""
    names = quantities.NAMES
    lines = [
        "| model | cost | " + " | ".join(_plain(name) for name in names) + " |",
        "|---|---:|" + "---:|" * len(names),
    ]
    rows = {
        name: (book.cost(BY_NAME[name]), {quantity: book.expected(BY_NAME[name], quantity) for quantity in names})
        for name in book.models
    }
    rows |= {f"*{name}*": (found["cost"], found["expected"]) for name, found in book.others.items()}
    for model, (cost, expected) in sorted(rows.items(), key=lambda item: item[1][0]):
        lines.append(f"| {model} | {cost:.3f} | " + " | ".join(_percent(expected[name]) for name in names) + " |")
    lines.append(f"| {FULL}, itself | | " + " | ".join(_percent(book.own(name)) for name in names) + " |")
    return lines


def trial_table(rows: list[Row]) -> list[str]:
    """Lines of Markdown: each scene, its targets, what was chosen and found, and what came of all."""
    lines = [
        "| case | targets | outcome | model | confirmed | worst error | met | cost | whole |",
        "|---|---|---|---|---|---:|---|---:|---:|",
    ]
    for row in rows:
        known = [(error, name) for name, error in row.found.items() if not isnan(error)]
        worst, name = max(known, default=(0.0, ""))
        found = "other outcome" if worst == inf else f"{_percent(worst)}{f' {_plain(name)}' if worst > 0 else ''}"
        confirmed = "is the full model" if row.model == FULL else "yes" if row.confirmed else "no"
        lines.append(
            f"| {row.fabric}, {row.shape}, {row.velocity:.0f} m/s | {_targets_text(row.targets)} | {row.outcome}"
            f" | {row.model} | {confirmed} | {found} | {'yes' if row.met else '**no**'}"
            f" | {row.cost:.3f} | {f'{row.whole_cost:.3f}' if isfinite(row.whole_cost) else '-'} |"
        )
    return [*lines, "", *_summary(rows)]


def _summary(rows):
    cheaper = [row for row in rows if row.model != FULL]
    sure = [row for row in cheaper if row.confirmed]
    whole = [row for row in rows if isfinite(row.whole_cost)]
    lines = [
        f"Within the targets: **{sum(row.met for row in rows)} of {len(rows)}**; median cost over that of the full "
        f"model on the same part of the panel: **{np.median([row.cost for row in rows]):.3f}**.",
        f"{len(rows) - len(cheaper)} were answered by the full model itself; of the {len(sure)} answers of cheaper "
        f"models that were called confirmed {sum(row.met for row in sure)} are within the targets, of the "
        f"{len(cheaper) - len(sure)} others {sum(row.met for row in cheaper if not row.confirmed)}.",
    ]
    if whole:
        share = np.median([row.whole_seconds / row.full_seconds for row in whole])
        cost = np.median([row.whole_cost for row in whole])
        lines.append(
            f"The whole panel was run for {len(whole)} of them and took {share:.2f} times its part, in the median; "
            f"over it the median cost of these is {cost:.3f}."
        )
    return lines


def _targets_text(targets):
    shares = set(targets.values())
    if len(targets) == len(quantities.NAMES) and len(shares) == 1:
        return f"all {_percent(shares.pop())}"
    return ", ".join(f"{_plain(name)} {_percent(share)}" for name, share in targets.items())


def _plain(name):
    return name.replace("_", " ")


def _percent(share):
    return "not known" if share == inf else f"{100 * share:.2g} %"
