"""The door that a user came through, the command line or Python: messages name options in its words."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_OF_TERMINAL: ContextVar[bool] = ContextVar("of_terminal", default=False)


@contextmanager
def open_terminal() -> Iterator[None]:
    """Name options as the command line has them inside this block."""
    token = _OF_TERMINAL.set(True)
    try:
        yield
    finally:
        _OF_TERMINAL.reset(token)


def in_terminal() -> bool:
    """Return whether the user came by the command line."""
    return _OF_TERMINAL.get()


def option(name: str, value: str = "True") -> str:
    """Name an option as the user would write it: "--uncertainty", or "uncertainty=True".

    Parameters
    ----------
    name : of the keyword in Python
    value : that Python would give it; "" names the keyword alone
    """
    if _OF_TERMINAL.get():
        return "--" + name.replace("_", "-")
    if value:
        return f"{name}={value}"
    return name
