"""The yarns of a TexGen file as arrays. A program of its own: TexGen writes to stdout and crashes on some files.

    python worker.py FILE.tg3 OUT.npz

In the file's unit of length, which OUT holds as a text. Exit code 4: no unit cell could be read.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytexgen as texgen

NODES, POINTS = 50, 240  # of a path between two of its master nodes, of a section
UNREADABLE = 4


def _xyz(vectors):
    return np.array([(v.x, v.y, v.z) for v in vectors])


def _yarn(yarn, textile):
    """{name: array} of one yarn: path, section and axes at each of n nodes, repeats, fibres (0 where not given)."""
    yarn.SetResolution(NODES * (yarn.GetNumNodes() - 1) + 1, POINTS)
    nodes = yarn.GetSlaveNodes(yarn.SURFACE)
    fibres = [
        getattr(yarn, name)(unit) or getattr(textile, name)(unit)
        for name, unit in (("GetYarnLinearDensity", "kg/m"), ("GetFibreDensity", "kg/m^3"), ("GetFibreArea", "m^2"))
    ]
    return {
        "path": _xyz(node.GetPosition() for node in nodes),
        "side": _xyz(node.GetSide() for node in nodes),
        "up": _xyz(node.GetUp() for node in nodes),
        "section": np.array([[(p.x, p.y) for p in node.Get2DSectionPoints()] for node in nodes]),
        "repeats": _xyz(yarn.GetRepeats()),
        "fibres": np.array(fibres),
    }


def main(source: str, out: str) -> int:
    """Write the yarns of `source` to `out`; returns the exit code."""
    if not texgen.ReadFromXML(source):
        return UNREADABLE
    textiles = list(texgen.GetTextiles().values())
    if len(textiles) != 1:
        return UNREADABLE
    textile = textiles[0]
    found: dict[str, Any] = {"yarns": textile.GetNumYarns(), "unit": textile.GetGeometryScale()}
    for k in range(textile.GetNumYarns()):
        found |= {f"{name}{k}": array for name, array in _yarn(textile.GetYarn(k), textile).items()}
    np.savez(out, **found)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
