"""A straight yarn struck across at constant velocity: Smith's closed form, and the cable model's run of it.

Smith, McCrackin and Schiefer, Textile Research Journal 28 (1958) 288, for the linear yarn T = EA strain of mass m per
natural length, struck at a point that then moves across it at the velocity V. Two waves leave the point.

1. The longitudinal one runs at c = sqrt(EA / m) along the yarn and leaves it with the strain e, and with the velocity
   W = c e towards the point: what jumps in strain by e in the time dt stretches c dt of yarn by c e dt.
2. Behind it comes the kink. A wave of shape runs in a string under tension at the speed sqrt(T / m') of the stretched
   string, m' = m / (1 + e); counted in natural length that is sqrt(T / m (1 + e)) = c sqrt(e / (1 + e)), and along the
   stretched yarn (1 + e) times as much, c sqrt(e (1 + e)). The yarn before it moves towards the point at W, so that in
   the laboratory

       U = c (sqrt(e (1 + e)) - e).

3. Behind the kink the yarn moves across at V with no velocity along. In the time t the kink has taken up the natural
   length c sqrt(e / (1 + e)) t. The tension is the same on both sides, hence the strain, and the length is now
   c sqrt(e (1 + e)) t: the hypotenuse over U t and V t. So

       V^2 = c^2 e (1 + e) - U^2 = c^2 (2 e sqrt(e (1 + e)) - e^2).

The force on the striker, both sides together, is 2 T V / (c sqrt(e (1 + e))), since the sine of the slope is V over the
speed along the hypotenuse. It equals the momentum that the two kinks take up, 2 m c sqrt(e / (1 + e)) V.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from scipy.optimize import brentq

from fabrics.errors import InputError
from fabrics.yarn import Yarn, striking_velocity
from shellfabric.projectile import contact
from shellfabric.projectile.projectile import Projectile
from validation.models.cable import step_kernels as kernels
from validation.models.cable.model import CableNumerics, at_rest, constants, energies

STRAIGHT = CableNumerics(cfl=0.8)  # a yarn without slack


@dataclass(frozen=True)
class TransverseImpact:
    """What a transverse impact does to a long straight yarn.

    Parameters
    ----------
    strain : [-] behind the longitudinal wave
    tension : [N]
    c : [m/s] longitudinal wave
    U : [m/s] kink, in the laboratory
    force : [N] on the striker, both sides
    """

    strain: float
    tension: float
    c: float
    U: float
    force: float


def smith(yarn: Yarn, velocity: float) -> TransverseImpact:
    """Smith's closed form for a straight yarn of linear behaviour, struck at `velocity` [m/s].

    Raises
    ------
    InputError : a velocity that is not positive, or not below the longitudinal wave's
    """
    c = yarn.wave_speed
    if not 0 < velocity < c:
        raise InputError(key="velocity", value=velocity, allowed=f"above 0 and below the wave speed {c:.0f} m/s")

    strain = brentq(lambda e: striking_velocity(c, e) ** 2 - velocity**2, 0.0, 1.0, xtol=1e-16, rtol=1e-14)
    along = c * sqrt(strain * (1 + strain))
    tension = yarn.EA * strain
    return TransverseImpact(strain, tension, c, along - c * strain, 2 * tension * velocity / along)


@dataclass(frozen=True)
class YarnRun:
    """Half of a struck yarn, marched by the cable model.

    Parameters
    ----------
    computed : TransverseImpact read off the run
    X : (n+1,) [m] nodes along the yarn at rest
    nodes : (n+1, 2) [m] at the end, along and across
    strain : (n,) [-] of the bars at the end
    energies : {name: [J]} of the half yarn at the end: kinetic_fabric, stored, viscous, external (less the work of the
        striker), and balance, their sum less the energy that the struck node begins with
    """

    computed: TransverseImpact
    X: np.ndarray
    nodes: np.ndarray
    strain: np.ndarray
    energies: dict


def strike(
    yarn: Yarn, velocity: float, *, length: float = 0.1, bars: int = 2000, numerics: CableNumerics = STRAIGHT
) -> YarnRun:
    """Integrate half of a straight yarn in time until its longitudinal wave has run 0.9 of its `length` [m].

    Strain and tension are the mean of the plateau between the waves; c is where the strain is half of that; U follows
    from the area under the deflected yarn, which is a triangle of the base U t and the height V t; the force is the
    mean over the second half of the run. The crimp of the yarn is left out, and so is its failure; without crimp no bar
    goes from slack to taut, and the default of the Courant factor is twice that of the net.

    Raises
    ------
    InputError : fewer than 50 bars, or as in `smith`
    """
    if bars < 50:
        raise InputError(key="bars", value=bars, allowed="at least 50")
    theory = smith(yarn, velocity)
    const = _constants(yarn, length / bars, bars, numerics)
    share, held = np.zeros((2, 1, bars + 1)), np.zeros((3, 1, bars + 1), bool)
    share[1, 0, :-1] = 1.0
    held[:, 0, [0, -1]] = True
    state = at_rest(const, share, (0.0, const.S0[1] * yarn.linear_density), held, velocity)
    state.v[2, 0] = velocity  # the driven node has no kick: it keeps its speed
    steps = round(0.9 * length / (theory.c * const.dt))
    history = np.empty((steps, kernels.COLUMNS))
    kernels.run_steps(state, const, steps, history)
    return _read(yarn, const, state, history, velocity)


def _constants(yarn, spacing, bars, numerics):
    """The yarn as a net of one row: bars along the weft, none along the warp, nothing in contact."""
    dt, cv = numerics.step(2 * yarn.wave_speed / spacing)
    return constants(
        (0, bars), (spacing, spacing), (spacing, spacing), (yarn.EA, yarn.EA), dt, cv, Projectile(),
        mirror_x=False, mirror_y=False, failure_elongation=(inf, inf), window_limits=(0, 0, 0, 0),
        **contact.constants(1, 0.0, dt, 0.0, 0.0), erosion_gap_ratio=inf, projectile_mass=1.0,
        clamped_nodes=np.array([0]), middle_end_nodes=(0, bars),
    )  # fmt: skip


def _read(yarn, const, state, history, V):
    bars, spacing, t = const.nj, const.dy, len(history) * const.dt
    X = spacing * np.arange(bars + 1)
    nodes = np.column_stack([X + state.u[1, : bars + 1], state.u[2, : bars + 1]])
    strain, middle = state.length[1, :bars] / spacing - 1, 0.5 * (X[1:] + X[:-1])
    area = 0.5 * np.sum(np.diff(nodes[:, 0]) * (nodes[1:, 1] + nodes[:-1, 1]))
    U = 2 * area / (V * t * t)
    # the kink has taken up the material up to U t plus what has moved in
    kink = np.interp(U * t, nodes[:, 0], X)
    plateau = float(strain[(middle > 1.5 * kink) & (middle < 0.8 * X[-1])].mean())
    k = int(np.flatnonzero(strain > 0.5 * plateau)[-1])
    front = middle[k] + spacing * (strain[k] - 0.5 * plateau) / (strain[k] - strain[k + 1])
    drive = history[:, kernels.CLAMP_FORCE]
    force = 2 * float(drive[len(drive) // 2 :].mean())
    cloth, _, stored = energies(state, const)
    viscous = float(state.energy_sums[kernels.VISCOUS])
    external = -V * const.dt * (drive.sum() - 0.5 * drive[-1])
    sums = {"kinetic_fabric": cloth, "yarn_strain": stored, "viscous": viscous, "boundary_work": external}
    sums["error"] = sum(sums.values()) - 0.5 * state.mass[0] * V * V
    computed = TransverseImpact(plateau, yarn.EA * plateau, float(front / t), float(U), force)
    return YarnRun(computed, X, nodes, strain, sums)
