"""What the range of a compression law does to a shot: one ply of the fabric with the law, and with both of its ends.

The dent alone: outcomes near a limit are mixed, and a V50 that distinguishes the laws takes some sixty shots of each
(`weavecell v50` draws from the range)."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from fabrics.base.errors import UndecidedError, UnstableError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.api.runs import setup

VELOCITIES = 90.0, 60.0, 40.0  # [m/s]: the first at which all three laws stop


@dataclass(frozen=True)
class LawEffect:
    """Dents of one ply in the default frame, of each law.

    Parameters
    ----------
    velocity : [m/s] of the shots, which all stop
    dents : (3,) [m] largest deflection: law as it is, soft end, stiff end
    """

    velocity: float
    dents: tuple[float, ...]

    def line(self) -> str:
        """Say how far the ends of the range move the dent."""
        middle, *ends = self.dents
        low, high = sorted(100 * (end / middle - 1) for end in ends)
        return (
            f"its range moves a ply's dent at {self.velocity:g} m/s by {low:+.2g} to {high:+.2g} %"
        )

    def entries(self) -> dict[str, Any]:
        """Return the numbers, for law-range.json."""
        return {"velocity_m_s": self.velocity, "dents_m": self.dents}


def find_effect(
    fabric: Fabric, law: CompressionLaw, report: Callable[[float], object] = lambda done: None
) -> LawEffect | None:
    """Fire shots of the law and of both ends at one ply of pinned yarns, by the default projectile.

    Parameters
    ----------
    fabric : Fabric
    law : CompressionLaw with a range
    report : called with the share of the work done

    Returns
    -------
    LawEffect, or None : the law has no range, or a shot of one of the laws does not stop
    """
    # help must not wait for a solver to load
    from weavecell.studies import ballistic_limit

    ends = law.ends()
    if not ends:
        return None
    laws = (law, *ends.values())
    targets = [
        setup(replace(fabric, laws=(one, one)), VELOCITIES[0], crossovers="pinned").target()
        for one in laws
    ]
    for velocity in VELOCITIES:
        dents: list[float] = []
        with suppress(UndecidedError, UnstableError):
            for target in targets:
                (shot,) = ballistic_limit.shoot(target, [velocity])
                if shot.perforated:
                    break
                dents.append(shot.deflection)
                report(len(dents) / len(targets))
        if len(dents) == len(targets):
            return LawEffect(velocity, tuple(dents))
    return None
