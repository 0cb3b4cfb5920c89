"""The gap between plies at rest: of the fabric, from the pressure law of packs (erratum E-02), or from thickness."""

from __future__ import annotations

from dataclasses import dataclass

from fabrics.data_sheet import entries
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve

TESTED = 4  # plies of the packs that the thesis takes its gaps from (section 5.2.2)


def compression_gap(areal_density: float, plies: int = TESTED) -> float:
    """[m] gap between plies from the pressure law of packs (thesis eqs. 5-1 to 5-4, erratum E-02).

    Parameters
    ----------
    areal_density : [kg/m2] of one ply, measured
    plies : of the pack that was pressed: 4, 8 or 16

    Raises
    ------
    InputError : as fabrics.plate_curve.PlateCurve.pressure_law
    """
    pack, one = (PlateCurve.pressure_law(areal_density, count).closure[-1] for count in (plies, 1))
    return float(pack - one) / (plies - 1)


@dataclass(frozen=True)
class PlyGap:
    """Gap between neighbouring plies at rest.

    Parameters
    ----------
    value, low, high : [m] and the range in which it is taken to lie; all one value where it is given
    source : where it comes from
    """

    value: float
    low: float
    high: float
    source: str


def ply_gap(fabric: Fabric) -> PlyGap:
    """A fabric's own gap, that of the pressure law of packs, or a share of its thickness.

    The pressure law is that of Kevlar 129 and needs the areal density that was measured with it. Any other fabric, and
    one below the areal density at which that law ends, has the share of `data_sheet.toml`, whose range goes for both.
    """
    one = entries()["ply_gap"]
    if fabric.interlayer_gap is not None:
        gap = fabric.interlayer_gap
        source = fabric.sources.get("interlayer_gap", {}).get("source", "")
        return PlyGap(gap, gap, gap, f"of the fabric file ({source})" if source else "of the fabric")
    try:
        if fabric.areal_density_measured is not None:
            gap = compression_gap(fabric.areal_density_measured)
            low, high = one.low / one.value * gap, one.high / one.value * gap
            return PlyGap(gap, low, high, "assumed: pressure law of packs, thesis eqs. 5-1 to 5-4")
    except InputError:  # K'' of eq. 2-6 is not positive
        pass
    thickness = fabric.weave.thickness if fabric.thickness is None else fabric.thickness
    gap, low, high = (share * thickness for share in (one.value, one.low, one.high))
    return PlyGap(gap, low, high, f"assumed: {one.value:g} of the thickness {1e3 * thickness:.3g} mm")


def fabric_gap(fabric: Fabric) -> float:
    """[m] the value of `ply_gap`."""
    return ply_gap(fabric).value
