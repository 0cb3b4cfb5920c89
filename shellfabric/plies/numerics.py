"""Numerical parameters of the contact between plies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.fields import check_fields, finite
from fabrics.base.frozen import explain_frozen
from fabrics.data_sheet import entries
from fabrics.ply_law import PlyLaw

_CELLS = 128  # of the table of a law over its travel
_SHARE_COURANT = 1.35  # kappa C, two thirds of what is stable


@explain_frozen
@dataclass(frozen=True)
class PlyContact:
    """Parameters of the contact between plies: those that stability and convergence set, and what
    plies give back.

    The contact's stiffness is that of a law of the fabric (`fabrics.ply_law.PlyLaw`) up to
    `stiffness`: K = dp/dd [Pa/m], the same on every mesh. It bounds the time step. In a stack of
    plies of the areal density A, on springs K with dampers c = zeta sqrt(K A) per area, the highest
    mode requires

        C^2 + 2 zeta C < 1,     C = dt sqrt(K / A)

    with K the steepest of the law. C is the Courant number of the contact: a compression wave
    passes C plies a step. The defaults stand at 0.83. Along the branch on which plies part K is 1 /
    resilience times as steep, with the same damper; the step is cut down so that this branch too
    stands there.

    Limited shares (`surface.surface_kernels`) call nodes back that run ahead of a push, by a damper
    of kappa sqrt(K A) per area, which requires kappa C < 2. kappa = 1.35 / C is 3 at the default; a
    node that runs ahead is called back within a step or two, and faster dampers overshoot. Without
    damping the contact keeps its energy, and has plain shares.

    Parameters
    ----------
    courant : [-] C, which the time step of the pack is cut down to
    damping : [-] zeta, on the stiffness that the law has at the present closure
    points : along each side of an element
    resilience : [-] e, share of the energy of a closure that comes back as plies part
        (`pressure_kernels`); 1: all of it
    stiffness : [-] steepest slope of the law, over that of solid fibre: what is steeper sets the
        time step, and nothing that a shot is asked for. 1 moves the tension under the nose by 1.6 %,
        V50 of two packs (24 draws) by .5 and 0 %; .25 moves that tension by 2.6 %

    Raises
    ------
    InputError : a value out of its range
    """

    courant: Annotated[float, finite(gt=0.0)] = 0.45
    damping: Annotated[float, finite(ge=0.0)] = 0.7
    points: Annotated[int, finite(ge=1, le=8)] = 2
    stiffness: Annotated[float, finite(gt=0.0)] = 0.5
    resilience: Annotated[float, finite(gt=0.0, le=1.0)] = entries()["ply_resilience"].number

    def __post_init__(self):
        check_fields(self)

    @property
    def closing_courant(self) -> float:
        """[-] dt sqrt(K / A) with which the branch on which plies part keeps the margin of
        `courant`."""
        sum_of_stability = self.courant * (self.courant + 2 * self.damping)
        drag = self.damping * self.resilience**0.5
        parting = (drag**2 + sum_of_stability) ** 0.5 - drag
        return parting * self.resilience**0.5

    @property
    def share_ratio(self) -> float:
        """[-] kappa; 0 without damping."""
        if self.damping == 0.0:
            return 0.0
        return _SHARE_COURANT / self.courant

    @property
    def share_drag(self) -> float:
        """[-] damper of limited shares over that of the contact, kappa / zeta; 0 without damping."""
        if self.damping == 0.0:
            return 0.0
        return self.share_ratio / self.damping


def law_tables(
    laws: Sequence[PlyLaw], areas: Sequence[float], densities: Sequence[float], contact: PlyContact
) -> tuple[FloatArray, FloatArray]:
    """Tabulate the laws of contact points for `law_kernels`, (laws, cells + 1, 4), and the widths
    (laws,) [m] of their cells.

    Parameters
    ----------
    laws : of each two neighbouring plies
    areas : [m2] that a point stands for
    densities : [kg/m2] of the lighter one of the two plies
    contact : PlyContact, of which the damping is taken
    """
    cells = _CELLS
    if all(law.closure.size == 2 for law in laws):
        cells = 1
    tables = np.zeros((len(laws), cells + 1, 4))
    for table, law, area, density in zip(tables, laws, areas, densities):
        at = np.linspace(0.0, law.travel, cells + 1)
        slope = np.append(np.diff(law.pressure_at(at)) / np.diff(at), law.stiffness)
        damping = contact.damping * np.sqrt(slope * density)
        table[:] = area * np.stack([law.pressure_at(at), slope, damping, law.energy_at(at)], axis=1)
    return tables, np.array([law.travel / cells for law in laws])
