"""The mesh of a crossover or a woven patch from the command line.

Folder of `weavecell mesh`
    crossover.msh, crossover.vtu    or patch.*; the formats requested (OpenRadioss: crossover_0000.rad)
    crossover.png, quality.png      the mesh, and the scaled Jacobian of its elements
    mesh.json                       size, quality, overlap, provenance
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from weavecell.commands import options
from weavecell.results import json_file, out_folder, progress, provenance

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

FORMATS = ("msh", "vtu", "k", "inp", "rad")
PERIODIC = (2, 2)  # yarns of the periodic cell


class Domain(StrEnum):
    """How much of a crossover is meshed."""

    quarter = "quarter"
    whole = "whole"
    periodic = "periodic"


class Overlap(StrEnum):
    """What to do with sections that overlap."""

    solve = "solve"
    refuse = "refuse"


TipOption = Annotated[
    float,
    typer.Option("--tip-thickness-ratio", "--bluntness", help="Thickness of the cut tips over that of the middle."),
]


@options.example("weavecell mesh S-720 --patch 3x4 --mesh coarse --format vtu,k")
def mesh(
    name: options.FabricArgument,
    size: options.FinenessOption = "medium",
    domain: Annotated[
        Domain | None,
        typer.Option(help="A quarter by symmetry (default), one whole crossover, or a periodic cell of 2 x 2."),
    ] = None,
    patch: Annotated[
        str | None, typer.Option(help="A woven patch of N warp and M weft yarns instead.", metavar="NxM")
    ] = None,
    section: options.SectionOption = None,
    gap: options.GapOption = "0 mm",
    width: Annotated[
        str | None,
        typer.Option(help="Width of both yarns, or of warp and weft; else the fabric's.", metavar="LENGTH[,LENGTH]"),
    ] = None,
    crimp: Annotated[
        str,
        typer.Option(
            help="Crimp: measured by hand, from micrographs, or values for both yarns or warp and weft.",
            metavar="hand|micrograph|CRIMP[,CRIMP]",
        ),
    ] = "hand",
    tip_thickness_ratio: TipOption = 0.075,
    overlap: Annotated[
        Overlap, typer.Option(help="Treatment of sections that overlap by more than a shift removes.")
    ] = Overlap.solve,
    end_shells: Annotated[
        str | None, typer.Option(help="Close the yarn ends with shells of this thickness.", metavar="LENGTH")
    ] = None,
    format: Annotated[
        str, typer.Option(help="Files to write, separated by commas.", metavar="msh|vtu|k|inp|rad,...")
    ] = "msh,vtu",
    out: options.OutOption = None,
) -> None:
    """Mesh a crossover or a woven patch in hexahedra, with a picture of it and one of its quality.

    A gmsh mesh (msh), ParaView (vtu), LS-DYNA (k), Abaqus (inp), OpenRadioss (rad).
    """
    out = out or options.RESULTS / f"mesh-{Path(name).stem}"
    fabric = with_3d_data(name)
    if patch is not None and domain is not None:
        raise InputError(key="--patch", value=patch, allowed="left out where --domain is given")
    count = None if patch is None else options.parse_count(patch)
    chosen = options.mesh_choices(
        size=size, crimp=crimp, width=width, end_shells=end_shells, gap=gap, section=section and section.value,
        tip_thickness_ratio=tip_thickness_ratio, overlap=overlap.value,
    )  # fmt: skip
    formats = _formats(format)
    out_folder.claim(out)
    built = build(fabric, domain=domain.value if domain else "quarter", count=count, **chosen)
    write(built, out, formats, fabric)
    for key, value in facts(built).items():
        print(f"{key:<24}{value}")
    print(f"written to {out}")


def with_3d_data(name: str) -> Fabric:
    """The fabric of this name with what a 3D crossover needs; prints one line where that is assumed.

    Raises
    ------
    InputError : no such fabric, or one without [solid] tables for whose yarns none are assumed
    """
    from meshing.mesh_plan import with_room

    try:
        fabric = with_room(assumed.with_solid_laws(catalogue.load(name)))
    except InputError as problem:
        raise problem if problem.file or problem.key else InputError(str(problem), key="FABRIC", value=name) from None
    for line in (*fabric.notes, *assumed.lines(fabric)):
        print(line)
    return fabric


def build(fabric: Fabric, *, domain: str = "quarter", count: Sequence[int] | None = None, **choices: Any) -> Any:
    """Mesh a quarter or whole crossover, the periodic cell of 2 x 2, or a patch of `count` (n, m) yarns.

    `choices` are those of `meshing.crossover.build`.
    """
    from meshing import crossover, patch

    if domain == "periodic":
        count = PERIODIC
    if count is not None:
        return patch.build(fabric, count, **choices)
    return crossover.build(fabric, domain=domain, **choices)


def write(built: Any, out: Path, formats: Sequence[str] = ("msh", "vtu"), fabric: Fabric | None = None) -> None:
    """Write a mesh and its pictures to the folder `out`; `fabric` is the meshed one."""
    from meshing import pictures, pictures_patch, pictures_quality
    from meshing.formats import export

    stem, draw = ("patch", pictures_patch) if hasattr(built, "count") else ("crossover", pictures)
    with progress.bar(f"Mesh of {built.fabric}") as advance:
        advance(0.2, "writing")
        for suffix in formats:
            export.write(built, out / (f"{stem}_0000.rad" if suffix == "rad" else f"{stem}.{suffix}"))
        advance(0.6, "drawing")
        draw.picture(built, out / f"{stem}.png")
        pictures_quality.picture(built, out / "quality.png")
        json_file.write(
            out / "mesh.json",
            {**facts(built), "provenance": provenance.stamp("", *([fabric] if fabric else []))},
        )


def facts(built: Any) -> dict[str, Any]:
    """The main figures of a mesh, as texts."""
    gap = 1e6 * built.least_gap
    bars = [sum(len(b) for b, f in zip(built.bars, built.families) if f == family) for family in (0, 1)]
    return {
        "fabric": built.fabric,
        "domain": built.domain if not hasattr(built, "count") else "{} warp x {} weft yarns".format(*built.count),
        "hexahedra": f"{len(built.hexes)}",
        "nodes": f"{len(built.points)}",
        "fibre bars": " / ".join(map(str, bars)) + " (warp / weft)",
        "worst scaled Jacobian": f"{built.min_scaled_jacobian:.3f}",
        "sections": f"{built.sections[0].kind}: {built.section_fit.report}",
        "facets of the mesh": f"overlap by up to {-gap:.2f} um" if gap < 0 else f"apart by at least {gap:.2f} um",
    }


def _formats(text):
    chosen = [part.strip().lstrip(".").lower() for part in text.split(",")]
    for part in chosen:
        if part not in FORMATS:
            raise InputError(key="--format", value=part, allowed=f"one or more of {', '.join(FORMATS)}")
    return dict.fromkeys(chosen)
