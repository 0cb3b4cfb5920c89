"""Files: written whole or not at all, beside the target first and then renamed over it; HDF5 files
with a format.

Every HDF5 file of the project has the attribute "format" with its kind and version, which is
compared when it is read.

Texts of a user are UTF-8, with or without a byte order mark, or UTF-16 with one; lines end as on
any system. Cells of a CSV file are separated by what its first line has of semicolons, commas and
tabs, in this order. Numbers have a decimal point; where no comma separates cells, also a decimal
comma, all of them. Lines that begin with # are comments. The first line of columns of numbers names
them with their units, such as

    time [us], displacement [mm]

and every other line is a row of finite numbers.
"""

from __future__ import annotations

import codecs
import csv
import json
import os
import re
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import BytesIO
from math import isfinite, nan
from pathlib import Path
from typing import IO, Any

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, WeavecellError
from fabrics.base.units import NUMBER, decimal_comma, refused, si

# [bytes] this much must still fit on the disk behind a file that a library has written
ROOM = 65536
# a number with decimal marks, and a unit of up to two words
_QUANTITY = re.compile(r"([-+]?[0-9.,]*[0-9])((?:[eE][-+]?[0-9]+)?\D*(?:\s\S+){0,2})")
_THOUSANDS = re.compile(r"[-+]?[1-9][0-9]{0,2},[0-9]{3}")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
# beginning of the names of files that are not finished; such a name ends as `mkstemp` has it
UNFINISHED = ".weavecell-"
_UNFINISHED = re.compile(r"\.weavecell-.+-[a-z0-9_]{8}(\.[^.]*)?")
# called as watcher(path, finished file beside it) before each file is renamed to its path
watchers: list[Callable[[Path, Path], None]] = []
_read: ContextVar[set[Path] | None] = ContextVar("files that were read", default=None)


@contextmanager
def noting_reads() -> Iterator[set[Path]]:
    """Yield the set of files that are read in this block, or in the block of this kind around
    it."""
    noted = _read.get()
    if noted is not None:
        yield noted
        return
    noted = set()
    token = _read.set(noted)
    try:
        yield noted
    finally:
        _read.reset(token)


def note_read(path: FilePath) -> None:
    """Add a file that another library is about to read to the set of `noting_reads`."""
    noted = _read.get()
    if noted is not None:
        noted.add(Path(path).resolve())


def noted_reads() -> frozenset[Path]:
    """Return the files that were read in the block of `noting_reads`; none outside of one."""
    return frozenset(_read.get() or ())


def refuse_existing(path: FilePath) -> None:
    """Refuse to write over a file that is there: a file alone, which no folder of results holds, is
    the user's, whoever made it.

    Raises
    ------
    InputError
    """
    # a link that leads nowhere is there too
    if os.path.lexists(path):
        raise InputError("exists already", file=path)


@contextmanager
def replace_whole(path: FilePath) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` if the block succeeds, remove it if
    not.

    For libraries that open a file by its name. The temporary name keeps the suffix, by which many
    of them choose the format.

    Raises
    ------
    OSError : it cannot be written, with `path` as its filename. Libraries that do not notice a full
        disk are found out, since the disk must have `ROOM` behind the file
    """
    path = Path(path)
    beside = path
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(
            dir=path.parent, prefix=f"{UNFINISHED}{path.stem}-", suffix=path.suffix
        )
        os.close(handle)
        beside = Path(name)
        yield beside
        with open(beside, "rb+") as file:
            size = file.seek(0, os.SEEK_END)
            # a disk that is full to the last bytes shows it here, while the old file is still in
            # place
            file.write(bytes(ROOM))
            file.truncate(size)
            os.fsync(file.fileno())
        # mkstemp makes files that only their owner reads
        beside.chmod(0o666 & ~_umask())
        for watcher in watchers:
            watcher(path, beside)
        os.replace(beside, path)
    except OSError as problem:
        # an error without a number has a text of its own, which a file name would hide
        if problem.errno is not None and problem.filename in (None, str(beside)):
            problem.filename = str(path)
        raise
    finally:
        if beside != path:
            beside.unlink(missing_ok=True)


def remove_unfinished(folder: Path) -> None:
    """Remove the temporary files that a process left in a folder when it was killed; no other
    process may write there."""
    for path in folder.glob(f"{UNFINISHED}*"):
        if _UNFINISHED.fullmatch(path.name) and path.is_file():
            with suppress(OSError):
                path.unlink()


@contextmanager
def write_whole(path: FilePath, mode: str = "w") -> Iterator[IO]:
    """Open a file for writing that appears under `path` complete, or not at all."""
    encoding = None
    if "b" not in mode:
        encoding = "utf-8"
    # names of files may have bytes that are no text
    errors = None
    if encoding is not None:
        errors = "replace"
    with (
        replace_whole(path) as beside,
        open(beside, mode, encoding=encoding, errors=errors) as file,
    ):
        yield file


def write(path: FilePath, content: str | bytes) -> None:
    """Write a text or bytes that appear under `path` complete, or not at all."""
    with write_whole(path, "w" if isinstance(content, str) else "wb") as file:
        file.write(content)


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def write_hdf5(path: FilePath, format: str, **attributes: Any) -> Iterator[Any]:
    """Open an HDF5 file for writing that appears under `path` complete, or not at all; needs h5py.

    Parameters
    ----------
    format : kind and version of the file, such as "weavecell impact 3"
    attributes : further attributes of its root
    """
    import h5py

    # in memory first: HDF5 ends the process if it cannot write to a disk
    content = BytesIO()
    with h5py.File(content, "w") as file:
        file.attrs.update(format=format, **attributes)
        yield file
    with write_whole(path, "wb") as on_disk:
        on_disk.write(content.getbuffer())


@contextmanager
def read_hdf5(path: FilePath, *formats: str, what: str = "HDF5 file") -> Iterator[Any]:
    """Open an HDF5 file for reading; needs h5py.

    Parameters
    ----------
    formats : kind and version of the file, as in `write_hdf5`; one of these
    what : the file in words, for the message

    Raises
    ------
    InputError : no such file, not HDF5, another format, or without an entry that the block reads
    """
    import h5py

    note_read(path)
    try:
        # a file is whole when it appears, and some network drives have no locks
        with h5py.File(path, "r", locking=False) as file:
            stated = file.attrs.get("format", "")
            if stated not in formats:
                raise InputError(
                    file=path, key="format", value=stated, allowed=" or ".join(map(repr, formats))
                )
            yield file
    except WeavecellError:
        raise
    # h5py and the readers of what it holds raise many types for bytes that are damaged
    except (
        ArithmeticError,
        AttributeError,
        EOFError,
        LookupError,
        MemoryError,
        OSError,
    ) as problem:
        raise InputError(f"is not a readable {what} ({problem})", file=path) from problem
    except (RecursionError, RuntimeError, TypeError, ValueError) as problem:
        raise InputError(f"is not a readable {what} ({problem})", file=path) from problem


def format_of_hdf5(path: FilePath) -> str:
    """Return the format that an HDF5 file states; "" without one. Needs h5py.

    Raises
    ------
    InputError : no such file, or not HDF5
    """
    import h5py

    note_read(path)
    try:
        with h5py.File(path, "r", locking=False) as file:
            return str(file.attrs.get("format", ""))
    except (OSError, RuntimeError, LookupError, ValueError) as problem:
        raise InputError(f"is not a readable HDF5 file ({problem})", file=path) from problem


def read_json(path: FilePath, format: str, *, what: str) -> dict[str, Any]:
    """Read a JSON file of this project.

    Parameters
    ----------
    format : kind and version of the file, its entry "format"
    what : the file in words, for the message

    Raises
    ------
    InputError : no such file, not JSON, or another format
    """
    try:
        content = json.loads(read_bytes(path).decode("utf-8-sig"))
    except OSError as problem:
        raise InputError(
            "cannot be read", file=path, allowed=f"{what} ({problem.strerror})"
        ) from problem
    except (ValueError, RecursionError) as problem:
        raise InputError("is not JSON", file=path, allowed=f"{what} ({problem})") from problem
    stated = None
    if isinstance(content, dict):
        stated = content.get("format")
    if stated != format:
        raise InputError(file=path, key="format", value=stated, allowed=repr(format))
    return content


def parse_toml(text: str) -> dict[str, Any]:
    """Return the table of a text in TOML.

    Raises
    ------
    ValueError : it is not TOML, nested too deeply, or has a number of thousands of digits
    """
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("lists or tables are nested too deeply") from None


def read_data(path: FilePath) -> dict[str, Any]:
    """Read a TOML file of a package, which needs no message for a user."""
    return tomllib.loads(Path(path).read_text(encoding="utf-8"))


def read_bytes(path: FilePath) -> bytes:
    """Return the bytes of a user's file."""
    note_read(path)
    return Path(path).read_bytes()


def read_text(path: FilePath) -> str:
    """Read a user's file: its text without byte order mark, with "\n" at the end of each line.

    Raises
    ------
    InputError : neither UTF-8 nor UTF-16
    OSError : no such file
    """
    content = read_bytes(path)
    # Notepad calls UTF-16 with its mark "Unicode"
    utf_16 = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    good = content
    try:
        text = content.decode("utf-16" if utf_16 else "utf-8-sig")
        good = content.partition(b"\0")[0]
    except UnicodeDecodeError as problem:
        good = content[: problem.start]
        text = "\0"
    # a NUL is what UTF-16 without a mark looks like as UTF-8
    if "\0" in text:
        number = len(good.splitlines()) + good.endswith((b"\n", b"\r"))
        advice = "save it with the encoding UTF-8 (Notepad and other editors)"
        if Path(path).suffix.lower() not in (".toml", ".json"):
            advice = (
                'save it as "CSV UTF-8" (Excel), or with the encoding UTF-8 (Notepad and other '
                "editors)"
            )
        message = f"line {max(number, 1)} is not UTF-8 text; {advice}"
        raise InputError(message, file=path)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def control_character(text: str) -> str | None:
    """Return the first character of a text that is none to be read and no end of a line, such as
    "U+001B"; None if there is none."""
    found = _CONTROL.search(text)
    if found is None:
        return None
    return f"U+{ord(found[0]):04X}"


def read_csv(path: FilePath, what: str, words: Sequence[str] = ()) -> list[tuple[int, list[str]]]:
    """Read a CSV file: (line number, cells without the blanks around them) of each line but empty
    ones and comments.

    Empty cells at the end of the first line, and below these, are left out. Decimal commas become
    points.

    Parameters
    ----------
    what : the file's content, given as what is allowed if it cannot be read
    words : names of columns that hold no numbers, and stay as they are

    Raises
    ------
    InputError : see `read_text`, a quotation mark that is not closed, a cell above the limit of
        Python's csv (131,072 letters), or a comma that may be a decimal comma and may not
    """
    try:
        lines = list(enumerate(read_text(path).split("\n"), 1))
    except OSError as problem:
        allowed = f"{what} ({problem.strerror})"
        raise InputError("cannot be read", file=path, allowed=allowed) from problem
    separator = None
    # Excel writes this line to name the separator
    if lines[0][1].startswith("sep="):
        separator = lines.pop(0)[1][4:5]
    # texts that were copied from a page may break lines by these
    lines = [(n, line.translate({11: " ", 12: " "})) for n, line in lines]
    for number, line in lines:
        if (control := control_character(line)) is not None:
            raise InputError(
                f"has the control character {control}", file=path, key=f"line {number}"
            )
    lines = [
        (n, line) for n, line in lines if line.strip("; ,\t") and not line.lstrip().startswith("#")
    ]
    if not lines:
        return []
    # semicolons before commas: where commas are decimal, a heading may have them in its words
    separator = separator or next((mark for mark in ";,\t" if mark in lines[0][1]), ",")
    rows = []
    for number, line in lines:
        try:
            (cells,) = csv.reader([line + "\n"], delimiter=separator, skipinitialspace=True)
        except csv.Error as problem:
            raise InputError(
                f"cannot be read ({problem})", file=path, key=f"line {number}"
            ) from None
        if any("\n" in cell for cell in cells):
            raise InputError(
                "has a quotation mark that is not closed", file=path, key=f"line {number}"
            )
        rows.append((number, [cell.strip() for cell in cells]))
    columns = max((n for n, cell in enumerate(rows[0][1], 1) if cell), default=0)
    for _, cells in rows:
        while len(cells) > columns and not cells[-1]:
            cells.pop()
    # a file whose columns commas separate has no decimal commas
    if separator != ",":
        _point_decimals(rows, words, path)
    return rows


def _point_decimals(rows, words, path):
    """Write the numbers of rows that no comma separates with a decimal point, in place."""
    numbers = []
    for line, cells in rows[1:]:
        for column, (heading, cell) in enumerate(zip(rows[0][1], cells)):
            quantity = None
            if heading not in words:
                quantity = _QUANTITY.fullmatch(cell)
            if quantity:
                numbers.append((line, cells, column, quantity))
    with_comma = [entry for entry in numbers if "," in entry[3][1]]
    # "12,345" can be read in two ways, "12,34" in one
    sure = any(not _THOUSANDS.fullmatch(quantity[1]) for *_, quantity in with_comma)
    with_point = any("." in quantity[1] for *_, quantity in numbers)
    for line, cells, column, quantity in with_comma:
        if with_point or not sure or quantity[1].count(",") > 1:
            allowed = (
                "written without commas: here they may be decimal commas, or separate thousands"
            )
            raise InputError(file=path, key=f"line {line}", value=quantity[0], allowed=allowed)
        cells[column] = quantity[1].replace(",", ".") + quantity[2]


def read_columns(
    path: FilePath,
    units: Mapping[str, str],
    *,
    what: str,
    example: str,
    either: Sequence[str] = (),
) -> dict[str, FloatArray]:
    """Read the columns of a file: {name: (n,) [SI]}.

    Parameters
    ----------
    units : {name: SI unit} of its columns
    what : what the file holds, for messages
    example : of a heading, for messages
    either : names of which the file has one, not all

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    needed = [name for name in units if name not in either]
    columns = " and ".join(needed)
    if either:
        columns += f", and {' or '.join(either)}"
    lines = read_csv(path, what)
    if not lines:
        raise InputError("is empty", file=path, allowed=f"{what}: {columns}")
    heading = f"{' or '.join(units)} with its unit, such as {example}"
    names, scales = zip(*(_heading(cell, units, heading, path) for cell in lines[0][1]))
    choices = [sorted((*needed, name)) for name in either] or [sorted(needed)]
    if sorted(names) not in choices:
        raise InputError(file=path, key="columns", value=", ".join(names), allowed=columns)
    rows = [_row(number, cells, names, path) for number, cells in lines[1:]]
    return dict(zip(names, (np.array(rows).reshape(-1, len(names)) * scales).T))


def read_number(text: str, allowed: str, *, file: FilePath, key: str) -> float:
    """Read the finite number of a cell; else raise InputError."""
    number = nan
    if NUMBER.fullmatch(text):
        number = float(text)
    if not isfinite(number):
        raise refused(text, allowed, file=file, key=key)
    return number


def _heading(cell, units, allowed, path):
    """(name, SI value of its unit) of a heading such as "pressure [MPa]"."""
    parts = re.fullmatch(r"(.+?)\s*\[([^\]]+)\]", cell)
    if parts is None or parts[1] not in units:
        raise InputError(file=path, key="heading", value=cell, allowed=allowed)
    return parts[1], si(f"1 {parts[2]}", units[parts[1]], file=path, key=parts[1])


def _row(number, cells, names, path):
    line = f"line {number}"
    if len(cells) != len(names):
        allowed = "two numbers"
        if len(names) != 2:
            allowed = f"{len(names)} numbers"
        message = decimal_comma(cells)
        if len(cells) == 2 * len(names):
            message = "if these are decimal commas, separate the columns by semicolons"
        raise InputError(message, file=path, key=line, value=", ".join(cells), allowed=allowed)
    numbers = []
    for name, cell in zip(names, cells):
        key = f"{line}, {name}"
        numbers.append(read_number(cell, "a finite number", file=path, key=key))
    return numbers
