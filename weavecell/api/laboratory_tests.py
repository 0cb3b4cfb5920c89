"""Tests of a laboratory, alone and beside what is computed.

The folder of `weavecell reduce tests`
    comparison.json      V50 of the tests, computed limit, residual velocities, intervals, provenance
    shots.csv            every test, with the computed outcome and residual velocity
    comparison.svg       residual against strike velocity, tested and computed
    report.html          all of it on one page
    scene.toml           the input file
    inputs/              copies of the files that the input file names
    tests.json           of tests alone: V10, V50, V90, V50 of six shots, Lambert-Jonas fit, provenance
    tests.svg            of tests alone: residual against strike velocity
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.api import limits, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableSearchKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize, WorkSize
from weavecell.api.study_result import DrawnResult, StudyResult
from weavecell.api.target import resolve_target
from weavecell.results import out_folder
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.indicator import Indicator
    from weavecell.api.target import Target
    from weavecell.runs.laboratory_tests import Comparison, ReducedTests


OF_TESTS = ("tests.json", "shots.csv", "tests.svg")
NAMES = ("comparison.json", "shots.csv", "comparison.svg", *out_folder.INPUT, "report.html")


@dataclass(frozen=True)
class ReductionPlan(Plan["TestsResult"]):
    """Tests that are reduced alone.

    Parameters
    ----------
    fired : table of the tests
    tests : name of their file
    """

    files = OF_TESTS

    fired: DataFrame
    tests: str

    def run(self, running: Running) -> TestsResult:
        """Compute their statistics."""
        from weavecell.runs import laboratory_tests as studies

        return running.save(TestsResult(studies.reduce(self.fired), self.tests))

    def forecast(self) -> WorkSize:
        """Count the tests: nothing is fired."""
        return WorkSize(self.tests, {"test": len(self.fired)})


@dataclass(frozen=True)
class BesideShotsPlan(Plan["TestsBesideShots"]):
    """Tests beside which shots are computed.

    Parameters
    ----------
    target : Target
    fired, tests : as of `ReductionPlan`
    tolerance : [m/s] of the bracket of the computed limit
    """

    files = NAMES

    target: Target
    fired: DataFrame
    tests: str
    tolerance: float

    @property
    def inputs(self) -> Sequence[object]:
        """The set-up."""
        from weavecell.studies import inputs

        return [inputs.use_one_thread(self.target.setup, strike_velocity=1.0)]

    @property
    def strikes(self) -> list[float]:
        """[m/s] of the tests, each once."""
        return sorted(set(self.fired["velocity"].tolist()))

    def forecast(self) -> StudySize:
        """Forecast the shots of the tests, and those of the search."""
        panel = self.target
        fired = len(self.strikes)
        return StudySize.estimate(
            panel.setup, panel.title, fired, 1, tolerance=self.tolerance, scene=panel.scene
        )

    def run(self, running: Running) -> TestsBesideShots:
        """Search the limit, and fire at the velocities of the tests."""
        from shellfabric.membrane import quality
        from weavecell.runs import laboratory_tests as studies
        from weavecell.studies import ballistic_limit

        struck = self.target.setup.target()
        kept = ballistic_limit.KeptShots(running.kept, self.target.setup)
        beside = {"kept": kept, **running.how.pool}
        with running.stage(f"{self.target.title}, critical velocity") as report:
            limit = ballistic_limit.critical_velocity(
                struck, tolerance=self.tolerance, report=report, **beside
            )
        strikes = self.strikes
        with running.stage("Shots of the tests") as report:
            shots = ballistic_limit.shoot(struck, strikes, report=report, **beside)
        computed = [shots[strikes.index(velocity)] for velocity in self.fired["velocity"]]
        found = studies.compare(self.fired, computed, limit)
        worst = quality.worst(shot.checks for shot in computed)
        return running.save(TestsBesideShots(self.target, found, self.tests, worst))

    def give_up(self, running: Running, problem: BaseException) -> None:
        """Write the shots so far, and the input."""
        limits.keep(running.ended, problem, self.target, running.folder)


@command(BesideShotsPlan, ReductionPlan)
@explain_keywords(ResumableSearchKeywords, Keywords)
def reduce_tests(
    tests: FilePath,
    target: Fabric | FilePath | ImpactSetup | None = None,
    *,
    tolerance: float | str | None = None,
    check: bool = False,
    **options: Unpack[ResumableSearchKeywords],
) -> Plan[TestsBesideShots | TestsResult]:
    """Reduce the shots of a laboratory, and put them beside computed ones: V50 and residual
    velocities, with intervals.

    TESTS has a row a shot, and the columns velocity, outcome (PP or CP, or stopped or perforated)
    and, where it was measured, residual velocity, each speed with its unit in the heading:
    "velocity [m/s]". Without a target nothing is computed: the tests alone give V10, V50 and
    V90, V50 of six shots (MIL-STD-662F), and the fit of Lambert and Jonas to the residual
    velocities. With a target the shots are also fired at it at these velocities, and its critical
    velocity is found, on the mesh of the input file.

    Of an input file these keys are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs. [history] and
    [accuracy] are rejected.

    The folder then holds report.html, comparison.json, shots.csv, comparison.svg, scene.toml, and
    runs/ with a file for each computed shot, from which `resume` goes on; of tests alone tests.json,
    shots.csv and tests.svg.

    Parameters
    ----------
    tests : table of tests (``*.csv``), a row a shot
    target : input file of a ply or pack, or name of a fabric or its file; in Python also a set-up
        or a Fabric.
        Left out, the tests alone are reduced
    tolerance : highest stop and lowest perforation differ by this at most [m/s]; if not given 1 m/s
    check : run nothing and write nothing: forecast shots and CPU time
    **options : jobs, executor, out and resume; beside a fabric also keywords of `setup` but history

    Returns
    -------
    TestsBesideShots; without a target TestsResult

    Raises
    ------
    InputError : a wrong table, keywords without a target, or as `critical_velocity`
    UndecidedError, UnstableError : as `critical_velocity`

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("velocity [m/s], outcome\\n60, PP\\n120, CP\\n")
    >>> comparison = wc.reduce_tests("tests.csv", "S-720", opening="100 mm", tolerance="20 m/s")
    >>> comparison.comparison.agree
    2
    """
    from weavecell.runs import laboratory_tests as studies
    from weavecell.studies import strengths

    width = 1.0
    if tolerance is not None:
        width = quantities.read_positive(tolerance, "m/s", "tolerance")
    fired = studies.read(tests)
    if target is None:
        for key in options:
            raise InputError(key=key, allowed="left out if nothing is shot at")
        quantities.refuse_unused({"tolerance": tolerance}, "if nothing is shot at")
        return ReductionPlan(fired, str(tests))
    panel = resolve_target(target, options, "limit", function="reduce_tests")
    with panel.name_problems():
        strengths.require_failure(panel.setup, limits.NO_LIMIT)
    return BesideShotsPlan(panel, fired, str(tests), width)


@explain_frozen
@dataclass(frozen=True, repr=False)
class TestsResult(DrawnResult):
    """Tests of a laboratory, to which nothing is computed; the table has a row a test.

    Parameters
    ----------
    reduced : `weavecell.runs.laboratory_tests.ReducedTests`
    tests : name of their file

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("velocity [m/s], outcome\\n60, PP\\n80, CP\\n70, CP\\n75, PP\\n")
    >>> wc.reduce_tests("tests.csv").reduced.table.shape
    (4, 3)
    """

    # pytest would take a class of this name for tests
    __test__ = False

    kind = "tests"

    reduced: ReducedTests
    tests: str

    def summary(self) -> dict[str, Any]:
        """Return V10, V50 and V90, V50 of six shots, and the Lambert-Jonas fit, with intervals."""
        return self.reduced.summary() | self._what_is_doubtful()

    def _columns(self):
        return self.reduced.table

    def draw(self, pyplot: Any) -> Figure:
        """Draw residual against strike velocity [m/s]."""
        from weavecell.report import pictures

        return pictures.draw_tests_and_shots(pyplot, self.tests, self.reduced, None)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the tests."""
        return self.reduced.doubts

    @out_folder.saving(*OF_TESTS)
    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.results import provenance

        self._write_files(Path(out), provenance.stamp())

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}: V50 and the fit as JSON, a row a test as CSV, and the
        picture."""
        return {
            "tests.json": {"format": "weavecell tests 1", **self.summary()},
            "shots.csv": self.to_csv(),
            "tests.svg": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        return self.reduced.lines(self.tests)


@explain_frozen
@dataclass(frozen=True, repr=False)
class TestsBesideShots(StudyResult):
    """Tests of a laboratory beside computed shots; the table has a row a test.

    Parameters
    ----------
    target : `weavecell.api.target.Target` that was shot at
    comparison : `weavecell.runs.laboratory_tests.Comparison`
    tests : name of their file
    checks : each quality check of the computed shot in which it is worst

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("velocity [m/s], outcome\\n60, PP\\n120, CP\\n")
    >>> comparison = wc.reduce_tests("tests.csv", "S-720", opening="100 mm", tolerance="20 m/s")
    >>> list(comparison.to_dataframe()["computed"])
    ['stopped', 'perforated']
    """

    kind = "comparison"

    target: Target
    comparison: Comparison
    tests: str
    checks: tuple[Indicator, ...] = ()

    def summary(self) -> dict[str, Any]:
        """Return V50 of the tests, computed critical velocity and residual velocities, with
        intervals."""
        named = {"fabric": self.target.title, "projectile": self.target.projectile}
        return named | self.comparison.summary() | self._what_is_doubtful()

    @property
    def doubts(self) -> tuple[str, ...]:
        """As in `Result`, of the computed shots; and what is doubtful of the tests."""
        return (*self.comparison.tests.doubts, *super().doubts)

    @property
    def answer(self) -> Answer:
        """The computed limit beside the V50 of the tests."""
        comparison = self.comparison
        value = f"computed limit {comparison.limit.velocity:.3g} m/s{self._format_difference()}"
        over = (
            f"outcome as tested in {comparison.agree} of {counted(len(comparison.table), 'shot')}"
        )
        return self._find_answer(self.title, value, over=over)

    def _format_difference(self):
        """By how much the computed velocity differs from the V50 of the tests; "" without one."""
        limit = self.comparison.limit
        if self.comparison.tests.posterior is None:
            return ""
        off = limit.velocity / self.comparison.tests.v50 - 1
        return f", {100 * off:+.1f} % off the V50 of the tests"

    def _columns(self):
        return self.comparison.table

    def draw(self, pyplot: Any) -> Figure:
        """Draw residual against strike velocity [m/s], tested and computed."""
        from weavecell.report import pictures

        return pictures.draw_tests_and_shots(
            pyplot, self.title, self.comparison.tests, self.comparison
        )

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        return {
            "comparison.json": {"format": "weavecell comparison 2", **self.summary()},
            "shots.csv": self.to_csv(),
            "comparison.svg": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        comparison = self.comparison
        limit = self.comparison.limit
        bracket = f"stops at {limit.low:.2f}, perforates at {limit.high:.2f} m/s"
        found = f"{limit.velocity:.1f} m/s{self._format_difference()}"
        lines = [
            f"{self.title}: computed critical velocity {found}; {bracket}",
            *comparison.tests.lines(self.tests),
            f"computed, Lambert-Jonas: {comparison.computed.words()}",
        ]
        count = len(comparison.table)
        residual = comparison.difference()
        lines.append(f"outcome as tested in {comparison.agree} of {counted(count, 'shot')}")
        if residual["mean"] is not None:
            lines.append(
                "residual velocity, computed less tested, {counted}: mean {mean:+.1f} m/s ({low:+.1f} to "
                "{high:+.1f} with 95 % confidence), rms {rms:.1f} m/s".format(
                    counted=counted(residual["shots"], "shot"), **residual
                )
            )
        doubtful = int((comparison.table["checks"] == "doubtful").sum())
        if doubtful:
            lines.append(f"doubtful: {doubtful} of {counted(count, 'computed shot')} (shots.csv)")
        return lines
