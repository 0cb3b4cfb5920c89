"""Where compiled numba kernels are kept: one folder for each file of kernels, named after all
source that its machine code depends on.

numba stamps a cached function with the source of its own file alone, so that after a change in a
kernel that is called from another file the caller would go on running the old code, silently. A
named tuple it identifies by its class and the types of its members, not by the names of its fields,
so that after a change in their order the old code would read the wrong arrays. Here the folder's
name holds a digest of the file, of all that it imports, and of the named tuples: a change in any of
them starts an empty folder, and the kernels that do not depend on it stay compiled.

Compiling takes minutes. It is announced in one line by the logger "weavecell", which writes to
stderr where the program has not set up logging.
"""

from __future__ import annotations

import ast
import hashlib
import logging
import os
import platform
import re
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError

# folder of kernels: what they compute, and how long they are compiled on two free cores
MODELS = {
    "shellfabric.cell": ("the unit cell", "about 10 seconds"),
    "shellfabric.membrane": ("a ply", "about half a minute"),
    "shellfabric.plies": ("packs", "about 1 minute"),
    "shellfabric.block": ("a block behind the panel", "a minute or two"),
    "shellfabric.coupon": ("coupons", "a minute or two"),
    "shellfabric.yarns": ("resolved yarns", "up to two minutes"),
    "shellfabric.metal": ("a bullet of metal", "up to two minutes"),
    "validation.models.solids": ("woven solids", "up to two minutes"),
    "validation.models.cable": ("the cable net", "a minute or two"),
}
# folders that define the named tuples which kernels take: their layout is part of every digest
TUPLES = ("unitcell3d", "validation/models")
ROOT = Path(__file__).parents[2]
# threads of a kernel that wait for each other sleep: those that spin take the time of other runs
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
# {variable of numba's: (values with which no kernel runs, what it may be)}; numba ends with tracebacks
REFUSED = {
    "NUMBA_DISABLE_JIT": (re.compile(r"\s*0*[1-9]\d*\s*"), "unset, or 0: kernels are machine code"),
    "NUMBA_NUM_THREADS": (re.compile(r"\s*(0+|-\d+)\s*"), "unset, or 1 or more"),
}
for _name, (_values, _allowed) in REFUSED.items():
    if _values.fullmatch(os.environ.get(_name, "")):
        raise InputError(key=_name, value=os.environ[_name], allowed=_allowed)
# files that no machine code depends on: the decorators import this one, and what the others declare is
# in the names of the types of rows (`shellfabric.jit.declared`)
NO_CODE = ("fabrics/base/kernel_cache.py", "fabrics/base/schema.py", "shellfabric/panel_numbers.py")
# kernels import at the head of their file
IMPORT = re.compile(r"^from ([\w.]+) import (\([^)]*|.*)", re.MULTILINE)
# a kernel that is compiled by itself (`shellfabric.jit.compile.units`): what its callers know of it
UNIT = re.compile(r"^(@unit\([^()]*\)\ndef (\w+)\([^()]*\):)", re.MULTILINE)
# a plain number with a name, which stands in the code of the kernels that use it
CONSTANT = re.compile(r"^(([A-Z]\w*) = (?:[\d.e-]+|np\.uint64\(\d+\)))$", re.MULTILINE)
# lines of comments and docstrings, and blank ones
PROSE = re.compile(rb'^[ \t]*(?:#[^\n]*|"""(?:[^"]|"(?!""))*"""[ \t]*|)\n', re.MULTILINE)
# what a pickle that was cut short, or has other bytes in it, raises
DAMAGED = (
    EOFError,
    UnpicklingError,
    ValueError,
    TypeError,
    AttributeError,
    IndexError,
    KeyError,
    ImportError,
    MemoryError,
    OverflowError,
)
# what an x86-64 processor has that runs code for x86-64-v3: nearly all since 2013
OF_V3 = {"avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave"}
# LLVM's name of the least processor that portable code is for, by architecture
COMMON = {"x86_64": "x86-64-v3", "AMD64": "x86-64-v3", "aarch64": "generic", "arm64": "generic"}
_announced: set[str] = set()  # folders of which the user has been told
_unkept: list[str] = []  # folders that cannot be written, whose kernels are kept nowhere
_compiled_with = ""  # what the options of the kernels that are decorated now are called
# compilations that go on, one inside another; [s] when the outermost began, and what all have taken
_depth = 0
_since = 0.0
_spent = 0.0


def compiling(module: str, done: bool = False) -> None:
    """Announce that kernels of a module are compiled, once for all those of a folder, and take the
    time.

    To be called before a kernel is compiled, and with `done` after it.
    """
    global _depth, _since, _spent
    if done:
        _depth -= 1
        if _depth == 0:
            _spent += time.monotonic() - _since
        return
    if _depth == 0:
        _since = time.monotonic()
    _depth += 1
    folder = module.rpartition(".")[0]
    if folder in MODELS and folder not in _announced:
        _announced.add(folder)
        what, duration = MODELS[folder]
        often = "once"
        if _unkept:
            often = (
                f"in each run, as {_unkept[-1]} cannot be written (NUMBA_CACHE_DIR chooses another)"
            )
        line = f"compiling the kernels of {what}, {often}: {duration}"
        logging.getLogger("weavecell").warning(line)


def seconds_compiled() -> float:
    """Return the time [s] that this process has spent on compiling kernels, which no forecast of a
    run should count."""
    return _spent


def kernel(**options: Any) -> Callable[[Callable], Any]:
    """Decorate a kernel with numba's njit and these options; its machine code is kept in the folder
    of its file."""

    def decorated(function: Callable) -> Any:
        from numba import njit

        # numba is imported here, since commands that compute nothing should start without it
        with kernel_cache(function.__code__.co_filename, options):
            return njit(cache=True, **options)(function)

    return decorated


@contextmanager
def kernel_cache(file: FilePath, options: Mapping[str, Any]) -> Iterator[None]:
    """Decorate kernels of a file inside this block, with these options of numba's njit.

    numba reads the folder when a function is decorated. A folder that the user has chosen
    (NUMBA_CACHE_DIR) is used as the root; otherwise the __pycache__ of the package.

    One function may be compiled with different options, by the crossover and by the woven solids.
    numba's key of machine code does not have them: without a name of its own for each, one would
    load the code of the other, which crashes where that has no way in from Python.
    """
    global _compiled_with
    import numba
    from numba.core import caching as caching_of_numba

    caching: Any = caching_of_numba
    file = Path(file).resolve()
    root = ROOT
    if not file.is_relative_to(ROOT):  # the folder that the outermost package of the file is in
        root = next(folder for folder in file.parents if not (folder / "__init__.py").is_file())
    config: Any = numba.config
    before = config.CACHE_DIR
    locators = config.CACHE_LOCATOR_CLASSES
    folder = Path(before or root / file.relative_to(root).parts[0] / "__pycache__")
    config.CACHE_DIR = str(folder / kernel_folder(file, root))
    places = (KernelFolder, UserFolder, ReadFolder)
    config.CACHE_LOCATOR_CLASSES = ",".join(f"{__name__}.{place.__name__}" for place in places)
    files_of_numba = caching.IndexDataCacheFile
    caching.IndexDataCacheFile = _files()
    _compiled_with = name_options(options)
    try:
        yield
    finally:
        _compiled_with = ""
        config.CACHE_DIR = before
        config.CACHE_LOCATOR_CLASSES = locators
        caching.IndexDataCacheFile = files_of_numba


class KernelFolder:
    """Tell numba where the machine code of a function is kept: in the folder of `kernel_cache`.

    numba's own place has the path of the source in its name and the time of its last change as its
    stamp, so that a copied cache is never found. The digest in the folder's name says all of it:
    what one computer has compiled can be copied to another of the same kind of processor.
    """

    def __init__(self, folder: str) -> None:
        self.folder = folder
        self.compiled_with = _compiled_with

    @classmethod
    def from_function(cls, function: Any, file: str) -> KernelFolder | None:
        """Return the place of a function, or None if its folder cannot be written."""
        import numba

        config: Any = numba.config
        place = cls(str(config.CACHE_DIR))
        try:
            place.ensure_cache_path()
        except OSError:
            return None
        return place

    def ensure_cache_path(self) -> None:
        """Make the folder; raises OSError if nothing can be written there."""
        os.makedirs(self.folder, exist_ok=True)
        tempfile.TemporaryFile(dir=self.folder).close()

    def get_cache_path(self) -> str:
        """Return the folder."""
        return self.folder

    def get_source_stamp(self) -> str:
        """Return what numba compares with the stamp of kept code: the digest of all source."""
        return Path(self.folder).name

    def get_disambiguator(self) -> str:
        """Return what the options are called: the names of kernels differ within their file."""
        return self.compiled_with


class UserFolder:
    """Tell numba where machine code is kept if the folder of `KernelFolder` cannot be written: in
    its own folder of the user."""

    @classmethod
    def from_function(cls, function: Any, file: str) -> Any:
        """Return numba's place of a function, in which its options have a name too, or None."""
        from numba.core.caching import UserWideCacheLocator

        # of a user without a home numba would make a folder "~" here
        if not os.path.isabs(os.path.expanduser("~")):
            return None
        place: Any = UserWideCacheLocator.from_function(function, file)
        if place is not None:
            name = f"{place.get_disambiguator()}-{_compiled_with}"
            place.get_disambiguator = lambda: name
        return place


class ReadFolder(KernelFolder):
    """Tell numba where machine code is found if nothing can be written, as for a user without a home:
    what the folder of `KernelFolder` has is taken, and what it lacks is compiled and not kept."""

    @classmethod
    def from_function(cls, function: Any, file: str) -> ReadFolder:
        """Return the place of a function."""
        import numba

        config: Any = numba.config
        place = cls(str(config.CACHE_DIR))
        _unkept.append(str(Path(place.folder).parent))
        return place

    def ensure_cache_path(self) -> None:
        """Do nothing."""


def name_options(options: Mapping[str, Any]) -> str:
    """Return eight digits that stand for options of numba's njit in the name of a file."""
    parts = []
    for key, value in sorted(options.items()):
        # the text of a set follows the hash seed of the process
        if isinstance(value, (set, frozenset)):
            value = sorted(value)
        parts.append((key, repr(value).encode()))
    return digest(parts)[:8]


@cache
def _files():
    """Return the class of numba's files of a kernel, changed in four ways.

    A file that was cut short counts as missing: the kernel is compiled again. Machine code is in a
    file that is named after the types that it is for. numba numbers these files, so that two
    processes which compile for other types at the same time write over each other's code. Where
    there is no code for this very processor, code for all processors of its kind is taken
    (`tools/compile_kernels.py --portable`). Code that cannot be written is not kept.
    """
    from numba.core import caching

    common = _common_processor()

    class Files(caching.IndexDataCacheFile):
        def load(self, key):
            """Load the machine code of a key of numba: types, (triple, processor, features), code."""
            found = super().load(key)
            if found is None and common:
                types, (triple, _, _), code = key
                found = super().load((types, (triple, common, ""), code))
            return found

        def _load_index(self):
            try:
                return super()._load_index()
            except (*DAMAGED, PermissionError):
                return {}

        def _load_data(self, name):
            try:
                return super()._load_data(name)
            except (*DAMAGED, PermissionError):
                # what numba takes for a kernel that is not there
                raise FileNotFoundError(name) from None

        def save(self, key, data):
            name = self._data_name(int(hashlib.sha256(repr(key).encode()).hexdigest()[:15], 16))
            # what cannot be kept, as on a full disk, is compiled again
            with suppress(OSError):
                self._save_data(name, data)
                self._save_index(self._load_index() | {key: name})

    return Files


def _common_processor() -> str:
    """Return the name of the processor whose code runs on this one too; "" if there is none."""
    from llvmlite.binding import get_host_cpu_features

    name = COMMON.get(platform.machine(), "")
    if name == "x86-64-v3":
        features = get_host_cpu_features()
        if not all(features.get(feature) for feature in OF_V3):
            return ""
    return name


@cache
def kernel_folder(file: Path, root: Path = ROOT) -> str:
    """Return the name of the folder of the kernels of a file: by 16 digits of the digest of its
    `kernel_sources`."""
    return f"kernels-{digest(kernel_sources(file, root))[:16]}"


def digest(parts: Iterable[tuple[str, bytes]]) -> str:
    """Return the hexadecimal SHA-256 of pairs (name, bytes)."""
    total = hashlib.sha256()
    for name, content in parts:
        total.update(f"{name}\0{len(content)}\0".encode() + content)
    return total.hexdigest()


@cache
def one_compiler_a_node() -> None:
    """Look for kernels in the cache from now on, and compile those that are not there, under a
    lock.

    The processes of a user on a node that share a cache share the lock, so that each kernel is
    compiled by one of them and loaded by the others. Where files cannot be locked, nothing is.
    """
    try:
        import fcntl
    except ImportError:
        return
    import numba
    from numba.core import event

    config: Any = numba.config
    shared = hashlib.sha256(str(config.CACHE_DIR or ROOT).encode()).hexdigest()[:16]
    try:
        path = Path(tempfile.gettempdir()) / f"weavecell-compiler-{os.getuid()}-{shared}.lock"
    except OSError:
        # no folder for temporary files
        return

    class Lock(event.Listener):
        """Held by one thread of one process while numba holds its own lock, which is that of a
        process."""

        # flock is held by a process: its threads need a lock of their own
        thread = threading.RLock()
        depth = 0
        file = None

        def on_start(self, _):
            self.thread.acquire()
            if self.depth == 0:
                # without the lock a kernel is compiled twice, which only costs time
                with suppress(OSError):
                    self.file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
                    fcntl.flock(self.file, fcntl.LOCK_EX)
            self.depth += 1

        def on_end(self, _):
            self.depth -= 1
            if self.depth == 0 and self.file is not None:
                # closing the file also unlocks it
                os.close(self.file)
                self.file = None
            self.thread.release()

    event.register("numba:compiler_lock", Lock())


def kernel_sources(file: Path, root: Path = ROOT) -> list[tuple[str, bytes]]:
    """List what the machine code of the kernels in a file depends on, as (name, content).

    The file, and what it imports from packages in the folder `root`, directly or not, without
    comments and docstrings. A unit of another kernel file is called through a pointer: the caller's
    code depends on its signature and on the tables that it takes, not on what it does. Of a file
    from which only units and plain numbers are imported these lines are all that counts. Of all other
    files of `TUPLES` the definitions of named tuples, the only arguments of kernels whose layout is
    ours.
    """
    whole: set[Path] = set()
    signatures: dict[str, bytes] = {}
    waiting = [file]
    while waiting:
        path = waiting.pop()
        if path in whole or path in {root / name for name in NO_CODE} or not path.is_file():
            continue
        whole.add(path)
        for imported, names in _imports(path, root):
            known = _units(imported) | _constants(imported)
            if not names or not names <= known.keys():
                waiting.append(imported)
                continue
            for name in names:
                signatures[f"{imported.relative_to(root)}:{name}"] = known[name]
            if names & _units(imported).keys():
                # the tables that their parameters are rows of
                tables = [path for path, _ in _imports(imported, root)]
                waiting += [path for path in tables if not path.stem.endswith("_kernels")]
    sources = [(str(path.relative_to(root)), _code(path)) for path in whole]
    sources += signatures.items()
    sources += [
        (str(path.relative_to(root)), tuples) for path, tuples in _tuples(root) if path not in whole
    ]
    return sorted(sources)


@cache
def _imports(path: Path, root: Path) -> list[tuple[Path, set[str]]]:
    """List the files of packages in `root` that a file imports, and what it takes of each; an empty
    set stands for all of it."""
    text = path.read_text("utf-8")
    found = []
    for module, names in IMPORT.findall(text):
        place = root.joinpath(*module.split("."))
        inside = re.findall(r"\w+(?: as \w+)?", names)
        if place.with_suffix(".py").is_file():
            found.append((place.with_suffix(".py"), {name.split()[0] for name in inside}))
        for name in inside:
            member = place / f"{name.split()[0]}.py"
            if member.is_file():
                used = re.findall(rf"(?<![\w.]){name.split()[-1]}\.(\w+)", text)
                found.append((member, set(used)))
    return found


@cache
def _units(path: Path) -> dict[str, bytes]:
    """Find the units of a kernel file: {name: its decorator and its parameters}."""
    text = path.read_text("utf-8")
    return {name: signature.encode() for signature, name in UNIT.findall(text)}


@cache
def _constants(path: Path) -> dict[str, bytes]:
    """Find the plain numbers that a file defines: {name: its line}."""
    text = path.read_text("utf-8")
    return {name: line.encode() for line, name in CONSTANT.findall(text)}


@cache
def _code(path: Path) -> bytes:
    """Read a file without its comments, docstrings and blank lines, which no machine code sees.

    Only whole lines are left out, so that a text inside a line of code stays.
    """
    return PROSE.sub(b"", path.read_bytes())


@cache
def _tuples(root):
    """[(file, definitions of its named tuples as bytes)] of the folders `TUPLES`."""
    files = (path for folder in TUPLES for path in (root / folder).rglob("*.py"))
    return [(path, tuples) for path in files if (tuples := named_tuples(path.read_bytes()))]


def named_tuples(content: bytes) -> bytes:
    """Extract the definitions of the named tuples of a file without the layout of its text; b"" if
    there are none.

    A definition with fields that are not literals depends on the rest of the file: then it is the
    whole file.
    """
    if b"amedtuple(" not in content and b"NamedTuple" not in content:
        return b""
    definitions = []
    for node in ast.walk(ast.parse(content)):
        if isinstance(node, ast.ClassDef) and any(
            ast.unparse(base).endswith("NamedTuple") for base in node.bases
        ):
            definitions.append(ast.dump(node))
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(
            ("namedtuple", "NamedTuple")
        ):
            if any(
                isinstance(part, ast.Name) for argument in node.args for part in ast.walk(argument)
            ):
                return content
            definitions.append(ast.dump(node))
    return "\n".join(definitions).encode()
