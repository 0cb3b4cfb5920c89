"""The backing block: an elastic-plastic solid with erosion (thesis section 6.5, Table 6-1;
docs/theory-panel.md, "Backing block").

A quarter of it, or the whole, x and y from the axis of the shot, its face at z = 0 or at `standoff`,
z into it, along the flight. The thesis gives size, modulus, density, yield stress and erosion strain,
but neither Poisson's ratio, hardening, mesh nor outer faces (`materials.toml`). In each step:

    block = Backing().block(dt)
    forces = block.press(places, velocities, stiffness)      # forces on points of the last ply [N]
    push = block.strike(position, speed)                     # force on a rigid projectile [N]
    block.advance()
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Annotated, Any

import numpy as np

from fabrics.backings import assumed_line
from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.fields import check_fields, finite
from fabrics.base.frozen import explain_frozen
from fabrics.materials import Isotropic, load
from shellfabric.block import block_kernels as kernels
from shellfabric.block import contact_kernels as touch
from shellfabric.block.block_keys import BlockKeys
from shellfabric.block.hex8 import Bricks
from shellfabric.block.state import BlockLaw, BlockPoints, BlockRow
from shellfabric.law_rows import make_law
from shellfabric.parts import own_steps
from shellfabric.projectile.projectile import Projectile
from shellfabric.state import Nose
from shellfabric.subcycle_kernels import make_steps

ENERGIES = (
    "kinetic",
    "elastic",
    "plastic",
    "hourglass",
    "viscous",
    "absorbed",
    "eroded",
    "contact",
    "damped",
)
CHECK_INTERVAL = 10  # steps from one look at what the flattened bricks bear to the next
CFL = 0.8  # of the bound that a step of the block's own takes
MAX_SUBSTEPS = 32


@explain_frozen
@dataclass(frozen=True)
class Backing(BlockKeys):
    """A block, its mesh and its contacts.

    Parameters
    ----------
    material : Isotropic
    size : (x, y, z) [m] of the whole block
    min_size : [m] edge of the smallest elements, under the shot
    refined_depth : [m] extent of these from the axis, and from the face
    growth : factor from brick to brick beyond, at most
    outer_boundary : "fixed", "absorbing" or "free" outer faces
    standoff : [m] of the face from z = 0; behind a panel (`block.coupling`) from the back of its
        last ply
    hourglass : factor f of the hourglass control (`control_kernels`): of the stiffness of the full
        rule, which would stand in for strength lost in flow, and of the shear modulus that holds
        the volumes of the corners
    viscosity : damping ratio of the highest mode
    penalty : stiffness of the contact with a projectile, in units of the bricks' own K A / h
    contact_damping : ratio to critical of a node on that spring, and of a point of the fabric on
        its own
    ply_penalty : stiffness of the contact with fabric, in units of the fabric's mass / dt^2
    points : of contact along each side of an element of fabric
    after_stop : [s] for which a run goes on after the projectile has turned back, while the block
        comes to rest
    mirrors : whether x = 0 and y = 0 are planes of symmetry that bound the modelled part
    name : of the backing (`fabrics.backings`) that the material is of, or ""

    Raises
    ------
    InputError : a value out of its range
    """

    material: Isotropic = field(default_factory=lambda: load("backing"))
    hourglass: Annotated[float, finite(ge=0.0)] = 0.1
    viscosity: Annotated[float, finite(ge=0.0)] = 0.1
    penalty: Annotated[float, finite(gt=0.0)] = 10.0
    contact_damping: Annotated[float, finite(ge=0.0)] = 0.2
    ply_penalty: Annotated[float, finite(gt=0.0)] = 0.1
    points: Annotated[int, finite(gt=0.0)] = 2
    mirrors: tuple[bool, bool] = (True, True)
    name: str = ""

    def __post_init__(self):
        check_fields(self)
        if len(self.size) != 3 or not all(0 < 2 * self.min_size <= length for length in self.size):
            raise InputError(
                key="size",
                value=self.size,
                allowed=f"three lengths of at least {2 * self.min_size:g} m",
            )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What a run takes for granted of it, a sentence each: the constants that are assumed, its
        outer faces, and how long it is followed."""
        ends = "The run ends when the projectile has stopped."
        if self.after_stop:
            ends = (
                f"It is followed for {1e3 * self.after_stop:g} ms after the projectile has stopped."
            )
        return (
            f"{assumed_line(self.name, self.material)}.",
            f"Its outer faces are {self.outer_boundary}.",
            ends,
        )

    @property
    def settings(self) -> dict[str, Any]:
        """{name: value in SI units} of its material, mesh and contacts."""
        own = {
            entry.name: getattr(self, entry.name)
            for entry in fields(self)
            if entry.name != "material"
        }
        return {
            entry.name: getattr(self.material, entry.name) for entry in fields(self.material)
        } | own

    @property
    def lines(self) -> tuple[FloatArray, ...]:
        """x, y, z [m] of the mesh planes of the modelled part."""
        half = (0.5 * self.size[0], 0.5 * self.size[1], self.size[2])
        found = [graded(length, self.min_size, self.refined_depth, self.growth) for length in half]
        for axis, mirrored in enumerate(self.mirrors):
            if not mirrored:
                found[axis] = np.append(-found[axis][:0:-1], found[axis])
        return tuple(found)

    @property
    def count(self) -> tuple[int, ...]:
        """(nx, ny, nz) bricks of the modelled part."""
        return tuple(len(line) - 1 for line in self.lines)

    @property
    def longest_step(self) -> float:
        """[s] bound of the step at rest, 1 / c (sum over the finest edges of 1 / h^2)^(1/2), and
        less for viscosity."""
        least = np.array([np.diff(line).min() for line in self.lines])
        damped = np.sqrt(1 + self.viscosity**2) - self.viscosity
        return float(damped / self.material.wave_speed / np.sqrt(np.sum(1 / least**2)))

    def block(self, dt: float) -> Block:
        """Return the block at rest, to be moved in steps of `dt` [s].

        Raises
        ------
        InputError : the step is longer than the mesh allows
        """
        return Block(self, dt)


def graded(length: float, min_size: float, refined_depth: float, growth: float) -> FloatArray:
    """Grade places (n + 1,) [m] from 0 to `length`: equal steps up to `refined_depth`, then growing
    by `growth` at most."""
    from scipy.optimize import brentq

    even = min(max(1, round(refined_depth / min_size)), max(1, round(length / min_size)))
    places = np.linspace(0, even * min_size, even + 1)
    left = length - places[-1]
    if left < 0.5 * min_size:
        return places * (length / places[-1])
    steps = 1
    while min_size * np.sum(growth ** np.arange(1, steps + 1)) < left:
        steps += 1
    if min_size * steps >= left:  # too little is left to grow
        return np.concatenate([places, places[-1] + left * np.arange(1, steps + 1) / steps])
    factor = brentq(
        lambda g: min_size * np.sum(g ** np.arange(1, steps + 1)) - left, 1.0, growth + 1e-9
    )
    return np.concatenate(
        [places, places[-1] + min_size * np.cumsum(factor ** np.arange(1, steps + 1))]
    )


class Block:
    """A block in motion, of a Backing, in steps of dt [s].

    Attributes
    ----------
    row : state.BlockRow, what the kernels work on
    x, v : (n, 3) [m], [m/s] places, and velocities of half a step ago
    mass, alpha, gone : as in `row`
    """

    def __init__(self, backing: Backing, dt: float) -> None:
        if not 0 < dt <= backing.longest_step:
            raise InputError(
                key="dt", value=dt, allowed=f"above 0 and at most {backing.longest_step:.3g} s"
            )
        self.backing = backing
        self.dt = float(dt)
        self.shape = nx, ny, nz = backing.count
        grid = np.stack(np.meshgrid(*backing.lines, indexing="ij"), axis=-1)
        grid[..., 2] += backing.standoff
        self.rest = grid.reshape(-1, 3)
        nodes = np.arange(len(self.rest)).reshape(grid.shape[:3])
        self.nodes = nodes
        bricks = Bricks.of(self.rest[_corners(nodes)])
        material = backing.material
        found = BlockRow.zeros(bricks=nx * ny * nz, nodes=nodes.size, sheets=nx + 1)
        found |= {
            "nx": nx,
            "ny": ny,
            "nz": nz,
            "gradient": bricks.gradient,
            "volume": bricks.volume,
            "shape": np.ascontiguousarray(bricks.twist),
            "control": backing.hourglass * bricks.control_weights,
            "hourglass_factor": backing.hourglass,
            "edges": bricks.edges,
            "x": self.rest.copy(),
        }
        viscosity = backing.viscosity * material.density * material.wave_speed
        found["law"] = make_law(BlockLaw, material, bulk_viscosity=viscosity)
        found["metric"][:] = np.eye(3)
        found["substeps"][...] = 1
        self._set_boundaries(bricks, found)
        self.row = BlockRow(**found)
        self.x = self.row.x
        self.v = self.row.v
        self.mass = self.row.mass
        self.alpha = self.row.alpha
        self.gone = self.row.gone
        self.points: BlockPoints | None = None  # of `press`

    def _set_boundaries(self, bricks, found):
        """Masses, supports, dashpots and contact springs of the nodes, into the arrays `found`."""
        nodes = self.nodes
        backing = self.backing
        material = self.backing.material
        share = np.repeat(bricks.volume / 8, 8)
        corners = _corners(nodes).ravel()
        mass = np.bincount(corners, material.density * share)
        free = found["free"]
        free[:] = 1.0
        outer = [(0, nodes[-1]), (1, nodes[:, -1]), (2, nodes[:, :, -1])]
        for axis, (face, mirrored) in enumerate(zip((nodes[0], nodes[:, 0]), backing.mirrors)):
            if mirrored:
                free[face, axis] = 0.0
            else:
                outer.append((axis, face))
        for axis, face in outer:
            if backing.outer_boundary == "fixed":
                free[face] = 0.0
            elif backing.outer_boundary == "absorbing":
                places = self.rest[face]
                edges = np.cross(
                    places[1:, 1:] - places[:-1, :-1], places[:-1, 1:] - places[1:, :-1]
                )
                quads = 0.125 * np.linalg.norm(edges, axis=-1)
                area = np.zeros(face.shape)
                for i in (0, 1):
                    for j in (0, 1):
                        area[i : i + quads.shape[0], j : j + quads.shape[1]] += quads
                speeds = np.full(3, material.shear_speed)
                speeds[axis] = material.wave_speed
                found["dashpot"][face] += material.density * area[..., None] * speeds
        own = backing.penalty * material.bulk * bricks.volume / bricks.edges.min(axis=1) ** 2 / 8
        stiffness = np.minimum(np.bincount(corners, np.repeat(own, 8)), 0.5 * mass / self.dt**2)
        found["mass"] = mass
        found["stiffness"] = stiffness
        found["damping"] = 2 * backing.contact_damping * np.sqrt(stiffness * mass)

    def strike(
        self,
        position: FloatArray,
        speed: FloatArray,
        projectile: Projectile,
        nose: Nose | None = None,
    ) -> np.ndarray:
        """Let a projectile touch the block in this step; return the force (3,) [N] on the part of it
        that is modelled.

        Parameters
        ----------
        position, speed : (3,) [m], [m/s] of the nose
        projectile : Projectile, along z
        nose : its shape as it is; None of one that does not change
        """
        if nose is None:
            nose = projectile.nose
        row = self.row
        position = np.asarray(position, float)
        speed = np.asarray(speed, float)
        ring_power = touch.nose_forces(row, position, speed, nose)
        force = row.nose_force + row.nose_drag
        if projectile.deforms:  # it holds the force of a step ago over all of the step:
            # the last half of what the force of a step ago does, in place of the first of this one
            later = float((row.force_before - force)[2] * speed[2])
            row.taken -= self.dt * (ring_power + 0.5 * later)
        return self._take(row.force_before, force, speed)

    def press(
        self,
        places: FloatArray,
        velocities: FloatArray,
        stiffness: FloatArray,
        *,
        damping: FloatArray | None = None,
        thickness: float = 0.0,
    ) -> np.ndarray:
        """Let points touch the block in this step; return the forces (s, 3) [N] on them. Always the
        same points, in the same order.

        Parameters
        ----------
        places, velocities : (s, 3) [m], [m/s] in the modelled part
        stiffness, damping : (s,) [N/m], [N s/m] of each point's spring
        thickness : [m] distance that they keep from the face
        """
        if self.points is None:
            self.points = self._make_points(np.asarray(places, float), thickness)
        points = self.points
        points.x[:] = places
        points.v[:] = velocities
        points.stiffness[:] = stiffness
        points.damping[:] = 0.0
        if damping is not None:
            points.damping[:] = damping
        touch.point_forces(self.row, points, float(thickness), self.dt)
        return self._take(points.force_before, points.force + points.drag, velocities)

    def _make_points(self, places, thickness):
        """BlockPoints that have not touched yet, above the columns of the block at rest."""
        points = BlockPoints(**BlockPoints.zeros(points=len(places)))
        for axis in (0, 1):
            column = np.searchsorted(self.backing.lines[axis], places[:, axis]) - 1
            points.columns[:, axis] = np.clip(column, 0, self.shape[axis] - 1)
        # as against the face at rest
        points.inside[:] = places[:, 2] + thickness - self.backing.standoff
        return points

    def _take(self, before, force, speed):
        """Add what contact takes from a partner that moves at `speed` in half a step before now, by
        its force of now, and by that of a step ago, which it replaces; the force."""
        both = before + force
        self.row.taken -= 0.5 * self.dt * float(np.sum(both * np.asarray(speed, float)))
        before[...] = force
        return force

    def advance(self) -> None:
        """Move the block by one step, under the contacts of this step.

        Raises
        ------
        UnstableError : a brick is turned inside out, or so flat that MAX_SUBSTEPS are too few
        """
        count = int(self.row.substeps)
        if self.row.steps % CHECK_INTERVAL == 0:
            # at first a step may take all of its bound, which is that of the block at rest
            count = 1
            if self.row.steps:
                count = own_steps(self.dt, CFL * self.stable_step())
        self.row.substeps = count
        self.row.steps += 1
        if count > MAX_SUBSTEPS:
            raise self._unstable(
                f"a brick is flattened: the block needs {count} steps in one of the run"
            )
        step = self.dt / count
        kick = float(self.row.kick)
        if kick not in (0.0, step) or count > 1:
            # the impulse of a whole step of the run, in the first of these; of half a step at first
            duration = self.dt
            if not kick:
                duration = 0.5 * self.dt
            whole = duration / (0.5 * (kick + step))
            self.row.outer[:] *= whole
            self.row.drags[:] *= whole
        make_steps(self._step, self.row, count, self.dt)
        self.row.time += self.dt

    @property
    def alone_step(self) -> float:
        """[s] step of a block that nothing touches: all of what its bricks bear at rest."""
        return CFL * self.backing.longest_step

    def advance_alone(self, duration: float) -> int:
        """Move a block that nothing touches any more in its own longer steps, by about `duration`
        [s]; return their number.

        What the springs of the contacts held is lost, and booked as damped (`energies`).

        Raises
        ------
        UnstableError : as `advance`
        """
        self.dt = self.alone_step
        self.row.nose_spring_energy = 0.0
        self.row.point_spring_energy = 0.0
        # the first of these steps looks at what the bricks bear, and the first of the next call too
        self.row.steps += -int(self.row.steps) % CHECK_INTERVAL
        count = CHECK_INTERVAL * max(1, round(duration / self.dt / CHECK_INTERVAL))
        for _ in range(count):
            self.advance()
        return count

    def _step(self, row, dt, left):
        kick = float(row.kick)
        kernels.forces(row, kick)
        inside_out = np.isnan(row.elastic_energy)
        if inside_out.any():
            raise self._unstable("a brick is turned inside out", int(np.argmax(inside_out)))
        kernels.move(row, 0.5 * (kick + dt), dt)
        row.kick = dt
        row.outer[:] = 0.0
        row.drags[:] = 0.0

    def _unstable(self, what, brick=None):
        """The error of a brick; without one, of that which bears the shortest step."""
        if brick is None:
            brick = int(np.argmin(self._bounds()))
        places = 1e3 * self.x[self.bricks[brick]].mean(axis=0)
        where = "the block's brick at ({:.3g}, {:.3g}, {:.3g}) mm".format(*places)
        return UnstableError(what, where=where, when=f"after {1e6 * float(self.row.time):.4g} us")

    def stable_step(self) -> float:
        """Compute the bound [s] of the step for the bricks as they are now: 1 / (c (2 sum |grad
        N_a|^2)^(1/2)), the sum over the corners of a brick with the gradients where it is, which is
        `Backing.longest_step` at rest (Flanagan and Belytschko 1981), and less for viscosity."""
        damped = np.sqrt(1 + self.backing.viscosity**2) - self.backing.viscosity
        return float(damped / self.backing.material.wave_speed * self._bounds().min())

    def _bounds(self):
        """(m,) [m] step of each brick times the speed of its waves; infinite of those that are
        gone."""
        f, g, h = np.moveaxis(
            sums.multiply(self.x[self.bricks].transpose(0, 2, 1), self.row.gradient), 1, 0
        )  # rows of F
        cofactors = np.stack([np.cross(g, h), np.cross(h, f), np.cross(f, g)], axis=1)
        with np.errstate(all="ignore"):
            outer = sums.multiply(cofactors, self.row.gradient.transpose(0, 2, 1))
            gradient = outer / np.sum(f * cofactors[:, 0], axis=1)[:, None, None]
            return np.where(self.gone, np.inf, 1 / np.sqrt(2 * np.sum(gradient**2, axis=(1, 2))))

    def energies(self) -> dict:
        """Return the ENERGIES [J] of the modelled part, at the last forces; "damped" is the work
        that contacts have taken and no spring stores: what damping takes, and what springs held
        that their face has left."""
        row = self.row
        held = row.nose_spring_energy + row.point_spring_energy
        values = (
            row.kinetic_energy.sum(),
            row.elastic_energy.sum(),
            row.plastic_work.sum(),
            row.hourglass_energy.sum() + row.corner_energy.sum(),
            row.viscous_work.sum(),
            row.dashpot_work.sum(),
            row.lost_by_erosion.sum(),
            held,
            row.taken + (row.contact_work - row.contact_work_ahead).sum() - held,
        )
        return dict(zip(ENERGIES, map(float, values)))

    @property
    def momentum(self) -> float:
        """[N s] along z, of the modelled part: what it moves with, half a step back, and what its
        held and absorbing faces have taken. It is the impulse of all contacts so far."""
        return sums.dot(self.mass, self.v[:, 2]) + float(self.row.outer_impulse.sum())

    @property
    def time(self) -> float:
        """[s] since it was at rest."""
        return float(self.row.time)

    @property
    def bricks(self) -> IntArray:
        """(m, 8) nodes of each brick, in VTK's order."""
        return _corners(self.nodes)

    def crater(self, axis: int = 0) -> FloatArray:
        """Return radius and depth (k, 2) [m] of the remaining face, from the axis of the shot along
        x (axis 0) or y."""
        face = self.depth_map()
        middle = [n // 2 for n in self.shape[:2]]
        for along, mirrored in enumerate(self.backing.mirrors):
            if mirrored:
                middle[along] = 0
        i, j = middle
        if axis == 0:
            return face[i:, j][:, [axis, 2]]
        return face[i, j:][:, [axis, 2]]

    def depth_map(self) -> FloatArray:
        """Return x, y and depth (nx + 1, ny + 1, 3) [m] of the nodes of the remaining face.

        The depth at a node is that of the first brick beside it below all that are gone, from where
        the face was.
        """
        gone = self.gone.reshape(self.shape)
        nz = self.shape[2]
        layers = np.where(gone.any(axis=2), nz - np.argmax(gone[:, :, ::-1], axis=2), 0)
        wide = np.pad(layers, 1, mode="edge")
        beside = np.minimum(
            np.minimum(wide[1:, 1:], wide[:-1, 1:]), np.minimum(wide[1:, :-1], wide[:-1, :-1])
        )
        face = self.x[np.take_along_axis(self.nodes, beside[..., None], axis=2)[..., 0]].copy()
        face[..., 2] -= self.backing.standoff
        return face


def _corners(grid):
    """(m, 8) nodes of the bricks of a grid, the last index fastest."""
    a = slice(None, -1)
    b = slice(1, None)
    parts = [(a, a, a), (b, a, a), (b, b, a), (a, b, a), (a, a, b), (b, a, b), (b, b, b), (a, b, b)]
    return np.stack([grid[part] for part in parts], axis=-1).reshape(-1, 8)
