"""Files of this project that state their format, HDF5 and JSON: read, or refused in one line.

In weavecell the readers of the folders of results alone import this module (pyproject.toml).
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, WeavecellError
from fabrics.base.files import check_size, is_sealed, note_read, read_bytes

OF_HDF5 = "HDF5 file"


@contextmanager
def read_hdf5(
    path: FilePath, *formats: str, what: str = "HDF5 file", sealed: bool = False
) -> Iterator[Any]:
    """Open an HDF5 file for reading; needs h5py.

    Parameters
    ----------
    formats : kind and version of the file, as in `write_hdf5`; one of these
    what : the file in words, for the message
    sealed : whether it was written with a seal, which is compared before anything is read

    Raises
    ------
    InputError : no such file, not HDF5, another format, with more numbers than its kind may have,
        without an entry that the block reads, or changed since it was sealed
    """
    import h5py

    note_read(path)
    try:
        content: Any = path
        whole: bool | None = True
        if sealed:
            taken = read_bytes(path, OF_HDF5)
            whole = is_sealed(taken)
            content = BytesIO(taken)
        if whole is False:
            raise InputError(f"is not the {what} that was written: bytes were changed", file=path)
        # a file is whole when it appears, and some network drives have no locks
        with h5py.File(content, "r", **({} if sealed else {"locking": False})) as file:
            stated = file.attrs.get("format", "")
            if stated not in formats:
                raise InputError(
                    file=path, key="format", value=stated, allowed=" or ".join(map(repr, formats))
                )
            sizes: list[int] = []
            file.visititems(lambda _, found: sizes.append(getattr(found, "nbytes", 0)))
            check_size(path, sum(sizes), OF_HDF5)
            if whole is None:
                raise InputError(f"is not the {what} that was written: it has no digest", file=path)
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
