"""Coupling of the backing block to the last ply and to the projectile.

After every step of the fabric the block takes its contacts with fabric and projectile at the same
instant and then its own step, so that it is one step ahead and its energies are those of the
fabric's instant. What the contacts give to fabric and projectile waits in state.f_block_cloth and
state.f_block_nose for the fabric's next step (`loop.ply_kernels.apply_backing_impulse`).

The fabric bears on the block at p x p points of each element, like on a projectile: x = sum N_i
x_i, with the penalty and damping of the point's own mass. They keep half of the ply's thickness
from the face. Points of eroded elements do not touch, nor those of fabric in the clamp; where
single yarns have failed the rest bears whole. The block lies along the sides of the opening,
whatever the angle of the last ply.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import numba
import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from shellfabric.block import contact_kernels as touch
from shellfabric.block.block import ENERGIES, Backing, Block
from shellfabric.jit.table import Row
from shellfabric.parts import Part
from shellfabric.projectile.frames import axes, turned_back
from shellfabric.state import ERODED

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

    @property
    def depth(self) -> float:
        """[m] of the crater."""
        return float(self.crater[:, 1].max())

    @property
    def back_face_signature(self) -> float:
        """[m] depth of the deepest point of the face, wherever it is; what is measured in clay
        after a shot."""
        return max(float(self.depth_map[..., 2].max()), 0.0)

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


def result_of(block: Block) -> BackingResult:
    """Return the result of a block as it is."""
    return BackingResult(
        block.backing.standoff,
        block.crater(0),
        block.crater(1),
        block.depth_map(),
        block.x.copy(),
        block.bricks,
        block.alpha.copy(),
        block.gone.copy(),
        0.5 ** sum(block.backing.mirrors),
    )


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
    if panel.symmetry == "half":
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

    Parameters
    ----------
    backing : Backing; its standoff is from the back of the last ply at rest
    panel : Panel
    const : its Constants

    Attributes
    ----------
    block : block.Block, one step ahead of the fabric
    threads : most that share its bricks, of the panel's numerics, or None

    Raises
    ------
    InputError : a step that is too long for the block
    """

    name = "block"
    of_ply = False
    ply = -1
    steps_in_python = True
    meets_nose = True
    contacts: Mapping[str, str] = {"backing_damped": "the contact with the block"}

    def __init__(self, backing: Backing, panel: Any, const: Any) -> None:
        self.backing = backing
        self.projectile = panel.shot.seen_from(-panel.weave_angle)
        self.shape = self.projectile.nose
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
        others = numba.get_num_threads()
        # of this thread of Python, for the block's kernels
        numba.set_num_threads(min(self.threads or others, others))
        try:
            self._step(state)
        finally:
            numba.set_num_threads(others)

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

    def rows(self) -> dict[str, Row]:
        """Return the rows of block and points, see Part."""
        assert self.block.points is not None  # they are made in the first step
        return {"row": self.block.row, "points": self.block.points}

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the block, see Part."""
        return self.name, self.backing

    def energies(self) -> dict[str, float]:
        """Return {name: [J]} of NAMES, of the modelled part."""
        return dict(zip(NAMES, self.block.energies().values()))

    def result(self, clock: FloatArray, steps: FloatArray) -> dict[str, Any]:
        """Return the block as it is, see Part."""
        return {"backing": result_of(self.block)}


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
