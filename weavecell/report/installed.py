"""Whether pages and pictures can be made: the packages that draw them come with an extra."""

from __future__ import annotations

import logging
from functools import cache

from fabrics.base import extras

DRAWING = ("matplotlib", "jinja2", "pyvista")


def can_draw() -> bool:
    """Say whether the packages that pages, pictures and ParaView series need are installed; tell the
    user once what to install if not: the numbers are written all the same."""
    missing = extras.find_missing(*DRAWING)
    if missing is not None:
        _tell(missing)
    return missing is None


@cache
def _tell(missing):
    line = f"numbers alone are written: pages, pictures and ParaView series need {missing}"
    if to_install := extras.how_to_install(missing):
        line += f"; {to_install}"
    logging.getLogger("weavecell").warning(line)
