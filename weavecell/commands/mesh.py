"""The mesh of a crossover or a woven patch from the command line.

Folder of `weavecell mesh`
    crossover.msh, crossover.vtu    or patch.*; the formats requested (OpenRadioss: crossover_0000.rad)
    crossover.png, quality.png      the mesh, and the scaled Jacobian of its elements
    mesh.json                       size, quality, overlap, provenance; with --texgen section and path against TexGen's
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from weavecell.commands import mesh_options
from weavecell.commands.fabrics import print_table
from weavecell.results import json_file, progress, provenance

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

FORMATS = ("msh", "vtu", "k", "inp", "rad")
PERIODIC = (2, 2)  # yarns of the periodic cell
_COMPARED = {
    "section_area_m2": ("section area, mm²", 1e6), "section_width_m": ("section width, mm", 1e3),
    "section_height_m": ("section height, mm", 1e3),
    "section_shape_deviation": ("area in one section alone, over TexGen's", 1),
    "path_amplitude_m": ("path amplitude, mm", 1e3), "crimp": ("crimp, %", 100),
    "path_rms_over_thickness": ("path, rms distance over yarn height", 1),
}  # fmt: skip


def mesh_command(
    name: str, out: Path, *, domain: str | None, patch: str | None, formats: Sequence[str],
    texgen: Path | None = None, **options: Any,
) -> None:  # fmt: skip
    """Mesh a fabric, write the mesh and print what it is; `options` are texts, as of `mesh_options.parse`.

    texgen : file whose yarns the mesh is held against, or None
    """
    from meshing.texgen import comparison
    from meshing.texgen.geometry import WeaveGeometry

    drawn = None if texgen is None else WeaveGeometry.read(texgen)
    fabric = with_3d_data(name)
    if patch is not None and domain is not None:
        raise InputError(key="--patch", value=patch, allowed="left out where --domain is given")
    count = None if patch is None else mesh_options.parse_count(patch)
    built = build(fabric, domain=domain or "quarter", count=count, **mesh_options.parse(**options))
    compared = {} if drawn is None else {"texgen": {"file": drawn.name, **comparison.compare(drawn, built)}}
    write(built, out, _formats(formats), fabric, compared)
    for key, value in facts(built).items():
        print(f"{key:<24}{value}")
    if compared:
        tell(compared["texgen"])
    print(f"written to {out}")


def tell(compared: Mapping[str, Any]) -> None:
    """Print what `meshing.texgen.comparison.compare` has found."""
    rows = []
    for family in ("warp", "weft"):
        for key, (words, factor) in _COMPARED.items():
            found = compared[family][key]
            pair = [f"{factor * found[one]:.4g}" for one in ("texgen", "mesh")] if isinstance(found, dict) else ["", ""]
            off = f"{found['deviation']:+.2%}" if isinstance(found, dict) else f"{found:.2%}"
            rows.append([f"{family}, {words}", *pair, off])
    print_table(f"Sections and paths against {compared['file']}", ["", "TexGen", "mesh", "deviation"], rows)


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


def write(
    built: Any, out: Path, formats: Sequence[str] = ("msh", "vtu"), fabric: Fabric | None = None,
    more: Mapping[str, Any] | None = None,
) -> None:  # fmt: skip
    """Write a mesh and its pictures to the folder `out`; `fabric` is the meshed one, and `more` goes into mesh.json."""
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
            {**facts(built), **(more or {}), "provenance": provenance.stamp("", *([fabric] if fabric else []))},
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
