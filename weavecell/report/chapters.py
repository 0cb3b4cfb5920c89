"""The chapters of a report, each from results to a Section: what to say, which picture, which
table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.counted import counted
from fabrics.fabric import Fabric
from weavecell.report import page, pictures, pictures_surface
from weavecell.report.derived import derive_rows
from weavecell.report.page import Figure, Report, Section, Table
from weavecell.results.finding import Answer
from weavecell.scenes import words

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.scenes.impact import Scene
    from weavecell.studies.energy_map import EnergyMap

# [-] strains of the cell, to past the failure strain of the yarns
STRAINS = np.linspace(0.0, 0.032, 97)


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
        "Every input of the fabric as it stands in its data file. Tables and equations have the numbers of the thesis; "
        "E-nn are its errata.",
        tables=tuple(tables),
        folded=True,
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


def movers(answer: Answer) -> Section:
    """Tabulate what moves an answer, the most first, and what it leaves out."""
    if all(one.moved is None for one in answer.movers):
        rows = tuple((one.what, one.settle) for one in answer.movers)
        table = Table(("not varied", "measure, give or run"), rows)
        return Section("movers", "What the answer leaves out", tables=(table,))
    listed = []
    for one in answer.ranked:
        moved = "not computed" if one.moved is None else f"{one.moved:.3g} m/s"
        listed.append((one.what, moved, one.settle))
    table = Table(("what", "moves it by", "measure, give or run"), tuple(listed))
    return Section("movers", "What moves the answer", tables=(table,))


def report(
    lead: str,
    fabrics: Sequence[Fabric],
    sections: Iterable[Section],
    stamp: Mapping[str, Any],
    seconds: Mapping[str, float],
    answer: Answer,
    more: tuple[Table, ...] = (),
    beside: tuple[Figure, ...] = (),
) -> Report:
    """Build the page of any result: its answer, what moves it, its sections; sources and the making
    at the end.

    Parameters
    ----------
    stamp : of `results.provenance.stamp`
    seconds : {stage: wall time [s]}
    more : tables of the making
    beside : picture beside the answer
    """
    listed = [movers(answer)] if answer.movers else []
    sections = (*listed, *sections, sources(*fabrics), making(stamp, seconds, more))
    footer = f"weavecell {stamp['weavecell']}, {stamp['date']}"
    return Report(answer, lead, sections, footer, beside)


def write(out: Path, *contents: Any, **more: Any) -> None:
    """Write report.html with the contents of `report` to a folder."""
    page.write(report(*contents, **more), out / "report.html")
