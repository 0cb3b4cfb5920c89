"""The grid of a fabric panel with its projectile: lines, masses, edges, time step.

The grid follows the yarns. Elements that are all alike have their middle in that of a straight opening;
a graded grid, an oblique and a round one have a crossover at the impact point (`PanelGrid.grid_middle`).
If the weave is at an angle to the sides, the opening is round, or its middle is not that of the grid,
the nodes on and beyond the edge are held: a staircase, nowhere further from the edge than the diagonal
of one element.

The bound of the time step is that of docs/theory-panel.md, "Time integration and time step"; along a
straight yarn it is d / c_woven (erratum E-38). How much of it is taken: `time_step`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, sqrt
from operator import ge
from typing import Any

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray, IntArray, refuse
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from shellfabric.block import coupling
from shellfabric.cell.model import CellTable
from shellfabric.membrane import boundary, forces, grading, time_step
from shellfabric.membrane.panel_setup import PanelSetup
from shellfabric.parts import Part
from shellfabric.projectile import frames
from shellfabric.projectile.projectile import Projectile

SAME_PLACE = 1e-9  # [m] within which two distances from a point are alike
SYMMETRIES = {
    "quarter": (True, True),
    "half": (True, False),
    "other half": (False, True),
    "whole": (False, False),
}


@dataclass(frozen=True)
class PanelGrid(PanelSetup):
    """A grid of crossovers about the impact point, from edge to edge of the opening, and the
    projectile before them.

    Parameters
    ----------
    table : CellTable of the fabric
    opening : (along warp, along weft) [m], but for an oblique weave. There are as many elements as
        whole crossovers fit from the centre to an edge (79 of 79.9 for S-720). Elements that are
        all alike are made longer to fill the rest; on a graded panel the last one is. Where neither
        can be, `held_opening` has what became of it
    elements_per_crossover : along each side
    trellis : whether the fabric's shear law acts; a fabric without one has none
    bending : (warp, weft) [N m2] bending stiffness of a yarn; none as in the thesis. It lies
        between the sum over its fibres, n E pi d^4 / 64, when they slide, and that of a solid
        section of its fibre area, E A^2 / 4 pi
    strength_factors : (warp, weft) factors on `strengths` of each yarn, as many as `yarn_counts`,
        or None where all are alike. They are those of the modelled part: across a plane of symmetry
        a yarn has that of its image
    ply_angle : [rad] of a ply that is turned in its pack, about the impact point: from the pack's
        axes, in which the projectile is given, to its own, in which its yarns lie. weave_angle has
        it in it
    others : see `PanelSetup`; of a round opening `opening` has the diameter twice

    Raises
    ------
    InputError : unknown symmetry or boundary, an opening smaller than the projectile needs, or a
        symmetry that shot, edges or weave do not have
    """

    table: CellTable
    opening: tuple[float, float] = (0.203, 0.203)
    elements_per_crossover: int = 1
    trellis: bool = True
    bending: tuple[float, float] = (0.0, 0.0)
    strength_factors: tuple | None = None
    ply_angle: float = 0.0

    def __post_init__(self):
        even = [*map(self.shot.mirrored, (0, 1))]
        fits = [name for name, planes in SYMMETRIES.items() if all(map(ge, even, planes))]
        if self.symmetry not in fits:
            refuse(self, "symmetry", " or ".join(fits) + " for this shot")
        self._check_edges()
        coupling.check(self)
        self._check_strength()
        if self.grading is not None:
            grading.check(self.grading)
        if self.elements_per_crossover < 1:
            refuse(self, "elements_per_crossover", "1, 2, 3, ...")
        if not all(0 <= EI < inf for EI in self.bending):
            refuse(self, "bending", "at least 0")
        if not 0 < self.packed_area < 1:
            refuse(self, "packed_area", "above 0, below 1")
        for family, given, count in zip(
            ("warp", "weft"), self.strength_factors or (), self.yarn_counts
        ):
            if np.shape(given) != (count,) or not np.all(
                np.isfinite(given) & (np.asarray(given) > 0)
            ):
                raise InputError(
                    key=f"strength_factors of the {family}", allowed=f"{count} numbers above 0"
                )
        for length, w in zip(self.opening, self.weave.w):
            if not length / 2 >= max(2 * self.projectile.radius, 4 * w, 2 * w * self.finest):
                raise InputError(
                    key="opening",
                    value=length,
                    allowed="wider than two projectiles and four crossovers",
                )
        if self.grading is not None:
            self._check_grading()

    def _check_edges(self):
        """InputError of edges that do not go with the symmetry or with an oblique weave."""
        for (low, high), mirrored in zip(self.supports, self.mirrors):
            if mirrored and low != high:
                allowed = "alike at both ends of mirrored yarns"
                refuse(self, "boundary", allowed)
        if any(offset and mirrored for offset, mirrored in zip(self.impact_point, self.mirrors)):
            allowed = "0 across planes of symmetry, or symmetry = whole"
            refuse(self, "impact_point", allowed)
        if self.round and len(set(self.opening)) > 1:
            allowed = "one diameter of a round opening"
            refuse(self, "opening", allowed)
        if self.stepped and not boundary.is_clamped(self.boundary):
            what = "in a round opening"
            if self.weave_angle:
                what = "oblique"
            if self.ply_angle:
                what = "turned in its pack"
            allowed = f"clamped if the weave is {what}"
            refuse(self, "boundary", allowed)
        room = [0.5 * side - 2 * self.projectile.radius for side in self.opening]
        if self.round:
            inside = np.hypot(*self.impact_point) < room[0]
        else:
            inside = np.all(np.abs(self.impact_point) < room)
        if any(self.impact_point) and not inside:
            allowed = "within the opening, two radii of the projectile from its edge"
            refuse(self, "impact_point", allowed)
        if not abs(self.weave_angle) < 1.5708:
            allowed = "within a right angle"
            refuse(self, "weave_angle", allowed)
        if self.weave_angle and any(self.mirrors):
            what = "the weave is oblique"
            if self.ply_angle:
                what = "a ply is turned by another angle than 90 deg"
            refuse(self, "symmetry", f"whole if {what}")

    def _check_strength(self):
        if self.rate_dependence and self.fabric.strain_rate is None:
            allowed = f"false: fabric {self.fabric.name} has no strain_rate"
            raise InputError(key="rate_dependence", value=True, allowed=allowed)
        if self.rate_dependence and not self.yarn_failure:
            raise InputError(
                key="rate_dependence", value=True, allowed="false if yarns do not fail"
            )

    def _check_grading(self):
        given = self.elements_per_crossover
        if given != 1:
            allowed = f"none, but a side 1/{given} in grading"
            raise InputError(key="elements_per_crossover", value=given, allowed=allowed)
        gripped = any(isinstance(side, boundary.Grip) for pair in self.supports for side in pair)
        if gripped or (not self._alike and self.grid_middle != self.impact_point):
            allowed = "clamped, free or a pull-in on a graded panel, clamped if it is struck off the middle"
            refuse(self, "boundary", allowed)
        for place, step, reach in zip(self._fine(), self.spacing, self.reach()):
            # and what the smooth surface of the last element has beside it
            least = int(np.ceil(reach / step)) + 1
            if self.sides is not None and place < least:
                allowed = f"a first zone of {-(-least * self._smallest[0] // self._smallest[1])} crossovers or more"
                refuse(self, "grading", f"{allowed}, all that comes under the nose")

    @property
    def fabric(self) -> Fabric:
        return self.table.model.fabric

    @cached_property
    def weave(self) -> Weave:
        return self.fabric.weave

    @cached_property
    def shot(self) -> Projectile:
        """The projectile in the panel's own frame."""
        if self.ply_angle:
            return self.projectile.seen_from(self.ply_angle)
        return self.projectile

    @cached_property
    def length_factors(self) -> tuple[float, float]:
        """(warp, weft) [-] strength of the yarns at their length in the panel over the stated one
        (`find_length_factors`)."""
        return self.find_length_factors(self.fabric, self.opening, self.weave_angle)

    @property
    def strengths(self) -> tuple[float, float]:
        """(warp, weft) [N] mean strength of the yarns, at their length in the panel."""
        warp, weft = (yarn.strength * at for yarn, at in zip(self.weave.yarns, self.length_factors))
        return warp, weft

    @property
    def failure_strains(self) -> tuple[float, float]:
        """(warp, weft) [-] at `strengths`."""
        pairs = zip(self.weave.yarns, self.length_factors)
        warp, weft = (yarn.failure_strain * at for yarn, at in pairs)
        return warp, weft

    @property
    def axes(self) -> FloatArray:
        """(2, 2) its own two axes as rows, in the frame of its pack."""
        return frames.axes(self.ply_angle)

    def in_pack(self, vectors: FloatArray) -> FloatArray:
        """Turn vectors (..., 2) or (..., 3) of its own frame into that of its pack."""
        if not self.ply_angle:
            return vectors
        return frames.turned_back(vectors, self.axes)

    @cached_property
    def mirrors(self) -> tuple[bool, bool]:
        """(x, y) whether x = 0 and y = 0 are planes of symmetry that bound the modelled part."""
        return SYMMETRIES[self.symmetry]

    @cached_property
    def _smallest(self):
        """(crossovers, elements) of a side at the impact point that is both long; one of them is
        1."""
        if self.grading is None:
            return 1, self.elements_per_crossover
        side = grading.exact(self.grading[0][1])
        return side.numerator, side.denominator

    @property
    def finest(self) -> int:
        """Crossovers along a side of an element at the impact point, if there is at least one."""
        return self._smallest[0]

    @property
    def lines_per_crossover(self) -> int:
        """Elements along a side of a crossover at the impact point, if there is at least one."""
        return self._smallest[1]

    @cached_property
    def spacing(self) -> tuple[float, ...]:
        """(dx, dy) [m] sides of an element, of the smallest on a graded panel."""
        if self._fills:
            return tuple(length / 2 / n for length, n in zip(self.extent, self._half_counts))
        return tuple(2 * w * self.finest / self.lines_per_crossover for w in self.weave.w)

    @property
    def _fills(self):
        """Whether all elements are alike, and made longer so that the edge of the opening is a line
        of the grid."""
        return self.sides is None and not self.stepped

    @cached_property
    def _half(self):
        """(along warp, along weft) crossovers from the middle of the grid to an edge."""
        return tuple(length / 2 / (2 * w) for length, w in zip(self.extent, self.weave.w))

    @cached_property
    def _half_counts(self):
        """(along warp, along weft) elements that are all alike, from the middle of the grid to an
        edge."""
        wholes = (int(half + 1e-9) for half in self._half)
        return tuple(n * self.lines_per_crossover // self.finest for n in wholes)

    @property
    def _alike(self):
        """Whether all elements are alike."""
        return self.grading is None or len({side for _, side in self.grading}) == 1

    @cached_property
    def sides(self) -> tuple[FloatArray, ...] | None:
        """((ni,), (nj,)) [m] sides of the elements along warp and weft; None where all are
        alike."""
        if self.grading is None or self._alike:
            return None
        found = []
        for axis, (half, w) in enumerate(zip(self._half, self.weave.w)):
            outward = 2 * w * grading.sides(self.grading, half)
            whole = np.concatenate([outward[::-1], outward])
            if self.grid_middle[axis]:
                edge = 0.5 * self.opening[axis] - abs(self.grid_middle[axis])
                whole = grading.with_line_at(whole, np.copysign(edge, self.grid_middle[axis]))
            if self.mirrors[axis]:
                found.append(outward)
            else:
                found.append(whole)
        return tuple(found)

    @property
    def held_opening(self) -> tuple[float, float]:
        """(along its two sides) [m] of the opening between the nodes that are held.

        They differ from `opening` where the edge is a staircase of grid lines: then a round opening
        and that of an oblique weave have the sides of an opening of the area that can move.
        """
        oblique = self.weave_angle != 0 or self.round
        if oblique:
            lengths = np.multiply.outer(*self.element_sides)
            area = np.prod(self.opening)
            if self.round:
                area *= np.pi / 4
            scale = (lengths[self.movable()].sum() / self.share / area) ** 0.5
            return scale * self.opening[0], scale * self.opening[1]
        found = []
        for axis, x in enumerate(self.lines()):
            place = x + self.impact_point[axis]
            edge = 0.5 * self.opening[axis] * (1 - 1e-9)
            if self.mirrors[axis]:
                low = -place[-1]
            else:
                low = place[place <= -edge].max(initial=place[0])
            found.append(float(place[place >= edge].min(initial=place[-1]) - low))
        return found[0], found[1]

    def _fine(self):
        """(along warp, along weft) elements of the first zone from the impact point outwards."""
        if self.sides is None:
            return self._half_counts
        found = []
        for sides, step, mirrored in zip(self.sides, self.spacing, self.mirrors):
            smallest = int((np.abs(sides - step) < 1e-9 * step).sum())
            if not mirrored:
                smallest //= 2  # they lie on both sides
            found.append(smallest)
        return tuple(found)

    def first_zone(self) -> tuple[int, ...]:
        """Return the rows and columns (i0, i1, j0, j1) of elements that the projectile may touch:
        of a graded panel those of the first zone but for the outermost, which the smooth surface of
        the others needs beside them; else all."""
        rim = 1
        if self.sides is None:
            rim = 0
        bounds = []
        for fine, count, mirrored in zip(self._fine(), self.counts, self.mirrors):
            if mirrored:
                bounds += [0, fine - rim]
            else:
                bounds += [count // 2 - fine + rim, count // 2 + fine - rim]
        return tuple(bounds)

    @cached_property
    def counts(self) -> tuple[int, ...]:
        """(ni, nj) elements along warp and weft."""
        if self.sides is not None:
            return tuple(part.size for part in self.sides)
        found = []
        for n, mirrored in zip(self._half_counts, self.mirrors):
            if not mirrored:
                n *= 2
            found.append(n)
        return tuple(found)

    @property
    def yarn_counts(self) -> tuple[int, ...]:
        """(warp, weft) yarns of the modelled part, with those on its rims; where elements are
        longer, their lines."""
        return tuple(axes.size for axes in self.yarn_axes[::-1])

    @property
    def elements(self) -> int:
        """Number of elements."""
        return self.counts[0] * self.counts[1]

    @property
    def share(self) -> float:
        """Part of the whole panel, and of the projectile, that is modelled."""
        return 0.5 ** sum(self.mirrors)

    @property
    def membrane_stiffness(self) -> float:
        """[N/m] the D of the time step's bound."""
        stiffness = self.table.stiffness()
        shear = self.fabric.shear
        if self.trellis and shear is not None:
            locked = 2 * shear.G2 * self.weave.thickness
        else:
            locked = 0.0
        if locked <= stiffness:
            return stiffness
        return (stiffness + locked) ** 2 / (4 * locked)

    def make_parts(self) -> tuple[Part, ...]:
        """Make what acts on it besides membrane and nose, each with a row of its own."""
        return forces.make_parts(self)

    @cached_property
    def critical_step(self) -> float:
        """[s] 2 / w of the undamped fabric."""
        mass = self.weave.areal_density
        membrane = self.membrane_stiffness / (mass * min(self.spacing) ** 2)
        return (membrane + sum(part.stiffness for part in forces.make_parts(self))) ** -0.5

    @cached_property
    def yarns_a_line(self) -> tuple[float, ...]:
        """(warp, weft) yarns that a grid line stands for at the impact point."""
        return tuple(
            count * d
            for count, d in zip((self.weave.warp_count, self.weave.weft_count), self.spacing[::-1])
        )

    @property
    def time_step(self) -> float:
        """[s] the step that is taken."""
        share = time_step.share(self.table, self.numerics.stretch_viscosity)
        return self.step_of_bound * share

    @property
    def step_of_bound(self) -> float:
        """[s] the stability bound times `cfl`."""
        return self.numerics.cfl * self.largest_step

    @property
    def largest_step(self) -> float:
        """[s] the stability bound."""
        xi = self.numerics.stretch_viscosity
        return self.critical_step * ((1 + xi**2) ** 0.5 - xi)

    def coordinates(self) -> list[FloatArray]:
        """Return (X, Y) [m] of the nodes at rest, each (ni+1, nj+1); the impact point is the
        origin."""
        return np.meshgrid(*self.lines(), indexing="ij")

    def lines(self) -> tuple[FloatArray, ...]:
        """Return the positions x and y ((ni+1,), (nj+1,)) [m] of the lines of the grid at rest."""
        if self.sides is None:
            return tuple(
                x0 + d * np.arange(n + 1)
                for x0, d, n in zip(self.origin, self.spacing, self.counts)
            )
        found = []
        for sides, mirrored in zip(self.sides, self.mirrors):
            x = np.insert(np.cumsum(sides), 0, 0.0)
            if not mirrored:
                x -= x[sides.size // 2]
            found.append(x)
        return tuple(found)

    @cached_property
    def _yarns(self):
        """(rows, columns) `grading.nearest_yarns` of the grid lines along the weft and along the
        warp."""
        per = self.lines_per_crossover
        found = []
        for x, d, w, mirrored in zip(self.lines(), self.spacing, self.weave.w, self.mirrors):
            if per > 1:
                places = np.rint(x / d)
            else:
                places = np.arange(x.size)
            if per > 1 and self.sides is not None:  # the edge is the axis of the last whole yarn
                last = max(per * int(x[-1] / (2 * w) + 1e-9), places[-2] + 1)
                places[-1] = last
                if mirrored:
                    places[0] = 0
                else:
                    places[0] = -last
            found.append(grading.nearest_yarns(places, per))
        return tuple(found)

    @property
    def yarn_axes(self) -> tuple[IntArray, ...]:
        """(rows, columns) numbers of the grid lines that are axes of yarns: of weft yarns, of warp
        yarns."""
        return tuple(axes for axes, _ in self._yarns)

    @property
    def nearest_yarns(self) -> tuple[IntArray, ...]:
        """(rows, columns) number of the weft yarn nearest to each row of nodes, of the warp yarn to
        each column."""
        return tuple(yarns for _, yarns in self._yarns)

    @property
    def element_sides(self) -> tuple[FloatArray, ...]:
        """((ni,), (nj,)) [m] sides of the elements along warp and weft."""
        return self.sides or tuple(map(np.full, self.counts, self.spacing))

    @cached_property
    def grid_middle(self) -> tuple[float, float]:
        """[m] of the crossover in the middle of the grid from the middle of the opening, along both
        sides: 0 where edges are lines of the grid wherever it is struck, else that of the impact
        point."""
        graded = not self._alike and boundary.is_clamped(self.boundary)
        if graded or self.weave_angle or self.round:
            return self.impact_point
        return 0.0, 0.0

    @property
    def contact_density(self) -> float:
        """[kg/m2] of what others push, which bounds the stiffness of contacts with it."""
        return self.weave.areal_density

    @property
    def origin(self) -> tuple[float, ...]:
        """(x0, y0) [m] of the first node at rest from the impact point; on a graded panel as if all
        elements were the smallest.

        There the smallest are where they would be then, and nothing else is looked for by its
        place.
        """
        found = []
        for axis, mirrored in enumerate(self.mirrors):
            low = 0.0
            if not mirrored:
                middle = self.grid_middle[axis] - self.impact_point[axis]
                low = middle - 0.5 * self.counts[axis] * self.spacing[axis]
            found.append(low)
        return tuple(found)

    @property
    def nearest_lines(self) -> tuple[int, ...]:
        """(row, column) of the grid lines nearest the impact point; of two that are equally near,
        the one that is counted first."""
        found = []
        for x in self.lines():
            away = np.abs(x)
            # digits of the sums that make the lines do not choose between two
            found.append(int(np.argmax(away <= away.min() + SAME_PLACE)))
        return tuple(found)

    @cached_property
    def supports(self) -> tuple[tuple[Any, Any], ...]:
        """((lowest, highest) of the warp, (lowest, highest) of the weft) sides of its boundary."""
        return boundary.sides(self.boundary)

    @cached_property
    def stepped(self) -> bool:
        """Whether the edge of the opening is a staircase of grid lines, in place of four of
        them."""
        return self.weave_angle != 0 or self.round or any(self.grid_middle)

    @cached_property
    def extent(self) -> tuple[float, ...]:
        """(along warp, along weft) [m] that the grid has to cover, its middle at `grid_middle`."""
        a, b = self.opening
        x, y = self.grid_middle
        c, s = frames.axes(self.weave_angle)[0]
        if s == 0:
            return a + 2 * abs(x), b + 2 * abs(y)
        wide = (a, b)
        if not self.round:
            wide = (a * c + b * abs(s), a * abs(s) + b * c)
        off = abs(c * x + s * y), abs(c * y - s * x)
        return tuple(side + 2 * far + 4 * w for side, far, w in zip(wide, off, self.weave.w))

    def in_frame(self) -> FloatArray:
        """Return the positions (2, ni+1, nj+1) [m] of the nodes at rest from the middle of the
        opening, along its two sides."""
        X, Y = self.coordinates()
        c, s = frames.axes(self.weave_angle)[0]
        x, y = self.impact_point
        return np.stack([c * X - s * Y + x, s * X + c * Y + y])

    def movable(self) -> BoolArray:
        """Mark the elements, (ni, nj) bool, which have a node that no edge holds."""
        loose = self.loose()
        return loose[:-1, :-1] | loose[1:, :-1] | loose[:-1, 1:] | loose[1:, 1:]

    def loose(self) -> BoolArray:
        """Mark the nodes, (ni+1, nj+1) bool, which no edge holds or leads."""
        free = np.ones(tuple(n + 1 for n in self.counts), bool)
        for axis, (low, high) in enumerate(self.supports):
            rows = np.moveaxis(free, axis, 0)
            if high != "free":
                rows[-1] = False
            if low != "free" and not self.mirrors[axis]:
                rows[0] = False
        if self.stepped:
            slack = 1e-9 * min(self.spacing)
            half = [0.5 * side - slack for side in self.opening]
            across, along = np.abs(self.in_frame())
            if self.round:
                free &= np.hypot(across, along) < half[0]
            else:
                free &= (across < half[0]) & (along < half[1])
        return free

    @cached_property
    def segments(self) -> list[FloatArray]:
        """(warp, weft) each (ni+1, nj+1): yarn segments, from crossover to crossover, that an edge
        stands for."""
        lengths = (side / (2 * w) for side, w in zip(self.element_sides, self.weave.w))
        return list(grading.edge_areas(*lengths))

    @cached_property
    def areas(self) -> FloatArray:
        """(ni+1, nj+1) [m2] of the nodes at rest, of the modelled part."""
        return self.masses() / self.weave.areal_density

    def masses(self) -> FloatArray:
        """Compute the masses (ni+1, nj+1) [kg] of the nodes."""
        warp_sides, weft_sides = self.element_sides
        corner = 0.25 * self.weave.areal_density * warp_sides[:, None] * weft_sides
        mass = np.zeros([n + 1 for n in self.counts])
        for i in (slice(None, -1), slice(1, None)):
            for j in (slice(None, -1), slice(1, None)):
                mass[i, j] += corner
        return mass

    @property
    def rate_law(self) -> FloatArray:
        """(2, 3, n) `RateLaw.table` of warp and weft; n = 0 if strengths do not depend on the
        strain rate."""
        if not self.rate_dependence:
            return np.zeros((2, 3, 0))
        assert self.fabric.strain_rate is not None  # checked by _check_strength
        return np.array([self.fabric.strain_rate.table(strain) for strain in self.failure_strains])

    def reach(self) -> tuple[float, ...]:
        """Compute the distance (along warp, along weft) [m] from the projectile's middle that
        fabric can come from to be under it.

        A straightened, stretched yarn that is held at its end draws fabric in by at most its crimp
        and strain times its length; a tilted projectile is wider in the panel's plane. Yarns with a
        free end follow the projectile from anywhere, over the whole panel; on a graded one contact
        stays in the first zone.
        """
        wide = self.projectile.reach_radius / self.projectile.frame[2, 2]
        found = []
        slips: tuple[float, ...] = (0.0, 0.0)
        if self.sides is not None:
            slips = boundary.pull_in(self.boundary)
        extent = self.extent
        for n, (x, step, yarn) in enumerate(zip(self.lines(), self.spacing, self.weave.yarns)):
            longest = max(x[-1], -x[0], 0.5 * extent[n])
            drawn = (yarn.crimp + self.failure_strains[n]) * longest + slips[n]
            ends = self.supports[n]
            if "free" in ends and self.sides is None:
                drawn = x[-1] - x[0]
            found.append(wide + drawn + 2 * step)
        return tuple(found)

    def path(self) -> tuple[float, ...]:
        """Compute the way (along warp, along weft) [m] that the projectile may move sideways before
        it is through.

        A yarn that is held a apart from the nose on either side and lengthens by e = crimp + failure strain lets the
        nose go a sqrt(e (2 + e)) deep; the projectile is through a diameter deeper. It moves sideways by that depth
        times the tangent of its obliquity, or is pushed so by a flat nose that leans.
        """
        depths = []
        for length, yarn, strain in zip(self.extent, self.weave.yarns, self.failure_strains):
            longer = yarn.crimp + strain
            depths.append(0.5 * length * sqrt(longer * (2 + longer)))
        depth = min(depths) + 2 * self.projectile.radius
        flight = self.shot.flight
        axis = self.shot.frame[2]
        sideways = np.maximum(np.abs(flight[:2] / flight[2]), np.abs(axis[:2] / axis[2]))
        return tuple(depth * sideways)

    def share_of_first_zone(self, nose: FloatArray) -> float:
        """Compute how far [-] the fabric that can be under a nose (3,) [m] reaches, over the half
        width of the first zone."""
        half_width = np.multiply(self._fine(), self.spacing) - self.spacing
        return float(np.max((np.abs(nose[:2]) + self.reach()) / half_width))
