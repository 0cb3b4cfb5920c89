"""The biaxial response of a fabric's crossover from the command line, at ratios of strains, to the strength of a yarn.

Folder of `weavecell biaxial`
    biaxial.csv     strains, tensions, contact force and heights of the unit cell, one row a state
    <ratio>.h5      with --compare-3d: history of the 3D crossover along the same path
    biaxial.json    where each path ends, differences from the 3D crossover, provenance
    pictures/cell.svg
    report.html
"""

from __future__ import annotations

import csv
import time
from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from math import isfinite, sqrt
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import catalogue, compression, files, units, variants
from fabrics.errors import InputError
from weavecell.commands import mesh
from weavecell.commands.options import RESULTS, FabricArgument, OutOption, Size, example
from weavecell.report import chapters
from weavecell.report import page as report_page
from weavecell.results import json_file, out_folder, progress, provenance

STATES = 241
_COLUMNS = {"T1": "warp tension [N]", "T2": "weft tension [N]", "F": "contact force [N]", "h1": "warp height [m]",
            "h2": "weft height [m]", "W": "stored energy [J]"}  # fmt: skip


class Profile(StrEnum):
    """Profiles of the yarns of the shell's cell."""

    cosine = "cosine"
    straight = "straight"


@example("weavecell biaxial S-720 --ratio 1:1 --ratio 2:1 --compare-3d coarse")
def biaxial(
    name: FabricArgument,
    ratio: Annotated[
        list[str] | None,
        typer.Option(help="Warp strain to weft strain; may be given again. 0 holds a yarn.", metavar="WARP:WEFT"),
    ] = None,
    crossover: Annotated[
        Size | None, typer.Option("--compare-3d", help="Solve the 3D crossover too, with this mesh, and compare.")
    ] = None,
    profile: Annotated[
        Profile, typer.Option(help="Centre line of the yarns: the thesis's cosine, or Kawabata's straight segments.")
    ] = Profile.cosine,
    toe: Annotated[
        str,
        typer.Option(
            "--fibre-slack",
            help="Mean slack of the fibres of a yarn (toe of its tensile curve): of both, or of warp and weft.",
            metavar="WARP[,WEFT]",
        ),
    ] = "0",
    law: Annotated[
        Path | None,
        typer.Option(
            help="Compression law of `weavecell calibrate` (law.json), in place of the fabric's.", metavar="FILE"
        ),
    ] = None,
    out: OutOption = None,
) -> None:
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen: `weavecell coupon`.
    """
    from shellfabric.cell.biaxial_path import to_strength
    from shellfabric.cell.model import CellModel

    out, size = out or RESULTS / f"biaxial-{Path(name).stem}", crossover and crossover.value
    wanted = {text: _ratio(text) for text in ratio or ("1:1", "1:0", "0:1")}
    plain = catalogue.load(name) if size is None else mesh.with_3d_data(name)
    fabric = variants.with_linear_density(plain, "effective")
    fabric = _with_law(fabric, law)
    options: dict[str, Any] = {"profile": profile.value, "toe": _toes(toe)}
    model, began = CellModel(fabric, **options), time.perf_counter()
    out_folder.claim(out)
    found = {text: to_strength(model, ratio, STATES) for text, ratio in wanted.items()}
    solved = {} if size is None else _crossovers(fabric, found, size, out)
    ends = {text: _end(path) | _misses(model, solved.get(text)) for text, path in found.items()}
    with files.write_whole(out / "biaxial.csv") as file:
        rows = csv.writer(file)
        rows.writerow(["ratio", "warp strain [-]", "weft strain [-]", *_COLUMNS.values()])
        for text, path in found.items():
            columns = (*path.strain.T, *(path.response[key] for key in _COLUMNS))
            rows.writerows([text, *(f"{value:.8g}" for value in row)] for row in zip(*columns))
    _report(out, model, found, solved, ends, options, size, began, "published" if law is None else str(law))
    for text, end in ends.items():
        print(
            f"{text:<8}{end['failed']} at its strength at strains {100 * end['strain'][0]:.2f} / "
            f"{100 * end['strain'][1]:.2f} %, tensions {end['tension'][0]:.1f} / {end['tension'][1]:.1f} N, "
            f"contact {end['contact_force']:.1f} N"
        )
    print(f"written to {out}")


def _with_law(fabric, law):
    """The fabric with the law in a file, or with its own."""
    if law is not None:
        return replace(fabric, laws=(compression.CompressionLaw.from_json(law),) * 2)
    if fabric.laws is None:
        allowed = f"given, a law.json of `weavecell calibrate`: fabric {fabric.name} has no compression law"
        raise InputError(key="--law", allowed=allowed)
    return fabric


def _report(out, model, found, solved, ends, options, size, began, source):
    """Write biaxial.json, pictures and report."""
    fabric, stamp = model.fabric, provenance.stamp("", model.fabric)
    content = {
        "fabric": fabric.name,
        "form": model.form,
        "law": source,
        **options,
        "mesh": size,
        "paths": ends,
        "provenance": stamp,
    }
    json_file.write(out / "biaxial.json", content)
    section = _chapter(fabric, found, solved, ends, options, source)
    report_page.write_pictures([section], out / "pictures")
    page = report_page.Report(
        f"{fabric.name}: biaxial response",
        "One crossover, stretched in both directions at fixed ratios of strains to the strength of its first yarn.",
        ((chapters.fabric_card(fabric), chapters.law_card(fabric.laws[0], source=source)),),  # type: ignore[index]
        (section, chapters.sources(fabric), chapters.making(stamp, {"all of it": time.perf_counter() - began})),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
    report_page.write(page, out / "report.html")


def _toes(text: str) -> float | Sequence[float]:
    """A toe from "0.1 %", or those of warp and weft from "0.1 %, 0.2 %"."""
    values = tuple(units.si(part.strip(), "", key="--fibre-slack") for part in text.split(","))
    return values[0] if len(values) == 1 else values


def _ratio(text):
    """(warp, weft) from "2:1"."""
    bad = InputError(key="--ratio", value=text, allowed='two numbers of at least 0, one of them above, such as "2:1"')
    try:
        ratio = tuple(float(part) for part in text.split(":"))
    except ValueError:
        raise bad from None
    if len(ratio) != 2 or not all(map(isfinite, ratio)) or not min(ratio) >= 0 < max(ratio):
        raise bad
    return ratio


def _crossovers(fabric, found, size, out):
    """{ratio: History} of the 3D crossover along the same paths."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    built, solved, (w1, w2) = crossover.build(fabric, size=size), {}, fabric.weave.w
    with progress.bar(f"3D crossover of {fabric.name}") as advance:
        for number, (text, path) in enumerate(found.items()):
            advance(number / len(found), text)
            solved[text] = biaxial_and_platens.biaxial(built, fabric, (path.ratio[0] * w1, path.ratio[1] * w2))
            solved[text].write(out / f"{text.replace(':', '-')}.h5")
    return solved


def _end(path):
    return {
        "failed": path.failed, "strain": path.strain[-1], "tension": path.tension[-1],
        "contact_force": float(path.response["F"][-1]),
    }  # fmt: skip


def _misses(model, history):
    """rms difference of the cell's tensions from those of the 3D crossover, at its states."""
    if history is None:
        return {}
    w1, w2 = model.fabric.weave.w
    cell = model.solve(1 + history.d1 / w1, 1 + history.d2 / w2)
    pairs = ((cell["T1"], history.T1), (cell["T2"], history.T2))
    return {"rms_from_3d": [sqrt(((own - other) ** 2).mean()) for own, other in pairs]}


def _chapter(fabric, found, solved, ends, options, source):
    paths = {}
    for text, path in found.items():
        title = f"strains {text}"
        if text in solved:
            history, (w1, w2) = solved[text], fabric.weave.w
            paths[title] = history.d1 / w1, history.d2 / w2, history.T1, history.T2
        else:
            paths[title] = tuple(path.strain.T)
    drawn = chapters.cell(
        fabric, {"published law" if source == "published" else "law given": fabric.laws}, paths=paths, **options
    )
    columns = ("strains, warp : weft", "first at its strength", "strain [%]", "tension [N]", "contact force [N]")
    columns += ("rms from 3D [N]",) if solved else ()
    rows = tuple(
        (
            text, end["failed"], _pair(100 * end["strain"], ".2f"), _pair(end["tension"], ".1f"),
            f"{end['contact_force']:.1f}", *((_pair(end["rms_from_3d"], ".2f"),) if solved else ()),
        )
        for text, end in ends.items()
    )  # fmt: skip
    table = report_page.Table(columns, rows, "Where each path ends, warp / weft", numeric=columns[2:])
    return report_page.Section("cell", drawn.title, drawn.lead, drawn.figures, (table,))


def _pair(values, form):
    return " / ".join(format(value, form) for value in values)
