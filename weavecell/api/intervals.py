"""The answer of a shot, or of a search of the critical velocity, over what nobody knows: where the
nose strikes, and each friction that nobody gave (`studies.interval`).

The folder of `weavecell impact --interval` and `weavecell critical-velocity --interval`
    scene.toml      the input file
    inputs/         copies of the files that the input file names
    interval.json   the answer, what was varied and what decides; the runs; provenance
    interval.csv    a row for each run
    interval.svg    the value of each run
    report.html     all of it on one page
    runs/           a file for each finished run, from which `--resume` goes on
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from weavecell.api import quantities
from weavecell.api.command import Plan, Running
from weavecell.api.run_size import StudySize, forecast_row
from weavecell.api.study_result import StudyResult
from weavecell.results import one_table, out_folder
from weavecell.results.keys import find_axis
from weavecell.results.left_out import DATA, LeftOut

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.api.target import Target
    from weavecell.studies.interval import Interval, IntervalPlan, Variation

NAMES = ("interval.json", "interval.csv", "interval.svg", *out_folder.INPUT, "report.html")


def plan_answer(
    target: Target, quantity: str, tolerance: float | None, beside: Mapping[str, object]
) -> AnswerPlan:
    """Plan the result of `plan_interval`.

    Parameters
    ----------
    beside : {option: value} of options that an interval does not read; None of what is not given

    Raises
    ------
    InputError : one of these options, or as `plan_interval`
    """
    quantities.refuse_unused(beside, "of an interval")
    plan = plan_interval(target, quantity, tolerance)
    return AnswerPlan(replace(target, setup=plan.first[0].setup), plan)


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
            run.setup.plain_panels()
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


@dataclass(frozen=True)
class AnswerPlan(Plan["IntervalResult"]):
    """An answer over what nobody knows that is about to be computed.

    Parameters
    ----------
    target : Target, with the set-up of the first run
    plan : `weavecell.studies.interval.IntervalPlan`
    """

    files = NAMES

    target: Target
    plan: IntervalPlan

    @property
    def inputs(self) -> Sequence[tuple]:
        """Set-up, quantity and tolerance of each of the first runs."""
        return [self.plan.arguments(run) for run in self.plan.first]

    @property
    def title(self) -> str:
        """What is computed."""
        return f"{self.target.title}, {self.plan.quantity.replace('-', ' ')} over what nobody knows"

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time of the runs, and of those that follow if they do not agree."""
        return replace(forecast_all(self.plan, self.target), title=self.title)

    def run(self, running: Running) -> IntervalResult:
        """Compute the first runs, and if they do not agree those that tell what decides."""
        from weavecell.studies import interval

        log = logging.getLogger("weavecell")
        plans = [self.plan]
        count = counted(len(self.plan.first), "run")
        log.info(f"{self.title}: {count}, {self.forecast().cost}")
        with running.count(count) as part:
            (found,) = interval.begin(plans, report=part(), **running.cache)
        if more := interval.find_more(self.plan, found):
            count = counted(len(more), "run")
            cost = add_up(self.plan, more, self.target).cost
            log.info(f"they do not agree: {count} more, {cost}")
            with running.count(count) as part:
                (found,) = interval.follow_up(plans, [found], report=part(), **running.cache)
        return running.save(IntervalResult(self.target, found, running.wall_time))


def forecast_all(plan: IntervalPlan, target: Target) -> StudySize:
    """Forecast shots and CPU time of the runs of a plan, and of those that follow if these do not
    agree."""
    size = add_up(plan, plan.first, target)
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


@explain_frozen
@dataclass(frozen=True, repr=False)
class IntervalResult(StudyResult):
    """The answer of a shot or of a search over what nobody knows.

    Parameters
    ----------
    target : `weavecell.api.target.Target` of the first run
    interval : `weavecell.studies.interval.Interval`, with the runs, what was varied, and what decides
    wall_time : [s]

    Examples
    --------
    >>> shot = {"opening": "30 mm", "end_time": "8 us", "crossovers": "yarns", "zone": "9 mm"}
    >>> found = wc.impact("S-720", "150 m/s", interval=True, crossover_friction=0.2, **shot)
    >>> found.outcome, len(found.to_dataframe())
    ('in flight', 2)
    """

    kind = "interval"

    target: Target
    interval: Interval
    wall_time: float = 0.0

    @property
    def title(self) -> str:
        from weavecell.studies import interval

        if self.interval.quantity == interval.SHOT:
            return self.target.shot_title
        return self.target.title

    @property
    def outcome(self) -> str:
        """Outcome of all shots; "depends" where they differ; "" of limits."""
        return self.interval.outcome

    @property
    def low(self) -> float | None:
        """[m/s] lowest residual velocity, or limit."""
        return self.interval.low

    @property
    def high(self) -> float | None:
        """[m/s] highest residual velocity, or limit."""
        return self.interval.high

    @property
    def decides(self) -> tuple[str, ...]:
        """What decides the answer, in words; empty where all runs agree."""
        return self.interval.decides

    @property
    def answer(self) -> str:
        """The answer in one line."""
        return self.interval.words()

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many runs are doubtful."""
        if not self.interval.doubtful:
            return ()
        return (f"{self.interval.doubtful} of {counted(len(self.interval.runs), 'run')}",)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As in `StudyResult`; of what is assumed, what the runs do not vary."""
        return leave_out(super().left_out, self.target, self.interval, ranged=False)

    @property
    def headline(self) -> tuple[str, str]:
        from weavecell.studies import interval
        from weavecell.studies.sweep import QUANTITIES

        if self.interval.quantity == interval.SHOT:
            return "Outcome", self.answer
        column = QUANTITIES[self.interval.quantity].column
        return find_axis(column).words.capitalize(), self.answer

    def _what(self):
        return f"{self.title}: {self.answer}"

    @property
    def _named(self):
        """The runs, with the columns of the table that the solver does not give."""
        quantity = self.interval.quantity
        return [run.variation.columns(quantity) | dict(run.row) for run in self.interval.runs]

    def _columns(self):
        rows = self._named
        names = dict.fromkeys(name for row in rows for name in row)
        return {name: [row.get(name) for row in rows] for name in names}

    def draw(self, pyplot: Any) -> Figure:
        """Draw the value of each run [m/s], and the interval."""
        from weavecell.report import pictures_uncertainty
        from weavecell.studies.sweep import QUANTITIES

        label = pictures_uncertainty.label_quantity(QUANTITIES[self.interval.quantity])
        return pictures_uncertainty.draw_interval(pyplot, self.interval, label)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        content = {"format": "weavecell interval 1", **one_table.facts(self, self.kind)}
        return {
            "interval.json": content | {"runs": self._named},
            "interval.csv": self.to_csv(),
            "interval.svg": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        from weavecell.studies import interval

        head = self.answer
        if self.interval.quantity == interval.LIMIT:
            head = f"critical velocity {head}"
        lines = [f"{self.title}: {head}"]
        for run in self.interval.runs:
            doubt = ""
            if run.doubtful:
                doubt = f", {run.row['checks']}"
            if "widened" in run.row:
                doubt += f", {run.row['widened']}"
            value = ""
            if run.value:
                value = f"{run.value:.1f} m/s, "
            lines.append(f"{run.variation.name}: {value}{run.outcome}{doubt}")
        if self.interval.places.why:
            lines.append(f"one place: {self.interval.places.why}")
        if effects := self.interval.effects:
            moved = ", ".join(f"{name} {effect:.1f} m/s" for name, effect in effects.items())
            lines.append(f"each alone moves the answer by: {moved}")
        lines.append("an interval is the envelope of these runs, and no bound")
        return lines
