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

_DATA = read_data(Path(__file__).with_suffix(".toml"))
NAMES: dict[str, list[str]] = _DATA["names"]
_AROUND = {role: frozenset(words) for role, words in _DATA["around"].items()}
_COLUMNS = {word: role for role, words in _DATA["columns"].items() for word in words}
_UNITS = {word: unit for unit, words in _DATA["units"].items() for word in words}
_WHOLE_UNITS = {word: unit for unit, words in _DATA["whole_units"].items() for word in words}
_UNIT_PATTERNS = [(re.compile(old), new) for old, new in _DATA["unit_patterns"].items()]
_WEAVES = {word: weave for weave, words in _DATA["weaves"].items() for word in words}
_KNOWN_AROUND = frozenset().union(
    *(_AROUND[role] for role in _AROUND if role not in ("other", "treated"))
)
# one unit of a product, such as "/ 10 cm" and "m^2"
_FACTOR = re.compile(
    r"\s*(/?)\s*(5|10|50|100)?\s*(%|\"|''|[a-z][a-z-]*[a-z]|[a-z])\.?\s*(?:\^?(-?[123])(?![\d.]))?"
)
_FOLDED = {
    "×": "x",
    "²": "^2",
    "³": "^3",
    "ß": "ss",
    "”": '"',
    "“": '"',
    "″": '"',
    "’": "'",
    "µ": "u",
    "μ": "u",
}
_FOLDED |= dict.fromkeys("–—−‐‑", "-") | dict.fromkeys("®™©¹⁴⁵⁶⁷⁸⁹†‡§", "") | {"⁻": "-", "·": " "}
_UNDER_PRESSURE = re.compile(r"\b(?:at|under|bei|sous)\s+[\d.,]+\s*(?:kpa|psi|g/cm\^2)")


def fold(text: str) -> str:
    """Write a text in small letters without accents, signs of trade marks and marks of footnotes."""
    text = "".join(_FOLDED.get(char, char) for char in text.replace("10⁶", "10^6"))
    letters = unicodedata.normalize("NFKD", text)
    plain = "".join(char for char in letters if not unicodedata.combining(char)).lower()
    return re.sub(r"[\s_]+", " ", plain).strip()


@cache
def unit(written: str) -> str:
    """Return the unit of a text as `fabrics.base.units` reads it; "" if it is none of a data sheet."""
    text = fold(written).strip("[]() .")
    for pattern, new in _UNIT_PATTERNS:
        text = pattern.sub(new, text)
    text = re.sub(r" ?/ ?", "/", text).strip(" .")
    if text in _WHOLE_UNITS:
        return _WHOLE_UNITS[text]
    above, below, end = [], [], 0
    while end < len(text):
        factor = _FACTOR.match(text, end)
        if factor is None or factor[3] not in _UNITS or (factor[2] and not factor[1]):
            return ""
        power = int(factor[4] or 1)
        of = f"{factor[2] or ''} {_UNITS[factor[3]]}".strip() + (
            "" if abs(power) == 1 else f"^{abs(power)}"
        )
        (below if factor[1] or power < 0 else above).append(of)
        end = factor.end()
    if len(above) > 1:
        return ""
    found = " ".join(above) + (
        "" if not below else f"/{' '.join(below)}" if above else f"/ {' '.join(below)}"
    )
    found = {"lb": "lbf", "g/10 cm": ""}.get(found, found)
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


def _titles():
    """{name: keys that it may be of}."""
    found: dict[str, tuple[str, ...]] = {
        key.replace("_", " "): (key,)
        for key in ALL
        if key != "width"  # of the fabric, where it does not say of what
    }
    for key, names in NAMES.items():
        for name in names:
            words = " ".join(_words(name))
            found[words] = tuple(dict.fromkeys((*found.get(words, ()), key)))
    return found


def _words(text):
    return [word for word in re.split(r"[\s,/&+:;.*()\[\]-]+", text) if word]


_TITLES = _titles()
_LONGEST_FIRST = sorted(_TITLES, key=len, reverse=True)


@cache
def find(text: str) -> Name | None:
    """Return the Name that a text is; None if a word of it is not known."""
    folded = _UNDER_PRESSURE.sub(" ", fold(text))
    folded = re.sub(r"\bw x f\b", "warp x weft", folded)
    if not folded or len(folded) > 90:
        return None
    brackets = re.findall(r"[\[(]([^\])]*)[\])]", folded)
    plain = re.sub(r"[\[(][^\])]*[\])]", " ", folded).strip(" :")
    if set(_words(folded)) & _AROUND["other"]:
        return None
    units, more = [], []
    for inside in brackets:
        bound = [word for word in _words(inside) if word in _AROUND["least"] | _AROUND["most"]]
        found = unit(re.sub(rf"[, ]*\b(?:{'|'.join(bound)})\b", "", inside) if bound else inside)
        units += [found] * bool(found)
        more += bound if found else [word for word in _words(inside) if not word.isdigit()]
    for part in (plain, *re.split(r"\s/\s|\s\|\s", plain)):
        found = _find_one(part, units[0] if units else "", more)
        if found is not None:
            return found
    return None


def _find_one(text, written, more):
    """The Name of a text without brackets, of which `more` are the words and `written` the unit."""
    if not written:
        text, written = _without_unit(text)
    text = re.sub(r"(?<=[a-z])\^\d|\b\d\)$", "", text)  # marks of footnotes
    words = _words(text)
    everything = [*words, *more]
    families = [family for word in everything for family in FAMILIES if word in _AROUND[family]]
    flat = " ".join(words)
    whole = " ".join(word for word in words if word not in _AROUND["nothing"])
    if DESCRIPTION in _TITLES.get(flat, ()) or DESCRIPTION in _TITLES.get(whole, ()):
        return Name((DESCRIPTION,), flat)
    for title in _LONGEST_FIRST:
        keys = tuple(key for key in _TITLES[title] if key != DESCRIPTION)
        at = re.search(rf"(?<!\S){re.escape(title)}(?!\S)", flat)
        if keys and at:
            rest = [*flat[: at.start()].split(), *flat[at.end() :].split(), *more]
            break
    else:
        keys, title, rest = (), "", everything
        if not families:
            return None
    if not {*rest} <= _KNOWN_AROUND:
        return None
    if not written and unit(flat):
        written = unit(flat)  # "Denier"
    said = {*everything}
    of = next((kind for kind in ("yarn", "fabric") if said & _AROUND[kind]), "")
    if of == "yarn":  # the thickness of a yarn, and what a length of it weighs, are no keys
        keys = tuple(key for key in keys if key not in ("thickness", "areal_density"))
        if not keys:
            return None
    bound = next((kind for kind in ("least", "most") if {*rest} & _AROUND[kind]), "")
    return Name(keys, title, tuple(dict.fromkeys(families)), written, of, bound)


def _without_unit(text):
    """(the text before a unit at its end, that unit), or (the text, "")."""
    for cut in re.finditer(r"\s*(?:,|:|\s-\s|\sin\s|/|\bper\b|(?<=\s)(?=[a-z%\"/]|1 ?/))", text):
        before, behind = text[: cut.start()].strip(" ,-:"), text[cut.start() :]
        for tail in (behind, re.sub(r"^\s*(?:,|:|-|in\s|/)\s*", "", behind)):
            found = unit(tail)
            if before and found and tail.strip() not in _AROUND["warp"] | _AROUND["weft"]:
                return before, found
    return text, ""


def has_word(role: str, text: str) -> bool:
    """Tell whether a text has a word of a role of `[around]`."""
    return not _AROUND[role].isdisjoint(_words(fold(text)))


def has_only(roles: Iterable[str], text: str) -> bool:
    """Tell whether a text has words of these roles of `[around]` alone."""
    return set(_words(fold(text))) <= frozenset().union(*(_AROUND[role] for role in roles))


def family_of(word: str) -> str:
    """Return "warp" or "weft" of a word that is one, else ""."""
    return next((family for family in FAMILIES if word.strip(".") in _AROUND[family]), "")


def column(text: str) -> str:
    """Return what a column of this heading has: "name", "value", "unit", ...; "" if that is not known."""
    plain = re.sub(r"[\[(].*?[\])]", " ", fold(text))
    return _COLUMNS.get(" ".join(_words(plain)), "")


def find_weave(text: str) -> str:
    """Return the name of the weave that a text or a part of it is, else ""."""
    folded = re.sub(r"(?<=\d):(?=\d)", "/", fold(text))
    for part in (folded, *re.split(r"[,;|]\s*|\s-\s|:\s|[()]", folded)):
        words = " ".join(_WEAVES.get(word, word) for word in part.strip(" .").split())
        with suppress(InputError):
            return Pattern.read(words).name
    return ""


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
        if (key := exact.get(fold(written))) is not None:
            yield line, cells | {"key": key}
            continue
        name = find(written)
        if name is None or not name.keys or len(name.families) == 1 or name.bound:
            yield line, dict(cells)
            continue
        if WEAVE in name.keys:
            if cells["warp"].strip():  # a cell that says nothing states no weave
                yield line, cells | {"key": WEAVE}
            continue
        # a row that may have a number says the name of the yarn
        is_text = name.keys[0] == "linear_density" and cells["warp"].strip()[:1].isalpha()
        if DESCRIPTION in name.keys or is_text:
            LOG.info(f"{path}: left out, {line}: {written} {cells['warp']}".rstrip())
            continue
        found = _with_unit(cells, name.unit)
        key = next((key for key in name.keys if ALL[key].takes(found["warp"])), name.keys[0])
        if fold(written) != key.replace("_", " "):
            LOG.info(f"{path}: {line}: {written} is taken for {key}")
        yield line, found | {"key": key}


def _with_unit(cells: Mapping[str, str], unit: str) -> dict[str, str]:
    """The cells of which numbers alone have the unit that stands behind the name of their row."""
    changed = dict(cells)
    for family in FAMILIES:
        text = changed.get(family, "")
        if unit and NUMBER.fullmatch(text):
            changed[family] = f"{text} {unit}"
    return changed
