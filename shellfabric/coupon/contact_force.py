"""Contact force of a crossover whose yarns resist bending, for the threshold of slip alone (equations:
docs/theory-panel.md, "Yarn pull-out"). Tensions and forces on the nodes stay those of the flexible
cell, whose yarns press back under tension only.
"""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.special import ellipe, ellipk

from fabrics.base.checks import FloatArray
from shellfabric.cell.crossover_kernels import VARIATIONAL, work_share
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.cell.state import CellYarn

FORCES = 240  # contact forces at which the heights are tabulated, from 0 to the largest
BISECTIONS = 60


def centreline(yarn: CellYarn, w: FloatArray, h: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compute (S, dS/dh) [m], [-] of a yarn of the height h [m] over the length 2 w [m]: a cosine where
    it changes sides, straight on the rest, as `yarn_kernels.floating`."""
    k = 0.5 * pi * h / w
    E = ellipe(-(k**2))
    K = ellipk(-(k**2))
    slope = np.where(k > 0, 2 * (E - K) / np.where(k > 0, k, 1.0), 0.0)
    straight = (1 - yarn.turning) * 2 * w
    return yarn.turning * (4 * w / pi * E) + straight, yarn.turning * slope


def heights(yarn: CellYarn, bending: float, stretch: FloatArray, force: FloatArray) -> FloatArray:
    """Solve for the height (stretches, forces) [m] of a yarn at the stretches and under the contact
    forces [N].

    Parameters
    ----------
    yarn : of `CellModel.yarns`
    bending : [N m2]
    """
    w0 = yarn.w
    S0 = yarn.S0
    EA = yarn.EA
    h0 = yarn.h0
    w = w0 * stretch[:, None] * np.ones_like(force)
    # what floats is not bent
    stiffness = yarn.turning * bending * pi**4 / (16 * w0**3)
    low = np.zeros_like(w)
    high = np.full_like(w, h0 + S0)
    for _ in range(BISECTIONS):  # the force that a yarn carries rises with its height
        h = 0.5 * (low + high)
        S, slope = centreline(yarn, w, h)
        above = (
            EA * np.maximum(S / S0 - 1, 0) * slope + stiffness * (h - h0)
            > work_share(VARIATIONAL) * force
        )
        low = np.where(above, low, h)
        high = np.where(above, h, high)
    return 0.5 * (low + high)


def compression(yarn: CellYarn, force: FloatArray) -> FloatArray:
    """Compute the compression [m] of a yarn at the contact forces [N]."""
    if yarn.a == 0:
        return np.zeros_like(force)
    return yarn.a - yarn.b * (np.maximum(force, 1e-300) + yarn.shift) ** (-1 / 3)


def contact_forces(
    model: CellModel,
    bending: tuple[float, float],
    stretch1: FloatArray,
    stretch2: FloatArray,
    largest: float,
) -> FloatArray:
    """Solve for the contact force (n1, n2) [N] of the cell at all pairs of stretches of warp and
    weft.

    The energy of a cosine of the height h against its height h0 at rest over the length 2 w of the
    cell is U = K (h - h0)^2 / 2, K = B pi^4 / (16 w^3), so that each yarn is in balance at T dS/dh
    + K (h - h0) = q F with q = pi / 4. Compression and closure are those of the cell
    (`cell.crossover_kernels`).

    Parameters
    ----------
    bending : (warp, weft) [N m2]
    stretch1, stretch2 : (n1,), (n2,) [-]
    largest : [N] of the forces that are looked for
    """
    force = largest * np.linspace(0, 1, FORCES) ** 2
    warp, weft = model.yarns
    h1 = heights(warp, bending[0], stretch1, force)
    h2 = heights(weft, bending[1], stretch2, force)
    own = h1 + compression(warp, force) + model.crossover_gap - sum(model.h0)
    other = h2 + compression(weft, force)
    found = np.empty((stretch1.size, stretch2.size))
    # what closes the cell rises with the force: where is it zero?
    for row, out in zip(own, found):
        r = row + other
        n = np.clip(np.argmax(r > 0, axis=1), 1, None)
        n[r[:, -1] <= 0] = force.size - 1
        at = np.arange(stretch2.size)
        before = r[at, n - 1]
        after = r[at, n]
        part = np.clip(-before / np.where(after > before, after - before, 1.0), 0.0, 1.0)
        out[:] = np.where(r[:, 0] >= 0, 0.0, force[n - 1] + part * (force[n] - force[n - 1]))
    return found


def crossing_tension(table: CellTable, bending: tuple[float, float]) -> FloatArray:
    """Compute the tension (n2,) [N] of the weft at the stretches of the table, where the warp that
    it crosses has none."""
    model = table.model
    slack = table.stretch1[:1]
    weft = model.yarns[1]
    force = contact_forces(model, bending, slack, table.stretch2, _largest(table))[0]
    h = np.array(
        [heights(weft, bending[1], x[None], F[None])[0, 0] for x, F in zip(table.stretch2, force)]
    )
    S, _ = centreline(weft, weft.w * table.stretch2, h)
    return weft.EA * np.maximum(S / weft.S0 - 1, 0)


def stiff_table(table: CellTable, bending: tuple[float, float]) -> FloatArray:
    """Return the contact forces (n1, n2) [N] on the grid of a table; those of the table if no yarn
    resists bending."""
    if not any(bending):
        return table.values["F"]
    return contact_forces(table.model, bending, table.stretch1, table.stretch2, _largest(table))


def _largest(table):
    """[N] above every contact force of a table."""
    return float(table.values["F"].max()) + 2 * max(
        yarn.strength for yarn in table.model.fabric.weave.yarns
    )
