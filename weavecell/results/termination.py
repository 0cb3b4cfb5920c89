"""SIGTERM, by which a batch system ends a job, ends a run as Ctrl-C does: what is computed by then
is kept."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from fabrics.base.errors import interrupts


@contextmanager
def interrupt_on_sigterm() -> Iterator[None]:
    """Raise KeyboardInterrupt at SIGTERM in this block, unless the program has a handler of its
    own; so does an interrupt inside a kernel."""
    default = signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    if not default or threading.current_thread() is not threading.main_thread():
        with interrupts():
            yield
        return
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with interrupts():
            yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
