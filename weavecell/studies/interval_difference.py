"""Which of two panels has the higher limit over what nobody knows: A less B, run by run.

What both do not know alike, the place that is struck and a friction that both assume, is the same for
both, whatever it is: run k of A is compared with the run of B at the same place and with the same
friction, and what moves both leaves their difference alone. A friction is shared if both assume it of
the same fibres, in the same range. One that is unknown of one side alone, or of each in a range of its
own, is that side's own: each end of it at A is compared with each end at B.

Each place is struck with all frictions at the low ends of their ranges; the first place also with the
shared ones at their high ends, and with each side's own at theirs. If A is better, or worse, in all
pairs, that is the answer. Else each friction alone is raised where both stop least, and what moves the
difference by half of its interval or more decides.

A difference lies between those of the ends of both brackets; of packs, whose limits are a V50 with an
interval, it is that of `paired.subtract`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

from fabrics.assumed import family_of
from fabrics.base.counted import counted
from weavecell.studies import interval, paired, sweep
from weavecell.studies.interval import FRICTIONS, PLACE, IntervalPlan, Run, Variation
from weavecell.studies.places import GIVEN, Place

Unknown = Mapping[str, tuple[float, float]]
SIDES = ("A", "B")
BRACKETS = "the width that the searches leave"
ADVICE = interval.ADVICE | {BRACKETS: "a narrower tolerance"}


@dataclass(frozen=True)
class PairPlan:
    """Runs at A and at B that tell which is better over what nobody knows, about to be made.

    Parameters
    ----------
    sides : IntervalPlan of A and of B
    """

    sides: tuple[IntervalPlan, IntervalPlan]

    @cached_property
    def shared(self) -> Unknown:
        """{what is assumed: (low, high)} of the frictions that are the same for both."""
        a, b = self.sides
        if _name_fibres(a.setup) != _name_fibres(b.setup):
            return {}
        return {name: ends for name, ends in a.unknown.items() if b.unknown.get(name) == ends}

    @cached_property
    def own(self) -> tuple[Unknown, Unknown]:
        """The same of the frictions that are A's own, and of those that are B's own."""
        a, b = (
            {name: ends for name, ends in side.unknown.items() if name not in self.shared}
            for side in self.sides
        )
        return a, b

    @cached_property
    def places(self) -> tuple[tuple[Place, Place], ...]:
        """(place at A, place at B) that are compared: the same at both; where it makes no difference to
        one side, its only place beside each of the other."""
        a, b = (side.places.listed for side in self.sides)
        if a == b:
            return tuple(zip(a, b))
        return tuple(product(a, b))

    @property
    def first(self) -> tuple[tuple[Variation, ...], tuple[Variation, ...]]:
        """The runs of A and of B that come first."""
        a, b = (self._plan_side(number) for number in (0, 1))
        return a, b

    def _plan_side(self, number):
        side = self.sides[number]
        low = _take_ends(side.unknown, 0)
        listed = side.places.listed
        runs = [interval.vary(side.setup, place, low) for place in listed]
        states = []
        for unknown in (self.shared, self.own[number]):
            ends = [_take_ends(unknown, end) for end in (0, 1)]
            # without an unknown both ends are one
            states.append(ends[: 1 + bool(unknown)])
        for shared, own in product(*states):
            # in the order in which a run at a place names them
            frictions = low | shared | own
            if frictions != low:
                runs.append(interval.vary(side.setup, listed[0], frictions))
        return tuple(runs)

    def find_more(
        self, found: IntervalDifference
    ) -> tuple[tuple[Variation, ...], tuple[Variation, ...]]:
        """Find the runs of A and of B that tell what decides; none if one is better in all pairs."""
        if found.verdict != paired.UNDECIDED or found.weakest is None:
            return (), ()
        return self.list_more(found.weakest)

    def list_more(
        self, places: tuple[Place, Place]
    ) -> tuple[tuple[Variation, ...], tuple[Variation, ...]]:
        """List the runs of A and of B that raise each friction alone, at a place of each, without those
        that come first."""
        wanted = []
        for side, runs, place in zip(self.sides, self.first, places):
            known = [(run.place, run.frictions) for run in runs]
            low = _take_ends(side.unknown, 0)
            raised = [low | {name: high} for name, (_, high) in side.unknown.items()]
            wanted.append(
                tuple(
                    interval.vary(side.setup, place, frictions)
                    for frictions in raised
                    if (place, frictions) not in known
                )
            )
        a, b = wanted
        return a, b

    def begin(self, **runs: Any) -> IntervalDifference:
        """Make the first runs of both sides beside each other; `runs` as of `interval.run_all`."""
        a, b = interval.run_all(self.sides, self.first, **runs)
        return IntervalDifference(self, (a, b))

    def follow_up(self, found: IntervalDifference, **runs: Any) -> IntervalDifference:
        """Make the runs of `find_more`, and return the difference with them."""
        a, b = interval.run_all(self.sides, self.find_more(found), **runs)
        return IntervalDifference(self, (found.runs[0] + a, found.runs[1] + b))


def _name_fibres(setup):
    """Names of the fibres of a set-up; of those that belong to no family, of their fabric."""
    families = [(family_of(fabric), fabric.name) for fabric in setup.fabrics]
    return {name if family is None else family.name for family, name in families}


def _take_ends(unknown, end):
    """{what is assumed: value} of all low ends (0) or all high ends (1)."""
    return {name: ends[end] for name, ends in unknown.items()}


@dataclass(frozen=True)
class Pair:
    """A run of A and the run of B that it is compared with.

    Parameters
    ----------
    a, b : Run
    """

    a: Run
    b: Run

    def subtract(self, scales: Sequence[float] | None = None) -> tuple[float, float, float] | None:
        """Compute A less B, (value, low, high) [m/s].

        Parameters
        ----------
        scales : of A and B [J s2/m2/kg], by which the squares of the limits are energies per areal
            density [J m2/kg]; None of velocities

        Returns
        -------
        None if a run has no limit
        """
        spans = []
        for side, run in enumerate((self.a, self.b)):
            if run.value is None:
                return None
            ends = float(run.row["lower_m_s"]), float(run.row["upper_m_s"])
            if scales is None:
                spans.append((run.value, *ends))
            else:
                low, high = (scales[side] * end**2 for end in ends)
                spans.append((scales[side] * run.value**2, low, high))
        a, b = spans
        if sweep.INTERVAL in (self.a.outcome, self.b.outcome):
            return paired.subtract(a, b)
        return a[0] - b[0], a[1] - b[2], a[2] - b[1]


@dataclass(frozen=True)
class IntervalDifference:
    """The limit of A less that of B over what nobody knows.

    Parameters
    ----------
    plan : PairPlan
    runs : of A and of B, tuples of Run
    """

    plan: PairPlan
    runs: tuple[tuple[Run, ...], tuple[Run, ...]]

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """The runs that are compared."""
        found = []
        for a, b in product(*self.runs):
            of_both = a.place, b.place
            if of_both in self.plan.places and self._shared(a) == self._shared(b):
                found.append(Pair(a, b))
        return tuple(found)

    def _shared(self, run):
        """The shared frictions of a run."""
        frictions = run.frictions
        return {name: frictions[name] for name in self.plan.shared}

    def span(self, scales: Sequence[float] | None = None) -> tuple[float, float] | None:
        """Return (lowest, highest) difference, with the brackets; None if no pair has one. `scales` as
        of `Pair.subtract`."""
        known = [one for one in (pair.subtract(scales) for pair in self.pairs) if one is not None]
        if not known:
            return None
        return min(low for _, low, _ in known), max(high for _, _, high in known)

    @property
    def count(self) -> int:
        """Number of runs of A and B."""
        return sum(map(len, self.runs))

    @property
    def lost(self) -> list[Run]:
        """The runs that have no limit."""
        return [run for of_side in self.runs for run in of_side if run.value is None]

    def judge(self, scales: Sequence[float] | None = None) -> str:
        """Return BETTER or WORSE of `paired` if A is so in all pairs, UNDECIDED where they differ or a
        run has no limit. `scales` as of `Pair.subtract`."""
        ends = self.span(scales)
        if ends is None or self.lost:
            return paired.UNDECIDED
        return paired.judge(*ends)

    @property
    def verdict(self) -> str:
        """As `judge` has it of velocities."""
        return self.judge()

    def _differences(self, a, b):
        """{(place at A, place at B): [m/s]} of the pairs with these frictions that have a value."""
        found = {}
        for pair in self.pairs:
            held = pair.a.frictions, pair.b.frictions
            difference = pair.subtract()
            if held == (a, b) and difference is not None:
                found[pair.a.place, pair.b.place] = difference[0]
        return found

    @property
    def _low(self):
        """The low ends of all frictions at A, and at B."""
        return tuple(_take_ends(side.unknown, 0) for side in self.plan.sides)

    @property
    def weakest(self) -> tuple[Place, Place] | None:
        """The places at which A and B together stop least, with all frictions at their low ends; None if
        no pair of runs has limits."""
        sums = {}
        for a, b in self.plan.places:
            values = [
                run.value
                for runs, place, low in zip(self.runs, (a, b), self._low)
                for run in runs
                if (run.place, run.frictions) == (place, low)
            ]
            known = [value for value in values if value is not None]
            if len(known) == len(values):
                sums[a, b] = sum(known)
        return min(sums, key=lambda pair: sums[pair], default=None)

    @cached_property
    def effects(self) -> dict[str, float]:
        """{the place, a friction, or the width of the brackets, in words: [m/s] by which it alone moves
        the difference}, the largest first; without what was not looked at."""
        found = {}
        known = [one for one in (pair.subtract() for pair in self.pairs) if one is not None]
        if known:
            found[BRACKETS] = max(high - low for _, low, high in known)
        low = self._low
        by_place = self._differences(*low)
        if len(by_place) > 1:
            found[PLACE] = max(by_place.values()) - min(by_place.values())
        base = self.weakest
        for words, raised in self._raise_each():
            values = self._differences(*raised)
            if base in values and base in by_place:
                found[words] = abs(values[base] - by_place[base])
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    def _raise_each(self):
        """(a friction in words, frictions of A and B where it alone is at its high end)."""
        low = self._low
        for name, (_, high) in self.plan.shared.items():
            yield FRICTIONS[name].words, [of_side | {name: high} for of_side in low]
        for number, side in enumerate(SIDES):
            for name, (_, high) in self.plan.own[number].items():
                raised = list(low)
                raised[number] = low[number] | {name: high}
                yield f"{FRICTIONS[name].words} of {side}", raised

    @property
    def decides(self) -> tuple[str, ...]:
        """What decides which is better: what moves the difference by half of its interval; where nothing
        alone does, all that moves it. Empty where one is better in all pairs."""
        ends = self.span()
        if self.verdict != paired.UNDECIDED or ends is None:
            return ()
        least = interval.DECIDES * (ends[1] - ends[0])
        alone = tuple(name for name, effect in self.effects.items() if effect >= least > 0)
        return alone or tuple(name for name, effect in self.effects.items() if effect > 0)

    @property
    def doubtful(self) -> int:
        """Number of runs with a doubtful check."""
        return sum(run.doubtful for of_side in self.runs for run in of_side)

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """{friction in words, of a side where it is its own: (low, high)}."""
        found = {FRICTIONS[name].words: ends for name, ends in self.plan.shared.items()}
        for side, own in zip(SIDES, self.plan.own):
            found |= {f"{FRICTIONS[name].words} of {side}": ends for name, ends in own.items()}
        return found

    @property
    def where(self) -> str:
        """Where the answer holds."""
        if all(side.places.listed == (GIVEN,) for side in self.plan.sides):
            return GIVEN.name
        return "wherever it strikes"

    def words(self) -> str:
        """Write the answer in one line: which is better over all runs, or what decides."""
        ends = self.span()
        if ends is None:
            return f"not decided: no pair of runs has limits: {self.lost[0].outcome}"
        low, high = ends
        if self.verdict != paired.UNDECIDED:
            least, most = sorted(map(abs, ends))
            parts = [f"A is {self.verdict} {self.where}, by {least:.1f} to {most:.1f} m/s"]
            parts += [f"{name} {a:g} to {b:g}" for name, (a, b) in self.ranges.items()]
            return ", ".join(parts)
        parts = [f"depends: A less B {low:+.1f} to {high:+.1f} m/s"]
        if self.decides:
            parts[0] += f": {interval.say_what_decides(self.decides)}"
            parts += dict.fromkeys(ADVICE[name.partition(" of ")[0]] for name in self.decides)
        if self.lost:
            parts.append(
                f"{len(self.lost)} of {counted(self.count, 'run')}: {self.lost[0].outcome}"
            )
        return "; ".join(parts)

    def tell_unknowns(self) -> list[str]:
        """Write which frictions both sides share, and which are a side's own."""
        lines = []
        if self.plan.shared:
            names = ", ".join(FRICTIONS[name].words for name in self.plan.shared)
            lines.append(f"the same for both, whatever it is: {names}")
        for side, own in zip(SIDES, self.plan.own):
            if own:
                names = ", ".join(FRICTIONS[name].words for name in own)
                lines.append(f"unknown of {side} alone, or in a range of its own: {names}")
        return lines

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for each pair, {column: value}."""
        return [_row(pair) for pair in self.pairs]


def _row(pair):
    """The row of a pair."""
    row: dict[str, Any] = {}
    for side, run in zip("ab", (pair.a, pair.b)):
        for column in ("place", "friction_between_yarns", "friction_on_nose"):
            row[f"{column}_{side}"] = run.row[column]
        row[f"{side}_m_s"] = run.value
    value, low, high = pair.subtract() or (None, None, None)
    row |= {"difference_m_s": value, "low_m_s": low, "high_m_s": high}
    doubtful = [name for name, run in zip(SIDES, (pair.a, pair.b)) if run.doubtful]
    row["checks"] = "ok"
    if doubtful:
        row["checks"] = f"doubtful: {' and '.join(doubtful)}"
    return row
