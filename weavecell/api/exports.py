"""Decks for other codes, of the Python interface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fabrics.checks import FilePath

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup

__all__ = ["export"]


def export(
    setup: ImpactSetup, to: Literal["lsdyna", "radioss"], out: FilePath, *,
    units: Literal["kg-m-s", "g-mm-ms"] = "kg-m-s", match: Literal["plane", "uniaxial"] = "plane",
) -> dict[str, float]:  # fmt: skip
    """Write a panel or pack as a deck for another code, with the error of its material card.

    The deck has not been run in that code. Warp and weft of a turned ply are a second material with the same error.

    Parameters
    ----------
    setup : of `weavecell.setup`
    to : the code
    out : folder of the deck, its picture and report.html
    units : of the deck
    match : what the law is nearest to: the cell over the biaxial plane, or in uniaxial tension

    Returns
    -------
    dict of the law less the cell over the strength [-]: "rms" and "largest" over the biaxial plane, largest in
    "uniaxial" tension and in "shear" until locking

    Raises
    ------
    InputError : an unknown code, unit or match, or a set-up with what no deck holds; nothing has been written

    Examples
    --------
    >>> error = wc.export(wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us"), "lsdyna", "deck")
    >>> f"{100 * error['uniaxial']:.0f} % of the strength"
    '35 % of the strength'
    """
    from weavecell.report import deck_folder

    laws = setup.laws or setup.fabric.laws
    made = deck_folder.made_of(
        setup, to, units, match, title=f"{setup.title}, {setup.strike_velocity:g} m/s",
        source=laws[0].provenance if laws and setup.cell_model == "compressible" else f"none, {setup.cell_model} yarns",
    )  # fmt: skip
    deck_folder.write(made, Path(out), to, setup.fabric.name, match, "", setup.fabric)
    return made.cards[0].mismatch.numbers()
