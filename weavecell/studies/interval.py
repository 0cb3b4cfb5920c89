"""The answer of a shot or of a search as an interval over what nobody knows: the place that is
struck, and each friction that nobody gave.

Each place is struck with all these frictions at the low ends of their ranges, and the first also
with all at the high ends: there yarns hold, and places are alike. Where the runs agree, that is the
answer. Else each friction alone is set to its high end at the place that stopped least, and what moves the
answer by half of the interval or more decides it. An interval is the envelope of these runs, and no
bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from fabrics import data_sheet
from fabrics.base import run_cache
from fabrics.base.counted import counted
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import inputs
from weavecell.studies.assumed_range import is_given, set_value
from weavecell.studies.places import NAMED, Place, Places, resolve, strike_at

if TYPE_CHECKING:
    from pandas import DataFrame

SHOT = "shot"
LIMIT = "critical-velocity"
PLACE = "the place"
DEPENDS = "depends"  # outcome of shots that differ


class Friction(NamedTuple):
    """A friction that is varied where nobody gave it: in words, what tells it, and its column."""

    words: str
    advice: str
    column: str


# {what is assumed: Friction}
FRICTIONS = {
    inputs.FRICTION_OF_CROSSOVERS: Friction(
        "friction between yarns",
        "measure friction between yarns by a pull-out",
        "friction_between_yarns",
    ),
    data_sheet.FRICTION_OF_PROJECTILE: Friction(
        "friction on the nose", "give `projectile.friction`", "friction_on_nose"
    ),
    data_sheet.FRICTION_BETWEEN_PLIES: Friction(
        "friction between plies", "give `panel.ply_friction`", "friction_between_plies"
    ),
}
ADVICE = {PLACE: "`v50` gives the share"} | {one.words: one.advice for one in FRICTIONS.values()}
# columns of texts that some runs have not
TEXTS = ("checks", "widened")
# [-] of the strike velocity, or of the highest limit: runs that differ by less agree
AGREE = 0.1
# [-] of the interval: what moves the answer by so much decides it
DECIDES = 0.5
# [-] of the first guess: width of the brackets of limits of one ply, where none is asked for
WIDTH = 0.02
# [-] of the first guess, for which it is judged whether friction holds the yarns of a limit
FAST = 1.5


@dataclass(frozen=True)
class Variation:
    """One run of an interval.

    Parameters
    ----------
    place : Place
    frictions : {what is assumed: value} of what was varied
    setup : ImpactSetup
    """

    place: Place
    frictions: Mapping[str, float]
    setup: ImpactSetup

    @property
    def name(self) -> str:
        """Place and frictions in words."""
        return _say_run(self.place, self.frictions)

    def columns(self, quantity: str) -> dict[str, Any]:
        """Return what is run for SHOT or LIMIT, as columns of the table of an Interval."""
        setup = self.setup
        assert setup.crossovers is not None
        found: dict[str, Any] = {
            "place": self.place.name,
            "friction_between_yarns": float(setup.crossovers.friction),
            "friction_on_nose": float(setup.projectile.friction),
        }
        if setup.plies > 1:
            found["friction_between_plies"] = float(setup.ply_friction)
        found["modelled_part"] = setup.symmetry
        if quantity == SHOT:
            found["strike_velocity_m_s"] = float(setup.strike_velocity)
        return found


def _say_run(place, frictions):
    """Where a run strikes and its frictions, {what is assumed: value}, in words."""
    values = [f"{FRICTIONS[name].words} {value:g}" for name, value in frictions.items()]
    return ", ".join((place.name, *values))


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


def vary(setup: ImpactSetup, place: Place, frictions: Mapping[str, float]) -> Variation:
    """Return the run at a place with some frictions."""
    for name, value in frictions.items():
        setup = set_value(setup, name, value)
    return Variation(place, dict(frictions), strike_at(setup, place))


def plan_first(
    setup: ImpactSetup, places: Places, unknown: Mapping[str, tuple[float, float]]
) -> list[Variation]:
    """Plan the runs whose agreement is an answer.

    Parameters
    ----------
    setup : ImpactSetup of resolved yarns
    unknown : of `find_unknown`
    """
    low, high = ({name: ends[end] for name, ends in unknown.items()} for end in (0, 1))
    first = [vary(setup, place, low) for place in places.listed]
    if unknown:
        first.append(vary(setup, places.listed[0], high))
    return first


def plan_more(
    setup: ImpactSetup,
    place: Place,
    unknown: Mapping[str, tuple[float, float]],
    done: Sequence[Variation],
) -> list[Variation]:
    """Plan the runs that tell which friction decides: each alone at its high end.

    Parameters
    ----------
    place : that stopped least
    done : runs that are not planned again
    """
    known = [(run.place, run.frictions) for run in done]
    low = {name: ends[0] for name, ends in unknown.items()}
    more = []
    for name, (_, high) in unknown.items():
        frictions = low | {name: high}
        if (place, frictions) not in known:
            more.append(vary(setup, place, frictions))
    return more


@dataclass(frozen=True)
class IntervalPlan:
    """Runs that answer over what nobody knows, about to be made.

    Parameters
    ----------
    setup : ImpactSetup of resolved yarns, from which all runs are made
    quantity : SHOT or LIMIT
    tolerance : [m/s] of the brackets of a limit; None of a shot, and of the usual one of a pack
    places : Places
    unknown : {what is assumed: (low, high)} of the frictions that nobody gave
    first : the runs whose agreement is the answer
    """

    setup: ImpactSetup
    quantity: str
    tolerance: float | None
    places: Places
    unknown: Mapping[str, tuple[float, float]]
    first: tuple[Variation, ...]

    @property
    def shown(self) -> ImpactSetup:
        """The set-up of the run whose shots are shown: the first."""
        return self.first[0].setup

    def plan_more(self, place: Place) -> list[Variation]:
        """Plan the runs that follow if the first do not agree, at the place that stopped least."""
        return plan_more(self.setup, place, self.unknown, self.first)

    def arguments(self, run: Variation) -> tuple[ImpactSetup, str, float | None]:
        """Return the arguments of `sweep.row` of a run."""
        return inputs.use_one_thread(run.setup), self.quantity, self.tolerance


@dataclass(frozen=True)
class Run:
    """A run of an interval with what came of it.

    Parameters
    ----------
    place : that was struck
    frictions : {what is assumed: value} of what was varied
    row : {column: value}: `Variation.columns`, and those of `sweep.row`
    """

    place: Place
    frictions: Mapping[str, float]
    row: Mapping[str, Any]

    @classmethod
    def of(cls, variation: Variation, quantity: str, row: Mapping[str, Any]) -> Run:
        """Return the run of a Variation for SHOT or LIMIT that came to a row of `sweep.row`."""
        columns = variation.columns(quantity) | dict(row)
        return cls(variation.place, variation.frictions, columns)

    @property
    def name(self) -> str:
        """Place and frictions in words."""
        return _say_run(self.place, self.frictions)

    def words(self) -> str:
        """Write place, frictions and what came of it in one line."""
        value = ""
        if self.value:
            value = f"{self.value:.1f} m/s, "
        notes = []
        if self.doubtful:
            notes.append(self.row["checks"])
        notes.append(self.row.get("widened", ""))
        return "; ".join(filter(None, (f"{self.name}: {value}{self.outcome}", *notes)))

    @property
    def outcome(self) -> str:
        """As in the row."""
        return str(self.row["outcome"])

    @property
    def value(self) -> float | None:
        """[m/s] residual velocity, 0 of a nose that stopped; or limit, the middle of its zone where
        outcomes mix; None of a run that has none."""
        if "residual_velocity_m_s" in self.row:
            if self.outcome == "unstable":
                return None
            # one that is taken as stopped may have a little of its velocity left
            if self.outcome == "stopped":
                return 0.0
            return float(self.row["residual_velocity_m_s"])
        if self.row.get("lower_m_s") is None:
            return None
        middle = 0.5 * (self.row["lower_m_s"] + self.row["upper_m_s"])
        return float(self.row.get("critical_velocity_m_s") or middle)

    @property
    def doubtful(self) -> bool:
        """Whether a quality check of the run is beyond its limit."""
        return str(self.row.get("checks", "")).startswith("doubtful")


@dataclass(frozen=True)
class Interval:
    """An answer over what nobody knows.

    Parameters
    ----------
    quantity : SHOT or LIMIT
    places : Places
    unknown : {what is assumed: (low, high)} of the frictions that were varied
    runs : tuple of Run, that whose shots are shown first

    Examples
    --------
    >>> shot = {"opening": "30 mm", "end_time": "8 us", "crossovers": "yarns", "zone": "9 mm"}
    >>> found = wc.impact("S-720", "150 m/s", interval=True, crossover_friction=0.2, **shot)
    >>> found.interval.outcome, len(found.interval.to_dataframe())
    ('in flight', 2)
    """

    quantity: str
    places: Places
    unknown: Mapping[str, tuple[float, float]]
    runs: tuple[Run, ...]

    @property
    def known(self) -> list[tuple[float, Run]]:
        """[(value [m/s], Run)] of the runs that have a value, the lowest first."""
        found = [(run.value, run) for run in self.runs if run.value is not None]
        return sorted(found, key=lambda pair: pair[0])

    @property
    def low(self) -> float | None:
        """[m/s] the lowest value; None if no run has one."""
        return min((value for value, _ in self.known), default=None)

    @property
    def high(self) -> float | None:
        """[m/s] the highest value; None if no run has one."""
        return max((value for value, _ in self.known), default=None)

    @property
    def outcomes(self) -> tuple[str, ...]:
        """Of the shots, each once; empty of limits."""
        if self.quantity != SHOT:
            return ()
        return tuple(dict.fromkeys(run.outcome for run in self.runs))

    @property
    def outcome(self) -> str:
        """Of all shots; "depends" where they differ; "" of limits."""
        if len(self.outcomes) > 1:
            return DEPENDS
        return "".join(self.outcomes)

    @property
    def agrees(self) -> bool:
        """Whether one answer holds for all runs."""
        if self.low is None or self.high is None or len(self.known) < len(self.runs):
            return False
        scale = self.high
        if self.quantity == SHOT:
            scale = self.runs[0].row["strike_velocity_m_s"]
        return len(self.outcomes) < 2 and self.high - self.low <= AGREE * scale

    def values_with(self, frictions: Mapping[str, float]) -> dict[Place, float]:
        """Return {place: [m/s]} of the runs with some frictions that have a value, the lowest
        first."""
        return {run.place: value for value, run in self.known if run.frictions == frictions}

    @property
    def lowest(self) -> dict[str, float]:
        """{what is assumed: low end} of the frictions that were varied."""
        return {name: ends[0] for name, ends in self.unknown.items()}

    @property
    def weakest(self) -> Place:
        """The place that stopped least, with all frictions at their low ends."""
        places = [*self.values_with(self.lowest)] or [self.places.listed[0]]
        if self.quantity == SHOT:
            return places[-1]
        return places[0]

    @property
    def effects(self) -> dict[str, float]:
        """{the place, or a friction in words: [m/s] by which it alone moves the answer}, the largest
        first; empty of what was not looked at."""
        found = {}
        by_place = self.values_with(self.lowest)
        if len(by_place) > 1:
            found[PLACE] = max(by_place.values()) - min(by_place.values())
        for name, (_, high) in self.unknown.items():
            raised = self.values_with(self.lowest | {name: high})
            if self.weakest in raised and self.weakest in by_place:
                moved = raised[self.weakest] - by_place[self.weakest]
                found[FRICTIONS[name].words] = abs(moved)
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @property
    def decides(self) -> tuple[str, ...]:
        """What decides the answer: what moves it by half of the interval; where nothing alone does,
        all that moves it. Empty where the runs agree."""
        if self.agrees or self.low is None or self.high is None:
            return ()
        least = DECIDES * (self.high - self.low)
        alone = tuple(name for name, effect in self.effects.items() if effect >= least > 0)
        return alone or tuple(name for name, effect in self.effects.items() if effect > 0)

    @property
    def doubtful(self) -> int:
        """Number of runs with a doubtful check."""
        return sum(run.doubtful for run in self.runs)

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """{friction in words: (low, high)} of those that were varied."""
        return {FRICTIONS[name].words: ends for name, ends in self.unknown.items()}

    @property
    def varied(self) -> str:
        """The frictions that were varied, in words; "" if all were given."""
        return ", ".join(f"{name} {low:g} to {high:g}" for name, (low, high) in self.ranges.items())

    @classmethod
    def read(cls, content: Mapping[str, Any]) -> Interval:
        """Return the interval of an entry of a JSON file: what keys.toml says of [interval], and the
        runs as they stand in the table."""
        unknown = {
            name: tuple(content["unknown"][one.words])
            for name, one in FRICTIONS.items()
            if one.words in content["unknown"]
        }
        runs = []
        for row in content["runs"]:
            frictions = {name: row[FRICTIONS[name].column] for name in unknown}
            runs.append(Run(NAMED[row["place"]], frictions, row))
        listed = tuple(dict.fromkeys(run.place for run in runs))
        places = Places(listed, content.get("one_place", ""))
        return cls(content["quantity"], places, unknown, tuple(runs))

    def strike_as_shown(self, setup: ImpactSetup) -> ImpactSetup:
        """Return a set-up at the place and with the frictions of the run whose shots are shown."""
        shown = self.runs[0]
        return vary(resolve(setup), shown.place, shown.frictions).setup

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many runs are doubtful, in words."""
        if not self.doubtful:
            return ()
        return (f"{self.doubtful} of {counted(len(self.runs), 'run')}",)

    def lines(self) -> list[str]:
        """Write the lines that stand below the answer: each run, and what moves it."""
        lines = [run.words() for run in self.runs]
        lines[0] += "; shown here"
        if self.places.why:
            lines.append(f"one place: {self.places.why}")
        if effects := self.effects:
            moved = ", ".join(f"{name} {effect:.1f} m/s" for name, effect in effects.items())
            lines.append(f"each alone moves the answer by: {moved}")
        lines.append("an interval is the envelope of these runs, and no bound")
        return lines

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The runs as rows of one table, {column: value}; None of a number that a run has not."""
        names = dict.fromkeys(name for run in self.runs for name in run.row)
        of_none = {name: "" if name in TEXTS else None for name in names}
        return [of_none | dict(run.row) for run in self.runs]

    def to_dataframe(self) -> DataFrame:
        """Return the runs as a pandas.DataFrame; names of the columns end in their SI unit."""
        from pandas import DataFrame

        return DataFrame(self.rows)

    def words(self) -> str:
        """Write the answer in one line: what all runs agree on, or what decides."""
        if self.low is None or self.high is None:
            return f"no run has a value: {self.runs[0].outcome}"
        parts = [self._answer()]
        if self.agrees and self.varied:
            parts[0] += f", {self.varied}"
        if self.decides:
            parts[0] += f": {say_what_decides(self.decides)}"
            parts += [ADVICE[name] for name in self.decides]
        if lost := [run for run in self.runs if run.value is None]:
            parts.append(f"{len(lost)} of {counted(len(self.runs), 'run')}: {lost[0].outcome}")
        return "; ".join(parts)

    def _answer(self):
        """The answer without what decides."""
        span = _say_span(self.low, self.high)
        if self.quantity != SHOT:
            if self.agrees:
                return f"{span} {self.places.words}"
            return span
        if self.outcome == "stopped":
            return f"stopped {self.places.words}"
        if len(self.outcomes) == 1:
            return f"{self.outcome} {self.places.words}, {span} left"
        runs_at = {}
        for place in self.places.listed:
            runs_at[place] = [run for run in self.runs if run.place == place]
        mixed = [place for place, runs in runs_at.items() if len({run.outcome for run in runs}) > 1]
        if self.decides == (PLACE,) and not mixed:
            return ", ".join(_say_place(place, runs) for place, runs in runs_at.items())
        ends = [_say_end(run) for _, run in (self.known[0], self.known[-1])]
        return " to ".join(ends)


def say_what_decides(names: Sequence[str]) -> str:
    """Write that some things, each in words, decide an answer."""
    *others, last = names
    if not others:
        return f"{last} decides"
    return f"{', '.join(others)} and {last} decide"


def _say_span(low, high):
    """An interval of velocities [m/s] in words, with one number where both ends are alike."""
    if f"{low:.1f}" == f"{high:.1f}":
        return f"{low:.1f} m/s"
    return f"{low:.1f} to {high:.1f} m/s"


def _say_place(place, runs):
    """The outcome of all runs at a place, with what is left."""
    outcome = runs[0].outcome
    if outcome == "stopped":
        return f"{outcome} {place.name}"
    values = [run.value for run in runs if run.value is not None]
    return f"{outcome} {place.name} with {_say_span(min(values), max(values))} left"


def _say_end(run):
    """The outcome of a run with what is left."""
    if run.outcome == "stopped":
        return run.outcome
    return f"{run.outcome} with {run.value:.1f} m/s left"


def run_all(
    plans: Sequence[IntervalPlan], wanted: Sequence[Sequence[Variation]], **runs: Any
) -> list[tuple[Run, ...]]:
    """Make runs of several plans, all beside each other.

    Parameters
    ----------
    plans : of n intervals
    wanted : (n,) the runs that are made of each
    runs : folder, jobs, executor and report of `run_cache.results`
    """
    # it loads the statistics of a V50, which words about an interval do without
    from weavecell.studies import sweep

    arguments = [plan.arguments(run) for plan, own in zip(plans, wanted) for run in own]
    rows = iter(run_cache.results(sweep.row, arguments, **runs))
    return [
        tuple(Run.of(run, plan.quantity, next(rows)) for run in own)
        for plan, own in zip(plans, wanted)
    ]


def begin(plans: Sequence[IntervalPlan], **runs: Any) -> list[Interval]:
    """Make the first runs of several plans, whose agreement is an answer; `runs` as in `run_all`."""
    done = run_all(plans, [plan.first for plan in plans], **runs)
    return [
        Interval(plan.quantity, plan.places, plan.unknown, own) for plan, own in zip(plans, done)
    ]


def find_more(plan: IntervalPlan, found: Interval) -> list[Variation]:
    """Find the runs that tell what decides an interval; none if its runs agree."""
    if found.agrees:
        return []
    return plan.plan_more(found.weakest)


def follow_up(
    plans: Sequence[IntervalPlan], found: Sequence[Interval], **runs: Any
) -> list[Interval]:
    """Make the runs of `find_more` of all intervals beside each other, and return these with them."""
    wanted = [find_more(plan, one) for plan, one in zip(plans, found)]
    done = run_all(plans, wanted, **runs)
    return [replace(one, runs=(*one.runs, *more)) for one, more in zip(found, done)]
