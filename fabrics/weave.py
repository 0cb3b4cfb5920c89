"""The weave: two crimped yarn families on a rectangular cell, one crossover a cell.

The centreline of yarn i is z = h_i cos(pi x / 2 w_i) (thesis eq. 4-1) over the cell 2 w_i, which is
the spacing of the family that crosses (eq. 4-2). Its length S (eq. 4-3) has the closed form

    S = (4 w / pi) E(m = -k^2),   k = pi h / 2 w,

with E the complete elliptic integral of the second kind. Index 1 is warp, 2 is weft.

In a weave that is not plain, a yarn changes sides over the share f of its spacings, in such a wave,
and is straight on the others: its length in a cell is f S + (1 - f) 2 w in the mean.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, positive
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.base.run_cache import ADDED_LATER
from fabrics.pattern import PLAIN, Pattern
from fabrics.yarn import Yarn


def arc_length(w: ArrayLike, h: ArrayLike) -> FloatArray:
    """Compute the length of a yarn of height `h` over the whole cell 2 w (eq. 4-3).

    Parameters
    ----------
    w, h : array_like [m] half length of the cell and height of the centreline

    Returns
    -------
    S : array or float [m]
    """
    # 80 ms, which a fabric needs and a list of keys does not
    from scipy.special import ellipe

    k = np.pi * np.asarray(h, float) / (2 * np.asarray(w, float))
    return 4 * np.asarray(w, float) / np.pi * ellipe(-(k**2))


def height_from_length(w: float, S: float) -> float:
    """Compute the height of the centreline of a yarn of length `S` over the cell 2 w: the inverse
    of `arc_length` (eq. 4-5).

    Newton's method on k = pi h / 2 w. The length is convex and rising in k, so every step after the
    first comes from above and the iteration cannot fail.

    Raises
    ------
    InputError : the yarn is shorter than its cell
    """
    from scipy.special import ellipe, ellipk

    crimp = float(S) / (2 * float(w)) - 1
    if crimp < 0:
        raise InputError(
            key="yarn length", value=float(S), allowed=f"at least the cell length {2 * w:g} m"
        )
    if crimp == 0:
        return 0.0
    k = 2 * np.sqrt(crimp)
    for _ in range(100):
        length = 2 / np.pi * ellipe(-(k**2))
        slope = 2 / np.pi * (ellipk(-(k**2)) - ellipe(-(k**2)))
        step = (length - 1 - crimp) * k / -slope
        k -= step
        if abs(step) <= 1e-15 * k:
            break
    return float(2 * w * k / np.pi)


@explain_frozen
@dataclass(frozen=True)
class Weave:
    """A weave of two yarn families.

    Parameters
    ----------
    warp, weft : Yarn
    warp_count, weft_count : [1/m] yarns per width of fabric
    pattern : Pattern, which yarn lies on top at each crossing

    Raises
    ------
    InputError : a count is not positive
    """

    warp: Yarn
    weft: Yarn
    warp_count: float
    weft_count: float
    pattern: Pattern = field(default=PLAIN, metadata=ADDED_LATER)

    def __post_init__(self):
        positive(self, "warp_count", "weft_count")

    @property
    def yarns(self) -> tuple[Yarn, Yarn]:
        """(warp, weft)"""
        return self.warp, self.weft

    @property
    def yarn_spacing(self) -> tuple[float, float]:
        """[m] from a warp yarn to the next, from a weft yarn to the next."""
        return 1 / self.warp_count, 1 / self.weft_count

    @property
    def w1(self) -> float:
        """[m] half the cell along the warp, 1 / (2 weft count) (eq. 4-2)."""
        return 0.5 / self.weft_count

    @property
    def w2(self) -> float:
        """[m] half the cell along the weft, 1 / (2 warp count)."""
        return 0.5 / self.warp_count

    @cached_property
    def w(self) -> tuple[float, float]:
        """(w1, w2) [m] half cell lengths along warp and weft."""
        return self.w1, self.w2

    @cached_property
    def S0(self) -> tuple[float, float]:
        """[m] lengths of the two yarns in one cell (eq. 4-4)."""
        return 2 * self.w1 * (1 + self.warp.crimp), 2 * self.w2 * (1 + self.weft.crimp)

    @property
    def S01(self) -> float:
        """[m] length of the warp in one cell."""
        return self.S0[0]

    @property
    def S02(self) -> float:
        """[m] length of the weft in one cell."""
        return self.S0[1]

    @cached_property
    def h0(self) -> tuple[float, float]:
        """[m] initial heights of the centrelines (eq. 4-5)."""
        first, second = (
            height_from_length(w, 2 * w * (1 + yarn.crimp / share))
            for w, yarn, share in zip(self.w, self.yarns, self.pattern.interlacings)
        )
        return first, second

    def of_plain_crossing(self) -> Weave:
        """Return the plain weave of the same yarns, spacings and heights: each change of sides, and so
        each crossing beside which both yarns change them, is shaped as in this weave.

        A yarn with floats has its crimp in fewer changes of sides: its length in each is 2w (1 + c/f),
        with the share f of the spacings in which it changes them.
        """
        warp, weft = (
            replace(yarn, crimp=yarn.crimp / share)
            for yarn, share in zip(self.yarns, self.pattern.interlacings)
        )
        return replace(self, warp=warp, weft=weft, pattern=PLAIN)

    def require_plain(self, model: str) -> None:
        """Refuse a weave that is not plain, for a `model` that holds for plain weave alone.

        Raises
        ------
        InputError : the weave is not plain
        """
        if not self.pattern.is_plain:
            raise InputError(key="weave", value=self.pattern.name, allowed=f"plain for {model}")

    def require_even(self, model: str) -> None:
        """Refuse a weave of which some yarns change sides more often than others of their family, for a
        `model` of one warp and one weft.

        Raises
        ------
        InputError : the yarns of a family are not alike
        """
        if not self.pattern.is_even:
            allowed = f"a weave whose warp yarns change sides equally often, and its weft yarns, for {model}"
            raise InputError(key="weave", value=self.pattern.name, allowed=allowed)

    def require_like_crossings(self, model: str) -> None:
        """Refuse a weave with crossings of several kinds, for a `model` that takes them all as one: a
        tie of 3/1 twill or of satin carries more than the mean, the middle of a float nothing.

        Raises
        ------
        InputError : crossings are not alike
        """
        if not self.pattern.has_like_crossings:
            allowed = (
                f"one whose crossings are all alike (plain, basket 2x2, twill 2/2) for {model}"
            )
            raise InputError(key="weave", value=self.pattern.name, allowed=allowed)

    @property
    def h01(self) -> float:
        """[m] initial height of the centreline of the warp."""
        return self.h0[0]

    @property
    def h02(self) -> float:
        """[m] initial height of the centreline of the weft."""
        return self.h0[1]

    @property
    def thickness(self) -> float:
        """[m] of the shell: twice the sum of the heights (section 6.6)."""
        return 2 * sum(self.h0)

    @property
    def cell_area(self) -> float:
        """[m2]"""
        return 4 * self.w1 * self.w2

    @property
    def cell_mass(self) -> float:
        """[kg] of the two yarns in one cell, crimp included."""
        return sum(S * yarn.linear_density for S, yarn in zip(self.S0, self.yarns))

    @cached_property
    def areal_density(self) -> float:
        """[kg/m2]"""
        return self.cell_mass / self.cell_area

    def tension_wave_speed(self, family: int) -> float:
        """Compute the speed [m/s] of a wave of tension along the straight yarns of a family, 0 for the
        warp, which carry the mass of both: sqrt(EA n / m)."""
        count = (self.warp_count, self.weft_count)[family]
        return (self.yarns[family].EA * count / self.areal_density) ** 0.5
