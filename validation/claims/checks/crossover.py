"""The 3D crossover against the shell's cell and against what the thesis says of it (chapter 3, section 4.3.4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from shellfabric.cell.model import CellModel
from validation.claims.judge import Found


def fitted(*paths: Any) -> CompressionLaw:
    """CompressionLaw fitted to paths as `unitcell3d.identify.calibrate` does: at equal shares of each displacement."""
    F, d = [], []
    for path in paths:
        shares = np.linspace(0, path.path[-1], 26)[1:]
        force, depth = (np.interp(shares, path.path, values) for values in (path.F_c, path.d_c))
        F.append(force[force > 0])
        d.append(depth[force > 0])
    return CompressionLaw.fit(np.concatenate(F), np.concatenate(d))


def cell_along(path: Any, fabric: str, law: CompressionLaw | None = None) -> Found:
    """The cell with its published law, or another, along a warp extension of the crossover: largest differences of the
    tensions over their peaks, and of the energy from the work of the ends, 2 T1 dd1, over that at the end."""
    given, d, T = catalogue.load(fabric), path.d1, path.T1
    cell = CellModel(given, None if law is None else (law, law)).solve(1 + d / given.weave.w1, 1.0)
    work = np.concatenate([[0], np.cumsum(np.diff(d) * (T[1:] + T[:-1]))])
    return {
        "warp": float(np.abs(cell["T1"] - T).max() / T.max()),
        "weft": float(np.abs(cell["T2"] - path.T2).max() / path.T2.max()),
        "energy": (np.abs(cell["W"] - work) / work.max()).max(),
    }


def cell_error(path: Any, fabric: str, profile: str) -> float:
    """RMS of both tensions of the cell with cosine or straight yarns less those of the 3D crossover, over the
    strengths, along a path of the crossover up to the cell's first failure."""
    given = catalogue.load(fabric)
    cell = CellModel(given, form="equilibrium", profile=profile)
    found = cell.solve(*(1 + d / w for d, w in zip((path.d1, path.d2), given.weave.w)))
    both = list(zip((found["T1"], found["T2"]), (path.T1, path.T2), given.weave.yarns))
    sound = np.all([T <= yarn.strength for T, _, yarn in both], axis=0)
    return float(np.sqrt(np.mean(np.square([(T - given) / yarn.strength for T, given, yarn in both])[:, sound])))


def off_cosine(line: Any) -> float:
    """RMS distance of a deformed centreline from the cosine of its height and length, over the height."""
    x, z = line
    h = z[0] - z[-1]
    return float(np.sqrt(np.mean((z - z[-1] - h * np.cos(0.5 * np.pi * x / x[-1])) ** 2)) / h)
