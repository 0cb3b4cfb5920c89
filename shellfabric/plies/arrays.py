"""The arrays of the contact between the plies of a pack (`shellfabric.state.PackContact`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.jit.simd import WIDTH
from shellfabric.plies.frame_kernels import TALL, WIDE
from shellfabric.plies.near_kernels import NEAR, SLOTS
from shellfabric.state import Constants, PackContact, State

_PAIRS = 60  # room for pairs of tiles, of a tile in the mean
_ENTRIES = 20  # room for pairs of facets, of a node in the mean


def pack_contact(
    consts: Sequence[Constants],
    states: Sequence[State],
    rest: Sequence[FloatArray],
    thicknesses: Sequence[float],
    turns: FloatArray,
    **of_points: Any,
) -> PackContact:
    """The contact between plies at rest.

    Parameters
    ----------
    consts, states : of the plies
    rest : of each ply, (ni + 1, nj + 1, 3) [m] its nodes at rest in the frame of the first one
    thicknesses : (plies,) [m]
    turns : (plies, 2) cosine and sine of the angles from the first frame to those of the plies
    of_points : `points` along each side of an element; `first_point` (plies,), `closest_a` and
        `closest_b` of all points, `first_element` (plies,) and `area` of all elements; `laws`,
        `law_step` (`numerics.law_tables`), `friction`, `stick_damping` and `side_by_side` (plies,)
    """
    plies = len(consts)
    own = max(state.mass.size for state in states)
    shape = np.array([(c.nj + 3, c.ni, c.nj, c.mirror_x, c.mirror_y) for c in consts])
    slots = int(max((s[1] + 3) * s[0] for s in shape)) + 4 * WIDTH
    base = np.arange(plies) * slots + shape[:, 0] + 1
    nodes = plies * slots
    x, kick, mirror = _grids(consts, states, rest, shape, slots, base)
    down = np.array([-(-c.ni // TALL) for c in consts])
    across = np.array([-(-c.nj // WIDE) for c in consts])
    first = np.concatenate([[0], np.cumsum(down * across)])
    tiles = int(first[-1])
    none = np.zeros((plies, 4), np.int64)
    none_of_grid = np.zeros((plies, 2, 4), np.int64)
    none[:, 0] = shape[:, 1] + 1
    none[:, 2] = shape[:, 2] + 1
    none_of_grid[:] = none[:, None]
    return PackContact(
        x=x,
        rest=x.copy(),
        kick=kick,
        mirror=mirror,
        base=base,
        shape=shape,
        slots=slots,
        turns=turns,
        dt=float(consts[0].dt),
        window=none_of_grid.copy(),
        grid_window=none_of_grid,
        guard_window=none,
        thickness=np.array(thicknesses),
        thickest=float(max(thicknesses)),
        longest=max(
            float(np.linalg.norm(nodes[1:, 1:] - nodes[:-1, :-1], axis=-1).max()) for nodes in rest
        ),
        has_planes=bool(consts[0].mirror_x or consts[0].mirror_y),
        tile_ply=np.repeat(np.arange(plies), np.diff(first)),
        first_tile=first,
        tiles_across=across,
        order=np.arange(tiles),
        lanes=np.arange(float(WIDTH)),
        # pairs of tiles, of facets, rows, nodes of these, steps, whether all lists are to be made,
        # tiles that press
        count=np.array([0, 0, 0, 0, 1, 1, 0]),
        guard=np.array([0.0, 0.0, NEAR, 0.0]),
        **of_points,
        **_zeros("closed given touched", SLOTS, of_points["closest_a"].size),
        **_zeros("v y impulse", 3, nodes),
        **_zeros("f", plies, 2, 3, slots),
        **_zeros("force", plies, 2, 3, own),
        **_zeros("guard_force", plies, 3, own),
        **_zeros("energy", plies, 4),
        **_zeros("work", plies),
        **_zeros("cluster", nodes, 5),
        **_zeros("dropped torn", nodes, kind=np.uint8),
        **_zeros("node_step node_list root", nodes, kind=np.int64),
        **_zeros("failures", plies, kind=np.int64),
        **_zeros("travel way travel_then plane_due clearance", tiles),
        **_zeros("boxed looked_at covered open", tiles, kind=np.int64),
        **_zeros("holes", tiles, kind=np.uint8),
        **_zeros("pressed", tiles + _PAIRS * tiles, 2, kind=np.int64),
        **_zeros("box", tiles, 6),
        **_zeros("block_speed", plies, int(((down + 1) * (across + 1)).max())),
        **_lists(_ENTRIES * max(nodes, 20_000), nodes, _PAIRS * tiles),
    )


def _grids(consts, states, rest, shape, slots, base):
    """Places of nodes and ghosts (3, plies slots), dt over mass, and planes of symmetry of the
    nodes (plies slots)."""
    nodes = len(consts) * slots
    x = np.zeros((3, nodes))
    kick = np.zeros(nodes)
    mirror = np.zeros(nodes, np.uint8)
    for p, (const, state, places) in enumerate(zip(consts, states, rest)):
        grid = np.pad(places, ((1, 1), (1, 1), (0, 0)))
        for axis, mirrored in enumerate((const.mirror_x, const.mirror_y)):
            lines = np.moveaxis(grid, axis, 0)
            lines[0], lines[-1] = 2 * lines[1] - lines[2], 2 * lines[-2] - lines[-3]
            if mirrored:
                lines[0] = lines[2] * np.where(np.arange(3) == axis, -1, 1)
        x[:, p * slots :][:, : grid[..., 0].size] = grid.reshape(-1, 3).T
        numbers = base[p] + np.add.outer(
            np.arange(const.ni + 1) * shape[p, 0], np.arange(const.row_stride)
        )
        kick[numbers] = state.dt_over_mass[: numbers.size].reshape(numbers.shape)
        mirror[numbers[0]] |= np.uint8(const.mirror_x)
        mirror[numbers[:, 0]] |= np.uint8(2 * const.mirror_y)
    return x, kick, mirror


def _lists(entries, nodes, pairs):
    """Room for pairs of tiles, for near facets, and for rows of all these and of nodes at the
    planes of symmetry."""
    rows = entries + 2 * nodes
    most = 4 * (TALL + 1) * (WIDE + 1)
    return {
        **_zeros("pair_tiles", pairs, 2, kind=np.int64),
        **_zeros("pair_due pair_seen", pairs),
        **_zeros("entry_nodes", entries, 6, kind=np.int32),
        **_zeros("entry_pair", entries, kind=np.int64),
        **_zeros("entry_end entry_due", entries),
        **_zeros("facets", 2, most, 3, kind=np.int64),
        **_zeros("facet_box", 2, most, 6),
        **_zeros("row_nodes", rows, 6, kind=np.int32),
        **_zeros("row_normal", rows, 3),
        **_zeros("row_need row_distance", rows),
    }


def _zeros(names, *shape, kind=float):
    """{name: zeros of a shape} of several arrays."""
    return {name: np.zeros(shape, kind) for name in names.split()}
