"""The answer of a shot, or of a search of the critical velocity, over what nobody knows: where the
nose strikes, and each friction that nobody gave (`studies.interval`).

The first of its runs is the one whose shots a result shows; the others follow it.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from weavecell.api.run_size import StudySize, forecast_row
from weavecell.results import one_table, progress
from weavecell.results.left_out import DATA, LeftOut

if TYPE_CHECKING:
    from weavecell.api.target import Target
    from weavecell.studies.interval import Interval, IntervalPlan, Variation

RUNS = "interval"  # folder of the finished runs
TABLE = "interval.csv"
# what a command asks for: an interval where there is anything to answer over
OPEN: Literal["open"] = "open"


def choose_interval(
    target: Target,
    quantity: str,
    choice: bool | str,
    tolerance: float | None = None,
    refused: Mapping[str, object] | None = None,
) -> IntervalPlan | None:
    """Plan the answer of a target over what nobody knows, if it is asked for.

    Parameters
    ----------
    target : as it was given
    quantity : "shot" or "critical-velocity"
    choice : False; True; or `OPEN`, where place or a friction is open and resolved yarns can answer
    tolerance : as of `plan_interval`
    refused : {option: value} of options that leave no interval; None of what is not given

    Raises
    ------
    InputError : another choice; of True one of these options, and what `plan_interval` refuses; of
        `OPEN` what one run refuses
    """
    if choice not in (True, False, OPEN):
        raise InputError(key="interval", value=choice, allowed=f"True, False or {OPEN!r}")
    if not choice:
        return None
    given = [key for key, value in (refused or {}).items() if value is not None]
    if choice is True:
        if given:
            raise InputError(key=given[0], allowed="left out of an interval")
        return plan_interval(target, quantity, tolerance)
    if given or target.is_pinned:
        return None
    _check_as_given(target)
    try:
        plan = plan_interval(target, quantity, tolerance)
    except InputError:
        # a mesh of its own, say, which pinned yarns alone read: the one run says what is open
        return None
    if len(plan.first) < 2:
        return None
    return plan


def _check_as_given(target):
    """Refuse an input that one run of it would refuse: its part of the panel, say, which an interval
    chooses by the place."""
    from weavecell.studies import choice

    setup = target.setup
    with target.name_problems():
        if setup.instead is not None:
            setup = choice.with_resolved(setup)
        setup.plain_panels()


def plan_interval(target: Target, quantity: str, tolerance: float | None = None) -> IntervalPlan:
    """Plan the answer of a target over what nobody knows.

    Parameters
    ----------
    target : as it was given; its yarns are resolved
    quantity : "shot" or "critical-velocity"
    tolerance : [m/s] of the brackets of a limit; None takes `studies.interval.WIDTH` of one ply,
        `limit.usual_tolerance` of a pack

    Raises
    ------
    InputError : yarns that are pinned by the input, or what resolved yarns do not have
    """
    from shellfabric.impact.run import check_impact
    from weavecell.studies import interval, places
    from weavecell.studies.ballistic_limit import first_guess

    case = target.case
    if case is not None:
        if target.is_pinned:
            allowed = "yarns, auto, or left out of an interval, which resolves the yarns"
            raise InputError(key="panel.crossovers", value="pinned", allowed=allowed)
        if case.scene.accuracy is not None:
            raise InputError(key="accuracy", allowed="left out of an interval")
    if target.setup.projectile.body == "metal":
        allowed = (
            "rigid in an interval: its yarns are resolved, whose forces do not reach the rings of a body of "
            "metal; or one run, of pinned yarns"
        )
        raise InputError(key="projectile.body", value="metal", allowed=allowed)
    with target.name_problems():
        setup = places.resolve(target.setup)
        velocity = setup.strike_velocity
        if quantity == interval.LIMIT:
            guess = first_guess(replace(target.setup, instead=None).target())
            velocity = interval.FAST * guess
            if tolerance is None and setup.plies == 1:
                tolerance = interval.WIDTH * guess
        if _has_own_place(target):
            struck = places.Places((places.GIVEN,), "the input has the point")
        else:
            struck = places.choose_places(setup, velocity)
        unknown = interval.find_unknown(setup)
        first = interval.plan_first(setup, struck, unknown)
        for run in first:
            # what resolved yarns do not have is refused before anything is run
            check_impact(run.setup)
    return interval.IntervalPlan(setup, quantity, tolerance, struck, unknown, tuple(first))


def _has_own_place(target):
    """Whether the input says which point is struck."""
    from shellfabric.yarns.model import aim

    if target.case is not None:
        panel = target.case.scene.panel
        return panel.impact_point is not None or panel.aim_seed is not None
    setup = target.setup
    usual = [(0.0, 0.0), aim(setup.fabric.weave)]
    return tuple(setup.impact_point) not in usual


def forecast_beside(plan: IntervalPlan, target: Target) -> StudySize:
    """Forecast the runs that follow the one that is shown, and those that follow if they do not
    agree."""
    return replace(_forecast(plan, plan.first[1:], target), after=plan.first[0].name)


def forecast_all(plan: IntervalPlan, target: Target) -> StudySize:
    """Forecast shots and CPU time of the runs of a plan, and of those that follow if these do not
    agree."""
    return _forecast(plan, plan.first, target)


def _forecast(plan, runs, target):
    size = add_up(plan, runs, target)
    # the last place has no plane of symmetry, or as many as the others
    more = plan.plan_more(plan.places.listed[-1])
    if not more:
        return size
    return replace(size, more=add_up(plan, more, target))


def add_up(plan: IntervalPlan, runs: Sequence[Variation], target: Target) -> StudySize:
    """Forecast shots and CPU time of some runs of a plan together."""
    sizes = []
    for run in runs:
        panel = replace(target, setup=run.setup)
        sizes.append(forecast_row(panel, plan.quantity, 0, plan.tolerance))
    return StudySize.add_up(target.title, [run.name for run in runs], sizes)


def complete(plan: IntervalPlan, target: Target, row: Mapping[str, Any], **cache: Any) -> Interval:
    """Compute the runs that follow the one that is shown, and where they do not agree those that tell
    what decides.

    Parameters
    ----------
    plan : IntervalPlan
    target : that was shot at
    row : of `sweep.row`, of the run that is shown
    **cache : folder, jobs and executor of `run_cache.results`
    """
    from weavecell.studies import interval

    log = logging.getLogger("weavecell")
    rest = plan.first[1:]
    count = counted(len(rest), "run")
    log.info(f"the answer over what nobody knows: {count} more, {add_up(plan, rest, target).cost}")
    with _bar(count) as report:
        (others,) = interval.run_all([plan], [rest], report=report, **cache)
    done = (interval.Run.of(plan.first[0], plan.quantity, row), *others)
    found = interval.Interval(plan.quantity, plan.places, plan.unknown, done)
    more = interval.find_more(plan, found)
    if not more:
        return found
    count = counted(len(more), "run")
    log.info(f"they do not agree: {count} more, {add_up(plan, more, target).cost}")
    with _bar(count) as report:
        (found,) = interval.follow_up([plan], [found], report=report, **cache)
    return found


@contextmanager
def _bar(title):
    """The progress of counted runs: report(number done, number of all)."""
    with progress.bar(title) as advance:
        yield lambda done, of: advance(done / of, f"{done} of {of}")


def summarise(found: Interval | None) -> dict[str, Any]:
    """Return the entries of a JSON file, answer and interval; none without one."""
    if found is None:
        return {}
    content = one_table.facts(found, "interval") | {"runs": found.rows}
    return {"answer": found.words(), "interval": content}


def leave_out(
    parts: Sequence[LeftOut], target: Target, found: Interval | IntervalPlan, ranged: bool
) -> tuple[LeftOut, ...]:
    """Return what numbers over an interval leave out: as of one run, but of what is assumed that
    which its runs do not vary.

    Parameters
    ----------
    ranged : whether a range over all that is assumed stands beside
    """
    from weavecell.studies import assumed_range

    others = tuple(part for part in parts if part.kind != DATA)
    names = [name for name in assumed_range.changes(target.setup) if name not in found.unknown]
    if ranged or not names:
        return others
    varied = "only the place and frictions are varied"
    text = f"{varied}, the range over {', '.join(names)} is not computed"
    return LeftOut(DATA, "", text), *others
