"""python -m validation.verification.mesh_convergence.rim

What a yarn of straight elements makes of a bend that is sharper than they are long: by how much the tensions inside and
outside of it differ, without friction, as the rim of the nose passes through an element. On a smooth rim they do not.

With contact forces shared among nodes by weights w_m (`shellfabric.cloth.spline_kernels`), a yarn under tension T gives
way to a force F by F^2 h / 4T (const - S) less than a continuous one, S = sum w_m w_n |m - n|. Where it is bent by
theta, F = T theta, and sliding by an element costs T theta^2 h / 4 dS:

    (T_in - T_out) / T = theta^2 / 4 dS/ds,      s [elements] the place of the rim

whatever the length h of the elements, until they are as short as the rim is round. Beside that stands what the yarn
does in full: nodes on stiff springs in a plane, stretched over a rim of radius r, at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import minimize

from shellfabric.cloth import spline_kernels
from validation.program import program

THETA = np.radians(39.0)  # of S-745 at its peak
RADIUS = 0.3  # [mm] of the thesis's nose
ELEMENTS = (1.5, 0.75, 0.5, 0.375)  # [mm] long, S-745 with 1 to 4 a crossover, nearly
_NODES, _POINTS, _STRAIN, _PHASES = 17, 24, 0.02, 12


def bilinear(s: float) -> tuple[float, ...]:
    """Weights of three nodes at s from the middle one, on a straight element."""
    return spline_kernels.node_weights(s, False)


def smooth(s: float) -> tuple[float, ...]:
    """Those of the quadratic B-spline, which the code uses."""
    return spline_kernels.node_weights(s, True)


def closed(weights: Callable[..., Any], theta: float = THETA) -> float:
    """[-] the largest difference of the tensions over their mean, small angles, a sharp rim."""
    s = np.linspace(-0.5, 0.5, 401)
    a, b, c = np.array([weights(one) for one in s]).T
    return 0.25 * theta**2 * np.abs(np.gradient(2 * b * (a + c) + 4 * a * c, s))[1:-1].max()


def solved(weights: Callable[..., Any], element: float, theta: float = THETA, radius: float = RADIUS) -> float:
    """[-] the same from yarns at rest, with the rim at several places in an element."""
    half, found = _NODES // 2, []
    shares = np.zeros((_NODES, (_NODES - 5) * _POINTS))
    for k in range(shares.shape[1]):
        a = 2 + (k + 0.5) / _POINTS
        middle = int(np.floor(a + 0.5))
        shares[middle - 1 : middle + 2, k] = weights(a - middle)
    shares, centre = shares.T, np.array([0.0, -radius])
    for phase in (np.arange(_PHASES) + 0.5) / _PHASES:
        along = (np.arange(_NODES) - half + phase) * element
        x = np.array([_round(one, theta, radius) for one in along])
        rest = element / (1 + _STRAIN)

        def energy(inner, ends=x[[0, -1]], rest=rest):
            y = np.vstack([ends[:1], inner.reshape(-1, 2), ends[1:]])
            edges = np.diff(y, axis=0)
            length = np.sqrt((edges**2).sum(1))
            pull = ((length / rest - 1) / length)[:, None] * edges
            slope = np.zeros_like(y)
            slope[1:] += pull
            slope[:-1] -= pull
            points = shares @ y
            off = points - centre
            far = np.sqrt((off**2).sum(1))
            flat = points[:, 0] < 0
            depth = np.minimum(np.where(flat, points[:, 1], far - radius), 0.0)
            normal = np.where(flat[:, None], (0.0, 1.0), off / far[:, None])
            stiffness = 200.0 * element**2 / _POINTS
            slope += shares.T @ (stiffness * depth[:, None] * normal)
            total = 0.5 * rest * ((length / rest - 1) ** 2).sum() + 0.5 * stiffness * (depth**2).sum()
            return total, slope[1:-1].ravel()

        options = {"maxiter": 20000, "ftol": 1e-15, "gtol": 1e-10, "maxcor": 50}
        inner = minimize(energy, x[1:-1].ravel(), jac=True, method="L-BFGS-B", options=options).x
        y = np.vstack([x[:1], inner.reshape(-1, 2), x[-1:]])
        strain = np.sqrt((np.diff(y, axis=0) ** 2).sum(1)) / rest - 1
        found.append(2 * (strain[1] - strain[-2]) / (strain[1] + strain[-2]))
    return float(np.abs(found).max())


def _round(along, theta, radius):
    """Place at a length along flat, rim and what hangs beyond it."""
    if along <= 0:
        return along, 0.0
    turn = min(along / radius, theta)
    beyond = along - turn * radius
    return (
        radius * np.sin(turn) + beyond * np.cos(theta),
        radius * (np.cos(turn) - 1) - beyond * np.sin(theta),
    )


def main() -> None:
    for weights in (bilinear, smooth):
        numbers = ", ".join(f"{element:g} mm {100 * solved(weights, element):.1f}" for element in ELEMENTS)
        print(f"{weights.__name__:9} closed form {100 * closed(weights):.1f} %; elements of {numbers} %", flush=True)


if __name__ == "__main__":
    program(main)
