"""What other distributions add, by entry points of their own:

    [project.entry-points."weavecell.fabrics"]
    acme = "acme_weaves"                # a package: each file *.toml of its folder is a fabric
    [project.entry-points."weavecell.projectiles"]
    acme = "acme_weaves.projectiles"    # a package: each file *.toml of its folder is a projectile
    [project.entry-points."weavecell.decks"]
    acme = "acme_deck"                  # a module: writes decks of a code, `weavecell.decks.folder`
    [project.entry-points."weavecell.parts"]
    foundation = "acme_parts:Foundation"    # a class: a part of each ply, `shellfabric.part_of_others`

Nothing of them is imported before something of their kind is listed or named.
"""

from __future__ import annotations

from collections.abc import Container
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

from fabrics.base.errors import InputError


def data_files(group: str, own: Container[str]) -> dict[str, Path]:
    """List the data files that distributions add to a group: {name of the file without .toml: its path}.

    Parameters
    ----------
    group : such as "weavecell.fabrics"
    own : names that are taken

    Raises
    ------
    InputError : a distribution whose package cannot be imported or holds no files, or a name that is taken
    """
    found: dict[str, Path] = {}
    for entry in _entries(group):
        folders = getattr(_load(entry), "__path__", ())
        files = sorted(file for folder in folders for file in Path(folder).glob("*.toml"))
        if not files:
            raise _unfit(entry, "a package whose folder holds *.toml files (package-data)")
        for file in files:
            _refuse_taken(entry, file.stem, own, found)
            found[file.stem] = file
    return found


def objects(group: str, own: Container[str], needs: tuple[str, ...]) -> dict[str, Any]:
    """Import what distributions add to a group: {name of the entry point: module, or class}.

    Parameters
    ----------
    group, own : as of `data_files`
    needs : what each has to have

    Raises
    ------
    InputError : one that cannot be imported or lacks something, or a name that is taken
    """
    found: dict[str, Any] = {}
    for entry in _entries(group):
        _refuse_taken(entry, entry.name, own, found)
        found[entry.name] = _load(entry)
        if not all(hasattr(found[entry.name], name) for name in needs):
            raise _unfit(entry, f"what has {', '.join(needs)}")
    return found


def _entries(group):
    """The entry points of a group, in an order that no installation changes."""
    return sorted(entry_points(group=group), key=lambda entry: (entry.name, entry.value))


def _load(entry):
    try:
        return entry.load()
    # code of others may raise anything
    except Exception as problem:
        allowed = f"importable, which raises {type(problem).__name__}: {problem}"
        raise _unfit(entry, allowed) from problem


def _refuse_taken(entry: EntryPoint, name: str, *taken: Container[str]) -> None:
    if any(name in names for names in taken):
        raise _unfit(entry, f'of names that are free, and "{name}" is taken')


def _unfit(entry, allowed):
    """The InputError of an entry point of a distribution."""
    by = f"of the installed package {entry.dist.name}" if entry.dist else "of a package"
    return InputError(by, key=f"{entry.group}.{entry.name}", value=entry.value, allowed=allowed)
