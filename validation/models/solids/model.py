"""A woven patch of solid yarns with fibre bars, and the projectile before it: what the kernels work on.

The model of the thesis, chapter 3, in explicit dynamics: hexahedra with the law of the fibre volume
fraction, bars along the fibre, contact of the yarns with friction. All yarn ends are held. Mass is
that of the fibres alone: each bar's, half to each of its nodes; it sums to the yarn's linear density
times its length.

The contact and the steps are in `facet_kernels`, `nose_kernels` and `step_kernels`; the arrays in
`state.SolidRow`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from shellfabric.block.hex8 import CORNERS, Bricks, at_points
from shellfabric.projectile.projectile import Projectile
from validation.models.solids import facet_kernels, step_kernels, tip_kernels
from validation.models.solids.mesh import SolidMesh, corners, facet_areas
from validation.models.solids.numerics import SolidNumerics
from validation.models.solids.state import SolidRow

FACES = facet_kernels.FACES
TOUCHING = 1e-9  # [m] from the projectile to the yarns at the start


@dataclass(frozen=True, eq=False)
class SolidPatch:
    """A meshed patch with its laws and a projectile.

    Parameters
    ----------
    mesh : SolidMesh
    fabric : Fabric, with solid laws, as it was meshed
    projectile : Projectile, rigid, at no obliquity, yaw or roll; None for a patch without one
    aim : (x, y) [m] of the projectile's axis; the middle of the patch is at (0, 0)
    friction : Coulomb's coefficient between yarns
    fibre_fractions : (warp, weft) [-] fibre volume fractions at rest in the solid laws; None for
        those that the fabric states
    numerics : SolidNumerics
    failure : whether fibres fail
    clamped : whether the ends of the yarns are held

    Raises
    ------
    InputError : the fabric has no solid laws, the projectile is one that is not modelled, it is off
        the middle of a quarter, or the friction is not at least 0
    """

    mesh: SolidMesh
    fabric: Fabric
    projectile: Projectile | None = None
    aim: tuple[float, float] = (0.0, 0.0)
    friction: float = 0.0
    fibre_fractions: tuple[float, float] | None = None
    numerics: SolidNumerics = field(default_factory=SolidNumerics)
    failure: bool = True
    clamped: bool = True

    def __post_init__(self):
        if self.fabric.solid_laws is None:
            raise InputError(
                f"fabric {self.fabric.name} has no [solid] tables, which solid yarns need"
            )
        if not 0 <= self.friction < inf:
            raise InputError(key="friction", value=self.friction, allowed="at least 0")
        if self.projectile is not None:
            check_projectile(self.projectile)
        if self.mesh.quarter and tuple(self.aim) != (0.0, 0.0):
            raise InputError(
                key="aim", value=tuple(self.aim), allowed="(0, 0), the middle, of a quarter"
            )

    def row(self, strike_velocity: float = 0.0) -> SolidRow:
        """Make the arrays of the patch at rest, the projectile about to touch, the feet of all facets
        found.

        strike_velocity : [m/s] of the projectile
        """
        mesh = self.mesh
        mass = self._mass()
        whole = mass / self._modelled()
        values = SolidRow.zeros(
            yarns=len(mesh.grids),
            nodes=len(mesh.points),
            bricks=mesh.bricks,
            points=len(CORNERS) if self.numerics.full_rule else 0,
            bars=sum(self._bars(yarn) for yarn in range(len(mesh.grids))),
            facets=sum(face.facets for face in self._faces()),
            tips=2 * sum(grid.shape[0] for grid in mesh.grids),
        )
        values.update(self._yarn_values(), **self._brick_values(), **self._bar_values())
        values.update(self._face_values(whole), **self._side_values(whole))
        values.update(self._nose_values(strike_velocity))
        numerics = self.numerics
        values.update(
            nz=mesh.grids[0].shape[2] - 1,
            slack_stiffness=numerics.slack_stiffness,
            slack_width=numerics.slack_width,
            mass=mass,
            whole_mass=whole,
            free=self._free(),
            quarter=int(mesh.quarter),
            penalty=numerics.penalty,
            toe=numerics.toe,
            friction=float(self.friction),
            x=np.array(mesh.points, float),
        )
        values["bar_intact"][:] = True
        found = SolidRow(**values)
        found.projectile_energy = 0.5 * found.projectile_mass * strike_velocity**2
        self._settle(found)
        return found

    def frequency(self, row: SolidRow) -> tuple[float, int]:
        """Bound the highest frequency [1/s] of a state, and find the node where it stands."""
        square, node = step_kernels.highest_frequency(row)
        return float(np.sqrt(square)), int(node)

    def _settle(self, row: SolidRow) -> None:
        """Find the feet of all facets, take off what overlaps, and bring the nose into touch."""
        gaps = np.empty(row.area.size)
        shares = np.empty(row.area.size)
        facet_kernels.find_feet(row, gaps, shares)
        if self.numerics.take_off_overlap:
            overlap = (shares > 0) & (gaps < 0)
            row.overlap[overlap] = gaps[overlap]
        distances = np.empty(row.tip_area.size)
        tip_kernels.find_tips(row, distances)
        row.tip_diameter[:] = np.minimum(row.tip_diameter, distances)
        if self.projectile is None:
            return
        middles = facet_middles(self.mesh)
        nose = self.projectile
        row.nose_position[2] = middles[:, 2].min() - nose.radius
        away = inf
        while away > TOUCHING:
            places = middles - row.nose_position
            below = self._below(places, nose.radius)
            away = min(nose.distance(place)[0] for place in places[below])
            row.nose_position[2] += away

    def _below(self, places: FloatArray, radius: float) -> Any:
        """Which places (n, 3) [m] about a nose of a radius [m] it can touch as it comes."""
        near = np.hypot(places[:, 0], places[:, 1]) <= radius
        if not near.any():
            raise InputError(key="aim", value=tuple(self.aim), allowed="on the patch")
        return near

    def _bars(self, yarn: int) -> int:
        shape = self.mesh.grids[yarn].shape
        return (shape[0] - 1) * shape[1] * shape[2]

    def _yarn_values(self) -> dict[str, Any]:
        """Numbers of each yarn."""
        grids = self.mesh.grids
        bars = [self._bars(yarn) for yarn in range(len(grids))]
        bricks = [int(np.prod(np.array(grid.shape) - 1)) for grid in grids]
        families = self.mesh.families
        yarns = [self.fabric.weave.yarns[family] for family in families]
        limits = [yarn.failure_strain if self.failure else inf for yarn in yarns]
        return {
            "first_node": np.array([grid.flat[0] for grid in grids]),
            "nx": np.array([grid.shape[0] - 1 for grid in grids]),
            "ny": np.array([grid.shape[1] - 1 for grid in grids]),
            "family": np.array(families),
            "first_brick": _starts(bricks),
            "first_bar": _starts(bars),
            "law": np.array([self._law(family) for family in families]),
            "lag": np.array([self.numerics.fibre_viscosity / yarn.wave_speed for yarn in yarns]),
            "failure_strain": np.array(limits),
        }

    def _law(self, family: int) -> tuple[float, ...]:
        """E_a, a_E [Pa], b_E, Vf0, V_c [-], G [Pa] of a family."""
        law = self._solid(family)
        return law.E_a, law.a_E, law.b_E, law.Vf0, law.V_c, law.G

    def _solid(self, family):
        law = self.fabric.solid_laws[family]
        if self.fibre_fractions is None:
            return law
        return replace(law, Vf0=self.fibre_fractions[family])

    def _brick_values(self) -> dict[str, Any]:
        """Geometry of the bricks at rest, their hourglass control and viscosity."""
        parts = []
        for grid, family in zip(self.mesh.grids, self.mesh.families):
            bricks = Bricks.of(self.mesh.points[corners(grid)])
            law = self._solid(family)
            across = law.K_r * law.E_c
            control = bricks.control((law.E_a * law.Vf0, across, across), law.G)
            density = self.fabric.weave.yarns[family].fibre_density * law.Vf0
            gradient, volume = at_points(self.mesh.points[corners(grid)])
            if not self.numerics.full_rule:
                # one point: `bricks` has its gradients and volume
                gradient = gradient[:, :0]
                volume = volume[:, :0]
            eta = self.numerics.solid_viscosity * np.sqrt(density) * bricks.edges[:, 1:]
            parts.append(
                {
                    "gradient": bricks.gradient,
                    "volume": bricks.volume,
                    "point_gradient": gradient,
                    "point_volume": volume,
                    "twist": bricks.twist,
                    "control": self._hourglass * control,
                    "viscosity": eta,
                }
            )
        return _joined(parts)

    @property
    def _hourglass(self):
        return 0.0 if self.numerics.full_rule else self.numerics.hourglass

    def _bar_values(self) -> dict[str, Any]:
        """Lengths and stiffnesses of the bars."""
        parts = []
        for grid, family, area in zip(self.mesh.grids, self.mesh.families, self.mesh.bar_area):
            along = np.diff(self.mesh.points[grid], axis=0)
            stiffness = self.fabric.weave.yarns[family].E * area
            parts.append(
                {
                    "bar_length": np.linalg.norm(along, axis=-1).ravel(),
                    "bar_stiffness": np.tile(stiffness.ravel(), len(along)),
                }
            )
        return _joined(parts)

    def _mass(self) -> FloatArray:
        """(n,) [kg] of the nodes."""
        mass = np.zeros(len(self.mesh.points))
        for grid, family, area in zip(self.mesh.grids, self.mesh.families, self.mesh.bar_area):
            density = self.fabric.weave.yarns[family].fibre_density
            length = np.linalg.norm(np.diff(self.mesh.points[grid], axis=0), axis=-1)
            half = 0.5 * density * area * length
            np.add.at(mass, grid[:-1], half)
            np.add.at(mass, grid[1:], half)
        return mass

    def _modelled(self) -> FloatArray:
        """(n,) share of each node that is modelled: a half for each plane of symmetry that it is on."""
        share = np.ones(len(self.mesh.points))
        if self.mesh.quarter:
            for yarn, grid in enumerate(self.mesh.grids):
                share[grid[0]] *= 0.5
                if self.mesh.cut_along(yarn):
                    share[grid[:, 0]] *= 0.5
        return share

    def _free(self) -> FloatArray:
        """(n, 3) where nodes may move: not at held ends, and not across planes of symmetry."""
        free = np.ones_like(self.mesh.points)
        for yarn, (grid, family) in enumerate(zip(self.mesh.grids, self.mesh.families)):
            if self.clamped:
                free[grid[-1]] = 0.0
            if self.mesh.quarter:
                free[grid[0].ravel(), family] = 0.0
            elif self.clamped:
                free[grid[0]] = 0.0
            if self.mesh.cut_along(yarn):
                free[grid[:, 0].ravel(), 1 - family] = 0.0
        return free

    def _faces(self) -> list[_Face]:
        """The lower and the upper face of each yarn."""
        return [
            _Face(yarn, kind, self.mesh) for yarn in range(len(self.mesh.grids)) for kind in (0, 1)
        ]

    def _face_values(self, mass: FloatArray) -> dict[str, Any]:
        """Faces, facets, who meets whom, and the bound of what their contacts give a node."""
        faces = self._faces()
        stiffness = np.zeros(len(self.mesh.points))
        parts = []
        for face in faces:
            area = facet_areas(self.mesh.points[face.nodes]).ravel()
            quads = face.quads()
            partner, foot = self._partners(face, faces)
            damping = self._damper(area, 0.25 * mass[quads].sum(axis=1))
            parts.append({"area": area, "damping": damping, "partner": partner, "foot": foot})
            # as slave and as master half the penalty each, twice of it in a row, and the nose
            np.add.at(stiffness, quads, 0.25 * 3 * self.numerics.penalty * area[:, None])
        return _joined(parts) | {
            "face_node": np.array([face.nodes[0, 0] for face in faces]),
            "face_facet": _starts([face.facets for face in faces]),
            "face_turn": np.array([face.turn() for face in faces]),
            "cut": np.array([self.mesh.cut_along(yarn) for yarn in range(len(self.mesh.grids))]),
            "contact_stiffness": stiffness + self._tip_stiffness(),
        }

    def _damper(self, area: FloatArray, mass: FloatArray) -> FloatArray:
        """[N s/m] of contacts of these areas [m2] and masses [kg] in one pass."""
        spring = 0.5 * self.numerics.penalty * area
        return 2 * self.numerics.contact_damping * np.sqrt(spring * mass)

    def _partners(self, face: _Face, faces: list[_Face]) -> tuple[IntArray, FloatArray]:
        """The face (facets,) that each facet may meet, -1 for none, and a first guess of its foot
        (facets, 2)."""
        middles = face.middles()
        family = self.mesh.families[face.yarn]
        crossing = [
            other
            for other, own in enumerate(self.mesh.families)
            if own != family and self.mesh.over(face.yarn, other) == (face.kind == 0)
        ]
        if not crossing:
            return np.full(face.facets, -1), np.zeros((face.facets, 2))
        away = np.abs(middles[:, family][:, None] - self.mesh.axes[crossing])
        nearest = np.array(crossing)[np.argmin(away, axis=1)]
        partners = FACES * nearest + 1 - face.kind
        return partners, _guess(middles, partners, faces)

    def _side_values(self, mass: FloatArray) -> dict[str, Any]:
        """Sides, their tips, and which faces which."""
        grids = self.mesh.grids
        sides = [(yarn, kind) for yarn in range(len(grids)) for kind in (0, 1)]
        parts = []
        for yarn, kind in sides:
            area = self._tip_areas(yarn, kind)
            light = mass[grids[yarn][:, -kind, :]].sum(axis=1)
            parts.append(
                {
                    "tip_area": area,
                    "tip_damping": self._damper(area, light),
                    "tip_foot": np.arange(float(len(area))),
                    "tip_diameter": np.full(len(area), self._edge(yarn)),
                }
            )
        return _joined(parts) | {
            "side_node": np.array([grids[yarn][0, -kind, 0] for yarn, kind in sides]),
            "side_tip": _starts([len(part["tip_area"]) for part in parts]),
            "side_partner": np.array([self._facing(yarn, kind) for yarn, kind in sides]),
        }

    def _tip_stiffness(self) -> FloatArray:
        """(n,) [N/m] bound of what the contacts of tips give a node: as slave and as master half the
        penalty each, twice of it in a row."""
        found = np.zeros(len(self.mesh.points))
        for yarn, grid in enumerate(self.mesh.grids):
            for kind in (0, 1):
                nodes = grid[:, -kind, :]
                spring = 2 * self.numerics.penalty * self._tip_areas(yarn, kind) / nodes.shape[1]
                np.add.at(found, nodes, spring[:, None])
        return found

    def _tip_areas(self, yarn: int, kind: int) -> FloatArray:
        """(nx + 1,) [m2] of the tips of a side: the length of each, times the diameter of the edge."""
        line = self.mesh.points[self.mesh.grids[yarn][:, -kind, :]].mean(axis=1)
        half = 0.5 * np.linalg.norm(np.diff(line, axis=0), axis=1)
        return self._edge(yarn) * (np.append(half, 0) + np.append(0, half))

    def _edge(self, yarn: int) -> float:
        """[m] diameter of the rounded edges of a yarn."""
        heights = self.mesh.points[self.mesh.grids[yarn][0]][..., 2]
        return self.numerics.edge_diameter * float(np.ptp(heights, axis=-1).max())

    def _outwards(self, yarn: int, kind: int) -> float:
        """1 if a side, 0 or 1, of a yarn lies towards higher coordinates, else -1; 0 of a side on a
        plane of symmetry."""
        if kind == 0 and self.mesh.cut_along(yarn):
            return 0.0
        across = 1 - self.mesh.families[yarn]
        line = self.mesh.points[self.mesh.grids[yarn][:, -kind, :]]
        return float(np.sign(line[..., across].mean() - self.mesh.axes[yarn]))

    def _facing(self, yarn: int, kind: int) -> int:
        """The number of the side that faces one; -1 for none."""
        mesh = self.mesh
        outwards = self._outwards(yarn, kind)
        for other in (yarn - 1, yarn + 1):
            if not 0 <= other < len(mesh.grids) or mesh.families[other] != mesh.families[yarn]:
                continue
            if np.sign(mesh.axes[other] - mesh.axes[yarn]) != outwards:
                continue
            for facing in (0, 1):
                if self._outwards(other, facing) == -outwards:
                    return 2 * other + facing
        return -1

    def _nose_values(self, strike_velocity: float) -> dict[str, Any]:
        """The projectile, or one that is nowhere near."""
        shot = self.projectile
        position = np.array([*map(float, self.aim), 0.0])
        if shot is None:
            shot = Projectile()
            position[2] = -1.0
        free = np.ones(3)
        if self.mesh.quarter:
            free[:2] = 0.0
        return {
            "nose": shot.nose,
            "nose_friction": float(shot.friction),
            "projectile_mass": shot.mass * self.mesh.share,
            "projectile_free": free,
            "nose_position": position,
            "nose_velocity": np.array([0.0, 0.0, float(strike_velocity)]),
        }


@dataclass(frozen=True, eq=False)
class _Face:
    """The lower (kind 0) or the upper (1) face of a yarn."""

    yarn: int
    kind: int
    mesh: SolidMesh

    @property
    def nodes(self) -> IntArray:
        return self.mesh.grids[self.yarn][:, :, -self.kind]

    @property
    def facets(self) -> int:
        return (self.nodes.shape[0] - 1) * (self.nodes.shape[1] - 1)

    def quads(self) -> IntArray:
        """(facets, 4) nodes."""
        n = self.nodes
        parts = n[:-1, :-1], n[1:, :-1], n[1:, 1:], n[:-1, 1:]
        return np.stack([part.ravel() for part in parts], axis=1)

    def middles(self) -> FloatArray:
        """(facets, 3) [m]"""
        return self.mesh.points[self.quads()].mean(axis=1)

    def turn(self) -> float:
        """1 if the normal along x across points out of the yarn, else -1."""
        points = self.mesh.points[self.nodes]
        normal = np.cross(points[1, 0] - points[0, 0], points[0, -1] - points[0, 0])
        return float(np.sign(normal[2]) * (2 * self.kind - 1))


def check_projectile(projectile: Projectile) -> None:
    """Refuse a projectile that solid yarns do not meet.

    Raises
    ------
    InputError : it is tilted or oblique, deforms, or is of the shape "stl"
    """
    for key in ("obliquity", "yaw", "roll"):
        if getattr(projectile, key):
            allowed = "0 with solid yarns, which are struck straight on"
            raise InputError(key=key, value=getattr(projectile, key), allowed=allowed)
    if projectile.body != "rigid":
        raise InputError(key="body", value=projectile.body, allowed="rigid with solid yarns")


def facet_middles(mesh: SolidMesh) -> FloatArray:
    """Compute the middles (n, 3) [m] of the facets of all faces."""
    faces = [_Face(yarn, kind, mesh) for yarn in range(len(mesh.grids)) for kind in (0, 1)]
    return np.concatenate([face.middles() for face in faces])


def _guess(middles, partners, faces):
    """(facets, 2) first guess of the feet of points on faces at rest, which are straight in plan."""
    feet = np.zeros((len(middles), 2))
    for number in np.unique(partners):
        face = faces[number]
        points = face.mesh.points[face.nodes]
        family = face.mesh.families[face.yarn]
        mine = partners == number
        stations = np.arange(len(points))
        feet[mine, 0] = np.interp(middles[mine, family], points[:, 0, family], stations)
        feet[mine, 1] = 0.5 * (points.shape[1] - 1)
    return feet


def _joined(parts):
    """{name: arrays of all parts, one after the other}."""
    return {
        name: np.ascontiguousarray(np.concatenate([part[name] for part in parts]))
        for name in parts[0]
    }


def _starts(counts):
    """(n,) where each of several parts begins."""
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
