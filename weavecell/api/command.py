"""A command: a function that reads its inputs and returns a plan; a check and a run follow from it.

The function below `@command` computes nothing. It reads its arguments, refuses what it cannot honour
and returns a Plan, which has all that the run needs: what the plan does not hold, the run does not
know. A call with `check=True` makes the same plan, looks at the same folder and returns the plan's
forecast; any other call holds the folder, runs the plan and warns of a doubtful result. The folder,
jobs and executor, the progress, the files that are read and the interrupt are here and nowhere else.
"""

from __future__ import annotations

import functools
import inspect
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, fields
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, Generic, ParamSpec, TypeVar, cast

from fabrics.base import files, run_cache
from fabrics.base.counted import counted
from fabrics.base.errors import InputError, UnstableError, interrupts
from weavecell.answers.result import Result
from weavecell.api import entrance, gone
from weavecell.api.execution import Execution
from weavecell.results import out_folder, progress

Parameters = ParamSpec("Parameters")
Found = TypeVar("Found", bound=Result)
FoundToo = TypeVar("FoundToo", bound=Result, covariant=True)
# report(number done, number of all) of the runs of a part of a study
Report = Callable[[int, int], None]


@dataclass
class Running(Generic[Found]):
    """A plan under way.

    Parameters
    ----------
    how : Execution
    folder : of the results; None if nothing is written
    runs : folder of the finished runs; a temporary one without `folder`
    ended : the runs that have ended since the last result was saved
    failure : the error that is raised with the result, when this is written
    """

    how: Execution
    folder: Path | None
    runs: Path
    ended: list[Any] = field(default_factory=list)
    failure: UnstableError | None = None
    began: float = field(default_factory=time.perf_counter)

    @property
    def wall_time(self) -> float:
        """[s] since it began."""
        return time.perf_counter() - self.began

    @property
    def kept(self) -> Path | None:
        """The folder of the finished runs, None if there is nothing to go on from."""
        return self.folder and self.runs

    @property
    def cache(self) -> dict[str, Any]:
        """Folder, jobs and executor, as `run_cache.results` takes them."""
        return {"folder": self.runs, **self.how.pool}

    @contextmanager
    def stage(
        self, title: str, describe: Callable[[Any], str] | None = None
    ) -> Iterator[Callable[..., None]]:
        """Show the progress of a stage; yield report(share, run), which takes the run that ended."""
        # without an estimate: some runs take ten times as long as others
        with progress.bar(title, estimate=describe is None) as advance:
            done = count(1)

            def report(share: float, run: Any) -> None:
                self.ended.append(run)
                if describe is None:
                    advance(share)
                else:
                    advance(share, f"{counted(next(done), 'shot')}, {describe(run)}")

            yield report

    @contextmanager
    def count(self, title: str) -> Iterator[Callable[..., Report]]:
        """Show the progress of a study of counted runs; yield part(number=0, of=1), which returns the
        Report of one of its parts."""
        with progress.bar(title) as advance:

            def part(number: int = 0, of: int = 1) -> Report:
                return lambda done, total: advance(
                    (number + done / total) / of, f"{done} of {total}"
                )

            yield part

    def save(self, result: Found) -> Found:
        """Return the result, written to the folder if there is one."""
        # what is written with the result need not be kept apart
        self.ended.clear()
        if self.folder is not None:
            result.save(self.folder)  # type: ignore[attr-defined]
        return result


class Plan(Generic[FoundToo]):
    """What a command is about to do: a frozen dataclass, all of whose inputs are its fields.

    A derived class has what raises NotImplementedError here. Its field `target`, if it has one, is
    what is shot at, whose file is named in problems.
    """

    # names of what its result writes, with wildcards
    files: Sequence[str] = ()
    # folder of the runs that `resume` goes on from; "" of a plan that keeps its state itself
    runs: ClassVar[str] = out_folder.RUNS

    @property
    def inputs(self) -> Sequence[object]:
        """What is computed, without what only chooses how much: `resume` goes on with the same; empty
        of what cannot be resumed."""
        return ()

    def key(self) -> str:
        """Return the digest of all inputs and code, which marks a whole folder; "" without one."""
        return ""

    def finished(self, folder: Path) -> Any:
        """Return the result of this very plan that a folder to resume from holds; None without."""
        return None

    def name_problems(self) -> AbstractContextManager[None]:
        """Name the input file in an InputError that is raised inside this block."""
        target = getattr(self, "target", None)
        if target is None:
            return nullcontext()
        return target.name_problems()

    def forecast(self) -> Result:
        """Say what the run takes, and refuse what it refuses."""
        raise NotImplementedError

    def run(self, running: Running) -> FoundToo:
        """Compute the result."""
        raise NotImplementedError

    def give_up(self, running: Running, problem: BaseException) -> None:
        """Write what had ended before an error or the user ended the run."""


def command(
    *kinds: type[Plan[Found]],
    result: str = "",
) -> Callable[[Callable[Parameters, Plan[Found]]], Callable[Parameters, Found]]:
    """Make a function that returns a Plan the function that runs it.

    Keywords of `Execution` are taken here; those that the function names are given to it too.

    Parameters
    ----------
    *kinds : of the plans that it may return
    result : what a call returns, where an option leads to a plan of another module, which is loaded
        for it alone; "" of what the `kinds` compute
    """

    def decorate(plan: Callable[Parameters, Plan[Found]]) -> Callable[Parameters, Found]:
        signature = inspect.signature(plan)
        own = _keywords_of_execution(plan, signature)

        @functools.wraps(plan)
        @out_folder.reading
        def called(*arguments: Any, **options: Any) -> Any:
            gone.refuse_gone(plan.__name__, options)
            given, options = entrance.take(signature, arguments, options)
            check = options.pop("check", False)
            taken = {key: options.pop(key) for key in own if key in options}
            how = Execution(**taken)
            named = {key: taken[key] for key in taken if key in signature.parameters}
            made = cast(Any, plan)(*given, **named, **options)
            if check:
                if how.out is not None:
                    out_folder.look(how.out, made.files, how.resume, made.inputs)
                with made.name_problems():
                    return made.forecast()
            return _run(made, how)

        # help, command line and reference page say what the run returns
        returned = result or " | ".join(kind.run.__annotations__["return"] for kind in kinds)
        called.__annotations__ = {**plan.__annotations__, "return": returned}
        called.__signature__ = signature.replace(return_annotation=returned)  # type: ignore[attr-defined]
        called.plan = entrance.public(plan)  # type: ignore[attr-defined]
        called.takes = entrance.take  # type: ignore[attr-defined]
        return cast(Any, called)

    return decorate


def _keywords_of_execution(function, signature):
    """The keywords of `Execution` that a function takes: its own, and those of the TypedDict of its
    `**options`."""
    names = set(signature.parameters)
    *_, last = signature.parameters.values()
    typed = re.fullmatch(r"Unpack\[(\w+)\]", str(last.annotation))
    if typed:
        names |= set(inspect.unwrap(function).__globals__[typed[1]].__annotations__)
    return [one.name for one in fields(Execution) if one.name in names]


def _with_other_keys(problem, made, folder):
    """Return the refusal of a folder to resume from, with the keys in which its input file is
    another one."""
    text = getattr(getattr(made, "target", None), "text", None)
    try:
        kept = files.parse_toml(files.read_text(folder / "scene.toml"))
        given = files.parse_toml(text) if isinstance(text, str) else kept
    except (OSError, ValueError):
        return problem
    before, now = dict(_values(kept)), dict(_values(given))
    differ = [key for key in before | now if before.get(key) != now.get(key)]
    if not differ:
        return problem
    shown = [
        f"{key} {before.get(key, 'left out')}, now {now.get(key, 'left out')}" for key in differ
    ]
    return problem.changed(allowed=f"{problem.allowed}; its input file has {'; '.join(shown[:3])}")


def _values(table, name=""):
    """Return (dotted key, value) of all values of a table of a file."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _values(value, f"{name}{key}.")
        else:
            yield f"{name}{key}", value


def _run(made: Plan[Found], how: Execution) -> Found:
    if how.resume and how.out is not None:
        before = made.finished(Path(how.out))
        if before is not None:
            return before
    inputs: Sequence[object] = ()
    if how.out is not None:
        inputs = made.inputs
    if how.resume and how.out is not None:
        try:
            out_folder.look(how.out, made.files, True, inputs)
        except InputError as problem:
            raise _with_other_keys(problem, made, Path(how.out)) from None
    with (
        out_folder.hold(how.out, made.files, how.resume, inputs, made.key) as folder,
        keep_runs(folder, how.resume, made.runs) as runs,
        made.name_problems(),
    ):
        running: Running[Found] = Running(how, folder, runs)
        try:
            with interrupts():
                result = made.run(running)
        except BaseException as problem:
            made.give_up(running, problem)
            raise
    # the folder has what was computed until then
    if running.failure is not None:
        running.failure.result = result
        raise running.failure
    result.warn()
    return result


@contextmanager
def keep_runs(folder: Path | None, resume: bool, name: str) -> Iterator[Path]:
    """Open the folder of the finished runs, emptied unless it is to `resume`; a temporary one if
    `folder` is None or it has no name."""
    with TemporaryDirectory() as spare:
        runs = Path(spare)
        if folder is not None and name:
            runs = folder / name
        if not resume:
            run_cache.RunCache(runs).clear()
        yield runs
