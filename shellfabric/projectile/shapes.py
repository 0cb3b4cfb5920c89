"""Shapes of the projectile's nose: all that is known of a shape but its distance (`sdf_kernels`).

A new shape is one entry here and its distance there; a number of its own is also a field of
`Projectile`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin, tan
from typing import Any

# of Projectile, of the body of metal alone
OF_METAL = (
    "core",
    "jacket",
    "jacket_thickness",
    "bare_tip",
    "open_base",
    "cavity_diameter",
    "cavity_depth",
    "element_size",
)


@dataclass(frozen=True)
class Shape:
    """A shape of a nose.

    Parameters
    ----------
    words : for the reader
    form : function of a Projectile that gives the numbers which its distance needs
    shoulder : function of a Projectile that gives the depth [m] from which it has its full width
    keys : of the Projectile, that this shape alone has
    least_volume : [-] over that of the cylinder about it
    optional : keys likewise, which may be left out
    pointed : whether the tip is a point of the axis that a mesh has to meet
    turned : whether it looks alike from all sides
    """

    words: str
    form: Callable[[Any], Any] = lambda shot: ()
    shoulder: Callable[[Any], float] = lambda shot: shot.radius
    keys: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    least_volume: float = 1.0
    pointed: bool = False
    turned: bool = True


def _cone(shot):
    """The shoulder's centre lies where the flank is tangent to tip and shoulder."""
    tip = shot.tip_radius
    rho = shot.edge_radius
    angle = shot.half_angle
    shoulder = (tip - rho - (shot.radius - rho) * cos(angle)) / sin(angle) - tip
    return tip, sin(angle), cos(angle), shoulder


def chisel(shot: Any) -> tuple[float, float, float]:
    """Return half the strip of the body K within, whose flats are set back by the edge radius."""
    return (
        0.5 * shot.flat_width - shot.edge_radius * tan(0.5 * shot.flat_angle),
        sin(shot.flat_angle),
        cos(shot.flat_angle),
    )


def _chisel_shoulder(shot):
    flat = shot.radius - shot.edge_radius - chisel(shot)[0]
    return shot.edge_radius + flat * tan(shot.flat_angle)


# in the order of their numbers in `sdf_kernels`
SHAPES = {
    "flat": Shape("a cylinder", shoulder=lambda shot: shot.edge_radius),
    "hemisphere": Shape("a round-nosed cylinder", least_volume=2 / 3),
    "cone": Shape(
        "a conical projectile",
        _cone,
        lambda shot: -_cone(shot)[3],
        ("half_angle", "tip_radius"),
        least_volume=1 / 3,
        pointed=True,
    ),
    "sphere": Shape("a sphere"),
    "chisel": Shape(
        "a chisel-nosed fragment simulator",
        chisel,
        _chisel_shoulder,
        ("flat_width", "flat_angle"),
        least_volume=1 / 2,
        turned=False,
    ),
    "stl": Shape(
        "a body from an STL file",
        lambda shot: shot.solid.form,
        lambda shot: shot.solid.shoulder,
        ("solid",),
        pointed=True,
        turned=False,
    ),
    "ogive": Shape(
        "a bullet with an elliptic nose",
        lambda shot: (shot.nose_length, shot.tip_diameter or 0.0),
        shoulder=lambda shot: shot.nose_length,
        keys=("nose_length",),
        optional=("tip_diameter",),
        least_volume=1 / 2,
    ),
}
