"""Publications and programs that results rest on (`references.toml`), and their form in BibTeX.

The source of a number is a text. It names a publication where one of the regular expressions
`cited` of that publication is found in it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base.files import read_data

UNCHECKED = "Not checked against the publication"
_OF_BIBTEX = {"\\": r"\textbackslash{}", "^": r"\^{}", "~": r"\~{}"}
_SPECIAL = re.compile(r"[\\^~&%$#_{}]")


@dataclass(frozen=True)
class Reference:
    """A publication or a program.

    Parameters
    ----------
    key : of BibTeX
    kind : of BibTeX, such as "article"
    fields : {field of BibTeX: its value, as BibTeX has it}
    cited : regular expressions that find it in the source of a number
    used_for : what a program is used for: "panel", "crossover", "mesh" or "picture"
    checked : what the fields were compared with; "" of those that were written down from memory
    """

    key: str
    kind: str
    fields: Mapping[str, str]
    cited: tuple[str, ...] = ()
    used_for: tuple[str, ...] = ()
    checked: str = ""

    def is_named_in(self, source: str) -> bool:
        """Tell whether the source of a number names this publication."""
        return any(re.search(pattern, source) for pattern in self.cited)

    def to_bibtex(self, note: str = "") -> str:
        """Write the entry; `note` is plain text that goes behind its own."""
        fields = dict(self.fields)
        unchecked = "" if self.checked else UNCHECKED
        own = ". ".join(filter(None, (fields.pop("note", ""), unchecked, escape(note))))
        if own:
            fields["note"] = own
        lines = [f"  {name} = {{{value}}}," for name, value in fields.items()]
        return "\n".join([f"@{self.kind}{{{self.key},", *lines, "}"])


def escape(text: str) -> str:
    """Escape what TeX reads as a command in a plain text."""
    plain = " ".join(text.split())
    return _SPECIAL.sub(lambda found: _OF_BIBTEX.get(found[0], f"\\{found[0]}"), plain)


@cache
def list_references() -> tuple[Reference, ...]:
    """Read `references.toml`, in the order of the file."""
    return tuple(
        _read(key, dict(row)) for key, row in read_data(Path(__file__).with_suffix(".toml")).items()
    )


def _read(key: str, row: dict[str, Any]) -> Reference:
    kind = row.pop("kind")
    cited = tuple(row.pop("cited", ()))
    used_for = tuple(row.pop("used_for", ()))
    checked = row.pop("checked", "")
    fields = {name: str(value) for name, value in row.items()}
    return Reference(key, kind, fields, cited, used_for, checked)


def find_cited(source: str) -> tuple[Reference, ...]:
    """Find the publications that the source of a number names."""
    return tuple(each for each in list_references() if each.is_named_in(source))


def list_programs(*uses: str) -> tuple[Reference, ...]:
    """List the programs that are used for one of "panel", "crossover", "mesh" and "picture"."""
    return tuple(each for each in list_references() if set(uses) & set(each.used_for))
