"""The pattern of a weave: which yarn lies on top at each crossing of its repeat.

A pattern is written by its name ("plain", "basket 2x2", "twill 2/2", "satin 5", "crowfoot") or as on
point paper, a row for each warp yarn, + where it lies over the weft: "++--/-++-/--++/+--+". Names
that makers use are read too ("2/2 twill", "8HS", "matt 2x2").

Between two crossings a yarn changes sides or floats on. `Pattern.interlacings` is the share of
spacings over which it changes sides: 1 in plain weave, a half in 2x2 basket, 2/2 twill and crowfoot,
2/5 in satin 5. Models of this project that do not hold for every weave say so by `Weave.require_plain`
and `Weave.require_like_crossings`.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from functools import cached_property
from math import gcd

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError

ALLOWED = (
    'plain, a basket such as "basket 2x2", a twill such as "twill 2/2", a satin such as "satin 5", '
    'crowfoot, or rows of warp yarns such as "++--/-++-/--++/+--+"'
)
# yarns of a group of a basket, and warp yarns of the repeat of a twill or satin, that are read
LARGEST_GROUP = 6
LARGEST_REPEAT = 24
_PLAIN = re.compile(r"(plain|tabby|linen)( weave)?( 1/1)?|1/1( plain)?( weave)?")
_NUMBERS = r"(\d+) ?[x/] ?(\d+)"
_BASKET = re.compile(rf"(?:basket|matt|panama|hopsack)(?: ?weave)? {_NUMBERS}")
_TWILL = re.compile(rf"twill(?: weave)? {_NUMBERS}")
_SATIN = re.compile(r"satin(?: weave)? (\d+)(?: step (\d+))?")
_HARNESS = re.compile(r"(\d+)[ -]{0,3}(?:hs|(?:h|hs|harness|shaft|end)[ -]satin)(?: weave)?")
_TWILL_OF_HARNESSES = re.compile(r"(\d+)[ -]{0,3}(?:h|hs|harness|shaft|end)[ -](.*twill.*)")
_FIRST_NUMBERS = re.compile(rf"{_NUMBERS} (basket|matt|panama|hopsack|twill)(?: ?weave)?")
_CROWFOOT = re.compile(r"(crow ?foot|crow'?s ?foot)( satin)?( weave)?|satin 4")
_ROWS = re.compile(r"[+-]+(/[+-]+)+")


@dataclass(frozen=True)
class Symmetry:
    """A motion that takes warp yarn i to warp_sign i + warp, weft yarn j to weft_sign j + weft, as they are
    or upside down."""

    warp_sign: int
    weft_sign: int
    warp: int
    weft: int
    upside_down: bool

    @property
    def keeps_shear(self) -> bool:
        """Whether a sheared weave has it too: no mirror plane, nor an axis in the plane."""
        return self.warp_sign == self.weft_sign


@dataclass(frozen=True)
class Pattern:
    """The repeat of a weave.

    Parameters
    ----------
    rows : (warp yarns, weft yarns) True where the warp is on top
    name : as it is written

    Raises
    ------
    InputError : a yarn that never changes sides
    """

    rows: tuple[tuple[bool, ...], ...]
    name: str

    def __post_init__(self):
        for lines in (self.matrix, self.matrix.T):
            floating = lines.all(axis=1) | ~lines.any(axis=1)
            if floating.any():
                raise self._refused("one in which each yarn changes sides", self.name)

    @classmethod
    def read(cls, text: str) -> Pattern:
        """Read a pattern by its name, by a maker's name, or row by row.

        Raises
        ------
        InputError : no pattern, or one in which a yarn never changes sides
        """
        words = " ".join(re.split(r"[\s_,;()]+", text.lower())).strip()
        if found := _TWILL_OF_HARNESSES.fullmatch(words):
            return cls._twill_of_harnesses(int(found[1]), found[2], text)
        if found := _FIRST_NUMBERS.fullmatch(words):
            words = f"{found[3]} {found[1]}/{found[2]}"
        if found := _HARNESS.fullmatch(words):
            words = f"satin {found[1]}"
        if _PLAIN.fullmatch(words):
            return PLAIN
        if _CROWFOOT.fullmatch(words):
            return cls._with_wefts_on_top((0, 2, 3, 1), "crowfoot")
        if found := _BASKET.fullmatch(words):
            return cls._basket(int(found[1]), int(found[2]), text)
        if found := _TWILL.fullmatch(words):
            return cls._twill(int(found[1]), int(found[2]), text)
        if found := _SATIN.fullmatch(words):
            return cls._satin(int(found[1]), found[2], text)
        if _ROWS.fullmatch(words):
            rows = words.split("/")
            if len({len(row) for row in rows}) == 1:
                return cls(tuple(tuple(mark == "+" for mark in row) for row in rows), words)
        raise cls._refused(ALLOWED, text)

    @classmethod
    def _basket(cls, warps, wefts, text):
        if not (1 <= warps <= LARGEST_GROUP and 1 <= wefts <= LARGEST_GROUP):
            raise cls._refused(f"a basket of groups of 1 to {LARGEST_GROUP} yarns", text)
        if warps == wefts == 1:
            return PLAIN
        group = np.arange(2 * warps)[:, None] // warps, np.arange(2 * wefts) // wefts
        return cls._of(PLAIN.is_warp_up(*group), f"basket {warps}x{wefts}")

    @classmethod
    def _twill(cls, over, under, text):
        repeat = over + under
        if min(over, under) < 1 or not 2 < repeat <= LARGEST_REPEAT:
            raise cls._refused(f"a twill such as 2/2, over 3 to {LARGEST_REPEAT} yarns", text)
        place = np.arange(repeat) - np.arange(repeat)[:, None]
        return cls._of(place % repeat < over, f"twill {over}/{under}")

    @classmethod
    def _twill_of_harnesses(cls, harnesses, words, text):
        """The twill of words behind a number of harnesses, which is that of its repeat."""
        if re.search(_NUMBERS, words) is None:
            likely = f"twill {harnesses - 1}/1"
            if harnesses % 2 == 0:
                likely += f" or twill {harnesses // 2}/{harnesses // 2}"
            raise cls._refused(f"more than the number of harnesses, such as {likely}", text)
        twill = cls.read(words)
        if len(twill.rows) != harnesses:
            raise cls._refused(f"{twill.name} of {len(twill.rows)} harnesses", text)
        return twill

    @classmethod
    def _satin(cls, repeat, step, text):
        steps = [each for each in range(2, repeat - 1) if gcd(each, repeat) == 1]
        if not steps or repeat > LARGEST_REPEAT:
            allowed = f"a satin of 5, 7 to {LARGEST_REPEAT} yarns; of 4 it is crowfoot"
            raise cls._refused(allowed, text)
        name = f"satin {repeat}"
        used = steps[0]
        if step is not None:
            used = int(step)
            name += f" step {used}"
        if used not in steps:
            raise cls._refused(f"a step of {', '.join(map(str, steps))}", text)
        return cls._with_wefts_on_top([used * yarn % repeat for yarn in range(repeat)], name)

    @classmethod
    def _with_wefts_on_top(cls, places, name):
        """The pattern in which each warp yarn goes under one weft, at its place."""
        own = np.ones((len(places), len(places)), bool)
        own[np.arange(len(places)), places] = False
        return cls._of(own, name)

    @classmethod
    def _of(cls, own, name):
        return cls(tuple(tuple(map(bool, row)) for row in own), name)

    @staticmethod
    def _refused(allowed, text):
        return InputError(key="weave", value=text, allowed=allowed)

    @cached_property
    def matrix(self) -> NDArray[np.bool_]:
        """(warp yarns, weft yarns) of the repeat: whether the warp is on top."""
        return np.array(self.rows)

    @property
    def is_plain(self) -> bool:
        """Whether each yarn changes sides between all crossings."""
        return self.interlacings == (1.0, 1.0)

    @cached_property
    def interlacings(self) -> tuple[float, float]:
        """(warp, weft) [-] mean share of spacings over which a yarn changes sides."""
        along_warp, along_weft = self._changes
        return float(along_warp.mean()), float(along_weft.mean())

    @property
    def is_even(self) -> bool:
        """Whether all yarns of a family change sides equally often."""
        along_warp, along_weft = self._changes
        counts = along_warp.sum(axis=1), along_weft.sum(axis=0)
        return all(np.ptp(count) == 0 for count in counts)

    @cached_property
    def turns(self) -> tuple[IntArray, IntArray]:
        """(warp yarns, weft yarns) of the repeat: on how many of its two sides (0, 1, 2) the warp, the
        weft of a crossing changes sides."""
        along_warp, along_weft = (changes.astype(int) for changes in self._changes)
        return (
            along_warp + np.roll(along_warp, 1, axis=1),
            along_weft + np.roll(along_weft, 1, axis=0),
        )

    @property
    def has_like_crossings(self) -> bool:
        """Whether warp and weft change sides beside every crossing equally often: in 2x2 basket and 2/2
        twill both on one side of each; in 3/1 twill on both sides of a tie and on none in the middle of
        a float, in 1x2 basket the weft on both sides and the warp on one."""
        return bool(np.ptp(np.concatenate([turns.ravel() for turns in self.turns])) == 0)

    def find_mirror(self, family: int) -> int | None:
        """Find the first yarn of the family 0 (warp) or 1 (weft) whose middle line is an axis of
        symmetry of the pattern; None without one."""
        own = np.moveaxis(self.matrix, family, 0)
        for yarn in range(len(own)):
            aside = np.arange(len(own))
            if np.array_equal(own[(yarn + aside) % len(own)], own[(yarn - aside) % len(own)]):
                return yarn
        return None

    @cached_property
    def centre(self) -> tuple[int, int]:
        """Numbers of the warp yarn and of the weft yarn that cross in the middle of a panel: those
        of axes of symmetry, else 0."""
        warp, weft = (self.find_mirror(family) or 0 for family in range(2))
        return warp, weft

    @cached_property
    def cell(self) -> tuple[int, int, int]:
        """(warp yarns, weft yarns, parity) of the least upright cell that repeats along both families: upside
        down (parity -1) where half the repeat along each does, else as it is (1): 1 x 1 of plain, 2 x 2 of
        basket 2x2 and twill 2/2."""
        own = self.matrix
        warps, wefts = own.shape
        if warps % 2 or wefts % 2:
            return warps, wefts, 1
        shifted = (np.roll(own, warps // 2, 0), np.roll(own, wefts // 2, 1))
        if all(np.array_equal(half, ~own) for half in shifted):
            return warps // 2, wefts // 2, -1
        return warps, wefts, 1

    @cached_property
    def symmetries(self) -> tuple[Symmetry, ...]:
        """What takes the weave into itself, warp yarns to warp yarns, up to its repeat."""
        own = self.matrix
        warps, wefts = own.shape
        found = []
        for turned in itertools.product(
            (1, -1), (1, -1), range(warps), range(wefts), (False, True)
        ):
            symmetry = Symmetry(*turned)
            warp = symmetry.warp_sign * np.arange(warps) + symmetry.warp
            weft = symmetry.weft_sign * np.arange(wefts) + symmetry.weft
            image = self.is_warp_up(warp[:, None], weft)
            if np.array_equal(image, own ^ symmetry.upside_down):
                found.append(symmetry)
        return tuple(found)

    @property
    def holds_yarns(self) -> bool:
        """Whether each yarn is turned round by a symmetry of the weave, so that equal pulls at both its
        ends do not move it along."""
        for family, yarns in enumerate(self.matrix.shape):
            of = "warp", "weft"
            own, along = of[family], of[1 - family]
            turned = {
                yarn
                for each in self.symmetries
                for yarn in range(yarns)
                if getattr(each, f"{along}_sign") < 0
                and (getattr(each, f"{own}_sign") * yarn + getattr(each, own) - yarn) % yarns == 0
            }
            if len(turned) < yarns:
                return False
        return True

    @property
    def _changes(self):
        """Whether warp, weft change sides behind each crossing."""
        own = self.matrix
        return own != np.roll(own, -1, axis=1), own != np.roll(own, -1, axis=0)

    def is_warp_up(self, warp: ArrayLike, weft: ArrayLike) -> NDArray[np.bool_]:
        """Return whether the warp is on top where yarns of these numbers cross; the numbers may be
        negative, and are broadcast."""
        first, second = np.broadcast_arrays(warp, weft)
        own = self.matrix
        return own[first % own.shape[0], second % own.shape[1]]

    def sides(self, family: int, yarn: ArrayLike, crossing: ArrayLike) -> FloatArray:
        """Return 1 where a yarn of the family 0 (warp) or 1 (weft) is on top of the crossing yarn of
        a number, -1 where it is below."""
        if family == 0:
            return np.where(self.is_warp_up(yarn, crossing), 1.0, -1.0)
        return np.where(self.is_warp_up(crossing, yarn), -1.0, 1.0)

    def rotated(self) -> Pattern:
        """Return the pattern of the fabric rotated by a right angle about the crossing of its first yarns:
        its weft is the warp then, and on top there where it was."""
        name = self.name
        if not self.is_plain:
            name = f"{name}, rotated"
        return self._of(~np.roll(np.rot90(self.matrix), 1, axis=0), name)


PLAIN = Pattern(((True, False), (False, True)), "plain")
