"""Numerical parameters of the contact between plies."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.ply_law import PlyLaw
from shellfabric.plies import surface_kernels

_CELLS = 128  # of the table of a law over its travel
FORMS = {"smooth": surface_kernels.SMOOTH, "facets": surface_kernels.FACETS, "nodes": surface_kernels.NODES}


@dataclass(frozen=True)
class PlyContact:
    """Numerical parameters of the contact between plies, set by stability and convergence.

    The contact's stiffness is that of a law of the fabric (`fabrics.ply_law.PlyLaw`): K = dp/dd [Pa/m], the same on
    every mesh. It bounds the time step. In a stack of plies of the areal density A, on springs K with dampers
    c = zeta sqrt(K A) per area, the highest mode requires

        C^2 + 2 zeta C < 1,     C = dt sqrt(K / A)

    with K the steepest of the law. C is the Courant number of the contact: a compression wave passes C plies a step.
    The defaults stand at 0.83. The damper leaves a ninth of the speed at which two free plies meet: plies do not
    bounce.

    Parameters
    ----------
    courant : [-] C, which the time step of the pack is cut down to
    damping : [-] zeta, on the stiffness that the law has at the present closure
    points : along each side of an element; the naive forms have one, at its first node
    stiffness : [-] factor on the pressure of the law and on the nose's stiffness, to see what depends on them
    form : "smooth"; for comparison the naive "facets" and "nodes" (see `plies.contact_kernels`)

    Raises
    ------
    InputError : a value out of its range, unknown form
    """

    courant: float = 0.45
    damping: float = 0.7
    points: int = 2
    stiffness: float = 1.0
    form: str = "smooth"

    def __post_init__(self):
        for key in ("courant", "stiffness"):
            if not 0 < getattr(self, key) < inf:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        if not 0 <= self.damping < inf:
            raise InputError(key="damping", value=self.damping, allowed="at least 0")
        if not 1 <= self.points <= 8:
            raise InputError(key="points", value=self.points, allowed="1 to 8")
        if self.form not in FORMS:
            raise InputError(key="form", value=self.form, allowed=" or ".join(FORMS))


def law_table(law: PlyLaw, area: float, density: float, contact: PlyContact) -> tuple[FloatArray, float]:
    """(cells + 1, 4) table of a contact point for `law_kernels`, and the width [m] of its cells.

    Parameters
    ----------
    law : PlyLaw
    area : [m2] that a point stands for
    density : [kg/m2] of a ply
    contact : PlyContact, of which factor on the stiffness and damping are taken
    """
    law = law.scaled(contact.stiffness)
    cells = 1 if law.closure.size == 2 else _CELLS
    at = np.linspace(0.0, law.travel, cells + 1)
    slope = np.append(np.diff(law.pressure_at(at)) / np.diff(at), law.stiffness)
    damping = contact.damping * np.sqrt(slope * density)
    columns = law.pressure_at(at), slope, damping, law.energy_at(at)
    return np.ascontiguousarray(area * np.stack(columns, axis=1)), law.travel / cells
