"""A panel or pack as a deck for another code."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fabrics.base.checks import FilePath
from fabrics.base.schema import changed
from weavecell.answers.deck import DeckResult
from weavecell.api.entrance import public
from weavecell.api.target import resolve_target
from weavecell.results import out_folder

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.impact.setup import ImpactSetup


@out_folder.reading
@public
def export(
    target: Fabric | FilePath | ImpactSetup,
    to: str,
    out: FilePath,
    *,
    units: Literal["kg-m-s", "g-mm-ms"] = "kg-m-s",
    match: Literal["plane", "uniaxial"] = "plane",
) -> DeckResult:
    """Export a panel or pack as a deck for another code: mesh, material card, boundary, rigid
    projectile, contact, output.

    The error of the material card against the unit cell is in the deck's header, printed, and in
    report.html. Warp and weft of a turned ply are a second material with the same error. The keys
    of an input file that a deck leaves out are in its header and printed: nothing breaks in it, and
    plies touch with the stiffness of the code. OpenRadioss was run with earlier decks, LS-DYNA was
    not: see docs/reports/cards.md.

    The folder then holds NAME.k, or NAME_0000.rad and NAME_0001.rad, with mapping.svg, summary.json
    and report.html.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or
        a set-up of `setup`
    to : code that the deck is for: lsdyna, radioss, or one that an installed package adds
    out : folder of the deck
    units : consistent units of the deck: kg-m-s or g-mm-ms
    match : what the law is nearest to: the cell over the biaxial plane (plane), or in uniaxial
        tension (uniaxial)

    Returns
    -------
    DeckResult

    Raises
    ------
    InputError : an unknown code, unit or match, or a target with what no deck holds; nothing has
        been written

    Examples
    --------
    >>> shot = wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> deck = wc.export(shot, "lsdyna", "deck")
    >>> f"{100 * deck.summary()['uniaxial']:.0f} % of the strength"
    '35 % of the strength'
    """
    from weavecell.decks import folder, model

    folder.check(to, units, match)
    panel = resolve_target(target, {}, "export")
    code = folder.codes()[to]
    if panel.from_file:
        stem = Path(panel.name).stem
    else:
        stem = panel.setup.fabric.name
    with out_folder.hold(out, folder.names(to, stem)), panel.name_problems():
        given: tuple[str, ...] = ()
        if panel.case is not None:
            given = tuple(changed(panel.case.scene))
        names = {"title": panel.shot_title, "source": panel.law_name}
        deck = model.build(panel.setup, code, units, match, **names, given=given)
        folder.write(deck, Path(out), to, stem, match, panel.text, panel.setup.fabric)
    errors = {card.name: card.mismatch.numbers() for card in deck.cards}
    return DeckResult(code.NAME, errors, deck.left_out)
