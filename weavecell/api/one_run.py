"""What a single shot, or the search of one limit, stands for: the place that is struck, and the frictions that nobody
gave. The answer over them is an interval (`api.intervals`); a single run says so, and what the interval would cost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from weavecell.results.left_out import LeftOut

if TYPE_CHECKING:
    from weavecell.api.target import Target

KIND = "what nobody gave"


def find_unknown(target: Target, quantity: str) -> LeftOut | None:
    """Say what one run at a target stands for that nobody gave, and the option that answers over it.

    Parameters
    ----------
    target : that was shot at
    quantity : "shot" or "critical-velocity"

    Returns
    -------
    None if place and frictions are given or make no difference: pinned yarns are asked for by the input; and of a
    body of metal, beside which no yarns are resolved
    """
    from weavecell.api.intervals import forecast_all, plan_interval
    from weavecell.studies import interval, places

    setup = target.setup
    if target.is_pinned or setup.projectile.body == "metal":
        return None
    unknown = interval.find_unknown(places.resolve(setup))
    ranges = {
        interval.FRICTIONS[name].words: "{:g} to {:g}".format(*ends)
        for name, ends in unknown.items()
    }
    try:
        plan = plan_interval(target, quantity)
        size = forecast_all(plan, target)
    except InputError as problem:
        # a mesh of its own, say, which pinned yarns alone read: there are no places to choose from
        way = f"{option('interval')} refuses {problem.key}"
    else:
        way = f"{option('interval')} answers over them, {counted(size.shots, 'shot')}, {size.cost}"
        if len(plan.places.listed) > 1:
            ranges = {"place": " or ".join(place.name for place in plan.places.listed)} | ranges
    if not ranges:
        return None
    spans = [f"{name} ({span})" for name, span in ranges.items()]
    return LeftOut(
        KIND,
        f"one run stands for unknown {_list(ranges)}: {way}",
        f"one run stands for unknown {_list(spans)}: {way}",
    )


def _list(names):
    """Several names in a sentence."""
    *others, last = names
    if not others:
        return last
    return f"{', '.join(others)} and {last}"
