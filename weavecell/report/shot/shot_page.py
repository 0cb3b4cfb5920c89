"""Chapters and page of the report of one impact, on one ply or on a pack."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from fabrics import assumed
from weavecell.report import chapters, chapters_assumed, chapters_discretisation, chapters_impact, checks
from weavecell.report.page import Report, Section
from weavecell.report.shot import chapters_mesh, chapters_shot, tables_shot
from weavecell.scenes import words
from weavecell.scenes.build import Case

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.results.impact import ImpactRecord
    from weavecell.studies.assumed_range import AssumedRange
    from weavecell.studies.mesh_uncertainty import Discretisation


def sections(
    this: Case, setup: ImpactSetup, record: ImpactRecord, around: AssumedRange | None = None,
    pair: Discretisation | None = None,
) -> list[Section]:  # fmt: skip
    """The chapters that have pictures or follow from options.

    Parameters
    ----------
    this : of the scene
    setup : what was run
    around, pair : the range over assumed laws, the discretisation uncertainty
    """
    used, places = setup.meshed, this.scene.history.report_positions if this.scene.history else ()
    found = [chapters_shot.chapter([record]), chapters_mesh.section(record, used)]
    if pair is not None:
        found.append(chapters_discretisation.section(pair))
    if around is not None:
        found.append(chapters_assumed.section(around))
    ends = dict.fromkeys((0, record.count - 1)) if record.measured else ()  # the ply that is struck, and the last
    found += [chapters_impact.measures(record.measured[p], places, p + 1 if record.pack else None) for p in ends]
    found += [*chapters_impact.body(record), *_cell(this)]
    return [
        *found,
        chapters_shot.assumptions(
            used, tuple(line for fabric in setup.fabrics for line in assumed.lines(fabric)), body=record.rigid_check
        ),
    ]


def _cell(this):
    """The cell's response where it has laws."""
    if this.surface is not None:
        return ()
    model = this.scene.fabric.cell_model
    return (chapters.cell(this.fabric, {this.law_name: this.laws}, model, **chapters.options(this.scene.fabric)),)


def page(
    this: Case, setup: ImpactSetup, record: ImpactRecord, found: Sequence[Section],
    stamp: dict[str, str],
) -> Report:  # fmt: skip
    """The report of one impact; `found` are the chapters of `sections`."""
    shot, panel, model = this.scene.projectile, this.scene.panel, this.scene.fabric.cell_model
    source = this.law_name if model == "compressible" else model
    laws = (chapters.law_card(this.laws[0], source=source),) if this.surface is None else ()
    plies, more = f"One ply of {record.fabric_name}", ""
    if record.pack:
        plies = f"{record.count} plies: {record.fabric_name}"
        if not setup.lay_up:
            plies = f"{record.count} plies of {record.fabric_name}, {record.pack['stacking']}"
        more = f" At rest: {record.gap_words}; {record.contact_words}."
    return Report(
        record.title,
        f"{plies}, {words.panel_in_words(panel)}, struck at {shot.strike_velocity:g} m/s by "
        f"{words.shot_in_words(shot)}.{more}",
        ((chapters_shot.card(record), *map(chapters.fabric_card, setup.fabrics), *laws),),
        (
            *found,
            checks.section(record.checks),
            chapters.sources(*setup.fabrics),
            chapters.making(stamp, {"time integration": record.wall_time}, tables_shot.cost([record], setup.meshed)),
        ),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
        outcome=chapters_shot.outcome(record),
        tone=record.outcome,
    )
