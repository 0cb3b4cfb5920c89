"""The critical velocity of a panel, and its residual velocities with a Lambert-Jonas fit, from a scene or a fabric.

The folder of `weavecell critical-velocity`
    scene.toml               the scene; that of a fabric is the standard one, and can be run again or changed
    critical-velocity.json   bracket, scan, zone of mixed outcomes if there is one, fit, shots, provenance
    shots.csv                one row a shot, by strike velocity
    residual-velocity.svg    residual against strike velocity

All of it is written at the end; after an unstable shot only the scene and the shots before it.
"""

from __future__ import annotations

import csv
import os
import time
from dataclasses import asdict
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from fabrics.errors import InputError, UndecidedError, UnstableError
from fabrics.files import write_whole
from weavecell.analysis import assumed_range
from weavecell.report import chapters_assumed, checks, pictures
from weavecell.results import json_file, progress, provenance
from weavecell.scenes import build, toml_writer
from weavecell.scenes import impact as scenes_impact
from weavecell.scenes.supported import Support, of

if TYPE_CHECKING:
    from shellfabric.impact.lambert_jonas import LambertJonas

SUPPORT = Support(
    "weavecell critical-velocity",
    scenes_impact.Scene,
    (*build.SHOT, "panel.grading", *build.CROSSOVERS),
    ignored=(
        "title", "projectile.strike_velocity",
        *of("run", "end_time snapshot_interval checkpoint_interval outputs"),
    ),
    rejected=build.NO_SLACK
    | {"panel.plies": "1: the ballistic limit of one ply is computed; that of a pack is not available"}
    | dict.fromkeys(build.OF_A_PACK, "left out for a single ply")
    | {"history": "left out: the shots record nothing along yarns; `weavecell impact` does"}
    | {"accuracy": "left out: the ballistic limit is computed on the mesh of the scene"},
    rules=build.SHOT_RULES,
)  # fmt: skip
_CURVE = (1.03, 2.0)  # first and last shot of the curve, times the velocity above which all shots perforate
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
    target: str, out: Path, *, tolerance: float, curve: int, jobs: int, executor: str, scan: Any = None,
    strict: bool = False, with_range: bool = True,
) -> None:  # fmt: skip
    """Find the critical velocity of `target`, a scene file, a fabric of the catalogue or a fabric file.

    Where a shot stops that is faster than one that perforates, no single critical velocity exists: the zone of mixed
    outcomes is reported in its place, and the result is doubtful.

    Parameters
    ----------
    target : text
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
    from shellfabric.impact import ballistic_limit, limit_scan

    (this, text), began, shots = _case(target, out), time.perf_counter(), []
    scan = scan or limit_scan.ScanRange()

    def keep(share, shot):
        shots.append(shot)
        doubt = ", doubtful" if checks.status(shot.checks) == checks.DOUBTFUL else ""
        advance(share, f"{shot.outcome} at {shot.strike_velocity:.1f} m/s{doubt}")

    beside: dict[str, Any] = {"jobs": jobs, "executor": executor, "report": keep}
    try:
        setup = build.setup(this, target)
        panel = setup.panel()
        with progress.bar(f"{this.fabric.name}, critical velocity") as advance:
            found = ballistic_limit.critical_velocity(panel, tolerance=tolerance, **beside)
        if scan.ladder(found):
            with progress.bar("Scan about the bracket") as advance:
                found = limit_scan.scan(panel, found, scan, **beside)
        if curve:
            with progress.bar("Residual velocities") as advance:
                strikes = max(found.high, found.highest_stop) * np.geomspace(*_CURVE, curve)
                found = limit_scan.with_shots(found, ballistic_limit.shoot(panel, strikes, **beside))
        around = _range(setup, found, tolerance, jobs, executor) if with_range else None
    except InputError as problem:
        raise build.in_file(problem, target) from None
    except (UndecidedError, UnstableError):
        _write_shots(out, text, shots)
        raise
    shots.sort(key=lambda shot: shot.strike_velocity)
    _report(out, this, found, shots, scan, time.perf_counter() - began, text, around, strict)


def _report(out, this, found, shots, scan, seconds, text, around, strict):
    """Write and print what was found; DoubtfulError where it is doubtful, and `strict`."""
    fit, indicators = _fit(found), _indicators(found)
    _write_shots(out, text, shots)
    _write(out, this, found, fit, shots, indicators, scan, seconds, text, around)
    _tell(this, found, fit, shots, out)
    if around is not None:
        print(f"assumed laws: {around.words()}")
    checks.report(indicators, strict)


def _range(setup, found, tolerance, jobs, executor):
    """The AssumedRange of the critical velocity; None where nothing is assumed."""
    if not assumed_range.corners(setup.fabric, setup.laws):
        return None
    with progress.bar("Range over the assumed laws") as advance:
        return assumed_range.critical_velocity(
            setup, found.velocity, tolerance=tolerance, jobs=jobs, executor=executor, on_progress=advance
        )


def _fit(found):
    """Lambert-Jonas fit to the perforations, with the bracket's middle as its limit if there is a single limit; None
    where the perforations are too few."""
    from shellfabric.impact import lambert_jonas

    through = [shot for shot in found.shots if shot.perforated]
    if len(through) <= (2 if found.single else 3):
        return None
    velocities = zip(*((shot.strike_velocity, shot.residual_velocity) for shot in through))
    return lambert_jonas.fit(*velocities, limit=found.velocity if found.single else None)


def _indicators(found):
    from shellfabric.impact import limit_scan
    from shellfabric.panel import quality

    return (*quality.worst(shot.checks for shot in found.shots), limit_scan.indicator(found))


def _case(target, out):
    """(Case, text of its scene)"""
    name = Path(target).stem
    if target in catalogue.list_names():
        table = {"name": target}
    elif target.endswith(".toml"):
        text, found = scenes_impact.read_toml(target, what="scene or fabric")
        if {"fabric", "projectile", "panel", "run"} & set(found):
            return build.build(scenes_impact.check(found, target, SUPPORT), target, name), text
        catalogue.read(target)
        table = {"file": os.path.relpath(target, out)}
    else:
        raise InputError(
            key="TARGET", value=target,
            allowed=f"a scene or fabric file (*.toml), or one of {', '.join(catalogue.list_names())}",
        )  # fmt: skip
    standard = scenes_impact.read_toml(resources.files("weavecell") / "scenes" / "demo.toml", what="demonstration")[1][
        "scene"
    ]
    table = {**standard, "fabric": standard["fabric"] | {"name": None} | table}
    table["fabric"] = {key: value for key, value in table["fabric"].items() if value is not None}
    return build.build(scenes_impact.check(table, out / "scene.toml", SUPPORT), target, name), toml_writer.dumps(table)


def _write_shots(out, text, shots):
    with write_whole(out / "scene.toml") as file:
        file.write(text)
    with write_whole(out / "shots.csv") as file:
        rows = csv.writer(file)
        rows.writerow(_COLUMNS)
        rows.writerows([column(shot) for column in _COLUMNS.values()] for shot in shots)


def _write(out, this, found, fit, shots, indicators, scan, wall_time, text, around=None):
    summary = {
        "format": "weavecell critical velocity 3",
        "fabric": this.fabric.name,
        "law_name": this.law_name,
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
        **chapters_assumed.summary(around),
        "wall_time_s": wall_time,
        "provenance": provenance.stamp(text, this.fabric),
    }
    json_file.write(out / "critical-velocity.json", summary)
    with write_whole(out / "residual-velocity.svg", "wb") as file:
        file.write(pictures.render(pictures.residual_velocity, this.fabric.name, found, fit, shots))


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


def _tell(this, found, fit, shots, out):
    if found.single:
        print(f"{this.fabric.name}: critical velocity {found.velocity:.1f} m/s")
        print(f"stops at {found.low:.2f} m/s, perforates at {found.high:.2f} m/s; {len(shots)} shots")
    else:
        low, high = found.mixed_zone
        inside = [shot.perforated for shot in shots if low <= shot.strike_velocity <= high]
        print(f"{this.fabric.name}: no single critical velocity, mixed outcomes from {low:.1f} to {high:.1f} m/s")
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
