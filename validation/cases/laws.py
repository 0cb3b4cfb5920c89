"""What laws of yarns and cards are worth in a shot: assumed laws, scatter of strength, cards of other codes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from SALib.analyze.sobol import analyze
from SALib.sample.sobol import sample

import weavecell as wc
from shellfabric.cell import coefficients
from shellfabric.cell.model import CellTable
from shellfabric.cell.surface_cell import potential
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from validation.cases import noses
from validation.values import Values
from weavecell.decks.homogenised import HomogenisedFabric
from weavecell.decks.laws import CrimpExchange, Law, UncoupledCurves
from weavecell.decks.mismatch import Mismatch
from weavecell.runs import table
from weavecell.runs import v50 as analysis
from weavecell.studies import ballistic_limit, inputs, mesh_uncertainty, unknown

LAWS: Values = {"curves (FORM 14)": UncoupledCurves, "LAW58": CrimpExchange}
TABLE = 201
FLOOR = 0.05
# stretches a side of the cell's table: S-720's peaks and velocities are within 0.05 % of those with 201
TABLE_OF_INDICES = 101


def assumed(
    *,
    fabric: str,
    mesh: str = "coarse",
    multiple: float = 1.3,
    tolerance: float = 0.5,
    nose_friction: float | str = noses.THESIS,
) -> Values:
    """Treat a fabric of the catalogue as one of which only the data sheet is known, beside its
    published laws.

    Its compression, trellis and solid laws are taken away, the fibre family's are assumed (`fabrics.families`), and the
    3D crossover yields the compression law and its range.

    Parameters
    ----------
    mesh : of the 3D crossover
    multiple : of the critical velocity with the published laws, at which residual velocities are compared
    tolerance : [m/s] between a stop and a perforation
    nose_friction : [-], or "assumed" (`noses`)

    Returns
    -------
    dict with critical, residual [m/s] with the published laws; `*_range`, `*_nominal` [m/s] with the assumed ones;
    strike [m/s]; a, b and a_range, b_range (soft, stiff) [m, m N^(1/3)]; `*_within`, whether the published value lies
    in the range; `*_ends` {ends of the laws: velocity or outcome}
    """
    own = wc.fabric(fabric)
    search: Values = {"tolerance": tolerance, "residual_shots": 0, "scan": False}

    def strike_at(struck: Any, velocity: float, **law: Any) -> ImpactSetup:
        return noses.with_friction(wc.setup(struck, velocity, **law), nose_friction)

    critical = wc.critical_velocity(strike_at(own, 100.0), **search).critical_velocity
    found = wc.calibrate(replace(own, laws=None, shear=None, solid_laws=None), mesh=mesh)
    assert isinstance(found, wc.CalibrationResult)
    bare = replace(found.fabric, laws=None)
    strike = multiple * critical
    ranges = {
        "critical": find_ends(
            strike_at(bare, 100.0, law=found.law),
            lambda made: wc.critical_velocity(made, **search).critical_velocity,
        ),
        "residual": find_ends(
            strike_at(bare, strike, law=found.law), lambda made: wc.impact(made).residual_velocity
        ),
    }
    residual = wc.impact(strike_at(own, strike)).residual_velocity
    published = {"critical": critical, "residual": residual}
    ends = found.law.assumed_range or ()
    summary: Values = {"strike": strike, "a": found.law.a, "b": found.law.b}
    summary |= {"a_range": [a for a, _ in ends], "b_range": [b for _, b in ends]}
    for name, ends_of in ranges.items():
        velocities = [found for found in ends_of.values() if isinstance(found, float)]
        low, high = min(velocities), max(velocities)
        summary |= {
            name: published[name],
            f"{name}_range": (low, high),
            f"{name}_nominal": ends_of["nominal"],
            f"{name}_within": low <= published[name] <= high,
            f"{name}_ends": ends_of,
        }
    return summary


def find_ends(
    setup: ImpactSetup, compute: Callable[[ImpactSetup], float]
) -> dict[str, float | str]:
    """Compute a velocity [m/s] with each end of each range of what is not known of a set-up, of all together
    that lower it, and that raise it: {words: velocity, or why there is none}."""

    def run(shares: dict[str, float]) -> float | str:
        try:
            return float(compute(unknown.put_all(setup, unknown.ALIKE, shares)))
        except wc.WeavecellError as problem:
            return str(problem)

    nominal = float(compute(setup))
    found: dict[str, float | str] = {"nominal": nominal}
    lower: dict[str, float] = {}
    higher: dict[str, float] = {}
    for name, (row, _) in unknown.find_drawn(setup, unknown.ALIKE).items():
        if not row.of_cloth:
            continue
        ends = {share: run({name: share}) for share in (0.0, 1.0)}
        found |= {f"{name}, {'high' if share else 'low'}": one for share, one in ends.items()}
        known = {one: share for share, one in ends.items() if isinstance(one, float)}
        for chosen, sign in ((lower, -1.0), (higher, 1.0)):
            furthest = max(known, key=lambda one: sign * one, default=None)
            if furthest is not None and sign * (furthest - nominal) > 0:
                chosen[name] = known[furthest]
    found["all that lower it"] = run(lower)
    found["all that raise it"] = run(higher)
    return found


def v50(
    *,
    fabric: str,
    shots: int,
    seed: int = 1,
    weibull_shape: float | None = None,
    modulus_cov: float | None = None,
    crimp_cov: float | None = None,
    **keywords: Any,
) -> Values:
    """Compute the V50 of drawn shots at pinned yarns, of which nothing but the yarns is drawn, beside the limit
    without scatter on the same mesh.

    Parameters
    ----------
    weibull_shape, modulus_cov, crimp_cov : of the scatter; None is that of weavecell/studies/inputs.toml
    keywords : of `weavecell.setup`

    Returns
    -------
    dict with V10, V50, V90, each with its interval of 90 %, and limit, without scatter [m/s]; doubtful, shots with a
    doubtful check
    """
    own = {"shape": weibull_shape, "modulus": modulus_cov, "crimp": crimp_cov}
    given = {key: value for key, value in own.items() if value is not None}
    scatter = replace(inputs.read_scatter(), **given)
    setup = noses.with_friction(wc.setup(fabric, "100 m/s", **keywords))
    with TemporaryDirectory() as folder:
        found = analysis.study(setup, scatter, shots=shots, seed=seed, folder=folder)
    if found.posterior is None:
        raise ValueError(f"all {shots} shots end alike: {found.shots}")
    limit = ballistic_limit.critical_velocity(table.as_fired(setup).target(), tolerance=1.0)
    spans = {name: tuple(span) for name, span in found.posterior.velocities.items()}
    return spans | {"limit": limit.velocity, "doubtful": found.doubtful}


def sobol(*, fabric: str, samples: int, **options: Any) -> Values:
    """Compute Sobol indices, by SALib, of the velocity 200 us after the strike and of the peak
    tension.

    The inputs vary over the ranges of weavecell/studies/inputs.toml, samples (inputs + 2) shots for each velocity.

    Parameters
    ----------
    samples : a power of 2
    options : keywords of `weavecell.setup`

    Returns
    -------
    dict with indices {"VELOCITY, QUANTITY, INPUT": (first order, half the width of its interval, total order, half the
    width)}
    """
    ranges = inputs.table("range")
    bounds = [[1 - entry.low, 1 + entry.high] for entry in ranges.values()]
    problem = {"num_vars": len(bounds), "names": list(ranges), "bounds": bounds}
    factors = sample(problem, samples, calc_second_order=False, seed=1)
    indices = {}
    for velocity in (92.5, 170.0):
        setup = noses.with_friction(wc.setup(fabric, velocity, **options))
        setup = replace(setup, table_size=TABLE_OF_INDICES)
        shots = [inputs.scale_setup(setup, **dict(zip(ranges, row))) for row in factors]
        found = np.array([_velocity_and_tension(shot) for shot in shots])
        for quantity, values in zip(("velocity", "peak tension"), found.T):
            of = analyze(problem, values, calc_second_order=False, num_resamples=1000, seed=1)
            columns = zip(of["S1"], of["S1_conf"], of["ST"], of["ST_conf"])
            for name, column in zip(ranges, columns):
                indices[f"{velocity:g}, {quantity}, {name}"] = column
    return {"indices": indices}


def _velocity_and_tension(setup: ImpactSetup) -> tuple[float, float]:
    """[m/s] 200 us after the strike, or at the end of a shorter shot, and the highest tension of a yarn [N]."""
    result = run_impact(setup)
    velocity = np.interp(200e-6, result.time, np.maximum(result.velocity, 0.0))
    return float(velocity), float(np.max(result.peak_tension))


def law_of_card(setup: ImpactSetup, law: str, match: str) -> Law:
    """Fit the law of a material card, one of LAWS, to the cell of a set-up; `match` of `decks.homogenised.MATCHES`."""
    cell: Any = setup.cell()
    law_of: Law = LAWS[law].fit(HomogenisedFabric(cell), match)
    return law_of


def card_table(setup: ImpactSetup, law: Law) -> CellTable:
    """Tabulate a card's law in place of the cell: its nominal stresses over the range of the cell, none below 0."""
    model: Any = setup.cell()
    x, y = (coefficients.grid(low, high, TABLE) for low, high in model.range())
    N = (
        np.maximum(law.stress(*np.meshgrid(x, y, indexing="ij")), 0.0)
        / HomogenisedFabric(model).smear[:, None, None]
    )
    per = [2 * w * (axis[1] - axis[0]) for w, axis in zip(model.fabric.weave.w, (x, y))]
    floor = np.array([FLOOR * p * yarn.strength for p, yarn in zip(per, model.fabric.weave.yarns)])
    W, fx, fy, residual = potential(N[0] * per[0], N[1] * per[1], floor, np.ones_like(N[0]))
    values = {"T1": N[0], "T2": N[1], "W": W, "N1": fx / per[0], "N2": fy / per[1]}
    # no contact force between yarns: that is not in the law
    return CellTable.of(replace(model, cell_model="decoupled"), x, y, values, fx, fy, residual)


@cache
def _cell(fabric: str, velocity: float, cell: Any) -> tuple[ImpactSetup, CellTable]:
    setup = wc.setup(
        fabric,
        velocity,
        cell_model=cell,
        elements_per_crossover=1,
        end_time=200e-6,
        yarn_failure=False,
    )
    setup = noses.with_friction(setup)
    return setup, setup.table()


def card(
    *, fabric: str, velocity: float, cell: str, law: str = "", match: str = "", finer: bool = False
) -> Values:
    """Fire a shot without failure with the cell, or with the law of a material card, which other
    codes have, in its place.

    Parameters
    ----------
    cell : model of the cell
    law, match : of LAWS, and of `decks.homogenised.MATCHES`; none for the cell
    finer : whether the elements have half the side

    Returns
    -------
    dict with t, v (n,) [s, m/s], deflection [m], peak (warp, weft) [N]
    """
    setup, table = _cell(fabric, velocity, cell)
    if law:
        table = card_table(setup, law_of_card(setup, law, match))
    if finer:
        setup = mesh_uncertainty.finer(setup, table)
    result = run_impact(setup, table=table)
    return {
        "t": result.time,
        "v": result.velocity,
        "deflection": result.max_deflection,
        "peak": result.peak_tension,
    }


def card_error(*, fabric: str, law: str, match: str) -> Values:
    """Compute the errors of a card's law against the cell, over the strength [-]: {name: error} of
    `decks.mismatch.Mismatch`."""
    cell: Any = wc.setup(fabric, "100 m/s").cell()
    homogenised = HomogenisedFabric(cell)
    return {"errors": Mismatch.measure(homogenised, LAWS[law].fit(homogenised, match)).numbers()}
