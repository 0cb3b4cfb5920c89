"""The section of a yarn: a lens that is symmetric about both axes, with its two sharp tips cut off.

    half thickness   q(y) = (t/2) cos(pi y / W)          "sine"     (thesis Figure A-7, left)
                     q(y) = (t/2) sqrt(1 - (2y/W)^2)     "ellipse"  (Figure A-7, right)

over |y| <= c W/2. The cut c is where q has fallen to the tip thickness ratio times t/2, so that the
outermost element has a height; W is the width of the lens before the cut, t its thickness. The area
between the cuts is

    A = t W a(c),   a = (2/pi) sin(pi c/2)   or   (c sqrt(1 - c^2) + arcsin c) / 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, positive
from fabrics.base.errors import InputError

KINDS = ("sine", "ellipse")
TIP_THICKNESS_RATIO = (0.01, 0.5)


@dataclass(frozen=True)
class Section:
    """One yarn section, in the vertical plane across the yarn.

    Parameters
    ----------
    kind : "sine" or "ellipse"
    width : [m] W of the lens before its tips are cut
    thickness : [m] t in the middle
    tip_thickness_ratio : [-] thickness at the cut over t

    Raises
    ------
    InputError : unknown kind, a dimension that is not positive, a tip thickness ratio outside 0.01
        .. 0.5
    """

    kind: str
    width: float
    thickness: float
    tip_thickness_ratio: float

    def __post_init__(self):
        if self.kind not in KINDS:
            raise InputError(key="section", value=self.kind, allowed=" or ".join(KINDS))
        positive(self, "width", "thickness", "tip_thickness_ratio")
        low, high = TIP_THICKNESS_RATIO
        if not low <= self.tip_thickness_ratio <= high:
            raise InputError(
                key="tip_thickness_ratio",
                value=self.tip_thickness_ratio,
                allowed=f"from {low:g} to {high:g}",
            )

    @classmethod
    def of_area(cls, kind: str, width: float, area: float, tip_thickness_ratio: float) -> Section:
        """Return the section of this width whose area [m2] between the cuts is `area`."""
        unit = cls(kind, width, 1.0, tip_thickness_ratio)
        return cls(kind, width, area / unit.area, tip_thickness_ratio)

    @property
    def cut(self) -> float:
        """[-] place of the cut, as a fraction of the half width."""
        if self.kind == "sine":
            return 2 / np.pi * np.arccos(self.tip_thickness_ratio)
        return float(np.sqrt(1 - self.tip_thickness_ratio**2))

    @property
    def half_width(self) -> float:
        """[m] from the middle to the cut."""
        return self.cut * self.width / 2

    @property
    def area(self) -> float:
        """[m2] between the cuts."""
        c = self.cut
        if self.kind == "sine":
            return self.thickness * self.width * 2 / np.pi * np.sin(np.pi * c / 2)
        return self.thickness * self.width * (c * np.sqrt(1 - c * c) + np.arcsin(c)) / 2

    def half_thickness(self, y: ArrayLike) -> FloatArray:
        """Compute the half thickness q(y) [m] at the distances `y` [m] from the middle, |y| up to
        the half width."""
        eta = np.clip(2 * abs(np.asarray(y, float)) / self.width, 0, 1)
        shape = np.cos(np.pi / 2 * eta) if self.kind == "sine" else np.sqrt(1 - eta**2)
        return self.thickness / 2 * shape

    @property
    def formula(self) -> str:
        """Return q at the distance v from the middle, in the language of gmsh."""
        half = float(self.thickness / 2)
        width = float(self.width)
        if self.kind == "sine":
            return f"{half} * Cos(Pi * v / {width})"
        return f"{half} * Sqrt(1 - (2 * v / {width})^2)"

    def grading(self, n: int) -> float:
        """Compute the factor from one step of the mesh along the face to the next, from the middle to
        the cut.

        1 for a sine. n steps of an ellipse shrink towards its steep end as steps of equal angle do:
        the area between its mesh lines is then of order 2.
        """
        if self.kind == "sine" or n < 2:
            return 1.0
        y = self.stations(n)
        steps = np.hypot(np.diff(y), np.diff(self.half_thickness(y)))
        return float((steps[-1] / steps[0]) ** (1 / (n - 1)))

    def stations(self, n: int) -> FloatArray:
        """Compute n + 1 positions y [m] from the middle to the cut: equal steps of y, or of the angle
        of the ellipse."""
        if self.kind == "sine":
            return np.linspace(0, self.half_width, n + 1)
        y = self.width / 2 * np.sin(np.linspace(0, np.arcsin(self.cut), n + 1))
        y[-1] = self.half_width
        return y
