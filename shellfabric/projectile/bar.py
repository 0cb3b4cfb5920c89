"""The projectile as an elastic-plastic bar along its axis.

The projectile of the thesis is a steel cylinder of 5.5 x 42 mm that is bored to 3 g; the dimensions
of the bore are not given (erratum E-37). Here it is 4.5 mm wide, from the tail, and as deep as the
mass requires. Tip and tail then swing about the centre of mass with the period of the first
free-free mode, 2 L / c for a bar of one section.

In a run the bar is the body of the projectile (`dynamics.BarBody`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import pi
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.materials import Isotropic, load, round_projectile
from shellfabric.parts import own_steps


@dataclass(frozen=True)
class Bar:
    """A straight bar of cylindrical sections, from the tip backwards.

    Parameters
    ----------
    sections : tuple of (length [m], area [m2])
    material : Isotropic
    elements : number of elements, about equally long
    cfl : Courant factor, the bar's own time step over its stability bound

    Raises
    ------
    InputError : no section, a length or area that is not positive, fewer than 2 elements a section
    """

    sections: tuple
    material: Isotropic = field(default_factory=lambda: load("steel"))
    elements: int = 84
    cfl: float = 0.9

    def __post_init__(self):
        if not self.sections or not all(length > 0 and area > 0 for length, area in self.sections):
            raise InputError(
                key="sections", value=self.sections, allowed="lengths and areas above 0"
            )
        if self.elements < 2 * len(self.sections):
            raise InputError(key="elements", value=self.elements, allowed="at least 2 a section")
        if not 0 < self.cfl <= 1:
            raise InputError(key="cfl", value=self.cfl, allowed="above 0 and at most 1")

    @classmethod
    def cylinder(
        cls,
        mass: float | None = None,
        *,
        diameter: float | None = None,
        length: float | None = None,
        bore_diameter: float | None = None,
        material: Isotropic | None = None,
        **changes: Any,
    ) -> Bar:
        """Bore a cylinder from its tail to a given mass; the defaults are those of the thesis.

        Raises
        ------
        InputError : a mass that the solid cylinder has not, or that the bore cannot leave
        """
        source = round_projectile()
        if material is None:
            material = load("steel")
        given = {"mass": mass, "diameter": diameter, "length": length, "bore": bore_diameter}
        chosen = source | {key: value for key, value in given.items() if value is not None}
        mass = chosen["mass"]
        length = chosen["length"]
        full = pi / 4 * chosen["diameter"] ** 2
        tube = pi / 4 * (chosen["diameter"] ** 2 - chosen["bore"] ** 2)
        solid = material.density * full * length
        depth = (solid - mass) / (material.density * (full - tube))
        if not 0 <= depth < length:
            least = material.density * tube * length
            raise InputError(
                key="mass", value=mass, allowed=f"above {least:.4g} and at most {solid:.4g} kg"
            )
        if depth > 0:
            return cls(((length - depth, full), (depth, tube)), material, **changes)
        return cls(((length, full),), material, **changes)

    @classmethod
    def full(cls, **changes: Any) -> Bar:
        """Return the cylinder of the thesis without a bore: density and modulus so much less that
        mass and wave speed are its own.

        Its first mode is 2 L / c = 17.0 us, the period of tip and tail in the thesis (erratum
        E-37).
        """
        source = round_projectile()
        steel = load("steel")
        area = pi / 4 * source["diameter"] ** 2
        share = source["mass"] / (steel.density * area * source["length"])
        return cls(
            ((source["length"], area),),
            replace(steel, density=share * steel.density, modulus=share * steel.modulus),
            **changes,
        )

    @property
    def length(self) -> float:
        """[m]"""
        return sum(length for length, _ in self.sections)

    @property
    def mass(self) -> float:
        """[kg]"""
        return self.material.density * sum(length * area for length, area in self.sections)

    @property
    def mesh(self) -> tuple[FloatArray, FloatArray]:
        """h, area : (n,) [m], [m2] of the elements, from the tip."""
        h = []
        area = []
        for length, section in self.sections:
            n = max(2, round(self.elements * length / self.length))
            h += [length / n] * n
            area += [section] * n
        return np.array(h), np.array(area)

    @property
    def nodal_mass(self) -> FloatArray:
        """(n + 1,) [kg] half of each element's to each of its nodes."""
        h, area = self.mesh
        own = 0.5 * self.material.density * h * area
        return np.append(own, 0.0) + np.append(0.0, own)

    @property
    def longest_step(self) -> float:
        """[s] bound of the bar's own time step, 2 / w of its fastest mode."""
        return 2 / np.sqrt(self._squares(-1))

    @property
    def period(self) -> float:
        """[s] of the first free-free mode; 2 L / c for one section."""
        return 2 * pi / np.sqrt(self._squares(1))

    @property
    def yield_force(self) -> float:
        """[N] at which the thinnest section yields."""
        return self.material.yield_stress * min(area for _, area in self.sections)

    def substeps(self, dt: float) -> int:
        """Return the number of steps of the bar in a step `dt` [s] of the target."""
        return own_steps(dt, self.cfl * self.longest_step)

    def _squares(self, number):
        """[1/s2] square of a frequency; 0 is the rigid motion, -1 the fastest."""
        h, area = self.mesh
        k = self.material.modulus * area / h
        mass = self.nodal_mass
        diagonal = (np.append(k, 0.0) + np.append(0.0, k)) / mass
        beside = -k / np.sqrt(mass[:-1] * mass[1:])
        number %= len(mass)
        from scipy.linalg import eigh_tridiagonal

        return float(
            eigh_tridiagonal(diagonal, beside, True, select="i", select_range=(number, number))[0]
        )
