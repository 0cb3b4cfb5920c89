"""Runs that several claims read are made once: each is named by its scene and kept in a file of its own.

The name is a digest of what is run, with what, and of the text of the packages that it runs in, so that a run of
another version of the program is never taken for one of this.
"""

from __future__ import annotations

import hashlib
import json
import pickle
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from fabrics.files import write_whole


@dataclass(frozen=True, order=True)
class Run:
    """A computation by name, with its arguments as JSON."""

    name: str
    arguments: str

    @classmethod
    def of(cls, name, **arguments):
        """The run `name` of `runs.RUNS` with these arguments."""
        return cls(name, json.dumps(arguments, sort_keys=True))

    @property
    def keywords(self):
        return json.loads(self.arguments)

    def digest(self, packages):
        """Name of its file."""
        text = "\n".join((self.name, self.arguments, *map(source, packages)))
        return f"{self.name}-{hashlib.sha256(text.encode()).hexdigest()[:24]}"


@cache
def source(package):
    """Digest of all program and data files of a package."""
    folder, found = Path(str(resources.files(package))), hashlib.sha256()
    for path in sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".toml")):
        found.update(str(path.relative_to(folder)).encode() + b"\0" + path.read_bytes())
    return found.hexdigest()


def kept(folder, digest):
    """Whether a run is in the folder."""
    return (Path(folder) / f"{digest}.pickle").exists()


def read(folder, digest):
    """What a run has left: a dict of plain numbers, texts and arrays."""
    with open(Path(folder) / f"{digest}.pickle", "rb") as file:
        return pickle.load(file)  # written by `write` in this very folder


def write(folder, digest, content):
    """Keep what a run has found."""
    with write_whole(Path(folder) / f"{digest}.pickle", "wb") as file:
        pickle.dump(content, file, protocol=pickle.HIGHEST_PROTOCOL)
