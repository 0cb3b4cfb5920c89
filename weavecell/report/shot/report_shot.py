"""The pictures and the page of an impact: which chapters it has, and how they are written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from weavecell.report import chapters, chapters_discretisation, checks, page
from weavecell.report.page import Figure, Section
from weavecell.report.shot import chapters_shot, moving, view
from weavecell.results.left_out import lines_of

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup


def write(found: Any, out: Path, stamp: Mapping[str, Any]) -> None:
    """Write the pictures and the page of a ShotResult to a folder, as far as its outputs name them.

    Parameters
    ----------
    found : ShotResult of an input file
    stamp : of `provenance.stamp`
    """
    scene = found.case.scene
    outputs = scene.run.outputs
    setup = found.target.setup if found.pair is None else found.pair.setup
    stills = view.still(found)
    beside = stills[:1]
    if found.draws is not None:
        # it has the answer; histories and stills are of one run
        beside = (chapters_shot.draw_draws(found.draws),)
    sections = _list_sections(found, setup, tuple(one for one in stills if one not in beside))
    if "pictures" in outputs:
        page.write_pictures((Section("panel", "", figures=beside), *sections), out / "pictures")
    if "report" in outputs:
        chapters.write(
            out,
            chapters.describe_shot(setup, scene, velocity=True),
            setup.fabrics,
            (*sections, checks.section(found.checks)),
            stamp,
            {"time integration": found.wall_time},
            found.answer,
            (chapters_shot.settings(setup.meshed),),
            beside,
        )


def _list_sections(found: Any, setup: ImpactSetup, stills: tuple[Figure, ...]) -> list[Section]:
    """Return the chapters that have pictures or follow from options; `setup` is what was run, `stills`
    pictures of its end."""
    case = found.case
    scene = case.scene
    used = setup.meshed
    lead = ""
    if found.draws is not None:
        lead = f"{found.run_words}: it {chapters_shot.outcome(found)}."
        lead = lead[0].upper() + lead[1:]
    sections = [
        moving.section(found, moving.collect_instants(found, found.instants)),
        chapters_shot.chapter(found, stills, lead),
        chapters_shot.mesh(found, used),
    ]
    if used.crossovers is None:
        sections.insert(-1, chapters_shot.critical(found, used))
    if found.pair is not None:
        sections.append(chapters_discretisation.section(found.pair))
    if found.measured:
        places = scene.history.report_positions if scene.history else ()
        # the ply that is struck, and the last
        for ply in dict.fromkeys((0, found.count - 1)):
            number = ply + 1 if found.pack else None
            fabric = found.ply_fabrics[ply] if found.ply_fabrics else ""
            if found.measured[ply].yarns:
                sections.append(chapters_shot.measures(found.measured[ply], places, number, fabric))
    sections += chapters_shot.body(found)
    if found.draws is not None:
        sections.append(chapters_shot.describe_draws(found.draws))
        sections.append(chapters_shot.describe_unknown(setup))
    if case.surface is None:
        cell = chapters.cell(case.fabric, {case.law_name: case.laws}, scene.fabric.cell_model)
        sections.append(replace(cell, folded=True))
    lines = [*found.assumed, *lines_of(found.left_out)]
    if found.pack:
        lines += [found.gap_words, found.contact_words]
    sections.append(chapters_shot.assumptions(used, lines, body=found.rigid_check))
    return sections
