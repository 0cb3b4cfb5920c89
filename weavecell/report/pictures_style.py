"""One palette for all pictures, which is distinct for colour-blind readers (Okabe and Ito,
2008)."""

from __future__ import annotations

from typing import Any

INK = "#1d2733"
FAINT = "#8a94a0"
# of what is doubtful, as in the pages
DOUBT = "#7a5c00"
BLUE = "#0072B2"
ORANGE = "#E69F00"
GREEN = "#009E73"
RED = "#D55E00"
PURPLE = "#CC79A7"
SKY = "#56B4E9"

WARP = BLUE
WEFT = RED
# tints of the same colours, for solids under a light
TINTS = {"warp": "#3d93c8", "weft": "#e27a3a"}
FITTED = BLUE
PUBLISHED = ORANGE
COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY)
STEEL = "#7c8794"
CLAY = "#c9a77c"

# of tensions in 3D pictures: light grey where nothing happens, even steps of lightness down to a
# dark blue
TENSIONS = ("#eceff2", "#b5d5e6", "#6bb0d0", "#2b83ba", "#1a4f92", "#0b1a4a")
DASHES = ("-", "--", "-.", ":")


def legend_beside(axes: Any, **looks: Any) -> None:
    """Place the legend of some axes at their right, outside of the curves."""
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), **looks)


def legend_below(axes: Any, columns: int = 2, **looks: Any) -> None:
    """Place the legend of some axes below all of the figure, which a phone shows as wide as itself."""
    listed = axes.get_legend_handles_labels()
    axes.figure.legend(*listed, loc="outside lower center", ncols=columns, **looks)


def tension_map() -> Any:
    """Return the colour map of tensions."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("tension", TENSIONS)
