"""The calibration of the 3D crossover from the command line.

Folder of `weavecell calibrate`
    solid.json          with --plates or --fit-solid: E_c, V_c, K_r and what the plate curve determines
    law.json            the fitted law, for `law = ".../law.json"` in a scene
    calibration.json    all numbers of the calibration, and provenance.json where they come from
    <path>.h5           histories of the loading paths and of the compression between plates
    crossover.*         the mesh, as `weavecell.mesh` writes it, with quality.png and mesh.json
    report.html
"""

from __future__ import annotations

from dataclasses import replace

import weavecell
from weavecell import chapters, json_file, mesh, progress, provenance, report, solid_fit
from weavecell.mesh import with_3d_data
from weavecell.report import Table


def calibrate_command(name, out, *, size, processes, plates=None, fit_solid=False):
    """Calibrate one fabric, its solid first if asked, write what came of it and print the law."""
    fabric = with_3d_data(name)
    solid = None
    if plates is not None or fit_solid:
        solid = solid_fit.fit(fabric, solid_fit.curve_for(fabric, plates), out)
        fabric = solid.fabric
    built = mesh.build(fabric, size=size, domain="whole")
    mesh.write(built, out)
    done = calibrate(fabric, out, size=size, processes=processes)
    laws = {"fitted": done.law}
    if done.published is not None:
        laws["published"] = done.published
    stamp = provenance.stamp()
    json_file.write(out / "provenance.json", stamp)
    sections = (
        fit_chapter(done, laws),
        *([] if solid is None else [solid_fit.chapter(solid)]),
        chapters.cell(fabric, {label: (law, law) for label, law in laws.items()}, paths=paths(done, fabric)),
        chapters.mesh(mesh.facts(built), (out / "crossover.png").read_bytes()),
        chapters.sources(fabric),
        chapters.making(stamp, done.seconds),
    )
    page = report.Report(
        f"{fabric.name}: compression law from the 3D crossover",
        "The crossover is stretched along several biaxial paths until its fibres fail; one law is fitted to the "
        "thickness that its yarns lose under their contact force.",
        ((chapters.fabric_card(fabric), chapters.law_card(done.law, done.published, "fitted to the 3D crossover")),),
        sections,
        f"weavecell {weavecell.__version__}, {stamp['date']}",
    )
    report.write(page, out / "report.html")
    for label, law in laws.items():
        print(f"{label:<10} a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
    print(f"residual   {1e6 * done.law.residual_rms:.2f} um rms over F = {_span(done.law.F_range)} N")
    print(f"written to {out}")


def _span(pair):
    return f"{pair[0]:.2g} to {pair[1]:.3g}"


def calibrate(fabric, out, *, size, processes):
    """Solve the crossover, fit its law and write both to the folder `out`; returns the Calibration."""
    from unitcell3d import calibrate as solver

    shares = {}
    with progress.bar(f"Calibration of {fabric.name}") as advance:

        def report_path(path, share):
            shares[path] = share
            told = ", ".join(f"{name} {100 * done:.0f} %" for name, done in shares.items() if done < 1)
            advance(sum(shares.values()) / (len(solver.PATHS) + 1), told)

        return solver.calibrate(fabric, size=size, out=out, progress=report_path, processes=processes)


def fit_chapter(done, laws):
    """The chapter of a Calibration: its samples and laws, each path alone, and fibre failure."""
    from unitcell3d.calibrate import samples

    biaxial = {name: samples(history) for name, history in stretched(done).items()}
    chapter = chapters.fit(biaxial, laws, (done.plates.F_c, done.plates.d_c))
    columns = ("path", "a [mm]", "b [mm N^(1/3)]", "rms from the joint law [µm]", "ended", "wall time [s]")
    rows = tuple(
        (
            name,
            *_parameters(done.path_laws.get(name)),
            "-" if name not in done.residuals else f"{1e6 * done.residuals[name]:.2f}",
            history.failed or ("at the test's pressure" if name == "plates" else "at fibre failure"),
            f"{done.seconds[name]:.1f}",
        )
        for name, history in done.histories.items()
    )
    alone = Table(columns, rows, "Each path", numeric=(*columns[1:4], columns[5]))
    columns = ("path", "criterion", "yarn", "d1 [µm]", "d2 [µm]", "T1 [N]", "T2 [N]", "F_c [N]")
    rows = tuple(
        (
            name,
            item.criterion,
            ("warp", "weft")[item.yarn],
            *(f"{1e6 * value:.2f}" for value in item.d),
            *(f"{value:.1f}" for value in (*item.T, item.F_c)),
        )
        for name, found in done.failures.items()
        for item in found
    )
    failure = Table(columns, rows, "Where the fibre strain first reaches the failure strain", numeric=columns[3:])
    return replace(chapter, tables=(*chapter.tables, alone, failure))


def _parameters(law):
    return ("-", "-") if law is None else (f"{1e3 * law.a:.4f}", f"{1e3 * law.b:.4f}")


def stretched(done):
    """{path: History} of a Calibration without the plates."""
    return {name: history for name, history in done.histories.items() if history is not done.plates}


def paths(done, fabric):
    """{path: (strain1, strain2, T1, T2)} [-, N] of a Calibration: end displacements over half cell lengths."""
    w1, w2 = fabric.weave.w
    return {name: (path.d1 / w1, path.d2 / w2, path.T1, path.T2) for name, path in stretched(done).items()}
