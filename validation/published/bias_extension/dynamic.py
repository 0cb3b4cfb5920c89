"""The bias extension test as the thesis ran it: explicit, its clamps pulled apart at a constant speed, two elements.

With the yarns of `shellfabric.coupon.model` on the grid lines, and with the thesis's element: a quadrilateral that
stands for a crossover, with one point at its centre and viscous hourglass control (LS-DYNA's first, coefficient 0.1).
Central differences, v <- v + dt f / m, x <- x + dt v, with the masses of the cloth. It shows that what becomes of the
cloth without locking depends on the trellis, and neither on the element nor on the way of running it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FloatArray
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.coupon import quasistatic
from validation.published.bias_extension.cases import cloth

if TYPE_CHECKING:
    from shellfabric.coupon.model import Coupon

SPEED = 2.0  # [m/s] of each clamp: 2.5 ms for 10 mm, in which a shear wave of G1 runs through the coupon twice
SAFETY = 0.5  # of the time step that the stiffest tangent of the cloth allows
HOURGLASS = 0.1


@dataclass(frozen=True)
class Pull:
    """A coupon that has been pulled.

    Parameters
    ----------
    coupon, zone : Coupon, (q,) index into quasistatic.ZONES
    elongation : (k,) [m]
    angles : (k, 3) [rad] mean angle between warp and weft in the zones A, B, C
    concentration : (k,) [-] see `quasistatic.concentration`
    x : (n, 2) [m] nodes at the end
    """

    coupon: object
    zone: np.ndarray
    elongation: np.ndarray
    angles: np.ndarray
    concentration: np.ndarray
    x: np.ndarray


def pull(
    name: str, *, element: str = "yarns", length: float = 0.1435, width: float = 0.074, elongation: float = 0.010,
    speed: float = SPEED, looks: int = 4, table_size: int = 121, elements_per_crossover: int = 1,
) -> Pull:  # fmt: skip
    """Pull one of `cases.CLOTHS` with "yarns" on the grid lines or the thesis's "one point" element; returns a Pull."""
    fabric, model, trellis = cloth(name)
    table = CellModel(fabric, model=model, form="variational").table(table_size)
    coupon, grips, (length, width) = quasistatic.bias_coupon(table, length, width, elements_per_crossover, trellis)
    zone = quasistatic.zones(coupon, length, width)
    weave, held, x = fabric.weave, grips > 0, coupon.points.copy()
    corner = 0.25 * weave.areal_density * np.prod(coupon.spacing)
    mass = np.maximum(np.bincount(coupon.quads.ravel(), minlength=len(x)), 1)[:, None] * corner
    locked = 2 * fabric.shear.G2 * weave.thickness if trellis else 0.0
    dt = SAFETY * min(coupon.spacing) * sqrt(weave.areal_density / (table.stiffness() + locked))
    v = np.zeros_like(x)
    v[held, 1] = speed * np.sign(x[held, 1])
    forces = one_point(coupon) if element == "one point" else lambda x, v: coupon.forces(x)[0]
    found, steps = [], int(elongation / (2 * speed * dt))
    for step in range(1, steps + 1):
        f = forces(x, v)
        f[held] = 0.0
        v += dt * f / mass
        x += dt * v
        if step % (steps // looks) == 0:
            gamma = coupon.shear_angles(x)
            means = [np.pi / 2 - gamma[zone == k].mean() for k in range(3)]
            found.append((2 * speed * step * dt, means, quasistatic.concentration(gamma, zone == 2)))
    moved, angles, concentration = (np.array(part) for part in zip(*found))
    return Pull(coupon, zone, moved, angles, concentration, x)


def one_point(coupon: Coupon) -> Callable[..., Any]:
    """forces(x, v) -> (n, 2) [N] of quadrilaterals with one point, from the same table and shear law."""
    table, weave, quads = coupon.table, coupon.weave, coupon.quads
    d = np.array(coupon.spacing)
    cells = np.prod(d) / weave.cell_area
    volume = np.prod(d) * weave.thickness if coupon.trellis else 0.0
    wave = sqrt(table.stiffness() / weave.areal_density)
    damping = HOURGLASS * 0.25 * weave.areal_density * sqrt(np.prod(d)) * wave
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.5 / d  # dX/da, dX/db of the corners
    zigzag = np.array([1, -1, 1, -1])

    def forces(x, v):
        a, b = np.einsum("cf,qcd->fqd", signs, x[quads])
        stretch = np.linalg.norm([a, b], axis=2)
        slopes = cells * np.array(table_slopes(table, *stretch)) / stretch
        pull_a, pull_b = slopes[0][:, None] * a, slopes[1][:, None] * b
        if volume:
            across = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
            gamma = 0.5 * np.pi - np.arctan2(across, np.sum(a * b, axis=1))
            tau = volume * table.model.fabric.shear.stress(gamma) / stretch**2
            pull_a = pull_a + tau[0][:, None] * np.stack([-a[:, 1], a[:, 0]], axis=1)
            pull_b = pull_b + tau[1][:, None] * np.stack([b[:, 1], -b[:, 0]], axis=1)
        corners = -np.einsum("cf,fqd->qcd", signs, np.array([pull_a, pull_b]))
        corners -= damping * zigzag[:, None] * np.einsum("c,qcd->qd", zigzag, v[quads])[:, None, :]
        nodes = quads.ravel()
        return np.stack([np.bincount(nodes, corners[:, :, k].ravel(), len(x)) for k in range(2)], axis=1)

    return forces


def table_slopes(table: CellTable, stretch1: FloatArray, stretch2: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slopes [J] of the tabulated potential with the two stretches; tensions go on straight above the table."""
    local, cell = [], []
    for stretch, grid in ((stretch1, table.stretch1), (stretch2, table.stretch2)):
        p = np.maximum((stretch - grid[0]) / (grid[1] - grid[0]), 0.0)
        i = np.minimum(p.astype(int), grid.size - 2)
        local.append(p - i)
        cell.append(i)
    (p, dp), (q, dq) = map(_powers, local)
    c = table.potential[cell[0], cell[1]].reshape(-1, 4, 4)
    d1, d2 = table.steps
    return np.einsum("nkl,kn,ln->n", c, dp, q) / d1, np.einsum("nkl,kn,ln->n", c, p, dq) / d2


def _powers(p):
    """1, p, p^2, p^3 and their slopes; above 1 each goes on as its parabola, as in `relaxation_kernels.powers`."""
    e = np.maximum(p - 1, 0.0)
    inside = np.minimum(p, 1.0)
    cubes = np.where(e > 0, 1 + 3 * e * (1 + e), inside**3)
    slopes = np.where(e > 0, 3 + 6 * e, 3 * inside**2)
    return np.array([np.ones_like(p), p, p * p, cubes]), np.array([np.zeros_like(p), np.ones_like(p), 2 * p, slopes])
