"""The projectile as an elastic-plastic bar along its axis, and whether a run needs it.

The projectile of the thesis is a steel cylinder of 5.5 x 42 mm that is bored to 3 g; the dimensions of the bore are not
given (erratum E-37). Here it is 4.5 mm wide, from the tail, and as deep as the mass requires. Tip and tail then swing
about the centre of mass with the period of the first free-free mode, 2 L / c for a bar of one section.

In a run the bar is the body of the projectile (`dynamics`, `bar_kernels.advance_bar`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import ceil, inf, pi
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.materials import Isotropic, load, round_projectile

# Periods of contact (`contact_time`) from which on a rigid projectile is enough (docs/reports/numerics.md)
ENOUGH = 3.0


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
        """A cylinder bored from its tail to a given mass; the defaults are those of the thesis.

        Raises
        ------
        InputError : a mass that the solid cylinder has not, or that the bore cannot leave
        """
        source = round_projectile()
        material = load("steel") if material is None else material
        mass, diameter, length, bore = (
            source[key] if value is None else value
            for key, value in (
                ("mass", mass),
                ("diameter", diameter),
                ("length", length),
                ("bore", bore_diameter),
            )
        )
        full, tube = pi / 4 * diameter**2, pi / 4 * (diameter**2 - bore**2)
        solid = material.density * full * length
        depth = (solid - mass) / (material.density * (full - tube))
        if not 0 <= depth < length:
            least = material.density * tube * length
            raise InputError(
                key="mass", value=mass, allowed=f"above {least:.4g} and at most {solid:.4g} kg"
            )
        sections = ((length - depth, full), (depth, tube)) if depth > 0 else ((length, full),)
        return cls(sections, material, **changes)

    @classmethod
    def full(cls, **changes: Any) -> Bar:
        """The cylinder of the thesis without a bore: density and modulus so much less that mass and wave speed are its
        own.

        Its first mode is 2 L / c = 17.0 us, the period of tip and tail in the thesis (erratum E-37).
        """
        source, steel = round_projectile(), load("steel")
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
        h, area = [], []
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
        """Number of steps of the bar in a step `dt` [s] of the target."""
        return max(1, ceil(dt / (self.cfl * self.longest_step)))

    def _squares(self, number):
        """[1/s2] square of a frequency; 0 is the rigid motion, -1 the fastest."""
        h, area = self.mesh
        k, mass = self.material.modulus * area / h, self.nodal_mass
        diagonal = (np.append(k, 0.0) + np.append(0.0, k)) / mass
        beside = -k / np.sqrt(mass[:-1] * mass[1:])
        number %= len(mass)
        from scipy.linalg import eigh_tridiagonal

        return float(
            eigh_tridiagonal(diagonal, beside, True, select="i", select_range=(number, number))[0]
        )


@dataclass(frozen=True)
class Rigidity:
    """Whether a rigid projectile would have done.

    Parameters
    ----------
    contact_time, period : [s]
    force, yield_force : [N] that pressed on it for half a period, and at which its thinnest section yields
    enough : bool
    elastic : whether the shot had the elastic projectile
    """

    contact_time: float
    period: float
    enough: bool
    force: float = 0.0
    yield_force: float = inf
    elastic: bool = False

    def __str__(self):
        periods = self.contact_time / self.period
        times = f"contact lasts {1e6 * self.contact_time:.3g} us, {periods:.3g} periods of the bar"
        times = f"{times} ({1e6 * self.period:.3g} us)"
        advice = (
            "a rigid projectile is not enough" if self.elastic else "use the elastic projectile"
        )
        if self.force > self.yield_force:
            forces = f"{self.force:.0f} N press on it, and its thinnest section yields at {self.yield_force:.0f} N"
            return f"{times}; {forces}: {advice}"
        verdict = (
            "a rigid projectile is enough" if self.enough else f"tip and tail move apart: {advice}"
        )
        return f"{times}: {verdict} (from {ENOUGH:g} periods on)"


def rigid_is_enough(
    contact_time: float,
    bar_period: float,
    force: float = 0.0,
    yield_force: float = inf,
    *,
    elastic: bool = False,
) -> Rigidity:
    """Compare the time of contact with the period of the bar, both [s]; see ENOUGH. And the force, `held_force`, with
    that at which it yields, both [N]: a wall that is squeezed takes energy that a rigid body would have to keep.

    Raises
    ------
    InputError : a time that is not positive
    """
    for key, value in (("contact_time", contact_time), ("bar_period", bar_period)):
        if not 0 < value < inf:
            raise InputError(key=key, value=value, allowed="above 0")
    enough = contact_time >= ENOUGH * bar_period and force <= yield_force
    return Rigidity(contact_time, bar_period, enough, float(force), float(yield_force), elastic)


def held_force(t: FloatArray, force: FloatArray, span: float) -> float:
    """[N] largest mean over a span [s] of the force in a history (n,) [s], (n,) [N] of even steps.

    A blow that is shorter than half a period does not reach the thin sections behind the tip as a force.
    """
    width = max(1, round(span / (t[1] - t[0]))) if len(t) > 1 else 1
    total = np.concatenate([[0.0], np.cumsum(np.abs(force)), np.full(width, np.sum(np.abs(force)))])
    return float(np.max(total[width:] - total[:-width], initial=0.0)) / width


def contact_time(t: FloatArray, force: FloatArray, period: float) -> float:
    """[s] for which the largest mean force over a period of the bar would have to act to give the impulse.

    Parameters
    ----------
    t, force : (n,) [s], (n,) [N] history of even steps
    period : [s] of the bar; what is shorter the bar does not follow

    The momentary largest force instead of that mean would depend on the mesh: a finer one begins with a higher and
    shorter peak of the same impulse. A half sine of a duration T above the period P gives (2 T / pi) x / sin x with
    x = pi P / (2 T); what is shorter than the period gives the period.

    Raises
    ------
    InputError : a history without force
    """
    t, force = np.asarray(t, float), np.abs(np.asarray(force, float))
    if not np.max(force, initial=0.0) > 0:
        raise InputError("the projectile was never touched")
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(t)) / held_force(t, force, period))
