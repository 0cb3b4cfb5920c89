"""Keywords of an impact in the Python interface: the keys of the input file, checked by its schema.

The keys of the tables [fabric], [panel] and [run] are keywords of their own, the tables
[projectile], [history], [numerics] and [backing] are dicts; a projectile or a backing may be just
its name. A number stands for a quantity in SI units, an object for what a file names; everything
else is written as in the file. Which is which is marked at the fields of the schema
(`fabrics.base.schema`). `Keywords` names them for editors and type checkers; a test holds it
against the schema.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict, TypeVar

from fabrics.base import values
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, InputErrors, nearest, together
from fabrics.base.schema import AsDict, AsKeywords, FileOnly, mark
from weavecell.scenes.scene_text import fields_of

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw, HasLaw
    from fabrics.ply_law import PlyLaw
    from fabrics.surface import ResponseSurface
    from weavecell.scenes.fabric_table import Reader
    from weavecell.scenes.impact import Scene

    Law: TypeAlias = (
        CompressionLaw | tuple[CompressionLaw, CompressionLaw] | HasLaw | FilePath | None
    )

Function = TypeVar("Function", bound=Callable)
# a number in SI units, or a text with a unit
Quantity = float | str
Number = float
End = Literal["clamped", "free"] | Mapping[str, Quantity]
Side = End | tuple[End, End] | list[End]


# <!-- keywords of tools/pages.py -->
class Keywords(TypedDict, total=False):
    """Keywords of `weavecell.setup` and what takes its keywords; docs/reference.md says more.

    weaving_damage : shares of modulus and strength that are left after weaving; a table { modulus =
        0.9, strength = 0.8, source = "..." }
    law : compression law of warp and weft; needed for a fabric without a published one, such as
        your own; "published", the path of a law written by `weavecell calibrate` (*.json), or a
        table { a = ..., b = ... }
    surface : response surface of the 3D crossover, which replaces the analytical cell and
        `fabric.law`; the path of a surface written by `weavecell surface`
    bending : bending stiffness of one yarn [N m^2]; a bending stiffness of at least 0, such as
        "1e-6 N m^2"
    cell_model : unit cell: yarns that compress, incompressible yarns, or warp and weft without
        interaction; one of "compressible", "incompressible", "decoupled"
    cell_formulation : how forces follow from the state of the cell: gradient of the stored energy
        (`variational`), force equilibrium as in the thesis (`equilibrium`), or interpolated
        tensions of a response surface (`direct`); one of "variational", "equilibrium", "direct"
    crossover_gap : play between warp and weft at a crossover before they touch [m]; a length of at
        least 0, such as "0 mm"
    projectile : the table [projectile] of the input file, as a dict
    preset : set-up of a test, whose values stand in place of keys of [panel], [backing] and [run]
        that are not given: body armour is a pack with free edges of 200 mm before a block of clay,
        followed until the dent rests; one of "body armour"
    opening : side of the square opening of the frame, or both sides; diameter of a round one [m]; a
        length above 0 and at most 5 m, such as "203 mm", or a list of two, along warp and weft
    opening_shape : shape of the opening; round needs clamped edges; one of "rectangular", "round"
    impact_point : point that the projectile hits, from the middle of the opening along its two
        sides. If not given: the middle, or with resolved yarns a quarter of a spacing beside the
        crossover there, in both directions, in a plane of symmetry 0. A point on the second axis
        may have the symmetry `half`, one on the first `other half`, others off the middle `whole`
        [m]; a list of two lengths, such as ["20 mm", "0 mm"]
    boundary : how the yarns end at the frame; "clamped", "free", a table of a slipping side for all
        four, or a table { warp = ..., weft = ... } of sides
    symmetry : modelled part of the panel; half: x >= 0, for a shot that flies in the plane x = 0
        (azimuth 90 deg); other half: y >= 0, in the plane y = 0. With resolved yarns a plane is the
        middle line of a yarn: a quarter is struck on a crossover, a half on a yarn; if not given,
        they have the whole panel. If not given: the smallest part that stands for the whole; one of
        "quarter", "half", "other half", "whole"
    weave_angle : angle of the warp to the sides of the opening [rad]; an angle from -89 to 89 deg,
        such as "45 deg"
    areal_density : areal density of a pack, from which the number of its plies follows: of whole
        plies that which is nearest [kg/m^2]; an areal density above 0, such as "5 kg/m^2"
    ply : plies one by one, in place of `plies`; tables [[panel.ply]]
    strength : yarns that differ in strength; a table { weibull_shape = 14.3, seed = 1 }
    length_effect : whether the strength of a yarn follows its length from edge to edge: the stated
        strength is that of yarns of the gauge length of the fabric, 200 mm if its file gives none,
        and longer ones are weaker; false: it is that of the yarns in the panel, as in the thesis;
        true or false
    grading : coarser mesh with the distance from the impact point: zones of distance and element
        side, in crossovers; zones [until, side] in crossovers, the last until inf, such as [[9,
        "1/2"], [20, 1], [inf, 2]]
    crossovers : whether warp and weft are pinned to each other where they cross, or are resolved
        yarns in a zone about the nose, which may slip and be pushed aside, and pinned beyond it;
        auto, as a command does where nothing is said, resolves them if a zone of them fits (a shot,
        a limit, a V50); one of "pinned", "yarns", "auto"
    parts : parts of each ply that installed packages add, by name; a table { foundation = {
        stiffness = "2e10 N/m^3" } }
    plies : number of plies; above 1 a pack with contact between plies; a whole number from 1 to 100
    stacking : pack: all plies alike, or every second turned by 90 deg; one of "aligned",
        "alternating"
    ply_gap : pack: clearance between plies at rest; if not given the gap of the fabric file, else
        an assumed gap with a range [m]; a length of at least 0, such as "0.12 mm", or a range such
        as "0.12 mm ± 5 %"
    ply_contact : pack: law of pressure against closure between two plies; if not given the law in
        the file of `fabric.law`, in the fabric file, or of solid fibre, in this order; "solid",
        "pressure_law", or the path of a law.json of `weavecell calibrate` or of a *.csv
    ply_friction : pack: Coulomb coefficient between plies; if not given assumed, by the fibre
        family; a number from 0 to 2, or a range such as "0.15 to 0.25" or "0.2 ± 0.05"
    zone : resolved yarns: half width of the square zone about the nose; if not given all of one ply
        up to an opening of 120 mm, beyond it and of a pack 40 mm, or 8 mm divided by
        `crossover_friction` if this is more [m]; a length above 0, such as "20 mm"
    aim_seed : resolved yarns: seed of a random impact point within a cell of the weave about the
        middle of the opening; by it, too, the plies of a pack whose edges are clamped are shifted
        against each other, by 0 if not given; a whole number from 0 to 2147483647
    crossover_friction : resolved yarns: Coulomb coefficient of yarn on yarn; assumed by fibre
        family if not given, 0.2 of para-aramid; a number from 0 to 2, or a range such as "0.15 to
        0.25" or "0.2 ± 0.05"
    yarn_failure : whether a yarn fails at its strength; true or false
    rate_dependence : strength of the yarns as a function of their strain rate, and their modulus at
        high rates, from the table `[strain_rate]` of the fabric file, else assumed by fibre family;
        true or false
    end_time : latest end of the run; it ends earlier when the projectile stops (see
        backing.after_stop) or has perforated [s]; a time above 0 and at most 10 ms, such as "250
        us"
    elements_per_crossover : elements along each side of a crossover; if not given, they follow the
        failure length of the yarns under the projectile, and are longer further out; a whole number
        from 1 to 8
    snapshot_interval : time between the shapes kept for ParaView and the pictures [s]; a time above
        0, such as "10 us"
    history : the table [history] of the input file, as a dict
    numerics : the table [numerics] of the input file, as a dict
    backing : the table [backing] of the input file, as a dict
    """

    weaving_damage: Mapping[str, Number | str] | None
    law: Law | Mapping[str, Quantity]
    surface: ResponseSurface | FilePath | None
    bending: Quantity
    cell_model: Literal["compressible", "incompressible", "decoupled"]
    cell_formulation: Literal["variational", "equilibrium", "direct"]
    crossover_gap: Quantity
    projectile: Mapping[str, Quantity] | str | None
    preset: Literal["body armour"]
    opening: Quantity | tuple[Quantity, Quantity] | list[Quantity]
    opening_shape: Literal["rectangular", "round"]
    impact_point: tuple[Quantity, Quantity] | list[Quantity]
    boundary: Literal["clamped", "free"] | Mapping[str, Side | Quantity]
    symmetry: Literal["quarter", "half", "other half", "whole"]
    weave_angle: Quantity
    areal_density: Quantity | None
    ply: list[Mapping[str, Any]] | tuple[Mapping[str, Any], ...]
    strength: Mapping[str, Quantity] | None
    length_effect: bool
    grading: list[list[Number | str]] | tuple[tuple[Number | str, Number | str], ...] | None
    crossovers: Literal["pinned", "yarns", "auto"]
    parts: Mapping[str, Mapping[str, Quantity]] | None
    plies: int
    stacking: Literal["aligned", "alternating"]
    ply_gap: Quantity | None
    ply_contact: PlyLaw | FilePath | None
    ply_friction: Quantity | None
    zone: Quantity | None
    aim_seed: int | None
    crossover_friction: Quantity | None
    yarn_failure: bool
    rate_dependence: bool
    end_time: Quantity
    elements_per_crossover: int | None
    snapshot_interval: Quantity | None
    history: Mapping[str, Any] | None
    numerics: Mapping[str, Number | str] | None
    backing: Mapping[str, Any] | str | None


# <!-- end of keywords -->


def explain_keywords(*kinds: type) -> Callable[[Function], Function]:
    """Add to the docstring of a function what each keyword of these TypedDicts means, for
    help()."""
    section = "\n    Other Parameters\n    ----------------\n"
    for kind in kinds:
        section += (kind.__doc__ or "").split("\n\n")[-1].split("--\n")[-1].rstrip() + "\n"

    def add(function):
        text = function.__doc__ or ""
        function.__doc__ = text.replace("\n    Raises\n", f"{section}\n    Raises\n", 1)
        return function

    return add


@cache
def tables() -> dict[str, str]:
    """Return {keyword: the table of the input file that holds it, "" of a whole table}, as the
    schema has them."""
    from weavecell.scenes.impact import Scene

    found = {}
    for name, entry in Scene.model_fields.items():
        if mark(entry, AsDict):
            found[name] = ""
        elif mark(entry, AsKeywords):
            keys = [
                key for key, field in fields_of(Scene, name).items() if not mark(field, FileOnly)
            ]
            found |= dict.fromkeys(keys, name)
    return found


@cache
def defaults() -> dict[str, Any]:
    """Return {keyword: value} of what files have to give and Python may leave out, which is that of
    the standard shot."""
    from weavecell.scenes.impact import standard_shot

    of_table = tables()
    values: dict[str, Any] = {}
    for table, keys in standard_shot().items():
        for key, value in keys.items():
            if of_table.get(key) == table:
                values[key] = value
            elif of_table.get(table) == "" and not mark(_field(table, key), FileOnly):
                values.setdefault(table, {})[key] = value
    return values


def _field(table, key):
    from weavecell.scenes.impact import Scene

    return fields_of(Scene, table)[key]


def scene(
    fabric: str | None,
    velocity: object,
    options: Mapping[str, Any],
    function: str,
    reader: Reader,
) -> tuple[Scene, dict[str, Any]]:
    """Check the keywords of a call: the scene, and its table.

    Parameters
    ----------
    fabric : its name, for messages; None if every ply has its own
    velocity : [m/s] of the strike, or a text with a unit
    **options : of `Keywords`
    function : that was called with them, for messages
    reader : what the scene is read for, which refuses keys that it does not read

    Raises
    ------
    InputError : an unknown keyword, or a value that is not allowed; one line that names the keyword
    """
    from fabrics.base.schema import PYTHON
    from weavecell.scenes import impact

    known = tables()
    table: dict[str, Any] = {name: {} for name in (*known.values(), "projectile") if name}
    given = {key: value for key, value in options.items() if value is not None}
    for key, value in (defaults() | given).items():
        if key not in known:
            raise _unknown(key, value, known, function)
        if isinstance(value, tuple) and key == "law":
            of_file = value
        else:
            of_file = plain(value)
        if known[key]:
            table[known[key]][key] = of_file
        else:
            table[key] = of_file
    for name, entry in impact.Scene.model_fields.items():
        as_dict = mark(entry, AsDict)
        if as_dict and as_dict.named_by and isinstance(table.get(name), str):
            table[name] = {as_dict.named_by: table[name]}
    if not isinstance(table["projectile"], dict) or "strike_velocity" in table["projectile"]:
        raise InputError(
            key="projectile",
            value=table["projectile"],
            allowed="a name, or a dict of its keys without strike_velocity",
        )
    table["projectile"] |= plain({"strike_velocity": velocity})
    table["fabric"] |= plain({"name": fabric})
    try:
        return impact.check(table, None, reader, PYTHON), table
    except InputError as problem:
        raise name_as_keywords(problem) from None


def plain(value: Any) -> Any:
    """Convert a value of Python to what a file has: dicts without None, lists and plain numbers,
    texts of paths; objects as they are."""
    value = values.plain(value)
    if isinstance(value, Mapping):
        return {key: plain(part) for key, part in value.items() if part is not None}
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    if isinstance(value, Path):
        return str(value)
    return value


def refuse_unknown(key: str, value: object, function: str) -> None:
    """Refuse a keyword that `function` does not have; `velocity` is one of its own.

    Raises
    ------
    InputError : with the keyword that it may be meant for
    """
    known = tables()
    if key != "velocity" and key not in known:
        raise _unknown(key, value, known, function)


def _unknown(key, value, known, function):
    """The error of a keyword that the function does not have."""
    from weavecell.scenes.impact import Scene
    from weavecell.scenes.panel import PanelTable

    for group in (name for name, table in known.items() if not table):
        field = fields_of(Scene, group).get(key)
        if field is not None and not mark(field, FileOnly):
            return InputError(
                f'is not a keyword of {function}, did you mean {group}={{"{key}": ...}}?',
                key=key,
                value=value,
            )
    message, allowed = PanelTable.unknown(key, None)
    if message is None:
        return InputError(key=key, value=value, allowed=allowed)
    # a key of tables is not meant where the value is none
    holds_tables = isinstance(value, (dict, list, tuple))
    fields = {name: fields_of(Scene, table).get(name) for name, table in known.items() if table}
    likely = [
        name for name in known if holds_tables or fields.get(name) is None or fields[name].title
    ]
    alike = _mean_the_same(known)
    near = nearest(key, likely) or alike.get(nearest(key, alike))
    hint = ";"
    if near:
        hint = f", did you mean {near}?"
    return InputError(
        f"is not a keyword of {function}{hint} keywords: {', '.join(Keywords.__annotations__)}",
        key=key,
        value=value,
    )


def _mean_the_same(known):
    """Return {what users call a keyword: its name}, as in files."""
    from fabrics.base.schema import tables_in
    from weavecell.scenes.impact import Scene

    groups = {name for name in known.values() if name}
    tables = [kind for name in groups for kind in tables_in(Scene.model_fields[name].annotation)]
    words = {word: key for table in tables for word, key in table.synonyms.items()}
    return {word: key for word, key in words.items() if key in known}


def name_as_keywords(problem: InputError, flat: Sequence[str] | None = None) -> InputError:
    """Name keywords in the InputErrors of a scene in place of the dotted keys of the file, of the
    tables `flat`; None: those that the schema of an impact gives as keywords."""
    if flat is None:
        flat = sorted(set(tables().values()))
    if isinstance(problem, InputErrors):
        return together([name_as_keywords(part, flat) for part in problem.problems])
    key = problem.key or ""
    table, _, rest = key.partition(".")
    short = "velocity"
    if key != "projectile.strike_velocity":
        short = ""
        if table in flat:
            short = rest
    if not str(problem).startswith(key):
        return problem
    return problem.changed(
        key=short or problem.key, allowed=_in_python(problem.allowed, short, problem.value)
    )


def _in_python(allowed, key, value):
    """What is allowed, tables of a file in the words of Python."""
    words = re.sub(r"^tables (\[\[.+\]\])$", r"a list of dicts with the keys of \1", allowed or "")
    words = re.sub(r"^a table (\[.+\])$", r"a dict with the keys of \1", words)
    if words != allowed and key == "ply" and isinstance(value, int):
        words += f"; equal plies are plies={value}"
    return words or None
