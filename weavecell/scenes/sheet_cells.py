"""The numbers of a row of a data sheet as its maker prints it: `34 x 33 / inch`, `5.3 oz/yd² (180 g/m²)`.

One reading alone may be left of them, of one or of two families and in any number of units that agree; else
`Unclear` says why there is none.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

from fabrics.base.errors import InputError
from fabrics.fabric_tables import FAMILIES
from weavecell.scenes import sheet_names
from weavecell.scenes.missing_values import BREAKING
from weavecell.scenes.sheet_names import ALL, PATTERNS, Name, fold

# [-] numbers that differ by no more are one, rounded in two units
ROUNDED = 0.035
# linear density over the number of filaments behind a solidus, which is that of no two yarns of a fabric
FILAMENTS = 5
Reading = tuple[str, float]  # as a fabric file has it, and in SI

_NUMBER = r"(?:\d{1,3}(?:[,.']\d{3})+(?:[.,]\d+)?(?![\d.,])|\d+(?:[.,]\d+)?|[.,]\d+)"
_TOKEN = re.compile(rf"({_NUMBER})|([x*/,;|:()\[\]])|([^\W\d_][\w'^.-]*|\S)")
_AND = ("by", "and", "und", "et")


class Unclear(Exception):
    """A value of which no reading is left, or more than one."""


class UnknownWords(Unclear):
    """A value with words that are not known, and so with none or one in them."""


@dataclass
class Amount:
    """A number of a cell: as written, its unit, family, the mark before it, and the bracket it is in."""

    number: str
    unit: str = ""
    family: str = ""
    mark: str = ""
    bracket: int = 0


def clean(text: str) -> str:
    """Fold a cell, without tolerances, standards and words that change nothing."""
    text = sheet_names.rewrite("in_values", fold(PATTERNS["standard"].sub(" ", text)))
    return " ".join(text.split()).strip(" -:")


def differ(one: float, other: float) -> bool:
    """Tell whether two numbers are unlike by more than their rounding in two units."""
    return abs(one - other) > ROUNDED * max(one, other)


def read_number(key: str, written: str, unit: str) -> Reading | None:
    """Read a number with a unit of a key; None if it is out of bounds, or may be two by its comma."""
    fits = []
    for number in _numbers_of(written):
        text = f"{number:.10g} {unit}".strip()
        with suppress(InputError):
            fits.append((text, ALL[key].read(text)[0]))
    if not fits or (len(fits) > 1 and "," in written):
        return None
    return fits[0]


def read_cells(
    name: Name, text: str, unit: str, order: Sequence[str] = ()
) -> tuple[str, dict[str, Reading], str]:
    """Read the numbers of a row.

    Parameters
    ----------
    text : its cleaned cells, with bars between them
    unit : of the row, for numbers that have none
    order : what columns hold that stand one blank apart

    Returns
    -------
    (key, {"warp", "weft" or "" of both: Reading}, words that are not known); the key is "" of a count
    without a unit

    Raises
    ------
    Unclear : no reading is left, or more than one
    """
    if "linear_density" in name.keys:
        text = PATTERNS["filaments"].sub(" ", PATTERNS["yarn_of_glass"].sub(_tex_of_glass, text))
    amounts, words = _find_amounts(text)
    if not amounts:
        raise UnknownWords("no number of it is understood")
    if words and not sheet_names.find_weave(" ".join(words)):
        raise UnknownWords(f"what {' '.join(words)} means is not known")
    for amount, behind in reversed(list(pairwise(amounts))):
        if not amount.unit and behind.mark != "|" and behind.bracket == amount.bracket:
            amount.unit = behind.unit  # "850 x 880 N/5cm"
    of_units: dict[tuple[str, int], list[Amount]] = {}
    for amount in amounts:
        of_units.setdefault((amount.unit or unit, amount.bracket), []).append(amount)
    readings = [
        _read_one_unit(name, several, of_unit, order) for (of_unit, _), several in of_units.items()
    ]
    key, first = readings[0]
    for other, found in readings:
        if other != key:
            raise Unclear(f"may be {key} or {other}")
        for family, (written, number) in found.items():
            own = first.get(family) or first.get("") or next(iter(first.values()))
            if differ(number, own[1]):
                raise Unclear(f"its numbers disagree: {own[0]} and {written}")
    return key, first, " ".join(words)


def read_yarns(text: str) -> set[Reading]:
    """Read the linear densities that a text says, such as "Kevlar KM2 600 denier"; none of plied yarns."""
    folded = clean(text)
    if PATTERNS["plied"].search(PATTERNS["yarn"].sub(" ", folded)):
        return set()
    written = PATTERNS["yarn"].findall(folded)
    found = {read_number("linear_density", each, sheet_names.unit(unit)) for each, unit in written}
    return {reading for reading in found if reading}


def _tex_of_glass(found):
    """Return the tex of a yarn of glass, whose number is hundreds of yards in a pound of one
    strand."""
    strands = max(1, int(found[2])) * max(1, int(found[3]))
    return f"{496054.648 / (100 * float(found[1]) * strands):.5g} tex"


def _find_amounts(text):
    """Return ([Amount] of a text, words that are not known)."""
    found: list[Amount] = []
    words = []
    end = bracket = 0
    family = mark = ""
    while end < len(text):
        length = _length_of_unit(text, end) if found else 0
        if length:
            found[-1].unit = found[-1].unit or sheet_names.unit(text[end : end + length])
            end += length
            continue
        token = _TOKEN.match(text, end)
        if token is None:  # a blank
            end += 1
            continue
        end = token.end()
        number, sign, word = token.groups()
        said = sheet_names.family_of(word or "")
        if number:
            inherited = found[-1].family if bracket and found else ""
            found.append(Amount(number, family=family or inherited, mark=mark, bracket=bracket))
            family = mark = ""
        elif said and found and not found[-1].family and not mark and found[0].mark != "|":
            found[-1].family = said
        elif said:
            family = said
        elif word and word not in _AND:
            words.append(word)
        elif sign and sign in "([":
            # brackets around a number hold it in another unit
            bracket = len(found) if re.match(rf"[^\])]*{_NUMBER}", text[end:]) else 0
        elif sign and sign in ")]":
            bracket = 0
        elif sign != ":":
            mark = "x" if word or sign == "*" else sign
    return found, words


def _length_of_unit(text, start):
    """Return the length of the longest unit at a place of a text, 0 without one."""
    rest = re.split(r"[,;|()\[\]]", text[start : start + 30])[0]
    for stop in sorted({found.end() for found in re.finditer(r"[\w%\"'^.-]+", rest)}, reverse=True):
        if not re.match(r"\s*\^|\d", rest[stop:]) and sheet_names.unit(rest[:stop]):
            return stop
    return 0


def _numbers_of(text):
    """Return [numbers that a text may be by its marks, the likely one first]."""
    text = text.replace("'", "")
    if "," in text and "." in text:
        thousands = min(",.", key=text.rindex)
        return [float(text.replace(thousands, "").replace(",", "."))]
    mark = "," if "," in text else "."
    if text.count(mark) > 1:
        return [float(text.replace(mark, ""))]
    numbers = [float(text.replace(",", "."))]
    if re.fullmatch(r"[1-9]\d{0,2}[.,]\d{3}", text):
        numbers.append(float(text.replace(mark, "")))
    return numbers


def _read_one_unit(name, amounts, unit, order):
    """Return (key, {family or "": Reading}) of the numbers of one unit."""
    if not unit and "count" not in name.keys:
        raise Unclear("has no unit")
    key = next((key for key in name.keys if unit and ALL[key].takes(f"1 {unit}")), "")
    if unit and not key:
        raise Unclear(f"{unit} is no unit of {' or '.join(name.keys)}")
    found = {}
    for family, amount in _of_families(name, key, amounts, order):
        reading = (
            read_number(key, amount.number, unit) if key else ("", _numbers_of(amount.number)[0])
        )
        if reading is None:
            raise Unclear(f"{amount.number} {unit} is no {key}")
        found[family] = reading
    return key, found


def _of_families(name, key, amounts, order):
    """Return (family or "" of both, Amount) of one or two numbers."""
    if len(amounts) == len(order) > 1:
        roles = dict(zip(order, amounts))
        return (
            [("", roles["value"])]
            if "value" in roles
            else [(each, roles[each]) for each in FAMILIES]
        )
    if len(amounts) == 1:
        return [(amounts[0].family, amounts[0])]
    if len(amounts) > 2:
        raise Unclear("more numbers than warp and weft")
    first, second = amounts
    pair = name.families if len(name.families) == 2 else FAMILIES
    if first.family or second.family:
        if first.family == second.family:
            raise Unclear(f"two numbers of the {first.family}")
        is_weft = first.family == "weft" or second.family == "warp"
        return zip(reversed(FAMILIES) if is_weft else FAMILIES, amounts)
    solidus = second.mark == "/"
    if (
        second.mark == "x"
        or len(name.families) == 2
        or (solidus and key in ("", "count", BREAKING))
    ):
        return zip(pair, amounts)
    if key == "linear_density" and solidus:
        if _numbers_of(first.number)[0] >= FILAMENTS * _numbers_of(second.number)[0]:
            return [("", first)]
        raise Unclear(f"{first.number}/{second.number} may be warp and weft, or filaments")
    if first.number == second.number:
        return [("", first)]
    # "12 500 N/5cm", if it cannot be two numbers
    thousands = re.fullmatch(r"\d{1,3} \d{3}", f"{first.number} {second.number}")
    if thousands and not second.mark and key and not read_number(key, first.number, second.unit):
        return [("", replace(first, number=first.number + second.number))]
    raise Unclear(f"{first.number} and {second.number}: it does not say of what each is")
