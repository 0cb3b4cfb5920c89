"""`weavecell sensitivity`, `v50` and `sweep`: their options, as texts and numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError
from weavecell.cli.options import (
    CORES,
    RESULTS,
    ExecutorOption,
    JobsOption,
    OutOption,
    ResumeOption,
    SeedOption,
    TargetArgument,
    WeibullOption,
)

SENSITIVITY = "Example: [bold]weavecell sensitivity S-720 --samples 64[/bold]"
SWEEP = "Example: [bold]weavecell sweep pack.toml --over panel.plies=2,4,8 --quantity critical-velocity[/bold]"
V50 = "Example: [bold]weavecell v50 S-720 --shots 200 --weibull-shape 14.3[/bold]"


OpeningOption = Annotated[
    str | None,
    typer.Option(help="Side of a fabric's square panel, 203 mm; an input file has its own.", metavar="LENGTH"),
]
GradingOption = Annotated[
    str | None,
    typer.Option(
        help="Sides of a fabric's elements by distance from the impact point, as panel.grading of an input file. If "
        "not given, one crossover near the impact point and up to four far off.",
        metavar="ZONES",
    ),
]
PageOption = Annotated[
    Path | None, typer.Option(help="Also put table and picture between their marks of this page.", metavar="FILE.md")
]


def sensitivity(
    target: TargetArgument,
    velocity: Annotated[
        list[str] | None, typer.Option(help="Strike velocity; may be given again.", metavar="VELOCITY")
    ] = None,
    samples: Annotated[int, typer.Option(min=2, help="N, a power of 2; N (inputs + 2) rows are run.")] = 64,
    seed: SeedOption = 1,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    opening: OpeningOption = None,
    resume: ResumeOption = False,
    page: PageOption = None,
    out: OutOption = None,
) -> None:
    """Sobol indices of the velocity after 200 us and of the peak tension over the uncertainties of the input.

    Where no strike velocity is given it is that of the input file, or 92.5 and 170 m/s at a fabric. A fabric is shot at
    as in the tests of the thesis: one ply, and a flat cylinder of 3 g and 5.5 mm. Of an input file these keys are
    ignored: title, run.snapshot_interval, run.checkpoint_interval, run.outputs; \\[history] and \\[accuracy] are
    rejected. The folder then holds sobol.html, .csv, .json, .png and scene.toml.
    """
    from fabrics.units import si
    from weavecell.commands import uncertainty

    uncertainty.sensitivity(
        target,
        out or RESULTS / f"sensitivity-{Path(target).stem}",
        velocities=[si(text, "m/s", key="--velocity") for text in velocity or ()],
        samples=samples,
        seed=seed,
        jobs=jobs,
        executor=executor,
        opening=opening,
        resume=resume,
        page=page,
    )


def v50(
    target: TargetArgument,
    shots: Annotated[int, typer.Option(min=4, help="Number of shots.")] = 100,
    batch: Annotated[
        int, typer.Option(min=4, help="Shots in a batch; each batch is placed by the results of those before.")
    ] = 10,
    shape: WeibullOption = None,
    modulus: Annotated[
        str | None,
        typer.Option(
            "--modulus-cov", help="Coefficient of variation of the modulus between panels.", metavar="FRACTION"
        ),
    ] = None,
    crimp: Annotated[
        str | None,
        typer.Option("--crimp-cov", help="Coefficient of variation of the crimp between panels.", metavar="FRACTION"),
    ] = None,
    seed: SeedOption = 1,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    opening: OpeningOption = None,
    grading: GradingOption = None,
    resume: ResumeOption = False,
    page: PageOption = None,
    out: OutOption = None,
) -> None:
    """V0, V50 and V100 of panels or packs whose yarns differ in strength, by repeated shots, with intervals.

    What is not given of the scatter is taken from weavecell/analysis/uncertainty/inputs.toml. Without scatter V50 is
    the critical velocity. A fabric is shot at as in the tests of the thesis: one ply, and a flat cylinder of 3 g and
    5.5 mm. Of an input file these keys are ignored: title, projectile.strike_velocity, run.end_time,
    run.snapshot_interval, run.checkpoint_interval, run.outputs; \\[history] and \\[accuracy] are rejected.

    The folder then holds v50.html, .csv, .json, .png, shots.csv and scene.toml.
    """
    from dataclasses import replace

    from fabrics.units import si
    from weavecell.analysis.uncertainty import inputs
    from weavecell.commands import uncertainty

    given = {"shape": shape}
    given |= {
        key: None if text is None else si(text, "", key=f"--{key}-cov")
        for key, text in (("modulus", modulus), ("crimp", crimp))
    }
    uncertainty.probabilistic(
        target,
        out or RESULTS / f"v50-{Path(target).stem}",
        shots=shots,
        batch=batch,
        seed=seed,
        scatter=replace(inputs.published(), **{key: value for key, value in given.items() if value is not None}),
        jobs=jobs,
        executor=executor,
        opening=opening,
        grading=grading,
        resume=resume,
        page=page,
    )


def sweep(
    target: TargetArgument,
    over: Annotated[
        list[str],
        typer.Option(
            help="A key of the input file and its values; may be given again, for all combinations.",
            metavar="KEY=VALUE,VALUE,...",
        ),
    ],
    quantity: Annotated[
        str, typer.Option(help="What is computed of each: one shot, its ballistic limit, or its V50.",
                          metavar="shot|critical-velocity|v50")
    ] = "shot",
    tolerance: Annotated[
        str, typer.Option(help="Of a critical velocity: between stop and perforation.", metavar="VELOCITY")
    ] = "1 m/s",
    shots: Annotated[int, typer.Option(min=4, help="Of a V50.")] = 60,
    seed: SeedOption = 1,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    resume: ResumeOption = False,
    out: OutOption = None,
) -> None:  # fmt: skip
    """Repeat an input file over values of its keys, and compute a shot, the ballistic limit or V50 of each.

    All combinations are checked before the first is computed. Ignored keys of the input file: title,
    run.snapshot_interval, run.checkpoint_interval, run.outputs, and for a limit or V50 projectile.strike_velocity and
    run.end_time; \\[history] and \\[accuracy] are rejected.

    The folder then holds sweep.csv, sweep.json, sweep.png (against areal density, of numbers of plies), scene.toml, and
    sweep.parquet where pyarrow is installed.
    """
    from fabrics.units import si
    from weavecell.analysis.sweep import Wanted
    from weavecell.commands import sweep as module

    width = si(tolerance, "m/s", key="--tolerance")
    if not width > 0:
        raise InputError(key="--tolerance", value=tolerance, allowed="above 0")
    try:
        wanted = Wanted(quantity, width, shots, seed)
    except InputError as problem:
        raise InputError(key=f"--{problem.key}", value=problem.value, allowed=problem.allowed) from None
    folder = out or RESULTS / f"sweep-{Path(target).stem}"
    module.sweep(target, folder, over, wanted, jobs=jobs, executor=executor, resume=resume)
