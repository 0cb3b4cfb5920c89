"""Which of two panels stops more, A or B: the difference of V50 or of the limit, with its interval.

The folder of `weavecell compare`
    difference.json      difference with its interval, verdict, masses, range over what is assumed,
                         provenance
    difference.csv       a row for A, for B and for their difference
    difference.svg       the picture
    report.html          all of it on one page
    a/, b/               what `weavecell v50` or `critical-velocity` write of each
    runs/                a file for each finished run, from which --resume goes on
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Unpack, cast

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.limits import NO_LIMIT, CriticalVelocityResult
from weavecell.api.of_two_panels import OfTwoPanels
from weavecell.api.result import Result, say_before_range
from weavecell.api.run_size import StudySize, WorkSize
from weavecell.api.scatter import V50Result
from weavecell.api.target import is_input_file, resolve_target
from weavecell.results.finding import Finding
from weavecell.results.left_out import LeftOut

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
    from weavecell.api.target import Target
    from weavecell.scenes.fabric_table import Reader
    from weavecell.studies.assumed_range import AssumedRange
    from weavecell.studies.paired import Difference

NAMES = ("difference.json", "difference.csv", "difference.svg", "report.html", "a/*", "b/*")
# what is computed of each: its name in words
QUANTITIES = {"v50": "V50", "critical-velocity": "critical velocity"}
# [-] by which areal densities differ at most that V50 alone compares
ALIKE = 0.03


@dataclass(frozen=True)
class ComparisonPlan(Plan["ComparisonResult"]):
    """Two panels that are about to be compared.

    Parameters
    ----------
    a, b : Targets
    quantity : "v50" or "critical-velocity"
    shots, seed : of V50, number of shots at each, and of all random numbers
    tolerance : [m/s] of the bracket of each search
    over : whether the range over what is assumed is searched
    """

    files = NAMES

    a: Target
    b: Target
    quantity: str
    shots: int
    tolerance: float
    seed: int
    over: bool

    @property
    def target(self) -> Target:
        """A, whose file is named in problems of both."""
        return self.a

    @property
    def panels(self) -> tuple[Target, Target]:
        """A and B."""
        return self.a, self.b

    @property
    def title(self) -> str:
        """What is compared."""
        return " or ".join(panel.title for panel in self.panels)

    @property
    def inputs(self) -> Sequence[object]:
        """Both set-ups, quantity and seed: any number of shots go on from the same ones."""
        from weavecell.studies import inputs

        given = tuple(
            inputs.use_one_thread(panel.setup, strike_velocity=1.0) for panel in self.panels
        )
        return [(given, self.quantity, self.seed)]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time of both together."""
        from weavecell.studies import assumed_range as ranges
        from weavecell.studies import v50

        searches = 0
        if self.over:
            changes = ranges.common_changes(*(panel.setup for panel in self.panels))
            searches = sum(map(len, changes.values())) + 2
        sizes = []
        for panel in self.panels:
            setup = panel.setup
            fired = 0
            drawn = self.quantity == "v50"
            if drawn:
                setup = v50.as_fired(setup)
                fired = self.shots
            words: dict[str, Any] = {"scene": panel.scene, "drawn": drawn}
            sizes.append(StudySize.estimate(setup, panel.title, fired, 1 + searches, **words))
        return StudySize.add_up(self.title, ("A", "B"), sizes)

    def run(self, running: Running) -> ComparisonResult:
        """Fire at both, and search the range of their difference over what is assumed."""
        begin = self._search
        if self.quantity == "v50":
            begin = self._fire_v50
        parts = 2 + self.over
        with running.count(self.title) as part:
            results = []
            for number, panel in enumerate(self.panels):
                # their problems name the file
                with panel.name_problems():
                    results.append(begin(panel, part(number, parts), running))
            result = running.save(ComparisonResult(self.quantity, *results))
            if not self.over:
                return result
            say_before_range(result.mark(result.lines()[0]))
            around = _range_of_difference(
                self.panels, self.tolerance, part(2, parts), running.cache
            )
            return running.save(replace(result, assumed_range=around))

    def _fire_v50(self, panel, report, running):
        """The V50Result of a panel drawn as the other is."""
        from weavecell.studies import inputs, v50

        batch = v50.usual_batch(self.shots)
        study = v50.study(
            panel.setup,
            inputs.read_scatter(),
            shots=self.shots,
            batch=batch,
            seed=self.seed,
            stride=max(one.setup.plies for one in self.panels),
            report=report,
            **running.cache,
        )
        return V50Result(study, panel, self.seed, batch, running.wall_time)

    def _search(self, panel, report, running):
        """The CriticalVelocityResult of a panel: of a pack with V50, of one ply scanned where
        outcomes mix."""
        from weavecell.studies import limit, pack_limit
        from weavecell.studies.limit_scan import ScanRange

        about: dict[str, Any] = {"scan": ScanRange(), "only_mixed": True}
        if panel.setup.plies > 1:
            about = {"scan": None, "v50_shots": pack_limit.SHOTS}
        study = limit.search(panel.setup, tolerance=self.tolerance, **about, **running.cache)
        report(1, 1)
        return CriticalVelocityResult(
            panel, study.limit, study.fit, scan=study.scan, wall_time=running.wall_time
        )


@dataclass(frozen=True)
class ComputedPlan(Plan["ComparisonResult"]):
    """Two computed results that are about to be compared; nothing is fired.

    Parameters
    ----------
    quantity : "v50" or "critical-velocity"
    a, b : V50Result or CriticalVelocityResult of each
    """

    files = NAMES
    runs = ""

    quantity: str
    a: V50Result | CriticalVelocityResult
    b: V50Result | CriticalVelocityResult

    def forecast(self) -> WorkSize:
        """Say what is compared: it takes no shot."""
        title = " or ".join(one.target.title for one in (self.a, self.b))
        return WorkSize(title, {"shot": 0})

    def run(self, running: Running) -> ComparisonResult:
        """Compare."""
        return running.save(ComparisonResult(self.quantity, self.a, self.b))


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
        return ComputedPlan("v50", a, b)
    if isinstance(a, CriticalVelocityResult) and isinstance(b, CriticalVelocityResult):
        return ComputedPlan("critical-velocity", a, b)
    kinds = f"{type(a).__name__} and {type(b).__name__}"
    allowed = "two results of v50, two of critical_velocity, or what is then computed; overlay draws others"
    raise InputError(key="target, other", value=kinds, allowed=allowed)


@command(ComparisonPlan, ComputedPlan, result="ComparisonResult | IntervalComparisonResult")
@explain_keywords(ResumableKeywords, Keywords)
def compare(
    target: Fabric | FilePath | ImpactSetup | Result | None,
    other: Fabric | FilePath | ImpactSetup | Result | None,
    *,
    quantity: str | None = None,
    shots: int | None = None,
    tolerance: float | str | None = None,
    interval: bool = False,
    assumed_range: bool | Literal["laws"] = False,
    check: bool = False,
    seed: int | None = None,
    **options: Unpack[StudyKeywords],
) -> Plan[ComparisonResult]:
    """Say which of two panels or packs stops more, A or B, by the difference of V50 or of the
    critical velocity.

    Shot k at A and shot k at B are fired at panels drawn with the same random numbers: modulus and
    crimp of the panel, strengths of the yarns, and the impact point of resolved yarns. What both
    assume, such as the friction of the projectile, is moved for both together. The verdict is
    "better", "worse", or "not decided" with the number of shots that would decide.

    Of the input files these keys are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] and
    [accuracy] are rejected. If one of the two is a single ply and the other is not, both have the
    mesh of a shot.

    The folder `out` then has report.html, difference.json, difference.csv, difference.svg, a/ and b/
    with the results of each, and runs/ with a file for each run.

    Parameters
    ----------
    target : A, an input file of a ply or pack, name of a fabric or its file; in Python also a
        Fabric, a set-up of `setup`, or a result of `v50` or `critical_velocity`, with which other
        is one too: nothing is fired then
    other : B, an input file of a ply or pack, name of a fabric or its file; in Python also a
        Fabric, or a set-up of `setup`
    quantity : v50, of panels that differ in strength; or critical-velocity, of yarns without
        scatter. If not given v50, with `interval` critical-velocity; of results what they are
    shots : of V50, number of shots at each, at least 4; if not given 40
    tolerance : of critical-velocity, and of the searches over what is assumed, largest difference
        between highest stop and lowest perforation [m/s]; if not given 1 m/s, with `interval` of a
        pack about 5 %
    interval : the limit of A less that of B over what nobody knows, with resolved yarns, run by run:
        the same place, and the same of each friction that both assume. Four to sixteen searches,
        whose cost is told before
    assumed_range : repeat the searches of both limits with both ends of each assumption. Without
        this option a command does so if a law or the crimp is assumed; "laws" does so in Python
    check : run nothing and write nothing: forecast shots and CPU time
    seed : of V50, seed of all random numbers; if not given 1
    **options : jobs, executor, out and resume; beside fabrics also keywords of `setup` but history,
        for both

    Returns
    -------
    ComparisonResult; with `interval` an IntervalComparisonResult, a row for each pair of runs

    Raises
    ------
    InputError : as `v50` or `critical_velocity`; a table of tests, which `reduce_tests` reads
    UnstableError : as `critical_velocity`

    Examples
    --------
    >>> found = wc.compare("S-720", "S-728", quantity="critical-velocity", opening="50 mm", tolerance="10 m/s")
    >>> found.verdict
    'not decided'
    """
    from weavecell.studies import assumed_range as ranges
    from weavecell.studies import inputs, strengths

    if isinstance(target, Result) or isinstance(other, Result):
        others = {"shots": shots, "tolerance": tolerance, "seed": seed, **options}
        others["interval"] = interval or None
        if assumed_range is not False:
            others["assumed_range"] = assumed_range
        made = _plan_computed(target, other, others)
        if quantity not in (None, made.quantity):
            raise InputError(
                key="quantity", value=quantity, allowed=f"{made.quantity}, as they are"
            )
        return made
    if quantity is None:
        quantity = "critical-velocity" if interval else "v50"
    if quantity not in list(QUANTITIES):
        raise InputError(
            key="quantity", value=quantity, allowed=f"one of {', '.join(map(repr, QUANTITIES))}"
        )
    if quantity != "v50":
        quantities.refuse_unused({"shots": shots, "seed": seed}, f"with {quantity}")
    if quantity == "v50" and interval:
        allowed = "left out of v50, whose shots strike anywhere; or quantity critical-velocity"
        raise InputError(key="interval", allowed=allowed)
    width, count, first = quantities.read_search(tolerance, shots, seed, usual=(None, 40))
    panels = _resolve(target, other, options, quantity)
    for panel in panels:
        with panel.name_problems():
            if quantity == "v50":
                strengths.check(panel.setup, inputs.read_scatter())
            else:
                strengths.require_failure(panel.setup, NO_LIMIT)
    if interval:
        from weavecell.api.interval_comparison import plan_comparison

        # a command asks for the range "laws" by itself
        beside = {"assumed_range": True if assumed_range is True else None}
        # its result is another, as that of a check is
        return cast(Any, plan_comparison(panels, width, beside))
    if width is None:
        width = 1.0
    panels = _mesh_alike(panels)
    over = any(ranges.with_ends(panel.setup, assumed_range) is not None for panel in panels)
    if quantity == "v50" and not over:
        quantities.refuse_unused({"tolerance": tolerance}, "of V50 without a range")
    return ComparisonPlan(panels[0], panels[1], quantity, count, width, first, over)


def _resolve(target, other, keywords, quantity):
    """The two Targets."""
    reader: Reader = "limit"
    if quantity == "v50":
        reader = "v50"
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
        panels.append(resolve_target(one, beside, reader, function="compare"))
    return panels


def _mesh_alike(panels):
    """The two Targets, a single ply beside a pack with both on the mesh of a shot."""
    if len({panel.setup.plies > 1 for panel in panels}) == 2:
        return [replace(panel, setup=panel.setup.meshed) for panel in panels]
    return panels


def _name_reduction():
    """The function or command that reads tables of tests."""
    if option("out").startswith("--"):
        return "`weavecell reduce tests`"
    return "`reduce_tests`"


def _range_of_difference(panels, width, report, runs):
    """AssumedRange of the difference of the limits without scatter, both changed together."""
    from weavecell.studies import assumed_range as ranges
    from weavecell.studies import inputs, v50

    pair = tuple(
        inputs.use_one_thread(v50.grade_mesh(panel.setup), strike_velocity=1.0) for panel in panels
    )
    ends = ranges.common_changes(*pair)
    moved = [change(pair) for of_one in ends.values() for change in of_one.values()]
    needed = [(setup, width) for both in (pair, *moved) for setup in both]
    # they run beside each other, and are found again below
    run_cache.results(v50.search_limit, needed, report=report, **runs)

    def difference(both):
        found = run_cache.results(v50.search_limit, [(setup, width) for setup in both], **runs)
        problems = "; ".join(problem for problem, _ in found if problem)
        if problems:
            return problems, None
        return "", found[0][1] - found[1][1]

    nominal = ranges.VariedRun("nominal", *difference(pair))
    return ranges.run_ends(DIFFERENCE, pair, ends, nominal, difference)


DIFFERENCE = "difference of the limits without scatter"


class ComparedPanel(NamedTuple):
    """A row of the table: a panel, or A less B.

    Parameters
    ----------
    quantity : of `QUANTITIES`
    panel : what it is called
    value, low, high : [m/s] V50 or limit, and its interval
    areal_density : [kg/m2]
    specific_energy : [J m2/kg]
    """

    quantity: str
    panel: str
    value: float
    low: float
    high: float
    areal_density: float
    specific_energy: float

    @property
    def v50(self) -> float | None:
        """[m/s] None where limits are compared."""
        return self.value if self.quantity == "v50" else None

    @property
    def critical_velocity(self) -> float | None:
        """[m/s] None where V50 are compared."""
        return None if self.quantity == "v50" else self.value


@explain_frozen
@dataclass(frozen=True, repr=False)
class ComparisonResult(OfTwoPanels):
    """Two panels or packs, A and B; the table has a row for each and one for A less B.

    Parameters
    ----------
    quantity : "v50" or "critical-velocity"
    a, b : V50Result or CriticalVelocityResult of each
    assumed_range : AssumedRange of the difference of the limits without scatter, or None

    Examples
    --------
    >>> found = wc.compare("S-720", "S-728", quantity="critical-velocity", opening="50 mm", tolerance="10 m/s")
    >>> low, high = found.interval  # [m/s] of A less B
    >>> low < found.difference.value < high
    True
    """

    kind = "difference"

    quantity: str
    a: V50Result | CriticalVelocityResult
    b: V50Result | CriticalVelocityResult
    assumed_range: AssumedRange | None = None

    @property
    def quantity_words(self) -> str:
        """ "V50" or "critical velocity"."""
        return QUANTITIES[self.quantity]

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        return self.a.target, self.b.target

    @property
    def values(self) -> tuple[float, float]:
        """[m/s] V50 or limit of A and of B."""
        return _value(self.a), _value(self.b)

    @cached_property
    def difference(self) -> Difference:
        """V50 or limit of A less that of B, with its interval."""
        from weavecell.studies import paired

        if isinstance(self.a, V50Result) and isinstance(self.b, V50Result):
            return paired.compare_shots(_outcomes(self.a), _outcomes(self.b))
        assert isinstance(self.a, CriticalVelocityResult)
        assert isinstance(self.b, CriticalVelocityResult)
        fewest = min(len(self.a.shots), len(self.b.shots))
        if self.a.v50 is None and self.b.v50 is None:
            low, high = (_span(self.a)[end] - _span(self.b)[1 - end] for end in (0, 1))
            return paired.Difference(self.values[0] - self.values[1], low, high, 0.0, fewest, 1.0)
        of_both = [(_value(one), *_span(one)) for one in (self.a, self.b)]
        return paired.Difference(*paired.subtract(*of_both), 0.0, fewest)

    @property
    def interval(self) -> tuple[float, float]:
        """[m/s] (low, high) of the difference, widened by the range over what is assumed where that
        is known."""
        difference = self.difference
        around = self.assumed_range
        low, high = difference.low, difference.high
        if around is not None and around.rows[0].velocity is not None:
            low += around.low - around.rows[0].velocity
            high += around.high - around.rows[0].velocity
        return low, high

    @property
    def verdict(self) -> str:
        """ "better" if A is better than B over the whole interval, "worse", or "not decided"."""
        from weavecell.studies import paired

        return paired.judge(*self.interval)

    @property
    def shots_to_decide(self) -> int | None:
        """Number of shots at each after which the difference as it is would be decided; None if
        shots would not decide, or it is decided."""
        from weavecell.studies import paired

        if self.verdict != paired.UNDECIDED or self.quantity != "v50":
            return None
        if self.difference.verdict != paired.UNDECIDED:
            return None
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
        """What the numbers leave out, of A and of B; the range over what is assumed covers both."""
        parts = dict.fromkeys((*self.a.left_out, *self.b.left_out))
        if self.assumed_range is None:
            return tuple(parts)
        return tuple(part for part in parts if part.kind != "assumed data")

    def _energies(self):
        """(value, low, high) [J m2/kg] of A and of B: energy over areal density at V50 or limit and at
        the ends of its interval."""
        found = []
        for panel, result, density in zip(self.targets, (self.a, self.b), self.areal_densities):
            speeds = (_value(result), *_span(result))
            found.append([0.5 * panel.setup.projectile.mass * v**2 / density for v in speeds])
        return found

    def _per_mass(self):
        """Which takes more energy per areal density, in words, where the masses differ; else ""."""
        from weavecell.studies import paired

        if abs(self.heavier) <= ALIKE:
            return ""
        of_a, of_b = self._energies()
        _, low, high = paired.subtract(of_a, of_b)
        verdict = paired.judge(low, high)
        if verdict != paired.UNDECIDED:
            verdict = f"A is {verdict}"
        mass = (
            f"A has {100 * abs(self.heavier):.0f} % {'more' if self.heavier > 0 else 'less'} mass"
        )
        energies = f"{of_a[0]:.1f} against {of_b[0]:.1f} J per kg/m²"
        return f"per areal density, by the shots, {verdict}, {energies}; {mass}; as a whole "

    @property
    def headline(self) -> tuple[str, str]:
        """Which is better, and by how much; per areal density first where the masses differ."""
        from weavecell.studies import paired

        a, b = self.names
        difference = self.difference
        if difference.reason:
            return f"{a}, or {b}", f"not decided: {difference.reason}"
        mass = self._per_mass()
        colon = ":" if mass else ""
        low, high = self.interval
        by = f"{QUANTITIES[self.quantity]} {difference.value:+.1f} m/s ({low:+.1f} to {high:+.1f})"
        if self.verdict == paired.UNDECIDED:
            words = f"{mass}not decided: {by}; {self._what_decides()}"
            return f"{a}, or {b}{colon}", words
        if mass:
            return f"{a}, or {b}{colon}", f"{mass}A is {self.verdict}, {by}"
        return a, f"{self.verdict} than {b}: {by}"

    def _what_decides(self):
        """What would decide, in words."""
        from weavecell.studies import paired

        by_shots = self.difference.verdict
        if by_shots != paired.UNDECIDED and self.assumed_range is not None:
            widest = next(iter(self.assumed_range.widths))
            return f"the shots decide, what is assumed does not: {widest} first"
        if self.quantity != "v50":
            return "a narrower tolerance, or V50"
        needed = self.shots_to_decide
        if needed is None:
            return f"{paired.MOST_SHOTS:,} shots of each would not decide it either"
        return f"{counted(needed - self.difference.shots, 'more shot')} at each, if the difference stays"

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        from weavecell.studies import paired

        difference = self.difference
        name = QUANTITIES[self.quantity]
        lines = [" ".join(self.headline)]
        for label, result, density, energy in zip(
            self.names, (self.a, self.b), self.areal_densities, self.specific_energies
        ):
            low, high = _span(result)
            span = f" ({low:.1f} to {high:.1f})" if isfinite(high) else ""
            lines.append(
                f"{label}: {name} {_value(result):.1f} m/s{span}, {1e3 * density:.0f} g/m², "
                f"{energy:.1f} J per kg/m²"
            )
        lines.append(f"mass of A: {100 * self.heavier:+.1f} % against B")
        if self.quantity == "v50" and not difference.reason:
            lines.append(
                f"difference by {counted(difference.shots, 'shot')} at each: {difference.low:+.1f} to "
                f"{difference.high:+.1f} m/s with {100 * difference.confidence:g} % confidence; "
                f"correlation of the two {difference.correlation:.2g}"
            )
            widths = paired.forecast_widths(difference)
            if widths:
                each = ", ".join(
                    f"{counted(count, 'shot')} ± {width:.1f}" for count, width, _ in widths
                )
                lines.append(f"interval of the difference by the shots, m/s: {each}")
        if self.assumed_range is not None:
            lines.append(f"over what is assumed: {self.assumed_range.words()}")
        if self.other_differences:
            lines.append(f"A and B also differ in: {', '.join(self.other_differences)}")
        failures = getattr(getattr(self.a, "study", None), "failures", ())
        failures = (*failures, *getattr(getattr(self.b, "study", None), "failures", ()))
        return lines + [f"Without an outcome: {failure}." for failure in failures]

    def _items(self):
        difference = self.difference
        spans = [_span(self.a), _span(self.b), (difference.low, difference.high)]
        less = [one[0] - one[1] for one in (self.areal_densities, self.specific_energies)]
        return [
            ComparedPanel(self.quantity, name, value, *span, density, energy)
            for name, value, span, density, energy in zip(
                (*self.names, "A less B"),
                (*self.values, difference.value),
                spans,
                (*self.areal_densities, less[0]),
                (*self.specific_energies, less[1]),
            )
        ]

    def widths(self) -> DataFrame:
        """Return the half width of the interval of the difference that numbers of shots would give,
        and the verdict if the difference stays."""
        from pandas import DataFrame

        from weavecell.studies import paired

        names = ["shots at each", "± of the difference [m/s]", "verdict if it stays"]
        return DataFrame(paired.forecast_widths(self.difference), columns=names)

    def draw(self, pyplot: Any) -> Figure:
        """Draw V50 or limit of A and B with their shots, and the difference below."""
        from weavecell.report import pictures_comparison

        return pictures_comparison.difference(pyplot, self)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `DrawnResult` does."""
        around = self.assumed_range
        content = {"format": "weavecell difference 1", **self.summary()}
        content["assumed_range"] = around and around.summary()
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
        from weavecell.report.page import Card, Table
        from weavecell.report.shot import chapters_shot

        tables = [Table.from_frame(self.table())]
        if len(widths := self.widths()):
            caption = "Width over the number of shots, if the difference stays as it is"
            tables.append(Table.from_frame(widths, caption))
        sections = []
        if self.assumed_range is not None:
            sections.append(chapters_shot.describe_assumed_range(self.assumed_range))
        cards = [Card("A against B", self.verdict, (self.headline[1],))]
        for name, result, density in zip(self.names, (self.a, self.b), self.areal_densities):
            of_one = Finding(name, f"{_value(result):.1f} m/s", result.doubts)
            lines = (f"{1e3 * density:.0f} g/m²", *result.lines()[:1])
            cards.append(Card(name, of_one.value, lines).with_doubts(of_one))
        points = ("The pages of the two are a/report.html and b/report.html.",)
        seconds = {"both studies": self.b.wall_time}
        self._write_page(out, stamp, cards, tables, sections, points, seconds)


def _outcomes(result):
    """{number of the drawn panel: (strike velocity [m/s], whether it perforated)}."""
    return {shot.number: (shot.velocity, shot.perforated) for shot in result.study.shots}


def _value(result):
    """[m/s] V50, also of a pack's limit, or the middle of the bracket or of the zone of mixed outcomes."""
    if isinstance(result, V50Result):
        return result.v50
    if result.v50 is not None:
        return result.v50.velocity
    low, high = _span(result)
    return 0.5 * (low + high)


def _span(result):
    """(low, high) [m/s] of V50 by the shots, or of the limit."""
    if isinstance(result, V50Result):
        return result.v50_low, result.v50_high
    if result.v50 is not None:
        return result.v50.low, result.v50.high
    if result.mixed_zone is not None:
        return result.mixed_zone
    return result.bracket
