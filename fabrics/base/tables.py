"""Tables of users: CSV files of laboratories, testing machines, radars and data sheets.

One reader for all of them. A table has a heading that names its columns, each with its unit, such as

    time [us], displacement [mm]

and below it a row each. Names are read in any case, with what machines call the same thing
(`SYNONYMS`); a unit stands in square or round brackets, after a solidus or behind the name, or in a
row of units below the heading. What stands above the heading is left out, as are columns that
nobody asks for, and the log says so. A heading may begin with #; other lines that do are comments.

Cells are separated by semicolons, commas or tabs, whichever makes a heading of a line. Numbers have
a decimal point; where no comma separates cells, also a decimal comma, all of them.
"""

from __future__ import annotations

import csv
import logging
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from itertools import product
from math import isfinite, nan

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from fabrics.base.files import control_character, read_text
from fabrics.base.units import NUMBER, decimal_comma, refused, si

LOG = logging.getLogger("weavecell")
# a column of counts, which have no unit
COUNTS = "counts"
# kinds of columns that hold no numbers alone: any text, and texts of a number with its unit
WORDS = "words"
QUANTITIES = "quantities"
SEPARATORS = ";,\t"
# what machines, radars and laboratories call a column; the first that a table has is taken
SYNONYMS = {
    "time": ("elapsed time", "test time", "t"),
    "displacement": (
        "extension",
        "standard travel",
        "travel",
        "crosshead displacement",
        "crosshead",
        "stroke",
        "distance",
        "position",
        "range",
    ),
    "force": ("load", "standard force"),
    "strain": ("elongation", "tensile strain"),
    "velocity": (
        "strike velocity",
        "striking velocity",
        "impact velocity",
        "speed",
        "striking speed",
        "muzzle velocity",
        "vs",
        "v s",
    ),
    "residual velocity": ("residual speed", "exit velocity", "residual", "vr", "v r"),
    "outcome": (
        "result",
        "penetration",
        "perforated",
        "perforation",
        "complete penetration",
        "stopped",
        "partial penetration",
    ),
    "shear angle": ("angle",),
    "pressure": ("compressive stress",),
    # of pull-outs
    "test": (
        "specimen",
        "sample",
        "test no",
        "specimen no",
        "sample no",
        "repeat",
        "strain ratio",
        "load ratio",
        "ratio",
    ),
    "pulled": ("pulled yarn", "yarn pulled", "direction", "yarn"),
    "crossings": (
        "crossovers",
        "number of crossings",
        "number of crossovers",
        "crossing yarns",
        "crossed yarns",
        "yarns crossed",
    ),
    "length": ("embedded length", "pull out length", "specimen length", "sample length"),
    "tension": ("pre tension", "pretension", "transverse tension", "tension of crossing yarns"),
    "transverse load": ("transverse force", "lateral load", "lateral force"),
    "peak": (
        "peak load",
        "peak force",
        "maximum load",
        "maximum force",
        "max load",
        "max force",
        "max. load",
        "max. force",
        "pull out load",
        "pull out force",
        "pullout load",
        "pullout force",
    ),
    # of data sheets
    "warp": ("ends",),
    "weft": ("fill", "filling", "picks"),
}
# of biaxial machines: "fill tension", "load per width in warp", "elongation weft"
_DIRECTIONS = {"warp": ("warp",), "weft": ("weft", "fill")}
_MEASURED = {
    "strain": ("strain", "elongation"),
    "load": (
        *(f"{word}{of}" for word in ("load", "tension", "force") for of in ("", " per width")),
        "line load",
        "membrane force",
    ),
}
for (_name, _own), (_kind, _words) in product(_DIRECTIONS.items(), _MEASURED.items()):
    _forms = ("{0} {1}", "{1} {0}", "{1} in {0}")
    _said = [form.format(*pair) for pair in product(_own, _words) for form in _forms]
    SYNONYMS[f"{_name} {_kind}"] = tuple(_said[1:])
# what instruments write for a unit, in small letters
_UNITS = {
    "sec": "s",
    "secs": "s",
    "seconds": "s",
    "msec": "ms",
    "usec": "us",
    "µs": "us",
    "μs": "us",
    "µm": "um",
    "μm": "um",
    "fps": "ft/s",
    "feet/s": "ft/s",
    "ft/sec": "ft/s",
    "m/sec": "m/s",
    "degrees": "deg",
    "°": "deg",
    "newton": "N",
    "newtons": "N",
    "kn": "kN",
    "pct": "%",
    "percent": "%",
    # of a number without dimension, beside its own name
    "-": "",
    "1": "",
    "mm/mm": "",
    "in/in": "",
}
# a number with decimal marks, and a unit of up to two words
_QUANTITY = re.compile(r"([-+]?[0-9.,]*[0-9])((?:[eE][-+]?[0-9]+)?\D*(?:\s\S+){0,2})")
_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2},[0-9]{3}")
_POINTED = re.compile(r"[-+]?[1-9][0-9]{0,2}\.[0-9]{3}")
_IN_BRACKETS = re.compile(r"[\[(](.*)[\])]")
# between the words of a name, and between a name and its unit
_BETWEEN_WORDS = r"[\s_/-]+"
_BEFORE_UNIT = re.compile(r"^(in |/|,|:|-)\s*")

Row = tuple[int, list[str]]  # number of the line, its cells


@dataclass(frozen=True)
class Table:
    """The columns that were asked for.

    Parameters
    ----------
    lines : (n,) number of the line of each row in the file
    cells : {name: (n,)} texts; "" where a row ends before the column
    scales : {name: value of its unit in SI} of columns of numbers
    headings : {name: heading of its column as it is written}
    """

    path: FilePath
    lines: tuple[int, ...]
    cells: Mapping[str, Sequence[str]]
    scales: Mapping[str, float]
    headings: Mapping[str, str]

    def rows(self) -> Iterator[tuple[str, dict[str, str]]]:
        """Yield ("line 7", {name: cell}) of each row."""
        for number, *cells in zip(self.lines, *self.cells.values()):
            yield f"line {number}", dict(zip(self.cells, cells))

    def number(self, line: str, name: str, cell: str) -> float:
        """Return the number of a cell in SI; InputError names the line and the column."""
        return self.scales[name] * read_number(
            cell, "a finite number", file=self.path, key=f"{line}, {name}"
        )

    def place(self, index: int) -> str:
        """Name the line of a row, for messages."""
        return f"line {self.lines[index]}"


class Columns(dict[str, FloatArray]):
    """Columns of numbers {name: (n,) [SI]}; `table` knows their lines."""

    def __init__(self, table: Table) -> None:
        self.table = table
        read = [
            [table.number(line, name, row[name]) for name in table.cells]
            for line, row in table.rows()
        ]
        super().__init__(zip(table.cells, np.array(read).reshape(-1, len(table.cells)).T))


def read_columns(
    path: FilePath,
    units: Mapping[str, str],
    *,
    what: str,
    example: str,
    either: Sequence[str] = (),
) -> Columns:
    """Read columns of numbers.

    Parameters
    ----------
    units : {name: SI unit} of the columns
    what : what the file holds, for messages
    example : of a heading, for messages
    either : names of which the file has one, not all

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    return Columns(read_table(path, units, what=what, example=example, either=either))


def read_table(
    path: FilePath,
    kinds: Mapping[str, str],
    *,
    what: str,
    example: str,
    either: Sequence[str] = (),
    optional: Sequence[str] = (),
) -> Table:
    """Read the columns of a table that are asked for, see the top of this file.

    Parameters
    ----------
    kinds : {name: SI unit, COUNTS, WORDS or QUANTITIES} of the columns
    either : names of which the file has one, not all
    optional : names that it may lack
    others : see `read_columns`

    Raises
    ------
    InputError : see `read_text`; no heading with these columns, a column that is there twice or
        without a unit, a row that is too long or too short, a quotation mark that is not closed, or
        a comma that may be a decimal comma and may not
    """
    lines = _lines_of(path, what)
    wanted = _Wanted(path, kinds, tuple(either), tuple(optional), what, example)
    if not lines:
        raise InputError("is empty", file=path, allowed=f"{what}: {wanted.words}")
    separator, (first, heading), rows = _find_heading(lines, wanted)
    columns = wanted.choose(heading)
    below = [(number, cells) for number, cells in rows if number > first]
    units_below = wanted.units_below(below, columns)
    scales = wanted.scales(columns, units_below)
    if units_below:
        below = below[1:]
    above = sum(number < first for number, _ in rows)
    places = {name: column.place for name, column in columns.items()}
    _tell_left_out(path, first, above, heading, places)
    _check_lengths(below, heading, [places[name] for name in places if name not in optional], path)
    if separator != ",":
        numbers = [place for name, place in places.items() if kinds[name] != WORDS]
        _point_decimals(below, numbers, path, mixed=QUANTITIES in kinds.values())
    cells = {name: [row[place] for _, row in below] for name, place in places.items()}
    named = {name: column.cell for name, column in columns.items()}
    return Table(path, tuple(number for number, _ in below), cells, scales, named)


def _tell_left_out(path, first, above, heading, places):
    """Log what of a table is not read: lines above the heading and columns that nobody asks for."""
    if above:
        LOG.info(f"{path}: left out, {above} lines above the heading in line {first}")
    others = [cell for place, cell in enumerate(heading) if cell and place not in places.values()]
    if others:
        LOG.info(f"{path}: left out, columns that are not known: {', '.join(others)}")


def read_number(text: str, allowed: str, *, file: FilePath, key: str) -> float:
    """Read the finite number of a cell; else raise InputError."""
    number = nan
    if NUMBER.fullmatch(text):
        number = float(text)
    if not isfinite(number):
        raise refused(text, allowed, file=file, key=key)
    return number


def find_name(
    text: str, names: Iterable[str], takes: Callable[[str, str], bool]
) -> tuple[str, str] | None:
    """Find the name with which a text begins, and the unit behind it: of a heading, or of the cell that
    names a row.

    Case is free, as is what stands between the words of a name; the unit is in brackets, behind a
    solidus, a comma, a colon, a dash or "in", or by itself.

    Parameters
    ----------
    text : as it is written
    names : in small letters, with blanks between their words; of several the longest is found
    takes : whether (name, unit) go together; brackets hold what is meant as a unit, and are not asked

    Returns
    -------
    (name, unit as it is written, "" without one), or None where the text begins with none of the names or
    goes on with other words
    """
    for name in sorted(names, key=len, reverse=True):
        begins = _name_pattern(name).match(text.replace("’", "'"))
        if begins is None:
            continue
        unit = _unit_behind(text[begins.end() :].replace("_", " ").strip(), partial(takes, name))
        if unit is not None:
            return name, unit
    return None


@cache
def _name_pattern(name):
    """Pattern of a name at the beginning of a text, which may be a comment."""
    words = _BETWEEN_WORDS.join(re.escape(word) for word in name.replace("_", " ").split())
    # "Test No." is abbreviated
    return re.compile(rf"[#\s]*{words}\.?(?![^\W_])", re.IGNORECASE)


def _unit_behind(rest, takes):
    """The unit that follows a name, "" if none does; None if other words do."""
    bracket = _IN_BRACKETS.fullmatch(rest.strip(": "))
    if bracket:
        return bracket[1].strip() or "-"
    # a solidus that is no mark before the unit is a part of it, as in "/ 10 cm"
    for unit in (_BEFORE_UNIT.sub("", rest), rest):
        if not unit or takes(unit):
            return unit
    return None


def plain_unit(written: str) -> str:
    """Return a unit as `fabrics.base.units` reads it, of one as instruments write it."""
    return _UNITS.get(written.lower(), written)


@dataclass(frozen=True)
class _Column:
    """A cell of a heading that names a column which is asked for.

    Parameters
    ----------
    name : of the column
    rank : 0 of the name itself, then the order of its synonyms
    unit : as it is written, "" without
    place : number of the column in the file
    cell : as it is written
    """

    name: str
    rank: int
    unit: str
    place: int
    cell: str


@dataclass(frozen=True)
class _Wanted:
    """The columns that are asked for, and how they are recognised."""

    path: FilePath
    kinds: Mapping[str, str]
    either: tuple[str, ...]
    optional: tuple[str, ...]
    what: str
    example: str

    @property
    def needed(self) -> list[str]:
        """Names that every table has."""
        return [name for name in self.kinds if name not in (*self.either, *self.optional)]

    @property
    def words(self) -> str:
        """The columns, for messages."""
        parts = (" and ".join(self.needed), " or ".join(self.either))
        return ", and ".join(filter(None, parts))

    @property
    def advice(self) -> str:
        """What a heading may be, for messages."""
        heading = " or ".join(self.kinds)
        if any(kind not in (WORDS, QUANTITIES) for kind in self.kinds.values()):
            heading += f" with its unit, such as {self.example}"
        return heading

    def columns_of(self, cells: Sequence[str]) -> list[_Column]:
        """Return the cells of a row that name columns which are asked for."""
        found = [self._column_of(cell, place) for place, cell in enumerate(cells)]
        return [column for column in found if column is not None]

    def _column_of(self, cell, place):
        """The _Column that a cell names; None without."""
        titles: dict[str, tuple[str, int]] = {}
        for name in self.kinds:
            for rank, title in enumerate((name, *SYNONYMS.get(name, ()))):
                titles.setdefault(title, (name, rank))
        found = find_name(cell, titles, lambda title, unit: self._has_unit(titles[title][0], unit))
        if found is None:
            return None
        title, unit = found
        return _Column(*titles[title], unit, place, cell)

    def _has_unit(self, name, unit):
        """Whether a unit is one that a column may have."""
        try:
            _scale(unit, self.kinds[name])
        except InputError:
            return False
        return True

    def has_all(self, columns: Sequence[_Column]) -> bool:
        """Tell whether all columns that are needed are there."""
        names = {column.name for column in columns}
        if self.either and not names & {*self.either}:
            return False
        return {*self.needed} <= names

    def choose(self, heading: Sequence[str]) -> dict[str, _Column]:
        """Return {name: _Column}, each once; refuse a heading that lacks one or has it twice.

        Of synonyms the first is taken, and the others are told as left out.
        """
        known = self.columns_of(heading)
        # a heading of which nothing is known is told by its first cell
        if not known:
            raise InputError(file=self.path, key="heading", value=heading[0], allowed=self.advice)
        chosen: dict[str, _Column] = {}
        for column in sorted(known, key=lambda one: one.rank):
            first = chosen.setdefault(column.name, column)
            if first is not column and first.rank == column.rank:
                allowed = f"a column {column.name} that is there once"
                raise self._refusal(column, allowed)
        both = [name for name in self.either if name in chosen]
        if len(both) > 1 or not self.has_all(known):
            raise InputError(
                file=self.path, key="columns", value=", ".join(heading), allowed=self.words
            )
        for column in chosen.values():
            if column.rank:
                LOG.info(f"{self.path}: {column.cell} is taken for {column.name}")
        return {name: chosen[name] for name in self.kinds if name in chosen}

    def units_below(self, below: Sequence[Row], columns: Mapping[str, _Column]) -> dict[str, str]:
        """Return {name: unit} of a row of units below the heading; empty if there is none."""
        units: dict[str, str] = {}
        if not below:
            return units
        _, row = below[0]
        for column in self._numbers(columns):
            cell = ""
            if column.place < len(row):
                cell = row[column.place]
            bracket = _IN_BRACKETS.fullmatch(cell)
            if bracket:
                cell = bracket[1].strip()
            if not cell and self.kinds[column.name] == COUNTS:
                continue
            if not cell or NUMBER.fullmatch(cell):
                return {}
            try:
                _scale(cell, self.kinds[column.name])
            except InputError:
                return {}
            units[column.name] = cell
        return units

    def scales(
        self, columns: Mapping[str, _Column], units_below: Mapping[str, str]
    ) -> dict[str, float]:
        """Return {name: SI value of its unit} of columns of numbers, from the heading or below it."""
        for name, column in columns.items():
            if self.kinds[name] == WORDS and column.unit:
                raise self._refusal(column, f"{name} alone")
        found = {}
        for column in self._numbers(columns):
            name = column.name
            units = [unit for unit in (column.unit, units_below.get(name, "")) if unit]
            if not units and self.kinds[name] == COUNTS:
                units = ["-"]
            if not units:
                raise self._refusal(column, self.advice, "has no unit")
            of_each = {_scale(unit, self.kinds[name], self.path, name) for unit in units}
            if len(of_each) > 1:
                raise self._refusal(column, f"one unit: the row below says {units_below[name]}")
            found[name] = of_each.pop()
        return found

    def _refusal(self, column, allowed, message=None):
        return InputError(
            message, file=self.path, key="heading", value=column.cell, allowed=allowed
        )

    def _numbers(self, columns):
        """The columns of numbers."""
        words = (WORDS, QUANTITIES)
        return [column for column in columns.values() if self.kinds[column.name] not in words]


def _scale(written, unit, path=None, name=None):
    """SI value of one of a unit, as instruments write it; InputError if it is none of `unit`."""
    folded = plain_unit(written.lower())
    if unit == COUNTS:
        unit = ""
    # a dash, or one length over another
    if not folded and not unit:
        return 1.0
    for text in (written, folded):
        with suppress(InputError):
            return si(f"1 {text}", unit)
    return si(f"1 {written}", unit, file=path, key=name)


def _lines_of(path, what):
    """[(number, text)] of the lines of a file that are not empty."""
    try:
        lines = list(enumerate(read_text(path).split("\n"), 1))
    except OSError as problem:
        allowed = f"{what} ({problem.strerror})"
        raise InputError("cannot be read", file=path, allowed=allowed) from problem
    # texts that were copied from a page may break lines by these
    lines = [(n, line.translate({11: " ", 12: " "})) for n, line in lines]
    for number, line in lines:
        if (control := control_character(line)) is not None:
            raise InputError(
                f"has the control character {control}", file=path, key=f"line {number}"
            )
    return [(n, line) for n, line in lines if line.strip("; ,\t")]


def _find_heading(lines, wanted):
    """(separator, heading, rows without comments) with the first line that has all columns; without
    one, the first line that is no comment."""
    separators = SEPARATORS
    # Excel writes this line to name the separator
    if lines[0][1].startswith("sep="):
        separators = lines.pop(0)[1][4:5]
    plain = [(number, text) for number, text in lines if not text.lstrip().startswith("#")]
    # a heading may be a comment, if no other line is one
    for candidates in (plain, lines):
        for separator in separators:
            for number, text in candidates:
                if separator not in text and len(wanted.needed) > 1:
                    continue
                cells = split_cells((number, text), separator, wanted.path)
                if wanted.has_all(wanted.columns_of(cells)):
                    rows = [_cells_of(line, separator, wanted.path) for line in plain]
                    return separator, (number, _without_empty_end(cells)), rows
    number, text = (plain or lines)[0]
    # semicolons before commas: where commas are decimal, a heading may have them in its words
    separator = next((mark for mark in separators if mark in text), ",")
    cells = split_cells((number, text), separator, wanted.path)
    rows = [_cells_of(line, separator, wanted.path) for line in plain]
    return separator, (number, _without_empty_end(cells)), rows


def _cells_of(line, separator, path):
    """(number, cells) of a line."""
    number, _ = line
    return number, split_cells(line, separator, path)


def split_cells(entry: tuple[int, str], separator: str, path: FilePath) -> list[str]:
    """Return the cells of a line (its number, its text), without the blanks around them.

    Raises
    ------
    InputError : a quotation mark that is not closed
    """
    number, line = entry
    try:
        (cells,) = csv.reader([line + "\n"], delimiter=separator, skipinitialspace=True)
    except csv.Error as problem:
        raise InputError(f"cannot be read ({problem})", file=path, key=f"line {number}") from None
    if any("\n" in cell for cell in cells):
        raise InputError("has a quotation mark that is not closed", file=path, key=f"line {number}")
    return [cell.strip() for cell in cells]


def _without_empty_end(cells):
    while cells and not cells[-1]:
        cells = cells[:-1]
    return cells


def _check_lengths(rows, heading, needed, path):
    """Make rows as long as the heading by empty cells, in place; refuse a row that goes on, or ends
    before the columns that are needed."""
    fewest = max(needed) + 1
    for number, cells in rows:
        while len(cells) > len(heading) and not cells[-1]:
            cells.pop()
        if fewest <= len(cells) <= len(heading):
            cells.extend([""] * (len(heading) - len(cells)))
            continue
        allowed = f"{len(heading)} cells"
        if len(heading) == 2:
            allowed = "two numbers"
        message = decimal_comma(cells)
        # a comma that separates may have been meant for a decimal one
        if len(cells) > len(heading) > 2:
            message = decimal_comma(",".join(cells))
        if len(cells) == 2 * len(heading):
            message = "if these are decimal commas, separate the columns by semicolons"
        raise InputError(
            message, file=path, key=f"line {number}", value=", ".join(cells), allowed=allowed
        )


def _point_decimals(rows, places, path, mixed):
    """Write the numbers of columns that no comma separates with a decimal point, in place.

    mixed : whether the values are of several sources, each with a decimal mark of its own
    """
    numbers = []
    for line, cells in rows:
        for place in places:
            quantity = _QUANTITY.fullmatch(cells[place])
            if quantity:
                numbers.append((line, cells, place, quantity))
    with_comma = [entry for entry in numbers if "," in entry[3][1]]
    with_point = [quantity[1] for *_, quantity in numbers if "." in quantity[1]]
    if mixed:
        # "1.44" is clear in itself, "1.440" is not
        with_point = [text for text in with_point if "," in text or _POINTED.fullmatch(text)]
    # "12,345" can be read in two ways, "12,34" in one
    sure = any(not _THOUSANDS.fullmatch(quantity[1]) for *_, quantity in with_comma)
    for line, cells, place, quantity in with_comma:
        if with_point or not sure or quantity[1].count(",") > 1:
            allowed = (
                "written without commas: here they may be decimal commas, or separate thousands"
            )
            raise InputError(file=path, key=f"line {line}", value=quantity[0], allowed=allowed)
        cells[place] = quantity[1].replace(",", ".") + quantity[2]
