"""Fabrics, projectiles and backings by name, a new fabric file, and a look at results."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from fabrics import assumed, catalogue, data_sheet
from fabrics import backings as backing_data
from fabrics import projectiles as projectile_data
from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.fabric_tables import FIBRES
from weavecell.api import quantities
from weavecell.api.result import saved

__all__ = [
    "Listing",
    "backings",
    "fabrics",
    "new_fabric",
    "projectiles",
    "show_backing",
    "show_fabric",
    "show_projectile",
    "view",
]

# columns of the list of fabrics, what stands in them
COLUMNS: dict[str, Callable[[Fabric], str]] = {
    "fabric": lambda f: f.name,
    "count [1/cm]": lambda f: f"{f.weave.warp_count / 100:.1f}/{f.weave.weft_count / 100:.1f}",
    "crimp [%]": lambda f: "/".join(f"{100 * yarn.crimp:.2f}" for yarn in f.weave.yarns),
    "mass [g/m²]": lambda f: f"{1000 * f.weave.areal_density:.1f}",
    "thick [mm]": lambda f: f"{1000 * f.weave.thickness:.3f}",
    "strength [N/yarn]": lambda f: "/".join(f"{yarn.strength:.0f}" for yarn in f.weave.yarns),
    "a [mm]": lambda f: f"{1000 * f.laws[0].a:.4f}" if f.laws else "-",
    "b [mm N^⅓]": lambda f: f"{1000 * f.laws[0].b:.3f}" if f.laws else "-",
}
MASS, STRENGTH = "mass [g/m²]", "strength [N/yarn]"
SOURCES = ("key", "value", "status", "source")
PROJECTILE = ("mass", "diameter", "length")
BACKING = ("density", "modulus", "yield_stress", "rate_exponent", "erosion_strain")


@dataclass(frozen=True, repr=False)
class Listing(Sequence):
    """Tables of texts, which a terminal and a notebook show; as a sequence the names in the first column.

    Parameters
    ----------
    tables : {title: (headings, rows)}
    notes : lines below the first table
    numeric : whether the columns of the first table but the first are numbers, which are set flush right

    Examples
    --------
    >>> print(wc.show_backing("gelatine 10 %"))  # doctest: +ELLIPSIS
    gelatine 10 %...
    """

    tables: dict[str, tuple[tuple[str, ...], list[tuple[str, ...]]]]
    notes: tuple[str, ...] = ()
    numeric: bool = False

    def __len__(self) -> int:
        return len(next(iter(self.tables.values()))[1])

    def __getitem__(self, index: Any) -> Any:
        return [name for name, *_ in next(iter(self.tables.values()))[1]][index]

    def _repr_html_(self) -> str:
        from pandas import DataFrame

        tables = {
            title: DataFrame(rows, columns=list(heads))
            for title, (heads, rows) in self.tables.items()
        }
        return "".join(
            f"<b>{escape(title)}</b>{of.to_html(index=False, border=0)}"
            for title, of in tables.items()
        )

    def save(self, out: FilePath) -> None:
        """Write the first table as CSV."""
        heads, rows = next(iter(self.tables.values()))
        files.write_csv(out, [heads, *rows])

    def __str__(self) -> str:
        from rich import box
        from rich.console import Console
        from rich.table import Table

        console = Console(force_jupyter=False)
        with console.capture() as shown:
            for number, (title, (heads, rows)) in enumerate(self.tables.items()):
                right = self.numeric and number == 0
                table = Table(
                    title=title, title_justify="left", title_style="bold", header_style="bold"
                )
                table.box, table.pad_edge, table.padding = box.SIMPLE_HEAD, False, (0, 1, 0, 0)
                for k, head in enumerate(heads):
                    name, _, unit = head.partition(" [")
                    text = (
                        f"{name}\n[dim]{unit.rstrip(']')}[/]"
                        if right and unit
                        else head.replace("[", "\\[")
                    )
                    justify: Any = "right" if right and k else "left"
                    table.add_column(text, justify=justify, overflow="fold", no_wrap=right)
                for row in rows:
                    table.add_row(*row)
                console.print(table)
                for note in self.notes if number == 0 else ():
                    console.print(note, markup=False)
        return shown.get().rstrip("\n")

    __repr__ = __str__


def fabrics(*, out: FilePath | None = None) -> Listing:
    """The catalogue, one line a fabric.

    Parameters
    ----------
    out : also write it as this CSV file

    Examples
    --------
    >>> wc.fabrics()[:2]
    ['S-720', 'S-726']
    >>> heads, rows = wc.fabrics().tables["Fabrics of the catalogue (warp / weft)"]
    >>> dict(zip(heads, rows[0]))["mass [g/m²]"]
    '252.9'
    """
    rows = [
        tuple(text(fabric) for text in COLUMNS.values())
        for fabric in map(catalogue.load, catalogue.list_names())
    ]
    loaded = map(catalogue.load, catalogue.list_names())
    fired = [f.with_effective_density() for f in loaded if f.effective_linear_density is not None]
    effective = [f"{f.name} {COLUMNS[MASS](f)} g/m² and {COLUMNS[STRENGTH](f)} N" for f in fired]
    note = (
        "Mass and strength are those of the data sheet; shots use the effective linear density of the published runs: "
        f"{'; '.join(effective)}."
    )
    title = "Fabrics of the catalogue (warp / weft)"
    return saved(Listing({title: (tuple(COLUMNS), rows)}, (note,), numeric=True), out)


def projectiles(*, out: FilePath | None = None) -> Listing:
    """Fragment simulators, cylinders and spheres that an input file may name, one line each.

    Parameters
    ----------
    out : also write it as this CSV file

    Examples
    --------
    >>> wc.projectiles()[3]
    'FSP 1.10 g'
    """
    rows = []
    for name in projectile_data.list_names():
        shape, data = projectile_data.entry(name)
        values = [data[key]["value"] if key in data else "" for key in PROJECTILE]
        rows.append(
            (name, shape, *values, f"{data['diameter']['status']}: {data['diameter']['source']}")
        )
    heads = ("projectile", "nose", *PROJECTILE, "source of the diameter")
    return saved(Listing({"Projectiles": (heads, rows)}), out)


def backings(*, out: FilePath | None = None) -> Listing:
    """Clay and gelatine that an input file may name behind a panel, one line each.

    Parameters
    ----------
    out : also write it as this CSV file

    Examples
    --------
    >>> wc.backings()[0]
    'Roma Plastilina No. 1'
    """
    rows = []
    for name in backing_data.list_names():
        data, speed = backing_data.entry(name), f"{backing_data.load(name).wave_speed:.0f}"
        rows.append(
            (name, *(data[key]["value"] for key in BACKING), speed, data["yield_stress"]["status"])
        )
    heads = ("backing", *BACKING, "wave speed [m/s]", "status of the yield stress")
    return saved(Listing({"Backings": (heads, rows)}), out)


def show_projectile(name: str) -> Listing:
    """One projectile: where each number comes from.

    Parameters
    ----------
    name : of the list

    Examples
    --------
    >>> print(wc.show_projectile("FSP 1.10 g"))  # doctest: +ELLIPSIS
    FSP 1.10 g, ...
    """
    from weavecell.scenes.impact import SHAPES

    shape, data = projectile_data.entry(name, key="PROJECTILE")
    steel = (
        "" if name.endswith(".toml") else f" of steel of {1e-3 * projectile_data.density():g} g/cm³"
    )
    return Listing({f"{name}, {SHAPES[shape]}{steel}": _sources(data)})


def show_backing(name: str) -> Listing:
    """One backing: where each number comes from.

    Parameters
    ----------
    name : of the list

    Examples
    --------
    >>> print(wc.show_backing("gelatine 10 %"))  # doctest: +ELLIPSIS
    gelatine 10 %...
    """
    return Listing({name: _sources(backing_data.entry(name, key="BACKING"))})


def _sources(data):
    return SOURCES, [
        (key, entry["value"], entry["status"], entry["source"]) for key, entry in data.items()
    ]


def show_fabric(fabric: FilePath, *, out: FilePath | None = None) -> Listing:
    """One fabric: what follows from its data, and where each number comes from.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file
    out : also copy its data file to this folder, to start your own from

    Raises
    ------
    InputError : no such fabric, or the folder holds such a file already

    Examples
    --------
    >>> print(wc.show_fabric("S-720"))  # doctest: +ELLIPSIS
    S-720: what follows...
    """
    from weavecell.report import derived

    plain = whole = catalogue.load(fabric)
    problems = []
    for complete in (assumed.with_shear, assumed.with_solid_laws):
        try:
            whole = complete(whole)
        except InputError as problem:
            problems.append(f"note: {problem}")
    if out is not None:
        _copy(str(fabric), Path(out))
    tables: dict[str, Any] = {
        f"{whole.name}: what follows": (("quantity", "value"), derived.derived(whole))
    }
    if rows := _assumptions(plain, whole):
        tables[f"{whole.name}: what is assumed"] = ("key", "value (range)", "source"), rows
    tables[f"{whole.name}: where each number comes from"] = _sources(plain.sources)
    return Listing(tables, (*problems, *whole.notes), numeric=True)


def _assumptions(plain, whole):
    """(key, value with its range, source) of what the file does not give and a command takes in its place."""
    from shellfabric.plies import gap as ply_gap

    rows, entries = [], data_sheet.entries()
    if "crimp" in whole.assumed:
        ends = assumed.crimp_ends(whole).values()
        for k, family in enumerate(data_sheet.FAMILIES):
            crimp, *others = [100 * fabric.weave.yarns[k].crimp for fabric in (whole, *ends)]
            low, high = min(crimp, *others), max(crimp, *others)
            if plain.sources[f"{family}.crimp"]["source"] == data_sheet.FROM_THICKNESS:
                span = f"{crimp:.2f} % ({low:.2f} .. {high:.2f} %)"
                rows.append((f"{family}.crimp", span, data_sheet.FROM_THICKNESS))
        rows.append(
            ("thickness, factor", entries["thickness"].written, entries["thickness"].source)
        )
        rows.append(
            (
                "warp share of the heights",
                entries["warp_share"].written,
                entries["warp_share"].source,
            )
        )
    if "failure_length" in whole.assumed:
        rows.append(
            ("failure_length", entries["failure_length"].written, entries["failure_length"].source)
        )
    added = {key: entry for key, entry in whole.sources.items() if key not in plain.sources}
    rows += [(key, entry["value"], entry["source"]) for key, entry in added.items()]
    gap = ply_gap.ply_gap(plain)
    if gap.high > gap.low:
        span = f"{1e3 * gap.value:.3g} mm ({1e3 * gap.low:.3g} .. {1e3 * gap.high:.3g} mm)"
        rows.append(("interlayer_gap", span, f"{gap.source}; {entries['ply_gap'].source}"))
    if plain.section is None:
        rows.append(
            (
                "section",
                "sine, ellipse or conforming",
                "the first of these that fits (3D crossover)",
            )
        )
    return rows


def _copy(name, folder):
    """Copy the data file of a fabric of the catalogue into `folder`; never over a file that is there."""
    target = folder / f"{name}.toml"
    if target.exists():
        raise InputError("exists already", file=target)
    source = Path(catalogue.__file__).parent / f"{name}.toml"
    if not source.exists():
        raise InputError(
            key="fabric",
            value=name,
            allowed=f"one of {', '.join(catalogue.list_names())} to be copied",
        )
    with files.replace_whole(target) as beside:
        shutil.copyfile(source, beside)


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

    What no data sheet states is assumed by fibre family when the file is used; the lines of the log, which the command
    prints, say what and what is missing. A platen curve is fitted by `weavecell calibrate FILE --platen-curve CURVE`.

    Parameters
    ----------
    file : the .toml file to write; never over one that exists
    values : CSV file of values: columns key, warp, weft, source, status; else the terminal asks for them
    yarn_curve : fit modulus and failure strain to this CSV file: strain and force of a yarn
    picture_frame : fit the trellis law to this CSV file: shear angle, and shear stress or force
    frame_side : side of the picture frame [m], needed where the file gives its force
    bias_extension : fit the trellis law to this CSV file: displacement and force of a bias strip
    strip : width and length of the bias strip between its clamps, such as "115 mm, 230 mm"
    family : para-aramid, UHMWPE or E-glass: family of which other yarns (PBO, LCP, nylon) take what is assumed

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
    from weavecell.scenes import fabric_file

    path = Path(file)
    if path.suffix != ".toml":
        raise InputError(key="file", value=str(path), allowed="a path that ends in .toml")
    if path.exists():
        raise InputError("exists already", file=path)
    if family not in (None, *FIBRES):
        raise InputError(key="family", value=family, allowed=f"one of {', '.join(FIBRES)}")
    side = None if frame_side is None else quantities.number(frame_side, "m", "frame_side")
    if strip is not None:
        strip = quantities.pair(strip, "m", "strip", "width and length")
    entered = _asked() if values is None else fabric_file.read_values(values)
    draft = fabric_file.Draft(path.stem, entered, file=values, family=family)
    draft, fitted = fabric_file.with_curves(
        draft,
        yarn=yarn_curve,
        frame=picture_frame,
        side=side,
        bias=bias_extension,
        strip=strip,
    )
    fabric = draft.write(path)
    for line in (*fitted, *fabric_file.left_open(fabric, path)):
        logging.getLogger("weavecell").info(line)


def _asked():
    """{key: Value} that the user types in; a wrong value is to be typed again, and one that may be open left empty."""
    import typer

    from weavecell.scenes import fabric_file

    def value(key, text, default=None):
        while True:
            try:
                typed = typer.prompt(text, default=default, show_default=bool(default))
                return fabric_file.check(key, typed) if typed or default is None else ""
            except InputError as problem:
                typer.echo(str(problem), err=True)

    source = typer.prompt("source of the values", default="data sheet")
    values = {}
    for key in fabric_file.REQUIRED:
        others = fabric_file.INSTEAD.get(key, ())
        skip = f" (Enter: from the {others[-1]})" if others else ""
        asked = fabric_file.ALL[key]
        text = f"{key} of the warp, {asked.meaning}, such as {asked.example}{skip}"
        warp = value(key, text, "" if others else None)
        if not warp:
            key = others[-1]
            asked = fabric_file.ALL[key]
            warp = value(key, f"{key}, {asked.meaning}, such as {asked.example}")
        weft = "" if key in fabric_file.OF_FABRIC else value(key, f"{key} of the weft", warp)
        values[key] = fabric_file.Value(warp, weft, source)
    return values


def view(
    file: FilePath,
    *,
    html: FilePath | None = None,
    screenshot: FilePath | None = None,
    movie: FilePath | None = None,
    cut: bool = False,
) -> None:
    """Look at a mesh or a result in a window, or write a picture, a movie or an interactive page of it.

    A picture or movie of a panel or pack shows all of it, its projectile, a scale of the tensions and the outcome; with
    cut its section along the warp through the impact point.

    Parameters
    ----------
    file : a folder of results, or a .vtu, .pvd or .msh file
    html : write a page, FILE.html, in which a browser shows the panel or pack from all sides at all snapshots
    screenshot : write a picture, FILE.png, instead of opening a window
    movie : write the snapshots of a panel or pack as a movie, FILE.gif or FILE.mp4 (which needs imageio)
    cut : the section through the impact point in place of the whole panel or pack

    Raises
    ------
    InputError : there is nothing to be shown, a file with another ending, or no display for a window

    Examples
    --------
    >>> wc.mesh("S-720", mesh="coarse", out="mesh") and wc.view("mesh", screenshot="mesh.png")  # doctest: +SKIP
    """
    from weavecell.report.shot.view import show

    picture, film, page = (
        None if path is None else Path(path) for path in (screenshot, movie, html)
    )
    show(Path(file), picture, film, page, cut)
    for path in (film, page, picture):
        if path is not None:
            logging.getLogger("weavecell").info(f"written to {path}")
