"""Numerical parameters of the contact between plies."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from fabrics.errors import InputError
from shellfabric.plies import surface_kernels

FORMS = {
    "smooth": surface_kernels.SMOOTH,
    "facets": surface_kernels.FACETS,
    "nodes": surface_kernels.NODES,
}


@dataclass(frozen=True)
class PlyContact:
    """Numerical parameters of the contact between plies, set by stability and convergence.

    Stability: in a stack of masses m on springs k with dampers c the highest mode requires k dt^2 / m + 2 c dt / m < 1;
    the defaults stand at 0.83. The damper leaves a ninth of the speed at which two free plies meet: cloth does not
    bounce. No spring that looks at its own two plies alone can be much stiffer: modes of the stack
    from the lowest to the highest feel it, and one that holds firmer at rest than against the highest lags behind it,
    which gives energy to the others. The nose's is stable whatever its stiffness (see `contact_kernels`).

    Convergence: docs/packs.md and docs/parameters.md. Stiffer plies drawn into folds bring energy from nothing.

    Parameters
    ----------
    penalty : stiffness of a point, in units of the mass that it stands for / dt^2
    damping : ratio to critical of that mass on that spring
    points : along each side of an element
    nose : stiffness of the nose's contact, times that of a single ply (`panel.model.Numerics`), whose explicit spring
        None leaves. Under the rim of the nose a pack presses the first ply on it, by more than a single ply ever is
    form : "smooth"; for comparison the naive "facets" and "nodes" (see `plies.contact_kernels`)

    Raises
    ------
    InputError : a value out of its range, unknown form
    """

    penalty: float = 0.2
    damping: float = 0.7
    points: int = 1
    nose: float | None = 6.0
    form: str = "smooth"

    def __post_init__(self):
        if not 0 < self.penalty < inf:
            raise InputError(key="penalty", value=self.penalty, allowed="above 0")
        if not 0 <= self.damping < inf:
            raise InputError(key="damping", value=self.damping, allowed="at least 0")
        if not 1 <= self.points <= 8:
            raise InputError(key="points", value=self.points, allowed="1 to 8")
        if self.nose is not None and not 0 < self.nose < inf:
            raise InputError(key="nose", value=self.nose, allowed="above 0, or None")
        if self.form not in FORMS:
            raise InputError(key="form", value=self.form, allowed=" or ".join(FORMS))
