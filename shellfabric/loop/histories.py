"""Histories along chosen yarns and at the edges: recorded while a run goes on, nothing else being
kept.

A yarn is one row of elements along warp or weft, chosen by its distance from the impact point.
Recorded at every instant are the tension in its elements, where its nodes are along its own
direction, and how far they are deflected; at each edge of the panel the force of the fabric on the
nodes there, which where they are held is the reaction; of a ply in a pack, with the force of its
neighbours on these nodes.

A recording is a list of rows of numbers (`PackSolver.histories`), so that checkpoints can keep it;
`unpack` gives it back its names. Of a pack the same is recorded of every ply, or of the plies that
are named.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray, refuse
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields
from fabrics.base.frozen import explain_frozen
from shellfabric.loop.cone import find_foot
from shellfabric.loop.history_keys import HistoryKeys
from shellfabric.loop.hooks import Every
from shellfabric.loop.snapshots import yarn_tensions
from shellfabric.membrane.slots import by_node
from shellfabric.projectile.frames import axes

if TYPE_CHECKING:
    from shellfabric.membrane.model import Panel

FAMILIES = ("warp", "weft")
EDGES = (
    "warp_high",
    "warp_low",
    "weft_high",
    "weft_low",
)  # at highest and lowest x, at highest and lowest y
PULL = 0
LIFT = 1


@explain_frozen
@dataclass(frozen=True)
class HistoryRequest(HistoryKeys):
    """What to record.

    Parameters
    ----------
    interval : [s] between records
    warp, weft : (n,) [m] distances from the impact point, across the family, of the yarns to follow
    plies : numbers of the plies of a pack to follow, the first is 1; None for all

    Raises
    ------
    InputError : an interval that is not positive, a distance that is not a number, plies that are
        no numbers of plies
    """

    plies: tuple[int, ...] | None = None

    def __post_init__(self):
        check_fields(self)
        if self.plies is not None and (not self.plies or min(self.plies) < 1):
            refuse(self, "plies", "numbers of plies, the first is 1")

    def chosen(self, count: int) -> Sequence[int]:
        """Return the indices of the plies to follow of a pack of `count`; InputError for a ply that
        it has not."""
        if self.plies is not None and max(self.plies) > count:
            refuse(self, "plies", f"1 to {count}")
        if self.plies is None:
            return range(count)
        return [ply - 1 for ply in self.plies]


@dataclass(frozen=True)
class YarnHistory:
    """One yarn through time. Positions along it count from the impact point.

    Parameters
    ----------
    family : "warp" or "weft"
    offset : [m] of the middle of its row of elements, across the family
    EA, strength : [N]
    crimp : [-]
    X : (n,) [m] middles of its elements at rest
    tension : (samples, n) [N]
    place : (samples, n+1) [m] of its nodes, along the family
    deflection : (samples, n+1) [m]
    """

    family: str
    offset: float
    EA: float
    strength: float
    crimp: float
    X: np.ndarray
    tension: np.ndarray
    place: np.ndarray
    deflection: np.ndarray

    @property
    def strain(self) -> FloatArray:
        """(samples, n) [-] of the fibre."""
        return self.tension / self.EA

    @property
    def cone_radius(self) -> FloatArray:
        """(samples,) [m] from the impact point to the foot of the cone, on the side of positive places:
        how far the transverse wave has come; not a number before there is a cone (`cone.find_foot`)."""
        spacing = self.X[1] - self.X[0]
        profiles = zip(self.place, self.deflection)
        return np.array([find_foot(x, z, spacing) for x, z in profiles])

    def element_at(self, distance: float) -> int:
        """Find the number of the element that lies nearest a distance [m] from the impact point."""
        return int(np.argmin(np.abs(self.X - distance)))


@dataclass(frozen=True)
class Histories:
    """A recording.

    Parameters
    ----------
    t : (samples,) [s]
    yarns : tuple of YarnHistory
    edges : {name of EDGES: (samples, 2)} [N] force of the fabric on an edge of the whole panel:
        pull inwards, and lift along the flight of the projectile
    """

    t: np.ndarray
    yarns: tuple[YarnHistory, ...]
    edges: dict

    def through(self, family: str) -> YarnHistory | None:
        """Return the yarn of a family that is nearest the impact point."""
        return min(
            (yarn for yarn in self.yarns if yarn.family == family),
            key=lambda y: abs(y.offset),
            default=None,
        )


class Recorder(Every):
    """Keep a row every interval, in solver.histories.

    Parameters
    ----------
    plies : Panels of the run, the one that is struck first
    measure : HistoryRequest

    Raises
    ------
    InputError : a yarn that is not on the panel, a ply that is not in the pack
    """

    def __init__(self, plies: Sequence[Panel], measure: HistoryRequest) -> None:
        super().__init__(measure.interval)
        self.chosen = measure.chosen(len(plies))
        self.what = [(rows(plies[p], measure), edge_nodes(plies[p])) for p in self.chosen]

    def __call__(self, solver: Any) -> None:
        if self.due(solver) and not solver.fabric_ended:
            parts = [
                _record(*solver.plies[p], yarns, sides, solver.neighbour_forces(p))  # type: ignore[call-arg]
                for p, (yarns, sides) in zip(self.chosen, self.what)
            ]
            solver.histories.append(np.concatenate([[solver.time], *parts]))


def rows(panel: Panel, measure: HistoryRequest) -> list[tuple[str, int, int]]:
    """List (family, row of elements, row of nodes) of every yarn to follow.

    On a mirrored panel the yarn at -y is the one at y.

    Raises
    ------
    InputError : a yarn that is not on the panel
    """
    found = []
    for family, mirrored, lines in zip(FAMILIES, panel.mirrors[::-1], panel.lines()[::-1]):
        count = lines.size - 1
        slack = 1e-9 * (lines[-1] - lines[0])
        for distance in getattr(measure, family):
            place = distance
            if mirrored:
                place = abs(distance)
            if not lines[0] - slack <= place <= lines[-1] + slack:
                allowed = f"at most {1e3 * lines[-1]:.4g} mm from the impact point"
                raise InputError(key=family, value=distance, allowed=allowed)
            position = float(np.interp(place, lines, np.arange(count + 1)))
            found.append((family, min(int(position), count - 1), round(position)))
    return found


def _record(panel, c, state, chosen, sides, neighbours):
    """Numbers of one ply: tension, places and deflections of each yarn, then the edges' forces."""
    tension = yarn_tensions(c, state)
    u = [by_node(component, c) for component in state.u]
    parts = []
    for family, element, node in chosen:
        axis = FAMILIES.index(family)
        across = 1 - axis
        rest = panel.lines()[axis]
        parts.append(tension[..., axis].take(element, across))
        parts.append(rest + u[axis].take(node, across))
        parts.append(u[2].take(node, across))
    return np.concatenate([*parts, _edge_forces(state, sides, neighbours).ravel()])


def _edge_forces(state, sides, neighbours):
    """(4, 2) [N] pull and lift at the edges, as EDGES names them; neighbours : forces that other
    plies add there."""
    forces = np.empty((4, 2))
    for number, (nodes, weights, normal) in enumerate(sides):
        nodal = [a[nodes] + b[nodes] for a, b in zip(state.f_int, state.f_int_above)]
        for others in neighbours:
            nodal = [total + force[nodes] for total, force in zip(nodal, others)]
        f = [sums.dot(weights, force) for force in nodal]
        forces[number] = -normal[0] * f[0] - normal[1] * f[1], f[2]
    return forces


def edge_nodes(panel: Panel) -> list[tuple[IntArray, FloatArray, FloatArray]]:
    """Return (node numbers, weights, outward normal) of the panel's sides, as EDGES names them.

    A mirrored side is its mirror's. Weights complete the panel by symmetry; a corner counts half to
    each of its sides. Where the edge is a staircase (`PanelGrid.stepped`) its sides are the held
    nodes, each with the side of the opening that it is nearest to.
    """
    shape = tuple(n + 1 for n in panel.counts)
    numbers = np.arange(shape[0] * shape[1]).reshape(shape)
    mirrored = [False, panel.mirrors[0], False, panel.mirrors[1]]
    if panel.stepped:
        on, normals = _stepped_sides(panel)
    else:
        on = np.zeros((4, *shape), bool)
        normals = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])
        for side, line, missing in zip(
            on, (np.s_[-1, :], np.s_[0, :], np.s_[:, -1], np.s_[:, 0]), mirrored
        ):
            side[line] = not missing
    share = np.where(on, 1 / panel.share / np.maximum(on.sum(axis=0), 1), 0.0)
    # a side whose opposite is its mirror stands for both: half of what its weight completes
    for k in range(4):
        if panel.mirrors[k // 2]:
            share[k] *= 0.5
    sides = [(numbers[side], part[side], normal) for side, part, normal in zip(on, share, normals)]
    for k in range(4):
        if mirrored[k]:
            sides[k] = sides[k - 1]
    return sides


def _stepped_sides(panel):
    """((4, ni+1, nj+1) held nodes of each side, (4, 2) outward normals) of a panel with a staircase
    for an edge."""
    c, s = axes(panel.weave_angle)[0]
    x, y = panel.in_frame() / (0.5 * np.array(panel.opening))[:, None, None]
    nearest = np.where(np.abs(x) > np.abs(y) - 1e-9, np.where(x > 0, 0, 1), np.where(y > 0, 2, 3))
    return ~panel.loose() & (nearest == np.arange(4)[:, None, None]), np.array(
        [(c, -s), (-c, s), (s, c), (-s, -c)]
    )


def unpack(
    recording: Sequence[FloatArray], plies: Sequence[Panel], measure: HistoryRequest
) -> tuple[Histories, ...]:
    """Name the numbers of a recording, a list of rows: the Histories of each ply that has been
    followed."""
    table = np.array(recording)
    at = 1

    def take(count):
        nonlocal at
        at += count
        return table[:, at - count : at]

    return tuple(
        _unpacked(table[:, 0], take, plies[p], measure) for p in measure.chosen(len(plies))
    )


def _unpacked(
    t: FloatArray, take: Callable[[int], FloatArray], panel: Panel, measure: HistoryRequest
) -> Histories:
    """Histories of one ply; take(count) gives the next columns of the recording."""
    weave = panel.weave
    lines = panel.lines()
    yarns = []
    for family, element, _ in rows(panel, measure):
        number = FAMILIES.index(family)
        yarn = weave.yarns[number]
        strength = panel.strengths[number]
        if family == "warp":
            own, other = lines
        else:
            own, other = lines[::-1]
        offset = 0.5 * (other[element] + other[element + 1])
        X = 0.5 * (own[:-1] + own[1:])
        known = family, float(offset), yarn.EA, strength, yarn.crimp, X
        yarns.append(YarnHistory(*known, take(own.size - 1), take(own.size), take(own.size)))
    edges = {name: take(2) for name in EDGES}
    return Histories(t, tuple(yarns), edges)
