"""The range of a compression law that follows from the range of an assumed solid law.

A fabric whose yarns have the solid law of their fibre family (`fabrics.assumed`) is calibrated once
more with the soft and once with the stiff end of that law. The two laws are kept with the nominal
one, `CompressionLaw.assumed_range`. A yarn that is meshed denser than V_c of an end, at which it
would be packed, has one a little above its own density.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fabrics import assumed
from fabrics.fabric import Fabric
from meshing import crossover
from unitcell3d.identify.calibrate import calibrate_all
from unitcell3d.identify.calibration import Calibration

# [-] of fibre volume fraction, from the mesh at rest to packed yarns
_LEAST_ROOM = 0.01


def _packed_later(fabric, name, size):
    """The fabric with a new name, and with V_c above the density that the mesh gives its yarns."""
    dense = crossover.build(fabric, size=size).Vf0
    laws = [
        replace(law, V_c=max(law.V_c, Vf0 + _LEAST_ROOM))
        for law, Vf0 in zip(fabric.solid_laws, dense)
    ]
    return replace(fabric, name=name, solid_laws=tuple(laws))


def with_assumed_range(
    fabric: Fabric, done: Calibration, **choices: Any
) -> tuple[Calibration, dict[str, str]]:
    """Return a calibration whose law holds its assumed range; as it is if the solid law is not
    assumed.

    Parameters
    ----------
    fabric : Fabric that was calibrated
    done : its Calibration
    **choices : size, friction, jobs, executor, on_progress as in `calibrate.calibrate_all`

    Returns
    -------
    done : Calibration
    failed : {"soft" or "stiff": why this end has no law}; the law has a range only where both ends
        have one
    """
    ends = {
        end: _packed_later(each, f"{each.name}, {end}", choices.get("size", "coarse"))
        for end, each in assumed.solid_ends(fabric).items()
    }
    if not ends:
        return done, {}
    found = calibrate_all(list(ends.values()), **choices)
    results = {end: found[each.name] for end, each in ends.items()}
    failed = {end: str(result) for end, result in results.items() if isinstance(result, Exception)}
    pairs = [
        (result.law.a, result.law.b)
        for result in results.values()
        if isinstance(result, Calibration)
    ]
    if len(pairs) < len(ends):
        return done, failed
    return replace(done, law=replace(done.law, assumed_range=(pairs[0], pairs[1]))), {}
