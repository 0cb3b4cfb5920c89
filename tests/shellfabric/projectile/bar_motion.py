"""A bar by itself under a force on its tip, moved by the kernel of the runs."""

from math import ceil, pi

import numpy as np

from shellfabric.projectile import bar_kernels as kernels


class Motion:
    """A `Bar` in motion, at first with a velocity [m/s] forwards and without strain."""

    def __init__(self, bar, velocity):
        self.bar = bar
        self.h, self.area = bar.mesh
        self.mass, material = bar.nodal_mass, bar.material
        self.law = np.array([material.modulus, material.yield_stress, material.hardening])
        self.u, self.v = np.zeros(self.mass.size), np.full(self.mass.size, float(velocity))
        self.plastic, self.stress, self.sums = np.zeros(self.h.size), np.zeros(self.h.size), np.zeros(2)
        self.start = 0.5 * float(self.mass @ self.v**2)

    def push(self, force, dt):
        """Hold a force [N], positive forwards, for the time dt [s]; displacement [m] and velocity [m/s] of the tip."""
        return kernels.advance(
            self.u, self.v, self.mass, self.h, self.area,
            self.law, self.plastic, self.stress, self.sums, float(force), float(dt), self.bar.substeps(dt),
        )  # fmt: skip

    def energies(self):
        """Energies [J] by name; the error is kinetic, elastic and plastic less the start and the work at the tip."""
        out = np.empty(2)
        kernels.energies(self.v, self.mass, self.h, self.area, self.bar.material.modulus, self.stress, out)
        plastic, work = self.sums[kernels.PLASTIC], self.sums[kernels.WORK]
        return {"plastic": plastic, "work": work, "error": out.sum() + plastic - work - self.start}

    def shortening(self):
        """[m] by plastic strain."""
        return -float(np.expm1(self.plastic) @ self.h)


def split(bar, duration, impulse):
    """What a half-sine push of `duration` [s] and a small `impulse` [N s] leaves of rigidity: the largest
    |v_tip - v_tail| over the change of the centre's velocity, during it and after."""
    motion, dt = Motion(bar, 0.0), bar.longest_step
    steps, extra = ceil(duration / dt), ceil(2 * bar.period / dt)
    peak = impulse * pi / (2 * steps * dt)
    apart = []
    for n in range(steps + extra):
        motion.push(-peak * np.sin(pi * (n + 0.5) / steps) if n < steps else 0.0, dt)
        apart.append(abs(motion.v[0] - motion.v[-1]))
    change = impulse / bar.mass
    return max(apart[:steps]) / change, max(apart[steps:]) / change
