"""Data sheets of fabrics as makers print them: what is understood is taken, and nothing is guessed.

A sheet is a table whose cells are separated by bars, tabs, semicolons or commas, or text: "name: value",
columns two blanks apart, or one. It is read in each way, and that which gives most keys is taken. A line is
used for a key, or says why it is not: numbers that may be warp and weft, or of two fabrics, are left unless
one reading alone is possible, and so are lines that disagree. A count without a unit is that per inch, cm or
10 cm which linear density and areal density leave.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from fabrics.base import tables
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.files import read_text
from fabrics.fabric_tables import FAMILIES, OF_FABRIC
from fabrics.families import list_families
from weavecell.scenes import sheet_names
from weavecell.scenes.missing_values import BREAKING, Value
from weavecell.scenes.sheet_cells import (
    Unclear,
    UnknownWords,
    clean,
    differ,
    read_cells,
    read_number,
    read_yarns,
)
from weavecell.scenes.sheet_names import ALL, DESCRIPTION, PATTERNS, WEAVE, Name, fold

MOST_LINES = 1000
MARKS = ("|", "\t", ";", ",", "&", "")
# mass of straight yarns over that of the fabric
STRAIGHT = (0.8, 1.1)
# keys for which the least value may stand, which is what makers promise
PROMISED = ("count", "strength", "tenacity", BREAKING)
OF_FIBRE = ("strength", "tenacity", "modulus", "fibre_density", "failure_strain")
A_HEADING = "a heading"
SEVERAL = "is of several fabrics: name the file after one of them, or leave one in it"


@dataclass(eq=False)
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
        text = sheet_names.rewrite("in_sheets", read_text(path))
    except OSError as problem:
        allowed = f"a data sheet ({problem.strerror})"
        raise InputError("cannot be read", file=path, allowed=allowed) from problem
    lines = text.splitlines()
    if len(lines) > MOST_LINES:  # a curve
        raise InputError(file=path, key="lines", value=len(lines), allowed=f"at most {MOST_LINES}")
    named = [fold(hint) for hint in (Path(path).stem, *hints)]
    sheets = [_Reader(lines, mark, Path(path).name, named).sheet() for mark in MARKS]
    best = max(sheets, key=lambda one: (len(one.values), sum(len(each.keys) for each in one.lines)))
    if best.values:
        return best
    for line in (line for each in sheets for line in each.lines):
        if line.why == SEVERAL or "disagree" in line.why:
            raise InputError(line.why, file=path, key=f"line {line.number}")
    allowed = "lines of a name, a number and a unit, such as Thickness: 0.30 mm"
    raise InputError("nothing of this sheet is understood", file=path, allowed=allowed)


class _Reader:
    """One way to separate the cells of a sheet, and what it has given so far."""

    def __init__(self, lines, mark, file, hints):
        self.mark, self.file, self.hints = mark, file, hints
        texts = {n: text for n, text in enumerate(lines, 1) if re.search(r"\w", text)}
        self.lines = [Line(number, text.strip()) for number, text in texts.items()]
        self.rows = [
            (line, cells) for line in self.lines for cells in self.split(texts[line.number])
        ]
        untreated = PATTERNS["untreated"].sub(" ", fold(" ".join(lines)))
        self.treated = sheet_names.has_word("treated", untreated)
        self.columns: list[str] = []  # role of each
        self.chosen: int | None = None  # of the columns of fabrics
        self.section = ""  # "warp", "weft", "yarn", "fabric" or "other"
        self.pending: Name | None = None  # its values stand in the lines below
        # of each key and family
        self.found: dict[str, dict[str, tuple[str, float, Line]]] = {}
        self.bare: list[tuple[str, float, Line]] = []  # family of counts without a unit
        self.clashes: dict[str, str] = {}  # why keys are left
        # that may name fibre, yarn and weave: in a row of the yarn, 0, a description, 1, or a title, 2
        self.texts: list[tuple[str, Line, int]] = []
        self.unsaid_strain = False  # an elongation that does not say of what it is

    def sheet(self):
        """Return the Sheet of the lines."""
        while self.rows:
            line, cells = self.rows.pop(0)
            if self.turn(cells) or self.is_heading(cells):
                line.why = A_HEADING
            else:
                self.take(line, cells)
        self.settle_texts()
        self.settle_counts()
        return Sheet(self.values(), self.family(), tuple(self.lines))

    # rows

    def split(self, text):
        """Return [cells] of the rows of a line, of which it mostly has one."""
        cells = [text] if self.mark else re.split(r"\s{2,}|\t", text.strip())
        with suppress(InputError):
            if self.mark:
                cells = tables.split_cells((0, text.strip("|")), self.mark, self.file)
        cells = [PATTERNS["no_text"].sub("", cell).strip() for cell in cells]
        filled = [cell for cell in cells if cell]
        pairs = [PATTERNS["between"].split(cell, maxsplit=1) for cell in filled]
        if len(pairs) > 1 and all(len(pair) == 2 for pair in pairs):
            return pairs
        beside = list(zip(filled[::2], filled[1::2]))  # name, value, name, value
        if len(beside) > 1 and len(filled) % 2 == 0:
            found = [[sheet_names.find(cell) for cell in pair] for pair in beside]
            if all(name and name.keys and value is None for name, value in found):
                return list(map(list, beside))
        if self.mark and len(filled) != 1:
            return [cells]
        parts = [part for pair in pairs for part in pair]
        # headings of columns, the first of which has none
        return [[""] * (len(parts) > 1 and text.startswith(" " * 8)) + parts]

    def turn(self, heading):
        """Turn a table with a heading of names and a row of each fabric; whether this is one."""
        names = [sheet_names.find(cell) for cell in heading if cell]
        known = sum(name is not None and bool(name.keys) for name in names)
        if known < max(3, len(names) / 2) or any(cell[:1].isdigit() for cell in heading):
            return False
        below = [row for row in self.rows if len(row[1]) == len(heading)]
        are_units = [all(map(sheet_names.unit, filter(None, cells))) for _, cells in below]
        fabrics = [row for row, units in zip(below, are_units) if not units]
        if not fabrics:
            return False
        self.columns = ["name", *("unit" if units else "fabric" for units in are_units)]
        self.chosen = self.choose([cells[0] for _, cells in fabrics])
        for line, _ in below:
            line.why = "of another fabric"
        used = fabrics[self.chosen or 0][0]
        others = [row for row in self.rows if len(row[1]) != len(heading)]
        turned = zip(heading, *(cells for _, cells in below))
        self.rows = [*((used, list(row)) for row in turned), *others]
        return True

    def is_heading(self, cells):
        """Tell whether the cells are headings of columns, which are then kept."""
        if len(cells) == 1 and all(map(sheet_names.column, cells[0].split())):
            cells = cells[0].split()  # columns one blank apart
        roles = [sheet_names.column(cell) for cell in cells]
        others = [place for place, cell in enumerate(cells) if place and cell and not roles[place]]
        labels = [cells[place] for place in others]
        if others:  # names of fabrics over their columns
            name = sheet_names.find(cells[0]) if cells[0] else None
            style = name is not None and name.title in ("style", "article", "artikel")
            numbers = any(re.match(r"[\d.,]+(?![\w-])", label) for label in labels)
            first = not cells[0] or roles[0] == "name"
            if (not style and (numbers or not first)) or not len(set(labels)) == len(labels) > 1:
                return False
        elif sum(map(bool, cells)) < 2 or {*roles} <= {"", "name", "most", "other"}:
            return False
        self.chosen = self.choose(labels)
        of_rest = dict.fromkeys(others, "fabric")
        self.columns = [role or of_rest.get(place, "name") for place, role in enumerate(roles)]
        return True

    def choose(self, labels):
        """Return the place of the one fabric whose number a name of the files has; None without."""
        numbers = [re.findall(r"\d{2,}", label) for label in labels]
        named = {number for hint in self.hints for number in re.findall(r"\d+", hint)}
        fits = [place for place, each in enumerate(numbers) if named & {*each}]
        return fits[0] if len(fits) == 1 else 0 if len(labels) == 1 else None

    def take(self, line, cells):
        """Take what a row gives, or say why not."""
        name, given = self.name_of(cells)
        above, self.pending = self.pending, None
        text = " ".join(filter(None, cells))
        only = sheet_names.has_only(("fabric", "yarn", "nothing"), text)
        units = [unit for _, cell in given if (unit := sheet_names.unit(cell))]
        if name is None and not only:
            self.take_unnamed(line, text, above)
        elif only or not (name.keys or any(re.search(r"\d", cell) for _, cell in given)):
            kinds = [kind for kind in FAMILIES if name and name.families == (kind,)]
            kinds += [kind for kind in ("yarn", "fabric") if sheet_names.has_word(kind, text)]
            self.section, line.why = "".join(kinds[:1]), A_HEADING
            self.pending = name if only else above
        elif name.keys and len(units) == sum(bool(clean(cell)) for _, cell in given):
            self.pending = replace(name, unit=next(filter(None, (name.unit, *units)), ""))
            line.why = A_HEADING
        else:
            if not name.keys:  # "Warp", below what it is of
                self.pending = above
                above = above or Name(("count", "linear_density"))
                name = replace(above, families=name.families, unit=name.unit or above.unit)
            self.take_values(line, name, given)

    def name_of(self, cells):
        """Return (Name of a row or None, [(role of the column, cell)] of what follows it)."""
        fits = len(cells) == len(self.columns) or (self.mark and len(cells) > 2)
        columns = self.columns if fits else []
        pairs = list(zip([*columns, *[""] * len(cells)], cells))
        places = [place for place, (role, _) in enumerate(pairs) if role == "name"]
        for place in places or range(min(2, len(cells))):
            if cells[place] and (name := sheet_names.find(cells[place])):
                return name, [pair for pair in pairs[place + 1 :] if pair[1]]
        words = clean(cells[0]).split(" ") if len(cells) == 1 else []
        for count in range(min(len(words) - 1, 9), 0, -1):
            begin, rest = " ".join(words[:count]), " ".join(words[count:])
            name = sheet_names.find(begin)
            if name is None or re.search(r"\d", PATTERNS["digits_of_units"].sub("", begin)):
                continue
            is_text = {WEAVE, "linear_density"} & {*name.keys} or (
                DESCRIPTION in name.keys and count < 2
            )
            if is_text or PATTERNS["begins_value"].match(rest):
                return name, [("", rest)]
        return None, []

    def take_unnamed(self, line, text, above):
        """Take a row without a name: values of the name above it, the heading of a section, a title."""
        line.why = "its name is not known"
        is_short = len(text.split()) < 8 and not re.search(r"\d", re.sub(r"\(.*?\)", "", text))
        if above is not None:
            self.take_values(line, above, [("", text)])
        elif sheet_names.has_word("other", text):
            if is_short and not sheet_names.has_word("fabric", text):
                self.section, line.why = "other", "a heading of something else"
        elif not self.found and not self.columns:
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
                self.put_weave(line, text)
            else:
                self.texts += [(text, line, 0)] * ("linear_density" in name.keys)
                try:
                    key, readings = self.understand(line, name, given)
                except UnknownWords:  # "Kevlar KM2 600 denier"
                    yarns = read_yarns(text) if "linear_density" in name.keys else set()
                    if len(yarns) != 1:
                        raise
                    key, readings = "linear_density", {"": yarns.pop()}
                self.put(line, name, key, readings)
        except Unclear as why:
            line.why = str(why)

    def of_one_fabric(self, given):
        """Return the cells of a row that are of the fabric that is meant."""
        fabrics = [cell for role, cell in given if role == "fabric"]
        others = [(role, cell) for role, cell in given if role not in ("fabric", "other", "name")]
        if fabrics and self.chosen is None and len({fold(cell) for cell in fabrics}) > 1:
            raise Unclear(SEVERAL)
        if fabrics:
            if len(fabrics) < self.columns.count("fabric"):
                raise Unclear("of some of several fabrics")
            others = [(role, cell) for role, cell in others if role == "unit"]
            others.append(("value", fabrics[self.chosen or 0]))
        if {"value", *FAMILIES} & {role for role, _ in others}:
            others = [(role, cell) for role, cell in others if role not in ("least", "most")]
        return others

    def understand(self, line, name, given):
        """Return (key, {family or "": Reading}) of cells in which nothing but numbers, units and
        families stands."""
        units, cells = [name.unit], []
        bounds = {name.bound, *(role for role, _ in given)}
        of_both = {*FAMILIES} <= bounds
        for role, cell in given:
            if role in ("", "unit") and (unit := sheet_names.unit(cell)):
                units.insert(0, unit)
            elif role == "unit" and cell.strip("- "):
                raise Unclear("a unit that is not known")
            elif role in FAMILIES and not re.search(r"\w", cell):
                raise Unclear("of warp or weft alone")
            elif text := clean(cell):
                bounds |= {kind for kind in ("least", "most") if PATTERNS[kind].search(text)}
                cells.append(f"{role} {text}" if of_both else text)
        roles = [role for role in self.columns if role in ("value", "least", "most", *FAMILIES)]
        text = PATTERNS["least"].sub(" ", " | ".join(cells))
        key, readings, words = read_cells(name, text, units[0], roles if len(cells) == 1 else ())
        if "most" in bounds or ("least" in bounds and key and key not in PROMISED):
            raise Unclear("a bound, and no value")
        if words and key not in ("", "count"):
            raise UnknownWords(f"{words} is no part of it")
        if words:  # "21 x 21 plain"
            self.put_weave(line, words)
        return key, readings

    def put_weave(self, line, text):
        """Keep the weave that a text is."""
        weave = sheet_names.find_weave(text)
        if not weave:
            raise Unclear("a weave that is not known")
        here = self.found.setdefault(WEAVE, dict.fromkeys(FAMILIES, (weave, 0.0, line)))
        if here["warp"][0] != weave:
            self.clashes[WEAVE] = f"several weaves: {here['warp'][0]} and {weave}"
        line.keys.append(WEAVE)

    def put(self, line, name, key, readings):
        """Keep the numbers of a row."""
        of = name.of or (self.section if self.section in ("yarn", "fabric") else "")
        section = (self.section,) if self.section in FAMILIES else FAMILIES
        if set(readings) == {""}:
            only = name.families if len(name.families) == 1 else section
            readings = dict.fromkeys(FAMILIES if key in OF_FABRIC else only, readings[""])
        if not key:
            self.bare += [(family, number, line) for family, (_, number) in readings.items()]
            raise Unclear("has no unit")
        unit = next(iter(readings.values()))[0].partition(" ")[2]
        if key == "strength" and of != "yarn" and not unit.endswith(("Pa", "psi")):
            raise Unclear("a force without the width of the strip")
        if key in OF_FIBRE and of == "fabric":
            raise Unclear("of the fabric, not of its fibre")
        if key in ("areal_density", "thickness") and self.treated and of != "fabric":
            raise Unclear("may be of the treated fabric")
        self.unsaid_strain |= key == "failure_strain" and of != "yarn"
        if key in OF_FABRIC and len({number for _, number in readings.values()}) > 1:
            raise Unclear("two numbers for one of the fabric")
        here = self.found.setdefault(key, {})
        for family, (text, number) in readings.items():
            first, other, above = here.setdefault(family, (text, number, line))
            if differ(number, other):
                why = f"lines {above.number} and {line.number} disagree: {first} and {text}"
                self.clashes[key] = why
                raise Unclear(why)
        line.keys += [key] * (key not in line.keys)

    # what the whole sheet settles

    def settle_texts(self):
        """Take the linear density and the weave that texts say, where no row has one."""
        for rank in range(3):
            lacks = {"linear_density", WEAVE} - {*self.found}
            for text, line in [(text, line) for text, line, of in self.texts if of == rank]:
                yarns = read_yarns(text) if rank else set()
                with suppress(Unclear):
                    if "linear_density" in lacks and len(yarns) == 1:
                        self.put(line, Name(()), "linear_density", {"": yarns.pop()})
                if WEAVE in lacks and sheet_names.find_weave(text):
                    self.put_weave(line, text)

    def settle_counts(self):
        """Take a count without a unit as that per inch, cm or 10 cm which gives the areal density."""
        density, areal = (self.found.get(key, {}) for key in ("linear_density", "areal_density"))
        pair = {family: number for family, number, _ in self.bare}
        once = len(pair) == len(self.bare) == len(density) == 2
        if not once or "count" in self.found or not areal:
            return
        fits = {}
        for unit in ("/ inch", "/ cm", "/ 10 cm"):
            counts = {each: read_number("count", f"{pair[each]:g}", unit) for each in FAMILIES}
            if None not in counts.values():
                mass = sum(counts[each][1] * density[each][1] for each in FAMILIES)
                if STRAIGHT[0] < mass / areal["warp"][1] < STRAIGHT[1]:
                    fits[unit] = counts
        if len(fits) == 1:
            unit, counts = fits.popitem()
            self.found["count"] = {each: (*counts[each], line) for each, _, line in self.bare}
            for line in {line for _, _, line in self.bare}:
                line.keys.append("count")
                line.text += f" (its unit, {unit}, follows from the areal density)"

    def values(self):
        """Return {key: Value} of what is found of both yarns, or of the fabric."""
        values = {}
        if self.unsaid_strain and (BREAKING in self.found or not {*self.found} & {*OF_FIBRE[:3]}):
            self.clashes["failure_strain"] = "may be of a strip of fabric, not of the yarn"
        for key in (*ALL, WEAVE):
            here = self.found.get(key, {})
            used = {line.number: line for _, _, line in here.values()}
            alone = f"of the {next(iter(here))} alone" if len(here) == 1 else ""
            if why := self.clashes.get(key, alone):
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
        """Return the fibre family that the texts of the sheet name, if one alone; else None."""
        words = [
            (fold(word), each.name)
            for each in list_families()
            for word in (each.name, *each.known_as)
        ]
        said: dict[str, Line] = {}
        for text, line, _ in self.texts:
            rest = fold(text)
            if PATTERNS["no_family"].search(rest):
                return None
            # the longest first: polyethylene terephthalate is no polyethylene
            for word, name in sorted(words, key=lambda each: -len(each[0])):
                whole = rf"(?<![\w-]){re.escape(word)}(?:[ae]|faser|gewebe)?(?![a-z])"
                rest, times = re.subn(whole, " ", rest)
                if times:
                    said.setdefault(name, line)
        for line in said.values() if len(said) == 1 else ():
            line.keys.append("family")
        return next(iter(said)) if len(said) == 1 else None
