"""Velocities at which given shares of shots pass, without a curve: of shots that strike anywhere in a cell of the
weave, the limit differs between places by more than a normal curve about one V50 has.

The share of perforations is taken to grow with the velocity, and nothing else: the maximum likelihood under that is
found by pooling neighbours that fall (Ayer, Brunk, Ewing, Reid and Silverman 1955, "An empirical distribution
function for sampling with incomplete information").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray
from shellfabric.impact.setup import ImpactSetup
from shellfabric.yarns.holding import friction_of_plies

# shares that are told, in words
TOLD = {0.1: "1 in 10", 0.5: "half", 0.9: "9 in 10"}


def may_slip(setup: ImpactSetup, velocity: float) -> bool:
    """Tell whether friction may not hold the resolved yarns of a set-up against a nose at a velocity [m/s]; yarns
    hold if they are pinned, and if the friction that they need is not known."""
    if setup.crossovers is None:
        return False
    needed = friction_of_plies(setup.plain_panels(), velocity)
    return needed is not None and setup.crossovers.friction < needed[1]


def pool_shares(velocity: ArrayLike, perforated: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Estimate the share of perforations that grows with the velocity.

    Parameters
    ----------
    velocity, perforated : (n,) [m/s] of the shots, and whether they perforated

    Returns
    -------
    velocity, share : (n,) [m/s, -] of the shots by velocity
    """
    V = np.asarray(velocity, float)
    hit = np.asarray(perforated, float)
    values = np.unique(V)
    # (perforations, shots, velocities) of each pool
    pools = [(hit[V == value].sum(), np.sum(V == value), 1) for value in values]
    pooled: list[tuple[float, int, int]] = []
    for pool in pools:
        while pooled and pooled[-1][0] * pool[1] >= pool[0] * pooled[-1][1]:
            before = pooled.pop()
            pool = before[0] + pool[0], before[1] + pool[1], before[2] + pool[2]
        pooled.append(pool)
    shares = [part for hits, shots, count in pooled for part in [hits / shots] * count]
    return values, np.array(shares)


@dataclass(frozen=True)
class PassingShares:
    """Velocities at which shares of shots pass.

    Parameters
    ----------
    velocities : {share: [m/s]}; NaN of one that no shot is slow, or fast, enough for
    lowest, highest : [m/s] of the shots
    """

    velocities: dict[float, float]
    lowest: float
    highest: float

    @classmethod
    def of_shots(
        cls, velocity: ArrayLike, perforated: ArrayLike, shares: Sequence[float] = tuple(TOLD)
    ) -> PassingShares:
        """Find the velocities of shares: between the fastest shot below the share and the next one."""
        V, share = pool_shares(velocity, perforated)
        found = {}
        for wanted in shares:
            found[wanted] = nan
            if share[0] < wanted <= share[-1]:
                first = int(np.argmax(share >= wanted))
                found[wanted] = float(0.5 * (V[first - 1] + V[first]))
        return cls(found, float(V[0]), float(V[-1]))

    def words(self) -> str:
        """Write the shares with their velocities, those of one velocity together."""
        names: dict[str, list[str]] = {}
        for share, velocity in self.velocities.items():
            if not np.isnan(velocity):
                names.setdefault(f"{velocity:.1f}", []).append(TOLD[share])
        if not names:
            return f"no share is determined by shots at {self.lowest:.1f} to {self.highest:.1f} m/s"
        parts = [f"{' and '.join(shares)} at {velocity}" for velocity, shares in names.items()]
        return f"{', '.join(parts)} m/s"
