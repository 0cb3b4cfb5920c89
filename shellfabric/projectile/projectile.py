"""The projectile: a body of a given shape, moving without turning, at any obliquity.

It is rigid, or along its axis an elastic-plastic bar (`bar`) whose tip has the shape; across its
axis it moves rigidly. Or it is a body of revolution of metal (`turned`), which flies straight.

Directions. A shot comes at an angle of obliquity to the panel's normal, towards an azimuth in the
panel's plane counted from the warp to the weft. The projectile's axis lies along its flight but for
a yaw, by which it leans further over in the plane of flight and normal; the roll turns it about its
axis. The body keeps this attitude: nothing turns it.

Line of flight. The point of the axis one radius behind the nose flies towards the impact point: of
a sphere or hemisphere, the centre, so that a sphere flies alike whatever its attitude.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import cos, degrees, inf, pi, radians, remainder, sin
from typing import Any

import numpy as np

from fabrics import metals
from fabrics.base import sums
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import declared, list_read, list_unread
from fabrics.base.sourced import assumed_of
from fabrics.metals import Metal
from shellfabric.projectile import sdf_kernels, shapes
from shellfabric.projectile.bar import Bar
from shellfabric.projectile.body_numbers import BodyNumbers
from shellfabric.projectile.profile_kernels import place_profile
from shellfabric.projectile.shapes import SHAPES, NoseNumbers, Shape
from shellfabric.projectile.solid import Solid
from shellfabric.projectile.turned import Turned
from shellfabric.state import Nose, Profile

BODIES = ("rigid", "elastic_bar", "metal")
WIDEST = 2.5  # times its radius at rest a body of metal may become; beyond, a run stops
OUTLINE = 12  # segments in the radius of a rigid ogive's outline
STEEPEST = radians(
    75
)  # of flight and axis against the normal: beyond, the shot passes along the panel


@explain_frozen
@dataclass(frozen=True)
class Projectile(NoseNumbers, BodyNumbers):
    """Projectile; by default a rigid right circular cylinder (thesis section 2.3: 3 g, 5.5 mm,
    flat).

    Parameters
    ----------
    mass : [kg]
    radius : [m]
    edge_radius : [m] rounding of all edges; the contact needs one, see `contact_kernels`.
        Hemisphere and sphere have no edge, but for the hemisphere's at the rear
    shape : one of SHAPES; "chisel" is the fragment simulator, a cylinder with a flat strip across
        its nose and two flats beside it
    length : [m] over all; None for a cylinder without an end. A sphere has none
    solid : Solid of the shape "stl"; its radius and length are the projectile's, its edges have the
        edge radius
    obliquity, azimuth, yaw, roll : [rad], see above; the axis may lean by 75 degrees at most
    friction : Coulomb's coefficient between projectile and fabric; that of the thesis is 0. A scene
        that gives none has an assumed one (`weavecell.scenes.build.make_projectile`)
    body : "rigid", "elastic_bar", "metal", or the Bar itself, of this mass. "elastic_bar" is a flat
        cylinder of steel (thesis Table 4-2), bored from its tail to its mass (erratum E-37), as long
        as that of the thesis where no length is given
    bore_diameter : [m] of the bore of that cylinder; None takes 4.5 mm. The thesis gives neither
        its diameter nor its depth
    core, jacket : of a body of metal, names of `fabrics.metals` or Metals; without a jacket None
    jacket_thickness : [m]
    bare_tip : [m] length of the tip that the jacket leaves bare
    open_base : whether the jacket leaves the base bare
    cavity_diameter, cavity_depth : [m] of a conical hole in the tip; None without
    element_size : [m] of the mesh of a body of metal; None takes a tenth of the diameter
    others : of its shape, see `shapes.NoseNumbers`, of its body, see `BodyNumbers`; the strip
        across a chisel's nose lies along the weft at no obliquity and roll

    Raises
    ------
    InputError : a value out of its range, one that the shape needs missing, or one that it has not
    """

    mass: float = 3.0e-3
    radius: float = 2.75e-3
    edge_radius: float = 0.3e-3
    shape: str = "flat"
    length: float | None = None
    solid: Solid | None = None
    obliquity: float = 0.0
    azimuth: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0
    friction: float = 0.0
    body: str | Bar = "rigid"

    def __post_init__(self):
        check_fields(self)
        if self.shape not in SHAPES:
            raise InputError(key="shape", value=self.shape, allowed=" or ".join(SHAPES))
        self._check_lengths()
        self._check_form()
        if not 0 <= self.friction < inf:
            raise InputError(key="friction", value=self.friction, allowed="at least 0")
        for key in ("azimuth", "roll"):
            if not abs(getattr(self, key)) <= 2 * pi:
                raise InputError(key=key, value=getattr(self, key), allowed="at most a full turn")
        if not 0 <= self.obliquity <= STEEPEST:
            raise InputError(
                key="obliquity", value=self.obliquity, allowed=f"from 0 to {STEEPEST:.4g} rad"
            )
        if not abs(self.obliquity + self.yaw) <= STEEPEST:
            raise InputError(
                key="yaw", value=self.yaw, allowed=f"with the obliquity within {STEEPEST:.4g} rad"
            )
        self._check_body()

    def _check_body(self):
        if not isinstance(self.body, Bar) and self.body not in BODIES:
            raise InputError(key="body", value=self.body, allowed=f"{', '.join(BODIES)} or a Bar")
        for name, bodies in list_unread(BodyNumbers, self, self.body):
            allowed = f"left out but for the body {bodies}"
            raise InputError(key=name, value=getattr(self, name), allowed=allowed)
        if self.body == "metal":
            self._check_metal()
        if self.bore_diameter is not None and not 0 < self.bore_diameter < 2 * self.radius:
            allowed = "below the diameter"
            raise InputError(key="bore_diameter", value=self.bore_diameter, allowed=allowed)
        if self.body == "elastic_bar" and not self.known.of_bar:
            raise InputError(
                key="body",
                value=self.body,
                allowed=f"rigid, or a Bar of its own sections, for a {self.shape}",
            )
        bar = self.bar
        if bar is not None and not abs(bar.mass / self.mass - 1) < 1e-9:
            raise InputError(
                key="mass", value=self.mass, allowed=f"that of the bar, {bar.mass:.6g} kg"
            )

    def _check_metal(self):
        """Refuse what a body of metal cannot do."""
        if not self.known.of_metal:
            names = " or ".join(name for name, known in SHAPES.items() if known.of_metal)
            allowed = f"{names} of the body metal, which is one of revolution"
            raise InputError(key="shape", value=self.shape, allowed=allowed)
        for key in ("obliquity", "yaw"):
            if getattr(self, key) != 0:
                allowed = "0 of the body metal: a body of revolution flies straight"
                raise InputError(key=key, value=getattr(self, key), allowed=allowed)
        if (self.cavity_diameter is None) != (self.cavity_depth is None):
            raise InputError(
                key="cavity_depth",
                value=self.cavity_depth,
                allowed="given together with cavity_diameter",
            )
        assert self.drawing  # which has checks of its own

    @cached_property
    def drawing(self) -> Turned | None:
        """What the body of metal is made of; of a rigid ogive its outline; None of another."""
        if self.body == "metal":
            return self._draw_metal()
        if self.known.drawn:
            size = min(max(self.radius / OUTLINE, self.edge_radius), 0.5 * self.radius)
            return self._draw(_load_metal("OFHC copper", "core"), size, mass=None)
        return None

    def _draw_metal(self):
        core = _load_metal(self.core or "lead", "core")
        given: dict[str, Any] = {"bare_tip": self.bare_tip or 0.0}
        if self.jacket is not None:
            given["jacket"] = _load_metal(self.jacket, "jacket")
        given["jacket_thickness"] = self.jacket_thickness or 0.0
        if self.open_base is not None:
            given["open_base"] = self.open_base
        if self.cavity_diameter is not None:
            given["cavity"] = 0.5 * self.cavity_diameter, self.cavity_depth
        return self._draw(core, self.element_size or 0.2 * self.radius, mass=self.mass, **given)

    def _draw(self, core, size, **given):
        """The drawing of the shape."""
        length = self.length
        edge = self.edge_radius
        if not self.known.edged:
            length = 2 * self.radius
            edge = min(edge, 0.5 * size)
            given["round_base"] = True
            given["open_base"] = False
        if length is None:
            raise InputError(key="length", value=None, allowed=f"given for the {self.shape}")
        return Turned(
            self.radius,
            length,
            core,
            nose_length=self.known.length_of_nose(self),
            tip_radius=0.5 * (self.tip_diameter or 0.0),
            element_size=size,
            edge_radius=edge,
            **given,
        )

    @property
    def deforms(self) -> bool:
        """Whether it is not rigid."""
        return self.body != "rigid"

    @property
    def turned(self) -> Turned | None:
        """The drawing of a body of metal; None of another."""
        if self.body == "metal":
            return self.drawing
        return None

    @property
    def notes(self) -> tuple[str, ...]:
        """What has to be known of a body of metal, a line each: by how much its mass is not that of
        its drawing, and which of its constants are assumed."""
        if self.turned is None:
            return ()
        lines = []
        factor = self.turned.density_factor
        if abs(factor - 1) > 5e-4:
            drawn = 1e3 * self.turned.drawn_mass
            lines.append(
                f"projectile.mass is {100 * (factor - 1):+.1f} % from that of the drawing, {drawn:.4g} g: the "
                f"densities of its metals are multiplied by {factor:.4f}"
            )
        for name in dict.fromkeys((self.core or "lead", self.jacket)):
            if isinstance(name, str) and (kept := assumed_of(metals.entry(name))):
                lines.append(f"assumed of {name}: {', '.join(kept)} (fabrics/metals.toml)")
        return tuple(lines)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What a run takes for granted of it: its body, how it flies, and its friction; a sentence
        each."""
        return (self._body_in_words, *self._flight_in_words, self._friction_in_words)

    @property
    def _body_in_words(self):
        if self.body == "rigid":
            return "Rigid."
        if self.turned is None:
            return "Elastic-plastic along its axis, and rigid across it."
        metals_of = f"of {_name_of(self.core or 'lead')}"
        if self.jacket is not None:
            metals_of += f" in a jacket of {_name_of(self.jacket)}"
        return (
            f"Of metal, {metals_of}: a body of revolution that deforms, flies straight along the normal and does not "
            "tear."
        )

    @property
    def _flight_in_words(self):
        if self.obliquity:
            angle = degrees(self.obliquity)
            yield f"It flies at {angle:.3g}° to the normal, towards {degrees(self.azimuth):.3g}° from the warp."
        if self.yaw:
            towards = (
                "" if self.obliquity else f", towards {degrees(self.azimuth):.3g}° from the warp"
            )
            yield f"Its axis leans {degrees(self.yaw):.3g}° from its flight{towards}."
        if self.roll:
            yield f"It is turned by {degrees(self.roll):.3g}° about its axis."
        if self.tilted:
            yield "It keeps this attitude: nothing turns it."

    @property
    def _friction_in_words(self):
        words = "No friction on the fabric"
        if self.friction:
            words = f"Friction on the fabric {self.friction:g}"
        if isinstance(self.friction, Assumed):
            words += f", {self.friction.words}"
        return f"{words}."

    @property
    def settings(self) -> dict[str, Any]:
        """{name: value in SI units} of its drawing and mesh, as far as they are given."""
        names = ("shape", "mass", "radius", "edge_radius", "length", *declared(NoseNumbers))
        if isinstance(self.body, str):
            names += tuple(list_read(BodyNumbers, self.body))
        given = {name: getattr(self, name) for name in names}
        return {name: value for name, value in given.items() if value is not None}

    @property
    def reach_radius(self) -> float:
        """[m] radius within which fabric may touch it, however it deforms."""
        if self.body == "metal":
            return WIDEST * self.radius
        return self.radius

    @cached_property
    def bar(self) -> Bar | None:
        """The bar along the axis; None for a rigid body."""
        if isinstance(self.body, Bar):
            return self.body
        if self.body == "elastic_bar":
            return self.steel_bar()
        return None

    def steel_bar(self) -> Bar:
        """Return the bored steel cylinder of this mass, diameter and length.

        Raises
        ------
        InputError : a mass that the solid cylinder has not, or that the bore cannot leave
        """
        return Bar.cylinder(
            self.mass,
            diameter=2 * self.radius,
            length=self.length,
            bore_diameter=self.bore_diameter,
        )

    def _check_lengths(self):
        for key in ("mass", "radius", "edge_radius"):
            if not 0 < getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        if self.known.edged and self.edge_radius > self.radius:
            raise InputError(
                key="edge_radius",
                value=self.edge_radius,
                allowed=f"at most the radius {self.radius:g}",
            )

    def _check_form(self):
        if (self.solid is not None) != self.known.from_file:
            allowed = "a Solid for the shape stl, left out for others"
            raise InputError(key="solid", value=self.solid, allowed=allowed)
        shapes.check_numbers(self.shape, self)
        self.known.check(self)
        if self.length is None or self.solid is not None:
            return
        if not self.known.edged:
            allowed = f"left out for {self.known.words}"
            raise InputError(key="length", value=self.length, allowed=allowed)
        least = self.shoulder + self.edge_radius
        if not least <= self.length < inf:
            allowed = f"at least nose and rear edge, {least:.4g}"
            raise InputError(key="length", value=self.length, allowed=allowed)

    @property
    def known(self) -> Shape:
        """All that is known of the shape."""
        return SHAPES[self.shape]

    def energy(self, speed: float) -> float:
        """Compute the kinetic energy [J] at a speed [m/s]."""
        return 0.5 * self.mass * speed**2

    @property
    def number(self) -> int:
        """Of the shape in `sdf_kernels`."""
        return list(SHAPES).index(self.shape)

    @property
    def form(self) -> FloatArray:
        """(n,) the numbers that `sdf_kernels` needs of the shape, at least 4."""
        values = self.known.form(self)
        if self.solid is not None:
            return values
        return np.array([*values, *[0.0] * (4 - len(values))])

    @property
    def nose(self) -> Nose:
        """The shape as kernels take it, at rest."""
        kind = self.number
        edge = self.edge_radius
        if self.drawing is not None:
            kind = sdf_kernels.PROFILE
            edge = self.drawing.edge_radius
        return Nose(
            kind=kind,
            radius=self.radius,
            edge_radius=edge,
            length=self.length or inf,
            form=self.form,
            profile=self._profile,
        )

    @cached_property
    def _profile(self):
        """Its meridian at rest; empty of a shape that has its own distance."""
        if self.drawing is None:
            return Profile.empty()
        return profile_of(self.drawing)

    @property
    def shoulder(self) -> float:
        """[m] depth behind the nose from which it has its full width."""
        return self.known.shoulder(self)

    @property
    def nose_radius(self) -> float:
        """[m] smallest radius that fabric is bent round by the nose."""
        return self.known.nose_radius(self)

    def seen_from(self, angle: float) -> Projectile:
        """Return the same shot in a frame that is turned by `angle` [rad] about the panel's
        normal."""
        if not self.roaming and self.known.turned:
            return self  # it looks alike from everywhere
        azimuth, roll = (remainder(each - angle, 2 * pi) for each in (self.azimuth, self.roll))
        return replace(self, azimuth=azimuth, roll=roll)

    @property
    def tilted(self) -> bool:
        """Whether the frame of the projectile is not that of the panel."""
        return self.obliquity + self.yaw != 0 or self.roll != 0

    @property
    def roaming(self) -> bool:
        """Whether its shadow on the panel moves."""
        return self.obliquity != 0 or self.obliquity + self.yaw != 0

    @property
    def flight(self) -> FloatArray:
        """(3,) unit vector along which it flies."""
        return _towards(self.obliquity, self.azimuth)

    @property
    def frame(self) -> FloatArray:
        """(3, 3) its x, y and z axes as rows: z along its axis, x and y the panel's turned with it,
        and rolled."""
        lean = self.obliquity + self.yaw
        c = cos(self.azimuth)
        s = sin(self.azimuth)
        away = np.array([cos(lean) * c, cos(lean) * s, -sin(lean)])
        beside = np.array([-s, c, 0.0])
        turn = self.roll - self.azimuth
        x = cos(turn) * away + sin(turn) * beside
        y = cos(turn) * beside - sin(turn) * away
        return np.array([x, y, _towards(lean, self.azimuth)])

    def distance(self, point: FloatArray | Sequence[float]) -> tuple[float, FloatArray]:
        """Compute the signed distance [m] to a point (3,) of the panel's frame when the nose is at
        the origin; and its gradient."""
        frame = self.frame
        depth, normal = sdf_kernels.distance(self.nose, sums.multiply(frame, point))
        return depth, sums.multiply(frame.T, normal)

    @property
    def top(self) -> float:
        """[m] how far the body reaches ahead of its nose, along the panel's normal.

        Seen from a point far ahead the distance to a convex body is that to the plane that touches
        it; at 10 km, it is wrong by a nanometre at most, without being too large.
        """
        if not self.tilted or self.obliquity + self.yaw == 0:
            return 0.0
        if self.solid is not None:
            return max(0.0, float(sums.multiply(self.solid.points, self.frame[:, 2]).max()))
        far = 1e4
        return max(0.0, far - self.distance(np.array([0.0, 0.0, far]))[0])

    def start(self) -> FloatArray:
        """Compute the place (3,) [m] of the nose when the body first touches the panel z = 0, on
        its way to the origin."""
        if self.obliquity == 0 and not self.tilted:
            return np.zeros(3)
        flight = self.flight
        nose = self.radius * self.frame[2]
        return nose - flight * (nose[2] + self.top) / flight[2]

    def surface(self, set_back: float = 0.0, rise: int = 61, around: int = 73) -> FloatArray:
        """Compute the body's surface (n, m, 3) [m] about its nose, m points a ring, for pictures;
        six radii of an endless one.

        Of a solid, what is seen from its axis.

        set_back : [m] along the axis
        rise, around : rays from the side to the tip, and in a ring
        """
        if self.drawing is not None:
            outline = self.drawing.places[self.drawing.outline]
            return turn_about(outline, around) - [0, 0, set_back]
        if self.known.edged:
            end = min(self.length or inf, 6 * self.radius)
            nose = self.nose._replace(length=end)
        else:
            end = 2 * self.radius
            nose = self.nose._replace(length=inf)
        if self.solid is None:
            deep = self.radius
        else:
            deep = min(self.radius, 0.5 * end)
        slopes = np.linspace(0, 0.5 * pi, rise)
        depths = np.linspace(deep, end - deep, rise // 5)
        # rings of rays: from the point one radius deep forwards, across the axis, and from as far
        # before the end back
        origin = np.concatenate([np.full(rise, -deep), -depths, np.full(rise, deep - end)])
        slope = np.concatenate([slopes[::-1], np.zeros(rise // 5), -slopes])
        turn = np.linspace(0, 2 * pi, around)
        away = np.cos(slope)[:, None] * np.array([np.cos(turn), np.sin(turn)])[:, None, :]
        rays = np.stack(
            [*away, np.broadcast_to(np.sin(slope)[:, None], away[0].shape)], axis=-1
        ).reshape(-1, 3)
        points = np.zeros_like(rays)
        points[:, 2] = np.repeat(origin, around)
        sdf_kernels.trace(nose, points, rays)
        return sums.multiply(points - [0, 0, set_back], self.frame).reshape(slope.size, around, 3)

    def mirrored(self, axis: int) -> bool:
        """Tell whether the shot is its own mirror image in the plane x = 0 (axis 0) or y = 0 (axis
        1)."""
        frame = self.frame
        flight = self.flight
        if abs(flight[axis]) > 1e-12 or abs(frame[2][axis]) > 1e-12:
            return False
        if self.solid is not None:
            own = np.abs(frame[:2, axis])
            return min(own) < 1e-12 and self.solid.even[int(np.argmax(own))]
        return self.known.turned or min(abs(frame[0][axis]), abs(frame[1][axis])) < 1e-12


def profile_of(drawing: Turned) -> Profile:
    """Return the meridian of a drawing at rest, as what touches the body sees it."""
    outline = np.ascontiguousarray(drawing.places[drawing.outline])
    profile = Profile(**Profile.zeros(rings=len(outline)))
    place_profile(profile, outline, drawing.edge_radius)
    return profile


def turn_about(outline: FloatArray, around: int) -> FloatArray:
    """Turn an outline (n, 2) [m] about the axis: the surface (n, around, 3) [m]."""
    turn = np.linspace(0, 2 * pi, around)
    r, z = outline.T[..., None]
    return np.stack([r * np.cos(turn), r * np.sin(turn), z + 0 * turn], axis=-1)


def _load_metal(metal, key):
    """The Metal of a name, or the Metal that is given."""
    if isinstance(metal, Metal):
        return metal
    return metals.load(metal, key=key)


def _name_of(metal):
    """The name of a Metal, or the name itself."""
    return getattr(metal, "name", metal)


def _towards(angle, azimuth):
    return np.array([sin(angle) * cos(azimuth), sin(angle) * sin(azimuth), cos(angle)])
