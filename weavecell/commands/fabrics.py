"""Fabrics, projectiles and backings on the terminal: all in one table, or one with the source of each number.

`new` writes a fabric file from prompts, a CSV file or curves.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import assumed, catalogue, data_sheet, files, units
from fabrics import backings as backing_data
from fabrics import projectiles as projectile_data
from fabrics.errors import InputError
from shellfabric.plies import gap as ply_gap
from weavecell.commands.options import FabricArgument, ListOption, example
from weavecell.report import derived
from weavecell.scenes import fabric_file
from weavecell.scenes import impact as scenes_impact

# heading, unit, and what stands in the column
_COLUMNS = (
    ("fabric", "", lambda f: f.name),
    ("count", "1/cm", lambda f: f"{f.weave.warp_count / 100:.1f}/{f.weave.weft_count / 100:.1f}"),
    ("crimp", "%", lambda f: "/".join(f"{100 * yarn.crimp:.2f}" for yarn in f.weave.yarns)),
    ("mass", "g/m²", lambda f: f"{1000 * f.weave.areal_density:.1f}"),
    ("thick", "mm", lambda f: f"{1000 * f.weave.thickness:.3f}"),
    ("strength", "N/yarn", lambda f: "/".join(f"{yarn.strength:.0f}" for yarn in f.weave.yarns)),
    ("a", "mm", lambda f: f"{1000 * f.laws[0].a:.4f}" if f.laws else "-"),
    ("b", "mm N^⅓", lambda f: f"{1000 * f.laws[0].b:.3f}" if f.laws else "-"),
)
_PROJECTILE = ("mass", "diameter", "length")
_BACKING = ("density", "modulus", "yield_stress", "rate_exponent", "erosion_strain")


@example("weavecell fabrics list")
def show_all(out: ListOption = None) -> None:
    """The catalogue, one line a fabric."""
    rows = [[column(fabric) for _, _, column in _COLUMNS] for fabric in map(catalogue.load, catalogue.list_names())]
    if out is not None:
        files.write_csv(out, [[f"{name} [{unit}]" if unit else name for name, unit, _ in _COLUMNS], *rows])
    heads = [f"{name}\n[dim]{unit}[/]" for name, unit, _ in _COLUMNS]
    print_table("Fabrics of the catalogue (warp / weft)", heads, rows)


@example("weavecell fabrics show S-720 --out .")
def show(
    name: FabricArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Also copy its data file here, to start your own from.", metavar="FOLDER"),
    ] = None,
) -> None:
    """One fabric: what follows from its data, and where each number comes from."""
    given = catalogue.load(name)
    fabric = _completed(given)
    if out is not None:
        _copy(name, Path(out))
    print_table(f"{fabric.name}: what follows", ["quantity", "value"], derived.derived(fabric))
    for note in fabric.notes:
        print(note)
    rows = _assumptions(given, fabric)
    if rows:
        print_table(f"{fabric.name}: what is assumed", ["key", "value (range)", "source"], rows, numeric=False)
    rows = [(key, entry["value"], entry["status"], entry["source"]) for key, entry in given.sources.items()]
    print_table(
        f"{fabric.name}: where each number comes from", ["key", "value", "status", "source"], rows, numeric=False
    )


def _completed(fabric):
    """The fabric with the laws that are assumed for it, as far as its yarns belong to a family."""
    for complete in (assumed.with_shear, assumed.with_solid_laws):
        try:
            fabric = complete(fabric)
        except InputError as problem:
            print(f"note: {problem}")
    return fabric


def _assumptions(given, fabric):
    """(key, value with its range, source) of what the file does not give and a command takes in its place."""
    rows = []
    if "crimp" in fabric.assumed:
        share, factor = (data_sheet.entries()[name] for name in ("warp_share", "thickness"))
        ends = assumed.crimp_ends(fabric).values()
        for k, family in enumerate(data_sheet.FAMILIES):
            found = [each.weave.yarns[k].crimp for each in (fabric, *ends)]
            span = f"{100 * found[0]:.2f} % ({100 * min(found):.2f} .. {100 * max(found):.2f} %)"
            if given.sources[f"{family}.crimp"]["source"] == data_sheet.FROM_THICKNESS:
                rows.append((f"{family}.crimp", span, data_sheet.FROM_THICKNESS))
        rows.append(("thickness, factor", factor.written, factor.source))
        rows.append(("warp share of the heights", share.written, share.source))
    rows += [
        (key, entry["value"], entry["source"]) for key, entry in fabric.sources.items() if key not in given.sources
    ]
    gap = ply_gap.ply_gap(given)
    if gap.high > gap.low:
        rows.append((
            "interlayer_gap", f"{1e3 * gap.value:.3g} mm ({1e3 * gap.low:.3g} .. {1e3 * gap.high:.3g} mm)",
            f"{gap.source}; {data_sheet.entries()['ply_gap'].source}",
        ))  # fmt: skip
    if given.section is None:
        rows.append(("section", "sine, ellipse or conforming", "the first of these that fits (3D crossover)"))
    return rows


def _copy(name, folder):
    """Copy the data file of a fabric of the catalogue into `folder`; never over a file that is there."""
    target = folder / f"{name}.toml"
    if target.exists():
        raise InputError("exists already", file=target)
    source = Path(catalogue.__file__).parent / f"{name}.toml"
    if not source.exists():
        raise InputError(key="FABRIC", value=name, allowed=f"one of {', '.join(catalogue.list_names())} to be copied")
    with files.replace_whole(target) as beside:
        shutil.copyfile(source, beside)


def print_table(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]], numeric: bool = True) -> None:
    """Print a table; of a numeric one the columns but the first are aligned to the right, and nothing is folded."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(
        title=title, title_justify="left", title_style="bold", header_style="bold",
        box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False,
    )  # fmt: skip
    for position, head in enumerate(heads):
        table.add_column(head, justify="right" if numeric and position else "left", overflow="fold", no_wrap=numeric)
    for row in rows:
        table.add_row(*row)
    Console().print(table)


PathArgument = Annotated[
    Path, typer.Argument(metavar="FILE.toml", help="The file to write; never over one that exists.")
]
FromOption = Annotated[
    Path | None,
    typer.Option("--from", help="Values: columns key, warp, weft, source, status; else prompts.", metavar="VALUES.csv"),
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


@example("weavecell fabrics new mine.toml --from mine.csv")
def new(
    path: PathArgument,
    values: FromOption = None,
    yarn_curve: YarnOption = None,
    picture_frame: FrameOption = None,
    frame_side: SideOption = None,
) -> None:
    """Write a fabric file from data-sheet values, each with its source and status.

    What no data sheet states is assumed by fibre family when the file is used; the command prints what that will be. A
    platen curve is fitted by `weavecell calibrate FILE --platen-curve CURVE.csv`.
    """
    if path.suffix != ".toml":
        raise InputError(key="FILE.toml", value=str(path), allowed="a path that ends in .toml")
    if path.exists():
        raise InputError("exists already", file=path)
    side = None if frame_side is None else units.si(frame_side, "m", key="--frame-side")
    entered = fabric_file.read_values(values) if values is not None else _prompt()
    draft = fabric_file.Draft(path.stem, entered, file=values)
    draft, fitted = fabric_file.with_curves(draft, yarn=yarn_curve, frame=picture_frame, side=side)
    fabric = draft.write(path)
    for line in (*fitted, *fabric_file.left_open(fabric)):
        typer.echo(line)
    typer.echo(f"written to {path}")


def _prompt():
    """{key: Value} that the user types in; a wrong value is to be typed again, and one that may be open left empty."""
    source = typer.prompt("source of the values", default="data sheet")
    found = {}
    for key in fabric_file.REQUIRED:
        others = fabric_file.INSTEAD.get(key, ())
        skip = f" (Enter: from the {others[-1]})" if others else ""
        asked = fabric_file.ALL[key]
        text = f"{key} of the warp, {asked.meaning}, such as {asked.example}{skip}"
        warp = _value(key, text, "" if others else None)
        if not warp:
            key = others[-1]
            asked = fabric_file.ALL[key]
            warp = _value(key, f"{key}, {asked.meaning}, such as {asked.example}")
        weft = "" if key in fabric_file.OF_FABRIC else _value(key, f"{key} of the weft", warp)
        found[key] = fabric_file.Value(warp, weft, source)
    return found


def _value(key, text, default=None):
    while True:
        try:
            given = typer.prompt(text, default=default, show_default=bool(default))
            return fabric_file.check(key, given) if given or default is None else ""
        except InputError as problem:
            typer.echo(str(problem), err=True)


@example("weavecell projectiles list")
def projectiles(out: ListOption = None) -> None:
    """Fragment simulators, cylinders and spheres that an input file may name, one line each."""
    rows = []
    for name in projectile_data.list_names():
        shape, data = projectile_data.entry(name)
        given = [data[key]["value"] if key in data else "" for key in _PROJECTILE]
        rows.append((name, shape, *given, f"{data['diameter']['status']}: {data['diameter']['source']}"))
    _all("Projectiles", ("projectile", "nose", *_PROJECTILE, "source of the diameter"), rows, out)


@example("weavecell backings list")
def backings(out: ListOption = None) -> None:
    """Clay and gelatine that an input file may name behind a panel, one line each."""
    rows = []
    for name in backing_data.list_names():
        data, speed = backing_data.entry(name), f"{backing_data.load(name).wave_speed:.0f}"
        rows.append((name, *(data[key]["value"] for key in _BACKING), speed, data["yield_stress"]["status"]))
    _all("Backings", ("backing", *_BACKING, "wave speed [m/s]", "status of the yield stress"), rows, out)


@example('weavecell projectiles show "FSP 1.10 g"')
def projectile(
    name: Annotated[str, typer.Argument(metavar="PROJECTILE", help="A name of the list.")],
) -> None:
    """One projectile: where each number comes from."""
    shape, data = projectile_data.entry(name, key="PROJECTILE")
    _one(f"{name}, {scenes_impact.SHAPES[shape]} of steel of {1e-3 * projectile_data.density():g} g/cm³", data)


@example('weavecell backings show "gelatine 10 %"')
def backing(
    name: Annotated[str, typer.Argument(metavar="BACKING", help="A name of the list.")],
) -> None:
    """One backing: where each number comes from."""
    _one(name, backing_data.entry(name, key="BACKING"))


def _all(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], out: Path | None) -> None:
    if out is not None:
        files.write_csv(out, [heads, *rows])
    print_table(title, heads, rows, numeric=False)


def _one(title: str, data: Mapping[str, Any]) -> None:
    rows = [(key, one["value"], one["status"], one["source"]) for key, one in data.items()]
    print_table(title, ("key", "value", "status", "source"), rows, numeric=False)
