"""The pin-jointed cable model of a fabric: the oldest of the discrete models, and the shell's decoupled limit.

Source thesis section 4.4.2: masses at the crossovers, joined along warp and weft by bars that carry tension only. Warp
and weft share their nodes and nothing else: no crimp exchange, no compression of the yarns, no shear stiffness. Crimp
is slack that must be pulled out first. The equations stand in `cable.step_kernels`.

Time step. No direction of a node sees more than both families, so that the highest frequency of the net obeys
w^2 <= 4 (k1 + k2) / M, with k = EA / S0 and M the mass of the two yarns in a cell, however the net folds. Along a flat
yarn the wave runs at 2 w1 sqrt(k1 / M), which is c / sqrt 2 for equal yarns without crimp (erratum E-38). The viscous
force acts on the change of length of the step before, which limits the step to (2 / w) (sqrt(1 + xi^2) - xi).
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np

from fabrics.checks import BoolArray, FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from shellfabric.driver.guards import ENERGY_ERROR_LIMIT
from shellfabric.jit.by_reference import by_reference
from shellfabric.panel.model import SYMMETRIES
from shellfabric.projectile import contact
from shellfabric.projectile.projectile import Projectile

Constants = namedtuple(
    "Constants",
    "ni nj row_stride rows_per_block mirror_x mirror_y x0 y0 dx dy dt S0 EA cv failure_elongation window_limits "
    "points_per_side shape_functions point_law nose_shape "
    "nose_parameters projectile_length frame tilted friction erosion_gap_ratio projectile_radius edge_radius "
    "projectile_mass free_dofs perforation_delay_steps clamped_nodes middle_end_nodes middle_yarn_fraction "
    "driven_node",
    defaults=(None,),  # no bending over the nose
)
State = namedtuple(
    "State",
    "u v f mass dt_over_mass stretch stiffness intact_fraction element_flag length viscous_force last_contact_force "
    "in_contact friction_state dv_other dv_contact force_scale contact_window f_contact contact_energy "
    "contact_scratch projectile_position projectile_velocity f_contact_nose active_rows counter energy_sums "
    "peak_elongation",
)
by_reference(Constants, State)


@dataclass(frozen=True)
class CableNumerics:
    """Numerical knobs, set by stability and not by outcome.

    Parameters
    ----------
    cfl : Courant factor, the time step over its stability bound. It could be near one but for crimp: bars that snap
        taut between two steps cost energy, as the square of the step (docs/reports/numerics.md)
    viscosity : damping ratio of the highest mode of the taut net; 0.1, as in the shell
    penalty : stiffness of the contact, in units of the touching mass / dt^2
    contact_damping : ratio to critical of that mass on that spring
    contact_points : along each bar
    widest : stretch of the gap left by failed bars at which an element of the surface loses contact, as in the shell
    clear_time : [s] without a push and with nothing ahead, after which the net counts as perforated
    block : nodes worked on together; their scratch should stay in cache
    energy_error_limit : share of the strike energy that the energy error may reach before the run counts as unstable

    Raises
    ------
    InputError : a value out of its range
    """

    cfl: float = 0.4
    viscosity: float = 0.1
    penalty: float = 0.3
    contact_damping: float = 0.5
    contact_points: int = 8
    widest: float = 3.0
    clear_time: float = 2e-6
    block: int = 2000
    energy_error_limit: float = ENERGY_ERROR_LIMIT

    def __post_init__(self):
        for key in ("cfl", "penalty", "contact_points", "widest", "clear_time", "block", "energy_error_limit"):
            if not getattr(self, key) > 0:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in ("viscosity", "contact_damping"):
            if not getattr(self, key) >= 0:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0")
        if self.cfl > 1:
            raise InputError(key="cfl", value=self.cfl, allowed="at most 1")

    def step(self, frequency: float) -> tuple[float, float]:
        """(dt [s], cv [-]) where the highest frequency is `frequency` [rad/s]; cv as in
        `cable.step_kernels.bar_forces`."""
        xi = self.viscosity
        dt = self.cfl * 2 / frequency * ((1 + xi**2) ** 0.5 - xi)
        return dt, 2 * xi / (frequency * dt)


@dataclass(frozen=True)
class CableNet:
    """A rectangle of bars about the impact point, clamped all round, and the projectile before it.

    The middle warp and weft yarns cross at the impact point; on a plane of symmetry a yarn counts half.

    Parameters
    ----------
    fabric : Fabric
    opening : (along warp, along weft) [m]; as many whole crossovers as fit, as in `panel.model.Panel`
    projectile : Projectile
    symmetry : "quarter", "half" (x >= 0) or "whole"
    numerics : CableNumerics
    failure : whether bars fail at the yarn's strength

    Raises
    ------
    InputError : unknown symmetry, an opening smaller than the projectile needs, or a shot that is not axial and flat
    """

    fabric: Fabric
    opening: tuple[float, float] = (0.203, 0.203)
    projectile: Projectile = field(default_factory=Projectile)
    symmetry: str = "quarter"
    numerics: CableNumerics = field(default_factory=CableNumerics)
    failure: bool = True

    def __post_init__(self):
        if self.symmetry not in SYMMETRIES:
            raise InputError(key="symmetry", value=self.symmetry, allowed=" or ".join(SYMMETRIES))
        shot = self.projectile
        if shot.shape != "flat" or shot.length is not None or shot.tilted or shot.roaming or shot.friction:
            raise InputError("the cable net takes a flat projectile without an end at normal incidence, frictionless")
        for length, w in zip(self.opening, self.fabric.weave.w):
            if not length / 2 >= max(2 * self.projectile.radius, 4 * w):
                raise InputError(key="opening", value=length, allowed="wider than two projectiles and four crossovers")

    @classmethod
    def of(cls, setup: Any, **others: Any) -> CableNet:
        """The net of an `simulation.ImpactSetup`: its fabric, opening, projectile and symmetry, to compare the two
        models.

        Raises
        ------
        InputError : an edge that is not clamped
        """
        if setup.edge != "clamped":
            raise InputError(key="edge", value=setup.edge, allowed="clamped, for the cable model")
        opening = tuple(np.broadcast_to(setup.opening, 2).tolist())
        return cls(setup.fabric, opening, setup.projectile, setup.symmetry, **others)

    @property
    def counts(self) -> tuple[int, ...]:
        """(ni, nj) bars along a warp and along a weft yarn."""
        half = [int(length / 2 / (2 * w) + 1e-9) for length, w in zip(self.opening, self.fabric.weave.w)]
        return tuple(n if mirrored else 2 * n for n, mirrored in zip(half, SYMMETRIES[self.symmetry]))

    @property
    def bars(self) -> int:
        """Number of bars."""
        ni, nj = self.counts
        return ni * (nj + 1) + nj * (ni + 1)

    @property
    def share(self) -> float:
        """Part of the whole net, and of the projectile, that is modelled."""
        return 0.5 ** sum(SYMMETRIES[self.symmetry])

    @property
    def stiffness(self) -> tuple[float, ...]:
        """(k1, k2) [N/m] of a bar of warp and weft."""
        weave = self.fabric.weave
        return tuple(yarn.EA / S0 for yarn, S0 in zip(weave.yarns, weave.S0))

    @property
    def time_step(self) -> float:
        """[s]"""
        return self._step()[0]

    def _step(self):
        return self.numerics.step(2 * (sum(self.stiffness) / self.fabric.weave.cell_mass) ** 0.5)

    def constants(self) -> Constants:
        """What the kernels need to know, as plain numbers and arrays."""
        (ni, nj), mirrors, weave, knobs = self.counts, SYMMETRIES[self.symmetry], self.fabric.weave, self.numerics
        shot, s, spacing, (dt, cv) = self.projectile, nj + 1, tuple(2 * w for w in weave.w), self._step()
        origin = tuple(0.0 if mirrored else -0.5 * n * d for mirrored, n, d in zip(mirrors, (ni, nj), spacing))
        slots = np.arange((ni + 1) * s).reshape(ni + 1, s)
        middle = (int(slots[-1, 0 if mirrors[1] else nj // 2]), int(slots[0 if mirrors[0] else ni // 2, -1]))
        return Constants(
            ni=ni, nj=nj, row_stride=s, rows_per_block=max(1, round(knobs.block / s)), mirror_x=mirrors[0],
            mirror_y=mirrors[1], x0=origin[0], y0=origin[1], dx=spacing[0], dy=spacing[1], dt=dt,
            S0=weave.S0, EA=tuple(yarn.EA for yarn in weave.yarns), cv=cv,
            failure_elongation=tuple(S0 * yarn.failure_strain if self.failure else inf
            for S0, yarn in zip(weave.S0, weave.yarns)), window_limits=self._near(origin),
            **contact.constants(knobs.contact_points, weave.cell_mass, dt, knobs.penalty, knobs.contact_damping),
            nose_shape=shot.number, nose_parameters=shot.form, projectile_length=inf, frame=shot.frame, tilted=False,
            friction=0.0, erosion_gap_ratio=knobs.widest, projectile_radius=shot.radius, edge_radius=shot.edge_radius,
            projectile_mass=shot.mass * self.share,
            free_dofs=(*(0.0 if mirrored else 1.0 for mirrored in mirrors), 1.0),
            perforation_delay_steps=max(1, round(knobs.clear_time / dt)), clamped_nodes=slots[self._clamped()],
            middle_end_nodes=middle,
            middle_yarn_fraction=(0.5 if mirrors[1] else 1.0, 0.5 if mirrors[0] else 1.0), driven_node=0,
        )  # fmt: skip

    def state(self, strike_velocity: float) -> State:
        """The net at rest, flat at z = 0, touched by the projectile that moves along +z at `strike_velocity` [m/s]."""
        const, mirrors = self.constants(), SYMMETRIES[self.symmetry]
        ni, nj = self.counts
        share = np.zeros((2, ni + 1, nj + 1))
        share[0, :-1, :] = share[1, :, :-1] = 1.0
        if mirrors[1]:
            share[0, :, 0] *= 0.5
        if mirrors[0]:
            share[1, 0, :] *= 0.5
        held = np.repeat(self._clamped()[None], 3, axis=0)
        held[0, 0, :] |= mirrors[0]
        held[1, :, 0] |= mirrors[1]
        i0, i1 = const.window_limits[:2]
        bar_mass = [S0 * yarn.linear_density for S0, yarn in zip(self.fabric.weave.S0, self.fabric.weave.yarns)]
        rows = (max(i0 - 1, 0), min(i1 + 1, ni))
        return at_rest(const, share, bar_mass, held, rows, strike_velocity)

    def coordinates(self) -> list[FloatArray]:
        """(X, Y) [m] of the nodes at rest, each (ni+1, nj+1); the impact point is the origin."""
        c = self.constants()
        return np.meshgrid(
            *(o + d * np.arange(n + 1) for o, d, n in zip((c.x0, c.y0), (c.dx, c.dy), self.counts)), indexing="ij"
        )

    def _clamped(self):
        """(ni+1, nj+1) bool: nodes held by the clamps."""
        ni, nj = self.counts
        clamped = np.zeros((ni + 1, nj + 1), bool)
        clamped[-1, :] = clamped[:, -1] = True
        clamped[0, :] |= not SYMMETRIES[self.symmetry][0]
        clamped[:, 0] |= not SYMMETRIES[self.symmetry][1]
        return clamped

    def _near(self, origin):
        """Element rows and columns (i0, i1, j0, j1) that can come under the projectile: crimp and strain draw in."""
        bounds = []
        for start, w, count, yarn in zip(origin, self.fabric.weave.w, self.counts, self.fabric.weave.yarns):
            half = count * 2 * w if start == 0 else -start
            reach = self.projectile.radius + (yarn.crimp + yarn.failure_strain) * half + 4 * w
            bounds += [max(0, int((-reach - start) / (2 * w))), min(count, int((reach - start) / (2 * w)) + 1)]
        return tuple(bounds)


def at_rest(
    const: Constants, share: FloatArray, bar_mass: Sequence[float], held: BoolArray, rows: tuple[int, int],
    speed: float,
) -> State:  # fmt: skip
    """Arrays of a net at rest.

    Parameters
    ----------
    share : (2, ni+1, nj+1) [-] of a yarn in the bars along warp and weft from each node
    bar_mass : (2,) [kg] of a whole bar
    held : (3, ni+1, nj+1) bool, components that do not move
    rows : (first, last) rows of bars that may move at once
    speed : [m/s] of the projectile
    """
    slots = share[0].size + const.row_stride + 8  # loops read one row beyond the last
    mass = np.zeros(share.shape[1:])
    for family in range(2):
        half = 0.5 * bar_mass[family] * share[family]
        mass += half
        mass[tuple(slice(1, None) if axis == family else slice(None) for axis in range(2))] += half[
            tuple(slice(None, -1) if axis == family else slice(None) for axis in range(2))
        ]
    inverse = np.divide(const.dt, mass, out=np.zeros_like(mass), where=mass > 0)
    stiffness = np.array([EA / S0 for EA, S0 in zip(const.EA, const.S0)])

    def flat(array):
        out = np.zeros((*array.shape[:-2], slots))
        out[..., : share[0].size] = array.reshape(*array.shape[:-2], -1)
        return out

    stiff = flat(share * stiffness[:, None, None])
    return State(
        u=np.zeros((3, slots)), v=np.zeros((3, slots)), f=np.zeros((3, slots)), mass=flat(mass),
        dt_over_mass=flat(np.where(held, 0.0, inverse)), stretch=np.zeros((2, 0)), stiffness=stiff,
        intact_fraction=(stiff > 0).astype(float),
        length=np.repeat(np.array([const.dx, const.dy])[:, None], slots, axis=1), viscous_force=np.zeros((2, slots)),
        element_flag=np.zeros(slots, np.uint8), f_contact=np.zeros((3, slots)), contact_energy=np.zeros(5),
        **contact.contact_state(const.window_limits, const.points_per_side, const.shape_functions, 0.0),
        contact_window=np.array(const.window_limits), contact_scratch=contact.scratch(const),
        projectile_position=np.zeros(3), projectile_velocity=np.array([0.0, 0.0, float(speed)]),
        f_contact_nose=np.zeros(3), active_rows=np.array(rows),
        counter=np.zeros(3, np.int64), energy_sums=np.zeros(4), peak_elongation=np.zeros(2),
    )  # fmt: skip
