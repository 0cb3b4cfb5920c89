"""What is known of a fabric, a projectile, a metal or a backing: its numbers and where each comes from."""

from __future__ import annotations

import logging
import shutil
from math import pi
from pathlib import Path

from fabrics import assumed, catalogue, data_sheet
from fabrics import backings as backing_data
from fabrics import metals as metal_data
from fabrics import projectiles as projectile_data
from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, placed, unknown_name
from fabrics.base.schema import read_toml, validated
from weavecell.answers.tables import Tables
from weavecell.api.entrance import public
from weavecell.scenes import build
from weavecell.scenes.impact import ProjectileTable


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
