"""What the edges of the panel and the size of the projectile change: slip, shear, reactions (sections 6.4.2, 6.4.3)."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.stats import spearmanr

from validation.claims.checks import series
from validation.claims.checks.histories import high_zone
from validation.claims.registry import Found, Run, RunResult, check

SLIPPED = 50e-6  # [m] from which on a yarn counts as slipped


def _grips(fabric, velocity, grips):
    return {f"N{grip:g}": Run.of("edged", fabric=fabric, velocity=velocity, warp=grip, weft=grip) for grip in grips}


def _pulled(runs):
    """([m] slip of the weft yarn that slips most, [m] whole width of the slipped zone) of each run."""
    slip = [float(run["slip"].max()) for run in runs]
    width = [2 * float(run["place"][run["slip"] > SLIPPED].max(initial=0.0)) for run in runs]
    return np.array(slip), np.array(width)


@check(_grips)
def slipped_width(fabric: str, velocity: float, grips: Sequence[float], **runs: RunResult) -> Found:
    """Width of the slipped zone of the weft against its largest slip, over clamps that hold with different forces."""
    slip, width = _pulled([runs[f"N{grip:g}"] for grip in grips])
    return {
        "rank correlation": float(spearmanr(slip, width)[0]),
        "exponent of the width on the slip": float(np.polyfit(np.log(slip), np.log(width), 1)[0]),
        "greatest over least width per slip": float((width / slip).max() / (width / slip).min()),
        "note": "; ".join(f"{g:g} N: {1e3 * s:.2f} mm over {1e3 * w:.0f} mm" for g, s, w in zip(grips, slip, width)),
    }


@check(_grips)
def clamp_force(fabric: str, velocity: float, grips: Sequence[float], **runs: RunResult) -> Found:
    """Largest slip of the weft against the force with which the clamp holds each yarn."""
    slip, _ = _pulled([runs[f"N{grip:g}"] for grip in grips])
    return {
        "least fall of the slip": float(min(a - b for a, b in itertools.pairwise(slip))),
        "slip at the firmest clamp": float(slip[-1]),
        "note": ", ".join(f"{g:g} N {1e3 * s:.3f} mm" for g, s in zip(grips, slip)),
    }


@check(
    lambda fabric, velocity: {
        "held": Run.of("edged", fabric=fabric, velocity=velocity),
        "free": Run.of("edged", fabric=fabric, velocity=velocity, weft="free"),
    }
)
def shear_share(held: RunResult, free: RunResult, fabric: str, velocity: float) -> Found:
    """Share of shear in the internal energy at the end, clamped on four sides and with free weft ends."""
    share = [float(run["energies"]["shear"][-1] / series.internal(run)[-1]) for run in (held, free)]
    return {
        "clamped": share[0],
        "free weft sides": share[1],
        "note": f"{free['outcome']} after {1e6 * free['t'][-1]:.0f} us with free weft ends",
    }


@check(
    lambda fabric, velocity, radii, window: {
        f"r{n}": Run.of("edged", fabric=fabric, velocity=velocity, radius=radius) for n, radius in enumerate(radii)
    }
)
def zone_by_projectile(
    fabric: str, velocity: float, radii: Sequence[float], window: Sequence[float], **runs: RunResult
) -> Found:
    """Width of the zone of high reactions of the weft, for projectiles of one mass and different radii [m]."""
    width, centre = zip(*(high_zone(runs[f"r{n}"], window)[:2] for n in range(len(radii))))
    return {
        "least growth of the width": min(np.diff(width)),
        "note": "; ".join(
            f"diameter {2e3 * r:g} mm: {1e3 * w:.0f} mm wide, middle {c:.2f} times the plateau"
            for r, w, c in zip(radii, width, centre)
        ),
    }
