"""Arrays of slots as grids: a row of slots for each row of nodes (`membrane.membrane_kernels`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shellfabric.state import Constants


def by_node(slots: Any, const: Constants) -> Any:
    """Return the (ni+1, nj+1) view of an array that has a slot for each node."""
    return slots[: (const.ni + 1) * const.row_stride].reshape(-1, const.row_stride)


def by_element(slots: Any, const: Constants) -> Any:
    """Return the (ni, nj) view of an array that has a slot for each element."""
    return by_node(slots, const)[:-1, :-1]
