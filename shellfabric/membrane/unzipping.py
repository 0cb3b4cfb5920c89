"""Whether the crossings of a panel of pinned yarns would hold what they carry.

Where a yarn is torn, a pinned crossing hands its whole tension to the yarn that crosses it, and the
next yarn gets it at once: the panel unzips. Yarns that can slip hand it over along many crossings. At a
node the yarns of a family pull by R_a, those of the other by R_b, and both have one motion: about half of
the difference goes from one to the other. Its part q in the plane of both yarns has to be friction, at
most mu F with the force F that presses them on each other (the cell's).

Where a grid line stands for a part of a yarn, q is that of the part, and F the whole yarn's: the share
that would slip is then a lower bound.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.membrane.slots import by_node, places_of_nodes
from shellfabric.state import Constants, State

LOADED = 0.1  # of the strength: tensions of both yarns of a crossing below it do not count


def slipping_crossings(panel: Any, const: Constants, state: State) -> tuple[int, int]:
    """Count the loaded crossings of a ply whose friction would not hold what they carry, and all loaded
    ones.

    Raises
    ------
    KeyError : a cell without the force between its yarns, that of a response surface
    """
    places = np.moveaxis(places_of_nodes(panel, const, state), -1, 0)
    pulls, carried, stretches, loads, directions = [], [], [], [], []
    for family in range(2):
        along = np.moveaxis(places, 1 + family, 1)
        tension = np.moveaxis(by_node(state.T[family], const), family, 0)[:-1]
        intact = np.moveaxis(by_node(state.intact_fraction[family], const), family, 0)[:-1]
        tension = np.where(intact > 0, tension, 0.0)
        edges = np.diff(along, axis=1)
        length = np.linalg.norm(edges, axis=0)
        force = tension * edges / length
        lines = panel.lines()[family]
        stretch = length / np.diff(lines)[:, None]
        inner = slice(1, -1)
        pulls.append(np.moveaxis(np.diff(force, axis=1), 1, 1 + family))
        means = {
            "load": np.maximum(tension[1:], tension[:-1]),
            "stretch": 0.5 * (stretch[1:] + stretch[:-1]),
            "carried": (intact[1:] > 0) & (intact[:-1] > 0),
        }
        loads.append(np.moveaxis(means["load"], 0, family))
        stretches.append(np.moveaxis(means["stretch"], 0, family))
        carried.append(np.moveaxis(means["carried"], 0, family))
        side = along[:, 2:] - along[:, :-2]
        directions.append(np.moveaxis(side / np.linalg.norm(side, axis=0), 1, 1 + family))
    cut = lambda x, family: x[..., :, inner] if family == 0 else x[..., inner, :]  # noqa: E731
    pull_a, pull_b = (cut(pull, family) for family, pull in enumerate(pulls))
    t_a, t_b = (cut(t, family) for family, t in enumerate(directions))
    load_a, load_b = (cut(load, family) for family, load in enumerate(loads))
    stretch_a, stretch_b = (cut(s, family) for family, s in enumerate(stretches))
    whole = cut(carried[0], 0) & cut(carried[1], 1)
    normal = np.cross(t_a, t_b, axis=0)
    normal /= np.linalg.norm(normal, axis=0)
    given = 0.5 * (pull_a - pull_b)
    shear = given - (given * normal).sum(axis=0) * normal
    q = np.sqrt((shear**2).sum(axis=0))
    strengths = [yarn.strength for yarn in panel.weave.yarns]
    loaded = np.maximum(load_a / strengths[0], load_b / strengths[1]) > LOADED
    loaded &= whole
    force = contact_force(panel.table, stretch_a[loaded], stretch_b[loaded])
    slip = q[loaded] > panel.friction_between_yarns * force
    return int(np.count_nonzero(slip)), int(np.count_nonzero(loaded))


def contact_force(table: Any, warp: FloatArray, weft: FloatArray) -> FloatArray:
    """Look up the force F (n,) [N] between the yarns of crossings at stretches (n,) of warp and weft."""
    values = table.values["F"]
    found = []
    for stretch, axis in ((warp, table.stretch1), (weft, table.stretch2)):
        at = (stretch - axis[0]) / (axis[1] - axis[0])
        found.append(np.clip(at, 0.0, axis.size - 1.000001))
    i, j = (at.astype(int) for at in found)
    a, b = found[0] - i, found[1] - j
    low = (1 - b) * values[i, j] + b * values[i, j + 1]
    high = (1 - b) * values[i + 1, j] + b * values[i + 1, j + 1]
    return np.asarray((1 - a) * low + a * high)


def yarns_under_the_nose(panel: Any) -> float:
    """Count the yarns of both families that the projectile's width covers."""
    return sum(2 * panel.projectile.radius / (2 * w) for w in panel.weave.w)
