"""The register of the checks, by name: what each needs of the shared runs, and the function that finds our numbers.

A check is called with the runs that it needs and the arguments of its claim, and returns {name: found} in SI; a "note"
among them is a remark.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

Found: TypeAlias = dict[str, Any]  # {name: number, text, list or bool in SI}, and "note": remark
RunResult: TypeAlias = dict[str, Any]  # {name: number, text or array} of a shared run

CHECKS: dict[str, Check] = {}


@dataclass(frozen=True, order=True)
class Run:
    """A computation by name, with its arguments as JSON; what several claims read is made once and kept."""

    name: str
    arguments: str

    @classmethod
    def of(cls, name: str, **arguments: Any) -> Run:
        """The run `name` of `runs.RUNS` with these arguments."""
        return cls(name, json.dumps(arguments, sort_keys=True))

    @property
    def keywords(self) -> dict[str, Any]:
        return json.loads(self.arguments)


@dataclass(frozen=True)
class Check:
    """A check.

    Parameters
    ----------
    function : called with runs and arguments
    needs : arguments -> {name: Run}
    """

    function: Callable
    needs: Callable


def check(needs: Callable[..., Any] | None = None) -> Callable[[Callable[..., Found]], Callable[..., Found]]:
    """Register the function under "module.name"; `needs` gives the runs for the same arguments."""

    def register(function):
        name = f"{function.__module__.rsplit('.', 1)[-1]}.{function.__name__}"
        CHECKS[name] = Check(function, needs or (lambda **arguments: {}))
        return function

    return register
