"""A straight yarn struck across at constant velocity: Smith's closed form (Smith, McCrackin and Schiefer, Textile
Research Journal 28 (1958) 288; equations: docs/theory-panel.md, "Wave speeds"), and the cable model's run of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.optimize import brentq

from fabrics.base.errors import InputError
from fabrics.yarn import Yarn, striking_velocity
from validation.models.cable.net import VISCOSITY, time_step

CFL = 0.8  # Courant factor of a yarn without slack: none of its bars goes from slack to taut


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
    """Compute Smith's closed form for a straight yarn of linear behaviour, struck at `velocity`
    [m/s].

    The longitudinal wave leaves the yarn with the strain e and the velocity W = c e towards the
    point. The kink is a wave of shape in a string under tension: in natural length it runs at c
    sqrt(e / (1 + e)), along the stretched yarn at c sqrt(e (1 + e)), and the yarn before it moves
    towards the point at W, so that U = c (sqrt(e (1 + e)) - e). Behind it the yarn moves across at
    V with no velocity along: the length c sqrt(e (1 + e)) t is the hypotenuse over U t and V t,
    which gives V^2. The force on the striker, both sides together, is 2 T V / (c sqrt(e (1 + e))):
    the momentum that the two kinks take up, 2 m c sqrt(e / (1 + e)) V.

    Raises
    ------
    InputError : a velocity that is not positive, or not below the longitudinal wave's
    """
    c = yarn.wave_speed
    if not 0 < velocity < c:
        raise InputError(
            key="velocity", value=velocity, allowed=f"above 0 and below the wave speed {c:.0f} m/s"
        )

    strain = brentq(
        lambda e: striking_velocity(c, e) ** 2 - velocity**2, 0.0, 1.0, xtol=1e-16, rtol=1e-14
    )
    along = c * sqrt(strain * (1 + strain))
    tension = yarn.EA * strain
    return TransverseImpact(strain, tension, c, along - c * strain, 2 * tension * velocity / along)


@dataclass(frozen=True)
class YarnRun:
    """Half of a struck yarn, integrated by the cable model.

    Parameters
    ----------
    computed : TransverseImpact read off the run
    X : (n+1,) [m] nodes along the yarn at rest
    nodes : (n+1, 2) [m] at the end, along and across
    strain : (n,) [-] of the bars at the end
    error : [-] of the energy balance at the end over the work of the striker
    """

    computed: TransverseImpact
    X: np.ndarray
    nodes: np.ndarray
    strain: np.ndarray
    error: float


def strike(
    yarn: Yarn,
    velocity: float,
    *,
    length: float = 0.1,
    bars: int = 2000,
    cfl: float = CFL,
    viscosity: float = VISCOSITY,
) -> YarnRun:
    """Integrate half of a straight yarn in time until its longitudinal wave has run 0.9 of its `length` [m].

    Its bars and steps are those of `cable.net`; it has neither crimp nor failure. Strain and tension are the mean of
    the plateau between the waves; c is where the strain is half of that; U follows from the area under the deflected
    yarn, which is a triangle of the base U t and the height V t; the force is the mean over the second half of the run.
    """
    d = length / bars
    V = velocity
    k = yarn.EA / d
    mass = np.full((bars + 1, 1), d * yarn.linear_density)
    mass[[0, -1]] *= 0.5
    dt, cv = time_step(2 * yarn.wave_speed / d, cfl, viscosity)
    kick = dt / mass
    kick[[0, -1]] = 0.0
    u, v, f = np.zeros((3, bars + 1, 2))
    v[0, 1] = V  # the driven node has no kick: it keeps its speed
    L = np.full(bars, d)
    drag = np.zeros(bars)
    lost = 0.0
    drive = []
    for _ in range(round(0.9 * length / (yarn.wave_speed * dt))):
        v += kick * f
        u += dt * v
        sides = np.diff(u, axis=0) + np.array([d, 0.0])
        before = L
        L = np.hypot(*sides.T)
        T = k * np.maximum(L - d, 0.0)
        viscous = np.where(T > 0, np.maximum(cv * k * (L - before), -T), 0.0)
        lost += np.sum(0.5 * (viscous + drag) * (L - before))
        drag = viscous
        pull = ((T + viscous) / L)[:, None] * sides
        f = np.diff(np.pad(pull, ((1, 1), (0, 0))), axis=0)
        drive.append(-f[0, 1])
    kinetic = 0.5 * np.sum(mass * v * (v + kick * f))
    stored = 0.5 * k * np.sum(np.maximum(L - d, 0.0) ** 2)
    done = V * dt * (sum(drive) - 0.5 * drive[-1])
    error = (kinetic + stored + lost - done - 0.5 * mass[0, 0] * V**2) / done
    X = d * np.arange(bars + 1)
    nodes = u + np.stack([X, 0 * X], axis=1)
    strain = L / d - 1
    return YarnRun(_read(yarn, X, nodes, strain, drive, dt, V), X, nodes, strain, error)


def _read(yarn, X, nodes, strain, drive, dt, V):
    """The TransverseImpact of a run."""
    t = len(drive) * dt
    middle = 0.5 * (X[1:] + X[:-1])
    spacing = X[1]
    area = 0.5 * np.sum(np.diff(nodes[:, 0]) * (nodes[1:, 1] + nodes[:-1, 1]))
    U = 2 * area / (V * t * t)
    # the kink has taken up the material up to U t plus what has moved in
    kink = np.interp(U * t, nodes[:, 0], X)
    plateau = float(strain[(middle > 1.5 * kink) & (middle < 0.8 * X[-1])].mean())
    k = int(np.flatnonzero(strain > 0.5 * plateau)[-1])
    front = middle[k] + spacing * (strain[k] - 0.5 * plateau) / (strain[k] - strain[k + 1])
    force = 2 * float(np.mean(drive[len(drive) // 2 :]))
    return TransverseImpact(plateau, yarn.EA * plateau, float(front / t), float(U), force)
