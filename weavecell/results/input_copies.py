"""Copies of what a run reads: its input file and the files that this names, in the folder of its
results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fabrics.base import files
from fabrics.base.files import parse_toml, read_bytes
from weavecell.results import file_list, out_folder
from weavecell.results.result_folder import SCENE
from weavecell.scenes import kept_files


def keep_input(folder: Path, text: str, scene: Any, base: Path) -> None:
    """Write the input of a run to its folder: scene.toml as it was given, and in inputs/ the files
    that it names.

    Parameters
    ----------
    text : of the input file; nothing is written of ""
    scene : that was made of it
    base : folder of the input file
    """
    if not text:
        return
    out_folder.write_copy(folder / SCENE, text)
    kept = {}
    for written, path in kept_files.find_named(parse_toml(text), scene, base).items():
        kept[written] = _read_with_beside(path)
    # of an earlier run, which named others
    for names in file_list.OF_INPUTS:
        out_folder.remove_earlier(folder, names)
    if not kept:
        return
    copies = {}
    taken: dict[str, bytes] = {Path(kept_files.NAMED).name: b""}
    for written, contents in kept.items():
        within = _find_place(contents, taken)
        taken |= {within + name: content for name, content in contents.items()}
        copies[written] = within + next(iter(contents))
    del taken[Path(kept_files.NAMED).name]
    for name, content in taken.items():
        files.write(folder / kept_files.FOLDER / name, content)
    files.write(folder / kept_files.NAMED, kept_files.list_named(copies))


def _read_with_beside(path: Path) -> dict[str, bytes]:
    """{path from its folder: content} of a file, the first, and of those that it names beside it."""
    # of any kind, and read before
    contents = {path.name: read_bytes(path, "HDF5 file")}
    for name, beside in kept_files.find_beside(path).items():
        contents[name] = read_bytes(beside, "HDF5 file")
    return contents


def _find_place(contents: Mapping[str, bytes], taken: Mapping[str, bytes]) -> str:
    """The folder in inputs, "" or one with a number, where no other file has one of these names."""
    within = ""
    number = 1
    while any(taken.get(within + name, content) != content for name, content in contents.items()):
        number += 1
        within = f"{number}/"
    return within
