"""The forces of a zone of yarns, in the order of a step."""

from shellfabric.jit.compile import entry
from shellfabric.yarns.chain_kernels import chain_forces, follow_tensions
from shellfabric.yarns.crossing_kernels import crossing_forces
from shellfabric.yarns.neighbour_kernels import neighbour_forces


@entry(_nrt=False)
def inner_forces(zone):
    """Compute the forces of the yarns on themselves and on each other, into zone.f, at the present
    places."""
    chain_forces(zone)
    follow_tensions(zone)
    crossing_forces(zone)
    neighbour_forces(zone)
