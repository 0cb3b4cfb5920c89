"""Tests of a laboratory beside what an input file computes.

The folder of `weavecell compare`
    comparison.json      V50 of the tests, computed critical velocity, residual velocities, with intervals, provenance
    shots.csv            every test with the computed outcome and residual velocity
    comparison.svg       residual against strike velocity, tested and computed
    scene.toml           the input file
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.errors import InputError
from fabrics.files import write_whole
from weavecell.commands.critical_velocity import SUPPORT
from weavecell.report import checks, pictures
from weavecell.results import json_file, progress, provenance
from weavecell.scenes import target

_HEADS = (
    "velocity [m/s]", "tested", "computed", "tested residual velocity [m/s]", "computed residual velocity [m/s]",
    "checks",
)  # fmt: skip


def compare(tests: Path, name: str, out: Path, *, tolerance: float, jobs: int, executor: str) -> None:
    """Fire the shots of a table of tests at what `name` says, and find its critical velocity.

    Parameters
    ----------
    tests : of `fired_tests.FiredTests.read`
    name : of `target.read`
    out : folder
    tolerance : [m/s] of the critical velocity
    jobs, executor : as of `ballistic_limit.critical_velocity`

    Raises
    ------
    InputError : a wrong table or input file; nothing has been written
    UnstableError, UndecidedError : a shot became unphysical, or neither stopped nor perforated
    """
    from shellfabric.impact import ballistic_limit
    from weavecell.analysis import fired_tests

    fired = fired_tests.FiredTests.read(tests)
    this = target.read(name, out, SUPPORT)
    beside: dict[str, Any] = {"jobs": jobs, "executor": executor}
    try:
        panel = this.setup.target()
        with progress.bar(f"{this.title}, critical velocity") as advance:
            limit = ballistic_limit.critical_velocity(
                panel, tolerance=tolerance, report=lambda share, _: advance(share), **beside
            )
        with progress.bar("Shots of the tests") as advance:
            strikes, where = np.unique(fired.velocity, return_inverse=True)
            shots = ballistic_limit.shoot(panel, strikes, report=lambda share, _: advance(share), **beside)
    except InputError as problem:
        raise this.in_file(problem) from None
    found = fired_tests.compare(fired, tuple(shots[k] for k in where), limit)
    _write(out, this, found)
    _tell(this.title, found, out)


def _write(out, this, found):
    with write_whole(out / "scene.toml") as file:
        file.write(this.text)
    words = ("stopped", "perforated")
    with write_whole(out / "shots.csv") as file:
        rows = csv.writer(file)
        rows.writerow(_HEADS)
        for shot, velocity, hit, residual in zip(
            found.shots, found.tests.velocity, found.tests.perforated, found.tests.residual
        ):
            tested = "" if np.isnan(residual) else f"{residual:.4g}"
            computed = f"{shot.residual_velocity:.4g}"
            rows.writerow(
                [f"{velocity:.4f}", words[int(hit)], shot.outcome, tested, computed, checks.status(shot.checks)]
            )
    summary = {"format": "weavecell comparison 1", "fabric": this.title, "projectile": this.projectile}
    summary |= found.summary() | {"provenance": provenance.stamp(this.text, *this.setup.fabrics)}
    json_file.write(out / "comparison.json", summary)
    with write_whole(out / "comparison.svg", "wb") as file:
        file.write(pictures.render(pictures.tested_and_computed, this.title, found))


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
