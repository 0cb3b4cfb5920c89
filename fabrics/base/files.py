"""Files: written whole or not at all, beside the target first and then renamed over it; HDF5 files
with a format.

Every HDF5 file of the project has the attribute "format" with its kind and version, which is
compared when it is read (`fabrics.base.read_formats`).

Texts of a user are UTF-8, with or without a byte order mark, or UTF-16 with one; lines end as on
any system. Tables of numbers are those of `fabrics.base.tables`.
"""

from __future__ import annotations

import codecs
import hashlib
import os
import re
import stat
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path, PurePath
from typing import IO, Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError

# [bytes] this much must still fit on the disk behind a file that a library has written
ROOM = 65536
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")
# beginning of the names of files that are not finished; such a name ends as `mkstemp` has it
UNFINISHED = ".weavecell-"
# {kind of file: most bytes of one that is read}; a file is read whole, and takes several times its
# size as a table or a body
MOST = {
    "text or table": 200_000_000,
    "STL file": 500_000_000,
    "mesh file": 2_000_000_000,
    "HDF5 file": 8_000_000_000,
}
_PART = 2**20
# [bytes] of a sealed HDF5 file before its own; they begin with the digest of all that follows it
SEAL = 512
_SEALED = b"weavecell sha256 "
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


@contextmanager
def looking() -> Iterator[None]:
    """Note no file that is read in this block: it is looked at, and no input."""
    token = _read.set(None)
    try:
        yield
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


def find_inside(folder: FilePath, name: str) -> Path | None:
    """Return the path in a folder of a name that a file of the folder gives; None of a name that
    leads elsewhere.

    Folders are sent from one to another: what they hold may be anyone's. A name is plain, relative
    and without "..", and no link is on its way.
    """
    parts = PurePath(name).parts
    if not parts or ".." in parts or "\0" in name or PurePath(name).anchor:
        return None
    path = Path(folder)
    for part in parts:
        path /= part
        if path.is_symlink():
            return None
    return path


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
def write_hdf5(
    path: FilePath, format: str, *, sealed: bool = False, **attributes: Any
) -> Iterator[Any]:
    """Open an HDF5 file for writing that appears under `path` complete, or not at all; needs h5py.

    Parameters
    ----------
    format : kind and version of the file, such as "weavecell impact 3"
    sealed : whether it begins with a digest of its bytes (`is_sealed`)
    attributes : further attributes of its root
    """
    import h5py

    # in memory first: HDF5 ends the process if it cannot write to a disk
    content = BytesIO()
    with h5py.File(content, "w", userblock_size=SEAL if sealed else 0) as file:
        file.attrs.update(format=format, **attributes)
        yield file
    with write_whole(path, "wb") as on_disk, content.getbuffer() as written:
        if sealed:
            seal = _seal(written)
            written[: len(seal)] = seal
        on_disk.write(written)


def is_sealed(content: bytes) -> bool | None:
    """Say whether the bytes of a sealed HDF5 file are those that were written; None of another
    file."""
    if not content.startswith(_SEALED):
        return None
    return content.startswith(_seal(content))


def _seal(content):
    """Return the beginning of a sealed file, from the bytes behind it."""
    length = len(_SEALED) + 2 * hashlib.sha256().digest_size
    return _SEALED + hashlib.sha256(memoryview(content)[length:]).hexdigest().encode()


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


def read_bytes(path: FilePath, kind: str = "text or table") -> bytes:
    """Return the bytes of a user's file, of a kind of `MOST`.

    Raises
    ------
    InputError : it has more bytes than a file of its kind may have
    OSError : no such file
    """
    note_read(path)
    with open(path, "rb") as file:
        found = os.fstat(file.fileno())
        check_size(path, found.st_size, kind)
        if stat.S_ISREG(found.st_mode):
            return file.read()
        # a device, or a pipe, has no size
        content = bytearray()
        while part := file.read(_PART):
            content += part
            check_size(path, len(content), kind)
    return bytes(content)


def check_size(path: FilePath, size: int, kind: str) -> None:
    """Refuse a file that has more than the bytes `size` of a file of a kind of `MOST`.

    Raises
    ------
    InputError
    """
    if size > MOST[kind]:
        most = f"{1e-6 * MOST[kind]:,.0f} MB at most, as a {kind}"
        raise InputError(f"has {1e-6 * size:,.0f} MB; must have {most}", file=path)


def read_text(path: FilePath) -> str:
    """Read a user's file: its text without byte order mark, with "\n" at the end of each line.

    Raises
    ------
    InputError : neither UTF-8 nor UTF-16, or too large
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
