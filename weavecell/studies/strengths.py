"""Panels and packs of a V50, drawn from a seed and a number alone.

The yarns differ in strength (`shellfabric.impact.strengths`). Modulus, and the crimp of either
family, are one log-normal value for all plies, which are cut from one roll.

Resolved yarns are struck anywhere in a repeat of the weave, by a nose that has turned about its axis
by any angle: nobody aims at a crossover, nor holds the roll of a fragment. Places and rolls are
spread: point k of a Sobol sequence, shifted by what the seed draws. Pinned yarns have no places, and
keep the roll that is given.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from math import log, pi, remainder, sqrt

import numpy as np

from fabrics.base.errors import InputError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.impact.strengths import YarnStrength, with_strengths
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from weavecell.studies.assumed_range import set_value
from weavecell.studies.inputs import Scatter, scale_setup, use_one_thread
from weavecell.studies.unknown import FRICTIONS, find_unknown

# [spacings] along warp and weft from a crossover: every other place of a plain weave is the image of
# one in here, by the middle lines of the yarns and by a step along both families
PLACES = 0.5, 1.0
PLACE = "place"
# shares of a drawn shot: along warp and weft, of the roll, and of each friction
SHARES_OF_PLACE = 3
SHARES = SHARES_OF_PLACE + len(FRICTIONS)


@dataclass(frozen=True)
class Drawn:
    """One drawn panel.

    Parameters
    ----------
    pack : Pack of whole plies
    factors : {"modulus", "crimp_warp", "crimp_weft": factor [-] of all plies}
    weakest : (warp, weft) [-] factor on the strength of the weakest yarn of any ply
    frictions : {column: [-] where nobody gave it, else None}
    """

    pack: Pack
    factors: dict[str, float]
    weakest: tuple[float, float]
    frictions: dict[str, float | None]


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
    frictions = draw_frictions(whole, seed, number)
    for name, value in frictions.items():
        whole = set_value(whole, name, value)
    whole = _place(whole, seed, number)
    factors = draw_factors(scatter, seed, number * (stride or whole.plies))
    if all(factor == 1 for factor in factors.values()):
        pack = whole.target(whole.table(kept=True))
    else:
        pack = scale_setup(whole, **factors).target()
    strength = YarnStrength(scatter.shape, seed, scatter.gauge_length)
    pack = with_strengths(pack, strength, number, stride)
    drawn_strengths = [ply.strength_factors or () for ply in pack.plies]
    warp, weft = (min(float(of[family].min()) for of in drawn_strengths) for family in (0, 1))
    told = {one.column: frictions.get(name) for name, one in FRICTIONS.items()}
    return Drawn(pack, factors, (warp, weft), told)


def _place(setup, seed, number):
    """The set-up with the place, the roll and the lie of the plies of a number, of resolved yarns."""
    if setup.crossovers is None:
        return setup
    zone = replace(setup.crossovers, seed=(seed, number))
    aim = draw_aim(setup, seed, number)
    nose = draw_roll(setup.projectile, seed, number)
    return replace(setup, impact_point=aim, projectile=nose, crossovers=zone)


def check_places(setup: ImpactSetup, scatter: Scatter, seed: int, shots: int) -> None:
    """Refuse a set-up as `check` does, or if one of its drawn panels cannot be built, such as in an opening
    that leaves no room for the zone of resolved yarns about every drawn place; nothing is run.

    Raises
    ------
    InputError
    """
    check(setup, scatter)
    if setup.crossovers is None:
        return
    whole = replace(setup, symmetry="whole")
    for number in range(shots):
        _place(whole, seed, number).plain_target()


def draw_aim(setup: ImpactSetup, seed: int, number: int) -> tuple[float, float]:
    """Draw the impact point [m] of a number: in a repeat of the weave, from the crossover that is
    nearest to the set-up's."""
    spread = _spread(seed, number)
    found = []
    weave = setup.fabric.weave
    places: tuple[float, float] = PLACES
    if not weave.pattern.is_plain:
        warp_yarns, weft_yarns = weave.pattern.matrix.shape
        places = weft_yarns, warp_yarns
    for point, half, share, reach in zip(setup.impact_point, weave.w, spread, places):
        spacing = 2 * half
        found.append(float(spacing * (round(point / spacing) + share * reach)))
    return found[0], found[1]


def draw_roll(nose: Projectile, seed: int, number: int) -> Projectile:
    """Draw the roll of the nose of a number, beyond its own: any angle of a half turn, after which a
    chisel is the same; of a body of an STL file of a full one."""
    if nose.known.turned:
        return nose
    turn = pi
    if nose.known.from_file:
        turn = 2 * pi
    roll = nose.roll + turn * float(_spread(seed, number)[2])
    return replace(nose, roll=remainder(roll, 2 * pi))


def draw_frictions(setup: ImpactSetup, seed: int, number: int) -> dict[str, float]:
    """Draw the frictions of a number that nobody gave, evenly over their ranges: {what is assumed: [-]}.

    Each has a share of its own, so that set-ups of which other frictions are known draw the same."""
    shares = dict(zip(FRICTIONS, _spread(seed, number)[SHARES_OF_PLACE:]))
    return {
        name: float(low + shares[name] * (high - low))
        for name, (low, high) in find_unknown(setup).items()
    }


def draw_known(setup: ImpactSetup, seed: int, number: int) -> dict[str, float]:
    """Return what is known of a drawn shot, from which its limit is estimated: {word: [-] about 0}.

    The place counts where it goes from gap to crossover, on plain weaves under noses that are round about
    their axis; elsewhere what it does is part of the rest.
    """
    spread = _spread(seed, number)
    found = {}
    plain = all(fabric.weave.pattern.is_plain for fabric in setup.fabrics)
    if setup.crossovers is not None and plain and setup.plies == 1 and not _has_roll(setup):
        found[PLACE] = float(0.5 * (np.cos(np.pi * spread[0]) + np.cos(2 * np.pi * spread[1])))
    shares = dict(zip(FRICTIONS, spread[SHARES_OF_PLACE:]))
    for name in find_unknown(setup):
        found[FRICTIONS[name].words] = float(shares[name] - 0.5)
    return found


def _has_roll(setup):
    """Whether the nose is not the same at every roll."""
    shot = setup.projectile
    return not shot.known.turned


def _spread(seed, number):
    """(SHARES,) of the numbers from 0 on they are spread evenly, each by itself may be anywhere."""
    # the first draws of the shift are those of the place
    shift = np.random.default_rng(seed).uniform(size=SHARES)
    return (_sobol_points(1 + number)[number] + shift) % 1.0


@cache
def _sobol_points(least):
    """At least so many points of the sequence."""
    if least & (least - 1):
        return _sobol_points(1 << least.bit_length())
    # takes a quarter of a second to load, which one run at nominal values does not need
    from scipy.stats import qmc

    return qmc.Sobol(SHARES, scramble=False).random(least)


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
