"""The folder that a command writes to: made, probed and locked before anything is computed, so that
no result is lost.

The lock is a file in the folder, held by flock until the command ends; the system frees it when the
process dies.
"""

from __future__ import annotations

import atexit
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from fabrics.base import files, run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from weavecell.results import termination

LOCK = ".lock"
INPUT = ".input"
_held: dict[
    Path, tuple[int, list[Path]]
] = {}  # folder: descriptor of its lock, and folders that were made for it


def claim(folder: Path, resume: bool = False, inputs: Iterable[object] = ()) -> None:
    """Make a folder ready for results, and keep it until `release`; print whose results are there
    and get replaced.

    Parameters
    ----------
    folder : made with its parents if it does not exist
    resume : whether the run goes on with what the folder holds, and replaces nothing
    inputs : what is computed, of a run that can be resumed; its digests are kept in the folder, as
        `INPUT`

    Raises
    ------
    InputError : it cannot be made or written to, or another run writes to it; to resume, it holds
        none of the inputs
    """
    place = folder.resolve()
    if place in _held:
        return
    mark = place / INPUT
    digests = {run_cache.inputs_digest(given) for given in inputs}
    if resume and digests and mark.exists() and digests.isdisjoint(mark.read_text("utf-8").split()):
        earlier = _earlier(place) or "an unfinished run"
        allowed = f"another folder: this one has {earlier}, of other input or options; without --resume it is replaced"
        raise InputError(key="--out", value=str(folder), allowed=allowed)
    made = [path for path in (place, *place.parents) if not path.exists()]
    try:
        place.mkdir(parents=True, exist_ok=True)
        descriptor = _lock(place / LOCK)
    except OSError as problem:
        _remove_empty(made)
        allowed = f"a folder that can be written to ({problem.strerror})"
        if isinstance(problem, BlockingIOError):
            allowed = "another folder: another run is writing to this one"
        raise InputError(key="--out", value=str(folder), allowed=allowed) from None
    if not _held:
        atexit.register(release)
    _held[place] = descriptor, made
    if resume and (mark.exists() or not digests):
        earlier = None
    else:
        earlier = _earlier(place)
    if digests:
        files.write(mark, "\n".join(sorted(digests)))
    if earlier:
        print(f"replaces the results of {earlier} in {folder}")


@contextmanager
def hold(
    out: FilePath | None, resume: bool = False, inputs: Iterable[object] = ()
) -> Iterator[Path | None]:
    """The folder, which is claimed in this block, while an outer claim goes on; None if nothing is
    written.

    What the folder holds outlives a SIGTERM, which is an interrupt in this block.
    """
    if out is None:
        yield None
        return
    folder = Path(out)
    mine = folder.resolve() not in _held
    claim(folder, resume, inputs)
    try:
        with termination.interrupt_on_sigterm():
            yield folder
    finally:
        if mine:
            _release(folder.resolve())


def release() -> None:
    """Free all folders; one that was made and is still empty goes."""
    for place in tuple(_held):
        _release(place)


def _release(place):
    descriptor, made = _held.pop(place)
    with suppress(OSError):
        os.unlink(place / LOCK)
        # nothing was computed: the folder is as it was before
        if os.listdir(place) == [INPUT]:
            os.unlink(place / INPUT)
    os.close(descriptor)
    _remove_empty(made)


def _lock(path):
    """Descriptor of a file that this process alone has locked; where files cannot be locked, of the
    file."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            import fcntl

            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # the run that had the lock may have removed the file after it was opened here
            if os.fstat(descriptor).st_ino == os.stat(path).st_ino:
                return descriptor
        except FileNotFoundError:
            # the run that had the folder has removed it
            pass
        except BlockingIOError:
            os.close(descriptor)
            raise
        # Windows and some network file systems have no locks: two runs in one folder are then the
        # user's care
        except (ImportError, OSError):
            return descriptor
        os.close(descriptor)


def _remove_empty(folders):
    """Remove folders, the innermost first, up to one that holds something."""
    with suppress(OSError):
        for folder in folders:
            folder.rmdir()


def _earlier(folder):
    """What a folder holds the results of, with their date; None if it holds none."""
    dated: list[tuple[str, str]] = []
    for path in folder.glob("*.json"):
        content: Any = None
        with suppress(OSError, ValueError):
            content = json.loads(path.read_text("utf-8"))
        stamp = None
        if isinstance(content, dict):
            stamp = content.get("provenance", content)
        if isinstance(stamp, dict) and "date" in stamp:
            dated.append(
                (
                    str(stamp["date"]),
                    str(content.get("title") or content.get("fabric") or path.stem),
                )
            )
    if dated:
        return "{1} of {0}".format(*max(dated))
    return None
