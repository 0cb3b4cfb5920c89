"""Which of two panels has the higher limit over what nobody knows (`studies.interval_difference`).

The folder of `weavecell compare --interval`
    interval-difference.json    the answer, what was varied and what decides; the runs; provenance
    interval-difference.csv     a row for each pair of runs
    interval-difference.svg     the difference of each pair
    report.html                 all of it on one page
    runs/                       a file for each finished run, from which --resume goes on
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from weavecell.api import quantities
from weavecell.api.command import Plan, Running
from weavecell.api.intervals import add_up, leave_out, plan_interval
from weavecell.api.of_two_panels import OfTwoPanels
from weavecell.api.run_size import StudySize
from weavecell.results import one_table
from weavecell.results.finding import Finding
from weavecell.results.left_out import LeftOut, find_left_out

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.api.target import Target
    from weavecell.studies.interval import Variation
    from weavecell.studies.interval_difference import IntervalDifference, PairPlan

FILES = tuple(f"interval-difference.{kind}" for kind in ("json", "csv", "svg"))
NAMES = (*FILES, "report.html")
# fields of a set-up that the runs vary, or that follow from what they vary
OF_RUNS = ("crossovers", "impact_point", "symmetry", "projectile")


def plan_comparison(
    panels: Sequence[Target], tolerance: float | None, beside: Mapping[str, object]
) -> IntervalComparisonPlan:
    """Plan which of two targets, A and B, is better over what nobody knows.

    Parameters
    ----------
    panels : A and B, as they were given; their yarns are resolved
    tolerance : [m/s] of the brackets; None takes `limit.usual_tolerance` of each
    beside : {option: value} of options that an interval does not read; None of what is not given

    Raises
    ------
    InputError : one of these options, or as `plan_interval`
    """
    from weavecell.studies import interval
    from weavecell.studies.interval_difference import PairPlan
    from weavecell.studies.limit import usual_tolerance

    quantities.refuse_unused(beside, "of an interval")
    sides = []
    for panel in panels:
        with panel.name_problems():
            width = tolerance or usual_tolerance(replace(panel.setup, instead=None).target())
            sides.append(plan_interval(panel, interval.LIMIT, width))
    a, b = sides
    plan = PairPlan((a, b))
    # what is told of either is of the yarns that are resolved
    of_a, of_b = (replace(panel, setup=runs[0].setup) for panel, runs in zip(panels, plan.first))
    return IntervalComparisonPlan(of_a, of_b, plan)


@dataclass(frozen=True)
class IntervalComparisonPlan(Plan["IntervalComparisonResult"]):
    """Two panels that are about to be compared over what nobody knows.

    Parameters
    ----------
    a, b : Targets, with the set-ups of the first runs
    plan : `weavecell.studies.interval_difference.PairPlan`
    """

    files = NAMES

    a: Target
    b: Target
    plan: PairPlan

    @property
    def target(self) -> Target:
        """A, whose file is named in problems of both."""
        return self.a

    @property
    def title(self) -> str:
        """What is compared."""
        return f"{self.a.title} or {self.b.title} over what nobody knows"

    @property
    def inputs(self) -> Sequence[tuple]:
        """Set-up, quantity and tolerance of each of the first runs."""
        both = zip(self.plan.sides, self.plan.first)
        return [side.arguments(run) for side, runs in both for run in runs]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time of the first runs of both together, and of those that follow if
        they do not decide."""
        size = self._add_up(self.plan.first)
        a, b = self.plan.sides
        # the last place has no plane of symmetry, or as many as the others
        more = self.plan.list_more((a.places.listed[-1], b.places.listed[-1]))
        if not any(more):
            return size
        return replace(size, more=self._add_up(more))

    def _add_up(self, runs: Sequence[Sequence[Variation]]) -> StudySize:
        sizes = [
            add_up(side, own, panel)
            for side, own, panel in zip(self.plan.sides, runs, (self.a, self.b))
        ]
        return StudySize.add_up(self.title, ("A", "B"), sizes)

    def run(self, running: Running) -> IntervalComparisonResult:
        """Search the limits of the first runs, and if they do not decide those that tell what does."""
        log = logging.getLogger("weavecell")
        searches = counted(sum(map(len, self.plan.first)), "search")
        log.info(f"{self.title}: {searches}, {self.forecast().cost}")
        with running.count(searches) as part:
            found = self.plan.begin(report=part(), **running.cache)
        more = self.plan.find_more(found)
        if any(more):
            searches = counted(sum(map(len, more)), "search")
            log.info(f"they do not decide: {searches} more, {self._add_up(more).cost}")
            with running.count(searches) as part:
                found = self.plan.follow_up(found, report=part(), **running.cache)
        result = IntervalComparisonResult(self.a, self.b, found, running.wall_time)
        return running.save(result)


@explain_frozen
@dataclass(frozen=True, repr=False)
class IntervalComparisonResult(OfTwoPanels):
    """Two panels or packs, A and B, over what nobody knows; the table has a row for each pair of runs.

    Parameters
    ----------
    a, b : `weavecell.api.target.Target` of the first runs
    difference : `weavecell.studies.interval_difference.IntervalDifference`, with the runs, what was
        varied, and what decides
    wall_time : [s]

    Examples
    --------
    >>> panel = {"opening": "30 mm", "crossovers": "yarns", "zone": "9 mm", "crossover_friction": 0.3}
    >>> size = wc.compare("S-720", "S-726", interval=True, check=True, **panel)
    >>> size.searches  # of each panel with both ends of the friction on its nose
    4
    """

    kind = "interval_difference"

    a: Target
    b: Target
    difference: IntervalDifference
    wall_time: float = 0.0

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        return self.a, self.b

    @property
    def verdict(self) -> str:
        """ "better" if A is better in all pairs of runs, "worse", or "not decided"."""
        return self.difference.verdict

    @property
    def answer(self) -> str:
        """The answer in one line."""
        return self.difference.words()

    @property
    def interval(self) -> tuple[float, float] | None:
        """[m/s] (low, high) of A less B over all pairs, with the brackets; None without limits."""
        return self.difference.span()

    @property
    def low(self) -> float | None:
        """[m/s] lowest difference, A less B, with the brackets."""
        return self.interval and self.interval[0]

    @property
    def high(self) -> float | None:
        """[m/s] highest of these."""
        return self.interval and self.interval[1]

    @property
    def decides(self) -> tuple[str, ...]:
        """What decides which is better, in words; empty where one is in all pairs."""
        return self.difference.decides

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many runs are doubtful."""
        if not self.difference.doubtful:
            return ()
        return (f"{self.difference.doubtful} of {counted(self.difference.count, 'run')}",)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What the numbers leave out, of A and of B."""
        found: dict[LeftOut, None] = {}
        for panel, side in zip(self.targets, self.difference.plan.sides):
            parts = find_left_out(panel.setup)
            found |= dict.fromkeys(leave_out(parts, panel, side, ranged=False))
        return tuple(found)

    @property
    def other_differences(self) -> list[str]:
        """As in `OfTwoPanels`, without what the runs vary."""
        return [name for name in super().other_differences if name not in OF_RUNS]

    @property
    def headline(self) -> tuple[str, str]:
        """Which is better over what nobody knows."""
        return self.title, self.answer

    @property
    def finding(self) -> Finding:
        """What was found, with what is doubtful of it."""
        return Finding(*self.headline, self.doubts)

    def _what(self):
        return f"{self.title}: {self.answer}"

    @property
    def per_mass(self) -> str:
        """Which takes more energy per areal density, in words."""
        from weavecell.studies import paired

        both = zip(self.targets, self.areal_densities)
        scales = [0.5 * panel.setup.projectile.mass / density for panel, density in both]
        ends = self.difference.span(scales)
        if ends is None:
            return ""
        verdict = self.difference.judge(scales)
        if verdict != paired.UNDECIDED:
            verdict = f"A is {verdict}"
        low, high = ends
        return (
            f"per areal density: {verdict}, {low:+.1f} to {high:+.1f} J per kg/m²; "
            f"mass of A {100 * self.heavier:+.1f} % against B"
        )

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        difference = self.difference
        lines = [f"{self.title}: {self.answer}"]
        lines += filter(None, (self.per_mass, *difference.tell_unknowns()))
        for side, runs in zip("AB", difference.runs):
            lines += [f"{side}, {_say_run(run)}" for run in runs]
        if effects := difference.effects:
            moved = ", ".join(f"{name} {effect:.1f} m/s" for name, effect in effects.items())
            lines.append(f"each alone moves the difference by: {moved}")
        if self.other_differences:
            lines.append(f"A and B also differ in: {', '.join(self.other_differences)}")
        lines.append("an interval is the envelope of these pairs of runs, and no bound")
        return lines

    def _columns(self):
        return _turn(self.difference.rows)

    def draw(self, pyplot: Any) -> Figure:
        """Draw the difference of each pair of runs [m/s]."""
        from weavecell.report import pictures_comparison

        return pictures_comparison.draw_pairs(pyplot, self.difference)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `DrawnResult` does."""
        runs = {}
        for side, own in zip("ab", self.difference.runs):
            runs[side] = [dict(run.row) for run in own]
        content = {"format": "weavecell interval difference 1", **one_table.facts(self, self.kind)}
        content |= {"runs": runs, "pairs": self.difference.rows}
        return dict(zip(FILES, (content, self.to_csv(), None)))

    _written = NAMES

    def _write_report(self, out, stamp):
        """Write the page."""
        from weavecell.report.page import Card, Table

        card = Card("A against B", self.verdict, (self.finding.value,))
        tables = [Table.from_frame(self.table())]
        self._write_page(out, stamp, [card], tables, (), (), {"all searches": self.wall_time})


def _say_run(run):
    """Place, frictions and limit of a run, with what is doubtful of it."""
    value = ""
    if run.value is not None:
        value = f"{run.value:.1f} m/s, "
    notes = [run.row.get("widened", "")]
    if run.doubtful:
        notes.insert(0, run.row["checks"])
    return "; ".join(filter(None, (f"{run.name}: {value}{run.outcome}", *notes)))


def _turn(rows):
    """Rows {column: value} as {column: values}."""
    return {name: [row[name] for row in rows] for name in rows[0]}
