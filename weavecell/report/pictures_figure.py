"""Figures in one look, made as by pyplot but outside of it: the user's backend and open figures
stay as they are."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib import cm, rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from weavecell.report.pictures_style import FAINT, INK

__all__ = ["Normalize", "StyledFigure", "cm", "figure", "plots", "subplots"]

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


class StyledFigure(Figure):
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
