"""Which of two panels stops more, A or B: the difference of V50 over all that is drawn, with its interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from weavecell.answers.comparison import NAMES, ComparisonResult
from weavecell.answers.result import Result
from weavecell.answers.v50 import V50Result
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize, WorkSize
from weavecell.api.scatter import V50Plan
from weavecell.api.target import is_input_file, resolve_target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target


@dataclass(frozen=True)
class ComparisonPlan(Plan[ComparisonResult]):
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
class ComputedPlan(Plan[ComparisonResult]):
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
