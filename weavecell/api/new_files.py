"""A first input file, and a fabric file from what a data sheet says."""

from __future__ import annotations

import logging
from pathlib import Path

from fabrics.base import door, files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.families import find_family, list_families
from weavecell import scenes
from weavecell.api import quantities
from weavecell.api.entrance import public


def _new_toml(file: FilePath) -> Path:
    """The path of a file that is to be written; an InputError if it exists or is not a TOML
    file."""
    path = Path(file)
    if path.suffix != ".toml":
        raise InputError(key="file", value=str(path), allowed="a path that ends in .toml")
    files.refuse_existing(path)
    return path


@public
def new_shot(file: FilePath) -> None:
    """Write a first input file, with a comment for each question that it answers.

    Parameters
    ----------
    file : the .toml file to write; never over one that exists

    Raises
    ------
    InputError : the file exists, or its name does not end in .toml

    Examples
    --------
    >>> wc.new_shot("shot.toml")
    >>> print(wc.impact("shot.toml", check=True))  # doctest: +ELLIPSIS
    my first shot: nothing is run...
    """
    path = _new_toml(file)
    template = Path(scenes.__file__).with_name("new_shot.toml").read_text("utf-8")
    files.write(path, template.replace("THIS_FILE", str(path)))
    logging.getLogger("weavecell").info(f"written to {path}")


@public
def new_fabric(
    file: FilePath,
    *,
    values: FilePath | None = None,
    yarn_curve: FilePath | None = None,
    picture_frame: FilePath | None = None,
    frame_side: float | str | None = None,
    bias_extension: FilePath | None = None,
    strip: str | tuple[float, float] | None = None,
    family: str | None = None,
) -> None:
    """Write a fabric file from data-sheet values, each with its source and status.

    What no data sheet states is assumed by fibre family when the file is used; the lines of the
    log, which the command prints, say what and what is missing. A platen curve is fitted by
    `weavecell calibrate FILE --platen-curve CURVE`.

    Parameters
    ----------
    file : the .toml file to write; never over one that exists
    values : CSV file with the columns key, warp, weft, source, status, or a data sheet as its maker prints it
        (text, CSV), of which what is understood is taken; without it the command asks for the values, and
        Python refuses
    yarn_curve : fit modulus and failure strain to this CSV file: strain and force of a yarn
    picture_frame : fit the trellis law to this CSV file: shear angle, and shear stress or force
    frame_side : side of the picture frame [m], needed if the file gives its force
    bias_extension : fit the trellis law to this CSV file: displacement and force of a bias strip
    strip : width and length of the bias strip between its clamps, such as "115 mm, 230 mm"
    family : para-aramid, UHMWPE, E-glass, nylon, polyester, PBO, carbon or LCP: family of which the
        yarns take what is assumed, if it does not follow from modulus and fibre density

    Raises
    ------
    InputError : the file exists, or a value or curve that is not allowed

    Examples
    --------
    >>> rows = ["key,warp,weft,source,status", "linear_density,1100 dtex,1100 dtex,sheet,measured"]
    >>> rows += ["fibre_density,1440 kg/m^3,1440 kg/m^3,sheet,measured", "modulus,96 GPa,96 GPa,sheet,measured"]
    >>> rows += ["failure_strain,3 %,3 %,sheet,measured", "crimp,2 %,1 %,sheet,measured"]
    >>> rows += ["count,10 1/cm,10 1/cm,sheet,measured"]
    >>> _ = open("values.csv", "w").write("\\n".join(rows))
    >>> wc.new_fabric("mine.toml", values="values.csv")
    >>> wc.fabric("mine.toml").name
    'mine'
    """
    from weavecell.scenes import fabric_file, printed_draft

    path = _new_toml(file)
    if family is not None:
        family = _family_name(family)
    if frame_side is None:
        side = None
    else:
        side = quantities.number(frame_side, "m", "frame_side")
    if strip is not None:
        strip = quantities.pair(strip, "m", "strip", "width and length")
    fitted: tuple[str, ...] = ()
    if yarn_curve is not None:
        fitted = fabric_file.OF_YARN_CURVE
    told: list[str] = []
    printed = values is not None and not fabric_file.is_own_table(values)
    if values is None and not door.in_terminal():
        allowed = "a CSV file of values, or a data sheet; the command alone asks for them"
        raise InputError("is missing", key="values", allowed=allowed)
    if values is not None and printed:
        draft, *told = printed_draft.read_draft(values, path.stem, family)
    elif values is not None:
        draft = fabric_file.read_draft(values, path.stem, family, fitted)
    else:
        draft = fabric_file.Draft(path.stem, _ask_values(family, fitted), family=family)
    draft, fits = fabric_file.with_curves(
        draft,
        yarn=yarn_curve,
        frame=picture_frame,
        side=side,
        bias=bias_extension,
        strip=strip,
    )
    if printed:
        told += [*fits, *printed_draft.write_draft(draft, path, fitted)]
    else:
        fabric = draft.write(path)
        told += fits
        told += [value.line(key) for key, value in draft.values.items() if value.stands_in]
        told += fabric_file.left_open(fabric, path)
    for line in told:
        logging.getLogger("weavecell").info(line)


def _family_name(text):
    """The name of the fibre family that a user means by a text."""
    found = find_family(text)
    if found is None:
        names = ", ".join(f"{each.name} ({', '.join(each.known_as)})" for each in list_families())
        allowed = (
            f"one of {names}; for another fibre the one most like it, whose ranges are then wider"
        )
        raise InputError(key="family", value=text, allowed=allowed)
    return found.name


def _ask_values(family, fitted):
    """{key: Value} that the user types in, but those that are `fitted`; a wrong value is to be typed
    again, and one that may be open, or is typical of the fibre family, left empty."""
    import typer

    from weavecell.scenes import fabric_file

    def value(key, text, default=None):
        while True:
            try:
                typed = typer.prompt(text, default=default, show_default=bool(default))
                if typed or default is None:
                    return fabric_file.check(key, typed)
                return ""
            except InputError as problem:
                typer.echo(str(problem), err=True)

    source = typer.prompt("source of the values", default="data sheet")
    values = {}
    for key in fabric_file.REQUIRED:
        if key in fitted:
            continue
        others = fabric_file.INSTEAD.get(key, ())
        typical = family is not None and key in fabric_file.TYPICAL
        if typical:
            skip = f" (Enter: typical of {family}, assumed)"
        elif others:
            skip = f" (Enter: from the {others[-1]})"
        else:
            skip = ""
        asked = fabric_file.ALL[key]
        text = f"{key} of the warp, {asked.meaning}, such as {asked.example}{skip}"
        warp = value(key, text, "" if others or typical else None)
        if not warp and typical:
            continue
        if not warp:
            key = others[-1]
            asked = fabric_file.ALL[key]
            warp = value(key, f"{key}, {asked.meaning}, such as {asked.example}")
        if key in fabric_file.OF_FABRIC:
            weft = ""
        else:
            weft = value(key, f"{key} of the weft", warp)
        values[key] = fabric_file.Value(warp, weft, source)
    return fabric_file.complete(values, family)
