"""Panels and packs whose yarns differ in strength, drawn from a seed and a number alone.

A yarn has one strength T_u all along, of a Weibull distribution of shape m,

    F(T) = 1 - exp(-(L / L0) (T / T0)^m)

over its length L in the panel; at the gauge length L0 its mean T0 Gamma(1 + 1/m) is the strength of the fabric's yarn,
so that a longer yarn is weaker by (L0 / L)^(1/m). Since the drawn value, that of the weakest place of the whole yarn,
is held against its tension everywhere, the yarn is taken as weak where the projectile strikes: the limit is on the safe
side. Modulus, and the crimp of either family, are one log-normal value for all plies, which are cut from one roll.
Every yarn of every ply is drawn: panels are whole.

On a graded panel (`shellfabric.panel.grading`) the yarns are drawn as on the uniform one; a line that stands for
several yarns has the strength of the weakest of them. Yarns of an oblique weave have the length of the panel's sides,
which is the most that they can have.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import gamma, inf, log, sqrt

import numpy as np

from fabrics.errors import InputError
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel import grading as grading_of_panels
from shellfabric.panel.model import Panel
from shellfabric.plies.model import Pack
from weavecell.studies.inputs import Scatter, alone, changed_setup

_SMALL = 11  # samples a side of a cell's table that no run uses


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


def drawn(setup: ImpactSetup, scatter: Scatter, seed: int, number: int) -> Drawn:
    """The panel or pack of a number.

    Raises
    ------
    InputError : yarns that do not fail, or a response surface where modulus or crimp scatter
    """
    whole = alone(setup, symmetry="whole")
    check(whole, scatter)
    plies = replace(whole, table_size=_SMALL).target().plies
    draws = [
        draw(scatter, seed, number * len(plies) + p, *_yarns(ply)) for p, ply in enumerate(plies)
    ]
    factors = draws[0][0]
    alike = all(factor == 1 for factor in factors.values())
    table = whole.table(kept=True) if alike else None
    pack = whole.target(table) if alike else changed_setup(whole, **factors).target()
    drawn_plies = tuple(
        replace(ply, strength_factors=strengths if ply.sides is None else of_lines(strengths, ply))
        for ply, (_, strengths) in zip(pack.plies, draws)
    )
    warp, weft = (
        min(float(strengths[family].min()) for _, strengths in draws) for family in (0, 1)
    )
    return Drawn(replace(pack, plies=drawn_plies), factors, (warp, weft))


def check(setup: ImpactSetup, scatter: Scatter) -> None:
    """InputError where the strengths of these plies cannot be drawn."""
    if not setup.failure:
        raise InputError(
            "strengths are drawn, and the yarns do not fail",
            key="yarn_failure",
            value=False,
            allowed="true",
        )
    if setup.surface is not None and (scatter.modulus or scatter.crimp):
        raise InputError(
            "a response surface holds for one modulus and one crimp",
            key="scatter of modulus and crimp",
            allowed="0",
        )


def _yarns(panel):
    """((warp, weft) yarns of a panel, (warp, weft) [m] of one)."""
    uniform = replace(panel, grading=None)
    return uniform.yarn_counts, tuple(
        count * side for count, side in zip(uniform.counts, uniform.spacing)
    )


def draw(
    scatter: Scatter, seed: int, number: int, counts: Sequence[int], lengths: Sequence[float]
) -> tuple[dict[str, float], tuple[np.ndarray, ...]]:
    """A panel's factors, from its number alone.

    Parameters
    ----------
    counts : (warp, weft) yarns
    lengths : (warp, weft) [m] of a yarn in the panel

    Returns
    -------
    ({"modulus", "crimp_warp", "crimp_weft": factor}, (warp, weft) (n,) factors on the strength of each yarn)
    """
    random = np.random.default_rng([seed, number])
    normal = random.standard_normal(3)
    factors = {
        name: _log_normal(spread, z)
        for name, spread, z in zip(
            ("modulus", "crimp_warp", "crimp_weft"),
            (scatter.modulus, scatter.crimp, scatter.crimp),
            normal,
        )
    }
    uniform = tuple(random.uniform(size=count) for count in counts)
    m = scatter.shape
    if m == inf:
        return factors, tuple(np.ones(count) for count in counts)
    return factors, tuple(
        (scatter.gauge_length / L) ** (1 / m) / gamma(1 + 1 / m) * (-np.log1p(-u)) ** (1 / m)
        for L, u in zip(lengths, uniform)
    )


def _log_normal(spread, z):
    """Mean 1, standard deviation `spread`, from a standard normal z."""
    variance = log(1 + spread**2)
    return float(np.exp(sqrt(variance) * z - 0.5 * variance))


def of_lines(strengths: Sequence[np.ndarray], panel: Panel) -> tuple[np.ndarray, ...]:
    """(warp, weft) strength factors of the lines of a graded panel, from those of all yarns."""
    lines = zip(strengths, panel.lines()[::-1], panel.weave.w[::-1], panel.yarn_axes[::-1])
    return tuple(
        grading_of_panels.weakest(factors, np.fix((1 + 1e-9) * x[axes] / (2 * w)))
        for factors, x, w, axes in lines
    )
