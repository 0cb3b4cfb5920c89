"""Figures as pyplot makes them, but outside of pyplot: its backend and the user's open figures stay as they are."""

from __future__ import annotations

import io
from typing import Any, ClassVar

from matplotlib import cm, rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

__all__ = ["Normalize", "StyledFigure", "cm", "figure", "subplots"]


class StyledFigure(Figure):
    """A figure that is drawn in the project's look wherever it is drawn, and that a notebook shows."""

    look: ClassVar[dict[str, Any]] = {}  # of `pictures_style.plots`

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, **options)
        FigureCanvasAgg(self)

    def draw(self, renderer: Any) -> None:
        """As of Figure: matplotlib makes ticks and their labels only now."""
        with rc_context(self.look):
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png")
        return content.getvalue()


figure = StyledFigure


def subplots(rows: int = 1, columns: int = 1, *, figsize: Any = None, layout: Any = None, **axes: Any) -> Any:
    """(figure, its axes) as of pyplot."""
    made = StyledFigure(figsize=figsize, layout=layout)
    return made, made.subplots(rows, columns, **axes)
