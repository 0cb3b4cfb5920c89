"""Figures in one look, made as by pyplot but outside of it: the user's backend and open figures
stay as they are."""

from __future__ import annotations

import io
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib import cm, rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.text import Text

from weavecell.report.pictures_style import DOUBT, FAINT, INK
from weavecell.results import finding

__all__ = [
    "Normalize",
    "StyledFigure",
    "TitledFigure",
    "cm",
    "complete",
    "drawn",
    "figure",
    "plots",
    "say_doubts",
    "subplots",
]

# inch: of a line that names doubts, and of a letter in it
LINE = 0.24
LETTER = 0.1

_SETTINGS = {
    # the first measures all texts. A page holds texts, no outlines: where the first is missing, a
    # reader sees one of the others, of which Verdana is as wide
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
    "font.size": 12,
    "axes.titlesize": 13,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 12,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e6e9ed",
    "grid.linewidth": 0.9,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 11,
    "ytick.labelsize": 11,
    "text.color": INK,
    "legend.fontsize": 11,
    "legend.frameon": False,
    "lines.linewidth": 2.2,
    "lines.solid_capstyle": "round",
    "figure.dpi": 100,
    "savefig.dpi": 160,
    "figure.constrained_layout.use": True,
    "svg.fonttype": "none",
    "svg.hashsalt": "weavecell",
}


@contextmanager
def plots() -> Iterator[Any]:
    """Give figures this project's look in this block; yield this module, which draws as pyplot
    does."""
    with rc_context(_SETTINGS):
        yield sys.modules[__name__]


def complete(draw: Callable, *arguments: Any) -> Any:
    """Draw with `draw(pyplot, ...)`, and say in the picture what is doubtful of the result that is
    shown; inside `plots`."""
    made = draw(sys.modules[__name__], *arguments)
    say_doubts(made)
    return made


def drawn(draw: Callable, *arguments: Any) -> Any:
    """Draw as `complete` does, in the project's look."""
    with plots():
        return complete(draw, *arguments)


def say_doubts(made: TitledFigure) -> None:
    """Write above a figure what is doubtful of the result that is shown; nothing where nothing is."""
    doubts = finding.shown()
    if not doubts:
        return
    wide, high = made.get_size_inches()
    lines = textwrap.wrap(finding.name(doubts), int(wide / LETTER))
    room = LINE * len(lines) + 0.5 * LINE
    taller = high + room
    engine = made.get_layout_engine()
    made.set_size_inches(wide, taller)
    if isinstance(engine, ConstrainedLayoutEngine) and made.heading is not None:
        # it stays at the very top: doubts stand on the empty lines with which it then begins
        made.heading.set_text("\n" * len(lines) + made.heading.get_text())
    elif isinstance(engine, ConstrainedLayoutEngine):
        # what the engine lays out ends below the line
        engine.set(rect=(0, 0, 1, high / taller))
    for axes in made.axes if engine is None else ():
        left, bottom, width, height = axes.get_position(original=True).bounds
        axes.set_position((left, bottom * high / taller, width, height * high / taller))
    for text in made.texts:
        x, y = text.get_position()
        text.set_position((x, y * high / taller))
    made.text(
        LETTER / wide,
        1 - 0.25 * LINE / taller,
        "\n".join(lines),
        color=DOUBT,
        ha="left",
        va="top",
        weight="bold",
        fontsize=11,
    )


class TitledFigure(Figure):
    """A figure that knows the title above all its panels.

    Attributes
    ----------
    heading : matplotlib Text that the layout engine keeps at the very top; None without a title, or
        of one that has a place of its own
    """

    heading: Text | None = None

    def suptitle(self, t: str, **look: Any) -> Any:
        """Write a title above all panels, and keep it as the heading unless it gets a place."""
        made = super().suptitle(t, **look)
        if "y" not in look:
            self.heading = made
        return made


class StyledFigure(TitledFigure):
    """A figure that is drawn in the project's look wherever it is drawn, and that a notebook
    shows."""

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, **options)
        FigureCanvasAgg(self)

    def draw(self, renderer: Any) -> None:
        """Draw in this project's look: Figure makes ticks and their labels only now."""
        with plots():
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        self.canvas.print_png(content := io.BytesIO())  # type: ignore[attr-defined]
        return content.getvalue()


figure = StyledFigure


def subplots(
    rows: int = 1, columns: int = 1, *, figsize: Any = None, layout: Any = None, **axes: Any
) -> Any:
    """Make (figure, its axes), as pyplot does."""
    made = figure(figsize=figsize, layout=layout)
    return made, made.subplots(rows, columns, **axes)
