"""The gap between plies at rest: what a test closes between neighbouring plies and the law of their
contact does not.

The thesis takes as the gap all that two neighbouring plies of a pack close up to the highest
pressure of its test (eqs. 5-1 to 5-4, erratum E-02): the flattening of the weave and the nesting of
plies together, since its contact is stiff. A law of the contact with a travel of its own
(`fabrics.ply_law`) holds the flattening; the rest of the closure is nesting, and that is the gap.
The pressure law of packs holds all of it and leaves none. How much of it a pack at rest has closed
by its own weight and seams nobody measured: the range of a closure between platens goes down to 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fabrics import ply_laws
from fabrics.base.errors import InputError
from fabrics.data_sheet import entries
from fabrics.fabric import Fabric
from fabrics.plate_curve import PLATEN_PRESSURE
from fabrics.ply_law import PlyLaw
from fabrics.ply_laws import TESTED, between_plies


def compression_gap(areal_density: float, plies: int = TESTED) -> float:
    """Return all [m] that neighbouring plies close in the tests of packs; parameters as
    `fabrics.ply_laws.between_plies`."""
    return float(between_plies(areal_density, plies)[1][-1])


@dataclass(frozen=True)
class PlyGap:
    """Gap between neighbouring plies at rest.

    Parameters
    ----------
    value, low, high : [m] and the range in which it is taken to lie; all one value where it is
        given
    source : where it comes from
    """

    value: float
    low: float
    high: float
    source: str


def ply_gap(fabric: Fabric, law: PlyLaw | None = None) -> PlyGap:
    """Choose a fabric's own gap, that of the pressure law of packs, or a share of its thickness,
    less what `law` closes of it.

    The pressure law is that of Kevlar 129 and needs the areal density that was measured with it.
    Any other fabric, and one below the areal density at which that law ends, has the share of
    `data_sheet.toml`, whose range goes for both.

    Parameters
    ----------
    law : of the contact between plies; None for a rigid one, as in the thesis
    """
    found = _closure(fabric)
    if law is None:
        return found
    closed = float(law.closure_at(PLATEN_PRESSURE))
    value, low, high = (max(0.0, each - closed) for each in (found.value, found.low, found.high))
    source = f"{found.source}, less the {1e6 * closed:.3g} um that the contact law closes"
    return replace(found, value=value, low=low, high=high, source=source)


def gap_between(front: Fabric, rear: Fabric) -> PlyGap:
    """Average the gap between plies of two fabrics with their own contact laws."""
    one, other = (ply_gap(fabric, ply_laws.default(fabric)) for fabric in (front, rear))
    value, low, high = (
        0.5 * (getattr(one, key) + getattr(other, key)) for key in ("value", "low", "high")
    )
    if one.source == other.source:
        source = one.source
    else:
        source = f"mean of two fabrics: {one.source}; {other.source}"
    return PlyGap(value, low, high, source)


def _closure(fabric):
    """PlyGap of a contact without travel."""
    one = entries()["ply_gap"]
    if fabric.interlayer_gap is not None:
        gap = fabric.interlayer_gap
        origin = "of the fabric"
        entry = fabric.sources.get("interlayer_gap", {})
        if entry.get("source"):
            origin += f" file ({entry['source']})"
        low = gap
        if entry.get("status") == "fitted":  # to what platens close
            low = 0.0
        return PlyGap(gap, low, gap, origin)
    try:
        if fabric.areal_density_measured is not None and fabric.weave.pattern.is_plain:
            gap = compression_gap(fabric.areal_density_measured)
            low = one.low / one.value * gap
            high = one.high / one.value * gap
            return PlyGap(gap, low, high, "assumed: pressure law of packs, thesis eqs. 5-1 to 5-4")
    except InputError:  # K'' of eq. 2-6 is not positive
        pass
    if fabric.thickness is None:
        thickness = fabric.weave.thickness
    else:
        thickness = fabric.thickness
    gap, low, high = (share * thickness for share in (one.value, one.low, one.high))
    return PlyGap(
        gap, low, high, f"assumed: {one.value:g} of the thickness {1e3 * thickness:.3g} mm"
    )
