"""A piece of fabric cut from a weave for a quasi-static test: its yarns as a grid, whatever the
outline.

The grid always runs along the yarns, also in a coupon that is cut on the bias: an element across
the yarns would be kept from shearing by the stiffness of the yarns themselves (tension locking),
which here is a thousand times that of the trellis. A cut across the yarns is then a staircase, as
it is in the fabric.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from fabrics.base import sums
from fabrics.base.checks import BoolArray, FloatArray
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellTable
from shellfabric.coupon import relaxation_kernels as kernels
from shellfabric.coupon.state import Segments
from shellfabric.loop import memory
from shellfabric.membrane.failure import mean_weights

if TYPE_CHECKING:
    from fabrics.weave import Weave


# [bytes] of resident memory at the peak, of bias coupons of S-720 of three sizes: 77 of each point
# of the grid that a coupon is cut from, then less than 110 of each element while it is relaxed, and 32
# for each step that is kept; `ELEMENT` is of 25 steps
GRID_POINT = 80.0
ELEMENT = 900.0


@dataclass(frozen=True)
class Coupon:
    """Fabric in its plane, as lists of yarn segments and of the quadrilaterals between them.

    Parameters
    ----------
    table : CellTable of the fabric, in the variational form (forces are the gradient of an energy)
    points : (n, 2) [m] nodes at rest
    edges : ((e1, 2), (e2, 2)) node numbers of the warp and of the weft segments
    cells : ((e1,), (e2,)) crossovers that a segment stands for; 1 inside, 1/2 on the outline, over
        the number of elements in a crossover
    across : ((e1, 4), (e2, 4)) segments of the other family that meet a segment's ends; -1 where
        there is none
    quads : (q, 4) node numbers of the woven quadrilaterals: origin, along warp, opposite, along
        weft
    spacing : (dX, dY) [m] lengths of a segment at rest
    trellis : whether the fabric's shear law acts; a fabric without one has none
    yarn_share : [-] share of the yarns' stiffness with which they are computed
        (`quasistatic.yarn_share`)

    Raises
    ------
    InputError : a table in another form
    """

    table: CellTable
    points: np.ndarray
    edges: tuple[np.ndarray, np.ndarray]
    cells: tuple[np.ndarray, np.ndarray]
    across: tuple[np.ndarray, np.ndarray]
    quads: np.ndarray
    spacing: tuple[float, float]
    trellis: bool = True
    yarn_share: float = 1.0

    def __post_init__(self):
        if self.table.model.cell_formulation != "variational":
            raise InputError(
                key="cell_formulation",
                value=self.table.model.cell_formulation,
                allowed="variational in a quasi-static run",
            )

    @property
    def weave(self) -> Weave:
        return self.table.model.fabric.weave

    @cached_property
    def _segments(self):
        """What the kernels take, with scratch."""
        table = self.table
        weave = self.weave
        counts = [len(edges) for edges in self.edges]
        volume = 0.0
        law = {"G1": 0.0, "G2": 0.0, "gamma1": 0.5, "gamma2": 1.0}
        shear = table.model.fabric.shear
        if self.trellis and shear:
            volume = self.spacing[0] * self.spacing[1] * weave.thickness
            law = {name: getattr(shear, name) for name in law}
        grid = []
        for axis, step in zip((table.stretch1, table.stretch2), table.steps):
            grid += [axis[0], 1 / step, axis.size - 2.0]
        return Segments(
            nodes=[np.ascontiguousarray(edges) for edges in self.edges],
            cells=[np.ascontiguousarray(cells) for cells in self.cells],
            across=[np.ascontiguousarray(across) for across in self.across],
            quads=np.ascontiguousarray(self.quads),
            length=self.spacing,
            potential=self.yarn_share * table.spline.reshape(-1, 9),
            grid=tuple(grid),
            half_width=weave.w,
            yarn_length=weave.S0,
            stiffness=tuple(self.yarn_share * yarn.EA for yarn in weave.yarns),
            volume=volume,
            **law,
            stretch=[np.zeros(n) for n in counts],
            direction=[np.zeros((n, 2)) for n in counts],
            pull=[np.zeros(n) for n in counts],
            row=[np.zeros(n) for n in counts],
        )

    def forces(self, x: FloatArray) -> tuple[FloatArray, FloatArray, tuple[float, float]]:
        """Compute forces (n, 2) [N], bounds (n,) [N/m] on rows of the stiffness, energies (yarns,
        trellis) [J] at x (n, 2)."""
        f, bound, stored, sheared = kernels.forces(x, self._segments)
        return f, bound, (stored, sheared)

    def spread(self, u: FloatArray, held: BoolArray) -> FloatArray:
        """Spread a motion u of the held nodes to all, (n, 2) [m]: each free node moves as its
        neighbours' mean."""
        n = len(self.points)
        pairs = np.concatenate(self.edges)
        joined = sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(n, n))
        joined = (joined + joined.T).tocsr()
        laplace = (sparse.diags(np.asarray(joined.sum(axis=1)).ravel()) - joined).tocsr()
        out = np.array(u, float)
        free = np.flatnonzero(~held)
        drawn = joined[free][:, np.flatnonzero(held)] @ out[held]
        # not by a factorization, whose last bits would set by the processor where a relaxation begins
        out[free] = sums.solve_laplace(laplace[free][:, free], drawn)
        return out

    def shear_angles(self, x: FloatArray) -> FloatArray:
        """Compute the shear angles (q,) [rad] of the quadrilaterals, positive where the angle
        between warp and weft has closed."""
        return kernels.angles(x, self.quads, *self.spacing)

    def stretches(self, x: FloatArray) -> tuple[FloatArray, ...]:
        """Compute the stretches ((e1,), (e2,)) [-] of the warp and the weft segments."""
        return tuple(
            sums.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1) / length
            for edges, length in zip(self.edges, self.spacing)
        )

    def tensions(self, x: FloatArray) -> tuple[FloatArray, ...]:
        """Compute the tensions ((e1,), (e2,)) [N] of the yarns in the warp and the weft
        segments."""
        stretches = self.stretches(x)
        model = self.table.model
        found = []
        for m, (own, other) in enumerate(zip(stretches, stretches[::-1])):
            there = self.across[m] >= 0
            count = there.sum(axis=1)
            mean = np.where(there, other[self.across[m]], 0.0).sum(axis=1) / np.maximum(count, 1)
            alone = model.alone(m, own)
            own = np.where(count > 0, own, 1.0)
            mean = np.where(count > 0, mean, 1.0)
            if m == 0:
                crossed = model.solve(own, mean)["T1"]
            else:
                crossed = model.solve(mean, own)["T2"]
            found.append(self.yarn_share * np.where(count > 0, crossed, alone))
        return tuple(found)

    def mean_tensions(self, x: FloatArray) -> tuple[FloatArray, ...]:
        """Average the tensions over the failure length about each segment, ((e1,), (e2,)) [N]: what
        is held against the strength, M of `membrane.failure_kernels`; without its low-pass, since the
        test is quasi-static."""
        return tuple(mean @ T for mean, T in zip(self._means, self.tensions(x)))

    @cached_property
    def _means(self):
        """(warp, weft) sparse matrices (e, e) of the weights of the segments beside each
        segment."""
        length = self.table.model.fabric.failure_length
        means = []
        for family, (edges, cells) in enumerate(zip(self.edges, self.cells)):
            along = (self.points[edges[0, 1]] - self.points[edges[0, 0]]) / self.spacing[family]
            middles = self.points[edges].mean(axis=1)
            side = self.spacing[1 - family]
            away = middles - middles[0]
            places = np.rint(
                np.stack(
                    [
                        sums.multiply(away, along) / self.spacing[family],
                        sums.multiply(away, (-along[1], along[0])) / side,
                    ]
                )
            )
            reach = int(length / side) + 1
            first, weights = mean_weights(side * np.arange(2 * reach + 1), length, mirrored=False)
            beside = first[reach] + np.arange(weights.shape[1])  # of the line in the middle
            i, j = (places - places.min(axis=1, keepdims=True)).astype(int)
            number = np.full((i.max() + 1, j.max() + 1 + 2 * reach), -1)
            number[i, j + reach] = np.arange(i.size)
            near = number[i[:, None], j[:, None] + beside]
            part = np.where(near >= 0, weights[reach] * cells[near], 0.0)
            part /= part.sum(axis=1, keepdims=True)
            entries = np.repeat(np.arange(i.size), near.shape[1]), np.maximum(near, 0).ravel()
            means.append(sparse.csr_matrix((part.ravel(), entries), shape=(i.size, i.size)))
        return means


def mesh_coupon(
    table: CellTable,
    outline: Callable,
    reach: float,
    *,
    angle: float = 0.0,
    elements_per_crossover: int = 1,
    offset: tuple[float, float] = (0.0, 0.0),
    woven: Callable | None = None,
    trellis: bool = True,
    yarn_share: float = 1.0,
) -> Coupon:
    """Mesh a coupon about the origin, cut out of the weave.

    Parameters
    ----------
    table : CellTable in the variational form
    outline : outline(x, y) -> bool array, which points [m] lie in the coupon, its edge included
    reach : [m] of the farthest point of the coupon from the origin
    angle : [rad] from the x axis to the warp
    elements_per_crossover : along each side
    offset : (along warp, along weft) [elements] of the grid's origin; 0.5 puts the middle of an
        element on the origin
    woven : woven(x, y) -> (bool array, bool array), whether warp and weft are present at points
        [m]; None: everywhere. Yarns that have been removed leave the others alone
    trellis, yarn_share : see Coupon

    Raises
    ------
    InputError : no element lies inside the outline, or more of them than memory holds
    """
    m = elements_per_crossover
    if m < 1 or m != int(m):
        raise InputError(key="elements_per_crossover", value=m, allowed="1, 2, 3, ...")
    spacing = tuple(2 * w / m for w in table.model.fabric.weave.w)
    half = tuple(int(reach / side) + 2 for side in spacing)
    points = (2 * half[0] + 1) * (2 * half[1] + 1)
    memory.check(GRID_POINT * points, f"a grid of {points:,} points", "length", reach)
    X, Y = np.meshgrid(
        *(side * (np.arange(-n, n + 1) + shift) for side, n, shift in zip(spacing, half, offset)),
        indexing="ij",
    )
    c = np.cos(angle)
    s = np.sin(angle)
    x = c * X - s * Y
    y = s * X + c * Y
    present = _present_yarns(x, y, outline, woven)
    # an edge stands for half of each element beside it in which its yarn is present
    count = _beside(*present)
    number = -np.ones(X.shape, int)
    edges = []
    used = np.zeros(X.shape, bool)
    for part, (di, dj) in zip(count, ((1, 0), (0, 1))):
        i, j = np.nonzero(part)
        edges.append((i, j, i + di, j + dj))
        used[i, j] = used[i + di, j + dj] = True
    if not used.any():
        raise InputError(key="coupon", allowed="at least one crossover large")
    number[used] = np.arange(used.sum())
    lines = [np.stack([number[i, j], number[k, l]], axis=1) for i, j, k, l in edges]
    # a yarn is crossed where an element beside it holds the other family too
    both = present[0] & present[1]
    memory.check(ELEMENT * both.sum(), f"{both.sum():,} elements", "length", reach)
    is_crossed = [(part > 0)[edge[:2]] for part, edge in zip(_beside(both, both), edges)]
    across = tuple(
        _meeting(lines[k], is_crossed[k], lines[1 - k], is_crossed[1 - k], used.sum())
        for k in (0, 1)
    )
    i, j = np.nonzero(both)
    quads = np.stack(
        [number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]], axis=1
    )
    points = np.stack([x[used], y[used]], axis=1)
    cells = tuple(part[part > 0] / (2 * m * m) for part in count)
    return Coupon(table, points, tuple(lines), cells, across, quads, spacing, trellis, yarn_share)


def _present_yarns(x, y, outline, woven):
    """[(elements), (elements)] bool: where warp and weft are present, of the elements that lie
    whole in the outline."""
    inside = outline(x, y)
    full = inside[:-1, :-1] & inside[1:, :-1] & inside[1:, 1:] & inside[:-1, 1:]
    centre = [0.25 * (v[:-1, :-1] + v[1:, :-1] + v[1:, 1:] + v[:-1, 1:]) for v in (x, y)]
    if woven is None:
        return [full, full]
    return [full & part for part in woven(*centre)]


def _beside(warp, weft):
    """Number of elements with warp beside each warp edge, and of elements with weft beside each
    weft edge."""
    count = [
        np.zeros((warp.shape[0], warp.shape[1] + 1), int),
        np.zeros((weft.shape[0] + 1, weft.shape[1]), int),
    ]
    count[0][:, :-1] += warp
    count[0][:, 1:] += warp
    count[1][:-1, :] += weft
    count[1][1:, :] += weft
    return count


def _meeting(edges, crossed, others, others_crossed, nodes):
    """(e, 4): edges of the other family at the ends of each edge, where both are crossed; -1 where
    there is none."""
    at = -np.ones((nodes, 2), int)
    numbers = np.flatnonzero(others_crossed)
    at[others[numbers, 0], 1] = numbers
    at[others[numbers, 1], 0] = numbers
    found = at[edges].reshape(-1, 4)
    found[~crossed] = -1
    return found
