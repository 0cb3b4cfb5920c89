"""The cell of a fabric as a membrane: the stresses to which the laws of other codes are fitted.

Stresses are nominal: force over width and thickness at rest. A force N [N] in each warp yarn is the
stress N warp_count / thickness.

L1, L2 [-] are the stretches of the fabric along warp and weft. The shear angle gamma [rad] is the
loss of the right angle between the yarns; its stress is tau [Pa].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import BoolArray, FloatArray
from fabrics.base.errors import InputError
from fabrics.trellis import TrellisShear
from shellfabric.cell.model import CellModel

# tests that a law can be fitted to
MATCHES = ("plane", "uniaxial")
# points of a curve up to the strength
_POINTS = 81
# points along each side of the biaxial plane
_PLANE = 81
# a curve is continued to so many times its last strain, since codes differ in how they extrapolate
_FURTHER = 2.0
# [rad] shear angle at which a shear curve ends
_STEEPEST = np.radians(80)


@dataclass(frozen=True)
class HomogenisedFabric:
    """A cell and its trellis law, as stresses of a membrane.

    Parameters
    ----------
    model : CellModel

    Raises
    ------
    InputError : a fabric without [shear]
    """

    model: CellModel

    def __post_init__(self):
        if self.model.fabric.shear is None:
            raise InputError(f"fabric {self.model.fabric.name} has no [shear]", allowed="given one")

    @property
    def shear(self) -> TrellisShear:
        """The trellis law."""
        assert self.model.fabric.shear is not None
        return self.model.fabric.shear

    @property
    def thickness(self) -> float:
        """[m] of the membrane."""
        return self.model.fabric.weave.thickness

    @property
    def density(self) -> float:
        """[kg/m3] of the membrane, which has the areal density of the fabric."""
        return self.model.fabric.weave.areal_density / self.thickness

    @property
    def smear(self) -> FloatArray:
        """(2,) [1/m2] nominal stress of 1 N in each yarn of warp and weft."""
        weave = self.model.fabric.weave
        return np.array([weave.warp_count, weave.weft_count]) / self.thickness

    @property
    def modulus(self) -> FloatArray:
        """(2,) [Pa] of straight yarns of warp and weft."""
        return self.smear * [yarn.EA for yarn in self.model.fabric.weave.yarns]

    @property
    def strength(self) -> FloatArray:
        """(2,) [Pa] nominal, of straight yarns of warp and weft."""
        return self.smear * [yarn.strength for yarn in self.model.fabric.weave.yarns]

    @property
    def crimp(self) -> FloatArray:
        """(2,) [-] of warp and weft."""
        return np.array([yarn.crimp for yarn in self.model.fabric.weave.yarns])

    @property
    def failure_stretch(self) -> FloatArray:
        """(2,) [-] of warp and weft in uniaxial tension."""
        strains = [yarn.failure_strain for yarn in self.model.fabric.weave.yarns]
        return (1 + self.crimp) * (1 + np.array(strains))

    def stress(self, stretch1: ArrayLike, stretch2: ArrayLike) -> FloatArray:
        """Compute the nominal stress (2, ...) [Pa] along warp and weft."""
        force = self.model.solve(stretch1, stretch2)
        return np.stack([force["N1"] * self.smear[0], force["N2"] * self.smear[1]])

    def uniaxial(self, family: int) -> tuple[FloatArray, FloatArray]:
        """Compute (stretch, nominal stress [Pa]) of one direction in uniaxial tension, up to the
        strength.

        The crossing yarns have no tension, so they do not press on the loaded ones, which are
        straight once their crimp is gone.
        """
        stretch = np.linspace(1, self.failure_stretch[family], _POINTS)
        stretch = np.union1d(stretch, [1 + self.crimp[family]])
        return stretch, self.model.alone(family, stretch) * self.smear[family]

    @cached_property
    def plane(self) -> tuple[FloatArray, FloatArray, BoolArray]:
        """(L1, L2, inside), each (n, n): stretches from rest on, and whether both yarns are below
        their strengths."""
        L1, L2 = np.meshgrid(
            *(np.linspace(1, high, _PLANE) for _, high in self.model.range()), indexing="ij"
        )
        state = self.model.solve(L1, L2)
        warp, weft = self.model.fabric.weave.yarns
        return L1, L2, (state["T1"] <= warp.strength) & (state["T2"] <= weft.strength)

    def curve(self, family: int, match: str) -> FloatArray:
        """Compute the curve (n, 2) of one direction: engineering strain, nominal stress [Pa].

        Beyond the strength it continues with the modulus of the yarns.

        family : 0 warp, 1 weft
        match : "uniaxial" for tension along this direction alone; "plane" for the mean over the
            stretches of the other direction in the biaxial `plane`

        Of all curves of one stretch this mean is nearest to the plane (least squares). It does not
        begin at zero stress, since stretched crossing yarns load a direction at rest. A material law
        has no stress at rest, so the beginning is limited to the modulus of the yarns.
        """
        if match == "uniaxial":
            stretch, stress = self.uniaxial(family)
        else:
            L1, L2, inside = self.plane
            if family == 0:
                within = inside
            else:
                within = inside.T
            count = within.sum(axis=1)
            rows = np.moveaxis(self.stress(L1, L2)[family], family, 0)
            mean = np.where(within, rows, 0).sum(axis=1)[count > 0] / count[count > 0]
            stretch = (L1[:, 0] if family == 0 else L2[0])[count > 0]
            stress = np.minimum(np.maximum.accumulate(mean), self.modulus[family] * (stretch - 1))
        points = np.column_stack([stretch - 1, np.maximum(stress, 0)])
        end = points[-1]
        reach = _FURTHER * points[-1, 0]
        return np.vstack([points, [reach, end[1] + self.modulus[family] * (reach - end[0])]])

    def trellis(self) -> FloatArray:
        """Compute the curve (n, 2), shear angle [rad] and stress [Pa], to 60 degrees or beyond
        locking."""
        law = self.shear
        last = min(max(np.pi / 3, 1.2 * law.gamma2), _STEEPEST)
        parts = [0.0], np.linspace(law.gamma1, law.gamma2, 41), np.linspace(law.gamma2, last, 9)
        gamma = np.unique(np.concatenate(parts))
        return np.column_stack([gamma, law.stress(gamma)])
