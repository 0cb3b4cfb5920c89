"""`weavecell sensitivity` and `weavecell v50`: their options, as texts and numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from weavecell.cli.options import (
    CORES,
    RESULTS,
    ExecutorOption,
    FabricArgument,
    JobsOption,
    OutOption,
    ResumeOption,
    SeedOption,
    WeibullOption,
)

SENSITIVITY = "Example: [bold]weavecell sensitivity S-720 --samples 64[/bold]"
V50 = "Example: [bold]weavecell v50 S-720 --shots 200 --weibull-shape 14.3[/bold]"


OpeningOption = Annotated[str, typer.Option(help="Side of the square panel.", metavar="LENGTH")]
GradingOption = Annotated[
    str | None,
    typer.Option(
        help="Sides of the elements by distance from the impact point, as panel.grading of a scene; docs/scatter.md "
        "has an example, which takes a third of the time, and its error. All of one side if not given.",
        metavar="ZONES",
    ),
]
PageOption = Annotated[
    Path | None, typer.Option(help="Also put table and picture between their marks of this page.", metavar="FILE.md")
]


def sensitivity(
    fabric: FabricArgument,
    velocity: Annotated[
        list[str] | None, typer.Option(help="Strike velocity; may be given again.", metavar="VELOCITY")
    ] = None,
    samples: Annotated[int, typer.Option(min=2, help="N, a power of 2; N (inputs + 2) rows are run.")] = 64,
    seed: SeedOption = 1,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    opening: OpeningOption = "203 mm",
    resume: ResumeOption = False,
    page: PageOption = None,
    out: OutOption = None,
) -> None:
    """Sobol indices of the velocity after 200 us and of the peak tension over the uncertainties of the input.

    Strike velocities are 92.5 and 170 m/s where none is given. The folder then holds sobol.html, .csv, .json, .png.
    """
    from fabrics.units import si
    from weavecell.commands import uncertainty

    uncertainty.sensitivity(
        fabric,
        out or RESULTS / f"sensitivity-{Path(fabric).stem}",
        velocities=[si(text, "m/s", key="--velocity") for text in velocity or ("92.5 m/s", "170 m/s")],
        samples=samples,
        seed=seed,
        jobs=jobs,
        executor=executor,
        opening=si(opening, "m", key="--opening"),
        resume=resume,
        page=page,
    )


def v50(
    fabric: FabricArgument,
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
    opening: OpeningOption = "203 mm",
    grading: GradingOption = None,
    resume: ResumeOption = False,
    page: PageOption = None,
    out: OutOption = None,
) -> None:
    """V0, V50 and V100 of panels whose yarns differ in strength, by repeated shots, with intervals.

    What is not given is taken from weavecell/analysis/uncertainty/inputs.toml. Without scatter V50 is the critical
    velocity. The folder then holds v50.html, .csv, .json, .png and shots.csv.
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
        fabric,
        out or RESULTS / f"v50-{Path(fabric).stem}",
        shots=shots,
        batch=batch,
        seed=seed,
        scatter=replace(inputs.published(), **{key: value for key, value in given.items() if value is not None}),
        jobs=jobs,
        executor=executor,
        opening=si(opening, "m", key="--opening"),
        grading=None if grading is None else uncertainty.grading_of(grading, key="--grading"),
        resume=resume,
        page=page,
    )
