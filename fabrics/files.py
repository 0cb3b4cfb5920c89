"""Files: written whole or not at all, beside the target first and then renamed over it; HDF5 files with a format.

Every HDF5 file of the project has the attribute "format" with its kind and version, which is compared when it is read.

CSV files of a user are UTF-8, with or without a byte order mark; cells are separated by commas, or by semicolons where
the first line has one. Lines that begin with # are comments. The first line of columns of numbers names them with their
units, such as

    time [us], displacement [mm]

and every other line is a row of numbers.
"""

from __future__ import annotations

import csv
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.units import decimal_comma, si


@contextmanager
def replace_whole(path: FilePath) -> Iterator[Path]:
    """Yield a temporary path beside `path`; rename it to `path` if the block succeeds, remove it if not.

    For libraries that open a file by its name. The temporary name keeps the suffix, by which many of them choose
    the format.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}-", suffix=path.suffix)
    os.close(handle)
    beside = Path(name)
    try:
        yield beside
        with open(beside, "rb+") as file:
            os.fsync(file.fileno())
        beside.chmod(0o666 & ~_umask())
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def write_whole(path: FilePath, mode: str = "w") -> Iterator[IO]:
    """Open a file for writing that appears under `path` complete, or not at all."""
    encoding = None if "b" in mode else "utf-8"
    with replace_whole(path) as beside, open(beside, mode, encoding=encoding) as file:
        yield file


def write(path: FilePath, content: str | bytes) -> None:
    """Write a text or bytes that appear under `path` complete, or not at all."""
    with write_whole(path, "w" if isinstance(content, str) else "wb") as file:
        file.write(content)


def write_csv(path: FilePath, rows: Iterable[Iterable[Any]]) -> None:
    """Write rows as a CSV file, as `write` does."""
    with write_whole(path) as file:
        csv.writer(file).writerows(rows)


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

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs.update(format=format, **attributes)
        yield file


@contextmanager
def read_hdf5(path: FilePath, *formats: str, what: str = "HDF5 file") -> Iterator[Any]:
    """Open an HDF5 file for reading; needs h5py.

    Parameters
    ----------
    formats : kind and version of the file, as of `write_hdf5`; one of these
    what : the file in words, for the message

    Raises
    ------
    InputError : no such file, not HDF5, another format, or without an entry that the block reads
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get("format")
            if found not in formats:
                raise InputError(
                    file=path, key="format", value=found, allowed=" or ".join(map(repr, formats))
                )
            yield file
    except (OSError, KeyError) as problem:
        raise InputError(f"is not a readable {what} ({problem})", file=path) from problem


def read_csv(path: FilePath, what: str) -> list[tuple[int, list[str]]]:
    """(line number, cells without the blanks around them) of each line of a CSV file but empty ones and comments.

    Empty cells at the end of the first line, and below these, are left out.

    Parameters
    ----------
    what : the file's content, given as what is allowed where it cannot be read

    Raises
    ------
    InputError : no such file, not UTF-8 text, or a cell above the limit of Python's csv (131,072 letters)
    """
    try:
        text = enumerate(Path(path).read_text(encoding="utf-8-sig").splitlines(), 1)
        numbered = [
            (n, line) for n, line in text if line.strip("; ,") and not line.lstrip().startswith("#")
        ]
        separator = ";" if numbered and ";" in numbered[0][1] else ","
        texts = csv.reader(
            [line for _, line in numbered], delimiter=separator, skipinitialspace=True
        )
        rows = [(n, [cell.strip() for cell in cells]) for (n, _), cells in zip(numbered, texts)]
    except (OSError, UnicodeDecodeError, csv.Error) as problem:
        why = (
            "not UTF-8 text"
            if isinstance(problem, UnicodeDecodeError)
            else getattr(problem, "strerror", problem)
        )
        raise InputError("cannot be read", file=path, allowed=f"{what} ({why})") from problem
    columns = max((n for n, cell in enumerate(rows[0][1], 1) if cell), default=0) if rows else 0
    for _, cells in rows:
        while len(cells) > columns and not cells[-1]:
            cells.pop()
    return rows


def read_columns(
    path: FilePath,
    units: Mapping[str, str],
    *,
    what: str,
    content: str,
    heading: str,
    accepts: Callable[[Sequence[str]], bool],
    columns: str,
) -> dict[str, FloatArray]:
    """The columns of a file: {name: (n,) [SI]}.

    Parameters
    ----------
    units : {name: SI unit} of the columns that there may be
    what, content, heading, columns : what the message gives as allowed where the file cannot be read, is empty, has a
        heading that is not one of `units`, or names that `accepts` (names) turns down

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    lines = read_csv(path, what)
    if not lines:
        raise InputError("is empty", file=path, allowed=content)
    names, scales = zip(*(_heading(cell, units, heading, path) for cell in lines[0][1]))
    if not accepts(names):
        raise InputError(file=path, key="columns", value=", ".join(names), allowed=columns)
    rows = [_row(number, cells, len(names), path) for number, cells in lines[1:]]
    return dict(zip(names, (np.array(rows).reshape(-1, len(names)) * scales).T))


def _heading(cell, units, allowed, path):
    """(name, SI value of its unit) of a heading such as "pressure [MPa]"."""
    found = re.fullmatch(r"(.+?)\s*\[([^\]]+)\]", cell)
    if found is None or found[1] not in units:
        raise InputError(file=path, key="heading", value=cell, allowed=allowed)
    return found[1], si(f"1 {found[2]}", units[found[1]], file=path, key=found[1])


def _row(number, cells, count, path):
    try:
        values = [float(cell) for cell in cells]
    except ValueError:
        values = []
    if len(values) != count:
        allowed_text = "two numbers" if count == 2 else f"{count} numbers"
        line = ", ".join(cells)
        raise InputError(
            decimal_comma(cells), file=path, key=f"line {number}", value=line, allowed=allowed_text
        )
    return values
