"""`weavecell validate`, `cost-accuracy` and `stability`, which `validation.commands` carries out."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from weavecell.commands import options


class Level(StrEnum):
    """How fine a study's finest case is."""

    quick = "quick"
    full = "full"
    fine = "fine"


QuickOption = Annotated[bool, typer.Option("--quick", help="Coarser references, as a check that everything runs.")]
PageOption = Annotated[
    Path | None, typer.Option(help="Also write this page, with its figures beside it in figures/.", metavar="FILE.md")
]
AllOption = Annotated[bool, typer.Option("--all", help="All standard scenes or maps.")]


@options.example("weavecell cost-accuracy --scene ply-stopped")
def cost_accuracy(
    context: typer.Context,
    scene: Annotated[
        list[str] | None, typer.Option(help="Standard scene; an unknown one lists them.", metavar="NAME")
    ] = None,
    everything: AllOption = False,
    quick: QuickOption = False,
    page: PageOption = None,
    level: Annotated[Level, typer.Option(help="crossover: mesh of the finest reference.")] = Level.full,
    only: Annotated[
        str, typer.Option(help="crossover: choices to vary, by commas; all if not given.", metavar="CHOICE,...")
    ] = "",
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    out: options.OutOption = None,
    resume: options.ResumeOption = False,
) -> None:
    """Run the standard cases with every method: CPU time against error, and the Pareto-optimal methods.

    The folder then holds tables (CSV) and pictures; while the run goes on, cases/. The scene "crossover" is the long
    study of the 3D crossover, with orders of convergence and a page of its own; --jobs and --executor are for it, since
    the cases of other scenes are timed, one after the other.
    """
    from validation.commands import cost_accuracy as module

    of_crossover = (scene or []) == [module.LONG]
    own = ("level", "only", "jobs", "executor") if of_crossover else ("everything", "quick", "page")
    where = f"{'with' if of_crossover else 'without'} --scene {module.LONG}"
    options.refuse_others(context, ("scene", "out", "resume", *own), where)
    module.chart_command(
        scene or [],
        out,
        everything=everything,
        quick=quick,
        page=page,
        level=level.value,
        only=[part.strip() for part in only.split(",") if part.strip()],
        jobs=jobs,
        executor=executor,
        resume=resume,
    )


@options.example("weavecell stability --map time-step")
def stability(
    maps: Annotated[
        list[str] | None, typer.Option("--map", help="Name of the map; an unknown one lists them.", metavar="NAME")
    ] = None,
    everything: AllOption = False,
    quick: Annotated[bool, typer.Option("--quick", help="Few points, as a check that everything runs.")] = False,
    page: PageOption = None,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    out: options.OutOption = None,
    resume: options.ResumeOption = False,
) -> None:
    """Compute stability maps of the methods, and the margins of the defaults.

    The folder then holds a picture for each map and tables (CSV) of points and edges; while it goes on, points/.
    """
    from validation.commands import stability as module

    module.stability_command(
        maps or [], out, everything=everything, quick=quick, page=page, jobs=jobs, executor=executor, resume=resume
    )


@options.example("weavecell validate --topic impact1 --topic cell")
def validate(
    topic: Annotated[
        list[str] | None, typer.Option(help="Only the claims of this topic; may be given again.", metavar="TOPIC")
    ] = None,
    slow: Annotated[bool, typer.Option("--slow", help="Also the checks that take minutes each.")] = False,
    variants: Annotated[
        bool,
        typer.Option(help="Check the claims that rest on shots in four variants of the model too."),
    ] = True,
    page: Annotated[
        Path | None, typer.Option(help="Also write this page, with its data beside it in data/.", metavar="FILE.md")
    ] = None,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    resume: options.ResumeOption = False,
    out: options.OutOption = None,
) -> int:
    """Compare computed values with the statements of the thesis: value, result and, where missed, the cause.

    A missed claim is a result, not an error; a result other than the recorded one ends with exit code 1. Claims that
    rest on shots at one ply are checked as computed and in four variants: the cell formulation of the thesis, nominal
    denier, 2 elements per crossover, elastic-plastic bored projectile. The folder has ledger.csv and ledger.json then.

    Topics: geom, compr, yarn, cell, shear, wave, impact1, impactN, gap, biaxial, bias, sens, slip, pencil, cost,
    failmode, future.
    """
    from validation.commands import claims as module

    return module.validate(
        out or options.RESULTS / "validate",
        topics=topic or (),
        slow=slow,
        jobs=jobs,
        executor=executor,
        resume=resume,
        vary=variants,
        page=page,
    )
