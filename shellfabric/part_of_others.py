"""A part of each ply (`shellfabric.parts.Part`) that an installed package adds (`fabrics.base.plugs`), as an
input file names it. The class of the part has

    keys = {"stiffness": "N/m^3"}       # numbers that it takes, with their SI units
    energy = "part_foundation"          # its name among the energies of a run, which begins with "part_"

and is made as Foundation(panel, stiffness=...). It imports no solver: an input file is checked without one.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base import plugs
from fabrics.base.errors import InputError, unknown_name
from fabrics.base.units import si

GROUP = "weavecell.parts"
BEGINNING = "part_"


@cache
def list_kinds() -> dict[str, Any]:
    """List the classes of parts that installed packages add, {name: class}.

    Raises
    ------
    InputError : as `plugs.objects`
    """
    return plugs.objects(GROUP, (), ("keys", "energy"))


@dataclass(frozen=True)
class PartOfOthers:
    """A part by its name, which makes it of a panel.

    Parameters
    ----------
    name : of `list_kinds`
    numbers : ((key, value [SI]), ...) as it takes them
    code : digest of the file of its class: a run of other code is another run
    """

    name: str
    numbers: tuple[tuple[str, float], ...] = ()
    code: str = ""

    def __call__(self, panel: Any) -> Any:
        """Make the part of a ply."""
        return list_kinds()[self.name](panel, **dict(self.numbers))

    @property
    def in_words(self) -> str:
        """What acts, and by which numbers."""
        units = list_kinds()[self.name].keys
        numbers = [f"{key} {value:.4g} {units[key]}".strip() for key, value in self.numbers]
        return ", ".join([f"Each ply has the part {self.name} of an installed package", *numbers])


def read(name: str, table: object) -> PartOfOthers:
    """Read a part from the table of its numbers, such as {"stiffness": "2e10 N/m^3"}.

    Raises
    ------
    InputError : no such part, a key that it does not take or lacks, or a value of another unit
    """
    if name not in list_kinds():
        known = tuple(list_kinds()) or ("none: no installed package adds one",)
        raise unknown_name("part", name, known, key=name)
    kind = list_kinds()[name]
    if not kind.energy.startswith(BEGINNING):
        allowed = f'of a class whose energy begins with "{BEGINNING}"'
        raise InputError(key=name, value=kind.energy, allowed=allowed)
    if not isinstance(table, Mapping) or table.keys() != kind.keys.keys():
        said = " and ".join(kind.keys) or "no keys"
        raise InputError(key=name, value=table, allowed=f"a table with {said}")
    numbers = [(key, si(table[key], unit, key=f"{name}.{key}")) for key, unit in kind.keys.items()]
    code = hashlib.sha256(Path(inspect.getfile(kind)).read_bytes()).hexdigest()[:16]
    return PartOfOthers(name, tuple(numbers), code)
