"""Figures as data: what is drawn against what, and one function that draws it.

A figure says its axes by keys of results/keys.toml and lists its layers from the back to the front.
Layers are plain: each has its label and its numbers, so that a test or another page reads them
without drawing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from weavecell.report.pictures_style import FAINT, legend_below
from weavecell.results import display, keys


@dataclass(frozen=True)
class Layer:
    """A layer of a figure.

    Parameters
    ----------
    label : in the legend; "" of none
    x, y : [SI] of points, or of a curve; a band or a line across has x alone: both ends, or one
    mark : "" of a curve, or a mark of matplotlib
    look : of matplotlib: colour, width
    """

    label: str
    x: Sequence[float]
    y: Sequence[float] | None = None
    mark: str = ""
    look: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Plot:
    """A figure.

    Parameters
    ----------
    title : above it
    x, y : keys of the axes
    layers : from the back to the front
    xlim, ylim : [SI]
    diagonal : label of the line y = x; "" of none
    """

    title: str
    x: str
    y: str
    layers: tuple[Layer, ...]
    xlim: tuple[float, float]
    ylim: tuple[float, float]
    diagonal: str = ""

    def draw(self, pyplot: Any) -> Any:
        """Draw it with matplotlib."""
        x, y = keys.infer_key(self.x), keys.infer_key(self.y)
        across, up = (display.choose_unit(key.unit)[1] for key in (x, y))
        figure, axes = pyplot.subplots(figsize=(5.6, 5))
        axes.set(xlabel=x.label, ylabel=y.label)
        axes.set(xlim=[across * end for end in self.xlim], ylim=[up * end for end in self.ylim])
        if self.diagonal:
            ends = [across * end for end in self.xlim]
            axes.plot(ends, ends, color=FAINT, lw=1, ls=":", label=self.diagonal)
        for layer in self.layers:
            looks = {"label": layer.label or None, **layer.look}
            places = [across * place for place in layer.x]
            if layer.y is not None:
                heights = [up * height for height in layer.y]
                axes.plot(places, heights, *filter(None, [layer.mark]), **looks)
            elif len(places) == 2:
                axes.axvspan(*places, **looks)
            else:
                axes.axvline(*places, **looks)
        legend_below(axes, columns=1)
        return figure
