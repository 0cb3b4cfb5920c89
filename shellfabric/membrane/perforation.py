"""Perforation test: fabric that no intact yarn joins to the boundary (a plug) is not ahead of the
nose.

The kernels ask whether a panel is perforated when yarns have failed and next to nothing pushes.
Cut-out fabric can stay ahead of the nose for good, ridden by the projectile or faster than it, so that
the connection counts: nodes that unbroken yarn joins to an edge of the panel are held, and the
elements between them; the rest is a plug, and does not count.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import BoolArray
from shellfabric.membrane.slots import by_element, by_node
from shellfabric.projectile.window_kernels import cloth_ahead_of_nose
from shellfabric.state import ERODED

if TYPE_CHECKING:
    from shellfabric.state import Constants, State


def held(state: State, const: Constants) -> BoolArray:
    """Mark the elements, (ni, nj) bool, that have not eroded and whose nodes unbroken yarn joins to
    an edge of the panel."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    node = by_node(np.arange(state.mass.size), const)
    warp, weft = (by_node(intact, const) > 0 for intact in state.intact_fraction)
    near = np.concatenate([node[:-1][warp[:-1]], node[:, :-1][weft[:, :-1]]])
    far = np.concatenate([node[1:][warp[:-1]], node[:, 1:][weft[:, :-1]]])
    joined = coo_matrix((np.ones(near.size, bool), (near, far)), shape=(node.size, node.size))
    piece = connected_components(joined, directed=False)[1].reshape(node.shape)
    outer = [piece[-1], piece[:, -1]]
    if not const.mirror_x:
        outer.append(piece[0])
    if not const.mirror_y:
        outer.append(piece[:, 0])
    fast = np.isin(piece, np.unique(np.concatenate(outer)))
    left = (by_element(state.element_flag, const) & ERODED) == 0
    return left & fast[:-1, :-1] & fast[1:, :-1] & fast[:-1, 1:] & fast[1:, 1:]


def passed(state: State, const: Constants, held_elements: BoolArray | None = None) -> bool:
    """Tell whether no held element is ahead of the nose; `held_elements` is `held` of the state, if
    it is known."""
    if held_elements is None:
        held_elements = held(state, const)
    flag = state.element_flag.copy()
    by_element(flag, const)[~held_elements] |= ERODED
    return not cloth_ahead_of_nose(state._replace(element_flag=flag), const)


def nothing_ahead(state: State, const: Constants) -> bool:
    """Tell whether no element at all is ahead of the nose, not even a plug: a block behind it bears one."""
    return not cloth_ahead_of_nose(state, const)
