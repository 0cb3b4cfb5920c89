"""The list of what weavecell wrote to a folder, and its mark that the folder is whole.

A line for each file, with its SHA-256, as `sha256sum -c .weavecell-files` checks it; a line is
appended before the file appears under its name, so that every file of weavecell is in the list
however a run ends. Comment lines hold the inputs of the run and, as the last line of a folder that
is whole, the key of what was computed:

    # input DIGEST
    DIGEST  NAME
    # whole KEY

Whatever is written afterwards stands behind the mark and takes it away.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path

from fabrics.base import files
from fabrics.base.errors import InputError

NAME = ".weavecell-files"
# copies of what a run reads: where the run reads that very file, it is left as it is
OF_INPUTS = ("inputs/*/*/*", "inputs/*/*", "inputs/*")
INPUT = ("scene.toml", *OF_INPUTS)
_LINE = re.compile(r"(\\?)([0-9a-f]{64})  (.+)")
_INPUT = "# input "
_WHOLE = "# whole "
_HEAD = "# written by weavecell; sha256sum -c .weavecell-files compares the files with this list\n"


@dataclass
class FileList:
    """What a list holds.

    Parameters
    ----------
    digests : {name: digests of what was written under it, the last one last}
    inputs : digests of the inputs of the run
    whole : key of what was computed, where nothing was written behind the mark; None of a folder
        that is not whole
    """

    digests: dict[str, list[str]] = field(default_factory=dict)
    inputs: set[str] = field(default_factory=set)
    whole: str | None = None

    @classmethod
    def read(cls, folder: Path) -> FileList:
        """Read the list of a folder; lines that are damaged, or a list that is missing, say
        nothing."""
        found = cls()
        try:
            text = files.read_bytes(folder / NAME).decode(errors="replace")
        except (OSError, InputError):
            return found
        for line in text.splitlines():
            entry = _LINE.fullmatch(line)
            found.whole = None
            if entry is not None:
                name = entry[3]
                if entry[1]:
                    name = name.replace("\\n", "\n").replace("\\\\", "\\")
                found.digests.setdefault(name, []).append(entry[2])
            elif line.startswith(_INPUT):
                found.inputs.add(line.removeprefix(_INPUT))
            elif line.startswith(_WHOLE):
                found.whole = line.removeprefix(_WHOLE)
        return found

    def write(self, folder: Path) -> None:
        """Write the list anew."""
        text = _HEAD
        text += "".join(f"{_INPUT}{digest}\n" for digest in sorted(self.inputs))
        for name, digests in self.digests.items():
            text += "".join(line(name, known) for known in digests)
        if self.whole is not None:
            text += f"{_WHOLE}{self.whole}\n"
        files.write(folder / NAME, text)

    def has(self, folder: Path, name: str) -> bool:
        """Say whether a file of a folder is what weavecell wrote under its name."""
        return _digest_inside(folder, name) in self.digests.get(name, ())

    def damaged(self, folder: Path, patterns: Iterable[str]) -> list[str]:
        """Return the names of the files with one of these patterns that are missing, or not what
        was written last."""
        wrong = []
        for name, digests in self.digests.items():
            if matches(name, patterns) and _digest_inside(folder, name) != digests[-1]:
                wrong.append(name)
        return wrong


def append(folder: Path, name: str, file: Path) -> None:
    """Append the line of a file that is about to appear under its name."""
    path = folder / NAME
    try:
        with open(path, "a", encoding="utf-8") as listed:
            listed.write(line(name, digest(file)))
            listed.flush()
            os.fsync(listed.fileno())
    except OSError as problem:
        problem.filename = str(path)
        raise


def line(name: str, known: str) -> str:
    """Return the line of a file, its name written as sha256sum does."""
    mark = ""
    if "\\" in name or "\n" in name:
        mark = "\\"
        name = name.replace("\\", "\\\\").replace("\n", "\\n")
    return f"{mark}{known}  {name}\n"


def digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _digest_inside(folder, name):
    """Return the digest of a file in a folder; None without one, or if its name leads elsewhere."""
    path = files.find_inside(folder, name)
    if path is None or not path.is_file():
        return None
    return digest(path)


def matches(name: str, patterns: Iterable[str]) -> bool:
    """Say whether the name of a file in a folder is one of these, which may have wildcards; a
    wildcard stays within a folder."""
    parts = name.split("/")
    for pattern in patterns:
        wanted = pattern.split("/")
        if len(wanted) == len(parts) and all(map(fnmatchcase, parts, wanted)):
            return True
    return False
