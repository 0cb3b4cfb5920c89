"""A woven patch of solid yarns with fibre bars, and the projectile before it: what the kernels work on.

The model of the thesis, chapter 3, in explicit dynamics: bricks with the volume-fraction law, bars along the
fibre, frictionless contact of the yarns where they cross, all yarn ends held. A plain weave has no plane of symmetry
between its yarns, so the patch is whole.

Mass is the fibres' alone: each bar's, half to each of its nodes; it sums to the yarn's linear density times its length.
"""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from shellfabric.backing.hex8 import Bricks
from shellfabric.jit.by_reference import by_reference
from shellfabric.projectile.projectile import Projectile
from validation.models.solid import solid_kernels, step_kernels, yarn_contact_kernels
from validation.models.solid.numerics import PatchNumerics

Constants = namedtuple(
    "Constants",
    "first_node bricks_along ny nz yarn_type first_brick first_bar type_brick type_bar type_face gradient volume "
    "hourglass_pattern hourglass_stiffness solid_viscosity solid_law bar_length bar_stiffness fibre_law mass "
    "inverse_mass face_area nose_damping nose_penalty nose_shape nose_parameters projectile_mass crossing_order "
    "colour_start crossing_node crossing_brick crossing_start warp_over cp_bounds crossing_shape contact_penalty "
    "contact_area contact_damping contact_row_sum",
)
State = namedtuple(
    "State",
    "x v f_material f_other bar_intact brick_failed last_log_stretch closest_point wait_steps energy_sums "
    "half_step_work contact_energy nose_sums projectile_energy projectile_position projectile_velocity "
    "f_contact_nose step_sizes counter time",
)
by_reference(Constants, State)


# of all kinds of yarn
JOINED = (
    "gradient",
    "volume",
    "hourglass_pattern",
    "hourglass_stiffness",
    "solid_viscosity",
    "bar_length",
    "face_area",
)
KIND_STARTS = {"type_brick": "volume", "type_bar": "bar_length", "type_face": "face_area"}


@dataclass(frozen=True, eq=False)
class SolidPatch:
    """A meshed patch with its laws.

    Parameters
    ----------
    mesh : meshing.patch.Patch, or a whole meshing.crossover.Crossover
    fabric : Fabric, with solid laws, as it was meshed
    projectile : Projectile, at no obliquity, yaw or roll, without friction; its axis is the middle of the patch
    numerics : PatchNumerics
    failure : whether fibres fail
    clamped : whether the ends of the yarns are held

    Raises
    ------
    InputError : the fabric is not the meshed one or has no solid laws, the mesh is a quarter or has fewer than 4 bricks
        along a crossing, or the projectile is tilted or rubs
    """

    mesh: Any
    fabric: Fabric
    projectile: Projectile = field(default_factory=Projectile)
    numerics: PatchNumerics = field(default_factory=PatchNumerics)
    failure: bool = True
    clamped: bool = True

    def __post_init__(self):
        if self.fabric.solid_laws is None:
            raise InputError(f"fabric {self.fabric.name} has no [solid] tables, which a solid patch needs")
        if self.mesh.fabric != self.fabric.name:
            raise InputError(key="fabric", value=self.fabric.name, allowed=f"the meshed one, {self.mesh.fabric}")
        if getattr(self.mesh, "domain", "whole") != "whole":
            raise InputError(key="domain", value=self.mesh.domain, allowed="'whole'")
        if self.per_crossing < 4:
            raise InputError(key="size", value=self.per_crossing, allowed="at least 4 bricks along a crossing")
        if self.projectile.tilted or self.projectile.obliquity or self.projectile.friction:
            raise InputError("a solid patch is struck straight on, by a projectile without friction")

    @property
    def count(self) -> tuple[int, ...]:
        """(n, m) numbers of warp and of weft yarns."""
        return tuple(self.mesh.families.count(family) for family in (0, 1))

    @property
    def per_crossing(self) -> int:
        """Bricks along a yarn in one crossing."""
        return (self.mesh.grids[0].shape[0] - 1) // self.count[1]

    @property
    def bricks(self) -> int:
        """Number of bricks."""
        return len(self.mesh.hexes)

    def constants(self) -> Constants:
        """What does not change in a run."""
        numerics, grids = self.numerics, self.mesh.grids
        bars = [np.prod((grid.shape[0] - 1, *grid.shape[1:])) for grid in grids]
        bricks = [np.prod(np.array(grid.shape) - 1) for grid in grids]
        kinds, kind = self._kinds()
        made = [self._kind(yarn) for yarn in kinds]
        mass, free = self._mass(), np.ones(len(self.mesh.points))
        for grid in grids if self.clamped else ():
            free[grid[0]] = free[grid[-1]] = 0.0
        faces = [part["face_area"] for part in made]
        nose = [
            2 * numerics.contact_damping * np.sqrt(numerics.penalty * area * mass[grids[yarn][:, :, 0]])
            for yarn, area in zip(kinds, faces)
        ]
        shot = self.projectile
        crossings = self._crossings(mass)
        return Constants(
            first_node=np.array([grid.flat[0] for grid in grids]),
            bricks_along=np.array([grid.shape[0] - 1 for grid in grids]),
            ny=grids[0].shape[1] - 1,
            nz=grids[0].shape[2] - 1,
            yarn_type=kind,
            first_brick=np.concatenate([[0], np.cumsum(bricks)[:-1]]),
            first_bar=np.concatenate([[0], np.cumsum(bars)[:-1]]),
            **{key: _starts(made, part) for key, part in KIND_STARTS.items()},
            **{key: np.concatenate([part[key] for part in made]) for key in JOINED},
            **{key: np.stack([part[key] for part in made]) for key in ("solid_law", "bar_stiffness", "fibre_law")},
            mass=mass,
            inverse_mass=free / mass,
            nose_damping=np.concatenate(nose),
            nose_penalty=np.array([numerics.penalty, numerics.toe]),
            nose_shape=np.array(
                [shot.number, shot.radius, shot.edge_radius, inf if shot.length is None else shot.length]
            ),
            nose_parameters=shot.form,
            projectile_mass=shot.mass,
            crossing_shape=np.array(
                [self.per_crossing, *(grids[k].shape[0] - 1 for k in (0, -1)), *(n - 1 for n in grids[0].shape[1:])]
            ),
            contact_penalty=np.array([numerics.penalty, numerics.toe, numerics.deepest]),
            contact_row_sum=self._contact_rows(kind, faces),
            **crossings,
        )

    def state(self, strike_velocity: float) -> State:
        """At rest, the projectile about to touch."""
        mesh, grids = self.mesh, self.mesh.grids
        n, slaves = len(mesh.points), (self.per_crossing + 1) * grids[0].shape[1]
        crossings = self.count[0] * self.count[1]
        bars = sum(len(pairs) for pairs in mesh.bars)
        return State(
            x=np.array(mesh.points, float),
            v=np.zeros((n, 3)),
            f_material=np.zeros((n, 3)),
            f_other=np.zeros((n, 3)),
            bar_intact=np.ones(bars, bool),
            brick_failed=np.zeros(self.bricks, bool),
            last_log_stretch=np.zeros((self.bricks, 2)),
            closest_point=np.zeros((crossings, 2, slaves, 2)),
            wait_steps=np.zeros((crossings, 2, slaves), np.int64),
            energy_sums=np.zeros((len(grids), solid_kernels.SUMS)),
            half_step_work=np.zeros(len(grids)),
            contact_energy=np.zeros((crossings, 2)),
            nose_sums=np.zeros((len(grids), 5)),
            projectile_energy=np.zeros(1),
            projectile_position=np.array([0.0, 0.0, self._lowest()]),
            projectile_velocity=np.array([0.0, 0.0, float(strike_velocity)]),
            f_contact_nose=np.zeros(3),
            step_sizes=np.zeros(3),
            counter=np.zeros(1, np.int64),
            time=np.zeros(1),
        )

    def ready(self, strike_velocity: float) -> tuple[Constants, State]:
        """Constants and state, the feet of all nodes found."""
        const, state = self.constants(), self.state(strike_velocity)
        yarn_contact_kernels.find_closest_points(
            state.x,
            const.crossing_node,
            const.crossing_start,
            const.warp_over,
            const.cp_bounds,
            const.crossing_shape,
            state.closest_point,
        )
        return const, state

    def frequency(self, const: Constants, state: State) -> tuple[float, int]:
        """Bound of the highest frequency [1/s] in the state as it is, and the node where it stands."""
        worst = np.zeros((len(self.mesh.grids), 2))
        step_kernels.frequency_bounds(state, const, worst)
        yarn = int(np.argmax(np.where(np.isfinite(worst[:, 0]), worst[:, 0], np.inf)))
        return float(np.sqrt(worst[yarn, 0])), int(worst[yarn, 1])

    def _lowest(self):
        """[m] where the nose first touches: the lowest node under its flat or tip."""
        points = self.mesh.points
        near = np.hypot(points[:, 0], points[:, 1]) < max(self.projectile.radius, np.hypot(*self.mesh.w))
        return float(points[near, 2].min())

    def _kinds(self):
        """Yarns that differ in more than place, and for each yarn which of them it is like."""
        kinds, kind = [], []
        for yarn, (grid, family) in enumerate(zip(self.mesh.grids, self.mesh.families)):
            own = self.mesh.points[grid] - self._origin(yarn)
            for number, other in enumerate(kinds):
                like = self.mesh.points[self.mesh.grids[other]] - self._origin(other)
                if self.mesh.families[other] == family and np.allclose(own, like, rtol=0, atol=1e-12):
                    kind.append(number)
                    break
            else:
                kind.append(len(kinds))
                kinds.append(yarn)
        return kinds, np.array(kind)

    def _origin(self, yarn):
        """A place that moves sideways with the yarn."""
        grid = self.mesh.grids[yarn]
        middle = self.mesh.points[grid[0, grid.shape[1] // 2, 0]].copy()
        middle[2] = 0.0
        return middle

    def _kind(self, yarn):
        """Bricks, bars and faces of one yarn."""
        mesh, numerics = self.mesh, self.numerics
        family, grid = mesh.families[yarn], mesh.grids[yarn]
        material, solid = self.fabric.weave.yarns[family], self.fabric.solid_laws[family]
        Vf0 = mesh.Vf0[family]
        b_E = (solid.V_c - solid.K_r * Vf0) / (1 - solid.K_r)
        law = np.array([solid.E_a, solid.E_c * (b_E - solid.V_c), b_E, Vf0, solid.V_c, solid.G])
        bricks = Bricks.of(mesh.points[_corners(grid)])
        control = bricks.control((solid.E_a * Vf0, *2 * (solid.K_r * solid.E_c,)), solid.G)
        ends = mesh.points[np.stack([grid[:-1].ravel(), grid[1:].ravel()])]
        sheet = grid.shape[1] * grid.shape[2]
        limit = material.failure_strain if self.failure else inf
        lag = numerics.fibre_viscosity / np.sqrt(material.E / material.fibre_density)
        return {
            "gradient": bricks.gradient,
            "volume": bricks.volume,
            "hourglass_pattern": np.ascontiguousarray(bricks.twist),
            "hourglass_stiffness": numerics.hourglass * control,
            "solid_viscosity": np.ascontiguousarray(
                numerics.solid_viscosity * np.sqrt(material.fibre_density * Vf0) * bricks.edges[:, 1:]
            ),
            "solid_law": law,
            "bar_length": np.linalg.norm(ends[1] - ends[0], axis=1),
            "bar_stiffness": material.E * np.ascontiguousarray(mesh.bar_area[yarn][:sheet]),
            "fibre_law": np.array([numerics.slack_stiffness, numerics.slack_width, lag, limit]),
            "face_area": face_area(mesh.points[grid[:, :, 0]]),
        }

    def _mass(self):
        """(n,) [kg] of the nodes."""
        mass = np.zeros(len(self.mesh.points))
        for family, pairs, area in zip(self.mesh.families, self.mesh.bars, self.mesh.bar_area):
            density = self.fabric.weave.yarns[family].fibre_density
            length = np.linalg.norm(np.diff(self.mesh.points[pairs], axis=1)[:, 0], axis=1)
            for end in (0, 1):
                np.add.at(mass, pairs[:, end], 0.5 * density * area * length)
        return mass

    def _contact_rows(self, kind, faces):
        """(n,) [N/m] bounds of the contact's rows: as slave, as master and under the nose."""
        rows = np.zeros(len(self.mesh.points))
        for grid, number in zip(self.mesh.grids, kind):
            for face in (0, -1):
                rows[grid[:, :, face]] = 3 * self.numerics.penalty * faces[number]
        return rows

    def _crossings(self, mass):
        """Who meets whom, and where."""
        (n, m), cell, grids = self.count, self.per_crossing, self.mesh.grids
        warp, weft = (index.ravel() for index in np.meshgrid(range(n), range(m), indexing="ij"))
        over = (warp + weft) % 2 == 0
        starts = np.stack([weft * cell, warp * cell], axis=1)
        margin, ends = max(cell // 2 - 2, 0), [m * cell, n * cell]
        bounds = np.stack([np.maximum(starts - margin, 0), np.minimum(starts + cell + margin, ends)], axis=2)
        area, damping = [], []
        for c in range(n * m):
            for grid, face in ((grids[warp[c]], 0 if over[c] else -1), (grids[n + weft[c]], -1 if over[c] else 0)):
                start = starts[c, len(area) % 2]
                nodes = grid[start : start + cell + 1, :, face]
                area.append(face_area(self.mesh.points[nodes]).ravel())
                half = 0.5 * self.numerics.penalty * area[-1]
                damping.append(2 * self.numerics.contact_damping * np.sqrt(half * mass[nodes].ravel()))
        shape = (n * m, 2, -1)
        colour = 2 * (warp % 2) + weft % 2
        first = np.array([grid.flat[0] for grid in grids])
        brick = np.concatenate([[0], np.cumsum([np.prod(np.array(grid.shape) - 1) for grid in grids])[:-1]])
        return {
            "crossing_order": np.argsort(colour, kind="stable"),
            "colour_start": np.concatenate([[0], np.cumsum(np.bincount(colour, minlength=4))]),
            "crossing_node": np.stack([first[warp], first[n + weft]], axis=1),
            "crossing_brick": np.stack([brick[warp], brick[n + weft]], axis=1),
            "crossing_start": starts,
            "warp_over": over,
            "cp_bounds": bounds.astype(float),
            "contact_area": np.array(area).reshape(shape),
            "contact_damping": np.array(damping).reshape(shape),
        }


def _starts(made, key):
    return np.concatenate([[0], np.cumsum([len(part[key]) for part in made])[:-1]])


def face_area(points: FloatArray) -> FloatArray:
    """(p, q) [m2] areas of the nodes of a face (p, q, 3): a quarter of each quadrilateral to each of its corners."""
    quads = 0.5 * np.linalg.norm(
        np.cross(points[1:, 1:] - points[:-1, :-1], points[:-1, 1:] - points[1:, :-1]), axis=-1
    )
    area = np.zeros(points.shape[:2])
    for i in (0, 1):
        for j in (0, 1):
            area[i : i + quads.shape[0], j : j + quads.shape[1]] += quads / 4
    return area


def _corners(grid):
    """(m, 8) nodes of the bricks of a yarn's grid, k fastest."""
    a, b = slice(None, -1), slice(1, None)
    parts = [(a, a, a), (b, a, a), (b, b, a), (a, b, a), (a, a, b), (b, a, b), (b, b, b), (a, b, b)]
    return np.stack([grid[part] for part in parts], axis=-1).reshape(-1, 8)
