"""Decks for other codes and fits to measured curves, of the Python interface."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fabrics.checks import FilePath

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.analysis.fit import Fit

__all__ = ["export", "fit"]


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
