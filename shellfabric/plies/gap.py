"""The gap between plies at rest, from the pressure law of packs of the thesis (eqs. 5-1 to 5-4, erratum E-02)."""

from __future__ import annotations

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


def fabric_gap(fabric: Fabric) -> float:
    """[m] a fabric's own gap, or that of the pressure law where its file has none.

    Raises
    ------
    InputError : a fabric with neither a gap nor a measured areal density
    """
    if fabric.interlayer_gap is not None:
        return fabric.interlayer_gap
    if fabric.areal_density_measured is None:
        problem = f"fabric {fabric.name} has neither an interlayer gap nor a measured areal density"
        raise InputError(problem, key="gap", allowed="given")
    return compression_gap(fabric.areal_density_measured)
