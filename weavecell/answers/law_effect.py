"""What the range of a compression law does to a shot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

SMALL_OPENING = 0.08  # [m] of the limits: a shot there is a sixth of one in the default opening


@dataclass(frozen=True)
class LawEffect:
    """Dents and limits of one ply of pinned yarns, each a number of the law as it is, its soft end, its stiff end.

    Parameters
    ----------
    velocity : [m/s] of the shots that dent, which all stop
    dents : (3,) [m] largest deflection in the default frame
    limits : (3,) [m/s] critical velocity in `SMALL_OPENING`; empty where one was not found
    """

    velocity: float
    dents: tuple[float, ...]
    limits: tuple[float, ...] = ()

    def line(self) -> str:
        """Say how far the ends of the range move the dent and the limit, and of which model."""
        text = f"its range moves the dent of a pinned ply at {self.velocity:g} m/s by {_shift(self.dents)} %"
        if self.limits:
            width = f"{1e3 * SMALL_OPENING:g} mm"
            text += f" and its critical velocity in {width} by {_shift(self.limits)} %"
        return text

    def entries(self) -> dict[str, Any]:
        """Return the numbers, for law-range.json."""
        return {
            "crossovers": "pinned",
            "velocity_m_s": self.velocity,
            "dents_m": self.dents,
            "opening_of_limits_m": SMALL_OPENING,
            "limits_m_s": self.limits,
        }


def _shift(values):
    """Write how far both ends are from the middle [%]."""
    middle, *ends = values
    low, high = sorted(100 * (end / middle - 1) for end in ends)
    return f"{low:+.2g} to {high:+.2g}"
