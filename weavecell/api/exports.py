"""Decks for other codes and fits to measured curves, of the Python interface."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from fabrics.checks import FilePath
from weavecell.api import targets
from weavecell.api.result import Result

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.analysis.fit import Fit

__all__ = ["DeckResult", "export", "fit"]


def export(
    target: Fabric | FilePath | ImpactSetup, to: Literal["lsdyna", "radioss"], out: FilePath, *,
    units: Literal["kg-m-s", "g-mm-ms"] = "kg-m-s", match: Literal["plane", "uniaxial"] = "plane",
) -> DeckResult:  # fmt: skip
    """A panel or pack as a deck for another code: mesh, material card, boundary, rigid projectile, contact, output.

    The error of the material card against the unit cell is in the deck's header, printed, and in report.html. Warp and
    weft of a turned ply are a second material with the same error. Of an input file, the tables history and numerics,
    the contact law of plies, and what a run records mean nothing here. Nothing breaks in a deck. OpenRadioss was run
    with earlier decks, LS-DYNA was not: see docs/reports/cards.md.

    The folder then holds NAME.k, or NAME_0000.rad and NAME_0001.rad, with mapping.svg, summary.json and report.html.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or a set-up of `setup`
    to : code that the deck is for: lsdyna or radioss
    out : folder of the deck
    units : consistent units of the deck: kg-m-s or g-mm-ms
    match : what the law is nearest to: the cell over the biaxial plane (plane), or in uniaxial tension (uniaxial)

    Returns
    -------
    DeckResult

    Raises
    ------
    InputError : an unknown code, unit or match, or a target with what no deck holds; nothing has been written

    Examples
    --------
    >>> shot = wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> deck = wc.export(shot, "lsdyna", "deck")
    >>> f"{100 * deck.summary()['uniaxial']:.0f} % of the strength"
    '35 % of the strength'
    """
    from weavecell.report import deck_folder

    panel = targets.of(target, {}, deck_folder.SUPPORT)
    with targets.folder_of(out), panel.named():
        made = deck_folder.made_of(panel.setup, to, units, match, title=panel.shot_title, source=panel.law_name)
        stem = Path(panel.name).stem if panel.from_file else panel.setup.fabric.name
        deck_folder.write(made, Path(out), to, stem, match, panel.text, panel.setup.fabric)
    return DeckResult(deck_folder.CODES[to].name, {card.name: card.mismatch.numbers() for card in made.cards})


@dataclass(frozen=True, repr=False)
class DeckResult(Result):
    """The error of the material cards of a deck.

    Parameters
    ----------
    code : that the deck is for
    errors : {material: law less the cell over the strength [-]}: "rms" and "largest" over the biaxial plane, largest
        in "uniaxial" tension and in "shear" until locking

    Examples
    --------
    >>> shot = wc.setup("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> list(wc.export(shot, "radioss", "deck").errors)
    ['S-720']
    """

    code: str
    errors: dict[str, dict[str, float]]

    def summary(self) -> dict[str, Any]:
        """The errors of the first material."""
        return next(iter(self.errors.values()))

    def _columns(self):
        rows = list(self.errors.values())
        return {"material": list(self.errors)} | {name: [row[name] for row in rows] for name in rows[0]}

    def __str__(self) -> str:
        from weavecell.report.deck_folder import ROWS, percent

        lines = [
            f"{name}: " + ", ".join(f"{ROWS[key]} {percent(value)}" for key, value in numbers.items())
            for name, numbers in self.errors.items()
        ]
        return "\n".join([*lines, f"of the strength; the deck has not been run in {self.code}"])


def fit(
    target: FilePath, data: FilePath, free: Sequence[str], out: FilePath, *, jobs: int = 1,
    executor: str | Executor = "local", resume: bool = False,
) -> Fit | None:  # fmt: skip
    r"""Fit numbers of a fabric or an input file to a measured curve; the files of `weavecell fit` are written to `out`.

    Parameters
    ----------
    target : input file of a shot or a coupon, or a fabric's name or file
    data : CSV file with units in its heading, as of `weavecell fit`
    free : texts NAME or NAME=LOW..HIGH: factors on the fabric, such as "modulus", or keys of the input file that hold a
        number; none for a curve of platens
    out : folder of the results
    jobs, executor : as of `sweep`
    resume : whether to take the runs that `out` holds

    Returns
    -------
    Fit: parameters, values, intervals, determined, correlation; of a curve of platens None, and solid.json

    Raises
    ------
    InputError : a wrong file, table or parameter; nothing has been written
    UnstableError : the model cannot be computed where the fit begins

    Examples
    --------
    >>> from pathlib import Path
    >>> test = '[picture_frame]\nshear_angle = "5 deg"\ncrossovers = 2\n[run]\nsteps = 2\n'
    >>> _ = Path("frame.toml").write_text('[fabric]\nname = "S-720"\n' + test)
    >>> _ = Path("curve.csv").write_text("shear angle [deg], shear stress [MPa]\n3, 0.45\n4, 0.6\n5, 0.75\n")
    >>> found = wc.fit("frame.toml", "curve.csv", ["trellis_stiffness"], "fit")  # doctest: +ELLIPSIS
    trellis_stiffness           x 0.88...written to fit
    >>> [round(float(factor), 2) for factor in found.values]
    [0.89]
    """
    from weavecell.commands import fit as command

    return command.run(str(target), Path(data), Path(out), list(free), jobs=jobs, executor=executor, resume=resume)
