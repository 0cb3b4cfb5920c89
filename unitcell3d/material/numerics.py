"""The numbers of the method: how stiff contact is, and what a slack fibre keeps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fabrics.base.errors import InputError
from fabrics.fabric import Fabric

FRACTIONS = ("mesh", "stated")


@dataclass(frozen=True)
class Numerics:
    """Numbers that belong to the method, not to the fabric. How results converge:
    docs/reports/mesh-and-cost.md.

    Parameters
    ----------
    penalty : [Pa/m] contact stiffness, both passes together
    toe : [m] penetration over which the contact stiffness sets in; a shorter one costs more
        tangents
    slack_width : [-] fibre strain over which a fibre becomes taut
    slack_stiffness : [-] fraction of its stiffness left to a slack fibre, which keeps slack yarns
        from collapsing; where it is large, slack yarn tips buckle
    friction : [-] Coulomb's coefficient between yarns, and between yarns and plates
    slip : [m] over which friction sets in
    fibre_fraction : whose fibre volume fraction at rest enters the law of the solid (thesis eqs.
        3-11 to 3-13). "mesh": the fibre area over that of the meshed section. "stated": that of the
        fabric, with which its V_c was published or fitted. The law is one of compression since
        rest, where only V_c / Vf0 counts, the compression at which the fibres are packed: a V_c
        measured on its own belongs to the first, one fitted with a nominal Vf0 to the second. They
        differ where the crimp leaves more or less room than the stated fraction asks for. None takes
        that of `fraction_of`.
    """

    penalty: float = 1e15
    toe: float = 0.5e-6
    slack_width: float = 1e-4
    slack_stiffness: float = 1e-3
    friction: float = 0.0
    slip: float = 0.5e-6
    fibre_fraction: str | None = None

    def __post_init__(self):
        for key in ("penalty", "toe", "slack_width", "slack_stiffness", "slip"):
            if not getattr(self, key) > 0:
                raise InputError(key=key, value=getattr(self, key), allowed="positive")
        if self.fibre_fraction not in (None, *FRACTIONS):
            raise InputError(
                key="fibre_fraction", value=self.fibre_fraction, allowed=" or ".join(FRACTIONS)
            )
        if not 0 <= self.friction < np.inf:
            raise InputError(key="friction", value=self.friction, allowed="0 or positive")

    def softened(self, factor: float) -> Numerics:
        """Return the settings with a softer contact: `factor` of the penalty, the toe deeper by its
        inverse root."""
        return replace(self, penalty=self.penalty * factor, toe=self.toe / factor**0.5)


def fraction_of(fabric: Fabric) -> str:
    """Return whose fibre fraction the solid law of a fabric belongs to: "stated" where V_c and Vf0 of
    both yarns come from one source, a pair, else "mesh"."""
    if "solid" in fabric.assumed:
        return "mesh"
    for family in ("warp", "weft"):
        packed, at_rest = (_source(fabric, family, key) for key in ("V_c", "Vf0"))
        # what is said of the fraction alone stands behind the common source
        if not packed or not at_rest.startswith(packed):
            return "mesh"
    return "stated"


def _source(fabric, family, key):
    """Where a number of a yarn's solid law comes from; "" if that is not told."""
    known = fabric.sources
    entry = known.get(f"solid.{family}.{key}") or known.get(f"solid.{key}")
    return entry["source"] if entry else ""
