"""The mesh of a crossover or a woven patch from the command line.

Folder of `weavecell mesh`
    crossover.msh, crossover.vtu    or patch.*; the formats requested (OpenRadioss: crossover_0000.rad)
    crossover.png, quality.png      the mesh, and the scaled Jacobian of its elements
    mesh.json                       size, quality, overlap, provenance
"""

from __future__ import annotations

import re

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from fabrics.units import si
from weavecell.results import json_file, progress, provenance

FORMATS = ("msh", "vtu", "k", "inp", "rad")
SIZES = ("coarse", "medium", "fine", "auto")
PERIODIC = (2, 2)  # yarns of the periodic cell
PAIR = "one value, or two separated by a comma, of warp and weft"


def mesh_command(name, out, *, domain, patch, formats, size, crimp, width, end_shells, gap, **choices):
    """Mesh what is requested in texts, write it and print what it is."""
    fabric = with_3d_data(name)
    if patch is not None and domain is not None:
        raise InputError(key="--patch", value=patch, allowed="left out where --domain is given")
    built = build(
        fabric,
        domain=domain or "quarter",
        count=None if patch is None else _count(patch),
        size=size_of(size),
        crimp=crimp if crimp in ("hand", "micrograph") else _pair(crimp, "", "--crimp"),
        width=None if width is None else _pair(width, "m", "--width"),
        gap=si(gap, "m", key="--yarn-gap"),
        end_shells=None if end_shells is None else si(end_shells, "m", key="--end-shells"),
        **choices,
    )
    write(built, out, _formats(formats), fabric)
    for key, value in facts(built).items():
        print(f"{key:<24}{value}")
    print(f"written to {out}")


def with_3d_data(name):
    """The fabric of this name with what a 3D crossover needs; prints one line where that is assumed.

    Raises
    ------
    InputError : no such fabric, or one without [solid] tables for whose yarns none are assumed
    """
    try:
        fabric = assumed.with_solid_laws(catalogue.load(name))
    except InputError as problem:
        raise problem if problem.file or problem.key else InputError(str(problem), key="FABRIC", value=name) from None
    for line in assumed.lines(fabric):
        print(line)
    return fabric


def build(fabric, *, domain="quarter", count=None, **choices):
    """Mesh a quarter or whole crossover, the periodic cell of 2 x 2, or a patch of `count` (n, m) yarns.

    `choices` are those of `meshing.crossover.build`.
    """
    from meshing import crossover, patch

    if domain == "periodic":
        count = PERIODIC
    if count is not None:
        return patch.build(fabric, count, **choices)
    return crossover.build(fabric, domain=domain, **choices)


def write(built, out, formats=("msh", "vtu"), fabric=None):
    """Write a mesh and its pictures to the folder `out`; `fabric` is the meshed one, for the record."""
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
        json_file.write(out / "mesh.json", facts(built) | {"provenance": provenance.stamp(fabric=fabric)})


def facts(built):
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


def _count(text):
    found = re.fullmatch(r"\s*(\d+)\s*[xX×]\s*(\d+)\s*", text)
    if found is None:
        raise InputError(key="--patch", value=text, allowed="numbers of warp and weft yarns, such as 3x4")
    return int(found[1]), int(found[2])


def size_of(text):
    """A name, three numbers, or an edge length [m], as `meshing.inputs.size` takes it."""
    if re.fullmatch(r"\s*\d+\s*(,\s*\d+\s*)*", text):
        return tuple(map(int, text.split(",")))
    if text in SIZES:
        return text
    if re.fullmatch(r"\s*[\d.+-][^,]*", text):
        return si(text, "m", key="--mesh")
    raise InputError(key="--mesh", value=text, allowed=f"{', '.join(SIZES)}, nx,ny,nz or a length such as 60um")


def _pair(text, unit, key):
    """(warp, weft) [SI] of one value or of two."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) > 2:
        raise InputError(key=key, value=text, allowed=PAIR)
    values = [si(part, unit, key=key) for part in parts]
    return values[0], values[-1]


def _formats(text):
    chosen = [part.strip().lstrip(".").lower() for part in text.split(",")]
    for part in chosen:
        if part not in FORMATS:
            raise InputError(key="--format", value=part, allowed=f"one or more of {', '.join(FORMATS)}")
    return dict.fromkeys(chosen)
