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
from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError, UndecidedError, UnstableError
from fabrics.files import write_whole
from weavecell.report import chapters_assumed, checks, pictures
from weavecell.results import json_file, progress, provenance
from weavecell.scenes import target

if TYPE_CHECKING:
    from shellfabric.impact.lambert_jonas import LambertJonas

SUPPORT = target.support(ignored=("title", *target.UNWRITTEN, "projectile.strike_velocity", "run.end_time"))
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


def critical_velocity(
    name: str, out: Path, *, tolerance: float, curve: int, jobs: int, executor: str, scan: Any = None,
    strict: bool = False, with_range: bool = True,
) -> None:  # fmt: skip
    """Find the critical velocity of what `name` says: an input file, a fabric of the catalogue or a fabric file.

    Where a shot stops that is faster than one that perforates, no single critical velocity exists: the zone of mixed
    outcomes is reported in its place, and the result is doubtful.

    Parameters
    ----------
    name : of `target.read`
    out : Path of the folder to write to
    tolerance : [m/s]
    curve : number of shots above the limit for the curve of residual velocity
    jobs, executor : as of `ballistic_limit.critical_velocity`
    scan : `limit_scan.ScanRange`, the range about the bracket that is scanned; None for its defaults
    strict : whether a doubtful result is an error
    with_range : whether the range over assumed laws is computed (`analysis.assumed_range`)

    Raises
    ------
    InputError : the scene or fabric is wrong, or its panel has no critical velocity; nothing has been written
    UnstableError : a shot became unphysical; those before it have been written
    UndecidedError : a shot neither stopped nor perforated; those before it have been written
    DoubtfulError : a quality indicator is beyond its limit, and `strict`; all results have been written
    """
    from shellfabric.impact.limit_scan import ScanRange
    from weavecell.analysis import limit_search

    this, began = target.read(name, out, SUPPORT), time.perf_counter()
    shots: list[Any] = []
    scan = scan or ScanRange()
    try:
        found = limit_search.search(
            this.setup, tolerance=tolerance, residual_shots=curve, scan=scan, with_range=with_range, jobs=jobs,
            executor=executor, stage=_stage, keep=shots.append,
        )  # fmt: skip
    except InputError as problem:
        raise this.in_file(problem) from None
    except (UndecidedError, UnstableError):
        _write_shots(out, this.text, shots)
        raise
    shots.sort(key=lambda shot: shot.strike_velocity)
    _report(out, this, found, shots, scan, time.perf_counter() - began, strict)


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
    indicators = _indicators(found.limit)
    _write_shots(out, this.text, shots)
    _write(out, this, found, shots, indicators, scan, seconds)
    _tell(this.title, found.limit, found.fit, shots, out)
    if found.range is not None:
        print(f"assumed laws: {found.range.words()}")
    checks.report(indicators, strict)


def _indicators(found):
    from shellfabric.impact import limit_scan
    from shellfabric.panel import quality

    return (*quality.worst(shot.checks for shot in found.shots), limit_scan.indicator(found))


def _write_shots(out, text, shots):
    with write_whole(out / "scene.toml") as file:
        file.write(text)
    with write_whole(out / "shots.csv") as file:
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
        "provenance": provenance.stamp(this.text, *this.setup.fabrics),
    }
    json_file.write(out / "critical-velocity.json", summary)
    with write_whole(out / "residual-velocity.svg", "wb") as file:
        file.write(pictures.render(pictures.residual_velocity, this.title, found, fit, shots))


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
