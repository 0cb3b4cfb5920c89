"""Contact of nodes with a rigid plate z = const: penalty and Coulomb friction, as in
`surface_contact_kernels`."""

from __future__ import annotations

import numpy as np

from fabrics.base.kernel_cache import kernel
from unitcell3d.contact.surface_contact_kernels import pressure


@kernel()
def plate_pass(x, face, height, law, forces, places, values):
    """Add the forces of the nodes of a surface on a rigid plate z = height, and their tangent if
    `places` is given.

    Parameters
    ----------
    x : (n, 3) [m] current positions
    face : PlateFace
    height : [m]
    law : ContactLaw
    forces : (n, 3) [N] internal forces, added to
    places : (s,) diagonal block of each node; (0,) for forces alone
    values : (k, 3, 3) [N/m] blocks, added to

    Returns
    -------
    force : [N] on the plate, positive in compression
    """
    nodes = face.nodes
    areas = face.areas
    side = face.side
    anchors = face.anchors
    slip = law.slip
    total = 0.0
    v = np.empty(2)
    for s in range(nodes.size):
        p, slope = pressure(side * (height - x[nodes[s], 2]), law.penalty, law.toe)
        if p == 0.0:
            continue
        forces[nodes[s], 2] += side * p * areas[s]
        total += p * areas[s]
        v[:] = x[nodes[s], :2] - anchors[s]
        length = np.sqrt(v[0] ** 2 + v[1] ** 2)
        phi = law.friction / max(length, slip)
        for c in range(2):
            forces[nodes[s], c] += areas[s] * p * phi * v[c]
        if places.shape[0] > 0:
            place = places[s]
            values[place, 2, 2] -= slope * areas[s]
            for c in range(2):
                values[place, c, c] += areas[s] * p * phi
                values[place, c, 2] -= areas[s] * phi * v[c] * side * slope
                for d in range(2):
                    if length > slip:
                        values[place, c, d] -= areas[s] * p * phi * v[c] * v[d] / length**2
    return total


@kernel()
def update_plate_anchors(x, face, height, slip):
    """Let the anchors follow to within `slip` [m] of nodes in contact, wholly those of the others;
    see `plate_pass`."""
    nodes = face.nodes
    side = face.side
    anchors = face.anchors
    for s in range(nodes.size):
        v = x[nodes[s], :2] - anchors[s]
        length = np.sqrt(v[0] ** 2 + v[1] ** 2)
        if side * (height - x[nodes[s], 2]) >= 0.0:
            anchors[s] += v
        elif length > slip:
            anchors[s] += v * (1.0 - slip / length)
