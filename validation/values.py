"""What cases, claims and measured rows share: the type of their results, and how far numbers are off."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

Values: TypeAlias = dict[str, Any]  # {name: number, text, array or table}


def largest(values: ArrayLike) -> float:
    """The largest absolute value."""
    return float(np.abs(values).max())


def rms(values: ArrayLike) -> float:
    """The root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))
