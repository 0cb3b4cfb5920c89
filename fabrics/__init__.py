"""What a woven fabric is: yarn, weave, compression law, response surface, catalogue, units and errors.

The public names are loaded when they are first used.
"""

from __future__ import annotations

import importlib
from typing import Any

__version__ = "0.2.0"

__all__ = [
    "CompressionLaw",
    "DoubtfulError",
    "Fabric",
    "InputError",
    "PlateCurve",
    "ResponseSurface",
    "SolidLaw",
    "TrellisShear",
    "UndecidedError",
    "UnstableError",
    "Weave",
    "WeavecellError",
    "WeavingDamage",
    "Yarn",
    "list_names",
    "load",
]

# Public name: its module, and its name there. For callers alone: no module of ours takes these names from here, so
# that no digest of code follows them.
_NAMES = {
    "list_names": ("fabrics.catalogue", "list_names"),
    "load": ("fabrics.catalogue", "load"),
    "CompressionLaw": ("fabrics.compression", "CompressionLaw"),
    "DoubtfulError": ("fabrics.errors", "DoubtfulError"),
    "InputError": ("fabrics.errors", "InputError"),
    "UndecidedError": ("fabrics.errors", "UndecidedError"),
    "UnstableError": ("fabrics.errors", "UnstableError"),
    "WeavecellError": ("fabrics.errors", "WeavecellError"),
    "Fabric": ("fabrics.fabric", "Fabric"),
    "PlateCurve": ("fabrics.plate_curve", "PlateCurve"),
    "SolidLaw": ("fabrics.solid", "SolidLaw"),
    "ResponseSurface": ("fabrics.surface", "ResponseSurface"),
    "TrellisShear": ("fabrics.trellis", "TrellisShear"),
    "Weave": ("fabrics.weave", "Weave"),
    "WeavingDamage": ("fabrics.yarn", "WeavingDamage"),
    "Yarn": ("fabrics.yarn", "Yarn"),
}


def __getattr__(name: str) -> Any:
    if name not in _NAMES:
        raise AttributeError(f"module 'fabrics' has no attribute {name!r}")
    module, attribute = _NAMES[name]
    return getattr(importlib.import_module(module), attribute)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
