"""What makers of fabrics call the rows of a data sheet, and the units in which they write numbers.

The words are data, in `sheet_names.toml`. A name is read in any case, in several languages, with its unit
in brackets, behind a solidus, a comma, "in" or by itself: "Weight [g/m2]" is areal_density. Words around
it say whether it is of the warp or the weft, of the yarn or the fabric; a word that is not known makes it
no name, so that "Tear strength" or "Weight of the roll" is none.
"""

from __future__ import annotations

import logging
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import read_data
from fabrics.base.units import NUMBER
from fabrics.fabric_tables import FAMILIES, OF_FABRIC, OF_YARN
from fabrics.pattern import Pattern
from weavecell.scenes.missing_values import BREAKING, OF_STRIP

LOG = logging.getLogger("weavecell")
Row = tuple[str, dict[str, str]]  # "line 7", its cells by the name of the column
ALL = OF_YARN | OF_FABRIC | {BREAKING: OF_STRIP}
WEAVE, DESCRIPTION = "weave", "description"


def _turned(table):
    """Return {word: key} of {key: words}."""
    return {word: key for key, words in _DATA[table].items() for word in words}


_DATA = read_data(Path(__file__).with_suffix(".toml"))
NAMES: dict[str, list[str]] = _DATA["names"]
PATTERNS = {name: re.compile(pattern) for name, pattern in _DATA["patterns"].items()}
AROUND = {role: frozenset(words) for role, words in _DATA["around"].items()}
_MEANT = frozenset().union(*(AROUND[role] for role in AROUND if role not in ("other", "treated")))
_SIGNS = str.maketrans(_DATA["signs"])
_COLUMNS, _UNITS, _WHOLE_UNITS = map(_turned, ("columns", "units", "whole_units"))
_WEAVES = _turned("weaves")
_UNIT_WORD = "|".join(map(re.escape, sorted(_UNITS, key=len, reverse=True)))
_POWER = r"(?:\^?[23])?"
_UNIT = re.compile(
    rf"(?:(?:{_UNIT_WORD}){_POWER})?(?:/ ?(?:(?:5|10|50|100) )?(?:{_UNIT_WORD}){_POWER})?"
    rf"|(?:(?:{_UNIT_WORD}) )?(?:{_UNIT_WORD})\^?-[123]"
)


def rewrite(table: str, text: str) -> str:
    """Write what a table of `sheet_names.toml` has in place of its patterns."""
    for pattern, new in _DATA[table].items():
        text = re.sub(pattern, new, text)
    return text


def fold(text: str) -> str:
    """Write a text in small letters without accents, signs of trade marks and marks of footnotes."""
    letters = unicodedata.normalize("NFKD", text.replace("10⁶", "10^6").translate(_SIGNS))
    plain = "".join(char for char in letters if not unicodedata.combining(char)).lower()
    return " ".join(plain.split())


@cache
def unit(written: str) -> str:
    """Return the unit of a text as `fabrics.base.units` reads it; "" if it is none of a data sheet."""
    text = rewrite("unit_patterns", fold(written).strip("[]() ."))
    found = _WHOLE_UNITS.get(text, "")
    if not found and _UNIT.fullmatch(text):
        found = re.sub(_UNIT_WORD, lambda word: _UNITS[word[0]], text)
    found = {"lb": "lbf"}.get(found, found)
    return found if found and any(key.takes(f"1 {found}") for key in ALL.values()) else ""


@dataclass(frozen=True)
class Name:
    """What the name of a row says.

    Parameters
    ----------
    keys : that it may be of, ("weave",) or ("description",); empty of a name such as "Warp" alone
    title : by which it is known
    families : of "warp", "weft", in the order of the name; empty if it says neither
    unit : behind it, "" without
    of : "yarn", "fabric", or "" if it does not say
    bound : "least" or "most" of a bound, else ""
    """

    keys: tuple[str, ...]
    title: str = ""
    families: tuple[str, ...] = ()
    unit: str = ""
    of: str = ""
    bound: str = ""


def _words(text):
    return [word for word in re.split(r"[\s,/&+:;.*()\[\]-]+", text) if word]


# {name: keys that it may be of}, the longest first; a width is of the fabric if it does not say of what
_TITLES: dict[str, tuple[str, ...]] = {
    key.replace("_", " "): (key,) for key in ALL if key != "width"
}
for _key, _names in NAMES.items():
    for _name in map(" ".join, map(_words, _names)):
        _TITLES[_name] = tuple(dict.fromkeys((*_TITLES.get(_name, ()), _key)))
_TITLES = dict(sorted(_TITLES.items(), key=lambda item: -len(item[0])))


@cache
def find(text: str) -> Name | None:
    """Return the Name that a text is; None if a word of it is not known."""
    folded = rewrite("in_names", fold(text))
    if DESCRIPTION in _TITLES.get(" ".join(_words(folded)), ()):
        return Name((DESCRIPTION,), folded)
    if not folded or len(folded) > 90 or not AROUND["other"].isdisjoint(_words(folded)):
        return None
    written = ""
    more = []
    for inside in re.findall(r"[\[(]([^\])]*)[\])]", folded):
        bound = [word for word in _words(inside) if word in AROUND["least"] | AROUND["most"]]
        inside = re.sub(rf"[, ]*\b(?:{'|'.join(bound)})\b", "", inside) if bound else inside
        rest, found = ("", unit(inside)) if unit(inside) else _without_unit(inside)
        written = written or found
        more += [*bound, *(word for word in _words(rest) if not word.isdigit())]
    plain = re.sub(r"[\[(][^\])]*[\])]", " ", folded).strip(" :.")
    plain, comma, last = plain.rpartition(",")
    if last.strip() in AROUND["least"] | AROUND["most"]:
        more.append(last.strip())
    else:
        plain += comma + last
    parts = (plain, *re.split(r"\s/\s|\s\|\s", plain))
    return next((name for part in parts if (name := _find_one(part, written, more))), None)


def _find_one(text, written, more):
    """Return the Name of a text without brackets, of which `more` are the words and `written` the
    unit."""
    if not written:
        text, written = _without_unit(text)
    words = _words(re.sub(r"(?<=[a-z])\^\d|\b\d\)$", "", text))  # without marks of footnotes
    flat = " ".join(words)
    said = [*words, *more]
    families = tuple(dict.fromkeys(filter(None, map(family_of, said))))
    whole = " ".join(word for word in words if word not in AROUND["nothing"])
    if DESCRIPTION in (*_TITLES.get(flat, ()), *_TITLES.get(whole, ())):
        return Name((DESCRIPTION,), flat)
    keys: tuple[str, ...] = ()
    title, rest = "", said
    for title, named in _TITLES.items():
        keys = tuple(key for key in named if key != DESCRIPTION)
        at = re.search(rf"(?<!\S){re.escape(title)}(?!\S)", flat)
        if keys and at:
            rest = [*flat[: at.start()].split(), *flat[at.end() :].split(), *more]
            break
        keys = ()
    if not _MEANT.issuperset(rest) or not (keys or families):
        return None
    of = next((kind for kind in ("yarn", "fabric") if not AROUND[kind].isdisjoint(said)), "")
    if of == "yarn" and keys:  # neither the thickness of a yarn nor its weight is a key
        keys = tuple(key for key in keys if key not in ("thickness", "areal_density"))
        if not keys:
            return None
    bound = next((kind for kind in ("least", "most") if not AROUND[kind].isdisjoint(rest)), "")
    return Name(
        keys,
        title if keys else "",
        families,
        written or unit(title.split()[-1] if keys else flat),
        of,
        bound,
    )


def _without_unit(text):
    """Return (the text before a unit at its end, that unit), or (the text, "")."""
    for cut in re.finditer(r"\s*(?:[,:/]|\s-\s|\sin\s|\bper\b|(?<=\s)(?=[a-z%\"/]|1 ?/))", text):
        before, behind = text[: cut.start()].strip(" ,-:"), text[cut.start() :]
        for tail in (behind, re.sub(r"^\s*(?:[,:/-]|in\s)\s*", "", behind)):
            # "Ends / Picks per inch" is no unit of ends
            if before and not family_of(tail.strip(" /").split(" ")[0]) and (found := unit(tail)):
                return before, found
    return text, ""


def has_word(role: str, text: str) -> bool:
    """Tell whether a text has a word of a role of `[around]`."""
    return not AROUND[role].isdisjoint(_words(fold(text)))


def has_only(roles: Iterable[str], text: str) -> bool:
    """Tell whether a text has words of these roles of `[around]` alone."""
    return frozenset().union(*(AROUND[role] for role in roles)).issuperset(_words(fold(text)))


def family_of(word: str) -> str:
    """Return "warp" or "weft" of a word that is one, else ""."""
    return next((family for family in FAMILIES if word.strip(".") in AROUND[family]), "")


def column(text: str) -> str:
    """Return what a column of this heading has: "name", "value", "unit", ...; "" if that is not known."""
    return _COLUMNS.get(" ".join(_words(re.sub(r"[\[(].*?[\])]", " ", fold(text)))), "")


def find_weave(text: str) -> str:
    """Return the name of the weave that a text is, or its one part that is a weave; else ""."""
    folded = re.sub(r"(?<=\d):(?=\d)", "/", fold(text))
    found = []
    for part in (folded, *re.split(r"\s/\s|[,;|]\s*|\s-\s|:\s|[()]", folded)):
        words = " ".join(_WEAVES.get(word, word) for word in part.strip(" .").split())
        with suppress(InputError):
            found.append(Pattern.read(words).name)
    return found[0] if len(set(found)) == 1 else ""


def named(rows: Iterable[Row], keys: Iterable[str], path: FilePath) -> Iterator[Row]:
    """Yield the rows of a table of warp and weft with the key that each is of, and its unit behind its
    numbers; a row of no key stays as it is, and one that describes the fabric is left out.

    Parameters
    ----------
    rows : with the cells key, warp and, if wanted, others
    keys : that a row may have as its name
    """
    exact = {key.replace("_", " "): key for key in keys}
    for line, cells in rows:
        written = cells["key"]
        name = find(written)
        key = exact.get(fold(written), "")
        if key or not (name and name.keys) or len(name.families) == 1 or name.bound:
            yield line, cells | {"key": key or written}
        elif WEAVE in name.keys:
            if cells["warp"].strip():  # a cell that says nothing states no weave
                yield line, cells | {"key": WEAVE}
        # a row that may have a number may say the name of the yarn
        elif DESCRIPTION in name.keys or (
            name.keys[0] == "linear_density" and cells["warp"].strip()[:1].isalpha()
        ):
            LOG.info(f"{path}: left out, {line}: {written} {cells['warp']}".rstrip())
        else:
            found = _with_unit(cells, name.unit)
            key = next((key for key in name.keys if ALL[key].takes(found["warp"])), name.keys[0])
            LOG.info(f"{path}: {line}: {written} is taken for {key}")
            yield line, found | {"key": key}


def _with_unit(cells: Mapping[str, str], unit: str) -> dict[str, str]:
    """The cells of which numbers alone have the unit that stands behind the name of their row."""
    bare = {family for family in FAMILIES if unit and NUMBER.fullmatch(cells.get(family, ""))}
    return {key: f"{cell} {unit}" if key in bare else cell for key, cell in cells.items()}
