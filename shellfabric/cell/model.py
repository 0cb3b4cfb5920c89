"""The crossover as an object, and its table: tensions of the two yarns over a uniform grid of their
stretches (docs/theory-cell.md, "Unit cell").

The stretch 1 is a node: fabric at rest has the very forces of the cell at rest. Below the lowest
stretch the lone yarn fills the cell and contact is lost, whatever the other does: looking up at the
edge is exact. Above the highest the yarn has failed; a yarn that may not fail goes on linearly.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import hypot, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, refuse
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.run_cache import ADDED_LATER
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.weave import arc_length
from shellfabric.cell import coefficients, fill_kernels, packed_table
from shellfabric.cell import crossover_kernels as kernels
from shellfabric.cell.state import CellYarn, Crossover

FORMS = {"equilibrium": kernels.EQUILIBRIUM, "variational": kernels.VARIATIONAL}
MODELS = ("compressible", "incompressible", "decoupled")
CENTRELINES = ("cosine", "straight")
_CLOSED = 1e-3  # stretch of a cell that has closed up
COLUMNS = ("T1", "T2", "N1", "N2", "F", "h1", "h2", "W")


@dataclass(frozen=True)
class CellModel:
    """One crossover of a fabric (thesis section 4.3.1).

    Parameters
    ----------
    fabric : Fabric
    laws : (CompressionLaw, CompressionLaw) of warp and weft; None takes the fabric's published ones
    crossover_gap : [m] play g between the yarns, closed before they touch (erratum E-16)
    cell_model : "compressible", "incompressible" (d_c = 0) or "decoupled" (the yarns never touch)
    cell_formulation : "variational" (forces are the gradient of W) or "equilibrium" (F = 2 T sin
        alpha of the thesis; forces T). The default is the variational one for its energy: what its
        forces do is what the cell stores. The forces of equilibrium are no gradient, and do work
        that nothing stores
    centreline : "cosine" (thesis eq. 4-1), of yarns that touch along most of their length, or
        "straight" from crossing to crossing (Kawabata), of a loose weave; those of a weave with floats
        are always straight
    stiffening : [-] growth of a yarn's resistance to compression with its strain e, by the factor
        1 + stiffening e; 0 is the law of `laws` at every strain
    slack : (warp, weft) [-] strain by which the foot of a yarn's tension curve lies off
        (`yarn_kernels`); 0 is the straight line of the fabric's data
    mean_crossing : whether a weave with crossings of several kinds (3/1 twill, satin) is taken, by the
        mean over them: up to twice as stiff as resolved yarns (docs/weaves.md), which a caller has to
        know of
    reach : how far a table goes beyond straight yarns, in units of the strain at their strength;
        above 1 where yarns do not fail, since forces beyond a table follow its last cell and may
        grow without bound

    Raises
    ------
    InputError : unknown model or form, negative gap, a weave that the cell does not hold for, or a
        compressible cell without laws
    """

    fabric: Fabric
    laws: tuple[CompressionLaw, CompressionLaw] | None = None
    crossover_gap: float = 0.0
    cell_model: str = "compressible"
    cell_formulation: str = "variational"
    centreline: str = "cosine"
    stiffening: float = 0.0
    slack: tuple[float, float] = (0.0, 0.0)
    reach: float = 1.0
    mean_crossing: bool = field(default=False, metadata=ADDED_LATER)

    def __post_init__(self):
        known = {"cell_model": MODELS, "cell_formulation": FORMS, "centreline": CENTRELINES}
        for key, names in known.items():
            if getattr(self, key) not in names:
                refuse(self, key, " or ".join(names))
        if not all(0 <= one < 1 for one in self.slack):
            refuse(self, "slack", "at least 0 and below 1, of warp and weft")
        if not 0 <= self.stiffening < np.inf:
            refuse(self, "stiffening", "at least 0")
        if not 1 <= self.reach < np.inf:
            refuse(self, "reach", "at least 1")
        self._check_weave()
        if not 0 <= self.crossover_gap <= sum(self.h0):
            refuse(self, "crossover_gap", "at least 0 and at most h01 + h02")
        if self.laws is None and self.fabric.laws is None and self.cell_model == "compressible":
            raise InputError(
                f"fabric {self.fabric.name} has no compression law", allowed="given one"
            )

    def _check_weave(self):
        """InputError of a weave that the cell does not hold for."""
        weave = self.fabric.weave
        weave.require_even("the cell of a crossover")
        if not self.mean_crossing:
            weave.require_like_crossings(
                "pinned yarns and the cell of a crossover; shots with crossovers = yarns take others"
            )

    @property
    def straight(self) -> bool:
        """Whether yarns are straight from crossing to crossing: those of a weave with floats always are, as
        they nearly are in 3D (docs/weaves.md)."""
        return self.centreline == "straight" or not self.fabric.weave.pattern.is_plain

    @property
    def used_laws(self) -> tuple[CompressionLaw, ...]:
        """The laws that the cell is solved with."""
        if self.cell_model != "compressible":
            return CompressionLaw.incompressible(), CompressionLaw.incompressible()
        return self.laws or self.fabric.laws or ()

    @property
    def h0(self) -> tuple[float, ...]:
        """[m] heights at rest of warp and weft.

        With floats they are those of the weave, at which its sections touch: the yarns are slack until
        they are straight from crossing to crossing.
        """
        weave = self.fabric.weave
        if not (self.straight and weave.pattern.is_plain):
            return weave.h0
        return tuple(sqrt((S0 / 2) ** 2 - w**2) for w, S0 in zip(weave.w, weave.S0))

    @property
    def yarns(self) -> tuple[CellYarn, ...]:
        """The two yarns as `crossover_kernels` takes them."""
        weave = self.fabric.weave
        found = []
        for m, law in enumerate(self.used_laws):
            shift = 0.0
            if law.form == "regularised":
                shift = law.F0
            yarn = CellYarn(
                w=weave.w[m],
                S0=weave.S0[m],
                EA=weave.yarns[m].EA,
                slack=self.slack[m],
                turning=weave.pattern.interlacings[m],
                h0=self.h0[m],
                a=law.a,
                b=law.b,
                shift=shift,
                stiffening=self.stiffening,
            )
            found.append(yarn)
        return tuple(found)

    def alone(self, family: int, stretch: ArrayLike) -> FloatArray:
        """Compute the tension [N] of a yarn of the family 0 (warp) or 1 (weft) that crosses
        nothing, at stretches of the cell."""
        yarn = self.yarns[family]
        longer = np.maximum(2 * yarn.w * np.asarray(stretch, float) - yarn.S0, 0)
        T = yarn.EA * longer / yarn.S0
        if not yarn.slack:
            return T
        return T + yarn.EA * yarn.slack * np.expm1(-longer / (yarn.S0 * yarn.slack))

    def solve(self, stretch1: ArrayLike, stretch2: ArrayLike) -> dict:
        """Solve the cell at given stretches.

        Parameters
        ----------
        stretch1, stretch2 : array_like [-] current over initial cell length, along warp and weft

        Returns
        -------
        dict of arrays: T1, T2 [N] tensions, N1, N2 [N] forces conjugate to the cell lengths, F [N]
        contact force, h1, h2 [m] heights, W [J] stored energy

        Raises
        ------
        UnstableError : the closing force was not found
        """
        stretch1, stretch2 = np.broadcast_arrays(
            np.asarray(stretch1, float), np.asarray(stretch2, float)
        )
        out = np.empty((8, stretch1.size))
        if not kernels.solve_many(stretch1.ravel(), stretch2.ravel(), self.crossover, out):
            raise UnstableError("the crossover did not close", where=f"fabric {self.fabric.name}")
        return {name: column.reshape(stretch1.shape) for name, column in zip(COLUMNS, out)}

    def solve_grid(self, stretch1: FloatArray, stretch2: FloatArray) -> dict[str, FloatArray]:
        """Solve the cell at all pairs of stretches, each from its neighbour: a tenth of the time of
        `solve`.

        Parameters
        ----------
        stretch1, stretch2 : (n1,), (n2,) [-] rising, along warp and weft

        Returns
        -------
        dict of (n1, n2) arrays, as `solve` gives them

        Raises
        ------
        UnstableError : a cell did not close
        """
        out = np.empty((len(COLUMNS), stretch1.size, stretch2.size))
        if not fill_kernels.fill(stretch1, stretch2, self.crossover, out):
            raise UnstableError(
                "the crossover did not close", where=f"the table of fabric {self.fabric.name}"
            )
        return dict(zip(COLUMNS, out))

    def range(self) -> tuple[tuple[float, float], ...]:
        """Return the ((lowest, highest), (lowest, highest)) stretches of the table, of warp and
        weft."""
        weave = self.fabric.weave
        bounds = []
        for m, (yarn, crossing) in enumerate(zip(weave.yarns, weave.yarns[::-1])):
            w = weave.w[m]
            S0 = weave.S0[m]
            turning = weave.pattern.interlacings[m]
            lowest = max(self._contact_loss(w, S0, turning), _dense_packing(w, crossing))
            # 2 % beyond the stretch at which the yarn alone is at its strength, so that the failure
            # test is inside
            furthest = 1.02 * self.reach * yarn.failure_strain + self.slack[m]
            bounds.append((lowest, S0 / (2 * w) * (1 + furthest)))
        return tuple(bounds)

    def _contact_loss(self, w, S0, turning):
        """Stretch below which a yarn's free height fills the cell; 0 where it cannot.

        A yarn of the length S0 has the height S0 / 2 when the cell has closed up to nothing, and no
        greater one; where it floats, its whole length is in the share `turning` of the crossings' sides.
        """
        full = sum(self.h0) - self.crossover_gap
        if not full > 0:
            return 1.0
        if full >= 0.5 * S0 / turning:
            return 0.0
        straight = S0 / (2 * w)
        if self.straight and turning == 1:
            return sqrt((S0 / 2) ** 2 - full**2) / w

        def too_long(stretch):
            level = (1 - turning) * 2 * stretch * w
            if self.straight:
                return turning * 2 * hypot(stretch * w, full) + level - S0
            return turning * arc_length(stretch * w, full) + level - S0

        if too_long(_CLOSED) >= 0:
            return 0.0
        from scipy.optimize import brentq

        if too_long(straight) > 0:
            return brentq(too_long, _CLOSED, straight)
        return straight

    def table(self, n: int = 201) -> CellTable:
        """Fill a table of n x n stretches; see CellTable.fill."""
        return CellTable.fill(self, n)

    @property
    def crossover(self) -> Crossover:
        """The crossover as `crossover_kernels` takes it."""
        warp, weft = self.yarns
        return Crossover(
            warp=warp,
            weft=weft,
            gap=self.crossover_gap,
            form=FORMS[self.cell_formulation],
            coupled=self.cell_model != "decoupled",
            straight=self.straight,
        )


@dataclass(frozen=True)
class CellTable:
    """Forces of a crossover on a uniform grid of stretches.

    A yarn of the length S0 is never higher than S0 / 2, however narrow its cell. Where that does
    not fill the cell (crimps of about 9 % and more, one yarn far higher than the other), a crossing
    yarn that is pulled straight stays in contact at every stretch. The table then ends where the
    crossing yarns would lie side by side as round solid rods, 2 w Lambda = sqrt(4 A_s / pi), closer
    than which no fabric can be. Below that stretch the energy is that at the edge, and the force
    conjugate to it zero.

    Parameters
    ----------
    model : CellModel, or surface_cell.SurfaceCell
    stretch1, stretch2 : (n1,), (n2,) [-] uniform
    values : dict of (n1, n2) arrays T1, T2, N1, N2, W, and what else `CellModel.solve` gives
    tension1, tension2 : (n1-1, n2-1, 4) [N] bilinear coefficients of T1 and T2 in each cell of the
        grid
    spline : (n1-1, n2-1, 9) [J] biquadratic coefficients of W, of its B-spline
        (`coefficients.spline`), which panels and coupons read. With 201 stretches its forces are
        within 0.2 % of the strength of the cell's, and within 3e-5 in the mean
    residual : [-] rms of the part of a sampled surface's forces that no potential has, over the rms
        force
    """

    model: Any
    stretch1: np.ndarray
    stretch2: np.ndarray
    values: dict
    tension1: np.ndarray = field(repr=False)
    tension2: np.ndarray = field(repr=False)
    spline: np.ndarray = field(repr=False)
    residual: float = 0.0

    @classmethod
    def fill(cls, model: CellModel, n: int = 201) -> CellTable:
        """Solve the cell on n x n stretches over its range (`fill_kernels`).

        Parameters
        ----------
        n : stretches along each side

        Raises
        ------
        InputError : n below 8
        UnstableError : a cell that did not close
        """
        if n < 8:
            raise InputError(key="table_size", value=n, allowed="at least 8")
        x, y = (coefficients.grid(lowest, highest, n) for lowest, highest in model.range())
        return cls.of_values(model, x, y, model.solve_grid(x, y))

    @classmethod
    def straight(cls, model: CellModel, n: int = 8) -> CellTable:
        """Fill the table of straight yarns that do not press on each other, T = E A (stretch - 1):
        nothing is solved."""
        x, y = (coefficients.grid(lowest, highest, n) for lowest, highest in model.range())
        strains = np.meshgrid(np.maximum(x - 1, 0), np.maximum(y - 1, 0), indexing="ij")
        weave = model.fabric.weave
        tensions = [yarn.EA * strain for yarn, strain in zip(weave.yarns, strains)]
        energy = sum(w * T * strain for w, T, strain in zip(weave.w, tensions, strains))
        values = {"W": energy} | {
            f"{letter}{k + 1}": T for k, T in enumerate(tensions) for letter in "TN"
        }
        return cls.of_values(model, x, y, values)

    @classmethod
    def of_values(
        cls, model: CellModel, x: FloatArray, y: FloatArray, values: dict[str, FloatArray]
    ) -> CellTable:
        """Make the table with the stretches x, y (n,) and what `CellModel.solve` gives at all pairs
        of them, (n, n) each."""
        w1, w2 = model.fabric.weave.w
        if model.cell_formulation == "variational":
            fx = values["N1"] * 2 * w1 * (x[1] - x[0])
            fy = values["N2"] * 2 * w2 * (y[1] - y[0])
        else:
            fx, fy = np.gradient(values["W"], edge_order=2)
        return cls.of(model, x, y, values, fx, fy)

    @classmethod
    def of(
        cls,
        model: Any,
        x: FloatArray,
        y: FloatArray,
        values: dict[str, FloatArray],
        fx: FloatArray,
        fy: FloatArray,
        residual: float = 0.0,
    ) -> CellTable:
        """Make the table with the stretches x, y, the values at them, and the slopes fx, fy of W
        per cell of the grid."""
        W = values["W"].copy()
        fx = fx.copy()
        fy = fy.copy()
        # the mixed slope from both sides; it is the same function where W is smooth
        fxy = 0.5 * (np.gradient(fx, axis=1) + np.gradient(fy, axis=0))
        # where a yarn goes slack its force is zero along the whole edge, and stays zero below it
        fxy[0, :] = fxy[:, 0] = fx[0, :] = fy[:, 0] = 0.0
        rest = int(np.argmin(np.abs(x - 1))), int(np.argmin(np.abs(y - 1)))
        about = tuple(slice(max(i - 1, 0), i + 2) for i in rest)
        for part, limited in zip(
            (W, fx, fy, fxy), coefficients.nonnegative(*(part[about] for part in (W, fx, fy, fxy)))
        ):
            part[about] = limited
        return cls(
            model,
            x,
            y,
            values,
            coefficients.bilinear(values["T1"]),
            coefficients.bilinear(values["T2"]),
            coefficients.spline(W, fx, fy, fxy, rest),
            residual,
        )

    @property
    def steps(self) -> tuple[float, float]:
        """[-] grid spacings along the two stretches."""
        return self.stretch1[1] - self.stretch1[0], self.stretch2[1] - self.stretch2[0]

    @cached_property
    def packed(self) -> packed_table.Packed:
        """The table as the kernels read it: all panels of a table read the same arrays, and no kernel
        writes to them."""
        scales = [2 * w * step for w, step in zip(self.model.fabric.weave.w, self.steps)]
        return packed_table.Packed(
            packed_table.ceilings(self.spline, (self.tension1, self.tension2), scales),
            packed_table.potential(self.spline),
            packed_table.beyond(self.spline, self.steps),
        )

    def stiffness(self) -> float:
        """Return the largest eigenvalue [N/m] of the membrane tangent dN_i/dLambda_j (per width of
        fabric) over the table."""
        return self._stiffness[0]

    def tautness(self) -> float:
        """Return that eigenvalue at rest, where fabric begins to be stretched, over its largest
        [-]."""
        return self._stiffness[1] / self._stiffness[0]

    @cached_property
    def _stiffness(self):
        """(largest, at rest) [N/m]."""
        weave = self.model.fabric.weave
        m1 = weave.warp_count
        m2 = weave.weft_count
        d1, d2 = self.steps
        N1 = self.values["N1"] * m1
        N2 = self.values["N2"] * m2
        k11 = np.diff(N1, axis=0)[:, :-1] / d1
        k22 = np.diff(N2, axis=1)[:-1, :] / d2
        k12 = 0.5 * (np.diff(N1, axis=1)[:-1, :] / d2 + np.diff(N2, axis=0)[:, :-1] / d1)
        found = 0.5 * (k11 + k22) + np.hypot(0.5 * (k11 - k22), k12)
        rest = tuple(int(np.argmin(np.abs(x - 1))) for x in (self.stretch1, self.stretch2))
        return float(np.max(found)), float(found[rest])


def _dense_packing(w, crossing):
    """Stretch of a cell of the half length w at which the yarns that cross it lie side by side, as
    round solid rods.

    At most 1: fabric that is denser than that does not become denser.
    """
    return min(np.sqrt(crossing.A_s / np.pi) / w, 1.0)
