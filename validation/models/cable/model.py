"""The pin-jointed cable model of a fabric: the oldest of the discrete models, and the shell's decoupled limit.

Source thesis section 4.4.2: masses at the crossovers, joined along warp and weft by bars that carry tension only. Warp
and weft share their nodes and nothing else: no crimp exchange, no compression of the yarns, no shear stiffness. Bars of
natural length S0 whose nodes are L apart have

    e = max(L - S0, 0),   T = k e,   k = EA / S0     (crimp is slack, S0 > L at rest; erratum E-18: strain beyond crimp)

and pull with T and, while taut, with a viscous force on their rate; never less than nothing in all. A bar fails where e
passes its limit, at once and for good. Time goes by central differences, forces standing at whole steps:

    v(n+1/2) = v(n-1/2) + dt f(n) / m,    u(n+1) = u(n) + dt v(n+1/2),    f(n+1) from u(n+1) and L(n+1) - L(n)

Time step. No direction of a node sees more than both families, so that the highest frequency of the net obeys
w^2 <= 4 (k1 + k2) / M, with M the mass of the two yarns in a cell, however the net folds. Along a flat yarn the wave
runs at 2 w1 sqrt(k1 / M), which is c / sqrt 2 for equal yarns without crimp (erratum E-38). The viscous force acts on
the change of length of the step before, which limits the step to (2 / w) (sqrt(1 + xi^2) - xi).
"""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Any, TypeAlias

import numpy as np

from fabrics.checks import BoolArray, FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from shellfabric.jit.by_reference import by_reference
from shellfabric.projectile import contact
from shellfabric.projectile.projectile import Projectile

Constants = namedtuple(
    "Constants",
    "ni nj row_stride mirror_x mirror_y x0 y0 dx dy dt S0 EA cv failure_elongation window_limits points_per_side "
    "shape_functions point_law nose_shape nose_parameters projectile_length frame tilted friction erosion_gap_ratio "
    "projectile_radius edge_radius projectile_mass free_dofs clamped_nodes middle_end_nodes",
)
State = namedtuple(
    "State",
    "u v f mass dt_over_mass stretch stiffness intact_fraction element_flag length elongation viscous_force "
    "last_contact_force in_contact friction_state dv_other dv_contact force_scale contact_window f_contact "
    "contact_energy contact_scratch projectile_position projectile_velocity f_contact_nose counter energy_sums "
    "peak_elongation",
)
by_reference(Constants, State)
Pair: TypeAlias = Sequence[float]
# of the contact, as in the shell: ratio to critical damping, points along each bar, and the stretch of the gap left by
# failed bars at which an element of the surface loses contact
CONTACT_DAMPING, CONTACT_POINTS, WIDEST_GAP = 0.5, 8, 3.0


@dataclass(frozen=True)
class CableNumerics:
    """Numerical knobs, set by stability and not by outcome.

    Parameters
    ----------
    cfl : Courant factor, the time step over its stability bound. It could be near one but for crimp: bars that snap
        taut between two steps cost energy, as the square of the step (docs/reports/numerics.md)
    viscosity : damping ratio of the highest mode of the taut net; 0.1, as in the shell
    penalty : stiffness of the contact, in units of the touching mass / dt^2
    """

    cfl: float = 0.4
    viscosity: float = 0.1
    penalty: float = 0.3

    def step(self, frequency: float) -> tuple[float, float]:
        """(dt [s], cv [-]) where the highest frequency is `frequency` [rad/s]; cv as in `cable.step_kernels.pull`.

        Raises
        ------
        InputError : a Courant factor out of 0 .. 1, or a negative viscosity
        """
        if not (0 < self.cfl <= 1 and self.viscosity >= 0):
            raise InputError(key="cfl", value=self.cfl, allowed="above 0 and at most 1, with a viscosity of at least 0")
        xi = self.viscosity
        dt = self.cfl * 2 / frequency * ((1 + xi**2) ** 0.5 - xi)
        return dt, 2 * xi / (frequency * dt)


@dataclass(frozen=True)
class CableNet:
    """A quarter of a rectangle of bars about the impact point, clamped all round, and the projectile before it.

    The middle warp and weft yarns cross at the impact point; of these the quarter has one half.

    Parameters
    ----------
    fabric : Fabric
    opening : (along warp, along weft) [m]; as many whole crossovers as fit, as in `panel.model.Panel`
    projectile : Projectile
    numerics : CableNumerics
    failure : whether bars fail at the yarn's strength

    Raises
    ------
    InputError : an opening smaller than the projectile needs, or a shot that is not axial and flat
    """

    fabric: Fabric
    opening: tuple[float, float] = (0.203, 0.203)
    projectile: Projectile = field(default_factory=Projectile)
    numerics: CableNumerics = field(default_factory=CableNumerics)
    failure: bool = True

    def __post_init__(self):
        shot = self.projectile
        if shot.shape != "flat" or shot.length is not None or shot.tilted or shot.roaming or shot.friction:
            raise InputError("the cable net takes a flat projectile without an end at normal incidence, frictionless")
        for length, w in zip(self.opening, self.fabric.weave.w):
            if not length / 2 >= max(2 * self.projectile.radius, 4 * w):
                raise InputError(key="opening", value=length, allowed="wider than two projectiles and four crossovers")

    @classmethod
    def of(cls, setup: Any, **others: Any) -> CableNet:
        """The net of an `simulation.ImpactSetup`: its fabric, opening and projectile, to compare the two models.

        Raises
        ------
        InputError : an edge that is not clamped
        """
        if setup.edge != "clamped":
            raise InputError(key="edge", value=setup.edge, allowed="clamped, for the cable model")
        return cls(setup.fabric, tuple(np.broadcast_to(setup.opening, 2).tolist()), setup.projectile, **others)

    @property
    def counts(self) -> tuple[int, ...]:
        """(ni, nj) bars along a warp and along a weft yarn."""
        return tuple(int(length / 2 / (2 * w) + 1e-9) for length, w in zip(self.opening, self.fabric.weave.w))

    @property
    def bars(self) -> int:
        """Number of bars."""
        ni, nj = self.counts
        return ni * (nj + 1) + nj * (ni + 1)

    @property
    def stiffness(self) -> tuple[float, ...]:
        """(k1, k2) [N/m] of a bar of warp and weft."""
        return tuple(yarn.EA / S0 for yarn, S0 in zip(self.fabric.weave.yarns, self.fabric.weave.S0))

    def constants(self) -> Constants:
        """What the kernels need to know, as plain numbers and arrays."""
        (ni, nj), weave, knobs, shot = self.counts, self.fabric.weave, self.numerics, self.projectile
        dt, cv = knobs.step(2 * (sum(self.stiffness) / weave.cell_mass) ** 0.5)
        ends = [S0 * yarn.failure_strain if self.failure else inf for S0, yarn in zip(weave.S0, weave.yarns)]
        near = [  # crimp and strain draw bars under the projectile
            min(count, int((shot.radius + (yarn.crimp + yarn.failure_strain) * count * 2 * w + 4 * w) / (2 * w)) + 1)
            for count, w, yarn in zip((ni, nj), weave.w, weave.yarns)
        ]
        slots = np.arange((ni + 1) * (nj + 1)).reshape(ni + 1, nj + 1)
        return constants(
            (ni, nj), tuple(2 * w for w in weave.w), weave.S0, tuple(yarn.EA for yarn in weave.yarns), dt, cv, shot,
            mirror_x=True, mirror_y=True, failure_elongation=tuple(ends), window_limits=(0, near[0], 0, near[1]),
            **contact.constants(CONTACT_POINTS, weave.cell_mass, dt, knobs.penalty, CONTACT_DAMPING),
            erosion_gap_ratio=WIDEST_GAP, projectile_mass=shot.mass / 4, clamped_nodes=slots[_clamped(ni, nj)],
            middle_end_nodes=(int(slots[-1, 0]), int(slots[0, -1])),
        )  # fmt: skip

    def state(self, strike_velocity: float) -> State:
        """The net at rest, flat at z = 0, touched by the projectile that moves along +z at `strike_velocity` [m/s]."""
        ni, nj = self.counts
        share = np.zeros((2, ni + 1, nj + 1))
        share[0, :-1, :] = share[1, :, :-1] = 1.0
        share[0, :, 0] *= 0.5
        share[1, 0, :] *= 0.5
        held = np.repeat(_clamped(ni, nj)[None], 3, axis=0)
        held[0, 0, :] = held[1, :, 0] = True
        weave = self.fabric.weave
        bar_mass = [S0 * yarn.linear_density for S0, yarn in zip(weave.S0, weave.yarns)]
        return at_rest(self.constants(), share, bar_mass, held, strike_velocity)

    def coordinates(self) -> list[FloatArray]:
        """(X, Y) [m] of the nodes at rest, each (ni+1, nj+1); the impact point is the origin."""
        lines = [2 * w * np.arange(n + 1) for w, n in zip(self.fabric.weave.w, self.counts)]
        return np.meshgrid(*lines, indexing="ij")


def _clamped(ni, nj):
    clamped = np.zeros((ni + 1, nj + 1), bool)
    clamped[-1, :] = clamped[:, -1] = True
    return clamped


def constants(
    counts: Pair, spacing: Pair, S0: Pair, EA: Pair, dt: float, cv: float, shot: Projectile, **others: Any
) -> Constants:
    """Constants of a net of counts = (ni, nj) bars, `spacing` apart; `others` by name."""
    given = {
        "ni": counts[0], "nj": counts[1], "row_stride": counts[1] + 1, "x0": 0.0, "y0": 0.0, "dx": spacing[0],
        "dy": spacing[1], "dt": dt, "S0": S0, "EA": EA, "cv": cv, "nose_shape": shot.number,
        "nose_parameters": shot.form, "projectile_length": inf, "frame": shot.frame, "tilted": False, "friction": 0.0,
        "projectile_radius": shot.radius, "edge_radius": shot.edge_radius, "free_dofs": (0.0, 0.0, 1.0),
    }  # fmt: skip
    return Constants(**given, **others)


def at_rest(const: Constants, share: FloatArray, bar_mass: Any, held: BoolArray, speed: float) -> State:
    """Arrays of a net at rest.

    Parameters
    ----------
    share : (2, ni+1, nj+1) [-] of a yarn in the bars along warp and weft from each node
    bar_mass : (2,) [kg] of a whole bar
    held : (3, ni+1, nj+1) bool, components that do not move
    speed : [m/s] of the projectile
    """
    n, s = share[0].size, const.row_stride
    slots = n + s + 8  # loops read one row beyond the last
    half = 0.5 * share.reshape(2, -1) * np.array(bar_mass)[:, None]
    mass = np.zeros(slots)
    mass[:n] += half.sum(axis=0)
    mass[s : n + s] += half[0]
    mass[1 : n + 1] += half[1]
    free = np.zeros((3, slots))
    free[:, :n] = ~held.reshape(3, -1)
    stiff = np.zeros((2, slots))
    stiff[:, :n] = share.reshape(2, -1) * (np.array(const.EA) / const.S0)[:, None]
    return State(
        u=np.zeros((3, slots)), v=np.zeros((3, slots)), f=np.zeros((3, slots)), mass=mass,
        dt_over_mass=np.divide(const.dt * free, mass, out=np.zeros((3, slots)), where=mass > 0),
        stretch=np.zeros((2, 0)), stiffness=stiff, intact_fraction=(stiff > 0).astype(float),
        length=np.repeat(np.array([const.dx, const.dy])[:, None], slots, axis=1), elongation=np.zeros((2, n)),
        viscous_force=np.zeros((2, slots)), element_flag=np.zeros(slots, np.uint8), f_contact=np.zeros((3, slots)),
        contact_energy=np.zeros(5),
        **contact.contact_state(const.window_limits, const.points_per_side, const.shape_functions, 0.0),
        contact_window=np.array(const.window_limits), contact_scratch=contact.scratch(const),
        projectile_position=np.zeros(3), projectile_velocity=np.array([0.0, 0.0, float(speed)]),
        f_contact_nose=np.zeros(3), counter=np.zeros(2, np.int64), energy_sums=np.zeros(4),
        peak_elongation=np.zeros(2),
    )  # fmt: skip


def energies(state: State, const: Constants) -> tuple[float, float, float]:
    """Kinetic energies of cloth and projectile, and the energy stored in the bars [J], at the present whole step.

    The kinetic ones are m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
    """
    cloth = 0.5 * np.sum(state.mass * state.v * (state.v + state.dt_over_mass * state.f))
    stretched = np.maximum(state.length - np.array(const.S0)[:, None], 0.0)
    push = const.dt * np.array(const.free_dofs) * state.f_contact_nose
    shot = 0.5 * state.projectile_velocity @ (const.projectile_mass * state.projectile_velocity + push)
    return float(cloth), float(shot), float(0.5 * np.sum(state.stiffness * stretched**2))
