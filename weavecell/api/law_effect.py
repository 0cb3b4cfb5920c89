"""What the range of a compression law does to a shot: one ply of pinned yarns with the law, and with both of its ends.

Resolved yarns, which `weavecell impact` has by default, say the same for nine times the work: -4.4 to +8.7 % of
the dent of an own aramid, pinned ones -4.3 to +8.0 %. The limits are those of one bisection each in a small
opening; `weavecell v50` draws from the range in the user's own.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.api.runs import setup

VELOCITIES = 90.0, 60.0, 40.0  # [m/s]: the first at which all three laws stop
SMALL_OPENING = 0.08  # [m] of the limits: a shot there is a sixth of one in the default opening
TOLERANCE = 1.0  # [m/s] of the limits
FIRST_STEP = 1.1  # of their bisections, which begin at the limit of the law as it is


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
    ends = law.ends()
    if not ends:
        return None
    fabrics = [replace(fabric, laws=(one, one)) for one in (law, *ends.values())]
    for velocity in VELOCITIES:
        dents = _find_dents(fabrics, velocity, report)
        if dents:
            return LawEffect(velocity, dents, _find_limits(fabrics, report))
    return None


def _find_dents(fabrics, velocity, report):
    """Return the dent of each; empty where a shot does not stop."""
    # help must not wait for a solver to load
    from weavecell.studies import ballistic_limit

    dents: list[float] = []
    with suppress(UndecidedError, UnstableError):
        for fabric in fabrics:
            target = setup(fabric, velocity, crossovers="pinned").target()
            (shot,) = ballistic_limit.shoot(target, [velocity])
            if shot.perforated:
                return ()
            dents.append(shot.deflection)
            report(0.5 * len(dents) / len(fabrics))
        return tuple(dents)
    return ()


def _find_limits(fabrics, report):
    """Return the critical velocity of each; empty where one has none, or a shot is undecided."""
    from weavecell.studies import ballistic_limit

    limits: list[float] = []
    with suppress(InputError, UndecidedError, UnstableError):
        for fabric in fabrics:
            options = {"crossovers": "pinned", "opening": SMALL_OPENING}
            target = setup(fabric, VELOCITIES[0], **options).target()
            found = ballistic_limit.critical_velocity(
                target,
                tolerance=TOLERANCE,
                guess=limits[0] if limits else None,
                step=FIRST_STEP,
            )
            limits.append(found.velocity)
            report(0.5 + 0.5 * len(limits) / len(fabrics))
        return tuple(limits)
    return ()
