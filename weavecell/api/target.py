"""What is shot at: an input file, a fabric of the catalogue with keywords, a fabric file, or a set-up.

A fabric is shot at as in the tests of the thesis: one ply, 203 mm square and clamped, struck by the
flat cylinder of 3 g and 5.5 mm (`scenes.impact.standard_shot`).
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard, cast

import tomlkit

from fabrics import catalogue
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, without_file
from fabrics.base.schema import read_toml
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.answers.result import Result
from weavecell.answers.target import Target, list_assumptions
from weavecell.answers.user_warnings import warn_user
from weavecell.api import keywords
from weavecell.scenes import build, words
from weavecell.scenes import impact as scenes
from weavecell.scenes.fabric_table import Reader

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup

# [m/s] for the deck of a fabric, and for studies that choose their velocities
STRIKE = 92.5
ALLOWED = "an input file or fabric file (*.toml), or one of "
_LAMINATE = re.compile(r"\b(UD|unidirectional|laminates?|prepregs?|composite)\b", re.IGNORECASE)
_OF_A_SCENE = {"fabric", "projectile", "panel", "run"}
# any of these makes a file one of a fabric, however wrong
_OF_A_FABRIC = {"name", "warp", "weft", "thickness", "areal_density", "compression", "shear"}


def read_target(
    name: str, out: Path, reader: Reader, *, changes: Mapping[str, Any] | None = None
) -> Target:
    """Read the target of a name.

    Parameters
    ----------
    name : of a file or a fabric
    out : folder of the results, from which the standard scene of a fabric file is named
    reader : what it is read for, which refuses keys that it does not read
    changes : {dotted key: value as it is written} in place of what the scene says

    Raises
    ------
    InputError : no such file or fabric, a wrong one, or a key that the command does not honour
    """
    stem = Path(name).stem
    if name in catalogue.list_names():
        fabric = {"name": name}
    elif name.endswith(".toml"):
        text, table = read_toml(name, what="input file or fabric")
        if _OF_A_SCENE & set(table):
            return _target(
                scenes.check(change_keys(table, changes), name, reader),
                name,
                stem,
                text,
                from_file=True,
            )
        catalogue.read(name)
        fabric = {"file": os.path.relpath(name, out)}
    else:
        raise unknown_target(name)
    table = {"fabric": fabric, **scenes.standard_shot()}
    text = tomlkit.dumps(table)
    # from which the path of the fabric counts; no such file was given
    file = out / "scene.toml"
    try:
        scene = scenes.check(change_keys(table, changes), file, reader)
    except InputError as problem:
        raise without_file(problem, file) from None
    return _target(scene, name, stem, text)


def unknown_target(name: str) -> InputError:
    """Return the InputError of a target that is neither a fabric of the catalogue nor a *.toml
    file; of a laminate that it is none that can be shot at."""
    if _LAMINATE.search(name):
        allowed = "woven of dry yarns: laminates and unidirectional sheet have no model here"
        return InputError("is no woven fabric", key="target", value=name, allowed=allowed)
    return catalogue.unknown(name, ALLOWED + ", ".join(catalogue.list_names()), key="target")


def is_input_file(name: str) -> bool:
    """Tell whether a name is the path of an input file, and not of a fabric file or a fabric.

    Raises
    ------
    InputError : no such file, or not TOML
    """
    return name.endswith(".toml") and bool(
        _OF_A_SCENE & set(read_toml(name, what="input file or fabric")[1])
    )


def change_keys(table: dict[str, Any], changes: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the table of a scene with the values of dotted keys in place of its own.

    Raises
    ------
    InputError : a key inside of a value
    """
    for key, value in (changes or {}).items():
        *parts, last = key.split(".")
        inner = table
        for part in parts:
            inner = inner.setdefault(part, {})
            if not isinstance(inner, dict):
                raise InputError(
                    key=key,
                    value=value,
                    allowed=f"left out: {part} is not a table of the input file",
                )
        inner[last] = value
    return table


def _target(scene, name, stem, text, from_file=False):
    # this logs a projectile that has a name or a file
    case = build.build(scene, name, stem)
    if scene.projectile.name is None and scene.projectile.stl is None:
        build.LOG.info(f"projectile: {words.shot_in_words(scene.projectile)}")
    return Target(case, build.setup(case, name), text, name, from_file)


def is_setup(target: object) -> TypeGuard[ImpactSetup]:
    """Tell whether a target is a set-up, whose class comes with the solver."""
    from shellfabric.impact.setup import ImpactSetup

    return isinstance(target, ImpactSetup)


def resolve_target(
    target: Fabric | FilePath | ImpactSetup | None,
    options: Mapping[str, Any],
    reader: Reader,
    velocity: float | str | None = None,
    *,
    function: str = "setup",
    one_shot: bool = False,
) -> Target:
    """Resolve the target of a study.

    Parameters
    ----------
    target : a set-up, the path of an input file, or a fabric
    **options : keywords of `weavecell.setup` beside a fabric; none beside the others
    reader : what it is read for, which refuses keys that it does not read
    velocity : [m/s] at which a fabric is struck; of a study that chooses it None
    function : that was called, for messages
    one_shot : whether what is computed is a shot, to which strike velocity and [history] mean
        something

    Raises
    ------
    InputError : as `weavecell.setup`; keywords or a velocity beside a set-up or an input file; a
        shot without velocity
    """
    chosen = {key: value for key, value in options.items() if value is not None}
    beside = chosen
    if velocity is not None:
        beside = chosen | {"velocity": velocity}
    refuse_result(target)
    file = ""
    if isinstance(target, (str, os.PathLike)):
        file = str(target)
    elif is_setup(target):
        _refuse(beside, "a set-up", function)
        return Target(None, target, "", target.title, from_file=False)
    if is_input_file(file):
        _refuse(beside, "an input file", function)
        return read_target(file, Path.cwd(), reader)
    if (
        isinstance(target, str)
        and not target.endswith(".toml")
        and target not in catalogue.list_names()
    ):
        raise unknown_target(target)
    if velocity is None and one_shot:
        if file.endswith(".toml"):
            _refuse_neither(file)
            given = "an input file, or the fabric file with a velocity"
            raise InputError(
                "is a fabric file", file=target, allowed=f'{given}, such as "92.5 m/s"'
            )
        raise InputError(
            "is missing", key="velocity", allowed='given for a fabric, such as "92.5 m/s"'
        )
    fabric = cast("Fabric | FilePath | None", target)  # a set-up has left above
    panel = build_target(fabric, STRIKE if velocity is None else velocity, chosen, function, reader)
    for line in (f"projectile: {panel.projectile}", *list_assumptions(panel.setup)):
        build.LOG.info(line)
    return panel


def _refuse_neither(file):
    """Refuse a file that is neither an input file nor a fabric file.

    Raises
    ------
    InputError
    """
    _, table = read_toml(file, what="input file or fabric")
    if not _OF_A_FABRIC & set(table):
        tables = ", ".join(f"[{name}]" for name in sorted(_OF_A_SCENE))
        allowed = f"an input file, with tables {tables}, or a fabric file, with [warp] and [weft]"
        raise InputError("is neither", file=file, allowed=allowed)


def build_target(
    fabric: Fabric | FilePath | None,
    velocity: float | str,
    options: Mapping[str, Any],
    function: str = "setup",
    reader: Reader = "setup",
) -> Target:
    """Build the target that `weavecell.setup` describes, with the input file that says the same if
    one can. Its notes are warnings.

    Parameters
    ----------
    fabric, velocity, options : arguments of `weavecell.setup`
    function, reader : that was called with them, for messages, and for what, see `resolve_target`

    Raises
    ------
    InputError : as `setup`
    """
    own = None
    if fabric is not None:
        own = resolve_fabric(fabric)
    # snapshots are of files, which name where they are written
    others: dict[str, Any] = {}
    if options.get("snapshot_interval") is None:
        others["snapshot_interval"] = None
    scene, written = keywords.scene(
        None if own is None else own.name, velocity, options, function, reader
    )
    try:
        case = build.build(scene, None, "", own)
        ply = build.setup(case, None, **others)
    except InputError as problem:
        raise keywords.name_as_keywords(problem) from None
    for note in ply.notes:
        warn_user(note)
    of_file: object = fabric
    if isinstance(fabric, (str, os.PathLike)) and str(fabric).endswith(".toml"):
        of_file = Path(fabric).resolve()
    return Target(case, ply, (written, of_file), ply.title, from_file=False)


def refuse_result(value: object) -> None:
    """Refuse a result where a fabric, a file or a set-up is to be computed.

    Raises
    ------
    InputError
    """
    if isinstance(value, Result):
        allowed = (
            "a fabric, an input file or a set-up, which is then computed; compare(...) takes "
            "results of v50 and critical_velocity, overlay(...) and view(..., beside=...) show "
            "results side by side"
        )
        raise InputError("is a result", key=type(value).__name__, allowed=allowed)


def resolve_fabric(fabric: Fabric | FilePath) -> Fabric:
    """Return a Fabric as it is, and load that of a name or file with the linear densities of the
    runs of the thesis."""
    if isinstance(fabric, Fabric):
        return fabric
    refuse_result(fabric)
    return with_linear_density(catalogue.load(fabric), "effective")


def _refuse(options, beside, function):
    for key, value in options.items():
        keywords.refuse_unknown(key, value, function)
        raise InputError(key=key, allowed=f"left out beside {beside}, which has it")
