"""What the range of a compression law does to a shot: one ply of pinned yarns with the law, and with both of its ends.

Resolved yarns, which `weavecell impact` has by default, say the same for nine times the work: -4.4 to +8.7 % of
the dent of an own aramid, pinned ones -4.3 to +8.0 %. The limits are those of one bisection each in a small
opening; `weavecell v50` draws from the range in the user's own.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from fabrics.base.errors import InputError, UndecidedError, UnstableError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.answers.law_effect import SMALL_OPENING, LawEffect
from weavecell.api.runs import setup

VELOCITIES = 90.0, 60.0, 40.0  # [m/s]: the first at which all three laws stop
TOLERANCE = 1.0  # [m/s] of the limits
FIRST_STEP = 1.1  # of their bisections, which begin at the limit of the law as it is


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
