"""The answer of a result: one object, from which every place that shows the result takes its words.

What a terminal and a notebook print, top and colour of a page, and the JSON file are `Answer.rows`, so
that none of them can show a number as sure that another one doubts. A picture is drawn far from its
result: while a result is shown (`showing`), all pictures say what is doubtful of it
(`report.pictures_figure.complete`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from fabrics.base.door import name_options
from weavecell.runs.outcomes import DEPENDS

if TYPE_CHECKING:
    from shellfabric.membrane.indicator import Indicator

WIDTH, LABEL = 120, 11  # characters of a printed line, and of what stands before it
RANKS = "first", "second", "third"
PLAIN = "plain"
COLOURED = ("stopped", "perforated", "unstable")
CLEAR = "no check beyond its limit"
TONE_OF_DOUBT = "doubtful"
_SHOWN: ContextVar[tuple[str, ...]] = ContextVar("doubts of the result that is shown", default=())


@dataclass(frozen=True)
class Mover:
    """What moves an answer.

    Parameters
    ----------
    what : in a few words
    settle : what to measure, give or run, with options as the command line names them
    moved : [m/s] by which it alone moves the answer; None if that was not computed
    sure : whether that number holds; else it tells the order alone
    """

    what: str
    settle: str = ""
    moved: float | None = None
    sure: bool = True

    def __str__(self) -> str:
        if self.moved is None or not self.sure:
            return self.what
        return f"{self.what} {self.moved:.3g} m/s"


@dataclass(frozen=True)
class Answer:
    """What a result came to.

    Parameters
    ----------
    subject : what was asked about
    value : the answer with its uncertainty
    doubts : what of it is doubtful, with numbers
    outcome : "stopped", "perforated" or "unstable", which colours it, or "depends"; "plain" does not
    over : what was run for it
    movers : what moves it, and what it leaves out
    advice : what to do first, with options as the command line names them
    near : checks within their limits that come near them
    listed : of an answer that is a list, the parts of each of its first lines, the most needed first
    """

    subject: str
    value: str
    doubts: tuple[str, ...] = ()
    outcome: str = PLAIN
    over: str = ""
    movers: tuple[Mover, ...] = ()
    advice: tuple[str, ...] = ()
    near: tuple[str, ...] = ()
    listed: tuple[tuple[str, ...], ...] = ()

    @property
    def tone(self) -> str:
        """The colour: what is doubtful is neither green nor red."""
        if (self.doubts or self.outcome == DEPENDS) and self.outcome != "unstable":
            return TONE_OF_DOUBT
        return self.outcome if self.outcome in COLOURED else PLAIN

    @property
    def ranked(self) -> list[Mover]:
        """What moves it, the most first; then what was not computed."""
        return sorted(
            self.movers, key=lambda one: -1 if one.moved is None else one.moved, reverse=True
        )

    @property
    def rows(self) -> list[tuple[str, str]]:
        """(what a user asks, the answer to it), seven at most."""
        moved = [one for one in self.ranked if one.moved is not None]
        advice = (*self.advice, *(one.settle for one in self.ranked if one.moved != 0))
        found = {
            "answer": f"DOUBTFUL: {self.value}" if self.doubts else self.value,
            **{rank: join_parts(parts, "; ", "") for rank, parts in zip(RANKS, self.listed)},
            "over": join_parts(self.over.split(", "), ", "),
            "moved by": join_parts(moved, ", "),
            "leaves out": join_parts([one for one in self.movers if one.moved is None], "; "),
            "doubts": join_parts(self.doubts, "; ") or join_parts((CLEAR, *self.near), "; near: "),
            "next": join_parts([*dict.fromkeys(filter(None, advice))][:3], "; ", ""),
        }
        return [(label, name_options(words)) for label, words in found.items() if words]

    def lines(self, folder: Path | None = None) -> list[str]:
        """Write the eight lines that are printed; the last says where the files are."""
        rows = self.rows
        if folder is not None:
            page = folder / "report.html"
            rows.append(("files", str(page if page.is_file() else folder)))
        return [self.subject, *(f"{label:<{LABEL}} {words}" for label, words in rows)]

    def entry(self) -> dict[str, Any]:
        """Return it as plain types, for a JSON file; an answer that is a list is written as such."""
        entry = asdict(self)
        if not self.listed:
            del entry["listed"]
        return entry

    @classmethod
    def read(cls, entry: dict[str, Any]) -> Self:
        """Return the Answer of an entry of a JSON file."""
        movers = tuple(Mover(**one) for one in entry["movers"])
        texts = {name: tuple(entry[name]) for name in ("doubts", "advice", "near")}
        texts["listed"] = tuple(map(tuple, entry.get("listed", ())))
        return cls(**(entry | texts | {"movers": movers}))

    @property
    def line(self) -> str:
        """Subject and value, without what is doubtful."""
        return f"{self.subject}: {self.value}"

    def __str__(self) -> str:
        return mark(self.line, self.doubts)


def join_parts(parts: Iterable[object], mark: str, more: str = "{} more") -> str:
    """Return those of several things that a line takes, the first at least, and how many others there are."""
    listed = [*map(str, parts)]
    # room for the number of the others
    room = WIDTH - LABEL - 1 - len(mark + more.format(99))
    if len(mark.join(listed)) <= WIDTH - LABEL - 1:
        return mark.join(listed)
    shown = listed[:1]
    for part in listed[1:]:
        if len(mark.join([*shown, part])) <= room:
            shown.append(part)
    rest = [more.format(len(listed) - len(shown))] if more else []
    return mark.join([*shown, *rest])


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
