"""The critical velocity of a panel or pack, and its residual velocities with a Lambert-Jonas fit.

The folder of `weavecell critical-velocity`
    scene.toml               the input file; that of a fabric is the standard one, and can be run again or changed
    critical-velocity.json   bracket, scan, zone of mixed outcomes if there is one, fit, shots, provenance
    shots.csv                one row a shot, by strike velocity
    residual-velocity.svg    residual against strike velocity

All of it is written at the end; after an unstable shot only the scene and the shots before it.
"""

from __future__ import annotations

import csv
import time
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError, UndecidedError, UnstableError
from weavecell.commands import options

with lazy.imports():
    from fabrics import files, units
    from shellfabric.impact import limit_scan
    from shellfabric.panel import quality
    from weavecell.analysis import limit_search
    from weavecell.report import chapters_assumed, checks, pictures
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import of_commands, target

if TYPE_CHECKING:
    from shellfabric.impact.lambert_jonas import LambertJonas

_COLUMNS = {
    "strike velocity [m/s]": lambda shot: f"{shot.strike_velocity:.4f}",
    "outcome": lambda shot: shot.outcome,
    "residual velocity [m/s]": lambda shot: f"{shot.residual_velocity:.4f}",
    "time [s]": lambda shot: f"{shot.time:.6e}",
    "failed yarn segments": lambda shot: f"{shot.failed}",
    "peak warp tension [N]": lambda shot: f"{shot.peak_tension[0]:.3f}",
    "peak weft tension [N]": lambda shot: f"{shot.peak_tension[1]:.3f}",
    "energy error [-]": lambda shot: f"{shot.balance:.3e}",
    "checks": lambda shot: checks.status(shot.checks),
}


@options.example("weavecell critical-velocity S-720 --tolerance '1 m/s'")
def critical_velocity(
    name: options.TargetArgument,
    tolerance: options.ToleranceOption = "1 m/s",
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
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    strict: options.StrictOption = False,
    assumed_range: options.AssumedRangeOption = True,
    out: options.OutOption = None,
) -> None:
    """Bisect for the velocity between stop and perforation, and fit residual velocities (Lambert-Jonas).

    Further shots scan the velocities about the bracket. If one stops that is faster than one that perforates, no single
    critical velocity exists: the zone of mixed outcomes is reported, and the result is doubtful (exit code 3 with
    --strict). --scan-above "0 %" --scan-below "0 %" leave the scan out.

    A fabric is shot at as in the tests of the thesis. Of a scene these keys are ignored: title,
    projectile.strike_velocity, run.end_time, backing.after_stop, run.snapshot_interval, run.checkpoint_interval,
    run.outputs. \\[history] and \\[accuracy] are rejected.

    The folder then holds critical-velocity.json, shots.csv, residual-velocity.svg and scene.toml.
    """
    width, scan = options.above_zero(tolerance, "m/s", "--tolerance"), _scan(scan_above, scan_below, scan_step)
    out = out or options.RESULTS / f"critical-velocity-{Path(name).stem}"
    this, began = target.read(name, out, of_commands.LIMITS), time.perf_counter()
    out_folder.claim(out)
    shots: list[Any] = []
    try:
        found = limit_search.search(
            this.setup, tolerance=width, residual_shots=curve, scan=scan, with_range=assumed_range, jobs=jobs,
            executor=executor, stage=_stage, keep=shots.append,
        )  # fmt: skip
    except InputError as problem:
        raise this.in_file(problem) from None
    except (UndecidedError, UnstableError):
        _write_shots(out, this.text, shots)
        raise
    shots.sort(key=lambda shot: shot.strike_velocity)
    _report(out, this, found, shots, scan, time.perf_counter() - began, strict)


def _scan(scan_above, scan_below, scan_step):
    """The ScanRange of the options."""
    given = {"above": scan_above, "below": scan_below, "step": scan_step}
    try:
        return limit_scan.ScanRange(**{name: units.si(text, "", key=f"--scan-{name}") for name, text in given.items()})
    except InputError as problem:
        if problem.key in given:
            raise InputError(key=f"--scan-{problem.key}", value=given[problem.key], allowed=problem.allowed) from None
        raise


@contextmanager
def _stage(title):
    """A progress bar that names each shot as it ends."""
    with progress.bar(title) as advance:
        yield lambda share, shot: advance(share, _in_words(shot)) if shot is not None else advance(share)


def _in_words(shot):
    doubt = ", doubtful" if checks.status(shot.checks) == checks.DOUBTFUL else ""
    return f"{shot.outcome} at {shot.strike_velocity:.1f} m/s{doubt}"


def _report(out, this, found, shots, scan, seconds, strict):
    """Write and print what was found; DoubtfulError where it is doubtful, and `strict`."""
    indicators = (*quality.worst(shot.checks for shot in found.limit.shots), limit_scan.indicator(found.limit))
    _write_shots(out, this.text, shots)
    _write(out, this, found, shots, indicators, scan, seconds)
    _tell(this.title, found.limit, found.fit, shots, out)
    if found.range is not None:
        print(f"assumed laws: {found.range.words()}")
    checks.report(indicators, strict)


def _write_shots(out, text, shots):
    files.write(out / "scene.toml", text)
    with files.write_whole(out / "shots.csv") as file:
        rows = csv.writer(file)
        rows.writerow(_COLUMNS)
        rows.writerows([column(shot) for column in _COLUMNS.values()] for shot in shots)


def _write(out, this, search, shots, indicators, scan, wall_time):
    found, fit = search.limit, search.fit
    summary = {
        "format": "weavecell critical velocity 3",
        "fabric": this.setup.name,
        "plies": this.case.scene.panel.plies,
        "projectile": this.projectile,
        "law_name": this.case.law_name,
        "critical_velocity_m_s": found.velocity if found.single else None,
        "bracket_m_s": [found.low, found.high],
        "single_limit": found.single,
        "highest_stop_m_s": found.highest_stop,
        "lowest_perforation_m_s": found.lowest_perforation,
        "mixed_zone_m_s": found.mixed_zone,
        "scan": asdict(scan),
        "lambert_jonas": asdict(fit) if fit else None,
        "shots": [_entry(shot) for shot in shots],
        "bracket_checks": checks.of_bracket(found),
        **checks.summary(indicators),
        **chapters_assumed.summary(search.range),
        "wall_time_s": wall_time,
        "provenance": provenance.stamp(this.text, setup=this.setup),
    }
    json_file.write(out / "critical-velocity.json", summary)
    files.write(
        out / "residual-velocity.svg", pictures.render(pictures.residual_velocity, this.title, found, fit, shots)
    )


def _entry(shot):
    """A shot for critical-velocity.json."""
    return {
        "strike_velocity_m_s": shot.strike_velocity,
        "residual_velocity_m_s": shot.residual_velocity,
        "outcome": shot.outcome,
        "end_time_s": shot.time,
        "failed_yarn_segments": shot.failed,
        "peak_tension_N": shot.peak_tension,
        "energy_error_max": shot.balance,
        "wall_time_s": shot.wall_time,
        "checks": checks.status(shot.checks),
    }


def _tell(title, found, fit, shots, out):
    if found.single:
        print(f"{title}: critical velocity {found.velocity:.1f} m/s")
        print(f"stops at {found.low:.2f} m/s, perforates at {found.high:.2f} m/s; {len(shots)} shots")
    else:
        low, high = found.mixed_zone
        inside = [shot.perforated for shot in shots if low <= shot.strike_velocity <= high]
        print(f"{title}: no single critical velocity, mixed outcomes from {low:.1f} to {high:.1f} m/s")
        print(f"lowest perforation {low:.2f} m/s, highest stop {high:.2f} m/s; {len(shots)} shots")
        print(f"{len(inside)} shots in this zone: {sum(inside)} perforate, {len(inside) - sum(inside)} stop")
    if (doubt := checks.of_bracket(found)) != checks.OK:
        print(f"the limit rests on a {doubt}")
    if fit is not None:
        print(f"Lambert-Jonas: {parameters(fit)}, rms {fit.residual_rms:.1f} m/s")
    print(f"written to {out}", flush=True)


def parameters(fit: LambertJonas) -> str:
    """The fitted parameters as text, each with its interval."""
    texts = []
    for name, interval in fit.intervals.items():
        within = f"({interval[0]:.3g} to {interval[1]:.3g})" if interval else "(at its bound)"
        texts.append(f"{name} = {getattr(fit, name):.3g} {within}")
    return ", ".join(texts)
