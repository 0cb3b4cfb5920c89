"""Fabrics and impacts of the Python interface. Quantities are SI numbers, or texts with a unit ("92.5 m/s")."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue
from fabrics.checks import FilePath
from fabrics.errors import InputError, UnstableError
from fabrics.executors import as_done, open_executor
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.api import quantities
from weavecell.api.results import CriticalVelocityResult, ShotResult, SweepResult

if TYPE_CHECKING:
    from shellfabric.impact.pack import PackSetup
    from shellfabric.impact.single_ply import ImpactSetup

__all__ = ["critical_velocity", "fabric", "fabrics", "setup", "shoot", "sweep"]

_CURVE = (1.03, 2.0)  # first and last shot of the residual velocities, times the highest stop or bracket's end


def fabrics() -> tuple[str, ...]:
    """Names of the fabrics of the catalogue, sorted.

    Examples
    --------
    >>> fabrics()[:2]
    ('S-720', 'S-726')
    """
    return catalogue.list_names()


def fabric(name: FilePath, *, linear_density: str = "effective") -> Fabric:
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
    >>> fabric("S-720").name
    'S-720'
    >>> round(1e3 * fabric("S-720", linear_density="nominal").weave.areal_density)  # [g/m2]
    253
    """
    if linear_density not in ("effective", "nominal"):
        raise InputError(key="linear_density", value=linear_density, allowed="effective or nominal")
    return with_linear_density(catalogue.load(name), linear_density)


def setup(
    fabric: Fabric | FilePath, velocity: float | str, *, law: Any = None, projectile: Any = None,
    opening: Any = 0.203, plies: int = 1, stacking: str = "aligned", ply_gap: float | str | None = None,
    ply_friction: float = 0.0,
    end_time: float | str = 800e-6, snapshot_interval: float | str | None = None, **options: Any,
) -> ImpactSetup | PackSetup:  # fmt: skip
    """The set-up of one impact, for `sweep` or `shellfabric`.

    Parameters
    ----------
    fabric : Fabric, or what `weavecell.fabric` takes
    velocity : [m/s] of the strike
    law : compression law of both families, a pair (warp, weft), a law.json or a CalibrationResult; None takes the
        fabric's
    projectile : Projectile, or its fields {"mass": [kg], "diameter": [m], "shape": ..., ...}; None is the flat cylinder
        of 3 g and 5.5 mm
    opening : [m] side of the panel, or (along warp, along weft)
    plies : number
    stacking : "aligned" or "alternating", of a pack
    ply_gap : [m] between plies at rest; None takes the fabric's
    ply_friction : [-] Coulomb's coefficient between plies
    end_time : [s] at the latest
    snapshot_interval : [s] between the shapes for `to_vtk`; None for the last alone
    options : further fields of `shellfabric.impact.single_ply.ImpactSetup` in SI units, such as elements_per_crossover,
        symmetry, edge, weave_angle, backing, history, numerics, cell_model

    Raises
    ------
    InputError : a value that is not allowed, a law that is missing, or an option that does not exist

    Examples
    --------
    >>> setup("S-720", "92.5 m/s", opening="50 mm").opening
    0.05
    """
    from shellfabric.impact.pack import PackSetup
    from shellfabric.impact.single_ply import ImpactSetup

    cloth = assumed.with_shear(as_fabric(fabric))
    unknown = sorted(set(options) - set(ImpactSetup.__dataclass_fields__))
    if unknown:
        known = ", ".join(key for key in ImpactSetup.__dataclass_fields__ if key not in ("fabric", "strike_velocity"))
        raise InputError(key=unknown[0], value=options[unknown[0]], allowed=f"one of {known}")
    if options.get("surface") is None and options.get("cell_model", "compressible") == "compressible":
        options["laws"] = quantities.laws(cloth, options.get("laws") if law is None else law)
    ply = ImpactSetup(
        fabric=cloth, strike_velocity=_above_zero(velocity, "m/s", "velocity"),
        projectile=quantities.projectile(projectile), opening=quantities.lengths(opening, "opening"),
        end_time=_above_zero(end_time, "s", "end_time"),
        snapshot_interval=None if snapshot_interval is None else quantities.number(snapshot_interval, "s", "interval"),
        **options,
    )  # fmt: skip
    if plies == 1:
        return ply
    gap = None if ply_gap is None else quantities.number(ply_gap, "m", "ply_gap")
    return PackSetup(ply, plies, stacking, gap, friction=ply_friction)


def shoot(
    fabric: Fabric | FilePath, velocity: float | str, *, assumed_range: bool = False, **options: Any
) -> ShotResult:
    """Fire a projectile at a panel, in this process.

    A shot that is still in flight at `end_time` is a result with the outcome "in flight".

    Parameters
    ----------
    fabric, velocity, options : as of `setup`
    assumed_range : whether the residual velocity's range over assumed laws is computed: two or four more shots, for one
        ply

    Returns
    -------
    ShotResult

    Raises
    ------
    InputError : as `setup`
    UnstableError : the run became unphysical; its attribute `result` is the ShotResult up to then
    """
    given: Any = setup(fabric, velocity, **options)
    shot, problem = _fire(given)
    if problem:
        error = UnstableError(problem)
        error.result = shot
        raise error
    if assumed_range and options.get("plies", 1) == 1:
        from weavecell.analysis import assumed_range as analysis

        shot = replace(shot, range=analysis.residual_velocity(given, shot.outcome, shot.residual_velocity))
    return shot


def sweep(
    setups: Iterable[ImpactSetup | PackSetup], *, jobs: int = 1, executor: str | Executor = "local"
) -> SweepResult:
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
    SweepResult, in the order of `setups`; an unstable shot has the outcome "unstable"

    Raises
    ------
    InputError : a set-up that cannot be run, jobs below 1, or no such executor
    """
    given = [(each,) for each in setups]
    found: dict[int, ShotResult] = {}
    with open_executor(executor, jobs) as pool:
        for index, (shot, _) in as_done(pool, _fire, given, jobs=jobs):
            found[index] = shot
    return SweepResult(tuple(found[index] for index in range(len(given))))


def _fire(given):
    """(ShotResult, why it became unstable or "") of a set-up."""
    from shellfabric.impact import pack, single_ply
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Shape
    from weavecell.results.pack import PackRecord

    several = isinstance(given, pack.PackSetup)
    ply, problem = given.ply if several else given, ""
    try:
        result = (pack if several else single_ply).run(given)
    except UnstableError as error:
        if error.result is None:
            raise
        result, problem = error.result, str(error)
    title = f"{ply.fabric.name}, {ply.strike_velocity:g} m/s"
    source = (
        "3D response surface" if ply.surface is not None else ply.laws[0].provenance if ply.laws else ply.cell_model
    )
    record = (PackRecord if several else ImpactRecord).of(result, title, source, problem)
    shapes = () if several else tuple(Shape.of(each) for each in result.snapshots)
    return ShotResult(record, shapes, ply.fabric, tuple(assumed.lines(ply.fabric))), problem


def critical_velocity(
    fabric: Fabric | FilePath, *, tolerance: float | str = 1.0, residual_shots: int = 8, scan: bool = True,
    assumed_range: bool = False, jobs: int = 1, executor: str | Executor = "local", **options: Any,
) -> CriticalVelocityResult:  # fmt: skip
    """Bisect for the strike velocity between stop and perforation of one ply.

    With jobs = 1 and the local executor, no process is started; more jobs are threads of this process.

    Parameters
    ----------
    fabric, options : as of `setup`, without velocity and end_time
    tolerance : [m/s] at most between a stop and a perforation
    residual_shots : shots above the limit, for the Lambert-Jonas fit
    scan : whether the velocities about the bracket are scanned for mixed outcomes (`limit_scan`)
    assumed_range : whether the range over assumed laws is computed: two or four more searches
    jobs, executor : as of `shellfabric.impact.ballistic_limit.critical_velocity`

    Returns
    -------
    CriticalVelocityResult

    Raises
    ------
    InputError : as `setup`, or a panel that stops, or does not stop, a projectile at any velocity
    UndecidedError : a shot neither stopped nor perforated
    UnstableError : a shot became unphysical; its attribute `shots` holds those before
    """
    import numpy as np

    from shellfabric.impact import ballistic_limit, lambert_jonas, limit_scan
    from weavecell.analysis import assumed_range as analysis

    if options.get("plies", 1) != 1:
        raise InputError(
            key="plies", value=options["plies"], allowed="1: the critical velocity of a pack is not available"
        )
    given: Any = setup(fabric, 100.0, **options)
    width = _above_zero(tolerance, "m/s", "tolerance")
    panel = given.panel()
    beside: dict[str, Any] = {"jobs": jobs, "executor": executor}
    limit = ballistic_limit.critical_velocity(panel, tolerance=width, **beside)
    if scan:
        limit = limit_scan.scan(panel, limit, **beside)
    if residual_shots:
        strikes = max(limit.high, limit.highest_stop) * np.geomspace(*_CURVE, residual_shots)
        limit = limit_scan.with_shots(limit, ballistic_limit.shoot(panel, strikes, **beside))
    through = [shot for shot in limit.shots if shot.perforated]
    fit = None
    if len(through) > (2 if limit.single else 3):
        velocities = zip(*((shot.strike_velocity, shot.residual_velocity) for shot in through))
        fit = lambert_jonas.fit(*velocities, limit=limit.velocity if limit.single else None)
    around = None
    if assumed_range:
        around = analysis.critical_velocity(given, limit.velocity, tolerance=width, **beside)
    return CriticalVelocityResult(given.fabric, limit, fit, tuple(assumed.lines(given.fabric)), around)


def as_fabric(given: Fabric | FilePath) -> Fabric:
    """A Fabric as it is, or that of a name or file."""
    return given if isinstance(given, Fabric) else fabric(given)


def _above_zero(value, unit, key):
    found = quantities.number(value, unit, key)
    if not found > 0:
        raise InputError(key=key, value=value, allowed="above 0")
    return found
