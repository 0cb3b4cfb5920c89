"""A page of two shots beside each other: what differs, both in motion under one slider with one scale
of colours, histories in one picture, results side by side."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report import checks, pictures, pictures_comparison
from weavecell.report.page import Figure, Report, Section, Table
from weavecell.report.shot import chapters_shot, moving, pictures_shot
from weavecell.results import display, finding, keys
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from weavecell.results.impact import ImpactRecord

_CAPTION = (
    "A and B at one instant: the slider and the colours are for both, with one scale. Drag one to turn "
    "both. Front is the side that is struck. Tension in % of the strength; orange: one yarn failed; elements "
    "that have lost both are left out. What has ended stays as it was at its end."
)
_LETTERS = "AB"
# results that the first line compares, by key of summary.json
HEADLINE = (
    "residual_velocity_m_s",
    "max_deflection_m",
    "absorbed_energy_J",
    "peak_contact_force_N",
)


def names(records: Sequence[ImpactRecord]) -> tuple[str, ...]:
    """Return what A and B are called."""
    return tuple(
        finding.tag(f"{letter}, {record.title}", finding.list_doubts(record.checks))
        for letter, record in zip(_LETTERS, records)
    )


def build(
    records: Sequence[ImpactRecord], instants: Sequence[Sequence[tuple[Any, float]]]
) -> Report:
    """Build the page of two shots.

    Parameters
    ----------
    records : of A and B
    instants : (grid of `results.vtk.panel`, time [s]) of each snapshot, of A and of B
    """
    titles = names(records)
    motion = Section(
        "motion",
        "A and B in motion",
        _CAPTION,
        (_cuts(records),),
        pair=tuple(zip(titles, scale_alike(records, instants))),
    )
    caption = (
        "Velocity of the projectile, deflection of the back face and contact force of A and B."
    )
    draw = pictures_comparison.draw_shots
    curves = pictures.draw_figure("histories", caption, draw, dict(zip(titles, records)))
    sections = (
        Section("results", "A and B side by side", "", tables=(results(records),)),
        motion,
        Section("histories", "Over time", "", (curves,)),
        Section("all", "All results", tables=(every_result(records),), folded=True),
    )
    return Report(Answer(" beside ".join(titles), difference(records)), "", sections)


def difference(records: Sequence[ImpactRecord]) -> str:
    """Say in a line how the outcomes and the main results of A and B differ."""
    a, b = records
    said = f"Both {a.outcome}" if a.outcome == b.outcome else f"A {a.outcome}, B {b.outcome}"
    parts = []
    facts = [record.facts() for record in records]
    units = _units()
    for name in HEADLINE:
        before, after = (fact.get(name) for fact in facts)
        if before is None or after is None or before == after:
            continue
        label = chapters_shot.OF_A_DESIGNER[name]
        first, second, more = (
            display.text(value, units[name], form=form)
            for value, form in zip((before, after, after - before), (".3g", ".3g", "+.3g"))
        )
        parts.append(f"{label} {first} and {second} ({more})")
    sentence = f"{said}: {', '.join(parts)}." if parts else f"{said}, with the same results."
    return " ".join((sentence, *_doubts(records)))


def _doubts(records):
    """A sentence about each of A and B that is doubtful."""
    for letter, record in zip(_LETTERS, records):
        if checks.status(record.checks) == checks.DOUBTFUL:
            yield f"{letter} is {checks.words(record.checks)}."


def _units():
    return {key.name: key.unit for key in keys.table("impact", *keys.OF_SOME.values())}


def _rows(records, labelled):
    """Rows (label, A, B, B less A) of {key of summary.json: label}."""
    facts = [record.facts() for record in records]
    units = _units()
    rows = [("outcome", *(record.outcome for record in records), "")]
    for name, label in labelled.items():
        values = [fact.get(name) for fact in facts]
        # what neither has is no row
        if not units.get(name) or values == [None, None]:
            continue
        texts = ["-" if value is None else display.number(value, units[name]) for value in values]
        less = ""
        if all(isinstance(value, (int, float)) for value in values):
            less = display.number(values[1] - values[0], units[name])
        rows.append((label, *texts, less))
    return tuple(rows)


def results(records: Sequence[ImpactRecord]) -> Table:
    """Tabulate what a designer asks of two shots, side by side."""
    units = _units()
    labelled = {
        name: display.heading(label, units[name])
        for name, label in chapters_shot.OF_A_DESIGNER.items()
        if name in units
    }
    columns = ("result", *names(records), "B − A")
    return Table(columns, _rows(records, labelled), "", columns[1:])


def every_result(records: Sequence[ImpactRecord]) -> Table:
    """Tabulate every number of both summaries, side by side."""
    table = keys.table("impact", *keys.OF_SOME.values(), "failure")
    labelled = {key.name: key.label for key in table}
    columns = ("result", *names(records), "B − A")
    return Table(
        columns, _rows(records, labelled), "As the two summary.json have them", columns[1:]
    )


def _cuts(records: Sequence[ImpactRecord]) -> Figure:
    """Cuts at the end of each, on axes of one height."""
    rows = []
    for letter, record in zip(_LETTERS, records):
        last = record.cuts[-1]
        title = f"{letter}, {chapters_shot.instant(record, last.time)}"
        view = chapters_shot.cut_view(record, last, title)
        rows.append(view)
    if len({row.fabrics for row in rows}) > 1:
        # one legend would name the plies of both
        rows = [replace(row, fabrics=()) for row in rows]
    caption = "A and B cut open along x through the impact point at their ends, on axes of one height; right to scale."
    fabrics = [f"{letter}: {record.which_fabric}" for letter, record in zip(_LETTERS, records)]
    if any(record.which_fabric for record in records):
        caption += f" {'. '.join(fabrics)}."
    draw = pictures_shot.cuts
    return pictures.draw_figure("cuts", caption, draw, rows, chapters_shot.CLOSE_UP)


def scale_alike(
    records: Sequence[ImpactRecord], instants: Sequence[Sequence[tuple[Any, float]]]
) -> list[str]:
    """Write the arrays of both views as JSON (`moving.moving`), with one end of each scale of colours
    and one width, so that what looks alike is alike."""
    heads = [json.loads(moving.moving(*pair)) for pair in zip(records, instants)]
    for name in heads[0]["ends"]:
        widest = max((head["ends"][name] for head in heads), key=lambda end: end["value"])
        for head in heads:
            head["ends"][name] = widest
    for name in ("width", "depth"):
        most = float(np.max([head[name] for head in heads]))
        for head in heads:
            head[name] = most
    # one side is seen of both
    for head in heads:
        head["elevation"] = heads[0]["elevation"]
    return [json.dumps(head) for head in heads]
