"""One self-contained HTML page from an answer, sections, figures and tables: no file beside it, nothing
fetched.

This file knows how a report is built and nothing of mechanics; `chapters.py` turns results into its
parts.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from html import escape
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.extras import explain_missing
from weavecell.results import glossary

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.results.finding import Answer

_MIME = {"svg": "image/svg+xml", "png": "image/png", "gif": "image/gif"}


@dataclass(frozen=True)
class Figure:
    """A picture held in the page."""

    content: bytes
    kind: str  # "svg", "png" or "gif"
    caption: str
    name: (
        str  # of its file, where it is written as one; also the text for readers who cannot see it
    )
    wide: bool = True
    tall: bool = False  # as two others that stand beside it

    @property
    def uri(self) -> str:
        return f"data:{_MIME[self.kind]};base64,{base64.b64encode(self.content).decode('ascii')}"


@dataclass(frozen=True)
class Table:
    """Rows of texts under a heading; columns named in `numeric` are set flush right, and `tips` say
    more of a heading, such as its key."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    numeric: tuple[str, ...] = ()
    tips: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def from_frame(cls, frame: DataFrame, caption: str = "", numeric: Iterable[str] = ()) -> Table:
        """Make the table of a frame, numbers with four digits; `numeric` are columns of texts that
        are numbers."""
        rows = frame.itertuples(index=False, name=None)
        texts = tuple(
            tuple(f"{v:.4g}" if isinstance(v, float) else str(v) for v in row) for row in rows
        )
        return cls(tuple(frame), texts, caption, (*frame.select_dtypes("number"), *numeric))


@dataclass(frozen=True)
class Section:
    """A chapter of the page: a lead sentence, then figures and tables."""

    key: str
    title: str
    lead: str = ""
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    points: tuple[str, ...] = ()  # sentences below the pictures
    details: tuple[tuple[str, str], ...] = ()  # (title, verbatim text), folded
    beside: bool = False  # the tables stand beside the figures
    folded: bool = False  # opened by a click
    moving: str = ""  # JSON of the arrays that templates/view3d.js draws
    pair: tuple[tuple[str, str], ...] = ()  # (title, JSON as of `moving`) of two, under one slider


@dataclass(frozen=True)
class Report:
    """The whole page."""

    answer: Answer
    subtitle: str
    sections: tuple[Section, ...]
    footer: str = ""
    beside: tuple[Figure, ...] = ()  # picture beside the answer

    @property
    def title(self) -> str:
        """Of the page."""
        return self.answer.subject


@explain_missing()
def render(report: Report) -> str:
    """Render the page as text."""
    import jinja2
    import markupsafe

    folder = resources.files("weavecell.report") / "templates"
    loader = jinja2.FunctionLoader(lambda name: (folder / name).read_text("utf-8"))
    environment = jinja2.Environment(
        loader=loader,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    words = glossary.Marker(markupsafe.Markup)
    environment.filters["explained"] = words.mark
    return environment.get_template("report.html.j2").render(report=report, words=words)


def write(report: Report, path: FilePath) -> None:
    """Write the page, whole or not at all."""
    files.write(path, render(report))


class Embedded:
    """A page as a notebook shows it, in a frame of its own."""

    def __init__(self, report: Report) -> None:
        self.html = render(report)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.html)}" style="width: 100%; height: 52rem; border: 0"></iframe>'


def write_pictures(sections: Iterable[Section], folder: Path) -> None:
    """Write the pictures of the sections as files of their own, named after what they show."""
    for section in sections:
        for figure in section.figures:
            files.write(folder / f"{figure.name}.{figure.kind}", figure.content)
