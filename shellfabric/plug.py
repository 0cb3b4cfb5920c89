"""Has the projectile left the held cloth behind? A plug that is cut out may fly on before it.

The kernels call a panel perforated when nothing pushes and nothing is left ahead of the nose. Cut-out cloth can stay
there for good, ridden by the projectile or faster than it, so that the march asks at its audits what holds what: cloth
that hangs together with an edge of the panel, over elements that share a node and have not eroded, is held; the rest
is a plug, and does not count.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label

from shellfabric.contact_kernels import in_the_way
from shellfabric.membrane_kernels import ERODED

_SHARED_NODE = np.ones((3, 3), bool)


def held(state, const):
    """(ni, nj) bool: elements that have not eroded and hang together with an edge of the panel."""
    cloth = (_by_element(state.flag, const) & ERODED) == 0
    pieces, _ = label(cloth, _SHARED_NODE)
    outer = [pieces[-1, :], pieces[:, -1]]
    outer += [] if const.mirror_x else [pieces[0, :]]
    outer += [] if const.mirror_y else [pieces[:, 0]]
    return cloth & np.isin(pieces, np.unique(np.concatenate(outer)))


def passed(state, const, work):
    """Whether no held element is ahead of the nose; `work` is the kernels' scratch."""
    flag = state.flag.copy()
    _by_element(flag, const)[~held(state, const)] |= ERODED
    return not in_the_way(state._replace(flag=flag), const, work.x, work.v)


def _by_element(flag, const):
    return flag[: const.ni * const.s].reshape(const.ni, const.s)[:, :-1]
