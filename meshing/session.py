"""gmsh, silent and closed again: one session at a time, no signal handler left behind.

gmsh is one global state in one process. A lock makes threads take turns. Older versions set the
interrupt handler on import and again on finalize, newer ones on initialize; a library must leave
the handler to the program.
"""

from __future__ import annotations

import inspect
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_handler = signal.getsignal(signal.SIGINT)
import gmsh  # noqa: E402

if signal.getsignal(signal.SIGINT) is not _handler:
    signal.signal(signal.SIGINT, _handler)
gmsh.oldsig = None  # what an older finalize() would put back

_LOCK = threading.Lock()
_QUIET = {"readConfigFiles": False}
if "interruptible" in inspect.signature(gmsh.initialize).parameters:
    _QUIET["interruptible"] = False


@contextmanager
def gmsh_session(name: str) -> Iterator[Any]:
    """Yield the gmsh module with one empty model called `name`; finalize gmsh whatever happens."""
    with _LOCK:
        gmsh.initialize(**_QUIET)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.model.add(name)
            yield gmsh
        finally:
            gmsh.finalize()
