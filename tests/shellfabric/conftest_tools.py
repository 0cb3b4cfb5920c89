"""Helpers to put a panel into a given shape and to read its nodal forces."""

import numpy as np

from shellfabric.panel import step_kernels as panel_step_kernels


def bring(panel, state, x):
    """Move the nodes to x (ni+1, nj+1, 3), all at once and at rest, and find the forces."""
    X, Y = panel.coordinates()
    rest = np.stack([X, Y, np.zeros_like(X)], axis=-1)
    for c in range(3):
        state.u[c][: X.size] = (x - rest)[..., c].ravel()
    panel_step_kernels.initial_forces(state, panel.constants(), panel.work())
    return state


def node_forces(panel, state):
    """(ni+1, nj+1, 3) [N] forces of the cloth on its nodes."""
    ni, nj = panel.counts
    f = np.array(state.f_int) + np.array(state.f_int_above)
    return np.moveaxis(f[:, : (ni + 1) * (nj + 1)].reshape(3, ni + 1, nj + 1), 0, -1)
