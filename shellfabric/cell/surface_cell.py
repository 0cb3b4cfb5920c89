"""A crossover's cell straight from a 3D response surface: no law of compression and no centreline in
between (docs/theory-cell.md, "Cell from a 3D response surface").

direct         the tables are the forces T1, T2 of `fabrics.surface.ResponseSurface` themselves
variational    the forces are the gradient of the potential that is next to T1, T2 in the sense of
               least squares; the rest of the surface is reported as a number

Inside the surface's rectangle of stretches they are interpolated monotonically along each direction:
no overshoot where contact begins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fabrics.base.checks import FloatArray, refuse
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from fabrics.weave import arc_length
from shellfabric.cell.coefficients import grid
from shellfabric.cell.crossover_kernels import free_height
from shellfabric.cell.model import CellModel, CellTable

FORMS = ("variational", "direct")
_SLACK = 1e-4  # share of the strength below which a sampled force counts as none
_FLOOR = 0.05  # share of the strength below which differences count as if the force were that
# least weight of the extension, and [-] the stretch over which it falls to 1 / e
_TRUST = 0.03
_TRUSTED = 4e-3
_LEAST_FADE = 2e-3  # [-] stretch over which contact is lost at the least


@dataclass(frozen=True)
class SurfaceCell:
    """One crossover of a fabric as its 3D model has it.

    Parameters
    ----------
    fabric : Fabric that the surface is of
    surface : ResponseSurface about rest, d = 0, in both directions
    cell_formulation : "variational" or "direct"

    Raises
    ------
    InputError : unknown formulation, a surface of another fabric, or one whose rectangle does not
        hold rest
    """

    fabric: Fabric
    surface: ResponseSurface
    cell_formulation: str = "variational"

    def __post_init__(self):
        if self.cell_formulation not in FORMS:
            refuse(self, "cell_formulation", " or ".join(FORMS))
        self.fabric.weave.require_plain("a surface sampled from one crossover")
        if self.surface.fabric and self.surface.fabric != self.fabric.name:
            raise InputError(
                key="surface", value=self.surface.fabric, allowed=f"one of {self.fabric.name}"
            )
        for name, axis in (("d1", self.surface.d1), ("d2", self.surface.d2)):
            if not axis[0] <= 0 < axis[-1]:
                given = f"{axis[0]:.3g} .. {axis[-1]:.3g} m"
                raise InputError(
                    key=f"surface.{name}", value=given, allowed="a range that begins at or below 0"
                )

    @property
    def region(self) -> tuple[tuple[float, float], ...]:
        """((lowest, highest), (lowest, highest)) stretches that the surface was sampled over, of
        warp and weft."""
        axes = zip((self.surface.d1, self.surface.d2), self.fabric.weave.w)
        return tuple((1 + axis[0] / w, 1 + axis[-1] / w) for axis, w in axes)

    def solve(self, stretch1: FloatArray, stretch2: FloatArray) -> dict:
        """Interpolate the forces at the stretches of a grid.

        Parameters
        ----------
        stretch1, stretch2 : (n1,), (n2,) [-] rising

        Returns
        -------
        dict of (n1, n2) arrays: T1, T2 [N], of the surface or its extension
        """
        from scipy.interpolate import PchipInterpolator

        stretches = (np.asarray(stretch1, float), np.asarray(stretch2, float))
        weave = self.fabric.weave
        clamped = [np.clip(x, *bounds) for x, bounds in zip(stretches, self.region)]
        phi = (
            self._contact(0, stretches[0], clamped[1])
            * self._contact(1, stretches[1], clamped[0]).T
        )
        values = {}
        for m, (name, sampled) in enumerate((("T1", self.surface.T1), ("T2", self.surface.T2))):
            strength = weave.yarns[m].strength
            sampled = np.where(np.abs(sampled) < _SLACK * strength, 0.0, sampled)
            inside = PchipInterpolator(self.surface.d1, sampled)((clamped[0] - 1) * weave.w1)
            inside = PchipInterpolator(self.surface.d2, inside, axis=1)((clamped[1] - 1) * weave.w2)
            here, there = (
                np.expand_dims(self._alone(m, x[m]), 1 - m) for x in (stretches, clamped)
            )
            values[name] = np.maximum(here + phi * (inside - there), 0.0)
        return values

    def table(self, n: int = 201) -> CellTable:
        """Fill tables of n x n stretches over the range of the cell, wider than the surface's
        region."""
        bounds = CellModel(self.fabric, cell_model="decoupled").range()
        x, y = (grid(*pair, n) for pair in bounds)
        values = self.solve(x, y)
        w1, w2 = self.fabric.weave.w
        per = 2 * w1 * (x[1] - x[0]), 2 * w2 * (y[1] - y[0])
        floor = np.array(
            [_FLOOR * p * yarn.strength for p, yarn in zip(per, self.fabric.weave.yarns)]
        )
        beyond = [
            np.abs(axis - np.clip(axis, *bounds)) for axis, bounds in zip((x, y), self.region)
        ]
        trust = np.maximum(np.exp(-np.maximum(beyond[0][:, None], beyond[1]) / _TRUSTED), _TRUST)
        W, fx, fy, residual = potential(values["T1"] * per[0], values["T2"] * per[1], floor, trust)
        values["W"] = W
        if self.cell_formulation == "variational":
            values["N1"] = fx / per[0]
            values["N2"] = fy / per[1]
        else:
            values["N1"] = values["T1"]
            values["N2"] = values["T2"]
        return CellTable.of(self, x, y, values, fx, fy, residual)

    def _alone(self, m, stretch):
        """[N] tension of yarn m that crosses nothing."""
        weave = self.fabric.weave
        return np.maximum(weave.yarns[m].EA * (2 * weave.w[m] * stretch / weave.S0[m] - 1), 0.0)

    def _contact(self, m, stretch, others):
        """(n, k) the share phi of contact that is left at n stretches of yarn m, for k stretches of
        the other."""
        lowest = self.region[m][0]
        lost = np.minimum([self._lost(m, other) for other in others], lowest - _LEAST_FADE)
        return np.clip((stretch[:, None] - lost) / (lowest - lost), 0.0, 1.0)

    def _lost(self, m, other):
        """Stretch of yarn m below which it leaves the other yarn, which has the stretch `other` and
        bears nothing."""
        weave = self.fabric.weave
        height = sum(weave.h0) - free_height(other * weave.w[1 - m], weave.S0[1 - m])
        low = 0.5
        high = weave.S0[m] / (2 * weave.w[m])
        for _ in range(60):  # the length at this height rises with the stretch
            middle = 0.5 * (low + high)
            if arc_length(middle * weave.w[m], height) < weave.S0[m]:
                low = middle
            else:
                high = middle
        return low


def potential(
    fx: FloatArray, fy: FloatArray, floor: FloatArray, trust: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Fit the potential whose slopes are next to given ones, by least squares of the relative
    difference.

    Parameters
    ----------
    fx, fy : (n1, n2) [J] slopes times the spacing at the nodes of a uniform grid
    floor : (2,) [J] slopes below which the difference is taken relative to these
    trust : (n1, n2) [-] weight of the slopes at the nodes

    Returns
    -------
    W : (n1, n2) [J], 0 where there is neither slope
    wx, wy : (n1, n2) [J] its slopes: those given, and half of what the fit changes on either side
        of a node
    residual : [-] rms of these changes over the rms of the slopes, where trust is full
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.linalg import spsolve

    number = np.arange(fx.size).reshape(fx.shape)
    rises = (_rises(fx), _rises(fy.T).T)
    low = np.concatenate([number[:-1].ravel(), number[:, :-1].ravel()])
    high = np.concatenate([number[1:].ravel(), number[:, 1:].ravel()])
    rise = np.concatenate([part.ravel() for part in rises])
    trusted = np.concatenate(
        [np.minimum(trust[:-1], trust[1:]).ravel(), np.minimum(trust[:, :-1], trust[:, 1:]).ravel()]
    )
    weight = (
        np.concatenate([1 / (np.abs(part).ravel() + least) for part, least in zip(rises, floor)])
        * trusted
    )
    sides = np.arange(low.size)
    G = coo_matrix(
        (np.r_[-weight, weight], (np.r_[sides, sides], np.r_[low, high])), (low.size, fx.size)
    ).tocsc()
    free = np.flatnonzero((fx.ravel() != 0) | (fy.ravel() != 0))
    W = np.zeros(fx.size)
    part = G[:, free]
    W[free] = spsolve((part.T @ part).tocsc(), part.T @ (weight * rise))
    change = W[high] - W[low] - rise
    first, second = (c.reshape(r.shape) for c, r in zip(np.split(change, [rises[0].size]), rises))
    full = trusted == 1.0
    residual = float(np.sqrt(np.mean(change[full] ** 2) / np.mean(rise[full] ** 2)))
    return (
        W.reshape(fx.shape),
        _corrected(fx, fy, first),
        _corrected(fy.T, fx.T, second.T).T,
        residual,
    )


def _rises(f):
    """(n1-1, n2) rise of a function along the first direction from its slopes f, by the trapezoid
    with its end term."""
    turn = np.gradient(f, axis=0)
    return 0.5 * (f[:-1] + f[1:]) + (turn[:-1] - turn[1:]) / 12


def _corrected(f, other, change):
    """(n1, n2) slopes f with the mean change of the rises beside a node; none where there is no
    other slope either."""
    padded = np.concatenate([change[:1], change, change[-1:]])
    return np.where((f != 0) | (other != 0), f + 0.5 * (padded[:-1] + padded[1:]), 0.0)
