"""The 3D crossover from the command line: its mesh, and its calibration.

Folder of `weavecell mesh`         crossover.msh, crossover.vtu, crossover.png, mesh.json (quality, overlap, provenance)
"""

from __future__ import annotations

from fabrics import catalogue
from weavecell import json_file, progress, provenance


def mesh(name, out, **choices):
    """Mesh one crossover and write it; `choices` are those of `meshing.crossover.build`."""
    fabric = catalogue.load(name)
    with progress.bar(f"Mesh of {fabric.name}") as advance:
        built = build(fabric, **choices)
        advance(0.4, "writing")
        write_mesh(built, out)
        advance(0.6, "drawing")
        picture(built, out / "crossover.png")
        json_file.write(out / "mesh.json", facts(built) | {"provenance": provenance.stamp()})
    for key, value in facts(built).items():
        print(f"{key:<24}{value}")
    print(f"written to {out}")


def build(fabric, **choices):
    """The mesh of a crossover."""
    from meshing import crossover

    return crossover.build(fabric, **choices)


def write_mesh(built, out):
    """Write the mesh as .msh and .vtu."""
    from meshing import export

    for suffix in ("msh", "vtu"):
        export.write(built, out / f"crossover.{suffix}")


def picture(built, path):
    """Write a picture of the mesh."""
    from meshing import pictures

    pictures.picture(built, path)


def facts(built):
    """What a user asks about a mesh first, as texts."""
    return {
        "fabric": built.fabric,
        "domain": built.domain,
        "hexahedra": f"{len(built.hexes)}",
        "nodes": f"{len(built.points)}",
        "fibre bars": " / ".join(str(len(bars)) for bars in built.bars) + " (warp / weft)",
        "worst scaled Jacobian": f"{built.min_scaled_jacobian:.3f}",
        "sections": built.closing.report,
    }
