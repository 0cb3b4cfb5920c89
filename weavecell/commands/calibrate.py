"""The calibration of the 3D crossover from the command line.

Folder of `weavecell calibrate`
    solid.json          with --platen-curve or --fit-solid: E_c, V_c, K_r and what the plate curve determines
    law-interval.json   with the same: intervals of a and b that follow from those of E_c, V_c, K_r
    law.json            the fitted law, for `law` in an input file, and the contact law of plies of a pack
    calibration.json    all numbers of the calibration, and provenance.json where they come from
    <path>.h5           histories of the loading paths and of the compression between plates
    crossover.*         the mesh, as `weavecell.commands.mesh` writes it, with quality.png and mesh.json
    report.html
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import assumed, checks
from weavecell.commands import calibrate_solid, mesh, options
from weavecell.report import chapters
from weavecell.report import page as report_page
from weavecell.results import json_file, out_folder, progress, provenance

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from unitcell3d.identify.calibration import Calibration
    from unitcell3d.identify.solid_record import SolidFit
    from unitcell3d.solver.history import History


PlatenCurveOption = Annotated[
    Path | None,
    typer.Option(
        "--platen-curve",
        help="First fit E_c, V_c and K_r to this platen curve (pressure and thickness).",
        metavar="CURVE.csv",
    ),
]


@options.example("weavecell calibrate S-720 --mesh coarse")
def calibrate(
    name: options.FabricArgument,
    size: options.MeshOption = options.Size.medium,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    plates: PlatenCurveOption = None,
    fit_solid: Annotated[
        bool,
        typer.Option(
            "--fit-solid", help="First fit E_c, V_c and K_r to the built-in pressure law of Kevlar plain weaves."
        ),
    ] = False,
    friction: options.FrictionOption = 0.0,
    out: options.OutOption = None,
    resume: options.ResumeOption = False,
) -> None:
    """Solve the 3D crossover and fit its compression law: law.json, histories and a report.

    The curve of --platen-curve is a CSV file headed, for example, "pressure \\[MPa], thickness \\[mm]": one ply between
    flat platens, loading only, at least five rows. A finished path is kept at once, for --resume.
    """
    out = out or options.RESULTS / f"calibrate-{Path(name).stem}"
    choices: dict[str, Any] = {"size": size.value, "friction": friction, "jobs": jobs, "executor": executor}
    fabric = mesh.with_3d_data(name)
    solid = None
    curve = calibrate_solid.curve_for(fabric, plates) if plates is not None or fit_solid else None
    out_folder.claim(out, resume)
    if curve is not None:
        solid = calibrate_solid.fit(fabric, curve, out, resume=resume)
        fabric = assumed.given(solid.fabric, "solid")
    built = mesh.build(fabric, size=size.value, domain="whole")
    mesh.write(built, out, fabric=fabric)
    done = assumed_range(fabric, solved(fabric, out, resume=resume, **choices), out, **choices)
    tell(done)
    around: dict[str, Any] = {}
    if solid is not None:
        beside = {key: choices[key] for key in ("friction", "jobs", "executor")}
        _, around = calibrate_solid.law_interval(solid, done.law, out, **beside)
    write_page(fabric, done, solid, around, built, out)
    print(f"written to {out}")


def write_page(fabric: Fabric, done: Calibration, solid: SolidFit | None, around: Any, built: Any, out: Path) -> None:
    """Write the report of a calibration."""
    laws = {"fitted": done.law}
    if done.published is not None:
        laws["published"] = done.published
    stamp = provenance.stamp("", fabric)
    json_file.write(out / "provenance.json", stamp)
    sections = (
        fit_chapter(done, laws),
        *([] if solid is None else [calibrate_solid.chapter(solid, around)]),
        chapters.cell(fabric, {label: (law, law) for label, law in laws.items()}, paths=paths(done, fabric)),
        chapters.mesh(mesh.facts(built), (out / "crossover.png").read_bytes()),
        chapters.sources(fabric),
        chapters.making(stamp, done.seconds),
    )
    content = report_page.Report(
        f"{fabric.name}: compression law from the 3D crossover",
        "The crossover is stretched along several biaxial paths until its fibres fail; one law is fitted to the "
        "thickness that its yarns lose under their contact force."
        + (f" Coulomb friction between the yarns: {done.friction:g}." if done.friction else ""),
        ((chapters.fabric_card(fabric), chapters.law_card(done.law, done.published, "fitted to the 3D crossover")),),
        sections,
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
    report_page.write(content, out / "report.html")


def tell(done: Calibration) -> None:
    """Print the law of a Calibration: intervals, published values, residual, spread between paths, the law chosen."""
    law = done.law
    if done.friction:
        print(f"{'friction':<12}{done.friction:g}")
    a, b = (f"{1e3 * value:.4f}" for value in (law.a, law.b))
    print(f"{'fitted':<12}a = {a} mm ({_mm(law.a_interval)}), b = {b} mm N^(1/3) ({_mm(law.b_interval)}), 95 %")
    if done.published is not None:
        print(f"{'published':<12}a = {1e3 * done.published.a:.4f} mm, b = {1e3 * done.published.b:.4f} mm N^(1/3)")
    print(
        f"{'residual':<12}{1e6 * law.residual_rms:.2f} um rms over "  # type: ignore[operator]
        f"F = {law.F_range[0]:.2g} to {law.F_range[1]:.3g} N"  # type: ignore[index]
    )
    if done.spread:
        print(f"{'each path':<12}a = {_mm(done.spread['a'])} mm, b = {_mm(done.spread['b'])} mm N^(1/3)")
    for name, own in zip(("warp", "weft"), done.yarn_laws):
        if own is not None:
            print(f"{name + ' alone':<12}a = {1e3 * own.a:.4f} mm, b = {1e3 * own.b:.4f} mm N^(1/3)")
    if done.ratio_law is not None:
        print(
            f"{'alternative':<12}compliance that depends on the ratio of warp and weft tension: "
            f"{1e6 * done.ratio_law.residual_rms:.2f} um rms"  # type: ignore[operator]
        )
    better = "" if done.chosen == "one law" else ", although the alternative fits the paths better"
    print(f"{'impacts use':<12}the fitted law{better}")
    for end, (low, high) in zip(("soft", "stiff"), law.assumed_range or ()):
        print(f"{end + ' end':<12}a = {1e3 * low:.4f} mm, b = {1e3 * high:.4f} mm N^(1/3), of the assumed solid law")
    for line in law.outside_ends():
        print(f"{'note':<12}{line}")
    if done.contact is not None:
        print(f"{'plies':<12}{done.contact.words()}")
    for name, history in done.histories.items():
        if history.failed:
            print(f"{name:<12}ended at {100 * history.path[-1]:.1f} % of its path: {history.failed}")


def _mm(pair):
    return " .. ".join(f"{1e3 * value:.4f}" for value in pair)


def solved(
    fabric: Fabric, out: Path, *, size: str, jobs: int, executor: str, friction: float = 0.0, resume: bool = False
) -> Calibration:
    """Solve the crossover, fit its law and write both to the folder `out`; returns the Calibration."""
    from unitcell3d.identify import calibrate as solver

    with progress.bar(f"Calibration of {fabric.name}") as advance:
        on_progress = progress.by_path(advance, solver.CASES)
        return solver.calibrate(
            fabric,
            size=size,
            friction=friction,
            out=out,
            on_progress=on_progress,
            jobs=jobs,
            executor=executor,
            resume=resume,
        )


def assumed_range(fabric: Fabric, done: Calibration, out: Path, **choices: Any) -> Calibration:
    """The Calibration with the range of its law over an assumed solid law, law.json written again; else as it is."""
    if "solid" not in fabric.assumed:
        return done
    from unitcell3d.identify import assumed_range as solver
    from unitcell3d.identify.calibrate import CASES

    with progress.bar(f"Assumed solid law of {fabric.name}, soft and stiff end") as advance:
        done, failed = solver.with_assumed_range(
            fabric, done, on_progress=progress.by_path(advance, 2 * CASES), **choices
        )
    for end, why in failed.items():
        print(f"{'no range':<12}the {end} end of the assumed solid law has no compression law: {why}")
    done.write_law(out / "law.json")
    return done


def fit_chapter(done: Calibration, laws: Any) -> report_page.Section:
    """The chapter of a Calibration: its samples and laws, each path alone, and fibre failure."""
    from unitcell3d.identify.calibration import samples

    biaxial = {name: samples(history) for name, history in stretched(done).items()}
    chapter = chapters.fit(biaxial, laws, (done.plates.F_c, done.plates.d_c))
    columns = ("path", "a [mm]", "b [mm N^(1/3)]", "rms from the joint law [µm]", "ended", "wall time [s]")
    rows = tuple(
        (
            name,
            *_parameters(done.path_laws.get(name)),
            "-" if name not in done.residuals else f"{1e6 * done.residuals[name]:.2f}",
            ended(name, history),
            f"{done.seconds[name]:.1f}",
        )
        for name, history in done.histories.items()
    )
    alone = report_page.Table(columns, rows, "Each path", numeric=(*columns[1:4], columns[5]))
    heads = ("path", "criterion", "yarn", "d1 [µm]", "d2 [µm]", "T1 [N]", "T2 [N]", "F_c [N]")
    found_failures = tuple(
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
    failure = report_page.Table(
        heads, found_failures, "Where the fibre strain first reaches the failure strain", numeric=heads[3:]
    )
    lead = " ".join([chapter.lead, *(f"Note: {line}." for line in done.law.outside_ends())])
    return replace(chapter, lead=lead, tables=(*chapter.tables, _laws(done), alone, failure))


def ended(name: str, history: History) -> str:
    """Why a path ended."""
    if history.failed:
        return history.failed
    if name != "plates":
        from unitcell3d.identify.calibrate import BEYOND, BOTH

        return f"at {BEYOND:g} times the failure strain" if name == BOTH else "at fibre failure"
    return "at the test's pressure" if history.path[-1] < 1 else "with the plates at half their distance"


def _laws(done):
    """The joint law with its intervals and the spread between paths, and what it leaves out."""
    columns = ("law", "a [mm]", "b [mm N^(1/3)]", "rms [µm]")
    law, ratio = done.law, done.ratio_law
    rows = [("joint", *_parameters(law), _um(law.residual_rms))]
    rows.append(("joint, 95 % intervals", _mm(law.a_interval), _mm(law.b_interval), ""))
    if done.spread:
        rows.append(("spread of the paths alone", _mm(done.spread["a"]), _mm(done.spread["b"]), ""))
    for end, (a, b) in zip(("soft", "stiff"), law.assumed_range or ()):
        rows.append((f"{end} end of the assumed solid law", f"{1e3 * a:.4f}", f"{1e3 * b:.4f}", ""))
    for name, own in zip(("warp", "weft"), done.yarn_laws):
        if own is not None:
            rows.append((f"{name}, its own compression", *_parameters(own), _um(own.residual_rms)))
    if ratio is not None:
        c = " .. ".join(f"{1e6 * ratio.compliance(m):.3f}" for m in ratio.m_range)
        name = f"c F / (1 + F / {ratio.F0:.3g} N), c = {c} µm/N, all weft .. all warp"
        rows.append((name, "-", "-", _um(ratio.residual_rms)))
    return report_page.Table(columns, tuple(rows), "Fitted laws; impacts use the joint one", numeric=columns[1:])


def _um(value):
    return f"{1e6 * value:.2f}"


def _parameters(law):
    return ("-", "-") if law is None else (f"{1e3 * law.a:.4f}", f"{1e3 * law.b:.4f}")


def stretched(done: Calibration) -> dict[str, History]:
    """{path: History} of a Calibration without the plates."""
    return {name: history for name, history in done.histories.items() if history is not done.plates}


def paths(done: Calibration, fabric: Fabric) -> dict[str, tuple[checks.FloatArray, ...]]:
    """{path: (strain1, strain2, T1, T2)} [-, N] of a Calibration: end displacements over half cell lengths."""
    w1, w2 = fabric.weave.w
    return {name: (path.d1 / w1, path.d2 / w2, path.T1, path.T2) for name, path in stretched(done).items()}
