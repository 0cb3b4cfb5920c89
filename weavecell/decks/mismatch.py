"""How far a law of another code is from a fabric's cell: over the biaxial plane, in uniaxial
tension, in shear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray
from weavecell.decks.homogenised import HomogenisedFabric
from weavecell.decks.laws import Law

# a card that misses the tension by a larger share of the strength says so
LIMIT = 0.1


@dataclass(frozen=True)
class Mismatch:
    """The stress of a law less that of the cell, over the strength of the direction; of shear, over
    the lower one.

    Parameters
    ----------
    stretch1, stretch2, inside : of `HomogenisedFabric.plane`
    difference : (2, n, n) of warp and weft
    uniaxial, shear : largest in uniaxial tension to the strength, and in trellis shear until
        locking
    """

    stretch1: FloatArray
    stretch2: FloatArray
    inside: BoolArray
    difference: FloatArray
    uniaxial: float
    shear: float

    @classmethod
    def measure(cls, fabric: HomogenisedFabric, law: Law) -> Mismatch:
        """Compare a law with the cell."""
        L1, L2, inside = fabric.plane
        difference = (law.stress(L1, L2) - fabric.stress(L1, L2)) / fabric.strength[:, None, None]
        tension = []
        for family in (0, 1):
            stretch, stress = fabric.uniaxial(family)
            tension.append(
                np.abs(law.uniaxial(stretch, family) - stress).max() / fabric.strength[family]
            )
        gamma = np.linspace(0, fabric.shear.gamma2, 201)
        shear = np.abs(law.shear(gamma) - fabric.shear.stress(gamma)).max() / fabric.strength.min()
        return cls(L1, L2, inside, difference, float(max(tension)), float(shear))

    @property
    def rms(self) -> float:
        """[-] over the biaxial plane and both directions."""
        return float(np.sqrt((self.difference[:, self.inside] ** 2).mean()))

    @property
    def largest(self) -> float:
        """[-] over the biaxial plane and both directions."""
        return float(np.abs(self.difference[:, self.inside]).max())

    @property
    def worst(self) -> float:
        """[-] the largest of all."""
        return max(self.largest, self.uniaxial, self.shear)

    def numbers(self) -> dict[str, float]:
        """Return the four numbers, by name."""
        return {
            "rms": self.rms,
            "largest": self.largest,
            "uniaxial": self.uniaxial,
            "shear": self.shear,
        }


def plot(pyplot: Any, mismatch: Mismatch) -> Any:
    """Draw the differences along warp and weft, in percent of the strength, where no yarn has
    reached it."""
    figure, pair = pyplot.subplots(1, 2, figsize=(10.4, 4.3), sharey=True)
    top = 100 * max(mismatch.largest, 0.01)
    x, y = (100 * (stretch - 1) for stretch in (mismatch.stretch1, mismatch.stretch2))
    for axes, difference, family in zip(pair, mismatch.difference, ("warp", "weft")):
        shown = np.where(mismatch.inside, 100 * difference, np.nan)
        image = axes.pcolormesh(
            x, y, shown, cmap="RdBu_r", vmin=-top, vmax=top, shading="nearest", rasterized=True
        )
        axes.set(xlabel="strain along the warp [%]", title=f"stress along the {family}")
    pair[0].set_ylabel("strain along the weft [%]")
    figure.colorbar(image, ax=pair, label="law less cell [% of the strength]")
    return figure
