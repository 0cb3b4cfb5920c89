"""Arrays of slots as grids: a row of slots for each row of nodes (`membrane.membrane_kernels`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FloatArray

if TYPE_CHECKING:
    from shellfabric.state import Constants


def by_node(slots: Any, const: Constants) -> Any:
    """Return the (ni+1, nj+1) view of an array that has a slot for each node."""
    return slots[: (const.ni + 1) * const.row_stride].reshape(-1, const.row_stride)


def places_of_nodes(panel: Any, const: Constants, state: Any) -> FloatArray:
    """Return the places (ni+1, nj+1, 3) [m] of the nodes of a ply, in its own frame."""
    along, across = panel.coordinates()
    moved = [by_node(part, const) for part in state.u]
    return np.stack([along + moved[0], across + moved[1], moved[2]], axis=-1)


def by_element(slots: Any, const: Constants) -> Any:
    """Return the (ni, nj) view of an array that has a slot for each element."""
    return by_node(slots, const)[:-1, :-1]
