"""Slipping edges of the panel: nodes with prescribed slip, and yarn ends that a clamp holds by friction
(docs/theory-panel.md, "Boundary").

Such a node moves along its yarn alone, by the velocity that is set here at the end of a step for the
next; being without inverse mass it takes no other. The force on it is that of the fabric and of all that
touches it, nose, block and other plies: these book their work on it, so it has to take their impulse.

The energy audit gets the work on prescribed nodes, that on the grips, and the kinetic energy of gripped
nodes, as central differences balance them: forces at whole steps over the motion between.
"""

from shellfabric.jit.compile import kernel
from shellfabric.state import unit


@kernel()
def slip_fraction(time, start, end):
    """Compute the ramp of the prescribed slip: 0 at `start`, 1 at `end`."""
    return min(max((time - start) / (end - start), 0.0), 1.0)


@unit(later=True, time="number")
def update_slip_nodes(state, const, time):
    """Set the velocities of the slipping nodes for the step that begins at `time` [s], by forces at
    that time; add up the work of the last step."""
    kinetic = 0.0
    for m in range(const.slip_node.size):
        k = const.slip_node[m]
        c = const.slip_axis[m]
        pull = const.slip_length[m]
        start = const.slip_start[m]
        end = const.slip_end[m]
        grip = const.slip_grip[m]
        mass = const.slip_mass[m]
        force = state.f_int[c][k] + state.f_int_above[c][k] + state.f_contact[c][k]
        force += state.slip_push[m]
        if const.has_backing:
            force += state.f_block_cloth[c][k]
        before = state.v[c][k]
        if grip > 0.0:
            free = before + const.dt * force / mass
            most = const.dt * grip / mass
            if free > 0.0:
                after = max(free - most, 0.0)
            else:
                after = min(free + most, 0.0)
            force = mass * (free - after) / const.dt
            kinetic += 0.5 * mass * before * after
            state.clamp_friction_work += 0.5 * const.dt * before * (state.slip_force[m] + force)
        else:
            after = (pull * slip_fraction(time + const.dt, start, end) - state.u[c][k]) / const.dt
            state.boundary_work += 0.5 * const.dt * before * (state.slip_force[m] + force)
        state.slip_force[m] = force
        state.v[c][k] = after
    state.gripped_kinetic_energy = kinetic
