"""The range of a compression law that follows from the range of an assumed solid law.

A fabric whose yarns have the solid law of their fibre family (`fabrics.assumed`) is calibrated once more with the soft
and once with the stiff end of that law. The two laws are kept with the nominal one, `CompressionLaw.assumed_range`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fabrics import assumed
from fabrics.fabric import Fabric
from unitcell3d.identify.calibrate import calibrate_all
from unitcell3d.identify.calibration import Calibration


def with_assumed_range(fabric: Fabric, done: Calibration, **choices: Any) -> tuple[Calibration, dict[str, str]]:
    """A calibration whose law holds its assumed range; as it is where the solid law is not assumed.

    Parameters
    ----------
    fabric : Fabric that was calibrated
    done : its Calibration
    choices : size, friction, jobs, executor, on_progress as of `calibrate.calibrate_all`

    Returns
    -------
    done : Calibration
    failed : {"soft" or "stiff": why this end has no law}; the law has a range only where both ends have one
    """
    ends = {end: replace(each, name=f"{each.name}, {end}") for end, each in assumed.solid_ends(fabric).items()}
    if not ends:
        return done, {}
    found = calibrate_all(list(ends.values()), **choices)
    results = {end: found[each.name] for end, each in ends.items()}
    failed = {end: str(result) for end, result in results.items() if isinstance(result, Exception)}
    pairs = [(result.law.a, result.law.b) for result in results.values() if isinstance(result, Calibration)]
    if len(pairs) < len(ends):
        return done, failed
    return replace(done, law=replace(done.law, assumed_range=(pairs[0], pairs[1]))), {}
