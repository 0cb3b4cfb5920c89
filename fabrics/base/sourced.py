"""Tables of constants by name: each number with its unit, source and status, some with a range.

A data file has tables [KIND.NAME] of constants as they would be written in an input file:

    [metal.lead]
    density = { value = "11340 kg/m^3", range = ["11300 kg/m^3", "11350 kg/m^3"],
                source = "the text that gives it", status = "second-hand" }

The range is what the value may be as far as is known. A source is read alone, by `weavecell show`
among others: it does not point to another line of the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

from fabrics.base import plugs
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, unknown_name
from fabrics.base.files import read_data
from fabrics.base.schema import read_toml
from fabrics.base.units import si

Constants = Mapping[str, Mapping[str, Any]]  # {constant: value, range, source and status}

# status of a number: what it says
STATUSES = {
    "measured": "the source measured it",
    "published": "it stands in a text that was at hand",
    "second-hand": "a text that was at hand quotes it from another",
    "nominal": "the name says it",
    "derived": "it follows from other numbers of the file",
    "assumed": "no text with the number was at hand; the reasoning stands in place of a source",
}


@dataclass(frozen=True)
class SourcedTables:
    """The tables [KIND.NAME] of a data file.

    Parameters
    ----------
    file : TOML file of the package
    kind : what a table is of, such as "metal"
    units : {constant: SI unit}; "" of a number without one, which may be infinite
    group : of the entry points by which installed packages add tables (`fabrics.base.plugs`), a
        file each as `read_constants` reads it; "" for none
    """

    file: Path
    kind: str
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    group: str = ""

    @cached_property
    def own(self) -> tuple[str, ...]:
        """The names in the file."""
        return tuple(read_data(self.file)[self.kind])

    @cached_property
    def content(self) -> dict[str, Any]:
        """All of the file, and what installed packages add.

        Raises
        ------
        InputError : as `plugs.data_files` and `read_constants`
        """
        found = read_data(self.file)
        if self.group:
            for name, path in plugs.data_files(self.group, self.own).items():
                found[self.kind][name] = read_constants(path, self.kind)
        return found

    def list_names(self) -> tuple[str, ...]:
        """List the names, in the order of the file."""
        return tuple(self.content[self.kind])

    def entry(
        self,
        name: str,
        *,
        file: FilePath | None = None,
        key: str | None = None,
        near: str | None = None,
    ) -> Constants:
        """Look up the table of a name.

        Raises
        ------
        InputError : an unknown name; one line with the `file` and `key` that it is read from, the
            name that is `near` to it, and the names there are
        """
        known = self.list_names()
        if name not in known:
            raise unknown_name(self.kind, name, known, file=file, key=key, near=near)
        found: Constants = self.content[self.kind][name]
        return found

    def values(self, name: str, *, key: str | None = None) -> dict[str, float]:
        """Return {constant: value [SI]} of those constants of a name that have a unit here.

        Raises
        ------
        InputError : an unknown name
        """
        return in_si(self.entry(name, key=key), self.units, self.file)

    def bounds(self, name: str, constant: str) -> tuple[float, float]:
        """Return the least and the largest value [SI] that a constant of a name may have: its value
        twice if no range is known.

        Raises
        ------
        InputError : an unknown name, or a constant that it does not have
        """
        data = self.entry(name)
        if constant not in data:
            raise InputError(key=constant, value=name, allowed=" or ".join(data))
        row = data[constant]
        ends = row.get("range", [row["value"]] * 2)
        unit = self.units[constant]
        low, high = (number_of(text, unit, self.file, constant) for text in ends)
        return low, high


def read_constants(path: FilePath, kind: str) -> dict[str, Any]:
    """Read a file of the constants of one thing as a user writes it, each a value or a table of its
    own; what has no source has the name of the file as its source and the status "user".

    Raises
    ------
    InputError : as `read_toml`
    """
    sole = {"source": Path(path).name, "status": "user"}
    found: dict[str, Any] = {}
    for key, value in read_toml(path, what=kind)[1].items():
        if not isinstance(value, dict):
            value = {"value": value}
        found[key] = sole | value
    return found


def in_si(constants: Constants, units: Mapping[str, str], file: FilePath) -> dict[str, float]:
    """Convert the values of {constant: its row} to the SI units of its keys; a key may be
    missing."""
    values = {}
    for key, unit in units.items():
        if key in constants:
            values[key] = number_of(constants[key]["value"], unit, file, key)
    return values


def number_of(text: str, unit: str, file: FilePath, key: str) -> float:
    """Convert a text to a number in an SI unit; without a unit it may be infinite."""
    value = plain(text)
    if unit == "" and isinstance(value, float):
        return value
    return si(value, unit, file=file, key=key)


def plain(text: str) -> float | str:
    """Return the number that a text is, else the text: ratios carry no unit."""
    try:
        return float(text)
    except ValueError:
        return text


def assumed_of(constants: Constants) -> list[str]:
    """List the constants whose value is assumed."""
    return [key for key, row in constants.items() if row["status"] == "assumed"]
