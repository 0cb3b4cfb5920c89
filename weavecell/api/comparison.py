"""Which of two panels stops more, A or B: the difference of V50 over all that is drawn, with its interval.

The folder of `weavecell compare`
    difference.json      difference with its interval, verdict, masses, provenance
    difference.csv       a row for A, for B and for their difference
    difference.svg       the picture
    report.html          all of it on one page
    a/, b/               what `weavecell v50` writes of each
    runs/                a file for each finished run, from which --resume goes on
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.of_two_panels import OfTwoPanels
from weavecell.answers.result import Result
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize, WorkSize
from weavecell.api.scatter import V50Plan, V50Result
from weavecell.api.target import is_input_file, resolve_target
from weavecell.results.finding import Answer
from weavecell.results.left_out import LeftOut

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.runs.difference import Difference

NAMES = ("difference.json", "difference.csv", "difference.svg", "report.html", "a/*", "b/*")
# [-] by which areal densities differ at most that V50 alone compares
ALIKE = 0.03


@dataclass(frozen=True)
class ComparisonPlan(Plan["ComparisonResult"]):
    """Two panels that are about to be compared.

    Parameters
    ----------
    a, b : Targets
    shots, seed : number of shots at each, and of all random numbers
    """

    files = NAMES

    a: Target
    b: Target
    shots: int
    seed: int

    @property
    def target(self) -> Target:
        """A, whose file is named in problems of both."""
        return self.a

    @property
    def plans(self) -> tuple[V50Plan, V50Plan]:
        """The V50Plan of A and of B."""
        from weavecell.runs import v50
        from weavecell.studies import inputs

        scatter = inputs.read_scatter()
        a, b = (V50Plan(one, scatter, self.shots, v50.BATCH, self.seed) for one in (self.a, self.b))
        return a, b

    @property
    def title(self) -> str:
        """What is compared."""
        return " or ".join(panel.title for panel in (self.a, self.b))

    @property
    def inputs(self) -> Sequence[object]:
        """Both set-ups and seed: any number of shots go on from the same ones."""
        return [tuple(part for plan in self.plans for part in plan.inputs)]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time of both together."""
        return StudySize.add_up(self.title, ("A", "B"), [plan.forecast() for plan in self.plans])

    def run(self, running: Running) -> ComparisonResult:
        """Fire at both."""
        stride = max(panel.setup.plies for panel in (self.a, self.b))
        with running.count(self.title) as part:
            found: list[V50Result] = []
            for number, plan in enumerate(self.plans):
                # their problems name the file
                with plan.target.name_problems():
                    found.append(plan.fire(running, part(number, 2), stride=stride))
        return running.save(ComparisonResult(*found))


@dataclass(frozen=True)
class ComputedPlan(Plan["ComparisonResult"]):
    """Two computed results that are about to be compared; nothing is fired.

    Parameters
    ----------
    a, b : V50Result of each
    """

    files = NAMES
    runs = ""

    a: V50Result
    b: V50Result

    def forecast(self) -> WorkSize:
        """Say what is compared: it takes no shot."""
        title = " or ".join(one.target.title for one in (self.a, self.b))
        return WorkSize(title, {"shot": 0})

    def run(self, running: Running) -> ComparisonResult:
        """Compare."""
        return running.save(ComparisonResult(self.a, self.b))


def _plan_computed(a, b, others):
    """The ComputedPlan of two results.

    Parameters
    ----------
    others : {name: value} of the options of `compare`, which mean nothing to what is computed

    Raises
    ------
    InputError : an option, or results that cannot be compared
    """
    quantities.refuse_unused(others, "beside results, which are computed")
    if isinstance(a, V50Result) and isinstance(b, V50Result):
        alike = a.seed == b.seed and a.target.setup.plies == b.target.setup.plies
        if not alike:
            allowed = (
                "a V50 of the same seed and number of plies, whose panels are drawn alike; "
                "or set-ups, which are then fired at"
            )
            raise InputError("is drawn otherwise", key="other", allowed=allowed)
        return ComputedPlan(a, b)
    kinds = f"{type(a).__name__} and {type(b).__name__}"
    allowed = "two results of v50, or what is then computed; overlay draws others"
    raise InputError(key="target, other", value=kinds, allowed=allowed)


@command(ComparisonPlan, ComputedPlan)
@explain_keywords(ResumableKeywords, Keywords)
def compare(
    target: Fabric | FilePath | ImpactSetup | Result | None,
    other: Fabric | FilePath | ImpactSetup | Result | None,
    *,
    shots: int | None = None,
    check: bool = False,
    seed: int | None = None,
    **options: Unpack[StudyKeywords],
) -> Plan[ComparisonResult]:
    """Say which of two panels or packs stops more, A or B, by the difference of V50 over all that nobody gave.

    Shot k at A and shot k at B are drawn with the same random numbers: modulus and crimp of the panel,
    strengths of the yarns, the impact point, and each friction that nobody gave of both. The verdict is
    "better", "worse", or "not decided" with the number of shots that would decide.

    Of the input files these keys are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] is rejected.

    The folder `out` then has report.html, difference.json, difference.csv, difference.svg, a/ and b/
    with the results of each, and runs/ with a file for each run.

    Parameters
    ----------
    target : A, an input file of a ply or pack, name of a fabric or its file; in Python also a
        Fabric, a set-up of `setup`, or a result of `v50`, with which other is one too: nothing is fired
        then
    other : B, an input file of a ply or pack, name of a fabric or its file; in Python also a
        Fabric, or a set-up of `setup`
    shots : number of shots at each, at least 4; if not given 16
    check : run nothing and write nothing: forecast shots and CPU time
    seed : seed of all random numbers; if not given 1
    **options : jobs, executor, out and resume; beside fabrics also keywords of `setup` but history,
        for both

    Returns
    -------
    ComparisonResult

    Raises
    ------
    InputError : as `v50`; a table of tests, which `reduce_tests` reads
    UnstableError : as `v50`

    Examples
    --------
    >>> found = wc.compare("S-720", "S-728", shots=4, opening="30 mm", projectile="sphere 5.5 mm")
    >>> found.verdict
    'not decided'
    """
    from weavecell.runs import table as rows
    from weavecell.studies import inputs, strengths

    if isinstance(target, Result) or isinstance(other, Result):
        return _plan_computed(target, other, {"shots": shots, "seed": seed, **options})
    _, count, first = quantities.read_search(None, shots, seed, usual=(None, 16))
    a, b = (panel.resolved() for panel in _resolve(target, other, options))
    for panel in (a, b):
        with panel.name_problems():
            fired = rows.as_fired(panel.setup)
            strengths.check_places(fired, inputs.read_scatter(), first, count)
    # but for what a V50 does not read
    plain = {"strike_velocity": 1.0, "end_time": 1e-3}
    alike = [inputs.use_one_thread(panel.setup, **plain) for panel in (a, b)]
    if run_cache.inputs_digest(alike[0]) == run_cache.inputs_digest(alike[1]):
        names = f"{a.title} and {b.title}"
        allowed = "two panels that differ: these two are the same set-up"
        raise InputError(key="target, other", value=names, allowed=allowed)
    return ComparisonPlan(a, b, count, first)


def _resolve(target, other, keywords):
    """The two Targets."""
    panels = []
    for one in (target, other):
        if str(one).lower().endswith((".csv", ".txt")):
            raise InputError(
                "is a table of tests", file=str(one), allowed=f"read by {_name_reduction()}"
            )
        beside = keywords
        # keywords are for the one that is no input file, if the other is
        if isinstance(one, (str, Path)) and is_input_file(str(one)):
            others = other if one is target else target
            named = isinstance(others, (str, Path, Fabric))
            if named and not (not isinstance(others, Fabric) and is_input_file(str(others))):
                beside = {}
        panels.append(resolve_target(one, beside, "v50", function="compare"))
    return panels


def _name_reduction():
    """The function or command that reads tables of tests."""
    if option("out").startswith("--"):
        return "`weavecell reduce tests`"
    return "`reduce_tests`"


class ComparedPanel(NamedTuple):
    """A row of the table: a panel, or A less B.

    Parameters
    ----------
    panel : what it is called
    v50, low, high : [m/s] with its interval
    areal_density : [kg/m2]
    specific_energy : [J m2/kg]
    """

    panel: str
    v50: float
    low: float
    high: float
    areal_density: float
    specific_energy: float


@explain_frozen
@dataclass(frozen=True, repr=False)
class ComparisonResult(OfTwoPanels):
    """Two panels or packs, A and B; the table has a row for each and one for A less B.

    Parameters
    ----------
    a, b : V50Result of each

    Examples
    --------
    >>> found = wc.compare("S-720", "S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> low, high = found.interval  # [m/s] of A less B
    >>> low < found.difference.value < high
    True
    """

    kind = "difference"

    a: V50Result
    b: V50Result

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        return self.a.target, self.b.target

    @property
    def values(self) -> tuple[float, float]:
        """[m/s] V50 of A and of B."""
        return self.a.v50, self.b.v50

    @cached_property
    def difference(self) -> Difference:
        """V50 of A less that of B, with its interval."""
        from weavecell.runs.difference import Difference, subtract

        fewest = min(len(one.study.shots) for one in (self.a, self.b))
        middles = []
        for name, one in zip("AB", (self.a, self.b)):
            if one.study.posterior is None:
                return Difference.missing(fewest, f"all shots at {name} end alike")
            middles.append(one.study.posterior.middles)
        return Difference(subtract(*middles), fewest)

    @cached_property
    def difference_by_mass(self) -> Difference:
        """Energy of the projectile at V50 over areal density [J m2/kg], of A less that of B."""
        from weavecell.runs.difference import Difference, subtract

        by_velocity = self.difference
        if by_velocity.reason:
            return by_velocity
        energies = []
        for panel, one, density in zip(self.targets, (self.a, self.b), self.areal_densities):
            assert one.study.posterior is not None
            mass = panel.setup.projectile.mass
            energies.append(0.5 * mass * one.study.posterior.middles**2 / density)
        return Difference(subtract(*energies), by_velocity.shots)

    @property
    def interval(self) -> tuple[float, float]:
        """[m/s] (low, high) of the difference."""
        return self.difference.span.low, self.difference.span.high

    @property
    def verdict(self) -> str:
        """ "better" if A is better than B over the whole interval, "worse", or "not decided"."""
        return self.difference.verdict

    @property
    def shots_to_decide(self) -> int | None:
        """Number of shots at each after which the difference as it is would be decided; None if
        shots would not decide, or it is decided."""
        return self.difference.shots_to_decide()

    @property
    def specific_energies(self) -> tuple[float, float]:
        """[J m2/kg] energy of the projectile at V50 or limit over areal density, of A and of B."""
        a, b = (
            float(0.5 * panel.setup.projectile.mass * value**2 / density)
            for panel, value, density in zip(self.targets, self.values, self.areal_densities)
        )
        return a, b

    @property
    def checks(self) -> tuple:
        """As in `Result`, of both."""
        return (*self.a.checks, *self.b.checks)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of A and of B, and of their order."""
        from weavecell.studies import choice

        parts = [f"{x}: {doubt}" for x, one in zip("AB", (self.a, self.b)) for doubt in one.doubts]
        parts += choice.doubt_order([panel.setup for panel in self.targets])
        return tuple(parts)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What the numbers leave out, of A and of B."""
        return tuple(dict.fromkeys((*self.a.left_out, *self.b.left_out)))

    @property
    def answer(self) -> Answer:
        """Which is better, per areal density first where the two differ in it, and by how much."""
        from weavecell.runs.difference import UNDECIDED

        difference = self.difference
        subject = f"{', or '.join(self.names)}: which is better?"
        if difference.reason:
            return self._find_answer(subject, f"not decided: {difference.reason}")
        low, high = self.interval
        by = f"V50 of A less B {difference.value:+.3g} m/s ({low:+.3g} to {high:+.3g})"
        value = f"{_say_verdict(self.verdict)}: {by}"
        a, b = self.specific_energies
        count = counted(difference.shots, "drawn shot")
        each = f"{self.a.v50:.3g} and {self.b.v50:.3g} m/s, {a:.3g} and {b:.3g} J per kg/m²"
        over = f"{count} at each: {each}"
        if abs(self.heavier) > ALIKE:
            by_mass = self.difference_by_mass.verdict
            value = f"per areal density {_say_verdict(by_mass)}; as a whole {value}"
            more = "more" if self.heavier > 0 else "less"
            over += f"; A has {100 * abs(self.heavier):.0f} % {more} mass"
        advice = (self._what_decides(),) if self.verdict == UNDECIDED else ()
        return self._find_answer(subject, value, advice=advice, over=over)

    def _what_decides(self):
        """What would decide, in words."""
        from weavecell.runs.difference import MOST_SHOTS

        needed = self.shots_to_decide
        if needed is None:
            return f"`weavecell compare --shots {MOST_SHOTS}` would not decide it either"
        return f"`weavecell compare --shots {needed}` decides, if the difference stays"

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        difference = self.difference
        lines = [self.answer.line]
        for label, result, density, energy in zip(
            self.names, (self.a, self.b), self.areal_densities, self.specific_energies
        ):
            span = f"({result.v50_low:.1f} to {result.v50_high:.1f})"
            lines.append(
                f"{label}: V50 {result.v50:.1f} m/s {span}, {1e3 * density:.0f} g/m², "
                f"{energy:.1f} J per kg/m²"
            )
        lines.append(f"mass of A: {100 * self.heavier:+.1f} % against B")
        if not difference.reason:
            low, high = self.interval
            lines.append(
                f"difference by {counted(difference.shots, 'shot')} at each: {low:+.1f} to "
                f"{high:+.1f} m/s with {100 * difference.confidence:g} % confidence"
            )
        if self.other_differences:
            lines.append(f"A and B also differ in: {', '.join(self.other_differences)}")
        failures = getattr(getattr(self.a, "study", None), "failures", ())
        failures = (*failures, *getattr(getattr(self.b, "study", None), "failures", ()))
        return lines + [f"Without an outcome: {failure}." for failure in failures]

    def _items(self):
        difference = self.difference
        spans = [(one.v50_low, one.v50_high) for one in (self.a, self.b)] + [self.interval]
        less = [one[0] - one[1] for one in (self.areal_densities, self.specific_energies)]
        return [
            ComparedPanel(name, value, *span, density, energy)
            for name, value, span, density, energy in zip(
                (*self.names, "A less B"),
                (*self.values, difference.value),
                spans,
                (*self.areal_densities, less[0]),
                (*self.specific_energies, less[1]),
            )
        ]

    def draw(self, pyplot: Any) -> Figure:
        """Draw V50 of A and B with their shots, and the difference below."""
        from weavecell.report import pictures_comparison

        return pictures_comparison.difference(pyplot, self)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `DrawnResult` does."""
        content = {"format": "weavecell difference 2", **self.summary()}
        return {
            "difference.json": content,
            "difference.csv": self.to_csv(),
            "difference.svg": None,
        }

    _written = NAMES

    def _save_each(self, out):
        for name, result in (("a", self.a), ("b", self.b)):
            (out / name).mkdir(exist_ok=True)
            result.save(out / name)

    def _write_report(self, out, stamp):
        """Write the page that has both."""
        from weavecell.report.page import Table

        tables = [Table.from_frame(self.table())]
        points = ("The pages of the two are a/report.html and b/report.html.",)
        seconds = {"both studies": self.b.wall_time}
        self._write_page(out, stamp, tables, (), points, seconds)


def _say_verdict(verdict):
    """Say better or worse, in words."""
    return verdict if verdict == "not decided" else f"A is {verdict}"
