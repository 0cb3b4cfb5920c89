"""`weavecell fit`: its options, as texts for `weavecell.commands.fit`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from weavecell.cli.options import CORES, RESULTS, ExecutorOption, JobsOption, OutOption, ResumeOption

EPILOG = "Example: [bold]weavecell fit examples/S-720-stops.toml radar.csv --free modulus --free crimp_warp[/bold]"


def fit(
    target: Annotated[
        str, typer.Argument(metavar="FILE|FABRIC", help="An input file of a shot or a coupon, a fabric's name or file.")
    ],
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Measured curve (*.csv), units in its heading.")],
    free: Annotated[
        list[str] | None,
        typer.Option(
            help="What is fitted; may be given again. Without a range: half to twice what the file has.",
            metavar="NAME[=LOW..HIGH]",
        ),
    ] = None,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
    resume: ResumeOption = False,
    out: OutOption = None,
) -> None:
    r"""Fit numbers of a fabric or an input file to a measured curve, with intervals and what the curve leaves open.

    DATA has the columns time and velocity of a projectile; or velocity, outcome and residual velocity of shots, as of
    `weavecell compare`; or what a coupon is prescribed and its loads; or pressure and thickness or closure of a ply
    between platens. Each has its unit in the heading: "time \[us], velocity \[m/s]".

    NAME is a key of the input file that holds a number, such as panel.crossover_friction, or a factor on the fabric:
    modulus, failure_strain, crimp_warp, crimp_weft, compression_a, compression_b, trellis_stiffness, trellis_angles.
    Platens give E_c, V_c and K_r of the yarns in 3D, without --free.

    Ignored keys of the input file: title, run.snapshot_interval, run.checkpoint_interval, run.outputs, and with shots
    projectile.strike_velocity and run.end_time; \[history] and \[accuracy] are rejected.

    The folder then holds fit.json, fit.csv, fit.svg, scene.toml, and with fitted values fitted.toml and fabric.toml.
    """
    from weavecell.commands import fit as command

    folder = out or RESULTS / f"fit-{Path(target).stem}"
    command.fit(target, data, folder, free or (), jobs=jobs, executor=executor, resume=resume)
