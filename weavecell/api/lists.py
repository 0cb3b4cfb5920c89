"""Fabrics, projectiles, metals and backings by name, a new fabric file, and a look at results."""

from __future__ import annotations

import logging
import shutil
import sys
from html import escape
from math import isnan, pi
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics import assumed, catalogue, data_sheet
from fabrics import backings as backing_data
from fabrics import metals as metal_data
from fabrics import projectiles as projectile_data
from fabrics.base import door, files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, placed, unknown_name
from fabrics.base.extras import explain_missing
from fabrics.base.schema import read_toml, validated
from fabrics.base.sourced import assumed_of
from fabrics.base.units import si
from fabrics.families import find_family, list_families
from weavecell import scenes
from weavecell.api import quantities
from weavecell.api.entrance import public
from weavecell.scenes import build
from weavecell.scenes.impact import ProjectileTable

if TYPE_CHECKING:
    from pandas import DataFrame


class Tables(dict[str, "DataFrame"]):
    """{title: DataFrame}, one below the other in a terminal and in a notebook.

    Examples
    --------
    >>> print(wc.show("gelatine 10 %"))  # doctest: +ELLIPSIS
    gelatine 10 %...
    """

    def __str__(self) -> str:
        return "\n\n".join(format_for_terminal(table, title) for title, table in self.items())

    __repr__ = __str__

    def _repr_html_(self) -> str:
        parts = []
        for title, table in self.items():
            parts.append(f"<b>{escape(title)}</b>{table.to_html(border=0)}")
        return "".join(parts)


@explain_missing()
def format_for_terminal(table: DataFrame, title: str = "") -> str:
    """Format a table as text: units below the names of columns, numbers with four digits, long
    texts in several lines."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text as AsItIs

    # texts of users may have square brackets, in which rich looks for marks
    shown = Table(title=AsItIs(title) if title else None, title_justify="left", title_style="bold")
    shown.box = box.SIMPLE_HEAD
    shown.pad_edge = shown.show_edge = False
    rows = table.reset_index()
    numbers = set(rows.select_dtypes("number"))
    if numbers:
        shown.padding = 0
    for name in rows:
        if name in numbers:
            # a word a line keeps nine numbers and a name within the 80 columns of a terminal
            heading = AsItIs("\n".join(word.strip("[]") for word in name.split()))
            shown.add_column(heading, justify="right")
        else:
            is_name = bool(numbers) and name == table.index.name
            shown.add_column(AsItIs(str(name)), overflow="fold", no_wrap=is_name)
    for row in rows.itertuples(index=False):
        shown.add_row(*(AsItIs(_cell(value)) for value in row))
    # a notebook keeps text and asks for colours: marks of bold would be kept with it
    console = Console(force_jupyter=False, force_terminal=sys.stdout.isatty())
    with console.capture() as printed:
        console.print(shown)
    return "\n".join(line.rstrip() for line in printed.get().rstrip("\n").split("\n"))


def _cell(value):
    if not isinstance(value, float):
        return str(value)
    # a sphere has no length
    if isnan(value):
        return "–"
    return f"{value:.4g}"


@public
def fabrics(*, out: FilePath | None = None) -> DataFrame:
    """List the catalogue, a row a fabric.

    Mass and strength are those of the data sheet. Shots use the linear density of the published
    runs, where the file has it, which gives the mass in shots.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.fabrics()["mass [g/m²]"]["S-720"].round(1)
    252.9
    """
    rows = {}
    for name in catalogue.list_names():
        fabric = catalogue.load(name)
        weave = fabric.weave
        shot_at = fabric
        if fabric.effective_linear_density is not None:
            shot_at = fabric.with_effective_density()
        rows[name] = {
            "warp count [1/cm]": weave.warp_count / 100,
            "weft count [1/cm]": weave.weft_count / 100,
            "warp crimp [%]": 100 * weave.warp.crimp,
            "weft crimp [%]": 100 * weave.weft.crimp,
            "mass [g/m²]": 1e3 * weave.areal_density,
            "mass in shots [g/m²]": 1e3 * shot_at.weave.areal_density,
            "thick [mm]": 1e3 * weave.thickness,
            "warp strength [N]": weave.warp.strength,
            "weft strength [N]": weave.weft.strength,
        }
    return _tabulate("fabric", rows, out)


# (key of a projectile, SI unit, column in thousandths of it)
_SIZES = (
    ("mass", "kg", "mass [g]"),
    ("diameter", "m", "diameter [mm]"),
    ("length", "m", "length [mm]"),
)


@public
def projectiles(*, out: FilePath | None = None) -> DataFrame:
    """List the fragment simulators, cylinders, spheres and bullets that an input file may name, a
    row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.projectiles().index[3]
    'FSP 1.10 g'
    """
    rows = {}
    for name in projectile_data.list_names():
        shape, data = projectile_data.entry(name)
        metals = [data[key]["value"] for key in ("core", "jacket") if key in data]
        row: dict[str, str | float] = {"nose": shape}
        # a sphere has no length, a body of an STL file no diameter
        for key, unit, column in _SIZES:
            if key in data:
                row[column] = 1e3 * si(data[key]["value"], unit)
        rigid = "steel, rigid" if name in projectile_data.TABLES.own else "rigid"
        row["metal"] = " in ".join(metals) or rigid
        assumed_keys = [key for key in assumed_of(data) if key != "mass_tolerance"]
        row["assumed"] = ", ".join(assumed_keys).replace("_", " ") or "nothing"
        rows[name] = row
    return _tabulate("projectile", rows, out)


@public
def metals(*, out: FilePath | None = None) -> DataFrame:
    """List the metals that core and jacket of a projectile may name, a row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.metals().index[0]
    'lead'
    """
    rows = {}
    for name in metal_data.list_names():
        metal = metal_data.load(name)
        rows[name] = {
            "density [kg/m³]": metal.density,
            "modulus [GPa]": metal.modulus / 1e9,
            "yield stress [MPa]": metal.yield_stress / 1e6,
            "hardening [MPa]": metal.hardening / 1e6,
            "hardening exponent": metal.hardening_exponent,
            "rate coefficient": metal.rate_coefficient,
            "failure strain": metal.failure_strain,
            "status of the yield stress": metal_data.entry(name)["yield_stress"]["status"],
        }
    return _tabulate("metal", rows, out)


@public
def backings(*, out: FilePath | None = None) -> DataFrame:
    """List the clay and gelatine that an input file may name behind a panel, a row each.

    Parameters
    ----------
    out : also write it as this CSV file; never over one that exists

    Examples
    --------
    >>> wc.backings().index[0]
    'Roma Plastilina No. 1'
    """
    rows = {}
    for name in backing_data.list_names():
        material = backing_data.load(name)
        rows[name] = {
            "density [kg/m³]": material.density,
            "modulus [MPa]": material.modulus / 1e6,
            "yield stress [MPa]": material.yield_stress / 1e6,
            "rate exponent": material.rate_exponent,
            "erosion strain": material.erosion_strain,
            "wave speed [m/s]": material.wave_speed,
            "status of the yield stress": backing_data.entry(name)["yield_stress"]["status"],
        }
    return _tabulate("backing", rows, out)


def _tabulate(kind, rows, out):
    """The table of {name: {column: value}}, which is also written to `out` if that is given."""
    from weavecell.results.readable import ReadableTable

    table = ReadableTable.from_dict(rows, orient="index").rename_axis(kind)
    if out is not None:
        files.refuse_existing(out)
        files.write(out, table.to_csv(float_format="%.6g"))
    return table


@public
def show(name: FilePath, *, out: FilePath | None = None) -> Tables:
    """Show a fabric, a projectile, a metal or a backing: what follows from its data, and where each
    number comes from.

    Parameters
    ----------
    name : of one of the lists, or the path of a file of a fabric or of a projectile
    out : folder to write to: of a fabric its data file, to start your own from; of a projectile of
        metal its drawing

    Raises
    ------
    InputError : nothing has this name, or the folder holds such a file already

    Examples
    --------
    >>> print(wc.show("FSP 1.10 g"))  # doctest: +ELLIPSIS
    FSP 1.10 g, ...
    """
    text = str(name)
    known = [*catalogue.list_names()]
    for data in (projectile_data, metal_data, backing_data):
        known += data.list_names()
    if text not in known and not text.endswith(".toml"):
        raise unknown_name("name", text, known, key="name")
    for data in (metal_data, backing_data):
        if text in data.list_names():
            _refuse_folder(out)
            return Tables({text: _sources(data.entry(text))})
    if text in projectile_data.list_names() or _is_of_a_projectile(text):
        return _projectile(text, out)
    tables = _fabric(text)
    if out is not None:
        _copy(text, Path(out))
    return tables


def _refuse_folder(out):
    """Refuse the folder of a look at something that nothing is written of."""
    if out is not None:
        allowed = "left out unless a fabric or a projectile of metal is shown"
        raise InputError(key="out", value=str(out), allowed=allowed)


def _is_of_a_projectile(name):
    """Whether a name is the path of a file that says how wide something is, as only a projectile's
    does."""
    return name.endswith(".toml") and "diameter" in read_toml(name, what="fabric")[1]


def _projectile(name, out):
    """What follows from the data of a projectile, and where each number comes from, those of its
    metals too; the drawing of a projectile of metal goes to the folder `out`."""
    from pandas import DataFrame

    from shellfabric.projectile.shapes import SHAPES

    shape, data = projectile_data.entry(name)
    title = f"{name}, {SHAPES[shape].words}"
    if "core" not in data:
        _refuse_folder(out)
        if name in projectile_data.TABLES.own:
            title += f" of steel of {1e-3 * projectile_data.density():g} g/cm³"
        return Tables({title: _sources(data)})
    body = _body_of(name)
    if out is not None:
        # a name such as .22 LR would make a hidden file
        stem = Path(name).name.removesuffix(".toml").lstrip(".")
        _draw(stem, body, data, Path(out) / f"{stem}.png")
    following = DataFrame(_drawn_rows(body), columns=["quantity", "value"])
    tables = Tables({f"{title}: what follows": following.set_index("quantity")})
    tables[f"{title}: where each number comes from"] = _sources(data)
    for key in ("core", "jacket"):
        metal = data.get(key, {}).get("value")
        if metal in metal_data.list_names():
            tables[f"{key}, {metal}"] = _sources(metal_data.entry(metal))
    return tables


def _body_of(name):
    """The Projectile of a name, or of the path of a file."""
    table = projectile_data.table(name) | {"strike_velocity": "1 m/s"}
    file = name if name.endswith(".toml") else None
    with placed(file):
        return build.make_projectile(validated(ProjectileTable, table, file))


def _draw(name, body, data, target):
    """Draw a projectile of metal at rest as a PNG file; never over one that is there."""
    from weavecell.report import pictures_body, pictures_figure

    files.refuse_existing(target)
    core, jacket = (data.get(key, {}).get("value", "") for key in ("core", "jacket"))
    with pictures_figure.plots() as pyplot, files.write_whole(target, "wb") as file:
        figure = pictures_body.drawings(pyplot, {name: (body.turned, core, jacket)})
        figure.savefig(file, format="png")
    logging.getLogger("weavecell").info(f"written to {target}")


def _drawn_rows(body):
    """(quantity, value) of the drawing of a projectile of metal."""
    drawing = body.turned
    masses = drawing.element_masses
    off = 100 * (drawing.density_factor - 1)
    rows = [("mass of the drawing", f"{1e3 * drawing.drawn_mass:.3f} g, given {off:+.1f} %")]
    if drawing.jacket is not None:
        rows.append(("mass of the jacket", f"{1e3 * masses[drawing.jacketed].sum():.3f} g"))
    area = pi * drawing.radius**2
    rows.append(("mass over the area of its cross-section", f"{1e-1 * body.mass / area:.3f} g/cm²"))
    rows.append(("elements of its mesh", str(len(masses))))
    return rows


def _fabric(name):
    """What follows from the data of a fabric, what is assumed, and where each number comes from."""
    from pandas import DataFrame

    from weavecell.report import derived

    plain = whole = catalogue.load(name)
    notes = []
    for complete in (assumed.with_shear, assumed.with_solid_laws):
        try:
            whole = complete(whole)
        except InputError as problem:
            notes.append(("note", str(problem)))
    if whole.idealised:
        notes.append(("idealised", assumed.describe_idealised(whole)))
    notes += [("note", note.removeprefix("note: ")) for note in whole.notes]
    following = DataFrame([*derived.derive_rows(whole), *notes], columns=["quantity", "value"])
    tables = Tables({f"{whole.name}: what follows": following.set_index("quantity")})
    if rows := _assumptions(plain, whole):
        columns = ["key", "value (range)", "source"]
        tables[f"{whole.name}: what is assumed"] = DataFrame(rows, columns=columns).set_index("key")
    tables[f"{whole.name}: where each number comes from"] = _sources(plain.sources)
    return tables


def _sources(data):
    """A row a number: its value with its range, status and source."""
    from pandas import DataFrame

    rows = {}
    for key, row in data.items():
        rows[key] = {"value": row["value"], "status": row["status"], "source": row["source"]}
        if "range" in row:
            low, high = row["range"]
            rows[key]["value"] += f" ({low} .. {high})"
    return DataFrame.from_dict(rows, orient="index").rename_axis("key").astype(str)


# what a computed crimp follows from (`assumed.entries_of_crimp`), as a row of a table names it
_CRIMP_ROWS = {
    "areal_density": "areal density, factor",
    "thickness": "thickness, factor",
    "warp_share": "warp share of the heights",
    "straight_floats": "share of a float that is straight",
}


def _assumptions(plain, whole):
    """(key, value with its range, source) of what the file does not give and a command takes in its
    place."""
    from shellfabric.plies import gap as ply_gap

    rows = []
    if "crimp" in whole.assumed:
        ends = assumed.crimp_ends(whole).values()
        for k, family in enumerate(data_sheet.FAMILIES):
            crimp, *others = [100 * fabric.weave.yarns[k].crimp for fabric in (whole, *ends)]
            low = min(crimp, *others)
            high = max(crimp, *others)
            origin = plain.sources[f"{family}.crimp"]["source"]
            if origin in (data_sheet.FROM_MASS, data_sheet.FROM_THICKNESS):
                span = f"{crimp:.2f} % ({low:.2f} .. {high:.2f} %)"
                rows.append((f"{family}.crimp", span, origin))
        for name in assumed.entries_of_crimp(whole):
            rows.append((_CRIMP_ROWS[name], *_read_entry(name)))
    of_fabric = assumed.shot_entries(whole)
    of_fabric["failure_length"] = data_sheet.failure_length(whole.weave)
    for name, entry in of_fabric.items():
        # that on the nose is of the input file, whatever the fabric
        if name in whole.assumed or name == data_sheet.FRICTION_OF_PROJECTILE:
            rows.append((name, entry.written, entry.source))
    added = {key: entry for key, entry in whole.sources.items() if key not in plain.sources}
    rows += [(key, entry["value"], entry["source"]) for key, entry in added.items()]
    gap = ply_gap.ply_gap(plain)
    if gap.high > gap.low:
        span = f"{1e3 * gap.value:.3g} mm ({1e3 * gap.low:.3g} .. {1e3 * gap.high:.3g} mm)"
        rows.append(("interlayer_gap", span, f"{gap.source}; {_read_entry('ply_gap')[1]}"))
    if plain.section is None:
        rows.append(
            (
                "section",
                "sine, ellipse or conforming",
                "the first of these that fits (3D crossover)",
            )
        )
    return rows


def _read_entry(name):
    """(value with its range, source) of an entry of data_sheet.toml."""
    entry = data_sheet.entries()[name]
    return entry.written, entry.source


def _copy(name, folder):
    """Copy the data file of a fabric of the catalogue into `folder`; never over a file that is
    there."""
    target = folder / f"{name}.toml"
    files.refuse_existing(target)
    if name not in catalogue.list_names():
        allowed = f"one of {', '.join(catalogue.list_names())} to be copied"
        raise InputError(key="fabric", value=name, allowed=allowed)
    with files.replace_whole(target) as beside:
        shutil.copyfile(catalogue.list_files()[name], beside)


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


@explain_missing()
@public
def view(
    file: FilePath,
    *,
    html: FilePath | None = None,
    screenshot: FilePath | None = None,
    movie: FilePath | None = None,
    cut: bool = False,
    beside: FilePath | None = None,
) -> None:
    """Look at a mesh or a result in a window, or write a picture, a movie or an interactive page of
    it.

    No file is written over one that exists. A picture or movie of a panel or pack shows all of it,
    its projectile, a scale of the tensions and the outcome; with cut its section along the warp
    through the impact point.

    Parameters
    ----------
    file : a folder of results, or a .vtu, .pvd or .msh file
    html : write a page, FILE.html, in which a browser shows the panel or pack from all sides at all
        snapshots
    screenshot : write a picture, FILE.png, instead of opening a window
    movie : write the snapshots of a panel or pack as a movie, FILE.gif or FILE.mp4 (which needs
        imageio)
    cut : the section through the impact point in place of the whole panel or pack
    beside : the folder of another shot: the page has both, A and B, with what differs, both in motion
        under one slider with one scale of colours, and both histories

    Raises
    ------
    InputError : there is nothing to be shown, or no two shots, a file with another ending or one that exists, or no
        display for a window

    Examples
    --------
    >>> wc.mesh("S-720", mesh="coarse", out="mesh") and wc.view("mesh", screenshot="mesh.png")  # doctest: +SKIP
    """
    from weavecell.report.shot.view import show

    picture, film, page = (
        None if path is None else Path(path) for path in (screenshot, movie, html)
    )
    show(Path(file), picture, film, page, cut, None if beside is None else Path(beside))
    for path in (film, page, picture):
        if path is not None:
            logging.getLogger("weavecell").info(f"written to {path}")
