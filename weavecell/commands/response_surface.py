"""The response surface of a fabric's crossover from the command line.

Folder of `weavecell surface`
    surface.h5      T1, T2, F_c, h1, h2 over (d1, d2) (`fabrics.surface`)
    surface.json    settings, estimated errors, comparison with the unit cell, times, provenance
    pictures/       surfaces, contours, slices beside the unit cell, what the interpolant misses
    report.html
    partial.h5      finished lines, while the run goes on: `--resume` begins with them
"""

from __future__ import annotations

from math import sqrt
from pathlib import Path
from typing import Annotated

import typer

from fabrics import units
from fabrics.errors import InputError
from weavecell.commands import mesh, options
from weavecell.report import chapters, pictures
from weavecell.report import page as report_page
from weavecell.results import json_file, out_folder, progress, provenance


@options.example("weavecell surface S-720 --mesh coarse --points 11")
def surface(
    name: options.FabricArgument,
    size: options.MeshOption = options.Size.medium,
    d1: Annotated[
        str, typer.Option("--d1", help="End displacements of the warp, per end.", metavar="'LOW .. HIGH'")
    ] = "0 mm .. 0.03 mm",
    d2: Annotated[
        str, typer.Option("--d2", help="End displacements of the weft, per end.", metavar="'LOW .. HIGH'")
    ] = "0 mm .. 0.03 mm",
    points: Annotated[int, typer.Option(help="Initial number of lines in each direction.")] = 21,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Refine until every line is interpolated from the others within this share of the largest force.",
            metavar="SHARE",
        ),
    ] = None,
    friction: options.FrictionOption = 0.0,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    out: options.OutOption = None,
    resume: options.ResumeOption = False,
) -> None:
    """Sample the response surface of the 3D crossover: tensions, contact force and heights over (d1, d2).

    The folder then holds surface.h5, surface.json, pictures/ and report.html; while the run goes on, partial.h5. With
    friction the response depends on the path: the surface is that of stretching the weft first and the warp then.
    """
    from unitcell3d.identify import response_surface as identify_response_surface

    out = out or options.RESULTS / f"surface-{Path(name).stem}"
    fabric = mesh.with_3d_data(name)
    spans = [_span(text, key) for text, key in ((d1, "--d1"), (d2, "--d2"))]
    stamp = provenance.stamp("", fabric)
    out_folder.claim(out, resume)
    with progress.bar(f"Response surface of {fabric.name}") as advance:
        found = identify_response_surface.sample(
            fabric,
            d1=spans[0],
            d2=spans[1],
            points=(points, points),
            tolerance=tolerance,
            size=size.value,
            friction=friction,
            partial=out / "partial.h5",
            resume=resume,
            jobs=jobs,
            executor=executor,
            on_progress=advance,
            provenance=f"weavecell {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}",
        )
    chosen = {
        "fabric": fabric.name, "mesh": size.value, "friction": friction, "d1_m": spans[0], "d2_m": spans[1],
        "lines": found.surface.T1.shape, "tolerance": tolerance,
    }  # fmt: skip
    _write(out, fabric, found, chosen, stamp)
    (out / "partial.h5").unlink(missing_ok=True)
    print(f"{'grid':<10}{found.surface.d1.size} x {found.surface.d2.size}, {size.value} mesh")
    _print_errors(found)
    print(f"written to {out}")


def _write(out, fabric, found, chosen, stamp):
    from unitcell3d.identify.interpolant import Interpolant

    found.surface.write(out / "surface.h5")
    interpolant, cell = Interpolant(found.surface), _cell(fabric, found.surface)
    sections = (
        _chapter(found, interpolant, cell),
        chapters.sources(fabric),
        chapters.making(stamp, found.seconds),
    )
    json_file.write(out / "surface.json", chosen | _results(found, cell) | {"provenance": stamp})
    report_page.write_pictures(sections[:1], out / "pictures")
    page = report_page.Report(
        f"{fabric.name}: response surface of the 3D crossover",
        "Tensions, contact force and heights of one crossing over the end displacements of its two yarns."
        + (
            f" Coulomb friction {chosen['friction']:g}; the weft is stretched first, then the warp."
            if chosen["friction"]
            else ""
        ),
        ((chapters.fabric_card(fabric),),),
        sections,
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
    report_page.write(page, out / "report.html")


def _results(found, cell):
    """The entries of surface.json that are computed."""
    return {
        "error_of_left_out_lines": {q: {"rms": e.rms, "largest": e.largest} for q, e in found.errors.items()},
        "rms_from_the_shells_cell_N": None if cell is None else _differences(found.surface, cell),
        "equilibria": found.solves,
        "tangents_factorised": found.iterations,
        "seconds": found.seconds,
    }


def _print_errors(found):
    for quantity, error in found.errors.items():
        factor, unit = _unit(quantity)
        print(
            f"{quantity:<10}left-out lines missed by {factor * error.rms:.3g} {unit} rms, "
            f"{factor * error.largest:.3g} at most"
        )


def _span(text, key):
    ends = text.split("..")
    if len(ends) != 2:
        raise InputError(key=key, value=text, allowed='two lengths, such as "0 mm .. 0.03 mm"')
    return tuple(units.si(end.strip(), "m", key=key) for end in ends)


def _unit(quantity):
    return (1.0, "N") if quantity in ("T1", "T2", "F_c") else (1e6, "µm")


def _cell(fabric, surface):
    """The shell's cell at the samples, {"T1", "T2", "F_c"}; None for a fabric without a law."""
    from shellfabric.cell.model import CellModel

    if fabric.laws is None:
        return None
    w1, w2 = fabric.weave.w
    state = CellModel(fabric).solve(1 + surface.d1[:, None] / w1, 1 + surface.d2[None, :] / w2)
    return {"T1": state["N1"], "T2": state["N2"], "F_c": state["F"]}


def _differences(surface, cell):
    return {name: sqrt(((getattr(surface, name) - values) ** 2).mean()) for name, values in cell.items()}


def _chapter(found, interpolant, cell):
    from weavecell.report import pictures_surface

    surface = found.surface
    differences = {} if cell is None else _differences(surface, cell)
    rows = []
    for quantity, error in found.errors.items():
        factor, unit = _unit(quantity)
        values = factor * getattr(surface, quantity)
        rows.append(
            (
                f"{quantity} [{unit}]",
                f"{values.min():.4g} to {values.max():.4g}",
                f"{factor * error.rms:.3g}",
                f"{factor * error.largest:.3g}",
                f"{differences[quantity]:.3g}" if quantity in differences else "-",
            )
        )
    columns = ("quantity", "range", "left-out lines, rms", "left-out lines, largest", "rms from the shell's cell")
    figures = [
        ("surfaces", "png", pictures_surface.surfaces, (interpolant,), "Forces over (d1, d2); white: samples."),
        ("contours", "png", pictures_surface.contours, (interpolant,), "Levels of the interpolated quantities."),
        (
            "missed", "svg", pictures_surface.missed, (surface, found.errors),
            "What the interpolant misses on a line that is left out, an upper estimate of its error; ticks: the lines.",
        ),
    ]  # fmt: skip
    if cell is not None:
        drawn = (surface, cell, "shell's cell, published law")
        caption = "Circles: 3D crossover. Lines: the shell's cell, whose yarns are sine curves with the published law."
        figures.insert(2, ("slices", "svg", pictures_surface.slices, drawn, caption))
    return report_page.Section(
        "surface",
        "Response surface",
        f"{surface.d1.size} × {surface.d2.size} samples, {found.solves} equilibria.",
        tuple(
            report_page.Figure(pictures.render(draw, *arguments, kind=kind), kind, caption, name)
            for name, kind, draw, arguments, caption in figures
        ),
        (report_page.Table(columns, tuple(rows), numeric=columns[1:]),),
    )
