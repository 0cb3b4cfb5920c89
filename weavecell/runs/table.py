"""Rows of runs: which shots a study fires, and what came of each.

A drawn shot ends once its outcome is known. A projectile that has less than 1 % of its strike energy
left counts as stopped if no yarn has failed while a stress wave went to the edge and back. Were it to
perforate all the same, its residual velocity would be below a tenth of its strike velocity: by
v_r^2 = V^2 - V50^2 it was struck within 0.5 % of the limit.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import nan
from typing import Any

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, UndecidedError, UnstableError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.indicator import OK
from weavecell.studies import ballistic_limit, places, strengths
from weavecell.studies.inputs import Scatter, read_scatter, scale_setup

# share of the strike velocity, see `ballistic_limit.shoot`
STOPS_BELOW = 0.1


@dataclass(frozen=True)
class Draw:
    """Which panel is drawn of all that nobody gave.

    Parameters
    ----------
    scatter : Scatter
    seed, number : which alone determine the panel
    stride : as in `strengths.draw_panel`, of studies whose panels are drawn alike
    """

    scatter: Scatter
    seed: int
    number: int
    stride: int | None = None


@dataclass(frozen=True)
class Row:
    """A shot that is to be fired.

    Parameters
    ----------
    setup : ImpactSetup; its strike velocity is not used
    velocity : [m/s]
    draw : Draw; None takes every value as the set-up has it
    labels : {name: value} of what was varied, which become columns of the table
    """

    setup: ImpactSetup
    velocity: float
    draw: Draw | None = None
    labels: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Shot:
    """What came of a row.

    Parameters
    ----------
    velocity, residual : [m/s]
    perforated : bool
    number : of its draw; -1 without one
    drawn : {column: value} of all that was drawn
    impact_point : (x, y) [m] from the middle of the opening
    weakest : (warp, weft) [-] factor on the strength of the weakest yarn
    deflection : [m] the largest; NaN of a shot that passes
    balance : [-] error of the energy balance over the strike energy
    doubtful : names of the quality checks of the shot that are beyond their limits
    failure : why the shot has no outcome, or ""
    cpu_time : [s] of all its runs, without compiling
    """

    velocity: float
    residual: float
    perforated: bool
    number: int = -1
    drawn: dict[str, float] = field(default_factory=dict)
    impact_point: tuple[float, float] = (0.0, 0.0)
    weakest: tuple[float, float] = (1.0, 1.0)
    deflection: float = nan
    balance: float = nan
    doubtful: tuple[str, ...] = ()
    failure: str = ""
    cpu_time: float = field(default=nan, compare=False)

    @property
    def outcome(self) -> str:
        """ "perforated", "stopped", or "none" of a shot that failed."""
        if self.failure:
            return "none"
        return "perforated" if self.perforated else "stopped"

    @property
    def checks(self) -> str:
        """ "ok", or which of its quality checks are beyond their limits."""
        if not self.doubtful:
            return OK
        return f"doubtful: {', '.join(self.doubtful)}"


def draw(
    setup: ImpactSetup,
    count: int,
    *,
    seed: int = 1,
    velocity: float | None = None,
    scatter: Scatter | None = None,
    **labels: Any,
) -> list[Row]:
    """Draw the rows of shots at panels of which all that nobody gave is drawn.

    Parameters
    ----------
    setup : ImpactSetup
    count : number of rows
    seed : of all that is drawn; rows of one seed and number share what both draw
    velocity : [m/s]; None takes that of the set-up
    scatter : Scatter of yarns and panels; None takes that of inputs.toml
    **labels : what was varied, which become columns of the table

    Raises
    ------
    InputError : as `strengths.check`, or fewer rows than one
    """
    if count < 1:
        raise InputError(key="count", value=count, allowed="at least 1")
    scatter = read_scatter() if scatter is None else scatter
    strengths.check(setup, scatter)
    fired = as_fired(setup)
    speed = setup.strike_velocity if velocity is None else velocity
    return [Row(fired, speed, Draw(scatter, seed, number), labels) for number in range(count)]


def run(rows: Sequence[Row], *, folder: FilePath, **runs: Any) -> list[Shot]:
    """Fire rows, and return a Shot of each, in their order.

    Parameters
    ----------
    rows : of which each is kept by what it is made of, without its labels
    folder, runs : as of `run_cache.results`: of the finished runs; executor, jobs, report
    """
    arguments = [(_plain(row.setup), row.velocity, row.draw) for row in rows]
    return run_cache.results(fire, arguments, folder=folder, **runs)


def fire(setup: ImpactSetup, velocity: float, draw: Draw | None = None) -> Shot:
    """Fire a shot at a drawn panel, or at the panel as it is."""
    # compiling is no part of what a shot costs
    began = time.process_time()
    known: dict[str, Any] = {}
    if draw is None:
        pack = setup.target(setup.table(kept=True))
    else:
        panel = strengths.draw_panel(setup, draw.scatter, draw.seed, draw.number, draw.stride)
        pack = panel.pack
        known = {"number": draw.number, "drawn": panel.values, "weakest": panel.weakest}
    known["impact_point"] = pack.plies[0].impact_point
    try:
        (shot,) = ballistic_limit.shoot(pack, (velocity,), stops_below=STOPS_BELOW)
    # the study goes on without this shot, and counts it
    except (UndecidedError, UnstableError) as problem:
        which = "the shot" if draw is None else f"shot {draw.number} of seed {draw.seed}"
        failure = f"{which}, {velocity:.1f} m/s: {problem}"
        return Shot(velocity, nan, False, **known, failure=failure)
    return Shot(
        velocity,
        shot.residual_velocity,
        shot.perforated,
        **known,
        deflection=shot.deflection,
        balance=shot.balance,
        doubtful=tuple(check.name for check in shot.checks if check.doubtful),
        cpu_time=time.process_time() - began,
    )


def list_drawn(shots: Sequence[Shot]) -> dict[str, list[float | None]]:
    """List what was drawn of shots as columns; None of a shot of which something was given."""
    names = dict.fromkeys(name for shot in shots for name in shot.drawn)
    return {name: [shot.drawn.get(name) for shot in shots] for name in names}


def as_fired(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up that drawn shots model: the whole panel of resolved yarns, unless the input
    pins them, on its mesh."""
    if setup.instead is not None:
        setup = places.resolve(setup)
    return replace(grade_mesh(setup), symmetry="whole")


def grade_mesh(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up with the mesh of a study if it names none: elements of a failure length,
    twice as long as those of a shot, as far as anything can come under the nose of nearly all drawn
    panels, and of four crossovers far from it.

    A pack has the mesh of a shot.
    """
    named = setup.grading is not None or setup.elements_per_crossover is not None
    named = named or setup.crossovers is not None
    if setup.plies > 1 or named:
        return setup
    crimped = replace(setup, symmetry="whole")
    # drawn panels may have more crimp, and draw in more fabric: four deviations cover nearly all
    if setup.surface is None:
        crimp = 1 + 4 * read_scatter().crimp
        crimped = scale_setup(crimped, crimp_warp=crimp, crimp_weft=crimp)
    fine = crimped.graded(1.0, 4)
    return replace(setup, grading=fine.grading, elements_per_crossover=fine.elements_per_crossover)


def _plain(setup):
    """Return a set-up as it is kept: what it records, and its own velocity, change no shot of a
    study."""
    return replace(setup, strike_velocity=1.0, history=None, snapshot_interval=None)
