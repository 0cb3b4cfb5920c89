"""A crossover of solid yarns drawn or pressed so slowly that it is at rest: the quasi-static limit of
the explicit patch, to be compared with the 3D crossover of dolfinx.

The ends of the yarns are those of a cell of the weave. The two-fold axis across a yarn's end sends
the end to itself, upside down: there the displacement along the yarn is prescribed in the mean, that
up is zero in the mean, and that across is even. What a node is moved by is the mean of both images.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sin

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from validation.models.solids import step_kernels
from validation.models.solids.facet_kernels import pressure
from validation.models.solids.mesh import facet_areas
from validation.models.solids.model import SolidPatch

DAMPING = 2e5  # [1/s] of all velocities
STEPS_OF_A_LENGTH = 50
EVERYWHERE = 1.0  # [m] by which a gap may close in a step: no facet waits
RELAXING = 1.0  # Courant factor over 2: the loading is smooth, and viscosity is small at rest


@dataclass(frozen=True)
class Drawn:
    """A crossover at rest under a load.

    Parameters
    ----------
    tension : (2,) [N] of warp and weft
    contact : [N] vertical force of the two yarns on each other
    plates : (2,) [N] of the upper and the lower platen
    kinetic_energy : [J] that is left
    steps : number of steps
    """

    tension: np.ndarray
    contact: float
    plates: np.ndarray
    kinetic_energy: float
    steps: int


def draw(
    patch: SolidPatch,
    displacement: tuple[float, float],
    plates: float | None = None,
    duration: float = 60e-6,
) -> Drawn:
    """Move the ends of the yarns of a crossover, and two platens, to where they shall be in half of
    a duration, and let it come to rest in the other half.

    Parameters
    ----------
    patch : SolidPatch of one warp and one weft, whole, its ends not clamped, without a projectile
    displacement : (d1, d2) [m] of each end of warp and weft, outwards
    plates : [m] half the distance of two rigid platens in the end; None for none
    duration : [s]

    Raises
    ------
    InputError : the patch is not a crossover of free ends
    """
    if patch.clamped or patch.mesh.quarter or len(patch.mesh.grids) != 2:
        raise InputError("a whole crossover of free ends is drawn, of one warp and one weft")
    row = patch.row()
    row.reach = EVERYWHERE
    platens = _Platens(patch, plates)
    steps = 0
    dt = 0.0
    time = 0.0
    while time < duration:
        if steps % STEPS_OF_A_LENGTH == 0:
            dt = RELAXING / patch.frequency(row)[0]
        step_kernels.forces(row)
        row.f_other[:] += platens.forces(row.x, time / duration)
        row.v[:] -= dt / row.mass[:, None] * (row.f_solid + row.f_other)
        row.v[:] *= 1 - DAMPING * dt
        speed = 0.0
        if time < 0.5 * duration:
            speed = pi / duration * sin(2 * pi * time / duration)
        _hold_ends(patch, row.v, [speed * d for d in displacement])
        row.x[:] += dt * row.v
        row.last_dt = dt
        time += dt
        steps += 1
    return _at_rest(patch, row, platens, steps)


def _hold_ends(patch, v, speeds):
    """Give the ends the velocities that the two-fold axis and the loading leave them."""
    for grid, family in zip(patch.mesh.grids, patch.mesh.families):
        for nodes, sign in ((grid[-1], 1.0), (grid[0], -1.0)):
            own = v[nodes]
            image = own[:, ::-1]
            held = 0.5 * (own - image)
            across = 1 - family
            held[..., across] = 0.5 * (own + image)[..., across]
            held[..., family] += sign * speeds[family]
            v[nodes] = held


def _at_rest(patch, row, platens, steps):
    """The forces of a state."""
    warp, weft = patch.mesh.grids
    internal = row.f_solid + row.f_other
    tension = [internal[grid[-1]][..., family].sum() for family, grid in enumerate((warp, weft))]
    step_kernels.forces(row)
    with_contact = row.f_other[warp][..., 2].sum()
    partner = row.partner.copy()
    row.partner[:] = -1
    step_kernels.forces(row)
    contact = row.f_other[warp][..., 2].sum() - with_contact
    row.partner[:] = partner
    return Drawn(
        tension=np.array(tension),
        contact=float(contact),
        plates=platens.total,
        kinetic_energy=0.5 * sums.dot(row.mass, (row.v**2).sum(axis=1)),
        steps=steps,
    )


class _Platens:
    """Two rigid planes at equal distances from the middle plane, over the warp and under the weft."""

    def __init__(self, patch: SolidPatch, end: float | None) -> None:
        self.total = np.zeros(2)
        self._numerics = patch.numerics
        self._end = end
        warp, weft = patch.mesh.grids
        self._nodes = warp[:, :, -1].ravel(), weft[:, :, 0].ravel()
        points = patch.mesh.points
        self._areas = [_node_areas(points[grid]) for grid in (warp[:, :, -1], weft[:, :, 0])]
        self._start = float(max(points[self._nodes[0], 2].max(), -points[self._nodes[1], 2].min()))

    def forces(self, x: FloatArray, share: float) -> FloatArray:
        """Compute the internal forces (n, 3) [N] of the platens at a share of the duration."""
        found = np.zeros_like(x)
        if self._end is None:
            return found
        way = min(1.0, 2 * share)
        way -= sin(2 * pi * way) / (2 * pi)
        height = self._start + way * (self._end - self._start)
        for number, (nodes, areas, side) in enumerate(zip(self._nodes, self._areas, (1.0, -1.0))):
            depth = side * x[nodes, 2] - height
            met = depth > 0
            numerics = self._numerics
            push = [pressure(d, numerics.penalty, numerics.toe)[0] for d in depth[met]]
            push = np.array(push) * areas[met]
            found[nodes[met], 2] += side * push
            self.total[number] = push.sum()
        return found


def _node_areas(points):
    """(n,) [m2] areas of the nodes of a surface: a quarter of each facet to each of its corners."""
    facets = facet_areas(points)
    areas = np.zeros(points.shape[:2])
    for i in (0, 1):
        for j in (0, 1):
            areas[i : i + facets.shape[0], j : j + facets.shape[1]] += facets / 4
    return areas.ravel()
