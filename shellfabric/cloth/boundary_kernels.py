"""Slipping edges of the panel: nodes with prescribed slip, and yarn ends that a clamp holds by friction.

Such a node moves along its yarn alone, by the velocity that is set here at the end of a step for the next; being
without inverse mass it takes no other. f is the force of the cloth on it along the yarn, v its velocity.

    led in      u = pull-in x (t - start) / (end - start), from 0 to the whole of it
    gripped     Coulomb's law without regularisation: the clamp takes of m v + dt f what it can, dt F at most, and the
                node keeps the rest. So it is at rest unless f exceeds the grip F, and F resists it while it slips

The energy audit gets the work of the cloth on led nodes, that on the grips, and the kinetic energy of gripped nodes,
all in the form in which central differences balance them: forces at whole steps over the motion between.
"""

from shellfabric.jit.compile import entry, kernel

EXTERNAL, GRIPPED, KINETIC = 0, 1, 2  # of state.rim_sums


@kernel()
def part(time, start, end):
    """Ramp of the prescribed slip: 0 at `start`, 1 at `end`."""
    return min(max((time - start) / (end - start), 0.0), 1.0)


@entry(_nrt=False)
def hold(state, const, time):
    """Set the velocities of the slipping nodes for the step that begins at `time` [s]; add up the work of the last."""
    kinetic = 0.0
    for m in range(const.rim_node.size):
        k, c = const.rim_node[m], const.rim_axis[m]
        pull, start, end = const.rim[m, 0], const.rim[m, 1], const.rim[m, 2]
        grip, mass = const.rim[m, 3], const.rim[m, 4]
        force = state.g0[c][k] + state.g1[c][k]
        before = state.v[c][k]
        if grip > 0.0:
            free = before + const.dt * force / mass
            most = const.dt * grip / mass
            after = max(free - most, 0.0) if free > 0.0 else min(free + most, 0.0)
            force = mass * (free - after) / const.dt
            kinetic += 0.5 * mass * before * after
            state.rim_sums[GRIPPED] += 0.5 * const.dt * before * (state.rim_force[m] + force)
        else:
            after = (pull * part(time + const.dt, start, end) - state.u[c][k]) / const.dt
            state.rim_sums[EXTERNAL] += 0.5 * const.dt * before * (state.rim_force[m] + force)
        state.rim_force[m] = force
        state.v[c][k] = after
    state.rim_sums[KINETIC] = kinetic
