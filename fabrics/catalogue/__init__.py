"""The catalogue: fabrics as data files, one TOML file each, every number with its unit, source and
status.

A number is written `{ value = "1420 denier", source = "...", status = "measured" }`, or just `"1420
denier"` in a user's own file. What data sheets state is enough: strength or tenacity in place of
the failure strain, the thickness of the fabric in place of crimps (`fabrics.data_sheet`). Statuses:
measured, computed, fitted, derived, assumed, corrected (a misprint of the thesis, put right) and
user.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path

from fabrics import assumed, data_sheet, plausible, ply_laws
from fabrics.base import plugs
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, nearest_name
from fabrics.base.files import parse_toml
from fabrics.base.schema import parse_source, read_source, validated
from fabrics.compression import CompressionLaw, check_room
from fabrics.fabric import Fabric
from fabrics.fabric_tables import (
    FAMILIES,
    OF_YARN,
    RANGED,
    STATUSES,
    Datum,
    FabricFile,
    Laws,
    Solids,
)
from fabrics.families.strain_rate import RateLaw
from fabrics.pattern import PLAIN
from fabrics.solid import SolidLaw
from fabrics.trellis import TrellisShear
from fabrics.weave import Weave
from fabrics.yarn import CLOSEST_PACKING, Yarn

__all__ = ["STATUSES", "list_files", "list_names", "load", "read"]

_FOLDER = Path(__file__).parent
# fabrics that are not built again while their files stay as they are
MOST_KEPT = 32


@cache
def list_files() -> dict[str, Path]:
    """List the files of the catalogue, {name of its fabric: path}, sorted; and of those that installed
    packages add (`fabrics.base.plugs`), which are read as a user's files are.

    Raises
    ------
    InputError : as `plugs.data_files`
    """
    own = {path.stem: path for path in _FOLDER.glob("*.toml")}
    return dict(sorted((own | plugs.data_files("weavecell.fabrics", own)).items()))


def list_names() -> tuple[str, ...]:
    """List the names of the fabrics in the catalogue, sorted."""
    return tuple(list_files())


def load(name_or_path: FilePath) -> Fabric:
    """Load a fabric of the catalogue by name, or a user's fabric file by path (it ends in .toml).

    Parameters
    ----------
    name_or_path : name of the catalogue, or path of a .toml file

    Raises
    ------
    InputError : no such fabric or file, or the file is wrong: one line naming the file, key, value
        and what is allowed
    """
    text = str(name_or_path)
    if text in list_files():
        return read(list_files()[text])
    if not text.endswith(".toml"):
        allowed = f"one of {', '.join(list_names())}, or the path of a .toml file"
        raise unknown(text, allowed, key="fabric")
    return read(Path(text))


def unknown(name: str, allowed: str, *, key: str, file: object = None) -> InputError:
    """Return the InputError of a `name` that no fabric has, with the name it may be meant for, or
    what it is the path of."""
    path = Path(name)
    near = nearest_name(name, list_names())
    hint = None
    if near:
        hint = f'did you mean "{near}"?'
    # an empty text is the path of no file
    if name and path.exists():
        hint = "is a file of another kind"
        if path.is_dir():
            hint = "is a folder"
    return InputError(hint, key=key, value=name, allowed=allowed, file=file)


def read(path: FilePath, text: str | None = None) -> Fabric:
    """Read one fabric file, or the `text` that is to become one.

    Raises
    ------
    InputError : as `load`; all values that are wrong, one line each
    """
    path = Path(path)
    if text is not None:
        return _build(parse_toml(text), path)
    return _build_once(read_source(path, what="fabric"), path)


@lru_cache(maxsize=MOST_KEPT)
def _build_once(text, path):
    """The Fabric of the text of a file; that of the same text is built once."""
    return _build(parse_source(text, path), path)


def _build(content, path):
    """The Fabric of the table of a file."""
    of_run = {"panel", "projectile", "run"} & set(content)
    if of_run or isinstance(content.get("fabric"), dict):
        allowed = "a fabric; functions that run something take an input file as it is"
        raise InputError("is an input file of a run", file=path, allowed=allowed)
    context = {"source": path.name, "idealised": content.get("idealised") is True}
    file = validated(FabricFile, content, path, context)
    data = file.data()
    sources = {key: datum.entry for key, datum in data.items()}
    try:
        return _fabric(file, data, sources, path)
    except InputError as problem:
        if problem.file is not None:
            raise
        # the message shows the value as the file has it
        value = sources.get(problem.key or "", {}).get("value", problem.value)
        raise problem.changed(file=path, value=value) from None


def _fabric(file, data, sources, path):
    """The Fabric of a checked file with its numbers; `sources` also gets what is computed."""
    # what can be computed is, and says so in its source
    thickness = _value(file.thickness)
    pattern = file.weave or PLAIN
    crimp, computed = _crimps(file, thickness, sources, pattern)
    # a wrong mass also spoils strength and thickness: it is reported first
    masses = data_sheet.mass_notes(file, crimp)
    strengths: dict[str, list[str]] = {}
    warp = _yarn("warp", file, crimp[0], strengths)
    weft = _yarn("weft", file, crimp[1], strengths)
    weave = Weave(warp, weft, file.warp.count.value, file.weft.count.value, pattern)
    notes = [f"note: {' and '.join(names)}: {text}" for text, names in strengths.items() if text]
    notes += data_sheet.thickness_note(weave, thickness) if thickness else []
    notes += [*masses, *data_sheet.width_notes(file)]
    effective = tuple(_value(yarn.effective_linear_density) for yarn in file.yarns.values())
    laws = _of_both(
        file.compression,
        "compression",
        Laws,
        lambda key, table: _made(
            CompressionLaw, key, table.a.value, table.b.value, table.form, path.name
        ),
    )
    if laws is not None:
        check_room(laws, weave, file=path, key="compression.a")
    solid = _of_both(
        file.solid, "solid", Solids, lambda key, table: _made(SolidLaw, key, **_values(table))
    )
    rate_law = None
    if file.strain_rate is not None:
        rate_law = RateLaw.from_table(file.strain_rate, path)
    length = data_sheet.failure_length(weave)
    own_length = file.failure_length
    if own_length is None:
        sources["failure_length"] = {
            "value": length.written,
            "source": length.source,
            "status": length.status,
        }
    of_length = {}
    for key in ("gauge_length", "weibull_shape"):
        entry = data_sheet.entries()[key]
        datum = getattr(file, key)
        of_length[key] = entry.number if datum is None else datum.value
        if datum is None:
            sources[key] = {
                "value": entry.written,
                "source": entry.source,
                "status": entry.status,
            }
    names = ("crimp",) * computed + ("failure_length",) * (own_length is None)
    # a fabric of the thesis is a plain weave, as strong as before weaving and without friction between plies
    if path.parent != _FOLDER:
        names += ("weave",) * (file.weave is None)
        names += data_sheet.OF_SHOTS
    ranges = {}
    deviations = []
    guessed = []
    for key, datum in data.items():
        if datum.ratios is not None:
            ranges[key] = datum.ratios
            if datum.deviation:
                deviations.append((key, datum.deviation))
        # the numbers of our own catalogue have been looked up; those of a user's file may be
        # guesses
        elif path.parent != _FOLDER and _guessed(key, datum):
            guessed.append(key)
    fabric = Fabric(
        name=path.stem if file.name is None else file.name,
        weave=weave,
        laws=laws,
        shear=None if file.shear is None else _made(TrellisShear, "shear", **_values(file.shear)),
        solid_laws=solid,
        section=file.section,
        areal_density_measured=_value(file.areal_density_measured),
        interlayer_gap=_value(file.interlayer_gap),
        effective_linear_density=None if None in effective else effective,
        micrograph={
            family: _values(table) for family, table in file.micrograph or () if table is not None
        },
        sources=sources | ({} if rate_law is None else rate_law.sources()),
        assumed=names,
        failure_length=(own_length or length).value,
        **of_length,
        yarn_width=(_value(file.warp.width), _value(file.weft.width)),
        yarn_area=(_area("warp", file.warp, warp), _area("weft", file.weft, weft)),
        thickness=thickness,
        strain_rate=rate_law,
        ranges=ranges,
        deviations=tuple(deviations),
        guessed=tuple(guessed),
        family=file.family,
        idealised=file.idealised,
        notes=tuple(notes),
    )
    fabric = assumed.with_ranges_of_guesses(fabric)
    if file.ply_contact is not None:
        law = ply_laws.from_table(file.ply_contact, fabric, path)
        entry = {"value": law.words(), "source": law.source, "status": law.status}
        fabric = replace(fabric, ply_contact=law, sources=fabric.sources | {"ply_contact": entry})
    return plausible.noted(fabric)


def _guessed(key, datum):
    """Whether a number without a range is a guess: assumed, or in [shear] or [solid] without a
    source."""
    sourced = datum.sourced or not key.startswith(("shear.", "solid."))
    # thickness and mass of a sheet have the ranges of `data_sheet.toml`
    ranged = key.rpartition(".")[2] in RANGED and key not in ("thickness", "areal_density")
    return ranged and (datum.status == "assumed" or not sourced)


def _value(datum):
    """A number in SI units, or None."""
    if datum is None:
        return None
    return datum.value


def _values(table):
    """{key: number in SI units} of a table."""
    return {key: datum.value for key, datum in table if isinstance(datum, Datum)}


def _made(kind, where, *args, **values):
    """An object of the table `where`, which its errors name."""
    try:
        return kind(*args, **values)
    except InputError as problem:
        key = {"E": "modulus"}.get(problem.key, problem.key)
        raise problem.changed(key=f"{where}.{key}") from None


def _of_both(table, key, pair, build):
    """(warp, weft) of a table for both, or of one each; None if the file has none."""
    if table is None:
        return None
    if isinstance(table, pair):
        return build(f"{key}.warp", table.warp), build(f"{key}.weft", table.weft)
    both = build(key, table)
    return both, both


def _crimps(file, thickness, sources, pattern):
    """((warp, weft) crimp, whether one of them was computed from areal density or thickness)."""
    known = tuple(_value(yarn.crimp) for yarn in file.yarns.values())
    if None not in known:
        return known, False
    # half cell lengths along warp and weft
    cells = (0.5 / file.weft.count.value, 0.5 / file.warp.count.value)
    crimp = source = None
    # the thickness of a weave with floats does not tell its crimp: how long a change of sides takes
    # is not known
    if file.areal_density is not None and (thickness is None or not pattern.is_plain):
        yarns = file.yarns.values()
        straight = [yarn.count.value * data_sheet.linear_density(yarn) for yarn in yarns]
        source = data_sheet.FROM_MASS
        try:
            crimp = data_sheet.crimps_of_mass(
                cells, straight, file.areal_density.value, known, pattern=pattern
            )
        except InputError:
            # a rounded mass may be below that of straight yarns
            if thickness is None:
                raise
    if crimp is None:
        crimp = data_sheet.crimps(cells, thickness, known, pattern=pattern)
        source = data_sheet.FROM_THICKNESS
    for family, given, value in zip(FAMILIES, known, crimp):
        if given is None:
            entry = {
                "value": f"{100 * value:.3f} %",
                "source": source,
                "status": "derived",
            }
            sources[f"{family}.crimp"] = entry
    return crimp, True


def _yarn(family, file, crimp, strengths):
    """The Yarn of a family; `strengths` gets what is to be said of its strength."""
    table = file.yarns[family]
    density = table.fibre_density.value
    E = data_sheet.modulus(table)
    linear_density = data_sheet.linear_density(table)
    strain = _value(table.failure_strain)
    strength = table.strength or table.tenacity
    if strength is None:
        yarn = _made(Yarn, family, linear_density, density, E, strain, crimp)
        if not file.idealised:
            data_sheet.check_fibre(yarn, f"{family}.failure_strain")
        return yarn
    reached = data_sheet.strain_at_strength(
        strength.value, strength.unit, linear_density, density, E
    )
    strains = OF_YARN["failure_strain"]
    low, high = strains.limits("")
    key = f"{family}.{'tenacity' if table.strength is None else 'strength'}"
    # a wrong modulus or unit shows itself as a strain that no fibre has
    if not (file.idealised or low <= reached <= high):
        bounds = f"{strains.bounds['']}, not {100 * reached:.3g} %"
        raise InputError(
            key=key, allowed=f"a strength that this modulus reaches at a strain from {bounds}"
        )
    yarn = _made(Yarn, family, linear_density, density, E, reached, crimp)
    if not file.idealised:
        data_sheet.check_fibre(yarn, key)
    if strain is not None:
        note = data_sheet.strength_note(yarn, strain, strength.written, f"{family}.failure_strain")
        strengths.setdefault(note, []).append(family)
    return yarn


def _area(family, table, yarn):
    """[m2] of a yarn's section, which has room for its fibres, or None."""
    area = _value(table.section_area)
    least = yarn.A_s / CLOSEST_PACKING
    if area is not None and area < least:
        allowed = f"at least {1e6 * least:.4g} mm^2, which the fibres of linear_density take when closest packed"
        raise InputError(key=f"{family}.section_area", allowed=allowed)
    return area
