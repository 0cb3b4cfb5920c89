"""Results of finished runs in a folder, each under a key of what was computed and of the code that
computed it: one rule for every study that can be resumed.

The key is a digest of the inputs (`inputs_digest`), the version and all files that compute
(`files_of`): a result of other code is computed again. A file with the state of a single unfinished
run carries both digests (`stamp`) and is refused where either differs (`check_stamp`).

Results are plain files, written whole or not at all: a folder of results is what users keep and
copy. joblib.Memory keys by the source of one function alone, so that it hands out old results after
a change in what that imports; diskcache hides results in a data base.
"""

from __future__ import annotations

import hashlib
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import __version__
from fabrics.base import executors, store
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.files import write_whole
from fabrics.base.kernel_cache import digest

ROOT = Path(__file__).parents[2]
LIBRARIES = ("fabrics", "meshing", "unitcell3d", "shellfabric")
COMPUTING = (
    "scenes",
    "studies",
)  # folders of weavecell whose code counts beside that of a module's own folder
SUFFIXES = (".py", ".toml", ".json", ".csv", ".geo")
# enough to tell two versions of the code apart by eye
# a message shows so many digits of the code's digest
_SHORT = 12
# names of the files of results: keys with a suffix
_OURS = re.compile(r"[0-9a-f]{32}\.(npz|npy|pickle)")


@cache
def code(*modules: str) -> str:
    """Digest the code of some modules (dotted names): the names and bytes of `files_of`."""
    return digest((str(file.relative_to(ROOT)), file.read_bytes()) for file in files_of(*modules))


def files_of(*modules: str) -> list[Path]:
    """List the source and data files, but pictures, that count as the code of some modules, sorted.

    All of `LIBRARIES`, since a module can use the methods of an object whose class it does not
    import; for a module of validation all of it but the files of studies, for one of weavecell its
    own folder; for both `COMPUTING`. A module that is none of ours, as a user's own function has,
    must have been imported: it is its file.
    """
    folders = {ROOT / name for name in LIBRARIES}
    files = set()
    for module in modules:
        package, *inner = module.split(".")
        if package == "weavecell":
            folders |= {ROOT / package / name for name in (*COMPUTING, *inner[:-1])}
        elif (ROOT / package / "__init__.py").is_file():
            folders |= {
                ROOT / package,
                *(ROOT / "weavecell" / name for name in COMPUTING if package == "validation"),
            }
        else:
            files.add(Path(str(sys.modules[module].__file__)))
    files |= {file for folder in folders for file in folder.rglob("*") if file.suffix in SUFFIXES}
    return sorted(
        f for f in files if not (f.stem.startswith("pictures") or f.match("validation/studies/*"))
    )


def version(*modules: str) -> str:
    """Return the version of weavecell and of the code of some modules, as text: "0.1.0 (code
    0123456789ab)"."""
    return f"{__version__} (code {code(*modules)[:_SHORT]})"


def key(inputs: object, *modules: str) -> str:
    """Name a result: the digest of the inputs, of the version and of the code of the modules that
    compute it."""
    return hashlib.sha256(
        f"{inputs_digest(inputs)} {__version__} {code(*modules)}".encode()
    ).hexdigest()[:32]


# metadata of a field that a dataclass got after digests of it had been kept in files: at its default
# it adds nothing, so that those digests hold
ADDED_LATER = {"added_later": True}


def inputs_digest(inputs: object) -> str:
    """Digest a value.

    Raises
    ------
    TypeError : it holds something that has no value of its own, as a function or an open file
    """
    hasher = hashlib.sha256()
    _feed(hasher, inputs)
    return hasher.hexdigest()


def _feed(hasher, value):
    if isinstance(value, np.generic):
        # a number of numpy and the same number of Python are one input
        value = value.item()
    if value is None or isinstance(value, (bool, int, float, complex, str, bytes, Path)):
        text = value
        if isinstance(value, Path):
            text = str(value)
        _mark(hasher, type(text).__name__, repr(text))
        # ranges that nobody gave are those of the code
        if isinstance(value, Assumed) and value.given:
            _mark(hasher, "range", repr(value.parts))
    elif isinstance(value, np.ndarray) and value.dtype != object:
        _mark(hasher, "array", f"{value.dtype.str} {value.shape}")
        hasher.update(np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value) and not isinstance(value, type):
        # fields that are computed from others add nothing
        kept = []
        for entry in fields(value):
            is_new = bool(entry.metadata.get("added_later"))
            if entry.init and not (is_new and getattr(value, entry.name) == entry.default):
                kept.append(entry.name)
        _mark(hasher, "dataclass", f"{type(value).__qualname__} {kept}")
        for name in kept:
            _feed(hasher, getattr(value, name))
    elif isinstance(value, Mapping):
        _mark(hasher, "mapping", str(len(value)))
        # the order in which a table was written does not change a result
        for name in sorted(value, key=repr):
            _feed(hasher, name)
            _feed(hasher, value[name])
    elif isinstance(value, (set, frozenset)):
        _mark(hasher, "set", repr(sorted(map(inputs_digest, value))))
    elif isinstance(value, (tuple, list)):
        _mark(hasher, "sequence", str(len(value)))
        for part in value:
            _feed(hasher, part)
    else:
        raise TypeError(f"a {type(value).__name__} cannot be part of a key")


def _mark(hasher, kind, text):
    content = text.encode()
    hasher.update(f"{kind} {len(content)} ".encode() + content)


class RunCache:
    """Results in a folder by their keys, as `fabrics.base.store` has them on disk. A file that is
    damaged is one that is not there.

    Parameters
    ----------
    folder : made with the first result
    """

    def __init__(self, folder: FilePath) -> None:
        self.folder = Path(folder)

    def file(self, key: str) -> Path:
        """Return the file of a result."""
        return self.folder / f"{key}.{store.SUFFIX}"

    def files(self) -> list[Path]:
        """Return the files of all results, of earlier versions too."""
        return [file for file in self.folder.glob("*") if _OURS.fullmatch(file.name)]

    def clear(self) -> None:
        """Remove the results, and the folder if nothing else is in it."""
        for file in self.files():
            file.unlink(missing_ok=True)
        with suppress(OSError):
            self.folder.rmdir()

    def __contains__(self, key: str) -> bool:
        with suppress(KeyError):
            self[key]
            return True
        return False

    def __getitem__(self, key: str) -> Any:
        try:
            with open(self.file(key), "rb") as file:
                return store.read(file)
        except (OSError, store.UnreadableResult):
            raise KeyError(key) from None

    def __setitem__(self, key: str, content: Any) -> None:
        # several processes write to one folder, and any of them may be killed
        with write_whole(self.file(key), "wb") as file:
            store.write(content, file)


def results(
    function: Callable,
    arguments: Sequence[tuple],
    *,
    folder: FilePath,
    executor: str | Executor = "local",
    jobs: int = 1,
    fresh: bool = False,
    resume: bool = True,
    report: Callable[[int, int], object] | None = None,
) -> list:
    """Return function(*row) for each row of `arguments`, in their order; each is kept as soon as it
    is done.

    Nothing depends on how many runs are under way, or in which order they end.

    Parameters
    ----------
    function : of a module, to be found again in another process
    arguments : list of tuples of plain numbers, texts and frozen dataclasses
    folder : Path where results are kept, and taken from
    executor, jobs, fresh : see `executors.open_executor`
    resume : take the results that the folder holds; otherwise it is emptied first
    report : called as report(number done, number of all)

    Raises
    ------
    WeavecellError : as the function; what had ended has been kept
    """
    names = [key((function.__qualname__, row), function.__module__) for row in arguments]
    kept = RunCache(folder)
    if not resume:
        kept.clear()
    found = {}
    for name in names:
        with suppress(KeyError):
            found[name] = kept[name]
    missing = [k for k, name in enumerate(names) if name not in found]
    report = report or (lambda done, total: None)
    report(len(names) - len(missing), len(names))
    if missing:
        with executors.open_executor(executor, jobs, fresh=fresh) as pool:
            finished = executors.as_done(pool, function, [arguments[k] for k in missing])
            for done, (k, content) in enumerate(finished, 1):
                # kept at once, so that an interrupted study has lost only what was under way
                name = names[missing[k]]
                kept[name] = content
                # as a resumed study finds it
                found[name] = kept[name]
                report(len(names) - len(missing) + done, len(names))
    return [found[name] for name in names]


def stamp(inputs: object, *modules: str) -> dict[str, str]:
    """Return the attributes {name: text} that a file with the state of one run carries."""
    return {"identity": inputs_digest(inputs), "code": version(*modules)}


def check_stamp(
    attributes: Mapping, wanted: Mapping[str, str], file: FilePath, of: str = "run"
) -> None:
    """Refuse a file whose attributes are not those of `wanted`, a `stamp`.

    Raises
    ------
    InputError : it is of other inputs, or of other code
    """
    if attributes.get("identity") != wanted["identity"]:
        raise InputError(f"is the checkpoint of another {of}", file=file)
    if attributes.get("code") != wanted["code"]:
        writer = attributes.get("code", "of an earlier version")
        raise InputError(
            f"was written by weavecell {writer}, and this is {wanted['code']}: a run goes on only with "
            f"the code that began it; run it again without {option('resume')}",
            file=file,
        )
