"""Fabrics and impacts of the Python interface. Quantities are SI numbers, or texts with a unit ("92.5 m/s")."""

from __future__ import annotations

import time
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, Unpack

from fabrics import backings as backing_data
from fabrics import catalogue, files
from fabrics import projectiles as projectile_data
from fabrics.checks import FilePath
from fabrics.errors import InputError, UndecidedError, UnstableError
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.api import keywords, limit_result, quantities, targets
from weavecell.api.keywords import Keywords
from weavecell.api.limit_result import CriticalVelocityResult
from weavecell.api.scatter_results import SensitivityResult, V50Result
from weavecell.results import progress
from weavecell.scenes import of_commands

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup

__all__ = [
    "backings",
    "critical_velocity",
    "fabric",
    "fabrics",
    "projectile",
    "projectiles",
    "sensitivity",
    "setup",
    "v50",
]


def fabrics() -> tuple[str, ...]:
    """Names of the fabrics of the catalogue, sorted.

    Examples
    --------
    >>> wc.fabrics()[:2]
    ('S-720', 'S-726')
    """
    return catalogue.list_names()


def fabric(name: FilePath, *, linear_density: Literal["effective", "nominal"] = "effective") -> Fabric:
    """A fabric of the catalogue, or of a user's file.

    Parameters
    ----------
    name : name of the catalogue, or path of a .toml file
    linear_density : "effective", of the runs of the thesis where the file gives it (erratum E-07), as scenes have it;
        or "nominal", of the data sheet

    Raises
    ------
    InputError : no such fabric, a wrong file, or another linear density

    Examples
    --------
    >>> wc.fabric("S-720").name
    'S-720'
    >>> round(1e3 * wc.fabric("S-720", linear_density="nominal").weave.areal_density)  # [g/m2]
    253
    """
    if linear_density not in ("effective", "nominal"):
        raise InputError(key="linear_density", value=linear_density, allowed="effective or nominal")
    return with_linear_density(catalogue.load(name), linear_density)


def backings() -> tuple[str, ...]:
    """Names of the backings: modelling clay and ballistic gelatine, for `backing` of `setup`.

    Examples
    --------
    >>> wc.backings()[0]
    'Roma Plastilina No. 1'
    """
    return backing_data.list_names()


def projectiles() -> tuple[str, ...]:
    """Names of the projectiles: fragment simulators, right circular cylinders, spheres.

    Examples
    --------
    >>> wc.projectiles()[3]
    'FSP 1.10 g'
    """
    return projectile_data.list_names()


def projectile(name: str, **changes: float | str) -> dict[str, float | str]:
    """A projectile by name, as the dict that `setup` and what takes its keywords take for `projectile`.

    Parameters
    ----------
    name : of `projectiles`; the name alone will do as well: projectile="FSP 1.10 g"
    changes : keys of [projectile] in the input file that are added to its data or replace them

    Raises
    ------
    InputError : no such projectile

    Examples
    --------
    >>> wc.projectile("FSP 1.10 g", obliquity="30 deg")["diameter"]
    '5.46 mm'
    """
    return projectile_data.table(name, changes)


def setup(fabric: Fabric | FilePath | None, velocity: float | str, **options: Unpack[Keywords]) -> ImpactSetup:
    """The set-up of one impact, for `sweep` or `shellfabric`.

    Parameters
    ----------
    fabric : Fabric, or what `weavecell.fabric` takes; None where every dict of `ply` has its name or file
    velocity : [m/s] of the strike, or a text such as "92.5 m/s"
    **options : the keys of the input file (docs/reference/input.md), numbers in SI units or texts with a unit. Those of
        [fabric], [panel] and [run] are keywords (`weavecell.api.keywords.Keywords`): opening is 203 mm and end_time
        800 us where not given, without snapshot_interval only the shape at the end is kept, ply is a list of dicts, as
        [[panel.ply]]: ply=[{"count": 2}, {"name": "S-726", "angle": "90 deg"}]. The tables [projectile], [history],
        [numerics] and [backing] are dicts: projectile={"mass": "1.1 g", "diameter": "5.4 mm", "edge_radius": "0.3 mm"},
        whose three keys are required as in the file; projectile="FSP 1.10 g" or {"name": "FSP 1.10 g", ...} is one of
        `projectiles`; without it the projectile is the flat cylinder of 3 g and 5.5 mm with an edge radius of 0.3 mm.
        backing="gelatine 10 %" or {"material": "gelatine 10 %", ...} is one of `backings`. law is a CompressionLaw of
        both families, a pair (warp, weft), the path of a law.json, a dict {"a": ..., "b": ...} or a CalibrationResult;
        without it that of the fabric. surface may be a ResponseSurface, ply_contact a PlyLaw

    Returns
    -------
    ImpactSetup; each of its `notes`, which sliding crossovers have, is a warning

    Raises
    ------
    InputError : an unknown keyword, a value that is not allowed, or a law that is missing

    Examples
    --------
    >>> wc.setup("S-720", "92.5 m/s", opening="50 mm").opening
    0.05
    """
    return targets.made(fabric, velocity, options).setup


def critical_velocity(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    tolerance: float | str = "1 m/s",
    residual_shots: int = 8,
    scan: bool = True,
    scan_above: float | str = "25 %",
    scan_below: float | str = "10 %",
    scan_step: float | str = "2 %",
    assumed_range: bool = False,
    jobs: int = 1,
    executor: str | Executor = "local",
    out: FilePath | None = None,
    **options: Unpack[Keywords],
) -> CriticalVelocityResult:
    """Bisect for the velocity between stop and perforation of a ply or pack, and fit residual velocities.

    Further shots scan the velocities about the bracket. If one stops that is faster than one that perforates, no single
    critical velocity exists: the zone of mixed outcomes is reported, and the result is doubtful. A shot with a quality
    check beyond its limit counts with its outcome, but a limit with such a shot at an end of its bracket or mixed zone
    is not sound: the result says so (`bracket_checks`).

    A fabric is shot at as in the tests of the thesis: one ply of 203 mm, clamped, and a flat cylinder of 3 g and 5.5
    mm. A shot ends with its outcome, so that these keys of an input file are ignored: title,
    projectile.strike_velocity, run.end_time, backing.after_stop, run.snapshot_interval, run.checkpoint_interval,
    run.outputs. [history] and [accuracy] are rejected.

    The folder then holds critical-velocity.json, shots.csv, residual-velocity.svg and scene.toml; after an unstable
    shot only the scene and the shots before it.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or a set-up of `setup`
    tolerance : highest stop and lowest perforation differ by this at most [m/s]
    residual_shots : shots above the limit, for the Lambert-Jonas fit
    scan : whether the velocities about the bracket are scanned for mixed outcomes
    scan_above : range above the highest stop that is scanned for further stops
    scan_below : range below the lowest perforation that is scanned for others
    scan_step : interval between shots of the scan
    assumed_range : where a law of the fabric is assumed, repeat the search with both ends of its range; not of a lay-up
    jobs : shots that run at the same time, as threads of this process
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or the workers of the
        Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    **options : beside a fabric, keywords of `setup` but history

    Returns
    -------
    CriticalVelocityResult

    Raises
    ------
    InputError : as `setup`, or a panel that stops, or does not stop, a projectile at any velocity
    UndecidedError : a shot neither stopped nor perforated
    UnstableError : a shot became unphysical; its attribute `shots` holds those before

    Examples
    --------
    >>> limit = wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="100 mm")
    >>> round(limit.velocity, -1), limit.bracket_checks  # [m/s]
    (90.0, 'ok')
    """
    from shellfabric.impact.limit_scan import ScanRange
    from weavecell.report import checks
    from weavecell.studies import limit as limits

    width, began = quantities.above_zero(tolerance, "m/s", "tolerance"), time.perf_counter()
    shares = {"above": scan_above, "below": scan_below, "step": scan_step}
    with keywords.of_group("scan", shares):
        around = ScanRange(**{key: quantities.number(value, "", f"scan_{key}") for key, value in shares.items()})
    panel = targets.of(target, options, of_commands.LIMITS)
    search: dict[str, Any] = {"residual_shots": residual_shots, "with_range": assumed_range}
    search |= {"tolerance": width, "scan": around if scan else None, "jobs": jobs, "executor": executor}

    @contextmanager
    def stage(title):
        with progress.bar(title) as advance:
            yield lambda share, shot: advance(share, shot and checks.of_shot(shot))

    with targets.folder_of(out) as folder:
        try:
            with panel.named():
                study = limits.search(panel.setup, **search, stage=stage)
        except (UndecidedError, UnstableError) as problem:
            if folder is not None:
                shots = sorted(problem.shots, key=lambda shot: shot.strike_velocity)
                files.write(folder / "shots.csv", limit_result.csv_of(shots))
                if panel.text:
                    files.write(folder / "scene.toml", panel.text)
            raise
        wall_time = time.perf_counter() - began
        result = CriticalVelocityResult(panel, study.limit, study.fit, study.range, search["scan"], wall_time)
        if folder is not None:
            result.save(folder)
    result.warn()
    return result


def v50(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    shots: int = 100,
    batch: int = 10,
    weibull_shape: float | None = None,
    modulus_cov: float | str | None = None,
    crimp_cov: float | str | None = None,
    seed: int = 1,
    jobs: int = 1,
    executor: str | Executor = "local",
    out: FilePath | None = None,
    resume: bool = False,
    **options: Unpack[Keywords],
) -> V50Result:
    """V0, V50 and V100 of plies or packs whose yarns differ in strength, by repeated shots, with intervals.

    Every yarn of every ply is drawn, so that the whole panel is computed, whatever part the input file models. Without
    scatter V50 is the critical velocity. A fabric is shot at as in the tests of the thesis: one ply of 203 mm, clamped,
    and a flat cylinder of 3 g and 5.5 mm. Where no mesh is named, elements are one crossover long near the impact point
    and up to four far off. Of an input file these keys are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] and [accuracy] are
    rejected.

    The folder then holds v50.html, .csv, .json, .png, shots.csv, scene.toml, and runs/, a file for each shot.

    Parameters
    ----------
    target : as of `critical_velocity`
    shots : number of shots, at least 4
    batch : shots of a round, at least 4; each round is placed by the outcomes before
    weibull_shape : Weibull shape of the yarns' strength, inf for yarns that are all alike; here and below that of
        weavecell/studies/inputs.toml where it is not given
    modulus_cov : coefficient of variation of the modulus from panel to panel
    crimp_cov : coefficient of variation of the crimp from panel to panel
    seed : of all that is drawn
    jobs : number of runs in parallel, each in a process of its own
    executor, out : as of `critical_velocity`
    resume : whether to take finished runs from the folder; those of another version of the code are computed again
    **options : beside a fabric, keywords of `setup` but history

    Returns
    -------
    V50Result

    Raises
    ------
    InputError : as `critical_velocity`, fewer than four shots, or yarns that do not fail
    UnstableError : a shot became unphysical

    Examples
    --------
    >>> curve = wc.v50("S-720", shots=8, batch=4, opening="100 mm", elements_per_crossover=1)
    >>> round(curve.v50, -1)  # [m/s]
    80.0
    """
    from weavecell.studies import inputs
    from weavecell.studies import v50 as analysis

    began = time.perf_counter()
    own: dict[str, Any] = {"shape": weibull_shape}
    for key, value in (("modulus", modulus_cov), ("crimp", crimp_cov)):
        own[key] = None if value is None else quantities.number(value, "", f"{key}_cov")
    scatter = replace(inputs.published(), **{key: value for key, value in own.items() if value is not None})
    panel = targets.of(target, options, of_commands.LIMITS)
    with targets.study(panel, f"{panel.title}, repeated shots", out, resume, jobs, executor) as run:
        sizes = {"shots": shots, "batch": batch, "seed": seed}
        study = analysis.study(panel.setup, scatter, **sizes, report=run.report(), **run.runs)
        return run.saved(V50Result(study, panel, seed, batch, time.perf_counter() - began))


def sensitivity(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    velocity: list[float | str] | None = None,
    samples: int = 64,
    seed: int = 1,
    jobs: int = 1,
    executor: str | Executor = "local",
    out: FilePath | None = None,
    resume: bool = False,
    **options: Unpack[Keywords],
) -> SensitivityResult:
    """Sobol indices of the velocity after 200 us and of the peak tension over the uncertainties of the input.

    A fabric is shot at as in the tests of the thesis: one ply, and a flat cylinder of 3 g and 5.5 mm. Of an input file
    these keys are ignored: title, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] and
    [accuracy] are rejected.

    The folder then holds sobol.html, .csv, .json, .png, scene.toml, and runs/, a file for each row.

    Parameters
    ----------
    target : as of `critical_velocity`
    velocity : strike velocity [m/s], may be given again; in Python a list. That of the input file where it is left out,
        or 92.5 and 170 m/s at a fabric
    samples : N, a power of 2; N (inputs + 2) rows are run
    seed : of the sample and of the intervals
    jobs, executor, out, resume : as of `v50`
    **options : beside a fabric, keywords of `setup` but history

    Returns
    -------
    SensitivityResult

    Raises
    ------
    InputError : as `critical_velocity`, or samples that are no power of 2
    UnstableError : a shot became unphysical

    Examples
    --------
    >>> sensitivity = wc.sensitivity("S-720", velocity=["100 m/s"], samples=2, opening="20 mm", end_time="10 us")
    >>> [of.quantity for of in sensitivity.indices]
    ['velocity', 'peak tension']
    """
    from weavecell.studies import sobol

    began = time.perf_counter()
    velocities = [quantities.above_zero(text, "m/s", "velocity") for text in velocity or ()]
    panel = targets.of(target, options, of_commands.SENSITIVITY)
    own = (panel.setup.strike_velocity,) if panel.from_file else targets.STRIKES
    with targets.study(panel, f"{panel.title}, sensitivities", out, resume, jobs, executor) as run:
        sizes = {"samples": samples, "seed": seed}
        indices = sobol.study(panel.setup, velocities or own, **sizes, report=run.report(), **run.runs)
        return run.saved(SensitivityResult(indices, panel, samples, seed, time.perf_counter() - began))
