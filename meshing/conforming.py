"""Sections that conform: the face of each yarn that meets the other is the other's arch, so the yarns
touch everywhere.

The gap of `meshing.section_fit` is zero at every point if, and only if, with one free length kappa,

    q_1(y) = h_2 cos(pi y / 2 w_2) + kappa,    q_2(x) = h_1 cos(pi x / 2 w_1) - kappa

A lens of prescribed shape (sine, ellipse) fits a balanced weave only: where h_1 is several times h_2
it rides on the crest of the flat yarn. Of the yarn with kappa > 0 (that of the warp) the edges are
blunt, as wide as the cell allows; the other is narrower than its spacing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.weave import Weave
from meshing.section import Section

KIND = "conforming"


@dataclass(frozen=True)
class ConformingSection:
    """One section q(y) = arch cos(pi y / span) + offset, cut at `half_width`.

    Parameters
    ----------
    width : [m] requested: no wider than this
    arch, span : [m] height and cell length of the crossing yarn
    offset : [m] kappa, or minus kappa
    tip_thickness_ratio : [-] least thickness at the cut over that of the middle
    """

    width: float
    arch: float
    span: float
    offset: float
    tip_thickness_ratio: float

    kind = KIND

    @property
    def thickness(self) -> float:
        """[m] in the middle."""
        return 2 * (self.arch + self.offset)

    @property
    def half_width(self) -> float:
        """[m] from the middle to the cut: half of the width requested, or to where the tip is
        cut."""
        cosine = (self.tip_thickness_ratio * self.thickness / 2 - self.offset) / self.arch
        tip = self.span / np.pi * np.arccos(np.clip(cosine, -1, 1))
        return float(min(tip, self.width / 2))

    @property
    def area(self) -> float:
        """[m2] between the cuts."""
        y = self.half_width
        return 4 * (self.arch * self.span / np.pi * np.sin(np.pi * y / self.span) + self.offset * y)

    def half_thickness(self, y: ArrayLike) -> FloatArray:
        """Compute the half thickness q(y) [m] at the distances `y` [m] from the middle, |y| up to
        the half width."""
        return self.arch * np.cos(np.pi * np.asarray(y, float) / self.span) + self.offset

    @property
    def formula(self) -> str:
        """Return q at the distance v from the middle, in the language of gmsh."""
        return f"{float(self.arch)} * Cos(Pi * v / {float(self.span)}) + {float(self.offset)}"

    def grading(self, n: int) -> float:
        """Return the factor from one step of the mesh along the face to the next: they are equal."""
        return 1.0

    def stations(self, n: int) -> FloatArray:
        """Compute n + 1 positions y [m] from the middle to the cut, in equal steps."""
        return np.linspace(0, self.half_width, n + 1)


# what the mesher works with: a shape, its size, its thickness over the width, and the places of its
# mesh lines
YarnSection: TypeAlias = Section | ConformingSection


def conform(
    widths: Sequence[float], areas: Sequence[float], weave: Weave, tip_thickness_ratio: float
) -> tuple[ConformingSection, ConformingSection]:
    """Fit the two sections that touch everywhere, with areas in the ratio of `areas`.

    kappa gives area from one yarn to the other, so that both keep the ratio of their fibre volume
    fractions,

        A_1(kappa) / A_2(kappa) = A_s1 (1 + crimp_1) Vf0_2 / (A_s2 (1 + crimp_2) Vf0_1),

    and both are multiplied by what is left over: the room that the crimp leaves is filled.

    Parameters
    ----------
    widths : (warp, weft) [m] greatest widths
    areas : (warp, weft) [m2] requested; the sections have these times one common factor
    weave : Weave
    tip_thickness_ratio : [-]

    Returns
    -------
    sections : (ConformingSection, ConformingSection)

    Raises
    ------
    InputError : no crimp, or no kappa gives areas of this ratio
    """
    h1, h2 = weave.h0
    w1, w2 = weave.w
    if min(h1, h2) <= 0:
        raise InputError(
            "conforming sections need crimp in warp and weft: a straight yarn has no arch to fill"
        )

    def at(kappa):
        return (
            ConformingSection(widths[0], h2, 2 * w2, kappa, tip_thickness_ratio),
            ConformingSection(widths[1], h1, 2 * w1, -kappa, tip_thickness_ratio),
        )

    def excess(kappa):
        warp, weft = at(kappa)
        return np.log(warp.area / weft.area) - np.log(areas[0] / areas[1])

    edge = 1e-3  # of a height: thinner than that is no yarn
    low = -(1 - edge) * h2
    high = (1 - edge) * h1
    if excess(low) > 0 or excess(high) < 0:
        raise InputError(
            "no conforming sections have the fibre fractions of this fabric: give other widths"
        )
    return at(brentq(excess, low, high, xtol=1e-15))
