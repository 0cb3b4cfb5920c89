"""How the runs of a study are computed, and where its results go: the keywords that studies share.

A study takes them with its other keywords (`Unpack`), and hands them on as one object.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, fields
from typing import Any, Self, TypedDict

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.executors import InProcess
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
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or the workers of the
        Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    """


class ResumableKeywords(ExecutionKeywords, total=False):
    """Keywords of what can be continued.

    Parameters
    ----------
    jobs : number of runs in parallel, each in a process of its own; 1 runs them one after the other
    executor : local; the ranks of mpiexec -n RANKS python -m mpi4py.futures -m weavecell ...; or the workers of the
        Dask scheduler at DASK_SCHEDULER_ADDRESS
    out : folder of the results; in Python None writes nothing
    resume : whether to take finished runs from the folder; those of another version of the code are computed again
    """

    resume: bool


class StudyKeywords(Keywords, ResumableKeywords, total=False):
    """The same beside the keywords of `setup`."""


# a command has the options that this docstring explains
StudyKeywords.__doc__ = ResumableKeywords.__doc__


@dataclass(frozen=True)
class Execution:
    """How runs are computed, and where the results go; its fields are `ExecutionKeywords`."""

    jobs: int = 1
    executor: str | Executor = "local"
    out: FilePath | None = None

    @classmethod
    def split(cls, options: Mapping[str, Any]) -> tuple[Self, dict[str, Any]]:
        """Keywords of a study as (its own, the others)."""
        names = [field.name for field in fields(cls)]
        own = {key: value for key, value in options.items() if key in names}
        others = {key: value for key, value in options.items() if key not in own}
        return cls(**own), others

    @classmethod
    def only(cls, options: Mapping[str, Any]) -> Self:
        """Keywords of a study that has no others.

        Raises
        ------
        InputError : another keyword
        """
        own, others = cls.split(options)
        for key, value in others.items():
            raise InputError("is not a keyword of this function", key=key, value=value)
        return own

    @property
    def pool(self) -> dict[str, Any]:
        """Jobs and executor, as `fabrics.base.executors.open_executor` takes them."""
        return {"jobs": self.jobs, "executor": self.executor}

    @property
    def solver_pool(self) -> dict[str, Any]:
        """The same for the 3D solver."""
        # PETSc is initialised in this process: a single job needs no second one, nor a guarded script
        if self.executor == "local" and self.jobs == 1:
            return self.pool | {"executor": InProcess()}
        return self.pool


@dataclass(frozen=True)
class Resumable(Execution):
    """How runs are computed that can be continued; its fields are `ResumableKeywords`."""

    resume: bool = False
