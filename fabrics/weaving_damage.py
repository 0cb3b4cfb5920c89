"""Weaving damage: the share of modulus and strength that a yarn retains after weaving, as an option.

Yarn data of a catalogue are those of yarns before weaving, which breaks and abrades fibres (thesis sections 5.2.3 and
6.2.2). Neither the thesis nor the catalogue has data of yarns taken from a woven fabric: a share is an assumption until
it is measured, and carries its source and status into the fabric's `sources`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fabrics.errors import InputError
from fabrics.fabric import Fabric

STATUSES = ("measured", "assumed")


@dataclass(frozen=True)
class WeavingDamage:
    """What weaving leaves of the yarns of both families.

    Parameters
    ----------
    modulus, strength : [-] shares that are retained; 1 is a yarn before weaving
    source : where the shares come from
    status : of STATUSES

    Raises
    ------
    InputError : a share that is not above 0 and at most 1, an unknown status, or no source
    """

    modulus: float
    strength: float
    source: str
    status: str = "assumed"

    def __post_init__(self) -> None:
        for key in ("modulus", "strength"):
            if not 0 < getattr(self, key) <= 1:
                raise InputError(key=f"weaving_damage.{key}", value=getattr(self, key), allowed="above 0 and at most 1")
        if self.status not in STATUSES:
            raise InputError(key="weaving_damage.status", value=self.status, allowed=" or ".join(STATUSES))
        if not self.source:
            raise InputError(key="weaving_damage.source", value=self.source, allowed="given")


def with_weaving_damage(fabric: Fabric, damage: WeavingDamage) -> Fabric:
    """The fabric with modulus and strength of its yarns after weaving; geometry, masses and laws stay.

    The failure strain follows from both: strength over modulus.

    Raises
    ------
    InputError : a failure strain that is not below 1
    """
    warp, weft = (
        replace(yarn, E=damage.modulus * yarn.E, failure_strain=yarn.failure_strain * damage.strength / damage.modulus)
        for yarn in fabric.weave.yarns
    )
    entry = {"source": damage.source, "status": damage.status}
    sources = {f"weaving_damage.{key}": {"value": getattr(damage, key), **entry} for key in ("modulus", "strength")}
    return replace(fabric, weave=replace(fabric.weave, warp=warp, weft=weft), sources={**fabric.sources, **sources})
