"""Ranges of residual and critical velocity that follow from what is assumed.

Laws, crimp, failure length and numbers of a fabric are assumed with a range (`fabrics.assumed`),
and what a set-up assumes besides (`inputs.ranges`). The shot, or the search of the critical
velocity, is repeated with each end of each, one at a time, and with all ends together that lower
the velocity, or raise it. The range is the envelope of these runs and the nominal one, and no
bound, since the outcome need not be monotonic. The share of an assumption is the width of its own
runs over the sum of these widths.

What is assumed besides the fabric follows from the set-up: strength after weaving, unless
`weaving_damage` gives it, since yarns are tested before; friction of the projectile, of plies where
there are several, the force of clamps in which yarns slip, and in packs the area that packed fabric
keeps, what plies give back, and the gap between them. Rigid clamps stay: slip is another model, not the end of a range.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from functools import partial, reduce
from itertools import pairwise
from typing import Any

from fabrics import assumed, data_sheet
from fabrics.base import run_cache
from fabrics.base.assumed_number import is_assumed
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError, UnstableError, WeavecellError
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.boundary import Grip
from shellfabric.membrane.indicator import DOUBTFUL, status
from shellfabric.plies.gap import gap_between
from shellfabric.plies.numerics import PlyContact
from weavecell.studies import inputs
from weavecell.studies.mover import Mover

Ends = dict[str, dict[str, Callable[[ImpactSetup], ImpactSetup]]]
GAP = "gap between plies"
# the search begins at the nominal limit, so its first step is small
NEXT_STEP = 1.05


@dataclass(frozen=True)
class VariedRun:
    """One run: laws and outcome in words, velocity [m/s] or None, and what was varied, "" of
    several or nothing."""

    laws: str
    outcome: str
    velocity: float | None
    varied: str = ""


@dataclass(frozen=True)
class AssumedRange:
    """Range of a velocity over the assumed laws.

    Parameters
    ----------
    quantity : "residual velocity" or "critical velocity"
    rows : tuple of VariedRun, the nominal run first
    """

    quantity: str
    rows: tuple[VariedRun, ...]

    @property
    def widths(self) -> dict[str, tuple[float, float]]:
        """{what is assumed: (lowest, highest) [m/s] of the nominal run and its own}, the widest
        first."""
        nominal = self.rows[0].velocity
        ranges = dict[str, tuple[float, float]]()
        for row in self.rows:
            if row.varied and row.velocity is not None and nominal is not None:
                low, high = ranges.get(row.varied, (nominal, nominal))
                ranges[row.varied] = min(low, row.velocity), max(high, row.velocity)
        return dict(sorted(ranges.items(), key=lambda item: item[1][0] - item[1][1]))

    @property
    def shares(self) -> dict[str, float]:
        """{what is assumed: [-] its width over the sum of all widths}, the largest first."""
        widths = {name: high - low for name, (low, high) in self.widths.items()}
        return {name: width / (sum(widths.values()) or 1.0) for name, width in widths.items()}

    @property
    def _ordered(self):
        """[(velocity [m/s], laws)] of the runs that have a velocity, the lowest first."""
        return sorted((row.velocity, row.laws) for row in self.rows if row.velocity is not None)

    @property
    def low(self) -> float:
        """[m/s]"""
        return self._ordered[0][0]

    @property
    def high(self) -> float:
        """[m/s]"""
        return self._ordered[-1][0]

    @property
    def movers(self) -> tuple[Mover, ...]:
        """What moves the velocity, and what tells it."""
        return tuple(
            Mover(name, f"measure {name}", high - low) for name, (low, high) in self.widths.items()
        )

    @property
    def span(self) -> str:
        """The range in words."""
        return f"{self.low:.3g} to {self.high:.3g} m/s"

    @property
    def over_friction_between_yarns(self) -> str:
        """The interval over the friction between resolved yarns, which answers rest on first; "" if it
        was not varied."""
        name = inputs.FRICTION_OF_CROSSOVERS
        if name not in self.widths:
            return ""
        low, high = self.widths[name]
        # each run names the friction that it had
        ends = [float(row.laws.removeprefix(name)) for row in self.rows if row.varied == name]
        over = f"friction between yarns of {min(ends):g} to {max(ends):g}"
        return f"{over}, which is assumed: {low:.1f} to {high:.1f} m/s"

    def words(self) -> str:
        """Write the range in one line, with the interval over the friction between yarns first."""
        outcomes = sorted({row.outcome for row in self.rows if row.outcome})
        shares = ", ".join(f"{name} {100 * share:.0f} %" for name, share in self.shares.items())
        over = f"over the assumed ranges (shares: {shares})"
        if outcomes == ["stopped"]:
            return f"stopped in all {counted(len(self.rows), 'run')} over the assumed ranges ({', '.join(self.shares)})"
        more = ""
        if outcomes:
            more = f"; {' or '.join(outcomes)}"
        _, lowest = self._ordered[0]
        _, highest = self._ordered[-1]
        first = self.over_friction_between_yarns
        if first:
            first += "; "
        return (
            f"{first}{self.quantity} {self.low:.1f} to {self.high:.1f} m/s {over}; lowest: {lowest}; "
            f"highest: {highest}{more}"
        )

    def summary(self) -> dict:
        """Return the range as plain types."""
        names = ("laws", "outcome", "velocity_m_s", "varied")
        return {
            "quantity": self.quantity,
            "shares": self.shares,
            "low_m_s": self.low,
            "high_m_s": self.high,
            "runs": [dict(zip(names, astuple(row))) for row in self.rows],
        }


def with_ends(setup: ImpactSetup, choice: bool | str) -> ImpactSetup | None:
    """Return the set-up whose range is computed, None if none is, by a choice of True, False and
    "laws": if more is assumed of the fabric than its failure length; InputError: another choice."""
    if choice not in (True, "laws", False):
        raise InputError(key="assumed_range", value=choice, allowed='True, False or "laws"')
    if not choice:
        return None
    names = set(changes(setup))
    if choice == "laws":
        # what others measured is no assumption
        names = set(changes(_change_each_ply(_without_measured, None, setup)))
        # these are assumed of nearly every set-up, so they alone do not start a range
        names -= {"failure length", GAP, *inputs.ranges()}
    if names:
        return setup
    return None


def searches(setup: ImpactSetup) -> int:
    """Count the runs over all that is assumed: each end alone, and the ends that lower or raise the
    velocity."""
    alone = sum(map(len, changes(setup).values()))
    if not alone:
        return 0
    return alone + 2


def changes(setup: ImpactSetup) -> Ends:
    """Collect {what is assumed: {words: change of a set-up to this end}}, in the order in which
    ends may be combined.

    Parameters
    ----------
    setup : ImpactSetup, its fabric completed by `fabrics.assumed`; its laws carry the range of an
        assumed solid law
    """
    return _moving(setup, _both_ends(setup))


def _moving(setup, ends):
    """The ends that change a set-up: a number may lie at an end of its range."""
    moving = {}
    for name, of_one in ends.items():
        kept = {words: change for words, change in of_one.items() if change(setup) != setup}
        if kept:
            moving[name] = kept
    return moving


def _both_ends(setup):
    """As `changes`, with the ends that change nothing: of all set-ups the first is low, the second
    high."""
    ends_of: dict[str, dict[str, Any]] = {}
    for fabric in setup.fabrics:
        for name, ends in assumed.ends(fabric).items():
            change = partial(_change_each_ply, partial(_with_end, name))
            ends_of.setdefault(name, {w: partial(change, k) for k, w in enumerate(ends)})
    # a law that was fitted to a given solid has no ends
    ends_of["solid law"] = {
        "yarns soft": partial(_change_each_ply, _with_laws, "soft"),
        "yarns stiff": partial(_change_each_ply, _with_laws, "stiff"),
    }
    for name, entry in inputs.ranges(*setup.fabrics).items():
        if is_given(setup, name):
            continue
        ends_of[name] = {
            f"{name} {end:g}": partial(set_value, name=name, value=end)
            for end in (entry.low, entry.high)
        }
    gaps = {}
    for words, field in (("plies in touch", "low"), ("wide gaps between plies", "high")):
        change = partial(_with_gaps, field)
        if change(setup) != _with_gaps("value", setup):
            gaps[words] = change
    if gaps:
        ends_of[GAP] = gaps
    return ends_of


def _change_each_ply(change, end, setup):
    """The set-up with change(ply, end) of itself and of every ply of its lay-up."""
    return change(replace(setup, lay_up=tuple(change(ply, end) for ply in setup.lay_up)), end)


def _without_measured(ply, _):
    """A ply whose fabric has ranges of what is assumed alone."""
    return replace(ply, fabric=assumed.without_ranges_of_measured(ply.fabric))


def _with_end(name, ply, number):
    """A ply with the first or the second end of what its fabric assumes of this name, if it
    does."""
    ends = list(assumed.ends(ply.fabric).get(name, {}).values())
    if ends:
        return replace(ply, fabric=ends[min(number, len(ends) - 1)])
    return ply


def _with_laws(ply, end):
    """A ply with one end of the ranges of its laws, where they have any."""
    laws = ply.laws or ()
    return replace(ply, laws=tuple((law.ends() or {end: law})[end] for law in laws) or None)


def _with_gaps(end, setup):
    """The set-up with one end of the range of each gap between plies that nobody gave
    (`PlyGap`)."""
    if setup.lay_up:
        plies = list(setup.lay_up)
        for number, (front, rear) in enumerate(pairwise(setup.lay_up)):
            if front.gap is None:
                gap = getattr(gap_between(front.fabric, rear.fabric), end)
                plies[number] = replace(front, gap=gap)
        return replace(setup, lay_up=tuple(plies))
    if setup.plies == 1 or setup.ply_gap is not None:
        return setup
    return replace(setup, ply_gap=getattr(gap_between(setup.fabric, setup.fabric), end))


def set_value(setup: ImpactSetup, name: str, value: float) -> ImpactSetup:
    """Return the set-up with a value of one of `inputs.ranges`; as it is where it does not assume
    it."""
    match name:
        case data_sheet.STRENGTH_AFTER_WEAVING if setup.yarn_failure and not setup.surface:
            return _change_each_ply(_with_woven_strength, value, setup)
        case data_sheet.FRICTION_OF_PROJECTILE:
            return replace(setup, projectile=replace(setup.projectile, friction=value))
        case data_sheet.FRICTION_BETWEEN_PLIES if setup.plies > 1:
            return replace(setup, ply_friction=value)
        case "area of packed fabric" if setup.plies > 1:
            return replace(setup, packed_area=value)
        case "energy given back by plies" if setup.plies > 1:
            contact = setup.contact or PlyContact()
            return replace(setup, contact=replace(contact, resilience=value))
        case inputs.FRICTION_OF_CROSSOVERS if setup.crossovers is not None:
            return replace(setup, crossovers=replace(setup.crossovers, friction=value))
        case _ if name in inputs.OF_RESOLVED_YARNS and setup.crossovers is not None:
            field, _ = inputs.OF_RESOLVED_YARNS[name]
            changed: dict[str, Any] = {field: value}
            return replace(setup, crossovers=replace(setup.crossovers, **changed))
        case "clamp force":
            return replace(setup, boundary=_scale_clamp_force(setup.boundary, value))
    return setup


def is_given(setup: ImpactSetup, name: str) -> bool:
    """Tell whether the set-up has a number of the user's own in place of what is assumed by this
    name: a measured friction is not varied."""
    number: float | None
    match name:
        case data_sheet.FRICTION_OF_PROJECTILE:
            number = setup.projectile.friction
        case data_sheet.FRICTION_BETWEEN_PLIES:
            number = setup.ply_friction
        case "area of packed fabric":
            number = setup.packed_area
        case "energy given back by plies":
            number = (setup.contact or PlyContact()).resilience
        case inputs.FRICTION_OF_CROSSOVERS if setup.crossovers is not None:
            number = setup.crossovers.friction
        case _ if name in inputs.OF_RESOLVED_YARNS and setup.crossovers is not None:
            field, _ = inputs.OF_RESOLVED_YARNS[name]
            number = getattr(setup.crossovers, field)
        case _:
            return False
    return not is_assumed(number)


def _with_woven_strength(ply, value):
    """A ply whose yarns have this share of their strength after weaving, unless its fabric says
    what they have."""
    fabric = ply.fabric
    if data_sheet.STRENGTH_AFTER_WEAVING in fabric.assumed:
        value /= assumed.shot_entries(fabric)[data_sheet.STRENGTH_AFTER_WEAVING].value
    elif "weaving_damage.strength" in fabric.sources:
        return ply
    strains = [value * yarn.failure_strain for yarn in fabric.weave.yarns]
    return replace(ply, fabric=fabric.with_yarns(failure_strain=strains))


def _scale_clamp_force(edge, factor):
    """An edge, in any of its forms, with the force of its friction clamps times a factor."""
    if isinstance(edge, tuple):
        return tuple(_scale_clamp_force(part, factor) for part in edge)
    if isinstance(edge, Grip):
        return replace(edge, clamp_force=factor * edge.clamp_force)
    return edge


def residual_velocity(
    setup: ImpactSetup,
    outcome: str,
    velocity: float,
    on_progress: Callable[[float], object] | None = None,
    folder: FilePath | None = None,
) -> AssumedRange | None:
    """Compute the range of the residual velocity of a shot; None if nothing is assumed.

    Parameters
    ----------
    setup : ImpactSetup of the nominal shot
    outcome, velocity : of the nominal shot, [m/s]
    on_progress : called as on_progress(share of the shots) after each
    folder : where the shots are kept, and taken from; None keeps nothing
    """

    def shot(changed):
        plain = replace(changed, snapshot_interval=None, history=None)
        if folder is None:
            return _residual(plain)
        (found,) = run_cache.results(_residual, [(plain,)], folder=folder)
        return found

    row = VariedRun("nominal", outcome, velocity)
    return run_ends("residual velocity", setup, changes(setup), row, shot, on_progress)


def _residual(setup):
    """(outcome, residual velocity [m/s] or None) of a shot."""
    try:
        result = run_impact(setup)
    except UnstableError:
        return "unstable", None
    outcome = result.outcome
    if doubtful(result):
        outcome += " (doubtful)"
    return outcome, float(result.residual_velocity)


def critical_velocity(
    setup: ImpactSetup,
    velocity: float,
    *,
    tolerance: float = 1.0,
    on_progress: Callable[[float], object] | None = None,
    folder: FilePath | None = None,
    **beside: Any,
) -> AssumedRange | None:
    """Compute the range of the critical velocity of a panel or pack; None if nothing is assumed.

    Parameters
    ----------
    setup : ImpactSetup of any shot at the panel
    velocity : [m/s] nominal critical velocity
    tolerance, beside : see `ballistic_limit.critical_velocity`
    on_progress : called as on_progress(share of the searches) after each
    folder : where shots are kept, and taken from
    """
    # it loads the kernels of packs, which a shot on one ply does not use
    from weavecell.studies import (
        ballistic_limit,
    )

    def search(changed):
        try:
            limit = ballistic_limit.critical_velocity(
                changed.target(),
                guess=velocity,
                step=NEXT_STEP,
                tolerance=tolerance,
                kept=ballistic_limit.KeptShots(folder, changed),
                **beside,
            )
        except WeavecellError as problem:
            return str(problem), None
        return "bracket on a doubtful shot" * any(map(doubtful, limit.ends)), float(limit.velocity)

    row = VariedRun("nominal", "", velocity)
    return run_ends("critical velocity", setup, changes(setup), row, search, on_progress)


def doubtful(shot: Any) -> bool:
    """Tell whether a quality check of a shot is beyond its limit."""
    return status(shot.checks) == DOUBTFUL


def run_ends(
    quantity: str,
    setup: ImpactSetup,
    ends: Ends,
    nominal: VariedRun,
    run: Callable[[ImpactSetup], tuple[str, float | None]],
    on_progress: Callable[[float], object] | None = None,
) -> AssumedRange | None:
    """Compute the AssumedRange of run(set-up) -> (outcome, velocity) over ends of `changes`; None
    if nothing is assumed."""
    rows = [nominal]
    velocity = nominal.velocity or 0.0
    count = sum(map(len, ends.values())) + 2

    def add(words, changed, varied=""):
        rows.append(VariedRun(words, *run(changed), varied))
        if on_progress is not None:
            on_progress(min((len(rows) - 1) / count, 1.0))

    for name, of_one in ends.items():
        for words, change in of_one.items():
            add(words, change(setup), name)
    alone = {row.laws: row.velocity - velocity for row in rows if row.velocity is not None}
    for words, sign in (("all that lower it", -1.0), ("all that raise it", 1.0)):
        chosen = []
        for of_one in ends.values():
            # of each assumption the end that moves the velocity furthest this way
            effects = [sign * alone.get(end, 0.0) for end in of_one]
            largest = max(effects)
            if largest > 0:
                chosen.append(list(of_one.values())[effects.index(largest)])
        # one alone has been run already
        if len(chosen) > 1:
            add(words, reduce(lambda changed, change: change(changed), chosen, setup))
    if ends:
        return AssumedRange(quantity, tuple(rows))
    return None
