"""Warnings at the line of the user."""

from __future__ import annotations

import inspect
import warnings
from pathlib import Path

# folder of all packages of ours; tests and examples beside them are users
_ROOT = Path(__file__).parents[2]
_PACKAGES = tuple(
    f"{_ROOT / name}/" for name in ("fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell")
)


def warn_user(message: str, category: type[Warning] = UserWarning) -> None:
    """Warn at the line that called a package of ours, however many functions lie between."""
    frames = inspect.stack(0)
    line_of_the_user = next(
        n for n, frame in enumerate(frames) if not frame.filename.startswith(_PACKAGES)
    )
    warnings.warn(message, category, stacklevel=line_of_the_user + 1)
