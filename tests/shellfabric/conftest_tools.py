"""Helpers to put a panel into a given shape, and to read and to check its nodal forces."""

import numpy as np
import pytest

from shellfabric.output import checkpoint
from shellfabric.solver import ply_kernels


def bring(panel, state, x):
    """Move the nodes to x (ni+1, nj+1, 3), all at once and at rest, and find the forces."""
    X, Y = panel.coordinates()
    rest = np.stack([X, Y, np.zeros_like(X)], axis=-1)
    for c in range(3):
        state.u[c][: X.size] = (x - rest)[..., c].ravel()
    ply_kernels.initial_forces(state, panel.constants(), None, panel.work())
    return state


def node_forces(panel, state):
    """(ni+1, nj+1, 3) [N] forces of the cloth on its nodes."""
    ni, nj = panel.counts
    f = np.array(state.f_int) + np.array(state.f_int_above)
    return np.moveaxis(f[:, : (ni + 1) * (nj + 1)].reshape(3, ni + 1, nj + 1), 0, -1)


def grid(const, flat):
    """(ni+1, nj+1) view of a flat array of the state."""
    return flat[: (const.ni + 1) * const.row_stride].reshape(const.ni + 1, const.row_stride)


def assert_gradient(panel, x, f, nodes, energy):
    """Forces f : (ni+1, nj+1, 3) [N] at some nodes are minus the derivative of energy(panel, x) [J], to the table's
    error."""
    step = 1e-8
    for node in nodes:
        for c in range(3):
            energies = []
            for sign in (1, -1):
                moved = x.copy()
                moved[(*node, c)] += sign * step
                energies.append(energy(panel, moved))
            expected = -(energies[0] - energies[1]) / (2 * step)
            assert f[(*node, c)] == pytest.approx(expected, abs=0.02 * np.abs(f).max()), (node, c)


def assert_balance(x, f):
    """The cloth's own forces f on nodes at x, both (ni+1, nj+1, 3), add up to nothing and have no moment."""
    scale = np.abs(f).sum()
    assert np.abs(f.sum(axis=(0, 1))).max() < 1e-14 * scale
    assert np.abs(np.cross(x, f).sum(axis=(0, 1))).max() < 1e-14 * scale * np.abs(x).max()


class Interrupted(Exception):
    """The user ends a run."""


class Interrupting(checkpoint.Checkpoints):
    """Checkpoints of a run that is interrupted at a time [s]."""

    def __init__(self, path, interval, end):
        super().__init__(path, interval)
        self.end = end

    def __call__(self, solver):
        super().__call__(solver)
        if solver.time > self.end:
            raise Interrupted
