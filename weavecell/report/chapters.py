"""The chapters of a report, each from results to a Section: what to say, which picture, which
table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.counted import counted
from fabrics.base.units import FACTORS
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.report import page, pictures, pictures_surface
from weavecell.report.derived import density_kind, derive_rows
from weavecell.report.page import Card, Figure, Report, Section, Table
from weavecell.results import finding
from weavecell.results.finding import Finding
from weavecell.scenes import words

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.scenes.impact import Scene
    from weavecell.studies.energy_map import EnergyMap

# [-] strains of the cell, to past the failure strain of the yarns
STRAINS = np.linspace(0.0, 0.032, 97)


def fabric_card(fabric: Fabric) -> Card:
    """Write the card that says which fabric."""
    weave = fabric.weave
    written = fabric.sources.get("warp.linear_density", {}).get("value", "")
    for unit in ("denier", "dtex", "tex"):
        if unit in written:
            break
    else:
        unit = "dtex"
    warp, weft = (yarn.linear_density / FACTORS["kg/m"][unit] for yarn in weave.yarns)
    density = f"{warp:.0f} / {weft:.0f} {unit}, warp / weft"
    if fabric.effective_linear_density is not None:
        kinds = {"effective": "from a measured areal density", "nominal": "of the data sheet"}
        density += f", {kinds[density_kind(fabric)]}"
    lines = (
        density,
        f"{1e3 * weave.areal_density:.1f} g/m², {1e3 * weave.thickness:.3f} mm thick",
        f"crimp {100 * weave.warp.crimp:.2f} / {100 * weave.weft.crimp:.2f} %",
        f"yarn strength {weave.warp.strength:.0f} / {weave.weft.strength:.0f} N",
    )
    return Card("Fabric", fabric.name, lines)


def law_card(
    law: CompressionLaw, published: CompressionLaw | None = None, source: str = ""
) -> Card:
    """Write the card that says which compression law, beside the published one; its constants if it
    was fitted."""
    title = "Compression of the yarns"
    headline = source.partition(" (")[0]
    # decoupled yarns do not compress each other
    if law.a == law.b == 0:
        return Card(title, headline or "none", ("none: the yarns keep their thickness",))
    lines = [f"at a crossover by {1e6 * float(law.d(F)):.1f} µm under {F} N" for F in (10, 100)]
    if published is not None:
        lines.append(f"a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
        lines.append(f"published: {1e3 * published.a:.4f} mm, {1e3 * published.b:.4f} mm N^(1/3)")
    if law.residual_rms is not None:
        lines.append(f"residual of the fit {1e6 * law.residual_rms:.2f} µm rms")
    return Card(title, headline or "given", tuple(lines))


def law_cards(case: Any) -> tuple[Card, ...]:
    """Write the card of the law of what was built from an input file; none of a response surface,
    or without a file."""
    if case is None or getattr(case, "surface", None) is not None:
        return ()
    if not case.materials:
        return (law_card(case.laws[0], source=case.law_name),)
    cards = []
    for material in case.materials:
        card = law_card(material.laws[0], source=material.law_name)
        cards.append(replace(card, label=f"{card.label}, {material.fabric.name}"))
    return tuple(cards)


def mesh(facts: Mapping[str, str], picture: bytes) -> Section:
    """Show the meshed crossover."""
    caption = "The whole crossover; by symmetry a quarter of it is solved."
    return Section(
        "mesh",
        "The crossover in hexahedra",
        "One crossing of warp (blue) and weft (orange). Mesh lines along the yarns are fibre lines and carry the bars.",
        (Figure(picture, "png", caption, "mesh"),),
        (Table(("quantity", "value"), tuple(facts.items())),),
        beside=True,
    )


def cell(
    fabric: Fabric,
    laws: Mapping[str, Any],
    model: str = "compressible",
    paths: Mapping[str, tuple] | None = None,
) -> Section:
    """Show the cell's biaxial response with each law, and the 3D crossover's if it is known.

    Parameters
    ----------
    laws : {label: (warp, weft) laws}
    paths : {title: (strain1, strain2, T1, T2)} [-, N] of straight paths of the 3D crossover, or
        strains alone where it has not been solved; two plain paths without
    """
    from shellfabric.cell.model import CellModel

    if not paths:
        paths = {
            "both yarns stretched alike": (STRAINS, STRAINS),
            "warp stretched, weft held": (STRAINS, 0 * STRAINS),
        }
    # a run that does not take the mean of its crossings has refused the weave itself
    models = {}
    for label, of in laws.items():
        models[label] = CellModel(fabric, of, cell_model=model, mean_crossing=True)
    share = np.linspace(0, 1, len(STRAINS))
    cases: dict[str, dict[str, Any]] = {}
    for title, (*strains, tension1, tension2) in _with_tensions(paths):
        ends = [float(strain[-1]) for strain in strains]
        # the axis shows the larger of the two strains
        main = int(ends[1] > ends[0])
        curves = {}
        for label, of_law in models.items():
            state = of_law.solve(1 + share * ends[0], 1 + share * ends[1])
            curves[label] = (state["N1"], state["N2"])
        measured = None
        if tension1 is not None:
            measured = (strains[main], tension1, tension2)
        cases[title] = {"strain": share * ends[main], "curves": curves, "points": measured}
    lead = "Tension of one yarn against the strain of the cell: lines are the shell's cell"
    if any(case["points"] for case in cases.values()):
        lead += ", circles the 3D crossover"
    if not fabric.weave.pattern.has_like_crossings:
        lead += ", by the mean of its crossings, which are of several kinds"
    caption = "Crimp exchange: each yarn bears on the other and carries load before it is straight."
    figure = pictures.draw_figure("cell", caption, pictures.cell, cases)
    points = []
    for label, (law, _) in laws.items():
        regularised = "F0 = 0"
        if law.form == "regularised":
            regularised = "F0 = (b / a)^3"
        points.append(
            f"Compression of the yarns, {label}: d_c = a - b / (F + F0)^(1/3), a = {1e3 * law.a:.4f} mm, "
            f"b = {1e3 * law.b:.4f} mm N^(1/3), {regularised}."
        )
    title = "Biaxial response of the cell"
    return Section("cell", title, f"{lead}.", (figure,), points=tuple(points))


def energy(found: EnergyMap, paths: Mapping[str, Any] | None = None, more: str = "") -> Figure:
    """Draw the energy of a crossover over its two strains, with paths.

    Parameters
    ----------
    found : of `weavecell.studies.energy_map`
    paths : {label: (strain_warp, strain_weft)} (n,) [-]
    more : sentences at the end of the caption
    """
    most, *strains = found.most
    at = " / ".join(f"{100 * strain:.2f}" for strain in strains)
    caption = (
        "Energy that the fabric stores over the strains of warp and weft, over its area at rest; white where a yarn "
        f"is past its strength. The most is {1e-3 * most:.3g} kJ/m² at strains of {at} %. {more}"
    )
    draw = pictures_surface.energy_map
    return pictures.draw_figure("energy", caption.strip(), draw, found, paths, kind="png")


def _with_tensions(paths):
    """(title, (strain1, strain2, T1, T2)) of each path; tensions that are not known are None."""
    for title, path in paths.items():
        yield title, (*path, None, None)[:4]


def comparison(rows: Iterable[tuple[str, str, str, str]]) -> Section:
    """Compare targets and values: rows of (quantity, target, value, met)."""
    rows = tuple(rows)
    missed = [quantity for quantity, _, _, met in rows if met == "no"]
    lead = "All are met."
    if missed:
        lead = f"Not met: {'; '.join(missed)}."
    return Section(
        "summary",
        "Compared with the published outcomes",
        lead,
        tables=(Table(("quantity", "target", "value", "met"), rows),),
    )


def sources(*fabrics: Fabric) -> Section:
    """Tabulate where each number comes from."""
    tables = []
    for fabric in fabrics:
        name = ""
        if len(fabrics) > 1:
            name = f" {fabric.name}"
        rows = []
        for key, entry in sorted(fabric.sources.items()):
            rows.append((key, entry["value"], entry["status"], entry["source"]))
        columns = ("key", "value", "status", "source")
        tables.append(Table(columns, tuple(rows), f"Data of the fabric{name}"))
        following = tuple(derive_rows(fabric))
        tables.append(Table(("quantity", "value"), following, f"What follows from them{name}"))
    return Section(
        "sources",
        "Where each number comes from",
        "Every input of the fabric as it stands in its data file. The thesis is the PhD thesis whose model is "
        "implemented; tables and equations have its numbers, and E-nn are its errata (validation/reports/errata.md).",
        tables=tuple(tables),
    )


def making(
    stamp: Mapping[str, Any], timings: Mapping[str, float], more: tuple[Table, ...] = ()
) -> Section:
    """Tell how the page was made: times, further tables, versions, machine and scene; folded."""
    tables = [*more]
    if timings:
        times = tuple((name, f"{seconds:.1f}") for name, seconds in timings.items())
        stages = Table(("stage", "wall time [s]"), times, numeric=("wall time [s]",))
        tables.insert(0, stages)
    rows = tuple((key, value) for key, value in stamp.items() if isinstance(value, str))
    rows = tuple((key, value) for key, value in rows if key != "scene")
    tables.append(Table(("what", "version or value"), rows))
    scene: tuple[tuple[str, str], ...] = ()
    if stamp["scene"]:
        scene = (("Input file", stamp["scene"]),)
    title = "How this was computed: times, settings, versions, input"
    return Section("making", title, tables=tuple(tables), details=scene, folded=True)


def describe_shot(setup: ImpactSetup, scene: Scene | None, *, velocity: bool = False) -> str:
    """Say in a sentence what is shot at, how it is held, what is behind it, and the projectile."""
    plies = f"One ply of {setup.name}"
    if setup.plies > 1 and setup.lay_up:
        plies = f"{counted(setup.plies, 'ply')}: {setup.name}"
    elif setup.plies > 1:
        plies = f"{counted(setup.plies, 'ply')} of {setup.name}, {setup.stacking}"
    if scene is None:
        return f"{plies}."
    sentence = f"{plies}, {words.panel_in_words(scene.panel)}"
    if scene.backing is not None:
        sentence += f", before {words.backing_in_words(scene.backing)}"
    sentence += ", struck"
    if velocity:
        sentence += f" at {scene.projectile.strike_velocity:g} m/s"
    return f"{sentence} by {words.shot_in_words(scene.projectile)}."


def report(
    title: str,
    lead: str,
    fabrics: Sequence[Fabric],
    cards: Sequence[Card],
    sections: Iterable[Section],
    stamp: Mapping[str, Any],
    seconds: Mapping[str, float],
    found: Finding,
    outcome: str = "",
    more: tuple[Table, ...] = (),
) -> Report:
    """Build the page of any result: what it found as its banner and on its first card, those of its
    fabrics, the others; sources and the making at the end.

    Parameters
    ----------
    stamp : of `results.provenance.stamp`
    seconds : {stage: wall time [s]}
    found : colours banner and first card, and names the doubts there
    outcome : the banner in place of label and value of `found`, without doubts
    more : tables of the making
    """
    first, *others = cards or (Card(found.label, found.value),)
    cards = (first.with_doubts(found), *map(fabric_card, fabrics), *others)
    banner = finding.mark(outcome or f"{found.label}: {found.value}.", found.doubts)
    sections = (*sections, sources(*fabrics), making(stamp, seconds, more))
    return Report(
        title,
        lead,
        (cards,),
        sections,
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
        banner,
        found.tone,
    )


def write(out: Path, *contents: Any, **more: Any) -> None:
    """Write report.html with the contents of `report` to a folder."""
    page.write(report(*contents, **more), out / "report.html")
