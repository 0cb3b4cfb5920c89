"""The 3D crossover from the command line: its mesh, and its calibration.

Folder of `weavecell mesh`
    crossover.msh, crossover.vtu, crossover.png
    mesh.json       size, quality, overlap, provenance

Folder of `weavecell calibrate`
    law.json        the fitted law, for `law = ".../law.json"` in a scene
    <path>.h5       histories of the loading paths
    summary.json    the law beside the published one, wall times, provenance
    report.html
"""

from __future__ import annotations

import weavecell
from fabrics import catalogue
from fabrics.errors import InputError
from weavecell import chapters, json_file, progress, provenance, report


def mesh_command(name, out, **choices):
    """Mesh one crossover, write it and print what it is; `choices` are those of `meshing.crossover.build`."""
    built = mesh(_with_3d_data(name), out, **choices)
    for key, value in facts(built).items():
        print(f"{key:<24}{value}")
    print(f"written to {out}")


def calibrate_command(name, out, *, size):
    """Calibrate one fabric, write what came of it and print the law."""
    fabric = _with_3d_data(name)
    built = mesh(fabric, out, size=size, domain="whole")
    done = calibrate(fabric, out, size=size)
    laws = {"fitted": done.law}
    if fabric.laws is not None:
        laws["published"] = fabric.laws[0]
    stamp = provenance.stamp()
    sections = (
        chapters.fit(*samples(done), laws),
        chapters.cell(fabric, {label: (law, law) for label, law in laws.items()}, paths=paths(done, fabric)),
        chapters.mesh(facts(built), (out / "crossover.png").read_bytes()),
        chapters.sources(fabric),
        chapters.making(stamp, done.timings),
    )
    page = report.Report(
        f"{fabric.name}: compression law from the 3D crossover",
        "The crossover is stretched along several biaxial paths; what its yarns lose in thickness is fitted.",
        ((chapters.fabric_card(fabric), chapters.law_card(done.law, laws.get("published"), "fitted")),),
        sections,
        f"weavecell {weavecell.__version__}, {stamp['date']}",
    )
    report.write(page, out / "report.html")
    for label, law in laws.items():
        print(f"{label:<10} a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
    print(f"written to {out}")


def _with_3d_data(name):
    fabric = catalogue.load(name)
    if fabric.solids is None:
        raise InputError(
            "the fabric has no [solid] tables, without which its crossover has no 3D model", key="FABRIC", value=name
        )
    return fabric


def mesh(fabric, out, **choices):
    """Mesh one crossover and write it to the folder `out`; returns the `meshing.crossover.Crossover`."""
    from meshing import crossover, export, pictures

    with progress.bar(f"Mesh of {fabric.name}") as advance:
        built = crossover.build(fabric, **choices)
        advance(0.4, "writing")
        for suffix in ("msh", "vtu"):
            export.write(built, out / f"crossover.{suffix}")
        advance(0.6, "drawing")
        pictures.picture(built, out / "crossover.png")
        json_file.write(out / "mesh.json", facts(built) | {"provenance": provenance.stamp()})
    return built


def calibrate(fabric, out, *, size):
    """Solve the crossover, fit its law and write both to the folder `out`; returns the Calibration."""
    from unitcell3d.calibrate import calibrate as solve

    with progress.bar(f"Calibration of {fabric.name}") as advance:
        done = solve(fabric, size=size, progress=advance)
    done.law.to_json(out / "law.json")
    for name, history in {**done.histories, "plates": done.plates}.items():
        history.write(out / f"{name}.h5")
    json_file.write(
        out / "summary.json",
        {
            "fabric": fabric.name,
            "size": size,
            "a [m]": done.law.a,
            "b [m N^(1/3)]": done.law.b,
            "residual_rms [m]": done.law.residual_rms,
            "published": [{"a [m]": law.a, "b [m N^(1/3)]": law.b} for law in fabric.laws or ()],
            "wall_times [s]": done.timings,
            "provenance": provenance.stamp(),
        },
    )
    return done


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


def samples(done):
    """({path: (F, d_c)}, (F, d_c) between plates) [N, m] of a Calibration."""
    plates = done.plates
    return {name: (path.F_c, path.d_c) for name, path in done.histories.items()}, (plates.F_c, plates.d_c)


def paths(done, fabric):
    """{path: (strain1, strain2, T1, T2)} [-, N] of a Calibration: end displacements over half cell lengths."""
    w1, w2 = fabric.weave.w
    return {name: (path.d1 / w1, path.d2 / w2, path.T1, path.T2) for name, path in done.histories.items()}
