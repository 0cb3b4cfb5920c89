"""The application: input files, studies, results and reports, as a Python interface and as
commands.

A module of the interface (`weavecell.api`) is loaded when one of its names is first used:

    import weavecell as wc

    fabric = wc.fabric("S-720")
    shot = wc.impact(fabric, "92.5 m/s")
    print(shot.outcome, shot.to_dataframe())
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

for _name in ("fabrics", "meshing", "unitcell3d", "shellfabric"):
    _found = importlib.util.find_spec(_name)
    if (
        _found is not None
        and _found.origin
        and Path(_found.origin).parent.parent != Path(__file__).parent.parent
    ):
        raise ImportError(
            f"{_found.origin} hides the package {_name} of weavecell, which has the same name: "
            "rename it, or run from another folder"
        )

# functions and commands of earlier versions: what to use instead
REMOVED = {
    "size_of": "use `impact` with check=True",
    "fit": "use scipy.optimize.least_squares (docs/coupons.md), or `reduce_tests` for the statistics of tests",
    "show_fabric": "use `show`",
    "show_projectile": "use `show`",
    "show_backing": "use `show`",
    "projectile": "give the keyword a dict: projectile={'name': 'FSP 1.10 g', 'obliquity': '30 deg'}",
    "patch": "resolved yarns judge whether crossovers may be pinned; `python -m validation patch` in a clone strikes "
    "solid yarns",
    "draws": "use `draw` and `run`, or impact with draws=16",
    "sensitivity": "use `measure_first`, or `sweep` over one key; examples/sobol_indices.py has Sobol indices",
}

if TYPE_CHECKING:
    from weavecell.api import *  # noqa: F403


def __getattr__(name: str) -> Any:
    """A public name, or the list of them."""
    import weavecell.api as api

    if name == "__all__":
        return dir(api)
    if name in dir(api):
        return getattr(api, name)
    if name in REMOVED:
        raise AttributeError(f"weavecell.{name} was removed: {REMOVED[name]}")
    raise AttributeError(f"module 'weavecell' has no attribute {name!r}")


def __dir__() -> list[str]:
    import weavecell.api as api

    return dir(api)
