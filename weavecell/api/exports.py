"""A panel or pack as a deck for another code.

The folder of `weavecell export`
    NAME.k                       the deck for LS-DYNA
    NAME_0000.rad, NAME_0001.rad the decks of OpenRadioss's starter and engine
    mapping.svg                  the law less the cell over the biaxial plane
    summary.json                 the mapping's error, provenance
    report.html                  the error in a table and the plot, and what the law does not hold
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from fabrics.base.checks import FilePath
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import changed
from weavecell.answers.result import Result
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


@explain_frozen
@dataclass(frozen=True, repr=False)
class DeckResult(Result):
    """The error of the material cards of a deck.

    Parameters
    ----------
    code : that the deck is for
    errors : {material: law less the cell over the strength [-]}: "rms" and "largest" over the
        biaxial plane, largest in "uniaxial" tension and in "shear" until locking
    keys_left_out : keys of the scene that the deck leaves out, with what follows

    Examples
    --------
    >>> shot = wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> list(wc.export(shot, "radioss", "deck").errors)
    ['S-720']
    """

    code: str
    errors: dict[str, dict[str, float]]
    keys_left_out: tuple[str, ...] = ()

    def summary(self) -> dict[str, Any]:
        """Return the errors of the first material."""
        return next(iter(self.errors.values()))

    def _columns(self):
        rows = list(self.errors.values())
        return {"material": list(self.errors)} | {
            name: [row[name] for row in rows] for name in rows[0]
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        from weavecell.decks.folder import percent

        lines = []
        for name, numbers in self.errors.items():
            errors = ", ".join(f"{key} {percent(value)}" for key, value in numbers.items())
            lines.append(f"{name}: {errors}")
        lines.append(f"of the strength; the deck has not been run in {self.code}")
        if self.keys_left_out:
            lines.append(f"left out of the input file: {', '.join(self.keys_left_out)}")
        return lines
