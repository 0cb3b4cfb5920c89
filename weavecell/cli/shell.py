"""`weavecell impact`, `biaxial`, `coupon` and `critical-velocity`: their options, for the modules of these names."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError
from weavecell.cli.options import (
    CORES,
    RESULTS,
    ExecutorOption,
    FabricArgument,
    JobsOption,
    OutOption,
    ResumeOption,
    SeedOption,
    Size,
    StrictOption,
    TargetArgument,
    WeibullOption,
    refuse_others,
)

IMPACT = "Example: [bold]weavecell impact examples/S-720-stops.toml[/bold]"
BIAXIAL = "Example: [bold]weavecell biaxial S-720 --ratio 1:1 --ratio 2:1 --compare-3d coarse[/bold]"
COUPON = "Example: [bold]weavecell coupon examples/coupons/S-728-bias.toml[/bold]"
COMPARE = "Example: [bold]weavecell compare tests.csv examples/S-728-pack.toml[/bold]"
CRITICAL_VELOCITY = "Example: [bold]weavecell critical-velocity S-720 --tolerance '1 m/s'[/bold]"


_OF_DRAWS = ("draws", "shape", "seed", "jobs", "executor")
AssumedRangeOption = Annotated[
    bool,
    typer.Option(
        "--assumed-range/--no-assumed-range",
        help="Where a law of the fabric is assumed: repeat the run with both ends of its range.",
    ),
]


class Profile(StrEnum):
    """Profiles of the yarns of the shell's cell."""

    cosine = "cosine"
    straight = "straight"


def impact(
    context: typer.Context,
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (*.toml).")],
    out: OutOption = None,
    resume: ResumeOption = False,
    strict: StrictOption = False,
    assumed_range: AssumedRangeOption = True,
    explain: Annotated[
        bool, typer.Option("--explain", help="Run nothing: show the models that would do for the scene's \\[accuracy].")
    ] = False,
    uncertainty: Annotated[
        bool,
        typer.Option(
            "--uncertainty", help="Run a finer mesh too, and report the discretisation uncertainty of each result."
        ),
    ] = False,
    draws: Annotated[
        int | None,
        typer.Option(
            min=2, metavar="N", help="Shoot at N panels whose yarns differ in strength (Weibull), and report the mean."
        ),
    ] = None,
    shape: WeibullOption = None,
    seed: SeedOption = 1,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
) -> None:
    """Fire the projectile of a scene at its panel: histories, ParaView series, pictures and a report.

    The folder then holds report.html, summary.json, histories.h5, panel.pvd with panel/*.vtu, pictures/ and scene.toml;
    while the run goes on, checkpoint.h5. A scene with a table \\[accuracy] says how well it wants to know something:
    the cheapest model that will do is chosen and checked. A key of the scene that cannot be honoured is rejected.

    --draws N computes the whole panel N times, each yarn of each ply with a strength of its own, and writes mean,
    scatter and probability of perforation: summary.json, summary.html, draws.csv and runs/, from which --resume goes
    on, also to more draws. --weibull-shape, --seed, --jobs and --executor are of --draws alone. It ignores
    panel.symmetry, --explain ignores title, and both ignore run.snapshot_interval, run.checkpoint_interval,
    run.outputs, history.interval, history.warp, history.weft and history.report_positions.
    """
    from weavecell.commands import fidelity
    from weavecell.commands import impact as commands_impact

    if explain:
        refuse_others(context, ("scene", "explain"), "with --explain, which runs and writes nothing")
        fidelity.explain(scene)
        return

    if draws is not None:
        from weavecell.commands import uncertainty as scatter

        refuse_others(context, ("scene", "out", "resume", *_OF_DRAWS), "with --draws")
        folder = out or RESULTS / f"{scene.stem}-draws"
        scatter.draws(scene, folder, count=draws, shape=shape, seed=seed, jobs=jobs, executor=executor, resume=resume)
        return
    refuse_others(context, set(context.params) - set(_OF_DRAWS), "without --draws")
    folder = out or RESULTS / scene.stem
    commands_impact.impact(
        scene, folder, resume=resume, strict=strict, with_range=assumed_range, uncertainty=uncertainty
    )


def biaxial(
    fabric: FabricArgument,
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
    out: OutOption = None,
) -> None:
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen: `weavecell coupon`.
    """
    from weavecell.commands import biaxial as module

    module.biaxial_command(
        fabric,
        out or RESULTS / f"biaxial-{Path(fabric).stem}",
        ratios=ratio or ("1:1", "1:0", "0:1"),
        size=crossover and crossover.value,
        profile=profile.value,
        toe=module.toes(toe),
    )


def coupon(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="The scene file of a coupon (*.toml).")],
    out: OutOption = None,
    resume: ResumeOption = False,
    strict: StrictOption = False,
) -> None:
    """Test a piece of fabric quasi-statically: bias extension, picture frame, uniaxial or biaxial tension.

    The folder then holds report.html, summary.json, histories.h5, pictures/ and scene.toml; while the run goes on,
    checkpoint.h5.
    """
    from weavecell.commands import coupon as module

    module.coupon(scene, out or RESULTS / scene.stem, resume=resume, strict=strict)


def compare(
    tests: Annotated[Path, typer.Argument(metavar="TESTS", help="Table of tests (*.csv): a row a shot.")],
    target: TargetArgument,
    tolerance: Annotated[
        str, typer.Option(help="Highest stop and lowest perforation differ by this at most.", metavar="VELOCITY")
    ] = "1 m/s",
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    out: OutOption = None,
) -> None:
    r"""Put the shots of a laboratory beside the computed ones: V50 and residual velocities, with intervals.

    TESTS has a row a shot, and the columns velocity, outcome (PP or CP, or stopped or perforated) and, where it was
    measured, residual velocity, each speed with its unit in the heading: "velocity \[m/s]". The shots are fired at the
    target at these velocities, and its critical velocity is found, on the mesh of the scene.

    Of a scene these keys are ignored: title, projectile.strike_velocity, run.end_time, run.snapshot_interval,
    run.checkpoint_interval, run.outputs. \[history] and \[accuracy] are rejected.

    The folder then holds comparison.json, shots.csv, comparison.svg and scene.toml.
    """
    from fabrics.units import si
    from weavecell.commands import compare as command

    width = si(tolerance, "m/s", key="--tolerance")
    if not width > 0:
        raise InputError(key="--tolerance", value=tolerance, allowed="above 0")
    command.compare(
        tests, target, out or RESULTS / f"compare-{Path(target).stem}", tolerance=width, jobs=jobs, executor=executor
    )


def critical_velocity(
    target: TargetArgument,
    tolerance: Annotated[
        str, typer.Option(help="Highest stop and lowest perforation differ by this at most.", metavar="VELOCITY")
    ] = "1 m/s",
    curve: Annotated[
        int, typer.Option("--residual-shots", min=0, max=100, help="Shots above the limit, for residual velocities.")
    ] = 8,
    scan_above: Annotated[
        str, typer.Option(help="Range above the highest stop that is scanned for further stops.", metavar="SHARE")
    ] = "25 %",
    scan_below: Annotated[
        str, typer.Option(help="Range below the lowest perforation that is scanned for others.", metavar="SHARE")
    ] = "10 %",
    scan_step: Annotated[str, typer.Option(help="Interval between shots of the scan.", metavar="SHARE")] = "2 %",
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    strict: StrictOption = False,
    assumed_range: AssumedRangeOption = True,
    out: OutOption = None,
) -> None:
    """Bisect for the velocity between stop and perforation, and fit residual velocities (Lambert-Jonas).

    Further shots scan the velocities about the bracket. If one stops that is faster than one that perforates, no single
    critical velocity exists: the zone of mixed outcomes is reported, and the result is doubtful (exit code 3 with
    --strict). --scan-above "0 %" --scan-below "0 %" leave the scan out.

    A fabric is shot at as in the tests of the thesis. Of a scene these keys are ignored: title,
    projectile.strike_velocity, run.end_time, run.snapshot_interval, run.checkpoint_interval, run.outputs.
    \\[history] and \\[accuracy] are rejected.

    The folder then holds critical-velocity.json, shots.csv, residual-velocity.svg and scene.toml.
    """
    from fabrics.units import si
    from shellfabric.impact.limit_scan import ScanRange
    from weavecell.commands import critical_velocity as command

    width = si(tolerance, "m/s", key="--tolerance")
    if not width > 0:
        raise InputError(key="--tolerance", value=tolerance, allowed="above 0")
    given = {"above": scan_above, "below": scan_below, "step": scan_step}
    try:
        scan = ScanRange(**{name: si(text, "", key=f"--scan-{name}") for name, text in given.items()})
    except InputError as problem:
        if problem.key in given:
            raise InputError(key=f"--scan-{problem.key}", value=given[problem.key], allowed=problem.allowed) from None
        raise
    command.critical_velocity(
        target,
        out or RESULTS / f"critical-velocity-{Path(target).stem}",
        tolerance=width,
        curve=curve,
        jobs=jobs,
        executor=executor,
        scan=scan,
        strict=strict,
        with_range=assumed_range,
    )
