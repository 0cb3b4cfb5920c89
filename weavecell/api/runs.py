"""Fabrics and impacts of the Python interface. Quantities are SI numbers, or texts with a unit ("92.5 m/s")."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, Unpack

from fabrics import assumed, catalogue
from fabrics import backings as backing_data
from fabrics import projectiles as projectile_data
from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError
from fabrics.executors import as_done, open_executor
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from fabrics.variants import with_linear_density
from weavecell.api import keywords, quantities
from weavecell.api.keywords import Keywords
from weavecell.api.results import CriticalVelocityResult, DrawsResult, ShotResult, SweepResult, V50Result
from weavecell.scenes.schema import InlineLaw
from weavecell.scenes.target import NO_HISTORY

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup

__all__ = [
    "backings",
    "critical_velocity",
    "draws",
    "fabric",
    "fabrics",
    "projectile",
    "projectiles",
    "setup",
    "shoot",
    "sweep",
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
    **changes : keys of [projectile] in the input file that are added to its data or replace them

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
    from weavecell.scenes import build

    own = None if fabric is None else as_fabric(fabric)
    scene = keywords.scene(None if own is None else own.name, velocity, options)
    surface = options.get("surface")

    def made(table, _):
        """Fabric, surface and laws of a table [fabric], with the objects among the keywords in place of their names."""
        named = table.file or (table.name if own is None or table.name != own.name else None)
        law = options.get("law") if table.law == scene.fabric.law and named is None else table.law
        if isinstance(law, InlineLaw) or isinstance(table.law, InlineLaw):
            law = CompressionLaw(table.law.a, table.law.b, table.law.form)
        cloth = build.damaged(assumed.with_shear(as_fabric(named or own)), table)
        cell = build.surface_of(table, cloth, None, surface if isinstance(surface, ResponseSurface) else None)
        laws = quantities.laws(cloth, law) if cell is None and table.cell_model == "compressible" else None
        if scene.panel.plies > 1:
            cloth = build.with_ply_contact(cloth, options.get("ply_contact"), law)
        return cloth, cell, laws, ""

    try:
        cloths, plies = build.lay_up(scene, made)
        cloth, cell, laws, _ = cloths[0]
        ply = build.setup(build.Case("", cloth, laws, "", scene, cell, plies), None)
    except InputError as problem:
        raise keywords.named(problem) from None
    if options.get("snapshot_interval") is None:
        ply = replace(ply, snapshot_interval=None)
    line_of_the_user = next(level for level, frame in enumerate(inspect.stack(0)) if frame.filename != __file__)
    for note in ply.notes:
        warnings.warn(note, stacklevel=line_of_the_user + 1)
    return ply


def shoot(
    fabric: Fabric | FilePath | None, velocity: float | str, *, assumed_range: bool = False, **options: Unpack[Keywords]
) -> ShotResult:
    """Fire a projectile at a panel, in this process.

    A shot that is still in flight at `end_time` is a result with the outcome "in flight". A shot with a quality check
    beyond its limit (docs/reports/checks.md) is `doubtful`, and warns with the category `DoubtfulResult`.

    Parameters
    ----------
    fabric, velocity, **options : as of `setup`
    assumed_range : whether the residual velocity's range over assumed laws is computed: up to eight more shots, for one
        ply

    Returns
    -------
    ShotResult

    Raises
    ------
    InputError : as `setup`
    UnstableError : the run became unphysical; its attribute `result` is the ShotResult up to then

    Examples
    --------
    >>> shot = wc.shoot("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot.outcome, round(shot.residual_velocity)  # [m/s]
    ('in flight', 148)
    """
    given = setup(fabric, velocity, **options)
    shot, problem = _fire(given)
    if problem:
        error = UnstableError(problem)
        error.result = shot
        raise error
    shot.warn()
    if assumed_range and given.plies == 1:
        from weavecell.analysis import assumed_range as analysis

        shot = replace(shot, range=analysis.residual_velocity(given, shot.outcome, shot.residual_velocity))
    return shot


def sweep(setups: Iterable[ImpactSetup], *, jobs: int = 1, executor: str | Executor = "local") -> SweepResult:
    """Fire several shots.

    With jobs = 1 they run in this process one after the other; else in `jobs` processes with one thread each, and the
    script that calls needs the guard `if __name__ == "__main__":`.

    Parameters
    ----------
    setups : of `setup`
    jobs : processes
    executor : as of `fabrics.executors.open_executor`

    Returns
    -------
    SweepResult, in the order of `setups`; an unstable shot has the outcome "unstable". Doubtful shots warn, all in one
    `DoubtfulResult`

    Raises
    ------
    InputError : a set-up that cannot be run, jobs below 1, or no such executor

    Examples
    --------
    >>> setups = [wc.setup("S-720", velocity, opening="20 mm", end_time="10 us") for velocity in (100, 150)]
    >>> [round(shot.residual_velocity) for shot in wc.sweep(setups)]
    [99, 148]
    """
    given = [(each,) for each in setups]
    found: dict[int, ShotResult] = {}
    with open_executor(executor, jobs) as pool:
        for index, (shot, _) in as_done(pool, _fire, given):
            found[index] = shot
    result = SweepResult(tuple(found[index] for index in range(len(given))))
    result.warn()
    return result


def draws(
    setup: ImpactSetup, count: int, *, shape: float | None = None, seed: int = 1,
    folder: FilePath | None = None, jobs: int = 1, executor: str | Executor = "local",
) -> DrawsResult:  # fmt: skip
    """Fire at `count` whole panels or packs, each yarn with a strength of its own.

    Parameters
    ----------
    setup : of `setup`; its symmetry and what it records are not used
    count : number of draws, at least 2
    shape : Weibull shape of the strengths; None takes that of weavecell/analysis/uncertainty/inputs.toml
    seed : of all that is drawn
    folder : where finished draws are kept and taken from; None keeps none
    jobs, executor : as of `sweep`

    Returns
    -------
    DrawsResult; unstable draws count in no estimate

    Raises
    ------
    InputError : a set-up that cannot be run, fewer than two draws, or yarns that do not fail

    Examples
    --------
    >>> found = wc.draws(wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us"), 2, seed=7)
    >>> found.summary()["in_flight"]
    2
    """
    from tempfile import TemporaryDirectory

    from weavecell.analysis.uncertainty import draws as analysis
    from weavecell.analysis.uncertainty import inputs

    scatter = inputs.published() if shape is None else replace(inputs.published(), shape=shape)
    with TemporaryDirectory() as spare:
        kept = spare if folder is None else folder
        found = analysis.study(setup, scatter, count, folder=kept, seed=seed, jobs=jobs, executor=executor)
    return DrawsResult(found)


def _fire(given):
    """(ShotResult, why it became unstable or "") of a set-up."""
    from shellfabric.impact import simulation
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Shape

    result, problem = simulation.fired(given)
    title = f"{given.name}, {given.strike_velocity:g} m/s"
    laws = given.laws[0].provenance if given.laws else given.cell_model
    record = ImpactRecord.of(result, title, "3D response surface" if given.surface is not None else laws, problem)
    shapes = tuple(tuple(map(Shape.of, plies)) for plies in result.snapshots)
    return ShotResult(record, shapes, given.fabric, _assumed(given)), problem


def _assumed(given):
    """Lines that name what is assumed of the fabrics of a set-up."""
    return tuple(line for fabric in given.fabrics for line in assumed.lines(fabric))


def critical_velocity(
    target: Fabric | FilePath | ImpactSetup | None, *, tolerance: float | str = 1.0, residual_shots: int = 8,
    scan: bool = True, assumed_range: bool = False, jobs: int = 1, executor: str | Executor = "local",
    **options: Unpack[Keywords],
) -> CriticalVelocityResult:  # fmt: skip
    """Bisect for the strike velocity between stop and perforation of a ply or pack.

    A shot with a quality check beyond its limit counts with its outcome, but a limit with such a shot at an end of
    its bracket or mixed zone is not sound: the result says so (`bracket_checks`), and warns with `DoubtfulResult`.

    With jobs = 1 and the local executor, no process is started; more jobs are threads of this process.

    Parameters
    ----------
    target, **options : a set-up of `setup`; or a fabric with options, both as of `setup`, without velocity and history.
        A shot ends with its outcome: end_time and snapshot_interval are not used
    tolerance : [m/s] at most between a stop and a perforation
    residual_shots : shots above the limit, for the Lambert-Jonas fit
    scan : whether the velocities about the bracket are scanned for mixed outcomes (`limit_scan`)
    assumed_range : whether the range over assumed laws is computed, up to eight more searches; not of a lay-up
    jobs, executor : as of `shellfabric.impact.ballistic_limit.critical_velocity`

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
    >>> found = wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="100 mm")
    >>> round(found.velocity, -1), found.bracket_checks  # [m/s]
    (90.0, 'ok')
    """
    from shellfabric.impact.limit_scan import ScanRange
    from weavecell.analysis import limit_search

    given = _panel(target, options)
    found = limit_search.search(
        given, tolerance=_above_zero(tolerance, "m/s", "tolerance"), residual_shots=residual_shots,
        scan=ScanRange() if scan else None, with_range=assumed_range, jobs=jobs, executor=executor,
    )  # fmt: skip
    result = CriticalVelocityResult(given.fabric, found.limit, found.fit, _assumed(given), found.range, setup=given)
    result.warn()
    return result


def v50(
    target: Fabric | FilePath | ImpactSetup | None, *, shots: int = 100, batch: int = 10,
    shape: float | None = None, modulus_cov: float | None = None, crimp_cov: float | None = None, seed: int = 1,
    folder: FilePath | None = None, jobs: int = 1, executor: str | Executor = "local", **options: Unpack[Keywords],
) -> V50Result:  # fmt: skip
    """Fire at plies or packs whose yarns differ in strength, and fit the probability of perforation.

    Every yarn of every ply is drawn, so that the whole panel is computed, whatever part the set-up models.

    Parameters
    ----------
    target, **options : as of `critical_velocity`
    shots, batch : how many, and how many at once: each batch is placed by the outcomes before
    shape : Weibull shape of the strengths; None, here and below, takes that of
        weavecell/analysis/uncertainty/inputs.toml; inf for yarns that are all alike
    modulus_cov, crimp_cov : [-] standard deviation over mean from panel to panel
    seed : of all that is drawn
    folder : where finished shots are kept and taken from; None keeps none
    jobs, executor : as of `sweep`

    Returns
    -------
    V50Result

    Raises
    ------
    InputError : as `critical_velocity`, fewer than four shots, or yarns that do not fail
    UnstableError : a shot became unphysical

    Examples
    --------
    >>> found = wc.v50("S-720", shots=8, batch=4, opening="100 mm", elements_per_crossover=1)
    >>> round(found.v50, -1)  # [m/s]
    80.0
    """
    from tempfile import TemporaryDirectory

    from weavecell.analysis.uncertainty import inputs
    from weavecell.analysis.uncertainty import v50 as analysis

    own = {"shape": shape, "modulus": modulus_cov, "crimp": crimp_cov}
    scatter = replace(inputs.published(), **{key: value for key, value in own.items() if value is not None})
    given = _panel(target, options)
    with TemporaryDirectory() as spare:
        kept = spare if folder is None else folder
        found = analysis.study(
            given, scatter, shots=shots, batch=batch, seed=seed, folder=kept, jobs=jobs, executor=executor
        )
    return V50Result(found)


def _panel(target: Any, options: Any) -> ImpactSetup:
    """The set-up of a target of shots that end with their outcome."""
    from shellfabric.impact.simulation import ImpactSetup

    if isinstance(target, ImpactSetup):
        for key in options:
            raise InputError(key=key, allowed="left out beside a set-up, which has it")
        return target
    if options.get("history") is not None:
        raise InputError(key="history", allowed=NO_HISTORY["history"])
    return setup(target, 100.0, **options)


def as_fabric(given: Fabric | FilePath) -> Fabric:
    """A Fabric as it is, or that of a name or file."""
    return given if isinstance(given, Fabric) else fabric(given)


def _above_zero(value, unit, key):
    found = quantities.number(value, unit, key)
    if not found > 0:
        raise InputError(key=key, value=value, allowed="above 0")
    return found
