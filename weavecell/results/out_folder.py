"""The folder that a command writes to: made, probed and locked before anything is computed, so that
no result is lost, and nothing is overwritten that weavecell did not write.

Whoever claims a folder names what will be written there. A file of such a name that this run reads,
or that is not what weavecell wrote under it by the folder's own list (`results.file_list`), is
refused before anything is computed; a run that is resumed puts it aside and makes it again.
The list gets its mark when everything is written. The folder may have come from anyone: nothing is
written or removed through a link in it, and no name of its list leads out of it.

The lock is a file in the folder, held by flock until the command ends; the system frees it when the
process dies.
"""

from __future__ import annotations

import atexit
import errno
import functools
import os
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import ParamSpec, TypeVar

from fabrics.base import files, run_cache
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError
from weavecell.results import file_list, run_folder, termination
from weavecell.results.file_list import INPUT, FileList

Parameters = ParamSpec("Parameters")
Returned = TypeVar("Returned")

RUNS = "runs"  # folder of a study, with a file for each run that is done
# those of what is shot beside a shot: in the range over what is assumed, with drawn panels, and at
# other velocities
DRAWS = "draws"
WINDOW = "window"
OF_RUNS = (RUNS, DRAWS, WINDOW)
LOCK = ".weavecell-lock"
ASIDE = ".found"
NOT_WRITABLE = "a folder that can be written to ({})"
ANOTHER_WRITES = "another folder: another run is writing to this one"


@dataclass
class Claim:
    """A folder that this process writes to.

    Parameters
    ----------
    descriptor : of its lock
    made : folders that were made for it, the innermost first
    known : list of the folder
    names : that are written, with wildcards
    resume : whether the run goes on with what the folder holds
    written : names of the files that were written since the claim
    """

    descriptor: int
    made: list[Path]
    known: FileList
    names: set[str] = field(default_factory=set)
    resume: bool = False
    written: set[str] = field(default_factory=set)


_held: dict[Path, Claim] = {}


def reading(function: Callable[Parameters, Returned]) -> Callable[Parameters, Returned]:
    """Decorate a function that claims a folder: the files that it reads are then known to the
    claim."""

    @functools.wraps(function)
    def called(*arguments: Parameters.args, **keywords: Parameters.kwargs) -> Returned:
        with files.noting_reads():
            return function(*arguments, **keywords)

    return called


def claim(
    folder: Path, names: Iterable[str], resume: bool = False, inputs: Iterable[object] = ()
) -> None:
    """Make a folder ready for results, and keep it until `release`; print whose results are there
    and get replaced.

    Parameters
    ----------
    folder : made with its parents if it does not exist
    names : of the files that will be written, relative to the folder, with wildcards
    resume : whether the run goes on with what the folder holds, and replaces nothing
    inputs : what is computed, of a run that can be resumed; its digests are kept in the folder's
        list

    Raises
    ------
    InputError : it cannot be made or written to, or another run writes to it; it has a file of
        these names that is not weavecell's, or that this run reads; to resume, it holds none of the
        inputs
    """
    place = folder.resolve()
    names = [*names]
    if place in _held:
        _add_names(folder, place, names)
        return
    # of a study whose folder is held too, and which said whose results go
    around = [_held[path] for path in place.parents if path in _held]
    resume = resume or any(one.resume for one in around)
    _check_list(folder, place)
    known = FileList.read(place)
    digests = _judge_inputs(folder, place, known, resume, inputs)
    made = [path for path in (place, *place.parents) if not path.exists()]
    try:
        place.mkdir(parents=True, exist_ok=True)
        descriptor = _lock(place / LOCK)
    except OSError as problem:
        _remove_empty(made)
        allowed = NOT_WRITABLE.format(problem.strerror)
        if isinstance(problem, BlockingIOError):
            allowed = ANOTHER_WRITES
        raise _refuse_folder(folder, allowed) from None
    if not _held:
        atexit.register(release)
        files.watchers.append(_list_file)
    _held[place] = Claim(descriptor, made, known, resume=resume)
    try:
        # a name is that of a file or of a folder of files; studies keep their runs besides
        for within in {"", *OF_RUNS, *names, *(str(Path(name).parent) for name in names)}:
            path = files.find_inside(place, within) if within else place
            if path is not None and path.is_dir():
                files.remove_unfinished(path)
        _add_names(folder, place, names)
        if around or (resume and (known.inputs or not digests)):
            earlier = None
        else:
            earlier = _name_results(place)
        if digests and digests != known.inputs:
            known.inputs = digests
            known.write(place)
    except BaseException:
        _release(place)
        raise
    if earlier:
        print(f"replaces the results of {earlier} in {folder}")


def look(
    out: FilePath,
    names: Iterable[str],
    resume: bool = False,
    inputs: Iterable[object] = (),
) -> None:
    """Refuse a folder that `claim` would refuse, and make nothing.

    Raises
    ------
    InputError : as `claim`
    """
    folder = Path(out)
    place = folder.resolve()
    there = next(path for path in (place, *place.parents) if path.exists())
    if there == place and place.is_dir():
        _check_list(folder, place)
    known = FileList.read(place)
    _judge_inputs(folder, place, known, resume, inputs)
    problem = 0
    if not there.is_dir():
        problem = errno.EEXIST if there == place else errno.ENOTDIR
    elif not os.access(there, os.W_OK):
        problem = errno.EACCES
    if problem:
        raise _refuse_folder(folder, NOT_WRITABLE.format(os.strerror(problem)))
    if there == place and place not in _held:
        if _is_locked(place / LOCK):
            raise _refuse_folder(folder, ANOTHER_WRITES)
        _judge_names(folder, place, set(names), Claim(-1, [], known, resume=resume))


@contextmanager
def hold(
    out: FilePath | None,
    names: Iterable[str],
    resume: bool = False,
    inputs: Iterable[object] = (),
    key: Callable[[], str] = str,
) -> Iterator[Path | None]:
    """Hold the folder, which is claimed in this block, while an outer claim goes on; None if
    nothing is written.

    What the folder holds outlives a SIGTERM, which is an interrupt in this block. At the end of the
    block the folder is whole: its list says so, with what `key` returns.
    """
    if out is None:
        yield None
        return
    folder = Path(out)
    place = folder.resolve()
    mine = place not in _held
    claim(folder, names, resume, inputs)
    try:
        with termination.interrupt_on_sigterm():
            yield folder
            if mine:
                _finish(place, key())
    finally:
        if mine:
            _release(place)


def write_copy(path: Path, content: str | bytes) -> None:
    """Write a copy of an input to a folder, unless it is the very file that was read."""
    if path.resolve() not in files.noted_reads():
        files.write(path, content)


def remove_earlier(folder: Path, names: str) -> None:
    """Remove the files of a pattern that weavecell wrote to a folder, such as a longer series of an
    earlier run."""
    listed = FileList.read(folder)
    for name in listed.digests:
        if file_list.matches(name, [names]) and listed.has(folder, name):
            (folder / name).unlink()
    with suppress(OSError):
        (folder / names).parent.rmdir()


def release() -> None:
    """Free all folders; one that was made and is still empty goes."""
    for place in tuple(_held):
        _release(place)


def _release(place):
    claimed = _held.pop(place)
    if not _held:
        files.watchers.remove(_list_file)
    with suppress(OSError):
        os.unlink(place / LOCK)
        # nothing was computed: the folder is as it was before
        if os.listdir(place) == [file_list.NAME]:
            os.unlink(place / file_list.NAME)
    os.close(claimed.descriptor)
    _remove_empty(claimed.made)


def _refuse_folder(folder, allowed):
    """The InputError of a folder of results."""
    return InputError(key=option("out", ""), value=str(folder), allowed=allowed)


def _name_results(place):
    """As `result_folder.name_results`, which knows all kinds of results: a command that writes none
    does without them."""
    from weavecell.results import result_folder

    return result_folder.name_results(place)


def _judge_inputs(folder, place, known, resume, inputs):
    """The digests of what is computed; a folder to resume from that holds none of them is refused."""
    digests = {run_cache.inputs_digest(given) for given in inputs}
    if resume and digests and known.inputs and digests.isdisjoint(known.inputs):
        earlier = _name_results(place) or "an unfinished run"
        others = f"this one has {earlier}, of other input or options"
        allowed = f"another folder: {others}; without {option('resume')} it is replaced"
        raise _refuse_folder(folder, allowed)
    return digests


def _is_locked(path):
    """Whether another run has the lock."""
    if not path.is_file():
        return False
    try:
        import fcntl

        with open(path, "rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    # as in `_lock`
    except (ImportError, OSError):
        pass
    return False


def _check_list(folder, place):
    """Refuse a folder whose list can be no list, or whose lock no lock: what is written to them must
    reach no other file."""
    of_list = f"{file_list.NAME}, the list of what weavecell wrote,"
    for name, what in ((file_list.NAME, of_list), (LOCK, LOCK)):
        path = place / name
        if not os.path.lexists(path):
            continue
        found = path.lstat()
        # another name of the file may be anywhere
        alone = stat.S_ISREG(found.st_mode) and found.st_nlink == 1
        if not alone or not os.access(path, os.W_OK):
            allowed = f"another folder: in this one {what} is no file that can be written to"
            raise _refuse_folder(folder, allowed)


def _add_names(folder, place, names):
    """Take further names into the claim of a place, which the user calls `folder`: that may lead
    through folders that are still to be made.

    Raises
    ------
    InputError : as `claim`, of files with these names
    """
    claimed = _held[place]
    new = set(names) - claimed.names
    strange = _judge_names(folder, place, new, claimed)
    for name in strange:
        aside = _aside(place / name)
        os.replace(place / name, aside)
        print(f"{folder / name} is not as weavecell wrote it: kept as {aside.name}, and made again")
    claimed.names |= new


def _judge_names(folder, place, new, claimed):
    """The files with new names that a run would put aside; those that it may not replace are refused."""
    read = files.noted_reads()
    found = [name for name in _present(place, new) if name not in claimed.written]
    refused = []
    strange = []
    for name in found:
        path = place / name
        if path.resolve() in read and file_list.matches(name, INPUT):
            continue
        if path.resolve() in read:
            refused.append(f"{name}, which this run reads")
        elif not claimed.known.has(place, name) and not run_folder.is_checkpoint(name, path):
            strange.append(name)
    if strange and not claimed.resume:
        for name in strange:
            why = "which weavecell did not write"
            if name in claimed.known.digests:
                why = "which was changed since weavecell wrote it"
            refused.append(f"{name}, {why}")
    if refused:
        allowed = f"another folder: this one has {'; '.join(refused)}; nothing was overwritten"
        raise _refuse_folder(folder, allowed)
    return strange


def _present(folder, names):
    """Return the names of what a folder has under names with wildcards, of files and links that
    stand where a folder of these names will be, and of links for or in a folder of finished
    runs."""
    found = []
    for pattern in sorted(names):
        places = [folder]
        *above, last = pattern.split("/")
        for part in above:
            inside = [path for place in places for path in _glob(place, part)]
            places = [path for path in inside if path.is_dir() and not path.is_symlink()]
            found += [path for path in inside if path not in places]
        found += [path for place in places for path in _glob(place, last)]
    for name in OF_RUNS:
        inside = [folder / name]
        if not inside[0].is_symlink():
            inside += [Path(at, one) for at, ones, _ in os.walk(inside[0]) for one in ones]
        found += [path for path in inside if path.is_symlink()]
    return list(dict.fromkeys(path.relative_to(folder).as_posix() for path in found))


def _glob(folder, part):
    """Return the paths in a folder with a name that may have wildcards, sorted."""
    # a link that leads nowhere is no file for glob
    if "*" not in part and (folder / part).is_symlink():
        return [folder / part]
    return sorted(folder.glob(part))


def _aside(path):
    """A free name beside a file."""
    number = 0
    aside = path.with_name(path.name + ASIDE)
    while os.path.lexists(aside):
        number += 1
        aside = path.with_name(f"{path.name}{ASIDE}-{number}")
    return aside


def _list_file(path, beside):
    """Append a file that is about to appear in a folder of a claim to its list."""
    full = Path(path).parent.resolve() / Path(path).name
    for place, claimed in _held.items():
        if not full.is_relative_to(place):
            continue
        name = full.relative_to(place).as_posix()
        if file_list.matches(name, claimed.names):
            file_list.append(place, name, beside)
            claimed.written.add(name)


def _finish(place, key):
    """Mark a folder as whole, in a list of what is there."""
    listed = FileList.read(place)
    for name, digests in [*listed.digests.items()]:
        # an input that the user changed where it lay
        changed = file_list.matches(name, INPUT) and not listed.has(place, name)
        path = files.find_inside(place, name)
        if path is not None and path.exists() and not changed:
            # the last one, if not the file itself: then the file was changed meanwhile
            listed.digests[name] = digests[-1:]
        else:
            del listed.digests[name]
    listed.whole = key
    listed.write(place)


def _lock(path):
    """Descriptor of a file that this process alone has locked; where files cannot be locked, of the
    file."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o644)
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
