"""The front door: commands, scene files, the walk of the data from fabric to impact, pictures and reports.

Python interface, loaded when it is first used:

    import weavecell as wc

    fabric = wc.fabric("S-720")
    shot = wc.impact(fabric, "92.5 m/s")
    print(shot.outcome, shot.to_dataframe())
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

for _name in ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation"):
    _found = importlib.util.find_spec(_name)
    if _found is not None and _found.origin and Path(_found.origin).parent.parent != Path(__file__).parent.parent:
        raise ImportError(
            f"{_found.origin} hides the package {_name} of weavecell, which has the same name: "
            "rename it, or run from another folder"
        )

from fabrics import lazy  # noqa: E402

__getattr__, __dir__ = lazy.public(__name__, __file__)
