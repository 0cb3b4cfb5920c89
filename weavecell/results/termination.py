"""SIGTERM, by which a batch system ends a job, ends a run as Ctrl-C does: what is computed by then
is kept."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from fabrics.base.errors import interrupts, raise_interrupt

# what a program that has chosen nothing does at a signal
_DEFAULTS = {signal.SIGTERM: signal.SIG_DFL, signal.SIGINT: signal.default_int_handler}


@contextmanager
def interrupt_on_sigterm() -> Iterator[None]:
    """Raise KeyboardInterrupt at SIGTERM and Ctrl-C in this block, unless the program has a handler
    of its own; also where they come inside of a library that makes another error of it."""
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number, default in _DEFAULTS.items():
            if signal.getsignal(number) is default:
                before[number] = signal.signal(number, raise_interrupt)
    try:
        with interrupts():
            yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
