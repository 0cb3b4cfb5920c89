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
import re
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath

# folder of kernels: what they compute, and how long they are compiled on two free cores
MODELS = {
    "shellfabric.cell": ("the unit cell", "about 10 seconds"),
    "shellfabric.panel": ("a ply", "about half a minute"),
    "shellfabric.plies": ("packs", "about 1 minute"),
    "shellfabric.backing": ("a block behind the panel", "a minute or two"),
    "shellfabric.coupon": ("coupons", "a minute or two"),
    "validation.models.cable": ("the cable net", "a minute or two"),
}
# folders that define the named tuples which kernels take: their layout is part of every digest
TUPLES = ("unitcell3d", "validation/models")
ROOT = Path(__file__).parents[2]
IMPORT = re.compile(
    r"^from ([\w.]+) import (\([^)]*|.*)", re.MULTILINE
)  # kernels import at the head of their file
# [s] after so long a pause without compiling, kernels of the same folder are announced again
PAUSE = 3.0
# folders announced since the last pause
_announced: set[str] = set()
# [s] time at which something was compiled last
_last = 0.0


def compiling(module: str, done: bool = False) -> None:
    """Announce that kernels of a module are compiled, once for those of a folder that are compiled
    in one go.

    To be called before a kernel is compiled, and with `done` after it.
    """
    global _last
    if time.monotonic() > _last + PAUSE and not done:
        _announced.clear()
    _last = time.monotonic()
    folder = module.rpartition(".")[0]
    if folder in MODELS and folder not in _announced and not done:
        _announced.add(folder)
        what, duration = MODELS[folder]
        logging.getLogger("weavecell").warning(f"compiling the kernels of {what}, once: {duration}")


def kernel(**options: Any) -> Callable[[Callable], Any]:
    """Decorate a kernel with numba's njit and these options; its machine code is kept in the folder
    of its file."""

    def decorated(function: Callable) -> Any:
        from numba import njit

        # numba is imported here, since commands that compute nothing should start without it
        with kernel_cache(function.__code__.co_filename):
            return njit(cache=True, **options)(function)

    return decorated


@contextmanager
def kernel_cache(file: FilePath) -> Iterator[None]:
    """Decorate kernels of a file inside this block.

    numba reads the folder when a function is decorated. A folder that the user has chosen
    (NUMBA_CACHE_DIR) is used as the root; otherwise the __pycache__ of the package.
    """
    import numba

    file = Path(file).resolve()
    root = ROOT
    if not file.is_relative_to(ROOT):  # the folder that the outermost package of the file is in
        root = next(folder for folder in file.parents if not (folder / "__init__.py").is_file())
    config: Any = numba.config
    before = config.CACHE_DIR
    folder = Path(before or root / file.relative_to(root).parts[0] / "__pycache__")
    config.CACHE_DIR = str(folder / f"kernels-{_kernel_digest(file, root)}")
    try:
        yield
    finally:
        config.CACHE_DIR = before


@cache
def _kernel_digest(file: Path, root: Path) -> str:
    """First 16 digits of the digest of a file's `kernel_sources`."""
    return digest(kernel_sources(file, root))[:16]


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
    path = Path(tempfile.gettempdir()) / f"weavecell-compiler-{os.getuid()}-{shared}.lock"

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
    """Collect what the machine code of the kernels in a file depends on, for packages in the folder
    `root`: [(file, bytes)].

    The file, and what it imports from packages in `root`, directly or not; of all other files of
    `TUPLES` the definitions of named tuples, the only arguments of kernels whose layout is ours.
    """
    whole: set[Path] = set()
    waiting = [file]
    while waiting:
        path = waiting.pop()
        # no machine code depends on this very file, which the decorators import
        if (
            path in whole
            or path == root / "fabrics" / "base" / Path(__file__).name
            or not path.is_file()
        ):
            continue
        whole.add(path)
        for module, names in IMPORT.findall(path.read_text("utf-8")):
            place = root.joinpath(*module.split("."))
            inside = re.findall(r"\w+", names)
            waiting += [place.with_suffix(".py"), *(place / f"{name}.py" for name in inside)]
    sources = [(path, path.read_bytes()) for path in whole]
    sources += [(path, tuples) for path, tuples in _tuples(root) if path not in whole]
    return [(str(path.relative_to(root)), content) for path, content in sorted(sources)]


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
