"""Where compiled numba kernels are kept: a folder named after all source that their machine code depends on.

numba stamps a cached function with the source of its own file alone, so that after a change in a kernel that is called
from another file the caller would go on running the old code, silently. A named tuple it identifies by its class and
the types of its members, not by the names of its fields, so that after a change in their order the old code would read
the wrong arrays. Here the folder's name holds a digest of both, and a change in either starts an empty folder.

Compiling takes minutes. It is announced in one line by the logger "weavecell", which writes to stderr where the program
has not set up logging.
"""

from __future__ import annotations

import logging
import os
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from fabrics import source_code
from fabrics.checks import FilePath

# folder of kernels: what they compute, and how long they are compiled on two free cores
MODELS = {
    "shellfabric.cell": ("the unit cell", "about 10 seconds"),
    "shellfabric.panel": ("a ply", "about half a minute"),
    "shellfabric.plies": ("packs", "about 1 minute"),
    "shellfabric.sliding": ("sliding crossovers", "some minutes"),
    "shellfabric.backing": ("a block behind the panel", "a minute or two"),
    "shellfabric.coupon": ("coupons", "a minute or two"),
    "validation.models.cable": ("the cable net", "a minute or two"),
    "validation.models.solid": ("the solid patch", "a minute or two"),
}
# folders of other packages whose kernels have the decorators of a package: all call each other, and have one cache
GUESTS = {"shellfabric": ("validation/models",)}
PAUSE = 3.0  # [s] without compiling, after which kernels of the same folder are announced again
_announced: set[str] = set()  # folders, since the last pause
_last = 0.0  # [s] when something was compiled last


def compiling(module: str, done: bool = False) -> None:
    """Announce that kernels of a module are compiled, once for those of a folder that are compiled in one go.

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


@contextmanager
def kernel_cache(package_file: FilePath) -> Iterator[None]:
    """Decorate the kernels of the package whose `__init__.py` is `package_file` inside this block.

    numba reads the folder when a function is decorated. A folder that the user has chosen (NUMBA_CACHE_DIR) is used as
    the root; otherwise the package's own __pycache__.
    """
    import numba

    folder = Path(package_file).parent
    config: Any = numba.config
    before = config.CACHE_DIR
    config.CACHE_DIR = str(Path(before or folder / "__pycache__") / f"kernels-{_kernel_digest(folder)}")
    try:
        yield
    finally:
        config.CACHE_DIR = before


@cache
def _kernel_digest(folder: Path) -> str:
    """First 16 digits of the digest of a package's `kernel_sources`, which are read once in a process."""
    return source_code.digest(kernel_sources(folder))[:16]


@cache
def one_compiler_a_node() -> None:
    """From now on this process looks for kernels in the cache, and compiles those that are not there, under a lock.

    All processes of a user on a node share the lock, so that each kernel is compiled by one of them and loaded by the
    others. Where files cannot be locked, nothing is.
    """
    try:
        import fcntl
    except ImportError:
        return
    from numba.core import event

    path = Path(tempfile.gettempdir()) / f"weavecell-compiler-{os.getuid()}.lock"

    class Lock(event.Listener):
        """Held by one thread of one process while numba holds its own lock, which is that of a process."""

        thread, depth, file = threading.RLock(), 0, None

        def on_start(self, _):
            self.thread.acquire()
            if self.depth == 0:
                with suppress(OSError):
                    self.file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
                    fcntl.flock(self.file, fcntl.LOCK_EX)
            self.depth += 1

        def on_end(self, _):
            self.depth -= 1
            if self.depth == 0 and self.file is not None:
                os.close(self.file)  # which unlocks it
                self.file = None
            self.thread.release()

    event.register("numba:compiler_lock", Lock())


def kernel_sources(folder: Path) -> list[tuple[str, bytes]]:
    """[(file, bytes)] that the machine code of the kernels in a package's folder and its sub-packages depends on.

    The folders of `GUESTS` count as sub-packages, since kernels of the package are compiled for their named tuples.
    Whole: every file called *_kernels.py or importing from numba, and what these import from our packages. Of all
    other files: the definitions of named tuples, the only arguments of kernels whose layout is ours.
    """
    root, packages = folder.parent, {folder.name, *source_code.PACKAGES}
    folders = [folder, *(root / guest for guest in GUESTS.get(folder.name, ()))]
    files = sorted(file for each in folders for file in each.rglob("*.py"))
    kernels = [file for file in files if file.stem.endswith("_kernels") or b"from numba" in file.read_bytes()]
    names = [source_code.name_of(file, root) for file in kernels]
    # no machine code depends on this very file, which the decorators import; nor on `__init__`, which may import it
    whole = source_code.closure(names, root, packages, ends=[folder / "__init__.py", *_of_this_file(root)])
    found = [(file, file.read_bytes()) for file in whole]
    found += [(file, tuples) for file in files if file not in whole and (tuples := source_code.named_tuples(file))]
    return [(str(file.relative_to(root)), content) for file, content in sorted(found)]


def _of_this_file(root):
    """This file below `root`, in a list."""
    file = root / "fabrics" / Path(__file__).name
    return [file] if file.is_file() else []
