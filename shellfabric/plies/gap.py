"""The gap between plies at rest: what a test closes between neighbouring plies and the law of their contact does not.

The thesis takes as the gap all that two neighbouring plies of a pack close up to the highest pressure of its test
(eqs. 5-1 to 5-4, erratum E-02): the flattening of the weave and the nesting of plies together, since its contact is
stiff. A law of the contact with a travel of its own (`fabrics.ply_law`) holds the flattening; the rest of the
closure is nesting, and that is the gap. The pressure law of packs holds all of it and leaves none.
"""

from __future__ import annotations

from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PLATEN_PRESSURE
from fabrics.ply_law import TESTED, PlyLaw, between_plies


def compression_gap(areal_density: float, plies: int = TESTED) -> float:
    """[m] all that neighbouring plies close in the tests of packs; parameters as `fabrics.ply_law.between_plies`."""
    return float(between_plies(areal_density, plies)[1][-1])


def fabric_gap(fabric: Fabric, law: PlyLaw | None = None) -> float:
    """[m] a fabric's own gap, or that of the pressure law where its file has none, less what `law` closes of it.

    Parameters
    ----------
    law : of the contact between plies; None for a rigid one, as in the thesis

    Raises
    ------
    InputError : a fabric with neither a gap nor a measured areal density
    """
    found = fabric.interlayer_gap
    if found is None:
        if fabric.areal_density_measured is None:
            problem = f"fabric {fabric.name} has neither an interlayer gap nor a measured areal density"
            raise InputError(problem, key="gap", allowed="given")
        found = compression_gap(fabric.areal_density_measured)
    return found if law is None else max(0.0, found - float(law.closure_at(PLATEN_PRESSURE)))
