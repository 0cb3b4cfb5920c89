"""The files that a scene names, as a folder of results keeps them.

A folder of results is moved, copied and sent: paths that its scene.toml has, as the user wrote them,
then lead nowhere. Their files are kept beside it in inputs/, and inputs/named.json says which text is
which copy.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path, PurePath
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import find_inside, parse_toml, read_text
from fabrics.base.read_formats import read_json

FOLDER = "inputs"
NAMED = f"{FOLDER}/named.json"
FORMAT = "weavecell inputs 1"
# keys that may name a file, by table
KEYS = {
    "fabric": ("file", "law", "surface"),
    "projectile": ("name", "stl"),
    "panel": ("ply_contact",),
}
KEYS_OF_PLY = ("file", "law")
# folders and name of a file that another one names, in inputs/
DEEPEST = 2
LOG = logging.getLogger("weavecell")
# a projectile has the name of an entry of ours, or the path of a file of one
_NAME = "name"


def find_named(table: Mapping[str, Any], scene: Any, folder: Path) -> dict[str, Path]:
    """Find the files that the table of a scene names.

    Parameters
    ----------
    table : as it is written
    scene : that was made of it, with the paths that were read
    folder : from which the name of a projectile counts that is the path of one

    Returns
    -------
    {text as it is written: its file}
    """
    found = {}
    for text, key, used in _pairs(table, scene):
        if not isinstance(text, str) or (key == _NAME and not text.endswith(".toml")):
            continue
        path = folder / text
        if isinstance(used, str) and key != _NAME:
            path = Path(used)
        if path.is_file():
            found[text] = path
    return found


def _pairs(table: Mapping[str, Any], scene: Any) -> Iterator[tuple[Any, str, Any]]:
    """(value as written, key, value in the scene) of all keys that may name a file."""
    for name, keys in KEYS.items():
        written = table.get(name, {})
        for key in keys:
            if key in written:
                yield written[key], key, getattr(getattr(scene, name), key, None)
    plies = table.get("panel", {}).get("ply", ())
    for written, ply in zip(plies, getattr(getattr(scene, "panel", None), "ply", ())):
        for key in KEYS_OF_PLY:
            if key in written:
                yield written[key], key, getattr(ply, key)


def find_beside(path: Path) -> dict[str, Path]:
    """Find the files that a fabric or law file names beside it: {path from its folder: file}.

    What such a file names elsewhere cannot be kept without a change of the file, which is told.
    """
    readers: dict[str, Callable[[str], Any]] = {".toml": parse_toml, ".json": json.loads}
    read = readers.get(path.suffix.lower())
    if read is None:
        return {}
    content: Any = None
    with suppress(ValueError, InputError, RecursionError):
        content = read(read_text(path))
    table = None
    if isinstance(content, dict):
        table = content.get("ply_contact")
    if not isinstance(table, dict) or not isinstance(table.get("file"), str):
        return {}
    named = PurePath(table["file"])
    if named.is_absolute() or ".." in named.parts or len(named.parts) > DEEPEST:
        LOG.warning(f"{path} names {named}, which the folder of results does not keep")
        return {}
    return {named.as_posix(): path.parent / named}


def read_named(folder: Path) -> dict[str, str]:
    """Return {text in scene.toml: path of its copy from the folder}; nothing of a folder without
    copies.

    Raises
    ------
    InputError : inputs/named.json is damaged
    """
    file = folder / NAMED
    if not file.is_file():
        return {}
    copies = read_json(file, FORMAT, what="list of the files that scene.toml names")
    named = copies.get("files")
    if not isinstance(named, dict) or not all(isinstance(name, str) for name in named.values()):
        raise InputError(file=file, key="files", allowed="{text in scene.toml: file in inputs}")
    place = find_inside(folder, FOLDER)
    for name in named.values():
        if place is None or find_inside(place, name) is None:
            raise InputError(file=file, key="files", value=name, allowed=f"a file in {FOLDER}")
    return {text: f"{FOLDER}/{name}" for text, name in named.items()}


def list_named(copies: Mapping[str, str]) -> str:
    """Write inputs/named.json of {text in scene.toml: file in inputs}."""
    content = {"format": FORMAT, "files": dict(copies)}
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def use_copies(table: dict[str, Any], copies: Mapping[str, str]) -> dict[str, Any]:
    """Return the table of a scene with the paths of copies in place of what names these files."""
    if not copies:
        return table

    def replaced(given, keys):
        """A table whose texts are those of copies."""
        if not isinstance(given, dict):
            return given
        changed = {}
        for key in keys:
            if isinstance(given.get(key), str) and given[key] in copies:
                changed[key] = copies[given[key]]
        return given | changed

    used = dict(table)
    for name, keys in KEYS.items():
        if name in used:
            used[name] = replaced(used[name], keys)
    panel = used.get("panel")
    if isinstance(panel, dict) and isinstance(panel.get("ply"), list):
        plies = [replaced(ply, KEYS_OF_PLY) for ply in panel["ply"]]
        used["panel"] = panel | {"ply": plies}
    return used


def use_copies_of_missing(table: dict[str, Any], file: FilePath | None) -> dict[str, Any]:
    """Return the table of a scene file that lies in a folder of results with the copies that this
    keeps of files that are not where it says."""
    if file is None:
        return table
    folder = Path(file).parent
    missing = {}
    for text, copy in read_named(folder).items():
        if not (folder / text).is_file():
            missing[text] = copy
    return use_copies(table, missing)
