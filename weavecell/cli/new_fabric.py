"""`weavecell fabrics new`: prompts for data-sheet values, or reads them from a CSV file, and writes a fabric file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fabrics.errors import InputError

EPILOG = "Example: [bold]weavecell fabrics new mine.toml --from mine.csv[/bold]"

PathArgument = Annotated[
    Path, typer.Argument(metavar="FILE.toml", help="The file to write; never over one that exists.")
]
FromOption = Annotated[
    Path | None,
    typer.Option("--from", help="Values: columns key, warp, weft, source, status; else prompts.", metavar="VALUES.csv"),
]
TexGenOption = Annotated[
    Path | None,
    typer.Option(
        "--texgen", help="Counts, crimp, width, area and thickness of a plain weave of TexGen.", metavar="FILE.tg3"
    ),
]
YarnOption = Annotated[
    Path | None,
    typer.Option(
        "--yarn-curve", help="Fit modulus and failure strain: strain and force of a yarn.", metavar="CURVE.csv"
    ),
]
FrameOption = Annotated[
    Path | None,
    typer.Option(
        "--picture-frame",
        help="Fit the trellis law: shear angle, and shear stress or force.",
        metavar="CURVE.csv",
    ),
]
SideOption = Annotated[
    str | None,
    typer.Option(
        "--frame-side", help="Side of the picture frame, needed where the file gives its force.", metavar="LENGTH"
    ),
]


def new(
    path: PathArgument,
    values: FromOption = None,
    texgen: TexGenOption = None,
    yarn_curve: YarnOption = None,
    picture_frame: FrameOption = None,
    frame_side: SideOption = None,
) -> None:
    """Write a fabric file from data-sheet values, each with its source and status.

    What no data sheet states is assumed by fibre family when the file is used; the command prints what that will be. A
    platen curve is fitted by `weavecell calibrate FILE --platen-curve CURVE.csv`. Values of --from, or typed in, add to
    those of a TexGen file and replace them.
    """
    from fabrics.units import si
    from weavecell.scenes import fabric_file

    if path.suffix != ".toml":
        raise InputError(key="FILE.toml", value=str(path), allowed="a path that ends in .toml")
    if path.exists():
        raise InputError("exists already", file=path)
    side = None if frame_side is None else si(frame_side, "m", key="--frame-side")
    known = {}
    if texgen is not None:
        from meshing.texgen.geometry import WeaveGeometry

        known = fabric_file.from_texgen(WeaveGeometry.read(texgen))
    found = fabric_file.read_values(values, known) if values is not None else _prompt(fabric_file, known)
    draft = fabric_file.Draft(path.stem, known | found)
    draft, fitted = fabric_file.with_curves(draft, yarn=yarn_curve, frame=picture_frame, side=side)
    fabric = draft.write(path)
    for line in (*fitted, *fabric_file.left_open(fabric)):
        typer.echo(line)
    typer.echo(f"written to {path}")


def _prompt(fabric_file, known):
    """{key: Value} that the user types in; a wrong value is to be typed again, and one that may be open left empty.

    Keys of `known` are not asked for.
    """
    source = typer.prompt("source of the values", default="data sheet")
    found = {}
    for key, (_, example, meaning) in fabric_file.KEYS.items():
        if key in known:
            continue
        others = fabric_file.INSTEAD.get(key, ())
        skip = f" (Enter: from the {others[-1]})" if others else ""
        warp = _value(
            fabric_file, key, f"{key} of the warp, {meaning}, such as {example}{skip}", "" if others else None
        )
        if not warp:
            key = others[-1]
            _, example, meaning = fabric_file.ALL[key]
            warp = _value(fabric_file, key, f"{key}, {meaning}, such as {example}")
        weft = "" if key in fabric_file.OF_FABRIC else _value(fabric_file, key, f"{key} of the weft", warp)
        found[key] = fabric_file.Value(warp, weft, source)
    return found


def _value(fabric_file, key, text, default=None):
    while True:
        try:
            given = typer.prompt(text, default=default, show_default=bool(default))
            return fabric_file.check(key, given) if given or default is None else ""
        except InputError as problem:
            typer.echo(str(problem), err=True)
