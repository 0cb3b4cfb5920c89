"""What cases, claims and measured rows share: the type of their results, and how far numbers are off."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base import run_cache

Values: TypeAlias = dict[str, Any]  # {name: number, text, array or table}


def largest(values: ArrayLike) -> float:
    """Return the largest absolute value."""
    return float(np.abs(values).max())


def rms(values: ArrayLike) -> float:
    """Compute the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def compute_each(
    function: Callable[[Any], Any], cases: Iterable[Hashable], **options: Any
) -> dict[Any, Any]:
    """Compute each case once: {case: what the function makes of it}; options of
    `run_cache.results`."""
    unique = list(dict.fromkeys(cases))
    return dict(zip(unique, run_cache.results(function, [(case,) for case in unique], **options)))


def flags(checks: Iterable[Any]) -> str:
    """Name the quality checks whose limit is passed."""
    return ", ".join(check.name for check in checks if not check.ok)
