"""Shots and critical velocities: a case has the keywords of `weavecell.setup`, and a few that no input file has."""

from __future__ import annotations

import inspect
import time
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from math import inf, log1p, nan, pi, sqrt
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

import weavecell as wc
from fabrics import metals, ply_laws
from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.fabric import Fabric
from fabrics.materials import Isotropic
from fabrics.pattern import Pattern
from fabrics.variants import scale_laws, scale_yarns, with_failure_length
from shellfabric.impact.run import run_impact, run_impact_or_partial
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies.model import PlyContact
from shellfabric.projectile.bar import Bar
from validation.cases import noses
from validation.models import variants
from validation.models.ply_crossings import plies_cross
from validation.values import Values, flags, rms
from weavecell.results.impact import ImpactRecord
from weavecell.results.wave_fronts import fronts
from weavecell.studies import ballistic_limit, lambert_jonas, mesh_uncertainty, pack_limit, shot_row
from weavecell.studies.window import QUANTITIES, Window

if TYPE_CHECKING:
    from fabrics.metals import Metal
    from shellfabric.impact.result import ImpactResult
    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.projectile.projectile import Projectile

STRAIGHT = (
    0.9  # least coefficient of determination of a line whose slope is called a speed of a wave
)
SLIPPED = 50e-6  # [m] from which on a yarn counts as slipped
VISCOUS = "viscous energy"  # the indicator of `quality`
NOT_IN_A_FILE = ("table_size", "packed_area", "audit_interval")  # fields of ImpactSetup


@dataclass(frozen=True)
class Unchecked(Numerics):
    """Numerics that nobody checks: a map has to go where the code refuses to."""

    def __post_init__(self):
        pass


@dataclass(frozen=True)
class UncheckedContact(PlyContact):
    """The same of the contact between plies."""

    def __post_init__(self):
        pass


def changed(
    fabric: Fabric,
    *,
    size: float = 1.0,
    mass: float = 1.0,
    yarns: Mapping[str, float] | None = None,
    law: str = "regularised",
    crossovers: int = 1,
    straight: bool = False,
    failure_length: float | None = None,
    pattern: str = "",
) -> Fabric:
    """Change a fabric for comparison.

    Parameters
    ----------
    size, mass : of all lengths of the weave, and of the yarns' linear density, over those of the fabric; closures of
        the compression laws grow with the size, forces with the mass of a yarn's length
    yarns : {field of Yarn: factor} of all yarns
    law : form of the compression laws, "regularised" or "printed"
    crossovers : along each side, for which one of thicker yarns stands (`variants.homogenised`)
    straight : whether the yarns have next to no crimp
    failure_length : [m]
    pattern : of the weave in which the same yarns cross, with the same crimps
    """
    factors = {"linear_density": mass} | dict(yarns or {})
    fabric = scale_yarns(fabric, **factors)
    weave = fabric.weave
    gap = fabric.interlayer_gap
    fabric = replace(
        scale_laws(fabric, size, size * mass ** (1 / 3)),
        weave=replace(
            weave, warp_count=weave.warp_count / size, weft_count=weave.weft_count / size
        ),
        interlayer_gap=gap and size * gap,
    )
    if law != "regularised":
        fabric = variants.with_law_form(fabric, law)
    if straight:
        fabric = fabric.with_yarns(crimp=variants.NEARLY_STRAIGHT)
    if failure_length is not None:
        fabric = with_failure_length(fabric, failure_length)
    if pattern:
        fabric = variants.with_pattern(fabric, Pattern.read(pattern))
    if crossovers > 1:
        fabric = variants.homogenised(fabric, crossovers)
    return fabric


def setup(
    fabric: str | None = None,
    velocity: float | str = 100.0,
    *,
    change: Values | None = None,
    mesh: str = "default",
    resolved: float | None = None,
    longest: int = 2,
    bar_of: str | None = None,
    unchecked: Values | None = None,
    contact: Values | None = None,
    ply_points: int | None = None,
    pinned_zone: bool = False,
    nose_friction: float | str = noses.THESIS,
    whole_zone: bool = False,
    **keywords: Any,
) -> ImpactSetup:
    """Build the set-up of a shot.

    Parameters
    ----------
    fabric : name, or None where each of `ply` has its own
    velocity : [m/s]
    change : keywords of `changed`
    mesh : "default", "finer", with half of its element side about the impact point, or "coarser", with one element per
        crossover
    resolved, longest : of `ImpactSetup.graded`, the default's rule with other elements; None takes `mesh`
    bar_of : metal of an elastic-plastic bar along the axis (`as_bar`), in place of a rigid projectile
    unchecked : fields of Numerics, which are not checked
    contact : fields of PlyContact, which are not checked; plies then press on each other as solid fibre
    ply_points : contact points between plies along each side of an element, with the laws of the fabrics
    pinned_zone : whether the crossings of resolved yarns are pinned: their friction is infinite
    nose_friction : [-] where `projectile` gives none, or "assumed" (`noses`)
    whole_zone : whether all yarns of the panel are resolved
    keywords : of `weavecell.setup`, and NOT_IN_A_FILE; one thread, where none is given
    """
    struck: Any = fabric
    if change and fabric is not None:
        struck = changed(wc.fabric(fabric), **change)
    own = {name: keywords.pop(name) for name in NOT_IN_A_FILE if name in keywords}
    if (
        contact is not None
    ):  # other laws reach the stiffness that bounds the step only at high pressures
        own |= {"contact": UncheckedContact(**contact)}
        keywords["ply_contact"] = ply_laws.solid_fibre(wc.fabric(str(fabric)))
    keywords["numerics"] = {"threads": 1} | keywords.get("numerics", {})
    with warnings.catch_warnings(action="ignore"):  # notes of openings that follow yarns
        made = replace(wc.setup(struck, velocity, **keywords), **own)
    made = noses.with_friction(made, nose_friction)
    if ply_points is not None:
        made = replace(made, contact=PlyContact(points=ply_points))
    if bar_of is not None:
        body = as_bar(made.projectile, metals.load(bar_of), made.strike_velocity)
        made = replace(made, projectile=replace(made.projectile, body=body))
    if unchecked is not None:
        given = {entry.name: getattr(made.numerics, entry.name) for entry in fields(Numerics)}
        made = replace(made, numerics=Unchecked(**given | dict(unchecked)))
    if pinned_zone:
        made = replace(made, crossovers=replace(made.crossovers, friction=inf))
    if whole_zone:
        made = replace(made, crossovers=made.crossovers.whole)
    if resolved is not None:
        return made.graded(resolved, longest)
    if mesh == "coarser":
        return replace(made, elements_per_crossover=1)
    if mesh == "finer":
        return mesh_uncertainty.finer(made, made.plain_table())
    return made


def as_bar(projectile: Projectile, metal: Metal, velocity: float) -> Bar:
    """Make the bar of a metal that has mass and diameter of a projectile.

    A bar hardens linearly and has no effect of the rate: its flow stress is that at the rate which is the velocity
    [m/s] over the diameter.
    """
    area = pi * projectile.radius**2
    rate = velocity / (2 * projectile.radius)
    faster = 1 + metal.rate_coefficient * log1p(rate / metal.reference_rate)
    material = Isotropic(
        metal.density,
        metal.modulus,
        metal.poisson,
        yield_stress=faster * metal.yield_stress,
        hardening=faster * metal.hardening,
    )
    return Bar(((projectile.mass / (metal.density * area), area),), material)


def shot(*, crossings: bool = False, unfailing: bool = False, **keywords: Any) -> Values:
    """Fire one shot: keys of its summary.json, histories, and what only studies read.

    Parameters
    ----------
    unfailing : whether yarns do not fail, with the cell's table of yarns that do
    crossings : whether plies that cross are looked for at each sample
    keywords : of `setup`

    Returns
    -------
    dict with all keys of summary.json; t, v, z, force and absorbed (n,) [s, m/s, m, N, J]; energies {name: (n,)} [J];
    peak (warp, weft) [N] of one yarn; strength (warp, weft) [N]; flags, the indicators beyond their limits; kinetic
    [-], the mean of kinetic over stored energy of the fabric in the last half of the shot; fronts {kind family: [m/s]};
    torn_plies, with a cut yarn at the end;
    cpu_s [s] of table and run;
    slip_*, place_* (k,) [m] of the ends of the yarns along the clamps; crossings, 1 if plies cross at a sample;
    force_peak, force_jumps [N] (`rough`)
    """
    this = setup(**keywords)
    crossing = [0]
    hooks: tuple[Any, ...] = ()
    if crossings:
        hooks = (lambda solver: crossing.append(int(plies_cross(solver))),)
    began = time.process_time()
    table = this.table()
    result = run_impact(
        replace(this, yarn_failure=this.yarn_failure and not unfailing), hooks=hooks, table=table
    )
    return {"cpu_s": time.process_time() - began, "crossings": max(crossing)} | found(
        result, keywords
    )


def found(result: ImpactResult, keywords: Values) -> Values:
    """Return the dict of `shot`."""
    yarns = dict(keywords.get("change") or {}).get("crossovers", 1)
    energies = result.energies
    late = result.time > 0.5 * result.time[-1]
    stored = energies["yarn_strain"] + energies["shear"]
    late &= stored > 0
    kinetic = nan
    if late.any():
        kinetic = float(np.mean(energies["kinetic_fabric"][late] / stored[late]))
    speeds = {
        f"{front.kind} {front.family}": front.speed if front.r2 >= STRAIGHT else nan
        for history in result.measured[:1]
        for front in fronts(history)
    }
    return (
        ImpactRecord.from_result(result, "", "").facts()
        | ends(result)
        | rough(result.step_history)
        | {
            "t": result.time,
            "v": result.velocity,
            "z": result.nose_position,
            "force": result.contact_force,
            "absorbed": result.strike_energy - energies["kinetic_projectile"],
            "energies": energies,
            "peak": np.array(result.peak_tension) / yarns,
            "fronts": speeds,
            "strength": np.array(result.panel.strengths),
            "flags": flags(result.checks),
            "kinetic": kinetic,
            "torn_plies": int(np.count_nonzero(result.plies["cut_yarns"][-1])),
        }
    )


def ends(result: ImpactResult) -> Values:
    """Measure how far the ends of the yarns of a quarter panel of one ply have come in, and where
    they are along the clamps."""
    panel = result.panel
    if panel.symmetry != "quarter" or len(result.panels) > 1:
        return {}
    X, Y = panel.coordinates()
    nodes = result.last[0].nodes
    found: Values = {
        "slip_warp": X[-1] - nodes[-1, :, 0],
        "slip_weft": Y[:, -1] - nodes[:, -1, 1],
    }
    found |= {"place_warp": Y[-1], "place_weft": X[:, -1]}
    for family in ("warp", "weft"):
        moved = found[f"place_{family}"][found[f"slip_{family}"] > SLIPPED]
        found[f"width_{family}"] = 2 * float(moved.max(initial=0.0))
    return found


def rough(history: np.ndarray, until: float = 100e-6) -> dict[str, float]:
    """Measure how the force on the projectile jumps: the highest mean over 2 us, and the rms of its
    difference from the mean over 20 us up to a time [s]."""
    t = history[:, 0]
    force = -history[:, 3]
    if len(t) < 3 or t[-1] < 20e-6:
        return {}
    smooth, slow = (
        np.convolve(force, np.ones(n) / n, "same")
        for n in (max(1, round(w / (t[1] - t[0]))) for w in (2e-6, 20e-6))
    )
    return {
        "force_peak": float(smooth.max()),
        "force_jumps": rms((smooth - slow)[t < until]),
    }


def stepped(*, cfl: float, neighbours: int = 1, **keywords: Any) -> Values:
    """Fire a shot with a time step over its bound.

    Without viscosity crimped yarns ring, and their peaks are an extreme of chance: there an answer is the median over
    some `neighbours`, steps each 1 % of the longest apart, which is the one that counts.

    Raises
    ------
    UnstableError : a run that loses energy in its steps, which `run_impact` makes again with a shorter one
    """
    own = dict(keywords.pop("unchecked", {}))
    steps = [cfl * (1 - 0.01 * n) for n in range(neighbours)]
    runs = [shot(unchecked=own | {"cfl": dt}, **keywords) for dt in steps]
    shortened = [run["step_factor"] for run in runs if run["step_factor"] < 1.0]
    if shortened:
        # its answer is of another step than the one that is asked about
        raise UnstableError(f"made again with {min(shortened):g} of the time step")
    peak = np.median([run["peak"] for run in runs], axis=0)
    velocity = median(float(run["v"][-1]) for run in runs)
    return runs[0] | {"peak": peak, "v": np.array([velocity]), "neighbours": neighbours}


def limit(
    *,
    tolerance: float = 1.0,
    guess: float | None = None,
    step: float = ballistic_limit.STEP,
    multiples: Sequence[float] = (),
    **keywords: Any,
) -> Values:
    """Find the critical velocity, and residual velocities above it.

    Parameters
    ----------
    tolerance, guess, step : of `ballistic_limit.critical_velocity`
    multiples : of the critical velocity, at which shots are fired; a and p of Lambert and Jonas are fitted to them
    keywords : of `setup`

    Returns
    -------
    dict with low, high, critical, half_width [m/s]; shots; error [-], the largest of the energy balance over the strike
    energy; cut_yarns of the slowest perforation; strikes, residuals [m/s], a, p with their intervals and rms [m/s] of
    the fit; v50, v50_low, v50_high [m/s] by all shots (`pack_limit`), not a number of too few perforations; flags of
    the bracket's shots
    """
    this = setup(**keywords)
    target = this.target(this.table(kept=True))
    bracket = ballistic_limit.critical_velocity(target, tolerance=tolerance, guess=guess, step=step)
    slowest = min(
        (one for one in bracket.shots if one.perforated), key=lambda one: one.strike_velocity
    )
    beyond = {check.name for one in bracket.ends for check in one.checks if not check.ok}
    summary = {
        "low": bracket.low,
        "high": bracket.high,
        "critical": bracket.velocity,
        "half_width": bracket.half_width,
        "shots": len(bracket.shots),
        "error": max(one.balance for one in bracket.shots),
        "flags": ", ".join(sorted(beyond)),
        "cut_yarns": slowest.cut_yarns,
    }
    if not multiples:
        return summary
    shots = ballistic_limit.shoot(target, [one * bracket.velocity for one in multiples])
    strikes = np.array([one.strike_velocity for one in shots])
    residuals = np.array([one.residual_velocity for one in shots])
    passed = np.array([one.perforated for one in shots])
    fit = lambert_jonas.fit(strikes[passed], residuals[passed], limit=bracket.velocity)
    v50 = pack_limit.of_shots(bracket.shots + shots)
    return summary | {
        "v50": v50.velocity if v50 else nan,
        "v50_low": v50.low if v50 else nan,
        "v50_high": v50.high if v50 else nan,
        "strikes": strikes.tolist(),
        "residuals": residuals.tolist(),
        "a": fit.a,
        "p": fit.p,
        "a_interval": fit.intervals["a"],
        "p_interval": fit.intervals["p"],
        "rms": fit.residual_rms,
    }


def perforated(velocities: Sequence[float], **keywords: Any) -> list[bool]:
    """Fire shots at velocities [m/s] with the keywords of `limit`, in place of its search: whether each perforates."""
    of_search = {*inspect.signature(limit).parameters} - {"keywords"}
    this = setup(**{key: value for key, value in keywords.items() if key not in of_search})
    shots = ballistic_limit.shoot(this.target(this.table(kept=True)), velocities)
    return [one.perforated for one in shots]


def first_failure(
    *, low: float, high: float, share: float = 0.006, end_time: float = 500e-6, **keywords: Any
) -> Values:
    """Find the lowest strike velocity at which a yarn fails: unlike a limit, it does not rest on
    what torn fabric does.

    Parameters
    ----------
    low, high : [m/s] at which no yarn fails, and one does
    share : width of the bracket over its lower end
    end_time : [s] of a shot in which none fails
    keywords : of `setup`

    Returns
    -------
    dict with velocity and half_width [m/s], error [-], the largest of the energy balance over the
    strike energy until then

    Raises
    ------
    InputError : yarns that fail at `low`, or do not at `high`
    UnstableError : as the solver
    """
    this = setup(**keywords)
    target = this.target(this.table(kept=True))
    worst = 0.0

    def fails(velocity):
        nonlocal worst
        solver = PackSolver(target, velocity, end_time, interval=this.audit_interval)
        with suppress(YarnFailed):
            solver.run([end_at_a_failure])
        worst = max(worst, float(np.abs(solver.sample("error")).max()) / solver.strike_energy)
        return any(state.failed_segments for state in solver.states)

    if fails(low) or not fails(high):
        allowed = (
            f"a velocity [m/s] at which no yarn fails, and below {high:g} one at which one does"
        )
        raise InputError(key="low", value=low, allowed=allowed)
    while high / low > 1 + share:
        middle = sqrt(low * high)
        if fails(middle):
            high = middle
        else:
            low = middle
    return {"velocity": 0.5 * (low + high), "half_width": 0.5 * (high - low), "error": worst}


class YarnFailed(Exception):
    """The first yarn of a shot has failed."""


def end_at_a_failure(solver: PackSolver) -> None:
    """End a run whose yarns have begun to fail: a hook.

    Raises
    ------
    YarnFailed : once a segment has failed
    """
    if any(state.failed_segments for state in solver.states):
        raise YarnFailed


def means(*, velocity: float, factors: Sequence[float], **keywords: Any) -> Values:
    """Compute means over a window of strike velocities about one (`weavecell.studies.window`).

    Parameters
    ----------
    velocity : [m/s] in the middle
    factors : on it, of the shots
    keywords : of `setup`; and `search`, those of `limit` alone

    Returns
    -------
    dict with (mean, standard error) of residual_velocity, absorbed_energy, cut_yarns; not_perforated; elements; cpu [s]
    of a shot, the median; viscous [-], the largest share of viscous energy; with `search` critical and half_width [m/s]
    """
    search = keywords.pop("search", None)
    rows = []
    costs = []
    shares = []
    for factor in factors:
        this = setup(
            velocity=round(factor * velocity, 3), end_time=ballistic_limit.UNDECIDED, **keywords
        )
        table = this.table(kept=True)
        began = time.process_time()
        result, problem = run_impact_or_partial(this, table=table)
        costs.append(time.process_time() - began)
        shares.append(next(check.value for check in result.checks if check.name == VISCOUS))
        rows.append(
            {"strike_velocity_m_s": this.strike_velocity} | shot_row.row_of(result, problem)
        )
    of_window = Window(velocity, tuple(rows))
    summary: Values = {name: of_window.mean(name) for name in QUANTITIES} | {
        "not_perforated": len(rows) - of_window.outcomes["perforated"],
        "cpu": median(costs),
        "viscous": max(shares),
        "elements": sum(panel.elements for panel in result.panels),
    }
    if search is None:
        return summary
    try:
        bracket = limit(**search, **keywords)
        return summary | {name: bracket[name] for name in ("critical", "half_width")}
    except (UnstableError, UndecidedError) as problem:
        return summary | {"critical": nan, "half_width": nan, "undecided": str(problem)}
