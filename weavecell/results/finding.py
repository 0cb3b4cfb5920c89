"""What a result found, with what is doubtful of it: one object, from which every place that shows
the result takes both.

The first line in a terminal and a notebook, banner, card and colour of a page, title and legend of
a picture, and the JSON file have their words and their colour from here, so that none of them can
show a number as sure that another one doubts. A picture is drawn far from its result: while a result
is shown (`showing`), all pictures say what is doubtful of it (`report.pictures_figure.complete`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from shellfabric.membrane.indicator import Indicator

PLAIN = "plain"
TONE_OF_DOUBT = "doubtful"
_SHOWN: ContextVar[tuple[str, ...]] = ContextVar("doubts of the result that is shown", default=())


@dataclass(frozen=True)
class Finding:
    """What a result found.

    Parameters
    ----------
    label : what was looked for
    value : what was found, in words
    doubts : what of it is doubtful
    outcome : "stopped", "perforated" or "unstable", which colours it; "plain" does not
    """

    label: str
    value: str
    doubts: tuple[str, ...] = ()
    outcome: str = PLAIN

    @property
    def tone(self) -> str:
        """The colour: what is doubtful is neither green nor red."""
        if self.doubts and self.outcome != "unstable":
            return TONE_OF_DOUBT
        return self.outcome

    @property
    def lines(self) -> tuple[str, ...]:
        """The line of a card that names the doubts; none without."""
        if not self.doubts:
            return ()
        return (name(self.doubts),)

    def __str__(self) -> str:
        return mark(f"{self.label} {self.value}", self.doubts)


@contextmanager
def showing(doubts: Iterable[str]) -> Iterator[None]:
    """Let the pictures that are drawn in this block say what is doubtful."""
    token = _SHOWN.set(tuple(doubts))
    try:
        yield
    finally:
        _SHOWN.reset(token)


def shown() -> tuple[str, ...]:
    """Return what is doubtful of the result that is being shown."""
    return _SHOWN.get()


def list_doubts(checks: Iterable[Indicator]) -> tuple[str, ...]:
    """List the names of the checks that are beyond their limits, each once."""
    return tuple(dict.fromkeys(check.name for check in checks if check.doubtful))


def name(doubts: Iterable[str]) -> str:
    """Name some doubts, such as "DOUBTFUL: energy error"."""
    return f"DOUBTFUL: {', '.join(doubts)}"


def mark(text: str, doubts: Iterable[str]) -> str:
    """Return a sentence about a result with its doubts behind it."""
    listed = tuple(doubts)
    if not listed:
        return text
    return f"{text.rstrip('.')}. {name(listed)}."


def tag(text: str, doubts: Iterable[str]) -> str:
    """Return what a result is called in a legend or a heading, tagged if it is doubtful."""
    if not tuple(doubts):
        return text
    return f"{text} (doubtful)"
