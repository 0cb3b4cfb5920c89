"""The pin-jointed cable model of a fabric: the oldest of the discrete models, and the shell's decoupled limit.

Source thesis section 4.4.2: masses at the crossovers, joined along warp and weft by bars that carry tension only. Warp
and weft share their nodes and nothing else: no crimp exchange, no compression of the yarns, no shear stiffness. Crimp
is slack that must be pulled out first. The equations stand in `cable_kernels`.

Time step. No direction of a node sees more than both families, so that the highest frequency of the net obeys
w^2 <= 4 (k1 + k2) / M, with k = EA / S0 and M the mass of the two yarns in a cell, however the net folds. Along a flat
yarn the wave runs at 2 w1 sqrt(k1 / M), which is c / sqrt 2 for equal yarns without crimp (erratum E-38). The viscous
force acts on the change of length of the step before, which limits the step to (2 / w) (sqrt(1 + xi^2) - xi).
"""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass, field
from math import ceil, inf
from time import perf_counter

import numpy as np

from fabrics.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from shellfabric import cable_kernels as kernels
from shellfabric.panel import SYMMETRIES
from shellfabric.projectile import Projectile

Constants = namedtuple(
    "Constants",
    "ni nj s block spacing origin dt S0 EA cv limit near point_stiffness point_damping R rho projectile_mass free "
    "idle_steps clamped middle middle_share driven",
)
State = namedtuple(
    "State", "u v g mass kick stiff L drag pressed touching position speed reaction rows counter sums peak"
)
OUTCOMES = {kernels.RUNNING: "in flight", kernels.STOPPED: "stopped", kernels.PERFORATED: "perforated"}


@dataclass(frozen=True)
class CableNumerics:
    """Numerical knobs, set by stability and not by outcome.

    Parameters
    ----------
    safety : of the time step against its bound. It could be near one but for crimp: bars that snap taut between two
        steps cost energy, as the square of the step (S-720 at 100 m/s: 1.7 % at 0.9, 0.45 % at 0.45)
    viscosity : damping ratio of the highest mode of the taut net; 0.1, as in the shell
    penalty : stiffness of the contact, in units of the touching mass / dt^2
    contact_damping : ratio to critical of that mass on that spring
    contact_points : on each bar; 0 takes as many as make their distance the edge radius
    clear_time : [s] without a push and with nothing ahead, after which the net counts as perforated
    block : nodes worked on together; their scratch should stay in cache
    drift_limit : share of the strike energy that the energy balance may reach before the run counts as unstable

    Raises
    ------
    InputError : a value out of its range
    """

    safety: float = 0.4
    viscosity: float = 0.1
    penalty: float = 0.3
    contact_damping: float = 0.5
    contact_points: int = 0
    clear_time: float = 2e-6
    block: int = 2000
    drift_limit: float = 0.05

    def __post_init__(self):
        for key in ("safety", "penalty", "clear_time", "block", "drift_limit"):
            if not getattr(self, key) > 0:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in ("viscosity", "contact_damping", "contact_points"):
            if not getattr(self, key) >= 0:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0")
        if self.safety > 1:
            raise InputError(key="safety", value=self.safety, allowed="at most 1")

    def step(self, frequency):
        """(dt [s], cv [-]) where the highest frequency is `frequency` [rad/s]; cv as in `cable_kernels.pulls`."""
        xi = self.viscosity
        dt = self.safety * 2 / frequency * ((1 + xi**2) ** 0.5 - xi)
        return dt, 2 * xi / (frequency * dt)


@dataclass(frozen=True)
class CableNet:
    """A rectangle of bars about the impact point, clamped all round, and the projectile before it.

    The middle warp and weft yarns cross at the impact point; on a plane of symmetry a yarn counts half.

    Parameters
    ----------
    fabric : Fabric
    opening : (along warp, along weft) [m]; as many whole crossovers as fit, as in `panel.Panel`
    projectile : Projectile
    symmetry : "quarter", "half" (x >= 0) or "whole"
    numerics : CableNumerics
    failure : whether bars fail at the yarn's strength

    Raises
    ------
    InputError : unknown symmetry, or an opening smaller than the projectile needs
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
        for length, w in zip(self.opening, self.fabric.weave.w):
            if not length / 2 >= max(2 * self.projectile.radius, 4 * w):
                raise InputError(key="opening", value=length, allowed="wider than two projectiles and four crossovers")

    @classmethod
    def of(cls, setup, **others) -> CableNet:
        """The net of an `impact.ImpactSetup`: its fabric, opening, projectile and symmetry, to compare the two models.

        Raises
        ------
        InputError : an edge that is not clamped
        """
        if setup.edge != "clamped":
            raise InputError(key="edge", value=setup.edge, allowed="clamped, for the cable model")
        opening = tuple(np.broadcast_to(setup.opening, 2).tolist())
        return cls(setup.fabric, opening, setup.projectile, setup.symmetry, **others)

    @property
    def counts(self):
        """(ni, nj) bars along a warp and along a weft yarn."""
        half = [int(length / 2 / (2 * w) + 1e-9) for length, w in zip(self.opening, self.fabric.weave.w)]
        return tuple(n if mirrored else 2 * n for n, mirrored in zip(half, SYMMETRIES[self.symmetry]))

    @property
    def bars(self):
        """Number of bars."""
        ni, nj = self.counts
        return ni * (nj + 1) + nj * (ni + 1)

    @property
    def share(self):
        """Part of the whole net, and of the projectile, that is modelled."""
        return 0.5 ** sum(SYMMETRIES[self.symmetry])

    @property
    def stiffness(self):
        """(k1, k2) [N/m] of a bar of warp and weft."""
        weave = self.fabric.weave
        return tuple(yarn.EA / S0 for yarn, S0 in zip(weave.yarns, weave.S0))

    @property
    def wave_speeds(self):
        """[m/s] of longitudinal waves along the taut, flat warp and weft, slowed by the mass of the crossing yarns."""
        weave = self.fabric.weave
        return tuple(2 * w * (k / weave.cell_mass) ** 0.5 for w, k in zip(weave.w, self.stiffness))

    @property
    def time_step(self):
        """[s]"""
        return self._step()[0]

    def _step(self):
        return self.numerics.step(2 * (sum(self.stiffness) / self.fabric.weave.cell_mass) ** 0.5)

    def constants(self) -> Constants:
        """What the kernels need to know, as plain numbers and arrays."""
        (ni, nj), mirrors, weave, knobs = self.counts, SYMMETRIES[self.symmetry], self.fabric.weave, self.numerics
        s, spacing, (dt, cv) = nj + 1, tuple(2 * w for w in weave.w), self._step()
        origin = tuple(0.0 if mirrored else -0.5 * n * d for mirrored, n, d in zip(mirrors, (ni, nj), spacing))
        points = [S0 * yarn.linear_density / p for S0, yarn, p in zip(weave.S0, weave.yarns, self._points())]
        slots = np.arange((ni + 1) * s).reshape(ni + 1, s)
        middle = (int(slots[-1, 0 if mirrors[1] else nj // 2]), int(slots[0 if mirrors[0] else ni // 2, -1]))
        return Constants(
            ni=ni, nj=nj, s=s, block=max(1, round(knobs.block / s)), spacing=spacing, origin=origin, dt=dt,
            S0=weave.S0, EA=tuple(yarn.EA for yarn in weave.yarns), cv=cv,
            limit=tuple(S0 * yarn.failure_strain if self.failure else inf for S0, yarn in zip(weave.S0, weave.yarns)),
            near=self._near(origin), point_stiffness=tuple(knobs.penalty * m / dt**2 for m in points),
            point_damping=tuple(2 * knobs.contact_damping * knobs.penalty**0.5 * m / dt for m in points),
            R=self.projectile.radius, rho=self.projectile.edge_radius,
            projectile_mass=self.projectile.mass * self.share,
            free=(*(0.0 if mirrored else 1.0 for mirrored in mirrors), 1.0),
            idle_steps=max(1, round(knobs.clear_time / dt)), clamped=slots[self._clamped()], middle=middle,
            middle_share=(0.5 if mirrors[1] else 1.0, 0.5 if mirrors[0] else 1.0), driven=0,
        )  # fmt: skip

    def state(self, strike_velocity) -> State:
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
        i0, i1, j0, j1 = const.near
        bar_mass = [S0 * yarn.linear_density for S0, yarn in zip(self.fabric.weave.S0, self.fabric.weave.yarns)]
        pressed = np.zeros((2, i1 - i0 + 1, j1 - j0 + 1, max(self._points())))
        rows = (i0, min(i1 + 1, ni))
        return at_rest(const, share, bar_mass, held, pressed, rows, strike_velocity)

    def coordinates(self):
        """(X, Y) [m] of the nodes at rest, each (ni+1, nj+1); the impact point is the origin."""
        c = self.constants()
        return np.meshgrid(
            *(o + d * np.arange(n + 1) for o, d, n in zip(c.origin, c.spacing, self.counts)), indexing="ij"
        )

    def _points(self):
        """Contact points on a bar, the same number for both families so that they share one array."""
        fine = max(2, *(ceil(2 * w / self.projectile.edge_radius) for w in self.fabric.weave.w))
        return (self.numerics.contact_points or fine,) * 2

    def _clamped(self):
        """(ni+1, nj+1) bool: nodes held by the clamps."""
        ni, nj = self.counts
        clamped = np.zeros((ni + 1, nj + 1), bool)
        clamped[-1, :] = clamped[:, -1] = True
        clamped[0, :] |= not SYMMETRIES[self.symmetry][0]
        clamped[:, 0] |= not SYMMETRIES[self.symmetry][1]
        return clamped

    def _near(self, origin):
        """Node rows and columns (i0, i1, j0, j1) whose bars can come under the projectile: crimp and strain draw in."""
        bounds = []
        for start, w, count, yarn in zip(origin, self.fabric.weave.w, self.counts, self.fabric.weave.yarns):
            half = count * 2 * w if start == 0 else -start
            reach = self.projectile.radius + (yarn.crimp + yarn.failure_strain) * half + 4 * w
            bounds += [max(0, int((-reach - start) / (2 * w))), min(count, int((reach - start) / (2 * w)) + 1)]
        return tuple(bounds)


def at_rest(const, share, bar_mass, held, pressed, rows, speed) -> State:
    """Arrays of a net at rest.

    Parameters
    ----------
    share : (2, ni+1, nj+1) [-] of a yarn in the bars along warp and weft from each node
    bar_mass : (2,) [kg] of a whole bar
    held : (3, ni+1, nj+1) bool, components that do not move
    pressed : contact forces, zero
    rows : (first, last) rows of bars that may move at once
    speed : [m/s] of the projectile
    """
    slots = share[0].size + const.s + 8  # loops read one row beyond the last
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

    return State(
        u=np.zeros((3, slots)), v=np.zeros((3, slots)), g=np.zeros((3, slots)), mass=flat(mass),
        kick=flat(np.where(held, 0.0, inverse)), stiff=flat(share * stiffness[:, None, None]),
        L=np.repeat(np.array(const.spacing)[:, None], slots, axis=1), drag=np.zeros((2, slots)), pressed=pressed,
        touching=np.zeros(pressed.shape[:3], np.bool_),
        position=np.zeros(3), speed=np.array([0.0, 0.0, float(speed)]), reaction=np.zeros(3), rows=np.array(rows),
        counter=np.zeros(3, np.int64), sums=np.zeros(4), peak=np.zeros(2),
    )  # fmt: skip


@dataclass(frozen=True)
class CableResult:
    """What an impact on a net came to; names as in `impact.ImpactResult`. Energies and forces are of the whole net.

    Parameters
    ----------
    net : what was struck
    outcome : "stopped", "perforated" or "in flight"
    residual_velocity : [m/s] of the projectile at the end
    t, v, z : (n,) [s, m/s, m] instants of the audit; velocity and nose position of the projectile
    energies : {name: (n,)} [J] with the names of ENERGIES; balance is the sum less the energy at the start
    peak_tension : (warp, weft) [N] over the run
    fine : (steps, 4) time [s], nose position [m], velocity [m/s] at half steps, force on the projectile [N]
    reactions : {"warp", "weft", "edges": (steps,)} [N] after each step: pulls of the middle yarns on a clamp, along the
        yarns at rest, and the force of all clamps on the net, along z
    nodes : (ni+1, nj+1, 3) [m] at the end
    broken : (2, ni+1, nj+1) bool at the end: bars that have failed, from each node along warp and weft
    steps, wall_time, ns_per_bar_step : cost of marching, [s] and [ns]
    """

    net: CableNet
    outcome: str
    residual_velocity: float
    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    energies: dict
    peak_tension: tuple[float, float]
    fine: np.ndarray
    reactions: dict
    nodes: np.ndarray
    broken: np.ndarray
    steps: int
    wall_time: float
    ns_per_bar_step: float

    @property
    def worst_balance(self):
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["balance"])) / self.energies["kinetic_projectile"][0])


def run(net: CableNet, strike_velocity, end_time=800e-6, *, audit_interval=2e-6) -> CableResult:
    """March a net until the projectile stops or is through, or `end_time` [s] has passed.

    Raises
    ------
    InputError : a time or velocity that is not positive
    UnstableError : a number that is not finite, or an energy balance beyond its limit
    """
    for key, value in (
        ("strike_velocity", strike_velocity),
        ("end_time", end_time),
        ("audit_interval", audit_interval),
    ):
        if not 0 < value < inf:
            raise InputError(key=key, value=value, allowed="above 0")
    const, state = net.constants(), net.state(strike_velocity)
    steps, chunk = ceil(end_time / const.dt), max(1, round(audit_interval / const.dt))
    history = np.empty((steps, kernels.COLUMNS))
    kernels.advance(state, const, 0, history)  # compiled before the clock starts
    made, reason, wall, samples = 0, kernels.RUNNING, 0.0, [audit(state, const)]
    while made < steps and reason == kernels.RUNNING:
        start = perf_counter()
        done, reason = kernels.advance(state, const, min(chunk, steps - made), history[made:])
        wall += perf_counter() - start
        made += done
        samples.append(audit(state, const))
        check(samples, reason, net.numerics.drift_limit)
    return _result(net, const, state, history[:made], np.array(samples), reason, wall)


ENERGIES = ("kinetic_fabric", "kinetic_projectile", "stored", "viscous", "contact", "failed", "external", "balance")


def audit(state, const):
    """One sample of the modelled part: time, the projectile's velocity and place, and ENERGIES but for the balance.

    What is stored follows from the lengths of the bars, not from the work that went into them.
    """
    cloth, projectile, stored = kernels.energies(state, const)
    speed = state.speed[2] + 0.5 * const.dt * state.reaction[2] / const.projectile_mass
    sums, time = state.sums, state.counter[kernels.STEP] * const.dt
    spent = sums[kernels.VISCOUS], sums[kernels.CONTACT], sums[kernels.LOST]
    return time, speed, state.position[2], cloth, projectile, stored, *spent, 0.0  # clamps do no work


def check(samples, reason, limit):
    """Stop a run that has become unphysical."""
    first, last = sum(samples[0][3:]), sum(samples[-1][3:])
    when = f"after {samples[-1][0] * 1e6:.3g} us"
    if reason == kernels.NOT_FINITE or not np.isfinite(last):
        raise UnstableError("a number is not finite in the cable net", when=when)
    if abs(last - first) > limit * first:
        raise UnstableError(
            f"the energy balance of the cable net is off by {100 * abs(last / first - 1):.2g} %", when=when
        )


def _result(net, const, state, history, samples, reason, wall):
    shape, share = (2, const.ni + 1, const.s), net.share
    size = shape[1] * shape[2]
    energies = np.column_stack([samples[:, 3:], samples[:, 3:].sum(axis=1) - samples[0, 3:].sum()]) / share
    whole = net.state(1.0).stiff[:, :size].reshape(shape)
    clock = const.dt * np.arange(1, len(history) + 1)
    moved = state.u[:, :size].reshape(3, *shape[1:])
    return CableResult(
        net=net,
        outcome=OUTCOMES[reason],
        residual_velocity=float(samples[-1, 1]),
        t=samples[:, 0],
        v=samples[:, 1],
        z=samples[:, 2],
        energies=dict(zip(ENERGIES, energies.T)),
        peak_tension=tuple(float(e * k) for e, k in zip(state.peak, net.stiffness)),
        fine=np.column_stack([clock, history[:, [kernels.Z, kernels.V_Z]], history[:, kernels.PUSH] / share]),
        reactions={
            "warp": history[:, kernels.MIDDLE].copy(),
            "weft": history[:, kernels.MIDDLE + 1].copy(),
            "edges": history[:, kernels.EDGES] / share,
        },
        nodes=np.stack([*net.coordinates(), np.zeros(shape[1:])], axis=-1) + np.moveaxis(moved, 0, 2),
        broken=(whole > 0) & (state.stiff[:, :size].reshape(shape) == 0),
        steps=len(history),
        wall_time=wall,
        ns_per_bar_step=1e9 * wall / (len(history) * net.bars),
    )
