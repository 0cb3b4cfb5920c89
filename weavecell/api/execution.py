"""How the runs of a study are computed, and where its results go: the keywords that studies share.

A study takes them with its other keywords (`Unpack`), and hands them on as one object.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypedDict

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, nearest
from fabrics.base.executors import EXECUTORS, InProcess
from weavecell.api import entrance, quantities
from weavecell.api.keywords import Keywords


class ExecutionKeywords(TypedDict, total=False):
    """How runs are computed, and where the results go."""

    jobs: int
    executor: str | Executor
    out: FilePath | None


class SearchKeywords(Keywords, ExecutionKeywords, total=False):
    """Keywords of a search for the critical velocity, beside those of `setup`.

    Parameters
    ----------
    jobs : shots that run at the same time, as threads of this process
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or
        the workers of the Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    """


class ResumableSearchKeywords(SearchKeywords, total=False):
    """Keywords of a search that can be continued.

    Parameters
    ----------
    jobs : shots that run at the same time, as threads of this process
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or
        the workers of the Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    resume : whether to take finished shots from the folder; those of another version of the code
        are fired again
    """

    resume: bool


class ResumableKeywords(ExecutionKeywords, total=False):
    """Keywords of what can be continued.

    Parameters
    ----------
    jobs : number of runs in parallel, each in a process of its own; 1 runs them one after the other
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or
        the workers of the Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    resume : whether to take finished runs from the folder; those of another version of the code are
        computed again
    """

    resume: bool


class StudyKeywords(Keywords, ResumableKeywords, total=False):
    """The same beside the keywords of `setup`."""


# a command has the options that this docstring explains
StudyKeywords.__doc__ = ResumableKeywords.__doc__


@dataclass(frozen=True)
class Execution:
    """How runs are computed, and where the results go; its fields are `ResumableKeywords`."""

    jobs: int = 1
    executor: str | Executor = "local"
    out: FilePath | None = None
    resume: bool = False

    def __post_init__(self) -> None:
        given = {"out": self.out, "resume": self.resume}
        entrance.refuse_others({"out": "FilePath | None", "resume": "bool"}, given)
        quantities.read_whole(self.jobs, "jobs", 1)
        if isinstance(self.executor, str):
            if self.executor not in EXECUTORS:
                allowed = f"one of {', '.join(EXECUTORS)}"
                raise InputError(key="executor", value=self.executor, allowed=allowed)
        elif not hasattr(self.executor, "submit"):
            allowed = f"one of {', '.join(EXECUTORS)}, or a concurrent.futures.Executor"
            raise InputError(key="executor", value=self.executor, allowed=allowed)

    @classmethod
    def refuse_others(cls, function: str, options: Mapping[str, Any]) -> None:
        """Refuse keywords of a function whose `**options` are `ResumableKeywords` alone.

        Raises
        ------
        InputError : any keyword, since `api.command` has taken those of `ResumableKeywords`
        """
        for key, value in options.items():
            near = nearest(key, cls.__dataclass_fields__)
            hint = f", did you mean {near}?" if near else ""
            names = ", ".join(cls.__dataclass_fields__)
            message = f"is not a keyword of {function}{hint or ';'} allowed here: {names}"
            raise InputError(message, key=key, value=value)

    @property
    def pool(self) -> dict[str, Any]:
        """Jobs and executor, as `fabrics.base.executors.open_executor` takes them."""
        return {"jobs": self.jobs, "executor": self.executor}

    @property
    def solver_pool(self) -> dict[str, Any]:
        """The same for the 3D solver."""
        # a single job needs no second process, in which PETSc and a script without a guard would
        # begin anew
        if self.pool == {"jobs": 1, "executor": "local"}:
            return {"jobs": 1, "executor": InProcess()}
        return self.pool
