"""Tests of a laboratory beside what an input file computes.

The folder of `weavecell compare`
    comparison.json      V50 of the tests, computed critical velocity, residual velocities, with intervals, provenance
    shots.csv            every test with the computed outcome and residual velocity
    comparison.svg       residual against strike velocity, tested and computed
    scene.toml           the input file
"""

from __future__ import annotations

import csv
from math import isnan
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError
from weavecell.commands import options

with lazy.imports():
    from fabrics import files
    from shellfabric.impact import ballistic_limit
    from weavecell.analysis import fired_tests
    from weavecell.report import checks, pictures
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import of_commands, target


_HEADS = (
    "velocity [m/s]", "tested", "computed", "tested residual velocity [m/s]", "computed residual velocity [m/s]",
    "checks",
)  # fmt: skip


@options.example("weavecell compare tests.csv examples/S-728-pack.toml")
def compare(
    tests: Annotated[Path, typer.Argument(metavar="TESTS", help="Table of tests (*.csv): a row a shot.")],
    name: options.TargetArgument,
    tolerance: options.ToleranceOption = "1 m/s",
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    out: options.OutOption = None,
) -> None:
    r"""Put the shots of a laboratory beside the computed ones: V50 and residual velocities, with intervals.

    TESTS has a row a shot, and the columns velocity, outcome (PP or CP, or stopped or perforated) and, where it was
    measured, residual velocity, each speed with its unit in the heading: "velocity \[m/s]". The shots are fired at the
    target at these velocities, and its critical velocity is found, on the mesh of the scene.

    Of a scene these keys are ignored: title, projectile.strike_velocity, run.end_time, backing.after_stop,
    run.snapshot_interval, run.checkpoint_interval, run.outputs. \[history] and \[accuracy] are rejected.

    The folder then holds comparison.json, shots.csv, comparison.svg and scene.toml.
    """
    width = options.above_zero(tolerance, "m/s", "--tolerance")
    out = out or options.RESULTS / f"compare-{Path(name).stem}"
    fired = fired_tests.FiredTests.read(tests)
    this = target.read(name, out, of_commands.LIMITS)
    out_folder.claim(out)
    beside: dict[str, Any] = {"jobs": jobs, "executor": executor}
    try:
        panel = this.setup.target()
        with progress.bar(f"{this.title}, critical velocity") as advance:
            limit = ballistic_limit.critical_velocity(
                panel, tolerance=width, report=lambda share, _: advance(share), **beside
            )
        with progress.bar("Shots of the tests") as advance:
            strikes = sorted({float(velocity) for velocity in fired.velocity})
            shots = ballistic_limit.shoot(panel, strikes, report=lambda share, _: advance(share), **beside)
    except InputError as problem:
        raise this.in_file(problem) from None
    found = fired_tests.compare(fired, tuple(shots[strikes.index(velocity)] for velocity in fired.velocity), limit)
    _write(out, this, found)
    _tell(this.title, found, out)


def _write(out, this, found):
    files.write(out / "scene.toml", this.text)
    words = ("stopped", "perforated")
    with files.write_whole(out / "shots.csv") as file:
        rows = csv.writer(file)
        rows.writerow(_HEADS)
        for shot, velocity, hit, residual in zip(
            found.shots, found.tests.velocity, found.tests.perforated, found.tests.residual
        ):
            tested = "" if isnan(residual) else f"{residual:.4g}"
            computed = f"{shot.residual_velocity:.4g}"
            rows.writerow(
                [f"{velocity:.4f}", words[int(hit)], shot.outcome, tested, computed, checks.status(shot.checks)]
            )
    summary = {"format": "weavecell comparison 1", "fabric": this.title, "projectile": this.projectile}
    stamp = provenance.stamp(this.text, setup=this.setup)
    summary |= found.summary() | {"provenance": stamp}
    json_file.write(out / "comparison.json", summary)
    files.write(out / "comparison.svg", pictures.render(pictures.tested_and_computed, this.title, found))


def _tell(title, found, out):
    low, high = found.limit.low, found.limit.high
    print(f"{title}: computed critical velocity {found.limit.velocity:.1f} m/s ({low:.2f} to {high:.2f})")
    if found.curve is None:
        print("tests: all of one outcome, which gives no V50")
    else:
        low, high = found.curve.intervals["V50"]
        off = 100 * (found.limit.velocity / found.curve.V50 - 1)
        print(
            f"tests: V50 {found.curve.V50:.1f} m/s ({low:.1f} to {high:.1f} with 95 % confidence, probit); "
            f"the computed critical velocity is {off:+.1f} % off"
        )
    print(f"outcome as tested in {found.agree} of {len(found.shots)} shots")
    off = found.difference()
    if off["mean"] is not None:
        print(
            f"residual velocity, computed less tested, {off['shots']} shots: mean {off['mean']:+.1f} m/s "
            f"({off['low']:+.1f} to {off['high']:+.1f} with 95 % confidence), rms {off['rms']:.1f} m/s"
        )
    doubtful = sum(checks.status(shot.checks) == checks.DOUBTFUL for shot in found.shots)
    if doubtful:
        print(f"doubtful: {doubtful} of {len(found.shots)} computed shots (shots.csv)")
    print(f"written to {out}", flush=True)
