"""The door that a user came through, the command line or Python: messages name options in its words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

# an option of the command line with its number or its quoted text, if it has one
_OPTION = re.compile(r"--([a-z][a-z0-9-]*)(?: (\d+|'[^']*'))?")
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


def name_options(text: str) -> str:
    """Name the options of a text, such as "--draws 16; --uncertainty", as the user would write them.

    A text that is kept in a file has them as the command line does, and is read through either door.
    """
    if _OF_TERMINAL.get():
        return text
    return _OPTION.sub(lambda found: option(found[1].replace("-", "_"), found[2] or "True"), text)
