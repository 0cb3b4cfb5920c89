"""Panels and packs of a V50, drawn from a seed and a number alone.

The yarns differ in strength (`shellfabric.impact.strengths`). Modulus, and the crimp of either
family, are one log-normal value for all plies, which are cut from one roll. Resolved yarns are
struck anywhere in a cell of the weave.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log, sqrt

import numpy as np

from fabrics.base.errors import InputError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.impact.strengths import YarnStrength, with_strengths
from shellfabric.plies.model import Pack
from shellfabric.yarns.model import aim
from weavecell.studies.inputs import Scatter, scale_setup, use_one_thread


@dataclass(frozen=True)
class Drawn:
    """One drawn panel.

    Parameters
    ----------
    pack : Pack of whole plies
    factors : {"modulus", "crimp_warp", "crimp_weft": factor [-] of all plies}
    weakest : (warp, weft) [-] factor on the strength of the weakest yarn of any ply
    """

    pack: Pack
    factors: dict[str, float]
    weakest: tuple[float, float]


def draw_panel(
    setup: ImpactSetup, scatter: Scatter, seed: int, number: int, stride: int | None = None
) -> Drawn:
    """Draw the strengths of the panel or pack of a number.

    Parameters
    ----------
    stride : as in `with_strengths`, of what is to be drawn alike

    Raises
    ------
    InputError : as `check`
    """
    whole = use_one_thread(setup, symmetry="whole")
    check(whole, scatter)
    if whole.crossovers is not None:
        zone = replace(whole.crossovers, seed=(seed, number))
        whole = replace(whole, impact_point=draw_aim(whole, seed, number), crossovers=zone)
    factors = draw_factors(scatter, seed, number * (stride or whole.plies))
    if all(factor == 1 for factor in factors.values()):
        pack = whole.target(whole.table(kept=True))
    else:
        pack = scale_setup(whole, **factors).target()
    strength = YarnStrength(scatter.shape, seed, scatter.gauge_length)
    pack = with_strengths(pack, strength, number, stride)
    drawn_strengths = [ply.strength_factors or () for ply in pack.plies]
    warp, weft = (min(float(of[family].min()) for of in drawn_strengths) for family in (0, 1))
    return Drawn(pack, factors, (warp, weft))


def draw_aim(setup: ImpactSetup, seed: int, number: int) -> tuple[float, float]:
    """Draw the impact point [m] of a number, anywhere in a cell of the weave about that of the
    set-up."""
    x, y = aim(setup.fabric.weave, [seed, number])
    return setup.impact_point[0] + x, setup.impact_point[1] + y


def check(setup: ImpactSetup, scatter: Scatter) -> None:
    """Raise an InputError if the strengths of these plies cannot be drawn."""
    if setup.strength is not None:
        raise InputError(key="strength", allowed="left out: a V50 draws the strengths itself")
    require_failure(setup, "strengths are drawn, and the yarns do not fail")
    if setup.surface is not None and (scatter.modulus or scatter.crimp):
        raise InputError(
            "a response surface holds for one modulus and one crimp",
            key="scatter of modulus and crimp",
            allowed="0",
        )


def require_failure(setup: ImpactSetup, why: str) -> None:
    """Refuse a set-up whose yarns do not fail, of which there is no limit.

    Raises
    ------
    InputError : with `why` as its message
    """
    if not setup.yarn_failure:
        raise InputError(why, key="yarn_failure", value=False, allowed="true")


def draw_factors(scatter: Scatter, seed: int, number: int) -> dict[str, float]:
    """Draw {"modulus", "crimp_warp", "crimp_weft": factor} of a number, from log-normal
    distributions of mean 1."""
    normal = np.random.default_rng([seed, number]).standard_normal(3)
    spreads = {
        "modulus": scatter.modulus,
        "crimp_warp": scatter.crimp,
        "crimp_weft": scatter.crimp,
    }
    factors = {}
    for (name, spread), z in zip(spreads.items(), normal):
        variance = log(1 + spread**2)
        factors[name] = float(np.exp(sqrt(variance) * z - 0.5 * variance))
    return factors
