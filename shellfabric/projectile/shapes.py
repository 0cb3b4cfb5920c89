"""Shapes of the projectile's nose: all that is known of a shape but its distance (`sdf_kernels`).

A new shape is a row here and its distance there. Numbers of its own are lines of `NoseNumbers`,
with the shapes that have them: from a line follow the field of `Projectile`, the key of the table
[projectile], and that other shapes refuse it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import cos, inf, pi, sin, tan
from typing import Annotated, Any

from fabrics.base.errors import InputError
from fabrics.base.schema import ReadBy, angle, declared, key, mark, quantity


@dataclass(frozen=True, kw_only=True)
class NoseNumbers:
    """Numbers of a nose, each of the shapes that it names."""

    half_angle: Annotated[
        float | None,
        key(
            angle("angle between axis and flank of a cone; required for a cone", 5, 85, "45 deg"),
            "cone",
        ),
    ] = None
    tip_radius: Annotated[
        float | None,
        key(quantity("rounding of the tip of a cone; required for a cone", "m", "0.5 mm"), "cone"),
    ] = None
    flat_width: Annotated[
        float | None,
        key(
            quantity(
                "width of the flat strip across a chisel nose; required for a chisel", "m", "2.5 mm"
            ),
            "chisel",
        ),
    ] = None
    flat_angle: Annotated[
        float | None,
        key(
            angle(
                "angle of a chisel's two flats against the plane of the nose; required for a chisel",
                5,
                85,
                "35 deg",
            ),
            "chisel",
        ),
    ] = None
    nose_length: Annotated[
        float | None,
        key(quantity("length of an elliptic nose; required for an ogive", "m", "8 mm"), "ogive"),
    ] = None
    tip_diameter: Annotated[
        float | None,
        key(
            quantity("diameter of the flat at the tip of an ogive; none if not given", "m", "2 mm"),
            "ogive",
        ),
    ] = None


@cache
def shapes_with(number: str) -> tuple[str, ...]:
    """List the shapes that have a number of `NoseNumbers`."""
    read = mark(declared(NoseNumbers)[number], ReadBy)
    assert read is not None  # each has
    return tuple(read.models.split())


@dataclass(frozen=True)
class Shape:
    """A shape of a nose. Functions take a Projectile.

    Parameters
    ----------
    words : for the reader
    form : numbers that its distance needs
    shoulder : depth [m] from which it has its full width
    check : raises an InputError for numbers that do not fit each other
    nose_radius : smallest radius [m] that fabric is bent round by the nose
    length_of_nose : [m] of a body of metal
    volume : [m3]; None where it is not known
    least_volume : [-] over that of the cylinder about it
    optional : of its numbers, those that may be left out
    pointed : whether the tip is a point of the axis that a mesh has to meet
    turned : whether it looks alike from all sides
    edged : whether it has an edge, and behind it a body of some length
    drawn : whether its distance is that of its meridian (`Projectile.drawing`)
    of_metal, of_bar : whether a body of metal, the elastic bar may have it
    from_file : whether it is that of a Solid
    if_soft : metal that a body without a length may be of; None says nothing
    """

    words: str
    form: Callable[[Any], Any] = lambda shot: ()
    shoulder: Callable[[Any], float] = lambda shot: shot.radius
    check: Callable[[Any], None] = lambda shot: None
    nose_radius: Callable[[Any], float] = lambda shot: shot.edge_radius
    length_of_nose: Callable[[Any], float] = lambda shot: 0.0
    volume: Callable[[Any], float | None] = lambda shot: None
    least_volume: float = 1.0
    optional: tuple[str, ...] = ()
    pointed: bool = False
    turned: bool = True
    edged: bool = True
    drawn: bool = False
    of_metal: bool = False
    of_bar: bool = False
    from_file: bool = False
    if_soft: str | None = None


def _section(shot):
    return pi * shot.radius**2


def _cylinder(shot, lost=0.0):
    """Volume of a cylinder of which a length is lost at the nose."""
    return None if shot.length is None else _section(shot) * (shot.length - lost)


def _cone(shot):
    """The shoulder's centre lies where the flank is tangent to tip and shoulder."""
    tip = shot.tip_radius
    rho = shot.edge_radius
    angle = shot.half_angle
    shoulder = (tip - rho - (shot.radius - rho) * cos(angle)) / sin(angle) - tip
    return tip, sin(angle), cos(angle), shoulder


def _check_cone(shot):
    angle = shot.half_angle
    if not angle < 0.5 * pi:
        raise InputError(key="half_angle", value=angle, allowed="below a right angle")
    most = (shot.radius - shot.edge_radius * (1 - cos(angle))) / cos(angle)
    if not shot.tip_radius < most:
        allowed = f"below {1e3 * most:.4g} mm, to leave a flank"
        raise InputError(key="tip_radius", value=shot.tip_radius, allowed=allowed)


def _chisel(shot):
    """Half the strip of the body K within, whose flats are set back by the edge radius."""
    return (
        0.5 * shot.flat_width - shot.edge_radius * tan(0.5 * shot.flat_angle),
        sin(shot.flat_angle),
        cos(shot.flat_angle),
    )


def _chisel_shoulder(shot):
    flat = shot.radius - shot.edge_radius - _chisel(shot)[0]
    return shot.edge_radius + flat * tan(shot.flat_angle)


def _check_chisel(shot):
    if not shot.flat_angle < 0.5 * pi:
        raise InputError(key="flat_angle", value=shot.flat_angle, allowed="below a right angle")
    if not 0 < _chisel(shot)[0] < shot.radius - shot.edge_radius:
        allowed = "above the rounding of its edges and below the diameter"
        raise InputError(key="flat_width", value=shot.flat_width, allowed=allowed)


def _check_solid(shot):
    for name in ("radius", "length"):
        if getattr(shot, name) != getattr(shot.solid, name):
            raise InputError(key=name, value=getattr(shot, name), allowed="that of the solid")


def _ogive_radius(shot):
    side = shot.radius - 0.5 * (shot.tip_diameter or 0.0)
    return min(side**2 / shot.nose_length, shot.nose_length**2 / side)


# in the order of their numbers in `sdf_kernels`
SHAPES = {
    "flat": Shape(
        "a cylinder",
        shoulder=lambda shot: shot.edge_radius,
        volume=_cylinder,
        of_metal=True,
        of_bar=True,
    ),
    "hemisphere": Shape(
        "a round-nosed cylinder",
        nose_radius=lambda shot: shot.radius,
        length_of_nose=lambda shot: shot.radius,
        volume=lambda shot: _cylinder(shot, shot.radius / 3),
        least_volume=2 / 3,
        of_metal=True,
        if_soft="lead",
    ),
    "cone": Shape(
        "a conical projectile",
        _cone,
        lambda shot: -_cone(shot)[3],
        _check_cone,
        nose_radius=lambda shot: min(shot.edge_radius, shot.tip_radius),
        least_volume=1 / 3,
        pointed=True,
    ),
    "sphere": Shape(
        "a sphere",
        nose_radius=lambda shot: shot.radius,
        length_of_nose=lambda shot: shot.radius,
        volume=lambda shot: _section(shot) * 4 / 3 * shot.radius,
        edged=False,
        of_metal=True,
    ),
    "chisel": Shape(
        "a chisel-nosed fragment simulator",
        _chisel,
        _chisel_shoulder,
        _check_chisel,
        least_volume=1 / 2,
        turned=False,
    ),
    "stl": Shape(
        "a body from an STL file",
        lambda shot: shot.solid.form,
        lambda shot: shot.solid.shoulder,
        _check_solid,
        pointed=True,
        turned=False,
        from_file=True,
    ),
    "ogive": Shape(
        "a bullet with an elliptic nose",
        lambda shot: (shot.nose_length, shot.tip_diameter or 0.0),
        lambda shot: shot.nose_length,
        nose_radius=_ogive_radius,
        length_of_nose=lambda shot: shot.nose_length,
        volume=lambda shot: shot.drawing.drawn_mass / shot.drawing.core.density,
        least_volume=1 / 2,
        optional=("tip_diameter",),
        drawn=True,
        of_metal=True,
    ),
}


def needed(shape: str) -> tuple[str, ...]:
    """Return the numbers that a shape cannot do without."""
    names = [name for name in declared(NoseNumbers) if shape in shapes_with(name)]
    return tuple(name for name in names if name not in SHAPES[shape].optional)


def check_numbers(shape: str, shot: Any) -> None:
    """Check the numbers of a nose: those that the shape needs are given, those of others are not.

    Raises
    ------
    InputError : the first that is wrong
    """
    for name in declared(NoseNumbers):
        value = getattr(shot, name)
        having = shapes_with(name)
        articles = [f"{'an' if each[0] in 'aeiou' else 'a'} {each}" for each in having]
        if shape not in having and value is not None:
            allowed = f"left out, being of {' or '.join(articles)}"
            raise InputError(key=name, value=value, allowed=allowed)
        if name in needed(shape) and not (value is not None and 0 < value < inf):
            allowed = f"above 0 for {articles[having.index(shape)]}"
            raise InputError(key=name, value=value, allowed=allowed)
        if name in SHAPES[shape].optional and not (value is None or 0 < value < 2 * shot.radius):
            raise InputError(key=name, value=value, allowed="above 0 and below the diameter")
