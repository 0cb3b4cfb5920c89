"""A panel whose yarns slide through its crossovers: friction, masses, time step and arrays of the slip.

Time step. A yarn that slides freely carries waves at c = sqrt(E / rho), not at c / sqrt 2 as one that drags its
crossing yarns with it: the bound of the pinned panel times sqrt(m1 / (m1 + m2)), with the lighter family's mass m1, at
the damping ratio that the viscosity of the yarn has against that mass alone.

Lateral contact. Two neighbouring yarns cannot come closer than in a jammed weave: sqrt 3 diameters of round yarns
between which the crossing yarn passes (Peirce's jammed square weave). The diameter is that of fibres in hexagonal
packing. The stiffness is EA over the spacing. A segment between yarns that touch holds at least as much yarn as
reaches from one to the other, and gives none beyond that.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from math import inf, isinf, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.base.errors import InputError
from shellfabric.cell import coefficients
from shellfabric.jit.aligned import aligned_zeros
from shellfabric.panel import boundary
from shellfabric.panel.model import Panel
from shellfabric.sliding import contact_force
from shellfabric.sliding.flow_kernels import PULLED_OUT
from shellfabric.state import Slip, State

DATA = tomllib.loads(
    (Path(__file__).parent / "friction.toml").read_text("utf-8")
)  # values, ranges, sources, status
HEXAGONAL = pi / sqrt(12)  # densest packing of round fibres
LEAST = 0.9  # of the closest distance: yarn between two neighbours that touch, stretched and pressed together
MOST_CLOSEST = 0.9  # of the spacing: fabric at rest is not in lateral contact
WINDOWING_FRICTION = DATA["windowing_friction"][
    "value"
]  # below it a nose may pass between the yarns of one ply


@dataclass(frozen=True)
class CrossoverFriction:
    """Threshold of slip at a crossover, Tf = c0 + mu F_c.

    Parameters
    ----------
    mu : [-] coefficient of friction of yarn on yarn; inf pins all crossovers. The default, with its range and source,
        is that of friction.toml, as the next
    cohesion : [N] c0, threshold without contact force; inf pins all crossovers
    bending : (warp, weft) [N m2] bending stiffness of the yarns, with which F_c is computed (`contact_force`); 0 for
        that of flexible yarns, which is none where one of them has no tension

    Raises
    ------
    InputError : a value below 0
    """

    mu: float = DATA["crossover_friction"]["value"]
    cohesion: float = DATA["crossover_cohesion"]["value"]
    bending: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self):
        for key in ("mu", "cohesion"):
            if not getattr(self, key) >= 0:
                name = f"crossover_{'friction' if key == 'mu' else key}"
                raise InputError(key=name, value=getattr(self, key), allowed="at least 0")
        if len(self.bending) != 2 or not all(0 <= B < inf for B in self.bending):
            raise InputError(
                key="bending", value=self.bending, allowed="two stiffnesses of at least 0"
            )

    @property
    def pins(self) -> bool:
        """Whether no yarn can slip."""
        return isinf(self.mu) or isinf(self.cohesion)


@dataclass(frozen=True)
class SlidingPanel(Panel):
    """A Panel whose yarns slide through its crossovers: a grid line a yarn, a crossover in the middle of the opening.

    Parameters
    ----------
    friction : CrossoverFriction, and the others of Panel

    Raises
    ------
    InputError : as Panel; and several elements a crossover, grading, an oblique weave, a prescribed pull-in, bending,
        a block, or a cell without contact force or energy
    """

    friction: CrossoverFriction = field(default_factory=CrossoverFriction)

    def __post_init__(self):
        super().__post_init__()
        words = "with sliding crossovers"
        led = any(
            isinstance(side, boundary.PullIn)
            for pair in boundary.sides(self.boundary)
            for side in pair
        )
        for key, value, met, allowed in (
            (
                "elements_per_crossover",
                self.elements_per_crossover,
                self.elements_per_crossover == 1,
                "1",
            ),
            ("grading", self.grading, self.grading is None, "left out"),
            ("weave_angle", self.weave_angle, self.weave_angle == 0, "0"),
            ("opening_shape", "round", not self.round, "rectangular"),
            ("boundary", self.boundary, not led, "clamped, free or gripped"),
            ("bending", self.bending, not any(self.bending), "0"),
            ("backing", "a block", self.backing is None, "left out"),
            (
                "cell_formulation",
                self.table.model.cell_formulation,
                self.table.model.cell_formulation == "variational",
                "variational",
            ),
            ("surface", "a response surface", "F" in self.table.values, "left out"),
        ):
            if not met:
                raise InputError(key=key, value=value, allowed=f"{allowed} {words}")

    @property
    def grid_middle(self) -> tuple[float, float]:
        """[m] as of Panel: the grid stays in the middle of the opening, wherever it is struck, so that a shot need not
        hit a crossover."""
        return 0.0, 0.0

    @property
    def _fills(self):
        """As of Panel; no, a line of the grid is one yarn, at the spacing of the weave."""
        return False

    @property
    def own_masses(self) -> tuple[float, float]:
        """(warp, weft) [-] share of each family in the mass of a node."""
        warp, weft = (yarn.linear_density * S0 for yarn, S0 in zip(self.weave.yarns, self.weave.S0))
        return warp / (warp + weft), weft / (warp + weft)

    @property
    def time_step(self) -> float:
        """[s] the step that is taken: that of the pinned panel times what the free yarn leaves of it."""
        if self.friction.pins:
            return super().time_step
        share, xi = min(self.own_masses), self.numerics.stretch_viscosity
        free = xi / sqrt(share)
        damped = (sqrt(1 + free**2) - free) / (sqrt(1 + xi**2) - xi)
        return super().time_step * sqrt(share) * damped

    @property
    def closest(self) -> float:
        """[-] share of the spacing below which neighbouring yarns touch."""
        across = zip(self.weave.w, self.weave.yarns[::-1])  # the yarns that cross lie side by side
        jammed = (sqrt(3) * sqrt(4 * yarn.A_s / (pi * HEXAGONAL)) / (2 * w) for w, yarn in across)
        return min(*jammed, MOST_CLOSEST)

    def rim(self) -> tuple[IntArray, IntArray, FloatArray]:
        """As Panel; none where yarns slip through the nodes of a gripped side, which do not move."""
        nodes, axes, values = super().rim()
        return (nodes, axes, values) if self.friction.pins else (nodes[:0], axes[:0], values[:0])

    def grips(self) -> tuple[FloatArray, FloatArray]:
        """(warp, weft) each (ni+1, nj+1) [N]: what the clamps of gripped sides hold the yarn at a node with; 0 where
        there is none."""
        found = np.zeros((2, *self.masses().shape))
        for node, axis, (*_, force, _) in zip(*super().rim()):
            found[axis].flat[node] = 0.0 if self.friction.pins else force
        return found[0], found[1]

    def mobile(self) -> tuple[Any, Any]:
        """(warp, weft) each (ni+1, nj+1) bool: nodes through which a yarn may slip: not in a clamp that does not let it
        slip, nor across a plane of symmetry."""
        loose = boundary.loose(self)
        warp, weft = (loose | (grip > 0) for grip in self.grips())
        if self.mirrors[0]:
            warp[0] = False
        if self.mirrors[1]:
            weft[:, 0] = False
        return warp, weft

    def slip(self, state: State) -> Slip:
        """Arrays of the slip for a State at rest, whose inverse masses say which nodes are held."""
        slots, s = state.mass.size, self.counts[1] + 1
        ones = aligned_zeros(4, slots)
        for each in ones:
            each[:] = 1.0
        mass, pull, mobility, coupling = self._node_constants(state, slots)
        pins = self.friction.pins
        mu, cohesion = (
            (0.0, 0.0) if pins else (float(self.friction.mu), float(self.friction.cohesion))
        )
        part = aligned_zeros(1, slots)[0]
        part[:] = state.mass / (self.weave.areal_density * self.spacing[0] * self.spacing[1])
        grip = aligned_zeros(1, slots)[0]
        for force in self.grips():
            grip[: force.size] += force.ravel()
        tails = aligned_zeros(4, slots + 2 * s)
        for each in tails:
            each[:] = 0.5
        for (near, far), step, force in zip((tails[:2], tails[2:]), (s, 1), self.grips()):
            nodes = np.flatnonzero(force)
            near[nodes + s] = far[nodes - step + s] = inf  # yarn in the clamp
            part[nodes] = 0.0
        zeros, stretches = aligned_zeros(14, slots), aligned_zeros(2, slots)
        for mine, stretch in zip(stretches, state.stretch):
            mine[:] = stretch
        removed = tuple(np.zeros(slots, np.uint8) for _ in range(2))
        counter = np.array(
            [0, 0, any("free" in pair for pair in boundary.sides(self.boundary))], np.int64
        )
        return Slip(
            active=not pins,
            cohesion=cohesion,
            mu=mu,
            table=coefficients.bilinear(
                contact_force.stiff_table(self.table, self.friction.bending)
            ).reshape(-1, 4),
            lateral=0.0 if pins else self.closest**2 * min(yarn.EA for yarn in self.weave.yarns),
            closest=self.closest,
            least=LEAST * self.closest,
            share=ones[:2],
            inv_share=ones[2:],
            x=stretches,
            config=zeros[0:2],
            q=zeros[2:4],
            q_before=zeros[4:6],
            friction=zeros[6:8],
            stop=zeros[8:10],
            residual=zeros[10:12],
            mass=mass,
            pull=pull,
            mobility=mobility,
            coupling=coupling,
            part=part,
            grip=grip,
            row_slips=np.zeros(self.counts[0] + 2, np.bool_),
            tail=(tails[:2], tails[2:]),
            removed=removed,
            passed=zeros[12:14],
            counter=counter,
            work=np.zeros(3),
        )

    def _node_constants(self, state, slots):
        """Of each family: mass of its yarn, that over the node's free mass, 1 / reduced mass; and m1 m2 / m."""
        mass, pull, mobility = (
            aligned_zeros(2, slots),
            aligned_zeros(2, slots),
            aligned_zeros(2, slots),
        )
        size = (self.counts[0] + 1) * (self.counts[1] + 1)
        for family, (share, mobile) in enumerate(zip(self.own_masses, self.mobile())):
            mass[family][:] = share * state.mass
            pull[family][:] = mass[family] * state.inverse_mass
            reduced = (mass[family] * (1 - pull[family]))[:size]
            mobility[family][:size] = np.where(mobile.ravel(), 1.0, 0.0) / np.where(
                reduced > 0, reduced, inf
            )
        coupling = aligned_zeros(1, slots)[0]
        coupling[:] = mass[0] * mass[1] * state.inverse_mass
        return mass, pull, mobility, coupling


@dataclass(frozen=True)
class SlipSummary:
    """What the slip of a run came to.

    Parameters
    ----------
    pulled_out_length : [m] longest length of yarn that has passed through a crossover
    largest_window : [m] widest distance between neighbouring yarns at the end, along whole segments
    pulled_out_segments : segments whose yarn end has left a crossover, without failure, of the modelled part
    friction_work : [J] work of friction at the crossovers, of the whole panel
    """

    pulled_out_length: float
    largest_window: float
    pulled_out_segments: int
    friction_work: float

    @classmethod
    def of(cls, panel: Panel, state: Any, slip: Slip, share: float) -> SlipSummary:
        """The summary of a ply, of which the part `share` is modelled."""
        windows = [0.0]
        for stretch, intact, side in zip(state.stretch, state.intact_fraction, panel.spacing):
            whole = grid(intact, panel) > 0
            if whole.any():
                windows.append(float(side * grid(stretch, panel)[whole].max()))
        return cls(
            pulled_out_length=float(max(np.abs(passed).max() for passed in slip.passed)),
            largest_window=max(windows),
            pulled_out_segments=int(slip.counter[PULLED_OUT]),
            friction_work=float(slip.work[0]) / share,
        )


def grid(array: FloatArray, panel: Panel) -> FloatArray:
    """(ni+1, nj+1) view of an array of slots."""
    shape = panel.counts[0] + 1, panel.counts[1] + 1
    return array[: shape[0] * shape[1]].reshape(shape)
