"""An impact on the pin-jointed cable net: run, energy audit, result. The net stands in `cable`."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, inf
from time import perf_counter

import numpy as np

from fabrics.errors import InputError, UnstableError
from shellfabric.cable import step_kernels as kernels
from shellfabric.cable.contact_kernels import CONTACT
from shellfabric.cable.model import CableNet

OUTCOMES = {kernels.RUNNING: "in flight", kernels.STOPPED: "stopped", kernels.PERFORATED: "perforated"}
ENERGIES = ("kinetic_fabric", "kinetic_projectile", "stored", "viscous", "contact", "failed", "external", "balance")


@dataclass(frozen=True)
class CableResult:
    """What an impact on a net came to; names as in `single_ply.ImpactResult`. Energies and forces are of the whole net.

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


def audit(state, const):
    """One sample of the modelled part: time, the projectile's velocity and place, and ENERGIES but for the balance.

    What is stored follows from the lengths of the bars, not from the work that went into them.
    """
    cloth, projectile, stored = kernels.energies(state, const)
    speed = state.speed[2] + 0.5 * const.dt * state.reaction[2] / const.projectile_mass
    sums, time = state.sums, state.counter[kernels.STEP] * const.dt
    spent = sums[kernels.VISCOUS], sums[CONTACT], sums[kernels.LOST]
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
