"""Files are written whole or not at all: beside the target first, then renamed over it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from fabrics.checks import FilePath


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


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask
