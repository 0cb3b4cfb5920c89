"""Coupling of the backing block to the last ply and to the projectile.

After every step of the fabric the block takes its contacts at the same instant and then its own step,
so that it is one step ahead; what the contacts give waits in state.f_block_cloth and f_block_nose for
the fabric's next step (`loop.ply_kernels.apply_backing_impulse`).

The fabric bears at p x p points of each element, half of the ply's thickness from the face, with the
penalty and damping of the point's own mass. Points of eroded elements and of fabric in the clamp do
not touch; where single yarns have failed the rest bears whole. The block lies along the sides of the
opening, whatever the angle of the last ply. It goes on alone once the pack has left it
(`BackingCoupling`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from math import nan, prod
from typing import Any

import numba
import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from shellfabric.block import contact_kernels as touch
from shellfabric.block import dent
from shellfabric.block.block import ENERGIES, Backing, Block
from shellfabric.block.state import HandOver
from shellfabric.jit.table import Row
from shellfabric.parts import Part
from shellfabric.projectile.frames import axes, turned_back
from shellfabric.state import ERODED

FLOOR = 0.5  # share of the depth of a dent from which on its face is the floor
APART = 10  # samples in a row at which the ply has to have moved away from the floor
FAR = 0.05  # of the depth of the dent, that it must have moved away by
LIGHT = 0.05  # of the largest force on the face so far, that may be left out on the rim
NAMES = tuple(f"backing_{name}" for name in ENERGIES)  # of the energies in the audit of a run


@dataclass(frozen=True)
class BackingResult:
    """The block at the end of a run, as the part that is modelled.

    Parameters
    ----------
    face : [m] where the face stood
    crater : (k, 2) [m] radius and depth of the remaining face, along the first side of the opening:
        the warp of a ply at no angle
    crater_weft : (k, 2) [m] the same along the second side
    depth_map : (nx + 1, ny + 1, 3) [m] x, y and depth of the nodes of the remaining face
    nodes, bricks : (n, 3) [m], (m, 8) in VTK's order
    plastic : (m,) effective plastic strain
    gone : (m,) bool, eroded
    share : [-] part of the block that is modelled
    gauge_depth : [m] that a gauge finds at the end, in motion or at rest (`dent.gauge`)
    time, dent : (n,) [s], [m] of the samples of the run, and the depth at each that a gauge finds
        (`dent.gauge`)
    at_rest : whether the block rests at the end (`dent.at_rest`): only then has it a signature
    alone_from : [s] at which the block went on alone, behind a pack that had left the dent's floor;
        NaN where it did not
    """

    face: float
    crater: np.ndarray
    crater_weft: np.ndarray
    depth_map: np.ndarray
    nodes: np.ndarray
    bricks: np.ndarray
    plastic: np.ndarray
    gone: np.ndarray
    share: float = 0.25
    gauge_depth: float = 0.0
    time: np.ndarray = field(default_factory=lambda: np.zeros(1))
    dent: np.ndarray = field(default_factory=lambda: np.zeros(1))
    at_rest: bool = False
    alone_from: float = nan

    @property
    def depth(self) -> float:
        """[m] of the crater."""
        return float(self.crater[:, 1].max())

    @property
    def deepest_point(self) -> float:
        """[m] depth of the deepest node of the face at the end, wherever it is, in motion or at
        rest, which is no measurement."""
        return dent.deepest(self.depth_map)

    @property
    def back_face_signature(self) -> float | None:
        """[m] depth that a gauge finds in a block at rest, which is what is measured in clay after a
        shot; None while it moves."""
        return self.gauge_depth if self.at_rest else None

    @property
    def deepest_dent(self) -> float:
        """[m] deepest that the dent has been, at any sample: what is seen in clear gel."""
        return float(self.dent.max())

    @property
    def deepest_dent_time(self) -> float:
        """[s] of that sample."""
        return float(self.time[np.argmax(self.dent)])

    @property
    def springback(self) -> float:
        """[-] share of its greatest depth by which the dent has fallen at the end; 0 without one."""
        if self.deepest_dent <= 0:
            return 0.0
        return 1 - self.gauge_depth / self.deepest_dent

    @property
    def volume(self) -> float:
        """[m3] of the whole dent, below where the face was; see `dent_volume`."""
        return dent_volume(self.depth_map) / self.share

    @property
    def steepness(self) -> float:
        """[rad] angle of the crater's wall against the face, as a mean along both yarns; see
        `wall_angle`."""
        return 0.5 * (wall_angle(self.crater) + wall_angle(self.crater_weft))

    @property
    def half_width(self) -> float:
        """[m] radius at which the crater is half as deep as it is, as a mean along both yarns."""
        return 0.5 * (radius_at(self.crater, 0.5) + radius_at(self.crater_weft, 0.5))


def result_of(
    block: Block,
    time: FloatArray | None = None,
    depth: FloatArray | None = None,
    alone_from: float = nan,
    gauge_radius: float = dent.GAUGE,
) -> BackingResult:
    """Return the result of a block as it is.

    Parameters
    ----------
    time, depth : (n,) [s], [m] when its dent was looked at, and how deep a gauge found it; None
        where nobody has looked: whether such a block rests is not known
    alone_from : of BackingResult
    gauge_radius : [m] of the gauge's disc
    """
    face = block.depth_map()
    gauged = dent.gauge(face, block.backing.mirrors, gauge_radius)
    if time is None or depth is None:
        time, depth = np.array([block.time]), np.array([gauged])
    found = BackingResult(
        block.backing.standoff,
        block.crater(0),
        block.crater(1),
        face,
        block.x.copy(),
        block.bricks,
        block.alpha.copy(),
        block.gone.copy(),
        0.5 ** sum(block.backing.mirrors),
        gauged,
        time,
        depth,
        alone_from=alone_from,
    )
    window = found.half_width / block.backing.material.shear_speed
    motion = dent.motion_about(block, found.half_width)
    return replace(found, at_rest=dent.at_rest(motion, time, depth, window))


def radius_at(crater: FloatArray, share: float) -> float:
    """Find the outermost radius [m] at which a crater (k, 2) is as deep as a share of its depth."""
    r, z = crater[np.argsort(crater[:, 0])].T
    level = share * z.max()
    k = int(np.flatnonzero(z >= level)[-1])
    return float(np.interp(-level, -z[k : k + 2], r[k : k + 2]))


def dent_volume(face: FloatArray) -> float:
    """Compute the volume [m3] between the plane of depth 0 and a face (nx, ny, 3) [m] of nodes x,
    y, depth, where it is below the plane.

    The sum over facets of their area seen along z times the mean depth of their corners, what rises
    above counting 0.
    """
    depth = np.maximum(face[..., 2], 0.0)
    across = face[1:, 1:, :2] - face[:-1, :-1, :2]
    along = face[:-1, 1:, :2] - face[1:, :-1, :2]
    area = 0.5 * (across[..., 0] * along[..., 1] - across[..., 1] * along[..., 0])
    mean = 0.25 * (depth[1:, 1:] + depth[:-1, :-1] + depth[:-1, 1:] + depth[1:, :-1])
    return float(np.sum(area * mean))


def wall_angle(crater: FloatArray) -> float:
    """Compute the angle [rad] against the face, of the chord of a crater's wall between a fifth and
    four fifths of its depth."""
    width = radius_at(crater, 0.2) - radius_at(crater, 0.8)
    return float(np.arctan2(0.6 * crater[:, 1].max(), width))


def check(panel: Any) -> None:
    """Refuse a panel that does not go with the block behind it (InputError)."""
    backing = panel.backing
    if backing is None:
        return
    if panel.mirrors[0] != panel.mirrors[1]:
        raise InputError(
            key="symmetry", value=panel.symmetry, allowed="quarter or whole in front of a backing"
        )
    shot = panel.shot.seen_from(-panel.weave_angle)
    if shot.roaming or shot.tilted:
        raise InputError(
            key="obliquity", value=shot.obliquity, allowed="0, and no yaw or roll, before a backing"
        )
    if any(
        side < a + 2 * abs(x) for side, a, x in zip(backing.size, panel.opening, panel.impact_point)
    ):
        allowed = "a face that reaches as far from the impact point as the panel's opening"
        raise InputError(key="size", value=backing.size, allowed=allowed)


class BackingCoupling(Part):
    """The block of a run, coupled to its last ply: a part that steps in Python.

    A dent goes on after the pack has left its floor, for ten times as long. From there the block
    moves by itself, in its own longer steps, and the pack stays as it is. The pack has left when
    the projectile has turned back, nothing touches the floor, which is the face at more than half
    of the depth, and the least distance of the ply from it has grown at ten samples in a row, to a
    twentieth of the depth at least. That a free ply still touches the rim, with a twentieth of the
    largest force so far at most, is then left out; the floor must not come back to the ply. A ply
    that is held keeps down the rim, and has left only if nothing touches the face anywhere. Behind
    15 plies the dent came to 38.7 mm so, and with the pack to 38.5 mm.

    Parameters
    ----------
    backing : Backing; its standoff is from the back of the last ply at rest
    panel : Panel
    const : its Constants

    Attributes
    ----------
    block : block.Block, one step ahead of the fabric
    gauge_radius : [m] of the disc that gauges its dent
    threads : most that share its bricks, of the panel's numerics, or None

    Raises
    ------
    InputError : a step that is too long for the block
    """

    name = "block"
    of_ply = False
    ply = -1
    steps_in_python = True
    goes_on = True
    meets_nose = True
    contacts: Mapping[str, str] = {"backing_damped": "the contact with the block"}

    def __init__(self, backing: Backing, panel: Any, const: Any) -> None:
        self.backing = backing
        self.projectile = panel.shot.seen_from(-panel.weave_angle)
        self.shape = self.projectile.nose
        self.gauge_radius = dent.disc_radius(self.projectile.radius)
        self.const = const
        self.threads = panel.numerics.threads
        self.p = backing.points
        self._turn = self._turned_back = None
        if panel.weave_angle:
            self._turn = axes(panel.weave_angle)
            self._turned_back = self._turn.T
        self.thickness = 0.5 * panel.weave.thickness
        standoff = self.thickness + backing.standoff
        self.block = replace(backing, standoff=standoff, mirrors=panel.mirrors).block(const.dt)
        areas = np.full((const.ni, const.nj), const.dx * const.dy)
        if panel.sides is not None:
            areas = np.multiply.outer(*panel.sides)
        areas = areas * panel.movable()
        point = np.repeat(panel.contact_density * areas.ravel() / self.p**2, self.p**2)
        self._stiffness = backing.ply_penalty * point / const.dt**2
        self._damping = 2 * backing.contact_damping * backing.ply_penalty**0.5 * point / const.dt
        self._loose = np.ones(point.size)
        self._free = all(side == "free" for pair in panel.supports for side in pair)
        self.hand_over = HandOver(**HandOver.totals())
        flat = np.zeros((const.ni + 1, const.nj + 1))
        self._rest = np.array([*panel.coordinates(), flat]).reshape(3, -1)
        self._none = np.zeros_like(self._rest)
        along = (np.arange(self.p) + 0.5) / self.p
        # (p p, 4) of the corners (0, 0), (1, 0), (0, 1), (1, 1) of an element
        self._weights = np.array(
            [((1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t) for s in along for t in along]
        )

    def join(self, parts: Iterable[Part]) -> None:
        """Find the nose of a projectile that deforms, see Part."""
        for part in parts:
            if part.nose_of_block is not None:
                self.shape = part.nose_of_block

    def begin(self, state: Any, const: Any, stack: Any) -> None:
        """Let the block take the step that it is ahead, see Part."""
        stack.after_stop = self.backing.after_stop
        self.step(state)

    def step(self, state: Any) -> None:
        """Move the block by one step under its contacts with fabric and projectile; store the
        contact forces [N] in state.f_block_cloth and state.f_block_nose."""
        with self._own_threads():
            self._step(state)

    @contextmanager
    def _own_threads(self):
        """The kernels of the block use as many threads as the panel has, in this thread of
        Python."""
        others = numba.get_num_threads()
        numba.set_num_threads(min(self.threads or others, others))
        try:
            yield
        finally:
            numba.set_num_threads(others)

    def has_left(self, state: Any) -> bool:
        """Tell whether the pack has left the floor of the dent for good, see Part; looks at a sample
        whether it is further away than at the last."""
        points = self.block.points
        assert points is not None  # they are made in the first step
        floor = self._on_floor()
        gap = float((-points.inside[floor]).min(initial=np.inf))
        depth = dent.deepest(self.block.depth_map())
        # a pack that is held may press on the rim for good, and keep down a dent that springs back
        seen = floor if self._free else np.ones_like(floor)
        touched = bool(points.force[seen].any() or self.block.row.nose_force.any())
        hand_over = self.hand_over
        if gap > hand_over.gap and not touched:
            hand_over.growing += 1
        else:
            hand_over.growing = 0
        hand_over.gap = gap
        light = hand_over.rim_force <= LIGHT * hand_over.peak_force
        if hand_over.growing < APART or not gap > FAR * depth or not light:
            return False
        below = points.x[floor, 2] + self.thickness - self.block.backing.standoff
        hand_over.deepest_ply = float(below.max(initial=0.0))
        return True

    def _on_floor(self):
        """(s,) bool, whether each point is over the floor of the dent."""
        depth = self.block.depth_map()[..., 2]
        of_facet = 0.25 * (depth[1:, 1:] + depth[:-1, 1:] + depth[1:, :-1] + depth[:-1, :-1])
        return (of_facet >= FLOOR * depth.max())[tuple(self.block.points.columns.T)]

    def go_on(self, duration: float) -> float:
        """Move the block alone, see Part."""
        with self._own_threads():
            return self.block.advance_alone(duration) * self.block.alone_step

    def _step(self, state):
        const = self.const
        block = self.block
        position, velocity = (
            turned_back(of, self._turn)
            for of in (state.projectile_position, state.projectile_velocity)
        )
        state.f_block_nose[:] = turned_back(
            block.strike(position, velocity, self.projectile, self.shape), self._turned_back
        )
        if state.failures > 0:  # yarns have failed
            eroded = (self._nodal(state.element_flag)[:-1, :-1] & ERODED) != 0
            self._loose[:] = np.repeat(~eroded, self.p**2)
        places, speeds = np.empty((2, self._loose.size, 3))
        touch.at_points(state.u, self._rest, self._weights, const.nj, places)
        touch.at_points(state.v, self._none, self._weights, const.nj, speeds)
        places, speeds = (turned_back(part, self._turn) for part in (places, speeds))
        forces = block.press(
            places,
            speeds,
            self._loose * self._stiffness,
            damping=self._loose * self._damping,
            thickness=self.thickness,
        )
        self._spread(turned_back(forces, self._turned_back), state)
        block.advance()

    def _nodal(self, values):
        """(ni+1, nj+1) view of an array of the state."""
        const = self.const
        return values[: (const.ni + 1) * const.row_stride].reshape(const.ni + 1, const.row_stride)

    def _spread(self, forces, state):
        """Forces (s, 3) at points to the nodes, each by its weights; none across planes of
        symmetry."""
        touched = np.flatnonzero(forces.reshape(self.const.ni, -1).any(axis=1))
        if touched.size:  # where nothing has moved yet, nothing is worked on
            state.first_row = min(state.first_row, max(touched[0] - 1, 0))
            state.end_row = max(state.end_row, min(touched[-1] + 2, self.const.ni))
        touch.to_nodes(forces, self._weights, self.const.nj, state.f_block_cloth)
        if self.const.mirror_x:
            self._nodal(state.f_block_cloth[0])[0] = 0.0
        if self.const.mirror_y:
            self._nodal(state.f_block_cloth[1])[:, 0] = 0.0

    def face(self) -> FloatArray:
        """Return the nodes (nx + 1, ny + 1, 3) [m] of the remaining face of the block as it is, in
        the frame of the last ply."""
        face = self.block.depth_map()
        face[..., 2] += self.block.backing.standoff
        return turned_back(face, self._turned_back)

    def rows(self) -> dict[str, Row]:
        """Return the rows of block and points, see Part."""
        assert self.block.points is not None  # they are made in the first step
        return {"row": self.block.row, "points": self.block.points, "hand over": self.hand_over}

    def samples(self) -> dict[str, float]:
        """Return the depth [m] of the dent that a gauge finds, the motion [m] beside held faces, and
        how far [m] a node is across a plane of symmetry, see Part; keeps the force on the face."""
        hand_over = self.hand_over
        if self.block.points is not None:
            hand_over.rim_force = float(np.abs(self.block.points.force[:, 2]).sum())
        hand_over.peak_force = max(float(hand_over.peak_force), float(hand_over.rim_force))
        return {
            "dent": dent.gauge(
                self.block.depth_map(), self.block.backing.mirrors, self.gauge_radius
            ),
            "held_motion": dent.held_motion(self.block),
            "crossing": dent.crossing(self.block),
        }

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the block, see Part."""
        return self.name, self.backing

    def energies(self) -> dict[str, float]:
        """Return {name: [J]} of NAMES, of the modelled part."""
        return dict(zip(NAMES, self.block.energies().values()))


def bricks_of(panel: Any) -> int:
    """Return the number of bricks of the block behind a panel; 0 without one."""
    if panel.backing is None:
        return 0
    return prod(panel.backing.count)


def make_blocks(pack: Any, consts: Any, velocity: float) -> tuple[Part, ...]:
    """Make the block behind the last ply of a pack that stands before one."""
    backing = pack.plies[0].backing
    if backing is None:
        return ()
    return (BackingCoupling(backing, pack.plies[-1], consts[-1]),)
