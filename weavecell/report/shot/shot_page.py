"""Chapters and page of the report of one impact, on one ply or on a pack."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from weavecell.report import chapters, chapters_discretisation, checks
from weavecell.report.page import Figure, Report, Section
from weavecell.report.shot import chapters_shot, moving, view

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.api.shots import ShotResult


def sections(shot: ShotResult, setup: ImpactSetup) -> list[Section]:
    """The chapters that have pictures or follow from options; `setup` is what was run."""
    case, used = shot.case, setup.meshed
    places = case.scene.history.report_positions if case.scene.history else ()
    caption = "The same cut open along x through the impact point; left with heights stretched, right to scale."
    film = Figure(view.cut_in_motion(shot), "gif", caption, "cut")
    motion = moving.section(shot, moving.of_shapes(shot, shot.instants), [film])
    found = [motion, chapters_shot.chapter(shot, view.still(shot)), chapters_shot.mesh(shot, used)]
    if shot.pair is not None:
        found.append(chapters_discretisation.section(shot.pair))
    if shot.assumed_range is not None:
        found.append(chapters_shot.assumed(shot.assumed_range))
    ends = (
        dict.fromkeys((0, shot.count - 1)) if shot.measured else ()
    )  # the ply that is struck, and the last
    found += [
        chapters_shot.measures(shot.measured[p], places, p + 1 if shot.pack else None) for p in ends
    ]
    found += chapters_shot.body(shot)
    if case.surface is None:
        model, options = case.scene.fabric.cell_model, chapters.options(case.scene.fabric)
        found.append(chapters.cell(case.fabric, {case.law_name: case.laws}, model, **options))
    lines = [*shot.assumed, *((shot.gap_words, shot.contact_words) if shot.pack else ())]
    return [*found, chapters_shot.assumptions(used, lines, body=shot.rigid_check)]


def page(
    shot: ShotResult, setup: ImpactSetup, found: Sequence[Section], stamp: Mapping[str, str]
) -> Report:
    """The report of one impact; `found` are the chapters of `sections`."""
    lead = chapters.struck(setup, shot.case.scene, velocity=True)
    cards, cost = (
        (chapters_shot.card(shot), *chapters.law_cards(shot.case)),
        chapters_shot.cost(shot, setup.meshed),
    )
    all_of_them, seconds = (
        (*found, checks.section(shot.checks)),
        {"time integration": shot.wall_time},
    )
    banner = chapters_shot.outcome(shot), shot.outcome
    return chapters.report(
        shot.title, lead, setup.fabrics, cards, all_of_them, stamp, seconds, *banner, cost
    )
