"""One look for all pictures: sizes, and a palette that is distinct for colour-blind readers (Okabe and Ito, 2008).

In the lowest package that draws, for all above it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

INK = "#1d2733"
FAINT = "#8a94a0"
BLUE = "#0072B2"
ORANGE = "#E69F00"
GREEN = "#009E73"
RED = "#D55E00"
PURPLE = "#CC79A7"
SKY = "#56B4E9"

WARP, WEFT = BLUE, RED
TINTS = {"warp": "#3d93c8", "weft": "#e27a3a"}  # of the same, for solids under a light
FITTED, PUBLISHED = BLUE, ORANGE
COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY)
STEEL = "#7c8794"

# of tensions in 3D pictures: light grey where nothing happens, even steps of lightness down to a dark blue
TENSIONS = ("#eceff2", "#b5d5e6", "#6bb0d0", "#2b83ba", "#1a4f92", "#0b1a4a")
DASHES = ("-", "--", "-.", ":")

_SETTINGS = {
    "font.family": "DejaVu Sans",
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
    "svg.fonttype": "path",
    "svg.hashsalt": "weavecell",
}


def tension_map() -> Any:
    """The colour map of tensions."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("tension", TENSIONS)


@contextmanager
def plots() -> Iterator[Any]:
    """Within the block figures get this project's look; yields what draws as pyplot does (`pictures_figure`)."""
    from matplotlib import rc_context

    from meshing import pictures_figure

    pictures_figure.StyledFigure.look = _SETTINGS
    with rc_context(_SETTINGS):
        yield pictures_figure
