"""The drawing of a projectile of metal that is a body of revolution, and its mesh of layers.

The meridian runs from the tip over nose, side and base to the axis. A core fills it: a square that
is mapped onto it, whose corners are the tip, the front corner, the rear corner and the tail. A
jacket is a layer of elements of its own about the core; drawn into the square as a grid line
instead it would have corner cells of a hundredth of its thickness, and so would be the time step.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, pi

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.metals import Metal

MASS_TOLERANCE = 0.05  # share by which a given mass may differ from that of the drawing
FRONT_CORNER = (
    0.75  # of the way out from the flat of the tip to the side, where the square's corner is
)
FEWEST_ACROSS, FEWEST_ALONG = 3, 4  # elements of a core
SMOOTHING = 200  # sweeps of Jacobi's iteration over the places of the core's nodes
POINTS = 1001  # of a curve


@dataclass(frozen=True)
class Turned:
    """A body of revolution.

    Parameters
    ----------
    radius, length : [m] over all
    core : Metal
    nose_length : [m] of the elliptic nose; 0 of a flat one
    tip_radius : [m] of the flat at the tip of that nose
    round_base : whether the base is a half ellipse as long as the nose, as of a sphere
    cavity : (radius, depth) [m] of a conical hole in the flat of the tip, or None
    jacket : Metal, or None
    jacket_thickness : [m]
    bare_tip : [m] length of the tip that the jacket leaves bare
    open_base : whether the jacket leaves the base bare
    element_size : [m] about that of its elements
    edge_radius : [m] of what touches it: edges are rounded by it
    mass : [kg] that is given, or None to take that of the drawing

    Raises
    ------
    InputError : lengths that make no body or no mesh, or a mass that is not that of the drawing
    """

    radius: float
    length: float
    core: Metal
    nose_length: float = 0.0
    tip_radius: float = 0.0
    round_base: bool = False
    cavity: tuple[float, float] | None = None
    jacket: Metal | None = None
    jacket_thickness: float = 0.0
    bare_tip: float = 0.0
    open_base: bool = True
    element_size: float = 0.5e-3
    edge_radius: float = 0.2e-3
    mass: float | None = None

    def __post_init__(self):
        self._check_lengths()
        self._check_mesh()
        self._check_mass()

    def _check_lengths(self):
        nose = self.nose_length
        if not (0 < self.radius < inf and 0 < self.length < inf):
            raise InputError(key="length", value=self.length, allowed="given for a body of metal")
        longest = self.length
        if self.round_base:
            longest = 0.5 * self.length * (1 + 1e-12)
        if not 0 <= nose <= longest:
            raise InputError(key="nose_length", value=nose, allowed=f"at most {longest:.4g} m")
        if not 0 <= self.tip_radius < self.radius:
            raise InputError(
                key="tip_diameter", value=2 * self.tip_radius, allowed="below the diameter"
            )
        if self.cavity is not None:
            wide, deep = self.cavity
            most = self.tip_radius if nose else self.radius
            if not (0 < wide <= most and 0 < deep < 0.7 * self.length):
                allowed = (
                    "a diameter up to that of the flat of the tip, and a depth below 0.7 lengths"
                )
                raise InputError(key="cavity_diameter", value=2 * wide, allowed=allowed)
        thick = self.jacket_thickness
        if (self.jacket is None) != (thick == 0) or not 0 <= thick < 0.5 * self.radius:
            raise InputError(
                key="jacket_thickness",
                value=thick,
                allowed="above 0 with a jacket, and below a quarter of the diameter",
            )
        if not 0 <= self.bare_tip < self.length or (self.bare_tip and self.jacket is None):
            raise InputError(
                key="bare_tip", value=self.bare_tip, allowed="below the length, with a jacket"
            )
        if not 0 < self.element_size <= 0.5 * self.radius:
            raise InputError(
                key="element_size",
                value=self.element_size,
                allowed="at most a quarter of the diameter",
            )
        if not 0 < self.edge_radius <= self.element_size:
            raise InputError(
                key="edge_radius",
                value=self.edge_radius,
                allowed=f"at most an element of the metal, element_size {self.element_size:.4g} m",
            )

    def _check_mesh(self):
        if not self.areas.min() > 0:
            raise InputError(
                key="element_size",
                value=self.element_size,
                allowed="such that a mesh fits into the drawing; this one has an element without area",
            )

    def _check_mass(self):
        if self.mass is None:
            return
        if not abs(self.mass / self.drawn_mass - 1) <= MASS_TOLERANCE:
            raise InputError(
                key="mass",
                value=self.mass,
                allowed=f"that of the drawing, {self.drawn_mass:.4g} kg, within {100 * MASS_TOLERANCE:g} %",
            )

    @property
    def density_factor(self) -> float:
        """[-] by which densities are multiplied, so that the mass is the given one."""
        if self.mass is None:
            return 1.0
        return self.mass / self.drawn_mass

    @property
    def drawn_mass(self) -> float:
        """[kg] of the mesh, with the densities of its metals."""
        return float(self.element_masses.sum())

    @property
    def densities(self) -> FloatArray:
        """(elements,) [kg/m3]"""
        if self.jacket is None:
            return np.full(len(self.corners), self.core.density)
        return np.where(self.jacketed, self.jacket.density, self.core.density)

    @property
    def element_masses(self) -> FloatArray:
        """(elements,) [kg] with the densities of the metals."""
        return self.densities * self.volumes

    @property
    def areas(self) -> FloatArray:
        """(elements,) [m2] in the plane of the meridian."""
        r, z = np.moveaxis(self.places[self.corners], -1, 0)
        return 0.5 * (
            (r[:, 2] - r[:, 0]) * (z[:, 3] - z[:, 1]) + (r[:, 1] - r[:, 3]) * (z[:, 2] - z[:, 0])
        )

    @property
    def radii(self) -> FloatArray:
        """(elements,) [m] of their middles."""
        return self.places[self.corners][..., 0].mean(axis=1)

    @property
    def volumes(self) -> FloatArray:
        """(elements,) [m3] of the whole rings."""
        return 2 * pi * self.radii * self.areas

    @property
    def places(self) -> FloatArray:
        """(nodes, 2) [m] r and z, 0 at the tip."""
        return self._mesh[0]

    @property
    def corners(self) -> IntArray:
        """(elements, 4) nodes, counterclockwise."""
        return self._mesh[1]

    @property
    def jacketed(self) -> np.ndarray:
        """(elements,) bool, whether they are of the jacket's metal."""
        return self._mesh[2]

    @property
    def outline(self) -> IntArray:
        """(rings,) nodes of the surface, from the tip to the tail."""
        return self._mesh[3]

    @cached_property
    def _mesh(self):
        front, side, rear = self._surface()
        if self.jacket is None:
            places, number = self._fill(front, side, rear)
            corners = _cells(number)
            outline = np.concatenate([number[-1], number[-2::-1, -1], number[0, -2::-1]])
            return places, corners, np.zeros(len(corners), bool), outline
        return self._wrap(front, side, rear)

    def _surface(self):
        """Places of the nodes on the surface: of the front (from the axis), the side (from the front
        corner backwards) and the rear (from the axis)."""
        curve, first, second = self._meridian()
        core = self.radius - self.jacket_thickness
        across = max(FEWEST_ACROSS, round(core / self.element_size))
        deep = self.length - self.jacket_thickness
        along = max(FEWEST_ALONG, round(deep / self.element_size))
        if self.cavity is not None:
            arc = np.hypot(*np.diff(curve[: first + 1], axis=0).T).sum()
            across = max(across, round(arc / self.element_size))
        front = _nodes_on(curve[: first + 1], across)
        side = _nodes_on(curve[first : second + 1], along)
        rear = _nodes_on(curve[second:], across)[::-1]
        return front, side, rear

    def _meridian(self):
        """(n, 2) [m] places from the tip to the tail, and the numbers of the two corners there."""
        R = self.radius
        L = self.length
        tip = self.tip_radius
        turn = np.linspace(0, 0.5 * pi, POINTS)
        parts = []
        if self.cavity is not None:
            wide, deep = self.cavity
            parts.append(_line((0.0, -deep), (wide, 0.0)))
        else:
            wide = 0.0
        if self.nose_length == 0:
            parts.append(_line((wide, 0.0), (R, 0.0)))
            first = sum(len(part) for part in parts) - 1
        else:
            if tip > wide:
                parts.append(_line((wide, 0.0), (tip, 0.0)))
            flat = sum(len(part) for part in parts)
            r = tip + (R - tip) * np.sin(turn)
            z = self.nose_length * (np.cos(turn) - 1)
            parts.append(np.stack([r, z], axis=-1))
            first = flat - 1  # the rim of a hole is a corner by itself
            if self.cavity is None:
                first = flat + int(np.searchsorted(r, tip + FRONT_CORNER * (R - tip)))
        if self.round_base:
            z = -L + self.nose_length * (1 - np.sin(turn))
            curve = np.concatenate([*parts, np.stack([R * np.cos(turn), z], axis=-1)])
            second = len(curve) - int(np.searchsorted(R * np.sin(turn), FRONT_CORNER * R))
        else:
            curve = np.concatenate([*parts, _line((R, -self.nose_length), (R, -L))])
            second = len(curve) - 1
            curve = np.concatenate([curve, _line((R, -L), (0.0, -L))])
        curve[-1, 0] = 0.0
        return curve, first, second

    def _fill(self, front, side, rear):
        """Places (n, 2) of a mesh within three curves and the axis, and the numbers (along, across)
        of its nodes, from rear to front and from the axis outwards."""
        side = side[::-1]
        s = np.linspace(0, 1, len(side))[:, None, None]
        w = np.linspace(0, 1, len(front))[None, :, None]
        axis = rear[0] + (front[0] - rear[0]) * s[:, 0]
        x = (1 - w) * axis[:, None] + w * side[:, None] + (1 - s) * rear[None] + s * front[None]
        x -= (1 - s) * (1 - w) * rear[0] + s * (1 - w) * front[0]
        x -= (1 - s) * w * rear[-1] + s * w * front[-1]
        if self.nose_length or self.cavity is not None:
            for _ in range(SMOOTHING):
                beside = x[2:, 1:-1] + x[:-2, 1:-1] + x[1:-1, 2:] + x[1:-1, :-2]
                x[1:-1, 1:-1] = 0.25 * beside
                x[1:-1, 0, 1] = 0.5 * (x[2:, 0, 1] + x[:-2, 0, 1])
        x[:, 0, 0] = 0.0
        number = np.arange(x.shape[0] * x.shape[1]).reshape(x.shape[:2])
        return x.reshape(-1, 2), number

    def _wrap(self, front, side, rear):
        """The mesh of a core with a layer about it."""
        outer = np.concatenate([front, side[1:]])
        if not self.open_base:
            outer = np.concatenate([outer, rear[-2::-1]])
        inner_front, inner_side, inner_rear = self._core_surface(front, side, rear)
        places, number = self._fill(inner_front, inner_side, inner_rear)
        around = np.concatenate([number[-1], number[-2::-1, -1], number[0, -2::-1]])
        wrapped = around[: len(outer)]
        new = len(places) + np.arange(len(outer))
        layer = np.stack([wrapped[1:], new[1:], new[:-1], wrapped[:-1]], axis=-1)
        corners = np.concatenate([_cells(number), layer])
        places = np.concatenate([places, outer])
        jacketed = np.zeros(len(corners), bool)
        # what is bare, and the wall of a hole, is of the core
        middle = places[layer].mean(axis=1)
        covered = middle[:, 1] < -self.bare_tip
        if self.cavity is not None:
            covered &= np.arange(len(layer)) >= len(front) - 1
        jacketed[-len(layer) :] = covered
        base = around[len(outer) - 1 :]
        if not self.open_base:
            base = base[:0]
        return places, corners, jacketed, np.concatenate([new, base])

    def _core_surface(self, front, side, rear):
        """Places of the nodes on the surface of the core within a jacket, as many as those on the
        surface."""
        thick = self.jacket_thickness
        curve, first, second = self._meridian()
        inner = _inset(curve, thick)
        middle = inner[first : second + 1]
        if self.open_base:
            # the layer ends at the base
            middle = np.concatenate([middle[:-1], [[self.radius - thick, -self.length]]])
            share = np.linspace(0, 1, len(rear))[:, None]
            inner_rear = share * middle[-1] + (1 - share) * [0.0, -self.length]
        else:
            inner_rear = _nodes_on(_untangled(inner[second:]), len(rear) - 1)[::-1]
        inner_side = _nodes_on(_untangled(middle), len(side) - 1)
        if self.cavity is not None:
            # the rim of a hole is too sharp for a layer of even thickness
            inner_front = _inset(np.concatenate([front, side[1:]]), thick)[: len(front)]
            inner_side[0] = inner_front[-1]
        else:
            inner_front = _nodes_on(_untangled(inner[: first + 1]), len(front) - 1)
        return inner_front, inner_side, inner_rear


def _line(start, end):
    """(POINTS, 2) places of a straight line."""
    share = np.linspace(0, 1, POINTS)[:, None]
    return (1 - share) * np.array(start) + share * np.array(end)


def _nodes_on(curve, count):
    """(count + 1, 2) places on a curve (n, 2) at even steps; the nearest of them at each kink."""
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(curve, axis=0).T)))
    at = np.linspace(0, along[-1], count + 1)
    steps = np.diff(curve, axis=0)
    length = np.hypot(*steps.T)
    whole = np.flatnonzero(length > 1e-9 * along[-1])
    unit = steps[whole] / length[whole, None]
    bends = np.flatnonzero(np.sum(unit[1:] * unit[:-1], axis=1) < 0.9)
    for kink in along[whole[bends + 1]]:
        k = 1 + int(np.argmin(abs(at[1:-1] - kink)))
        at[k] = kink
    return np.stack([np.interp(at, along, curve[:, c]) for c in (0, 1)], axis=-1)


def _inset(curve, thickness):
    """(n, 2) places of a polygon's nodes, `thickness` [m] within it along their bisectors. Places of
    the polygon may coincide."""
    t = np.diff(curve, axis=0)
    length = np.hypot(*t.T)
    normal = np.stack([-t[:, 1], t[:, 0]], axis=-1) / np.maximum(length, 1e-300)[:, None]
    # a side without length has the normal of the one before it, or of the one behind
    known = np.flatnonzero(length > 1e-9 * length.max())
    k = np.arange(len(t))
    before = normal[known[np.maximum(np.searchsorted(known, k, "right") - 1, 0)]]
    behind = normal[known[np.minimum(np.searchsorted(known, k), len(known) - 1)]]
    both = np.concatenate([before[:1], before]) + np.concatenate([behind, behind[-1:]])
    on_axis = np.flatnonzero(curve[:, 0] <= 0)
    both[on_axis, 0] = 0.0
    found = curve - 2 * thickness * both / np.sum(both**2, axis=1)[:, None]
    found[on_axis, 0] = 0.0
    return found


def _untangled(curve):
    """The curve (n, 2) without the places beside its ends that lie beyond them: where a corner is cut
    off, those beside it come to lie behind it."""
    start, end = curve[0], curve[-1]
    inward = curve[len(curve) // 2] - start
    outward = end - curve[len(curve) // 2]
    ahead = np.cumsum(sums.multiply(curve - start, inward) > 0) > 0
    behind = np.cumsum((sums.multiply(end - curve, outward) > 0)[::-1])[::-1] > 0
    kept = ahead & behind
    kept[[0, -1]] = True
    return curve[kept]


def _cells(number):
    """(m, 4) corners of a grid of nodes, counterclockwise in (r, z)."""
    parts = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    return np.stack(parts, axis=-1).reshape(-1, 4)
