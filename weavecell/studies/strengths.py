"""Panels and packs of a V50, drawn from a seed and a number alone.

All that nobody knows of a shot is drawn from the rows of `unknown`; the yarns differ in strength
(`shellfabric.impact.strengths`). Modulus and crimp are one value for all plies, which are cut from one roll.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from fabrics.base.errors import InputError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.impact.strengths import YarnStrength, with_strengths
from shellfabric.plies.model import Pack
from weavecell.studies import unknown
from weavecell.studies.inputs import Scatter, use_one_thread

FACTORS = {
    "modulus": "modulus",
    "crimp_warp": "crimp of the warp",
    "crimp_weft": "crimp of the weft",
}
draw_known = unknown.draw_known


@dataclass(frozen=True)
class Drawn:
    """One drawn panel.

    Parameters
    ----------
    pack : Pack of whole plies
    values : {column: drawn [SI]} of `unknown.ROWS`
    weakest : (warp, weft) [-] factor on the strength of the weakest yarn of any ply
    """

    pack: Pack
    values: dict[str, float]
    weakest: tuple[float, float]

    @property
    def factors(self) -> dict[str, float]:
        """{"modulus", "crimp_warp", "crimp_weft": factor [-] of all plies}"""
        columns = {key: unknown.column_of(name) for key, name in FACTORS.items()}
        return {key: self.values.get(column, 1.0) for key, column in columns.items()}


def draw_panel(
    setup: ImpactSetup, scatter: Scatter, seed: int, number: int, stride: int | None = None
) -> Drawn:
    """Draw the panel or pack of a number.

    Parameters
    ----------
    stride : as in `with_strengths`, of what is to be drawn alike

    Raises
    ------
    InputError : as `check`
    """
    whole = use_one_thread(setup, symmetry="whole")
    check(whole, scatter)
    materials = whole.materials
    whole, values = unknown.draw(whole, scatter, seed, number, number * (stride or whole.plies))
    if whole.crossovers is not None:
        # plies lie shifted against each other
        whole = replace(whole, crossovers=replace(whole.crossovers, seed=(seed, number)))
    # plies of the same cell have their table in the cache
    pack = whole.target(whole.table(kept=True)) if whole.materials == materials else whole.target()
    strength = YarnStrength(scatter.shape, seed)
    pack = with_strengths(pack, strength, number, stride)
    drawn_strengths = [ply.strength_factors or () for ply in pack.plies]
    warp, weft = (min(float(of[family].min()) for of in drawn_strengths) for family in (0, 1))
    told = {unknown.column_of(name): value for name, value in values.items()}
    return Drawn(pack, told, (warp, weft))


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
        unknown.put_place(whole, seed, number).plain_target()


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
