"""What nobody gave of a shot: the place that is struck, the roll of the nose, and frictions. It is drawn
(`strengths.draw_panel`), or set to the middle of its range (`choose_nominal`)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from fabrics import data_sheet
from fabrics.base.assumed_number import Assumed
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import inputs
from weavecell.studies.assumed_range import is_given, set_value
from weavecell.studies.places import ON_WARP, strike_at


class Friction(NamedTuple):
    """A friction that is drawn where nobody gave it: in words, what tells it, and its column."""

    words: str
    advice: str
    column: str


# {what is assumed: Friction}, in the order of their draws
FRICTIONS = {
    inputs.FRICTION_OF_CROSSOVERS: Friction(
        "friction between yarns",
        "measure friction between yarns by a pull-out",
        "friction_between_yarns",
    ),
    data_sheet.FRICTION_OF_PROJECTILE: Friction(
        "friction on the nose", "give projectile.friction", "friction_on_nose"
    ),
    data_sheet.FRICTION_BETWEEN_PLIES: Friction(
        "friction between plies", "give panel.ply_friction", "friction_between_plies"
    ),
}


# {what moves an answer: what tells it}
ADVICE = {one.words: one.advice for one in FRICTIONS.values()}
PLACE = "place"  # that is struck, with the roll of the nose


def find_unknown(setup: ImpactSetup) -> dict[str, tuple[float, float]]:
    """Find the frictions of a set-up that nobody gave: {what is assumed: (low, high)}."""
    entries = inputs.ranges(*setup.fabrics)
    found = {}
    for name in FRICTIONS:
        ends = entries[name].low, entries[name].high
        low, high = (set_value(setup, name, end) for end in ends)
        if not is_given(setup, name) and low != high:
            found[name] = ends
    return found


def choose_nominal(setup: ImpactSetup, placed: bool) -> ImpactSetup:
    """Return the set-up of the one run that stands for all draws: each friction that nobody gave in the
    middle of its range, and resolved yarns struck half-way between gap and crossover, on a yarn, where the
    panel mirrors itself.

    Parameters
    ----------
    placed : whether the input says where it strikes
    """
    for name, (low, high) in find_unknown(setup).items():
        # it stays one that nobody gave, and is drawn beside this run
        setup = set_value(setup, name, Assumed(0.5 * (low + high), low, high))
    if setup.crossovers is None or placed:
        return setup
    return strike_at(setup, ON_WARP)


def say_run(setup: ImpactSetup, placed: bool) -> str:
    """Write what the one run takes of all that nobody gave; `placed` as of `choose_nominal`."""
    parts = []
    if setup.crossovers is not None and not placed:
        parts.append("on a yarn, half-way from gap to crossover")
    for name, (low, high) in find_unknown(setup).items():
        parts.append(f"{FRICTIONS[name].words} {0.5 * (low + high):g}")
    return ", ".join(parts) or "all that matters is given"


def say_drawn(setup: ImpactSetup) -> str:
    """Write what drawn shots draw."""
    parts = [say(find_unknown(setup)), "strength, modulus and crimp drawn"]
    if setup.crossovers is not None:
        parts.insert(0, PLACE)
    return ", ".join(filter(None, parts))


def say(unknown: Mapping[str, tuple[float, float]]) -> str:
    """Write the frictions with their ranges; "" of none."""
    return ", ".join(
        f"{FRICTIONS[name].words} {low:g} to {high:g}" for name, (low, high) in unknown.items()
    )
