"""Material laws of other codes for a fabric, evaluated as those codes evaluate them: uncoupled curves
(*MAT_FABRIC FORM 14 of LS-DYNA: P_i = f_i(L_i - 1), tau = f(gamma)) and crimp exchange (/MAT/LAW58
of OpenRadioss, engine/source/materials/mat/mat058/sigeps58c.F).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray
from weavecell.decks.homogenised import HomogenisedFabric

# LAW58 is unstable unless its yarns have some bending stiffness
FLEX = 1e-3
# a fit looks at every third row and column of the plane, which is enough for a smooth law
_EVERY = 3


@dataclass(frozen=True)
class UncoupledCurves:
    """P = f(L - 1) of each direction, tau = f(gamma).

    Parameters
    ----------
    curves : two of (n, 2), engineering strain and nominal stress [Pa] of warp and weft
    trellis : (n, 2) shear angle [rad], stress [Pa]
    """

    curves: tuple[FloatArray, FloatArray]
    trellis: FloatArray
    lost: ClassVar[str] = (  # what it does not hold, in words
        "crimp exchange (each direction has a curve of its own), sliding of yarns at the crossovers, "
        "failure (nothing breaks)"
    )

    @classmethod
    def fit(cls, fabric: HomogenisedFabric, match: str) -> UncoupledCurves:
        """Fit the curves to a fabric, see `HomogenisedFabric.curve`."""
        return cls((fabric.curve(0, match), fabric.curve(1, match)), fabric.trellis())

    def stress(self, stretch1: ArrayLike, stretch2: ArrayLike) -> FloatArray:
        """Compute the nominal stress (2, ...) [Pa] along warp and weft."""
        pairs = zip(np.broadcast_arrays(stretch1, stretch2), (0, 1))
        return np.stack([self.uniaxial(stretch, family) for stretch, family in pairs])

    def uniaxial(self, stretch: FloatArray, family: int) -> FloatArray:
        """Compute the nominal stress [Pa] along one direction in uniaxial tension."""
        return np.interp(stretch - 1, *self.curves[family].T)

    def shear(self, gamma: FloatArray) -> FloatArray:
        """Compute the shear stress [Pa] at the angle between the yarns."""
        return np.interp(gamma, *self.trellis.T)


@dataclass(frozen=True)
class CrimpExchange:
    """/MAT/LAW58.

    Two straight zigzags of linear, incompressible yarns, one to a unit width and length (N1 = N2 =
    1): half length L, height H + y with H at rest, length D = 1 + S at rest,

        f = E (sqrt(L^2 + (H + y)^2) - D),   P = f cos(alpha),
        f_1 sin(alpha_1) + k_1 y_1 = f_2 sin(alpha_2) + k_2 y_2   with y_2 = -y_1 where they touch,

    k = Flex E H / D, and each side zero where they do not. The modulus of the yarn is E (1 + S).
    The law's viscosity is left out. Other counts would hold a fabric whose warp and weft counts
    differ exactly, but OpenRadioss takes the speed of sound from E alone, which grows with them: 27
    and 26 made the time step five times smaller than it need be.

    Parameters
    ----------
    E : (2,) [Pa] E1, E2
    crimp : (2,) [-] S1, S2
    trellis : (n, 2) shear angle [rad], stress [Pa] that works on it
    limit : (2,) true strain of the fabric at which a direction fails: that of uniaxial tension
    """

    E: FloatArray
    crimp: FloatArray
    trellis: FloatArray
    limit: FloatArray
    lost: ClassVar[str] = (
        "flattening of the yarns and the rounding of their path, sliding of yarns at the crossovers; failure "
        "(nothing breaks: /FAIL/FABRIC is a comment, since OpenRadioss takes the strain of the neighbouring element)"
    )

    @classmethod
    def fit(cls, fabric: HomogenisedFabric, match: str) -> CrimpExchange:
        """Fit the law: crimps and yarn modulus as they are, which is exact in uniaxial tension; or
        S1, S2 and one factor on both moduli by least squares over the plane, so that softer yarns
        of less crimp stand in for yarns that flatten."""
        whole = cls(fabric.modulus, fabric.crimp, fabric.trellis(), np.log(fabric.failure_stretch))

        def scale_cloth(scales):
            crimp = fabric.crimp * scales[:2]
            return replace(whole, crimp=crimp, E=scales[2] * fabric.modulus / (1 + crimp))

        if match == "uniaxial":
            return scale_cloth(np.ones(3))
        from scipy.optimize import least_squares

        L1, L2, inside = (values[::_EVERY, ::_EVERY] for values in fabric.plane)
        stress = fabric.stress(L1, L2)
        strength = fabric.strength[:, None, None]

        def error(scales):
            return ((scale_cloth(scales).stress(L1, L2) - stress) / strength)[:, inside].ravel()

        return scale_cloth(
            least_squares(error, [0.7, 0.7, 1.0], bounds=([0.02] * 3, [2.0, 2.0, 1.5])).x
        )

    @property
    def rest(self) -> tuple[FloatArray, FloatArray]:
        """Lengths and heights of half a wave at rest over its length in the fabric, each (2,) of
        warp and weft."""
        length = 1 + self.crimp
        return length, np.sqrt(length**2 - 1)

    def _yarn(self, family, stretch, y):
        """(f sin(alpha) + k y, P) of a yarn raised by y."""
        length, height = (of_both[family] for of_both in self.rest)
        stiffness = self.E[family]
        h = height + y
        now = np.hypot(stretch, h)
        force = stiffness * (now - length)
        return force * h / now + FLEX * stiffness * height / length * y, force * stretch / now

    def _free_rise(self, family, stretch):
        """Rise y of a yarn that nothing touches."""
        height = self.rest[1][family]
        return _root(lambda y: self._yarn(family, stretch, y)[0], -height, 1.0, stretch.shape)

    def stress(self, stretch1: ArrayLike, stretch2: ArrayLike) -> FloatArray:
        """Compute the nominal stress (2, ...) [Pa] along warp and weft, in equilibrium."""
        L1, L2 = np.broadcast_arrays(np.asarray(stretch1, float), np.asarray(stretch2, float))
        y1 = self._free_rise(0, L1)
        y2 = self._free_rise(1, L2)
        height = self.rest[1]
        both = _root(
            lambda y: self._yarn(0, L1, y)[0] - self._yarn(1, L2, -y)[0],
            -height[0],
            height[1],
            L1.shape,
        )
        touching = y1 + y2 < 0
        y1 = np.where(touching, both, y1)
        y2 = np.where(touching, -both, y2)
        return np.stack([self._yarn(0, L1, y1)[1], self._yarn(1, L2, y2)[1]])

    def uniaxial(self, stretch: FloatArray, family: int) -> FloatArray:
        """Compute the nominal stress [Pa] along one direction in uniaxial tension: crossing yarns
        are pushed out of the way."""
        return self._yarn(family, stretch, self._free_rise(family, stretch))[1]

    @property
    def table(self) -> FloatArray:
        """(n, 2) angle [degree] and stress [Pa] of its shear function, which is odd.

        The stress is that of a picture frame, F / (2 t L sin(pi/4 + gamma/2)) (Radioss manual,
        Airbag Fabric Material); the work of F on the frame makes it tau / cos(gamma).
        """
        gamma, stress = self.trellis.T
        half = np.column_stack([np.degrees(gamma), stress / np.cos(gamma)])
        return np.vstack([-half[:0:-1], half])

    def shear(self, gamma: FloatArray) -> FloatArray:
        """Compute the shear stress [Pa] at the angle between the yarns."""
        return np.interp(np.degrees(gamma), *self.table.T) * np.cos(gamma)


def _root(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, shape: tuple[int, ...]
) -> FloatArray:
    """Where a rising function of an array is zero, by bisection; `low` where it is positive there
    already."""
    a = np.full(shape, low)
    b = np.full(shape, high)
    for _ in range(50):
        middle = 0.5 * (a + b)
        above = function(middle) > 0
        a = np.where(above, a, middle)
        b = np.where(above, middle, b)
    return 0.5 * (a + b)


Law = UncoupledCurves | CrimpExchange
