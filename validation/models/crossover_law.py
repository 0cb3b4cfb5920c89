"""The compression law that paths of the 3D crossover have."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.compression import CompressionLaw


def fitted(*paths: Any) -> CompressionLaw:
    """Fit the CompressionLaw to paths of the 3D crossover as `unitcell3d.identify.calibration`
    does."""
    from unitcell3d.identify.calibration import samples

    return CompressionLaw.fit(*(np.concatenate(parts) for parts in zip(*map(samples, paths))))
