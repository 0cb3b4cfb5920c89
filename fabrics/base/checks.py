"""What values may be: types of the public signatures, and checks that frozen objects make of their
own values."""

from __future__ import annotations

import os
from math import isfinite
from typing import NoReturn, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fabrics.base.errors import InputError

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]
FilePath: TypeAlias = str | os.PathLike[str]


def _check(owner, names, holds, allowed):
    for name in names:
        value = getattr(owner, name)
        if not (isinstance(value, (int, float)) and isfinite(value) and holds(value)):
            refuse(owner, name, allowed)


def refuse(owner: object, key: str, allowed: str) -> NoReturn:
    """Raise the InputError of an attribute whose value is not allowed."""
    raise InputError(key=key, value=getattr(owner, key), allowed=allowed)


def positive(owner: object, *names: str) -> None:
    """Raise InputError unless every named value is a finite number above zero."""
    _check(owner, names, lambda value: value > 0, "a positive number")


def not_negative(owner: object, *names: str) -> None:
    """Raise InputError unless every named value is a finite number, zero or above."""
    _check(owner, names, lambda value: value >= 0, "zero or a positive number")


def fraction(owner: object, *names: str) -> None:
    """Raise InputError unless every named value is in [0, 1)."""
    _check(owner, names, lambda value: 0 <= value < 1, "a fraction from 0 to below 1 (0.02 or 2 %)")
