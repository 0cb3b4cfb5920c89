"""Patches of yarns by themselves: made, marched, and read."""

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.yarns import chain_kernels, zone_kernels
from shellfabric.yarns.coupling_kernels import stored_and_lost
from shellfabric.yarns.patch import YarnPatch, kinetic_energy


def patch(crossings=(6, 5), **values):
    """A patch of S-726 without pinned rows."""
    return YarnPatch(CellModel(catalogue.load("S-726")), crossings, **({"rim_rows": 0} | values))


def free_zone(made, cfl=0.5):
    """Its arrays, all nodes free to move."""
    zone = made.arrays(cfl * made.critical_step)
    zone.inverse_mass[:] = 1 / zone.mass
    return zone


def march(zone, steps, watch=None):
    """Make steps; `watch(zone)` is called after each."""
    for _ in range(steps):
        chain_kernels.move(zone)
        zone_kernels.inner_forces(zone)
        if watch is not None:
            watch(zone)


def energy(zone):
    """[J] of a free zone: kinetic, stored, and all that has been dissipated."""
    return kinetic_energy(zone) + stored_and_lost(zone)


def only_first_warp(zone):
    """Leave of a zone its first warp yarn, drawn straight: its nodes."""
    zone.touching[:] = False
    zone.foot[:] = -1.0
    nodes = np.arange(zone.nodes[0])
    rest = zone.rest_length[2]
    zone.x[2, nodes] = 0.0
    zone.rest_length[nodes[:-1]] = np.diff(zone.x[0, nodes])
    zone.mass[nodes] *= 0.5 * (zone.x[0, 2] - zone.x[0, 0]) / rest
    zone.inverse_mass[nodes[1:-1]] = 1 / zone.mass[nodes[1:-1]]
    zone.whole[zone.nodes[0] :] = False
    return nodes
