"""Plot of a material card's error: the law less the cell over the biaxial plane."""

from __future__ import annotations

from typing import Any

import numpy as np

from weavecell.decks.mismatch import Mismatch

PERCENT = 1e2


def plane(pyplot: Any, found: Mismatch) -> Any:
    """Difference along warp and weft, in percent of the strength, where no yarn has reached it."""
    figure, pair = pyplot.subplots(1, 2, figsize=(10.4, 4.3), sharey=True, layout="constrained")
    most = PERCENT * max(found.largest, 0.01)
    x, y = (PERCENT * (stretch - 1) for stretch in (found.stretch1, found.stretch2))
    for axes, difference, family in zip(pair, found.difference, ("warp", "weft")):
        shown = np.where(found.inside, PERCENT * difference, np.nan)
        image = axes.pcolormesh(x, y, shown, cmap="RdBu_r", vmin=-most, vmax=most, shading="nearest", rasterized=True)
        axes.set(xlabel="strain along the warp [%]", title=f"stress along the {family}")
    pair[0].set_ylabel("strain along the weft [%]")
    figure.colorbar(image, ax=pair, label="law less cell [% of the strength]")
    return figure
