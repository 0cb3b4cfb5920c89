"""Words of the field, explained where they are printed: the words are in glossary.toml, and terminal,
notebook and report take them from here."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable
from functools import cache
from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from shellfabric.membrane.indicator import OK

if TYPE_CHECKING:
    from shellfabric.membrane.indicator import Indicator


@cache
def words() -> dict[str, str]:
    """Return {word: what it means}."""
    text = (resources.files("weavecell.results") / "glossary.toml").read_text("utf-8")
    return tomllib.loads(text)["words"]


@cache
def _pattern():
    """The words in a text, the longer of two first, with a capital, in capitals or with an s at
    will."""
    parts = []
    for word in sorted(words(), key=len, reverse=True):
        parts.append(re.escape(word))
        if word.islower():
            parts += [re.escape(word[0].upper() + word[1:]), re.escape(word.upper())]
    # parts of keys, such as solid.warp.E_c, are no words
    return re.compile(rf"(?<![\w.-])({'|'.join(parts)})(s?)(?!\w)")


def _word(found):
    """The word of the glossary that was found in a text."""
    text = found[1]
    return text if text in words() else text.lower()


def explain(text: str) -> dict[str, str]:
    """Return {word: what it means} of the words in a text, in their order."""
    found = map(_word, _pattern().finditer(text))
    return {word: words()[word] for word in dict.fromkeys(found)}


def lines(text: str, checks: Iterable[Indicator] = ()) -> list[str]:
    """Write a line about each word in a text, and about each quality check that is not ok."""
    named = {check.name: check.meaning for check in checks if check.status != OK and check.meaning}
    found = {word: means for word, means in explain(text).items() if word not in named}
    return [f"  {word}: {means}" for word, means in (found | named).items()]


def mark(text: str, explained: set[str] | None = None) -> str:
    """Write a text as HTML, in which each word has what it means as <abbr title>.

    Parameters
    ----------
    explained : words that were explained before, which stay as they are; those of the text are added
    """
    if explained is None:
        explained = set()
    parts = []
    end = 0
    for found in _pattern().finditer(text):
        word = _word(found)
        if word in explained:
            continue
        explained.add(word)
        means = escape(words()[word])
        parts.append(escape(text[end : found.start()]))
        parts.append(f'<abbr title="{means}">{escape(found[0])}</abbr>')
        end = found.end()
    return "".join((*parts, escape(text[end:])))


class Marker:
    """Marks the words of a page, each once in a section, and knows which it has.

    Parameters
    ----------
    safe : makes of HTML what a template takes as it is
    """

    def __init__(self, safe: Callable[[str], str]) -> None:
        self.safe = safe
        self.explained: set[str] = set()
        self.found: set[str] = set()

    def begin(self) -> str:
        """Begin a section, in which words are explained again."""
        self.explained = set()
        return ""

    def mark(self, text: object) -> str:
        """Write a text as HTML with its words explained."""
        marked = mark(str(text), self.explained)
        self.found |= self.explained
        return self.safe(marked)

    def listed(self) -> list[tuple[str, str]]:
        """Return (word, what it means) of all words of the page so far, by the alphabet."""
        return sorted(
            ((word, words()[word]) for word in self.found), key=lambda row: row[0].lower()
        )
