"""Data sheets of fabrics as makers print them: what is understood is taken, and nothing is guessed.

A sheet is a table whose cells are separated by bars, tabs, semicolons or commas, or text: "name: value",
columns two blanks apart, or one. It is read in each way, and that which gives most keys is taken. A line is
used for a key, or says why it is not: numbers that may be warp and weft, or of two fabrics, are left unless
one reading alone is possible, and so are lines that disagree. A count without a unit is that per inch, cm or
10 cm which linear density and areal density leave.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import read_text
from fabrics.fabric_tables import FAMILIES, OF_FABRIC
from fabrics.families import list_families
from weavecell.scenes import sheet_names
from weavecell.scenes.missing_values import BREAKING, Value
from weavecell.scenes.sheet_cells import (
    ROUNDED,
    Unclear,
    UnknownWords,
    clean,
    read_cells,
    read_number,
)
from weavecell.scenes.sheet_names import ALL, DESCRIPTION, PATTERNS, WEAVE, Name, fold

MOST_LINES = 1000
MARKS = ("|", "\t", ";", ",", "")
# mass of straight yarns over that of the fabric
STRAIGHT = (0.8, 1.1)
# keys for which the least value may stand, which is what makers promise
PROMISED = ("count", "strength", "tenacity", BREAKING)
OF_FIBRE = ("strength", "tenacity", "modulus", "fibre_density", "failure_strain")
A_HEADING = "a heading"
_SEVERAL = "of several fabrics: name the file after one of them, or leave one in it"


@dataclass
class Line:
    """A line of a sheet: the keys that it is used for, or why it is not used."""

    number: int
    text: str
    keys: list[str] = field(default_factory=list)
    why: str = ""


@dataclass(frozen=True)
class Sheet:
    """What is understood of a sheet: {key: Value}, the fibre family or None, and its lines."""

    values: dict[str, Value]
    family: str | None
    lines: tuple[Line, ...]


def read(path: FilePath, hints: Sequence[str] = ()) -> Sheet:
    """Read what is understood of a sheet.

    Parameters
    ----------
    hints : names that may say which of several fabrics is meant, beside that of the file

    Raises
    ------
    InputError : no file, or nothing of it is understood
    """
    try:
        text = read_text(path)
    except OSError as problem:
        allowed = f"a data sheet ({problem.strerror})"
        raise InputError("cannot be read", file=path, allowed=allowed) from problem
    lines = text.splitlines()
    if len(lines) > MOST_LINES:  # a curve
        raise InputError(file=path, key="lines", value=len(lines), allowed=f"at most {MOST_LINES}")
    named = [fold(hint) for hint in (Path(path).stem, *hints)]
    sheets = [_Reader(lines, mark, Path(path).name, named).sheet() for mark in MARKS]
    best = max(
        sheets, key=lambda each: (len(each.values), sum(len(line.keys) for line in each.lines))
    )
    if not best.values:
        of_several = next(
            (line.why for each in sheets for line in each.lines if _SEVERAL == line.why), None
        )
        if of_several:
            raise InputError(f"is {of_several}", file=path)
        allowed = "lines of a name, a number and a unit, such as Thickness: 0.30 mm"
        raise InputError("nothing of this sheet is understood", file=path, allowed=allowed)
    return best


class _Reader:
    """One way to separate the cells of a sheet, and what it has given so far."""

    def __init__(self, lines, mark, file, hints):
        self.mark, self.file, self.hints = mark, file, hints
        # no comment of a TOML file has control characters
        texts = [re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", " ", text) for text in lines]
        self.rows = [
            (Line(number, text.strip()), self.split(text))
            for number, text in enumerate(texts, 1)
            if re.search(r"\w", text)
        ]
        self.lines = [line for line, _ in self.rows]
        everything = PATTERNS["untreated"].sub(" ", fold(" ".join(texts)))
        self.treated = sheet_names.has_word("treated", everything)
        self.columns: list[str] = []  # role of each
        self.chosen: int | None = None  # of the columns of fabrics
        self.section = ""  # "warp", "weft", "yarn", "fabric" or "other"
        self.pending: Name | None = None  # its values stand in the lines below
        self.found: dict[str, dict[str, tuple[str, float, Line]]] = {}  # of key and family
        self.bare: list[tuple[dict[str, float], Line]] = []  # counts without a unit
        self.clashes: dict[str, str] = {}
        self.weaves: dict[str, Line] = {}
        self.texts: list[
            tuple[str, Line, int]
        ] = []  # that may name fibre, yarn and weave; their rank
        self.unsaid_strain = False  # an elongation that does not say of what it is

    def sheet(self):
        """The Sheet of the lines."""
        while self.rows:
            line, cells = self.rows.pop(0)
            if not self.turn(line, cells) and not self.is_heading(line, cells):
                self.take(line, cells)
        self.settle_texts()
        self.settle_counts()
        return Sheet(self.values(), self.family(), tuple(self.lines))

    # rows

    def split(self, text):
        """The cells of a line."""
        cells = [text]
        if self.mark in (";", ","):
            with suppress(csv.Error):
                (cells,) = csv.reader([text], delimiter=self.mark, skipinitialspace=True)
        elif self.mark:
            cells = text.strip("|\n").split(self.mark)
        else:
            cells = re.split(r"\s{2,}|\t", text.strip())
        cells = [re.sub(r"\*\*|__|`", "", cell).strip() for cell in cells]
        filled = [cell for cell in cells if cell]
        if self.mark and len(filled) != 1:
            return cells
        return [part for cell in filled for part in _split_name(cell)]

    def turn(self, line, heading):
        """Turn a table with a heading of names and a row of each fabric; whether this is one."""
        known = sum(
            bool((name := sheet_names.find(cell)) and name.keys) for cell in heading if cell
        )
        if known < max(3, sum(map(bool, heading)) / 2) or any(
            cell[:1].isdigit() for cell in heading
        ):
            return False
        below = [row for row in self.rows if len(row[1]) == len(heading)]
        rest = [row for row in self.rows if len(row[1]) != len(heading)]
        self.columns = ["name", *["fabric"] * len(below)]
        self.chosen = self.choose([cells[0] for _, cells in below])
        used = 0 if self.chosen is None else self.chosen
        for row, _ in below:
            row.why = "of another fabric"
        if below:
            self.rows = [
                (below[used][0], [name, *(cells[place] for _, cells in below)])
                for place, name in enumerate(heading)
            ] + rest
        line.why = A_HEADING
        return True

    def is_heading(self, line, cells):
        """Whether the cells are headings of columns, which are then kept."""
        if len(cells) == 1 and all(map(sheet_names.column, parts := cells[0].split())):
            cells = parts  # columns one blank apart
        roles = [sheet_names.column(cell) for cell in cells]
        filled = [place for place, cell in enumerate(cells) if cell]
        others = [place for place in filled if place and not roles[place]]
        name = sheet_names.find(cells[0]) if cells[0] else None
        if others:
            # names of fabrics over their columns
            is_first = (
                not cells[0] or roles[0] == "name" or (name and name.title in ("style", "article"))
            )
            different = len({cells[place] for place in others}) == len(others) > 1
            numbers = [re.match(r"[\d.,]+(?![\w-])", cells[place]) for place in others]
            of_fabrics = is_first and different and (name is not None or not any(numbers))
            # two blanks separate columns: the first one has no heading
            unnamed = not cells[0] and not self.mark and len(cells) > 1
            if not of_fabrics and not unnamed:
                return False
        elif len(filled) < 2 or not {*roles} & {"value", "warp", "weft", "unit", "least"}:
            return False
        self.chosen = self.choose([cells[place] for place in others])
        self.columns = [
            role or ("fabric" if place in others else "name") for place, role in enumerate(roles)
        ]
        line.why = A_HEADING
        return True

    def choose(self, labels):
        """The place of the one fabric whose number a name of the files has; None without."""
        fits = [
            place
            for place, label in enumerate(labels)
            if any(
                re.search(rf"(?<!\d){number}(?!\d)", hint)
                for number in re.findall(r"\d{2,}", label)
                for hint in self.hints
            )
        ]
        return fits[0] if len(fits) == 1 else 0 if len(labels) == 1 else None

    def take(self, line, cells):
        """Take what a row gives, or say why not."""
        name, given = self.name_of(cells)
        if sheet_names.has_only(("fabric", "yarn", "nothing"), " ".join(cells)):
            kinds = [kind for kind in ("yarn", "fabric") if sheet_names.has_word(kind, cells[0])]
            self.section, line.why = "".join(kinds[:1]), A_HEADING
            self.pending = name
            return
        if name is None:
            self.take_unnamed(line, cells)
            return
        has_value = any(clean(cell) and not sheet_names.unit(cell) for _, cell in given)
        if not name.keys and not any(re.search(r"\d", cell) for _, cell in given):
            self.section = name.families[0] if len(name.families) == 1 else ""
            line.why = A_HEADING
            return
        if not name.keys:
            above = self.pending or Name(("count", "linear_density"))
            name = replace(above, families=name.families, unit=name.unit or above.unit)
        elif not has_value:
            units = [unit for _, cell in given if (unit := sheet_names.unit(cell))]
            self.pending = replace(name, unit=name.unit or "".join(units[:1]))
            line.why = A_HEADING
            return
        else:
            self.pending = None
        self.take_values(line, name, given)

    def name_of(self, cells):
        """(Name of a row or None, [(role of the column, cell)] of what follows it)."""
        columns = self.columns if self.mark or len(self.columns) == len(cells) else []
        places = [place for place, role in enumerate(columns[: len(cells)]) if role == "name"]
        for place in places or range(min(2, len(cells))):
            name = sheet_names.find(cells[place]) if cells[place] else None
            if name is not None:
                roles = [*columns, *[""] * len(cells)]
                pairs = [(role, cell) for role, cell in zip(roles, cells) if cell]
                return name, pairs[sum(map(bool, cells[: place + 1])) :]
        words = clean(cells[0]).split(" ") if len(cells) == 1 else []
        for count in range(min(len(words) - 1, 9), 0, -1):
            begin = " ".join(words[:count])
            name = sheet_names.find(begin)
            if re.search(r"\d", PATTERNS["digits_of_units"].sub("", begin)):
                continue
            rest = " ".join(words[count:])
            if name is None:
                continue
            is_text = {WEAVE, "linear_density"} & {*name.keys} or (
                count == 1 and DESCRIPTION in name.keys
            )
            if is_text or PATTERNS["begins_value"].match(rest):
                return name, [("", rest)]
        return None, []

    def take_unnamed(self, line, cells):
        """Take a row without a name: values of the name above it, the heading of a section, a title."""
        text = " ".join(cell for cell in cells if cell)
        pending, self.pending = self.pending, None
        line.why = "its name is not known"
        if pending is not None:
            self.take_values(line, pending, [("", text)])
            return
        is_short = len(text.split()) < 8 and not re.search(r"\d", re.sub(r"\(.*?\)", "", text))
        if sheet_names.has_word("other", text):
            if is_short and sum(map(bool, cells)) == 1 and not sheet_names.has_word("fabric", text):
                self.section, line.why = "other", "a heading of something else"
            return
        if not self.found and not self.columns:
            self.texts.append((text, line, 2))

    # values

    def take_values(self, line, name, given):
        """Take the values of a row whose name is known: [(role of the column, cell)]."""
        line.why = ""
        try:
            if self.section == "other":
                raise Unclear("of something else than fabric and yarn")
            given = self.of_one_fabric(given)
            text = ", ".join(dict.fromkeys(cell for role, cell in given if role != "unit"))
            if DESCRIPTION in name.keys:
                self.texts.append((text, line, 1))
                line.why = "a description"
            elif WEAVE in name.keys:
                self.take_weave(line, text)
            else:
                self.texts += [(text, line, 0)] * ("linear_density" in name.keys)
                self.put(line, name, *self.understand(line, name, given))
        except UnknownWords as why:
            line.why = str(why)
            if "linear_density" in name.keys and len(yarns := _yarns_of(text)) == 1:
                line.why = ""  # "Kevlar KM2 600 denier"
                self.put(line, name, "linear_density", {"": yarns.pop()})
        except Unclear as why:
            line.why = str(why)

    def of_one_fabric(self, given):
        """The cells of a row that are of the fabric that is meant."""
        fabrics = [cell for role, cell in given if role == "fabric"]
        others = [(role, cell) for role, cell in given if role not in ("fabric", "other", "name")]
        if fabrics and self.chosen is None and len({fold(cell) for cell in fabrics}) > 1:
            raise Unclear(_SEVERAL)
        if fabrics and len(fabrics) < self.columns.count("fabric"):
            raise Unclear("of some of several fabrics")
        if fabrics:
            others = [(role, cell) for role, cell in others if role == "unit"]
            others.append(("value", fabrics[self.chosen or 0]))
        if {"value", *FAMILIES} & {role for role, _ in others}:
            others = [(role, cell) for role, cell in others if role not in ("least", "most")]
        return others

    def take_weave(self, line, text):
        """Take the weave that a text is."""
        weave = sheet_names.find_weave(text)
        if not weave:
            raise Unclear("a weave that is not known")
        line.keys.append(WEAVE)
        self.weaves.setdefault(weave, line)

    def understand(self, line, name, given):
        """(key, {family or "": Reading}) of the cells of a row."""
        units = [name.unit]
        cells = []
        bounds = {name.bound, *({"least", "most"} & {role for role, _ in given})}
        of_columns = {role for role, _ in given if role in FAMILIES}
        for role, cell in given:
            if role in ("", "unit") and (unit := sheet_names.unit(cell)):
                units.insert(0, unit)
            elif role == "unit" and cell.strip("- "):
                raise Unclear("a unit that is not known")
            elif role in FAMILIES and not re.search(r"\w", cell):
                raise Unclear("of warp or weft alone")
            elif text := clean(cell):
                bounds |= (
                    {"least"}
                    if PATTERNS["least"].search(text)
                    else {"most"}
                    if PATTERNS["most"].search(text)
                    else set()
                )
                cells.append(f"{role} {text}" if len(of_columns) == 2 else text)
        roles = [role for role in self.columns if role in ("value", "least", "most", *FAMILIES)]
        text = PATTERNS["least"].sub(" ", " | ".join(cells))
        key, readings, words = read_cells(name, text, units[0], roles if len(cells) == 1 else ())
        if "most" in bounds or ("least" in bounds and key and key not in PROMISED):
            raise Unclear("a bound, and no value")
        if words and key not in ("", "count"):
            raise UnknownWords(f"{words} is no part of it")
        if words:  # "21 x 21 plain"
            self.take_weave(line, words)
        return key, readings

    def put(self, line, name, key, readings):
        """Keep the numbers of a row."""
        of = name.of or (self.section if self.section in ("yarn", "fabric") else "")
        if not key:
            self.bare.append(({family: number for family, (_, number) in readings.items()}, line))
            raise Unclear("has no unit")
        unit = next(iter(readings.values()))[0].partition(" ")[2]
        if key == "strength" and of != "yarn" and not unit.endswith(("Pa", "psi")):
            raise Unclear("a force without the width of the strip")
        if key in OF_FIBRE and of == "fabric":
            raise Unclear("of the fabric, not of its fibre")
        if key in ("areal_density", "thickness") and self.treated and of != "fabric":
            raise Unclear("may be of the treated fabric")
        self.unsaid_strain |= key == "failure_strain" and of != "yarn"
        if set(readings) == {""}:
            only = name.families if len(name.families) == 1 else ()
            only = only or ((self.section,) if self.section in FAMILIES else FAMILIES)
            readings = dict.fromkeys(FAMILIES if key in OF_FABRIC else only, readings[""])
        if key in OF_FABRIC and len({number for _, number in readings.values()}) > 1:
            raise Unclear("two numbers for one of the fabric")
        here = self.found.setdefault(key, {})
        for family, (text, number) in readings.items():
            first, other, above = here.setdefault(family, (text, number, line))
            if abs(number / other - 1) > ROUNDED:
                why = f"lines {above.number} and {line.number} disagree: {first} and {text}"
                self.clashes[key] = why
                raise Unclear(why)
        line.keys += [key] * (key not in line.keys)

    # what the whole sheet settles

    def settle_texts(self):
        """Take the linear density and the weave that texts say, where no row has one."""
        for rank in range(3):
            texts = [(clean(text), line) for text, line, of in self.texts if of == rank]
            said = {yarn: line for text, line in texts if rank for yarn in _yarns_of(text)}
            if said and not self.found.get("linear_density"):
                ((text, number), line), *others = said.items()
                if any(abs(other / number - 1) > ROUNDED for (_, other), _ in others):
                    self.clashes["linear_density"] = "several yarns"
                self.found["linear_density"] = dict.fromkeys(FAMILIES, (text, number, line))
                line.keys.append("linear_density")
            weaves = {
                weave: line for text, line in texts if (weave := sheet_names.find_weave(text))
            }
            if not self.weaves:
                self.weaves = weaves
                for line in weaves.values():
                    line.keys.append(WEAVE)

    def settle_counts(self):
        """Take a count without a unit as that per inch, cm or 10 cm which gives the areal density."""
        density = self.found.get("linear_density", {})
        areal = self.found.get("areal_density", {})
        pair = {family: number for numbers, _ in self.bare for family, number in numbers.items()}
        pair = {family: pair.get(family, pair.get("")) for family in FAMILIES}
        once = sum(len(numbers) for numbers, _ in self.bare) <= 2
        if (
            "count" in self.found
            or None in pair.values()
            or len(density) < 2
            or not areal
            or not once
        ):
            return
        fits = []
        for unit in ("/ inch", "/ cm", "/ 10 cm"):
            counts = {
                family: read_number("count", f"{pair[family]:g}", unit) for family in FAMILIES
            }
            if None not in counts.values():
                mass = sum(counts[family][1] * density[family][1] for family in FAMILIES)
                if STRAIGHT[0] < mass / areal["warp"][1] < STRAIGHT[1]:
                    fits.append((unit, counts))
        if len(fits) != 1:
            return
        ((unit, counts),) = fits
        for _, line in self.bare:
            line.keys.append("count")
            line.text += f" (its unit, {unit}, follows from the areal density)"
        self.found["count"] = {family: (*counts[family], self.bare[0][1]) for family in FAMILIES}

    def values(self):
        """{key: Value} of what is found of both yarns, or of the fabric."""
        values = {}
        if self.unsaid_strain and (BREAKING in self.found or not {*self.found} & {*OF_FIBRE[:3]}):
            self.clashes["failure_strain"] = "may be of a strip of fabric, not of the yarn"
        if len(self.weaves) > 1:
            self.clashes[WEAVE] = f"several weaves: {', '.join(self.weaves)}"
        for weave, line in self.weaves.items():
            self.found[WEAVE] = dict.fromkeys(FAMILIES, (weave, 0.0, line))
        for key in (*ALL, WEAVE):
            here = self.found.get(key, {})
            used = {line.number: line for _, _, line in here.values()}
            why = self.clashes.get(
                key, "" if len(here) != 1 else f"of the {next(iter(here))} alone"
            )
            if why:
                for line in self.lines:
                    line.why = why if key in line.keys else line.why
                    line.keys = [each for each in line.keys if each != key]
            elif here:
                quoted = [f"line {number}: {line.text}" for number, line in used.items()]
                weft = "" if key in OF_FABRIC or key == WEAVE else here["weft"][0]
                source = f"{self.file}, {'; '.join(quoted)}"
                values[key] = Value(here["warp"][0], weft, source, row=min(used))
        return values

    def family(self):
        """The fibre family that the texts of the sheet name, if one alone; else None."""
        words = [
            (fold(word), each) for each in list_families() for word in (each.name, *each.known_as)
        ]
        said: dict[str, Line] = {}
        for text, line, _ in self.texts:
            rest = fold(text)
            if PATTERNS["no_family"].search(rest):
                return None
            # the longest first: polyethylene terephthalate is no polyethylene
            for word, family in sorted(words, key=lambda each: -len(each[0])):
                whole = rf"(?<![\w-]){re.escape(word)}(?:[ae]|faser|gewebe)?(?![a-z])"
                rest, times = re.subn(whole, " ", rest)
                if times:
                    said.setdefault(family.name, line)
        if len(said) != 1:
            return None
        ((name, line),) = said.items()
        line.keys.append("family")
        return name


def _yarns_of(text):
    """{Reading} of the linear densities that a text says; empty if it speaks of plied yarns."""
    folded = clean(text)
    if PATTERNS["plied"].search(PATTERNS["yarn"].sub(" ", folded)):
        return set()
    found = [
        read_number("linear_density", number, sheet_names.unit(unit))
        for number, unit in PATTERNS["yarn"].findall(folded)
    ]
    return {reading for reading in found if reading}


def _split_name(cell):
    """[name, value] of "name: value" and "name = value", else [the cell]."""
    parts = re.split(r"\s*(?<!\d):(?=\s|$)\s*|\s+[:=]\s+|(?<=[A-Za-z)\]]):(?=\S)", cell, maxsplit=1)
    return parts if len(parts) > 1 and parts[0] else [cell]
