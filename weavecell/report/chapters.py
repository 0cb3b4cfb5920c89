"""The chapters of a report, each from results to a Section: what to say, which picture, which table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.units import FACTORS
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.report import pictures
from weavecell.report.derived import density_kind, derived
from weavecell.report.page import Card, Figure, Report, Section, Table
from weavecell.scenes import words

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.scenes.impact import Scene

STRAINS = np.linspace(0.0, 0.032, 97)  # [-] of the cell, to past the yarns' failure strain


def fabric_card(fabric: Fabric) -> Card:
    """Which fabric."""
    weave = fabric.weave
    written = fabric.sources.get("warp.linear_density", {}).get("value", "")
    unit = next((unit for unit in ("denier", "dtex", "tex") if unit in written), "dtex")
    density = " / ".join(
        f"{yarn.linear_density / FACTORS['kg/m'][unit]:.0f}" for yarn in weave.yarns
    )
    kinds = {"effective": ", from a measured areal density", "nominal": ", of the data sheet"}
    kind = "" if fabric.effective_linear_density is None else kinds[density_kind(fabric)]
    return Card(
        "Fabric",
        fabric.name,
        (
            f"{density} {unit}, warp / weft{kind}",
            f"{1e3 * weave.areal_density:.1f} g/m², {1e3 * weave.thickness:.3f} mm thick",
            f"crimp {100 * weave.warp.crimp:.2f} / {100 * weave.weft.crimp:.2f} %",
            f"yarn strength {weave.warp.strength:.0f} / {weave.weft.strength:.0f} N",
        ),
    )


def law_card(
    law: CompressionLaw, published: CompressionLaw | None = None, source: str = ""
) -> Card:
    """Which compression law, beside the published one; its constants where it was fitted."""
    title, headline = "Compression of the yarns", source.partition(" (")[0]
    if law.a == law.b == 0:  # of a cell whose yarns are not compressed
        return Card(title, headline or "none", ("none: the yarns keep their thickness",))
    lines = [f"at a crossover by {1e6 * float(law.d(F)):.1f} µm under {F} N" for F in (10, 100)]
    if published is not None:
        lines.append(f"a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
        lines.append(f"published: {1e3 * published.a:.4f} mm, {1e3 * published.b:.4f} mm N^(1/3)")
    if law.residual_rms is not None:
        lines.append(f"residual of the fit {1e6 * law.residual_rms:.2f} µm rms")
    return Card(title, headline or "given", tuple(lines))


def law_cards(case: Any) -> tuple[Card, ...]:
    """The card of the law of what was built from an input file; none of a response surface, or without a file."""
    if case is None or getattr(case, "surface", None) is not None:
        return ()
    cards = []
    for of in case.materials or (case,):
        card = law_card(of.laws[0], source=of.law_name)
        name = f"{card.label}, {of.fabric.name}" if case.materials else card.label
        cards.append(replace(card, label=name))
    return tuple(cards)


def mesh(facts: Mapping[str, str], picture: bytes) -> Section:
    """The meshed crossover."""
    return Section(
        "mesh",
        "The crossover in hexahedra",
        "One crossing of warp (blue) and weft (orange). Mesh lines along the yarns are fibre lines and carry the bars.",
        (
            Figure(
                picture,
                "png",
                "The whole crossover; by symmetry a quarter of it is solved.",
                "mesh",
            ),
        ),
        (Table(("quantity", "value"), tuple(facts.items())),),
        beside=True,
    )


def cell(
    fabric: Fabric,
    laws: Mapping[str, Any],
    model: str = "compressible",
    paths: Mapping[str, tuple] | None = None,
) -> Section:
    """The cell's biaxial response with each law, and the 3D crossover's where it is known.

    Parameters
    ----------
    laws : {label: (warp, weft) laws}
    paths : {title: (strain1, strain2, T1, T2)} [-, N] of straight paths of the 3D crossover, or strains alone where it
        has not been solved; two plain paths without
    """
    from shellfabric.cell.model import CellModel

    paths = paths or {
        "both yarns stretched alike": (STRAINS, STRAINS),
        "warp stretched, weft held": (STRAINS, 0 * STRAINS),
    }
    cases = {}
    for title, (warp, weft, *tensions) in paths.items():
        share = np.linspace(0, 1, 97)
        ends = float(warp[-1]), float(weft[-1])
        main = int(ends[1] > ends[0])  # the strain on the axis is the larger one
        curves = {}
        for label, pair in laws.items():
            state = CellModel(fabric, pair, model=model).solve(
                1 + share * ends[0], 1 + share * ends[1]
            )
            curves[label] = (state["N1"], state["N2"])
        measured = ((warp, weft)[main], *tensions) if tensions else None
        cases[title] = {"strain": share * ends[main], "curves": curves, "points": measured}
    content = pictures.render(pictures.cell, cases)
    lead = "Tension of one yarn against the strain of the cell: lines are the shell's cell"
    lead += ", circles the 3D crossover." if any(case["points"] for case in cases.values()) else "."
    caption = "Crimp exchange: each yarn bears on the other and carries load before it is straight."
    points = [
        f"Compression of the yarns, {label}: d_c = a - b / (F + F0)^(1/3), a = {1e3 * law.a:.4f} mm, "
        f"b = {1e3 * law.b:.4f} mm N^(1/3), {'F0 = (b / a)^3' if law.form == 'regularised' else 'F0 = 0'}."
        for label, (law, _) in laws.items()
    ]
    figure = Figure(content, "svg", caption, "cell")
    return Section("cell", "Biaxial response of the cell", lead, (figure,), points=tuple(points))


def comparison(rows: Iterable[tuple[str, str, str, str]]) -> Section:
    """Targets and values: rows of (quantity, target, value, met)."""
    rows = tuple(rows)
    missed = [quantity for quantity, _, _, met in rows if met == "no"]
    lead = f"Not met: {'; '.join(missed)}." if missed else "All are met."
    return Section(
        "summary",
        "Compared with the published outcomes",
        lead,
        tables=(Table(("quantity", "target", "value", "met"), rows),),
    )


def sources(*fabrics: Fabric) -> Section:
    """Where each number comes from."""
    tables = []
    for fabric in fabrics:
        of = f" {fabric.name}" if fabrics[1:] else ""
        data = sorted(fabric.sources.items())
        rows = tuple((key, entry["value"], entry["status"], entry["source"]) for key, entry in data)
        tables.append(
            Table(("key", "value", "status", "source"), rows, caption=f"Data of the fabric{of}")
        )
        tables.append(
            Table(
                ("quantity", "value"), tuple(derived(fabric)), caption=f"What follows from them{of}"
            )
        )
    return Section(
        "sources",
        "Where each number comes from",
        "Every input of the fabric as it stands in its data file. The thesis is the PhD thesis whose model is "
        "implemented; tables and equations have its numbers, and E-nn are its errata (docs/reports/errata.md).",
        tables=tuple(tables),
    )


def making(
    stamp: Mapping[str, str], timings: Mapping[str, float], more: tuple[Table, ...] = ()
) -> Section:
    """How the page was made: times, further tables, versions, machine and scene; folded."""
    rows = tuple((key, value) for key, value in stamp.items() if key != "scene")
    times = tuple((name, f"{seconds:.1f}") for name, seconds in timings.items())
    stages = Table(("stage", "wall time [s]"), times, numeric=("wall time [s]",))
    tables = *([stages] if times else []), *more, Table(("what", "version or value"), rows)
    scene = (("Scene", stamp["scene"]),) if stamp["scene"] else ()
    title = "How this was computed: times, settings, versions, input"
    return Section("making", title, tables=tables, details=scene, folded=True)


def struck(setup: ImpactSetup, scene: Scene | None, *, velocity: bool = False) -> str:
    """What is shot at, how it is held, what is behind it, and the projectile, in a sentence."""
    plies = f"One ply of {setup.name}"
    if setup.plies > 1:
        plies = (
            f"{setup.plies} plies: {setup.name}"
            if setup.lay_up
            else f"{setup.plies} plies of {setup.name}"
        )
        plies += "" if setup.lay_up else f", {setup.stacking}"
    if scene is None:
        return f"{plies}."
    behind = "" if scene.backing is None else f", before {words.backing_in_words(scene.backing)}"
    at = f" at {scene.projectile.strike_velocity:g} m/s" if velocity else ""
    panel, projectile = words.panel_in_words(scene.panel), words.shot_in_words(scene.projectile)
    return f"{plies}, {panel}{behind}, struck{at} by {projectile}."


def report(
    title: str,
    lead: str,
    fabrics: Sequence[Fabric],
    cards: Sequence[Card],
    sections: Iterable[Section],
    stamp: Mapping[str, str],
    seconds: Mapping[str, float],
    outcome: str = "",
    tone: str = "plain",
    more: tuple[Table, ...] = (),
) -> Report:
    """The page of any result: the first card, those of its fabrics, the others; sources and the making at the end.

    Parameters
    ----------
    stamp : of `results.provenance.stamp`
    seconds : {stage: wall time [s]}
    outcome, tone : of the Report
    more : tables of the making
    """
    cards = (*cards[:1], *map(fabric_card, fabrics), *cards[1:])
    sections = (*sections, sources(*fabrics), making(stamp, seconds, more))
    return Report(
        title,
        lead,
        (cards,),
        sections,
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
        outcome,
        tone,
    )
