"""Keywords of an impact in the Python interface: the keys of the input file, checked by its schema.

The keys of the tables [fabric], [panel] and [run] are keywords of their own, the tables [projectile], [history],
[numerics] and [backing] are dicts; a projectile or a backing may be just its name. A number stands for a quantity in
SI units; everything else is written as in the file. `Keywords` names them for editors and type checkers; a test holds
it against the schema.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

from fabrics.checks import FilePath
from fabrics.errors import InputError, InputErrors, together
from weavecell.scenes.target import STANDARD

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from fabrics.ply_law import PlyLaw
    from fabrics.surface import ResponseSurface
    from weavecell.api.calibration import CalibrationResult
    from weavecell.scenes.impact import Scene

    Law: TypeAlias = CompressionLaw | tuple[CompressionLaw, CompressionLaw] | CalibrationResult | FilePath | None

__all__ = ["DEFAULTS", "Keywords", "scene"]

FLAT = ("fabric", "panel", "run")
GROUPS = ("projectile", "history", "numerics", "backing")
# keys of the file that Python has not: the fabric is an argument, nothing is written or resumed, shots have no slack
NOT_HERE = (
    "fabric.name", "fabric.file", "fabric.linear_density", "fabric.fibre_slack", "run.checkpoint_interval",
    "run.outputs",
)  # fmt: skip
# of keys that the input file requires
DEFAULTS: dict[str, Any] = {
    "projectile": {key: value for key, value in STANDARD["projectile"].items() if key != "strike_velocity"},
    **STANDARD["panel"],
}
_OBJECTS = {"fabric": ("law", "surface"), "panel": ("ply_contact",)}  # may be objects, which no file can hold

_OBJECT = " of Python"  # of names that stand for objects

Quantity = float | str  # in SI units, or a text with a unit
Number = float
End = Literal["clamped", "free"] | Mapping[str, Quantity]
Side = End | tuple[End, End] | list[End]


class Keywords(TypedDict, total=False):
    """Keywords of `weavecell.setup` and what takes its keywords; meanings are in docs/reference/input.md."""

    law: Law | Mapping[str, Quantity]
    cell_model: Literal["compressible", "incompressible", "decoupled"]
    cell_formulation: Literal["variational", "equilibrium", "direct"]
    cell_profile: Literal["cosine", "straight"]
    crossover_gap: Quantity
    surface: ResponseSurface | FilePath | None
    bending: Quantity
    weaving_damage: Mapping[str, Number | str] | None
    projectile: Mapping[str, Quantity] | str | None
    opening: Quantity | tuple[Quantity, Quantity] | list[Quantity]
    opening_shape: Literal["rectangular", "round"]
    impact_point: tuple[Quantity, Quantity] | list[Quantity]
    boundary: Literal["clamped", "free"] | Mapping[str, Side | Quantity]
    symmetry: Literal["quarter", "half", "whole"]
    weave_angle: Quantity
    plies: int
    ply: list[Mapping[str, Any]] | tuple[Mapping[str, Any], ...]
    stacking: Literal["aligned", "alternating"]
    ply_gap: Quantity | None
    ply_contact: PlyLaw | FilePath | None
    ply_friction: Number
    yarn_failure: bool
    rate_dependence: bool
    grading: list[list[Number | str]] | tuple[tuple[Number | str, Number | str], ...] | None
    crossovers: Literal["pinned", "sliding"]
    crossover_friction: Number | None
    crossover_cohesion: Quantity | None
    end_time: Quantity
    elements_per_crossover: int | None
    snapshot_interval: Quantity | None
    history: Mapping[str, Any] | None
    numerics: Mapping[str, Number | str] | None
    backing: Mapping[str, Any] | str | None


def tables() -> dict[str, str]:
    """{keyword: the table of the input file that holds it, "" of a whole table}, as the schema has them."""
    from weavecell.scenes import impact, supported

    of = supported.tables(impact.Scene)
    flat = {key: name for name in FLAT for key in of[name].model_fields if f"{name}.{key}" not in NOT_HERE}
    return flat | dict.fromkeys(GROUPS, "")


def scene(fabric: str | None, velocity: object, options: Mapping[str, Any]) -> tuple[Scene, dict[str, Any]]:
    """The checked scene of a call, and its table as it would stand in a file.

    Parameters
    ----------
    fabric : its name, for messages; None where every ply has its own
    velocity : [m/s] of the strike, or a text with a unit
    **options : of `Keywords`

    Raises
    ------
    InputError : an unknown keyword, or a value that is not allowed; one line that names the keyword
    """
    from weavecell.scenes import impact as scenes_impact
    from weavecell.scenes.of_commands import IMPACT

    given = DEFAULTS | {key: value for key, value in options.items() if value is not None}
    known = tables()
    table: dict[str, Any] = {name: {} for name in (*FLAT, "projectile")}
    for key, value in given.items():
        if key not in known:
            raise _unknown(key, value, known)
        if known[key]:
            table[known[key]][key] = value
        else:
            table[key] = value
    for name, keys in _OBJECTS.items():
        table[name] |= {key: _stand_in(table[name][key]) for key in keys if key in table[name]}
    if isinstance(table["projectile"], str):
        table["projectile"] = {"name": table["projectile"]}
    if isinstance(table.get("backing"), str):
        table["backing"] = {"material": table["backing"]}
    if not isinstance(table["projectile"], Mapping) or "strike_velocity" in table["projectile"]:
        raise InputError(
            key="projectile", value=table["projectile"], allowed="a name, or a dict of its keys without strike_velocity"
        )
    struck = {} if velocity is None else {"strike_velocity": velocity}
    table["projectile"] = {**table["projectile"], **struck}
    as_written = written(table, scenes_impact.Scene)
    if fabric is not None:
        as_written["fabric"] |= {"name": fabric}
    rejected = dict(IMPACT.rejected) | {"history.report_positions": "left out: `weavecell.setup` does not support it"}
    try:
        return scenes_impact.check(as_written, None, replace(IMPACT, rejected=rejected)), as_written
    except InputError as problem:
        raise named(problem) from None


def text(table: Mapping[str, Any], fabric: object) -> str:
    """The input file of a table of `scene`; "" where it has objects in it, or `fabric` is one, which no file can hold.

    Parameters
    ----------
    fabric : its name or the path of its file
    """
    import tomlkit

    if any(str(table[name].get(key)).endswith(f"{_OBJECT}.json") for name, keys in _OBJECTS.items() for key in keys):
        return ""
    if not isinstance(fabric, (str, Path)):
        return ""
    named = {"file": str(Path(fabric).resolve())} if str(fabric).endswith(".toml") else {"name": str(fabric)}
    rest = {key: value for key, value in table["fabric"].items() if key != "name"}
    return tomlkit.dumps({key: value for key, value in {**table, "fabric": named | rest}.items() if value})


@contextmanager
def of_group(group: str, values: Mapping[str, object]) -> Iterator[None]:
    """An InputError inside this block of a key of `values` names the keyword GROUP_KEY and the value as given."""
    try:
        yield
    except InputError as problem:
        key = problem.key or ""
        if key not in values:
            raise
        raise InputError(key=f"{group}_{key}", value=values[key], allowed=problem.allowed) from None


def _stand_in(value):
    """A text for the schema: paths and tables as they are, of an object the name of its type."""
    if isinstance(value, (str, Path, Mapping)):
        return value
    return f"{type(value).__name__}{_OBJECT}.json"


def written(values: Mapping[str, Any], model: Any) -> dict[str, Any]:
    """A table as it stands in a file: numbers that are quantities become texts with the unit of their key."""
    return {key: _text(value, model.model_fields.get(key)) for key, value in values.items()}


def fields_of(model: Any, name: str) -> dict[str, Any]:
    """{key: field} of the table `name` of an input file."""
    from weavecell.scenes.schema import tables_in

    return {
        key: field
        for kind in tables_in(model.model_fields[name].annotation)
        for key, field in kind.model_fields.items()
    }


def _text(value, entry):
    from weavecell.scenes.schema import tables_in, unit_of

    value = value.item() if hasattr(value, "item") else value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        kinds = tuple(tables_in(entry.annotation)) if entry is not None else ()
        fields = {name: field for kind in kinds for name, field in kind.model_fields.items()}
        return {key: _text(each, fields.get(key)) for key, each in value.items() if each is not None}
    if isinstance(value, (list, tuple)):
        return [_text(each, entry) for each in value]
    unit = unit_of(entry)
    if unit is None or isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    return repr(value) if unit == "1" else f"{value!r} {unit}"


def _unknown(key, value, known):
    """The error of a keyword that is none."""
    from weavecell.scenes import impact, supported

    for group in GROUPS:
        if (
            key in supported.tables(impact.Scene)[group].model_fields
            and f"{group}.{key}" != "projectile.strike_velocity"
        ):
            return InputError(f'is no keyword, did you mean {group}={{"{key}": ...}}?', key=key, value=value)
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
    hint = f", did you mean {near[0]}?" if near else ";"
    return InputError(f"is no keyword{hint} keywords: {', '.join(Keywords.__annotations__)}", key=key, value=value)


def named(problem: InputError, flat: Sequence[str] = FLAT) -> InputError:
    """The InputErrors of a scene with keywords in place of the dotted keys of the file, of the tables `flat`."""
    if isinstance(problem, InputErrors):
        return together([named(one, flat) for one in problem.problems])
    key = problem.key or ""
    table, _, rest = key.partition(".")
    short = "velocity" if key == "projectile.strike_velocity" else rest if table in flat else ""
    if not short or not str(problem).startswith(key):
        return problem
    found = InputError(short + str(problem)[len(key) :])
    found.key, found.value, found.allowed = short, problem.value, problem.allowed
    return found
