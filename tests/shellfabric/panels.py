"""Panels that tests share, and what panels store by definition: plain numpy, whole or a part, graded or not."""

from functools import cache
from math import perm

import numpy as np

from fabrics import catalogue
from fabrics.ply_laws import packing_stiffness
from shellfabric.block.block import Backing
from shellfabric.cell import packed_table
from shellfabric.cell.model import CellModel
from shellfabric.membrane import edges
from shellfabric.membrane.bending_kernels import CLAMPED_END, FREE_END, SYMMETRY_END
from shellfabric.membrane.grading import tributary
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics
from shellfabric.membrane.trellis_kernels import FADE_STRETCH

INF = np.inf
SERIAL = Numerics(threads=1)
UNDAMPED = Numerics(stretch_viscosity=0.0, threads=1)
COARSER = ((9, 1), (13, 2), (INF, 4))  # gradings about the impact point, of panels of 60 mm
FINER = ((7, 1 / 3), (13, 1), (INF, 2))
HALF = ((7, 0.5), (INF, 1))
STEPPED = ((7, 0.25), (9, 0.5), (13, 1), (INF, 4))
THIRD = ((8, 1 / 3), (INF, 2))
BLOCK = Backing(size=(0.06, 0.06, 0.03), min_size=3e-3, refined_depth=6e-3, growth=1.5)


@cache
def table(form="variational", size=121):
    """A table of S-720."""
    return CellModel(catalogue.load("S-720").with_effective_density(), cell_formulation=form).table(
        size
    )


def make_panel(side=0.03048, *, cell_formulation="variational", **changes):
    """A small panel, of 24 x 24 crossovers as a whole."""
    defaults = {
        "table": changes["table"] if "table" in changes else table(cell_formulation),
        "opening": (side, side),
        # the criterion is tested by the strength of the fabric's yarns
        "length_effect": False,
    }
    return Panel(**defaults | changes)


def rest(panel):
    """(ni+1, nj+1, 3) [m] places of the nodes at rest."""
    X, Y = panel.coordinates()
    return np.stack([X, Y, np.zeros_like(X)], axis=-1)


def grid(array, panel):
    """(ni+1, nj+1) view of an array of slots."""
    shape = panel.counts[0] + 1, panel.counts[1] + 1
    return array[: shape[0] * shape[1]].reshape(shape)


def set_nodal(components, vectors):
    """Write vectors (ni+1, nj+1, 3) of nodes into the flat arrays of a state."""
    for part, component in zip(components, np.moveaxis(vectors, -1, 0)):
        part[: component.size] = component.ravel()


def plain_potential(table, stretch1, stretch2):
    """[J] of crossovers by the table's spline; above the table as `table_kernels` has it, below it as at its edge."""

    def derivative(c, place, orders):
        p, q = place
        m, n = orders
        terms = ((a, b) for a in range(m, 3) for b in range(n, 3))
        return sum(
            c[3 * a + b] * perm(a, m) * p ** (a - m) * perm(b, n) * q ** (b - n) for a, b in terms
        )

    axes = (stretch1, table.stretch1), (stretch2, table.stretch2)
    places = np.array([np.maximum((stretch - x[0]) / (x[1] - x[0]), 0) for stretch, x in axes])
    cell = [np.minimum(place.astype(int), n - 1) for place, n in zip(places, table.spline.shape)]
    inside = np.minimum(places - cell, 1)
    over = np.maximum(places - cell - 1, 0)
    cells = np.moveaxis(table.spline[tuple(cell)], -1, 0)
    corner = table.spline[-1, -1]
    far = over / (1 + over * np.reshape(table.steps, (2, 1, 1)) / packed_table.REACH)
    W = derivative(cells, inside, (0, 0)) + far.prod(axis=0) * derivative(cells, inside, (1, 1))
    for k, orders in enumerate(((1, 0), (0, 1))):
        slope, curvature = (derivative(corner, (1.0, 1.0), n * np.array(orders)) for n in (1, 2))
        W += (
            far[k] * (derivative(cells, inside, orders) - slope)
            + slope * over[k]
            + 0.5 * curvature * over[k] ** 2
        )
    return W


def potential_grid(table):
    """What `relaxation_kernels.potential` takes besides two stretches, of a table of 61 x 61."""
    along = (table.stretch1[0], 1 / table.steps[0], 59)
    return table.spline.reshape(-1, 9), *along, table.stretch2[0], 1 / table.steps[1], 59


def beside(values):
    """Sums of what is on either side of each line, of values between the lines."""
    return np.pad(values, ((0, 1), (0, 0))) + np.pad(values, ((1, 0), (0, 0)))


def plain_energies(panel, x):
    """[J] of yarns, trellis, bending and packing with the nodes at x (ni+1, nj+1, 3), from the definitions alone."""
    sides = panel.sides or tuple(map(np.full, panel.counts, panel.spacing))
    stretches = []
    crossing = []
    lengths = []
    sums = []
    bending = 0.0
    # arrays of edges: along, across
    for axis, count in enumerate((panel.weave.warp_count, panel.weave.weft_count)):
        own = sides[axis][:, None]
        yarns = count * tributary(sides[1 - axis])
        edge = np.diff(np.moveaxis(x, axis, 0), axis=0) / own[..., None]
        stretch = np.linalg.norm(edge, axis=-1)
        length = own * yarns
        t = edge / stretch[..., None]
        turns = np.sum((t[1:] - t[:-1]) ** 2, axis=-1) / (own[1:] + own[:-1])
        for end, kind in zip((0, -1), edges.yarn_ends(panel)[axis]):
            along = t[end, :, axis]
            energy = {FREE_END: 0 * along, CLAMPED_END: 2 - 2 * along, SYMMETRY_END: 1 - along**2}[
                kind
            ]
            turns = np.vstack([turns, energy / own[end]])
        bending += panel.bending[axis] * np.sum(turns * yarns)
        sums.append(edge[:, 1:] + edge[:, :-1])
        stretches.append(stretch)
        lengths.append(length)
        # the mean of the edges that cross a line, each for its length
        crossing.append((beside(0.5 * (stretch[:, 1:] + stretch[:, :-1]) * own) / beside(own)).T)
    W = (
        plain_potential(panel.table, stretches[0], crossing[1]),
        plain_potential(panel.table, crossing[0], stretches[1]),
    )
    yarns = sum(
        0.25 * np.sum(length * each) / w for length, each, w in zip(lengths, W, panel.weave.w)
    )
    return yarns, plain_trellis(panel, sides, stretches, sums), bending, plain_packing(panel, x)


def plain_packing(panel, x):
    """[J] of packed elements, from the diagonals of each at x and at rest."""
    now = areas(x)
    full = areas(rest(panel))
    share = panel.packed_area
    stiffness = packing_stiffness(panel.fabric)
    missing = np.maximum(share - now / full, 0.0)
    return float(np.sum(full * stiffness * missing**2 / (2 * share)))


def areas(x):
    """(ni, nj) [m2] half the cross product of the diagonals of each element."""
    one = x[1:, 1:] - x[:-1, :-1]
    other = x[:-1, 1:] - x[1:, :-1]
    return 0.5 * np.linalg.norm(np.cross(one, other), axis=-1)


def plain_trellis(panel, sides, stretches, sums):
    """[J] of the shear between the mean edges of quadrilaterals: the integral of a modulus that rises from G1 at gamma1
    to G2 at gamma2. Drawn together, mean edges count as longer than they are."""
    if not panel.trellis:
        return 0.0
    shear = panel.fabric.shear
    lengths = [stretch[:, 1:] + stretch[:, :-1] for stretch in stretches]
    lengths = [
        s + np.maximum(2 * FADE_STRETCH - s, 0) ** 2 / (4 * FADE_STRETCH)
        for s in (lengths[0], lengths[1].T)
    ]
    angle = np.arcsin(
        abs(np.sum(sums[0] * sums[1].swapaxes(0, 1), axis=-1)) / np.prod(lengths, axis=0)
    )
    beyond1, beyond2 = (np.maximum(angle - kink, 0) for kink in (shear.gamma1, shear.gamma2))
    rise = (shear.G2 - shear.G1) / (shear.gamma2 - shear.gamma1)
    U = 0.5 * shear.G1 * angle**2 + rise / 6 * (beyond1**3 - beyond2**3)
    return panel.weave.thickness * float(np.sum(np.multiply.outer(*sides) * U))
