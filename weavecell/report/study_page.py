"""The page of a study of many shots: what was found with its picture and table, what is assumed, and sources."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from fabrics import assumed
from weavecell.report import chapters, checks, pictures
from weavecell.report.page import Card, Figure, Report, Section, Table
from weavecell.report.shot import chapters_shot

if TYPE_CHECKING:
    from weavecell.api.study_result import StudyResult

_LINES = 2  # of the card


def page(study: StudyResult, stamp: Mapping[str, str]) -> Report:
    """The report of a study."""
    setup, case, (label, value), lines = (
        study.target.setup,
        study.target.case,
        study.headline,
        study.lines(),
    )
    picture = Figure(pictures.render(study.draw), "svg", "", "result")
    sections = [
        Section("result", "Result", "", (picture,), (Table.of(study.table()),), points=tuple(lines))
    ]
    shown, span = [line for line in lines if value not in line][:_LINES], []
    if (around := getattr(study, "assumed_range", None)) is not None:
        sections.append(chapters_shot.assumed(around))
        if "what is assumed" not in value:
            span = [f"{around.low:.1f} to {around.high:.1f} m/s over what is assumed"]
    laws = [line for fabric in setup.fabrics for line in assumed.lines(fabric)]
    sections.append(
        chapters_shot.assumptions(
            setup, laws, drawn=hasattr(getattr(study, "study", None), "scatter")
        )
    )
    if study.checks:
        sections.append(checks.section(study.checks))
    doubtful = [check.name for check in study.checks if check.doubtful]
    outcome = f"{label} {', '.join([value, *span])}." + f" DOUBTFUL: {', '.join(doubtful)}." * bool(
        doubtful
    )
    card = Card(label, value, (*span, *shown))
    seconds = {"study": study.wall_time} if hasattr(study, "wall_time") else {}
    title = study.title if ":" in study.title else f"{study.title}: {label[0].lower()}{label[1:]}"
    lead = "The first combination: " * hasattr(study, "targets")  # of a sweep
    lead += chapters.struck(setup, None if case is None else case.scene)
    cards = card, *chapters.law_cards(case)
    return chapters.report(title, lead, setup.fabrics, cards, sections, stamp, seconds, outcome)
