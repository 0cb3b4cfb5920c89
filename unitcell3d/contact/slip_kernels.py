"""How far the friction of a pass is mobilised: the slip of its points over the regularisation
slip."""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.surface_contact_kernels import overlap_weight, pressure, traction
from unitcell3d.contact.surface_kernels import evaluate, surround


@kernel()
def mobilised_friction(x, slave, master, law, state):
    """Sum friction and normal force of a pass by size over its points, at the state of its last
    call.

    Parameters
    ----------
    x : (n, 3) [m] positions of that state
    slave, master, law, state : as in `surface_contact_kernels.contact_pass`

    Returns
    -------
    sum of p A min(|v| / s, 1) and sum of p A [N] (symbols as there)
    """
    ni, nj = master.grid.shape
    ringed = np.empty((ni + 2, nj + 2, 3))
    work = np.empty((2, 3, 4))
    surround(x, master.grid, master.axes, master.mirror, ringed)
    surface = np.empty((6, 3))
    v = np.empty(3)
    tau = np.empty(3)
    mobilised = 0.0
    whole = 0.0
    for s in range(state.codes.size):
        if state.codes[s] < 0:
            continue
        xi = state.xi[s]
        evaluate(ringed, xi, work[0], work[1], surface)
        length = traction(surface, xi, state.anchors[s], 0.0, 0.0, law.slip, v, tau)
        w1, _ = overlap_weight(xi[0], ni - 1, not master.mirror[0], True)
        w2, _ = overlap_weight(xi[1], nj - 1, not master.mirror[1], True)
        p, _ = pressure(state.gaps[s], law.penalty, law.toe)
        push = p * slave.areas[s] * w1 * w2
        whole += push
        mobilised += push * min(length / law.slip, 1.0)
    return mobilised, whole
