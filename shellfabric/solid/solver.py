"""Marching a solid patch and its projectile through time: steps as long as the state allows, audits, and hooks.

Steps are as long as the state allows: bricks that are pressed to their packing are two orders stiffer than at rest.
The bound is found anew after every few steps. A hook is called as hook(march) after every audit.

Energy audit, at the instant of the last forces. Fibres, hourglass control and contacts have potentials, which are
evaluated as they stand. The solids' law has none: their entry is the work that they have taken. Balance is the sum of
all less what there was at the start.
"""

from __future__ import annotations

import time

import numba
import numpy as np

from fabrics.errors import InputError, UnstableError
from shellfabric.solid import solid_kernels
from shellfabric.solid import step_kernels as kernels

ENERGIES = (
    "kinetic_fabric",
    "kinetic_projectile",
    "fibres",
    "solids",
    "hourglass",
    "contact",
    "viscous",
    "failed",
    "balance",
)
SAMPLES = ("t", "v", "z", "push", "dt", "failed_bars", "warp_peak", "weft_peak", "warp_nose", "weft_nose", *ENERGIES)
SAME = 16  # steps of one length
GROWTH = 1.5  # by which the fastest node may speed up meanwhile: sets for how long clear contacts may rest


class SolidMarch:
    """One run.

    Parameters
    ----------
    patch : SolidPatch
    strike_velocity : [m/s]
    end_time : [s]
    interval : [s] between audits
    drift_limit : share of the strike energy that the balance may reach before the run is called unstable
    threads : of numba; None leaves its setting. They change no bit of the result

    Attributes
    ----------
    const, state : what the kernels work on
    wall_time : [s] spent in the kernels
    samples : list of rows, one an audit, in the order of SAMPLES. Tensions [N] are elastic forces of whole sections:
        the largest of a family, and the mean of its two middle yarns under the nose
    snapshots : list of (time, places (n, 3)), where a hook takes them

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    def __init__(self, patch, strike_velocity, end_time, *, interval=0.25e-6, drift_limit=0.02, threads=None):
        for key, value in (("strike_velocity", strike_velocity), ("end_time", end_time), ("interval", interval)):
            if not 0 < value < np.inf:
                raise InputError(key=key, value=value, allowed="above 0")
        self.patch, self.strike_velocity, self.end_time = patch, float(strike_velocity), float(end_time)
        self.interval, self.drift_limit, self.threads = float(interval), drift_limit, threads
        self.const, self.state = patch.ready(strike_velocity)
        self.samples, self.snapshots, self.wall_time = [], [], 0.0
        kernels.forces(self.state, self.const, 0.0)  # compiled before any clock starts
        self._rest = self.state.contact[:, 0].sum()  # coarse facets overlap at rest, and store what they then give

    @property
    def steps(self):
        """Steps made."""
        return int(self.state.counter[0])

    @property
    def time(self):
        """[s] of the places."""
        return float(self.state.clock[0])

    @property
    def ended(self):
        """Whether the end time is reached."""
        return self.time > self.end_time - 0.5 * self.interval

    @property
    def strike_energy(self):
        """[J]"""
        return self.patch.projectile.energy(self.strike_velocity)

    def sample(self, name):
        """(n,) one column of the samples."""
        return np.array([row[SAMPLES.index(name)] for row in self.samples])

    def run(self, hooks=()):
        """March to the end.

        Raises
        ------
        UnstableError : a number that is not finite, or a balance beyond its limit; samples and state stay
        """
        if self.threads is not None:
            numba.set_num_threads(self.threads)
        kernels.advance(self.state, self.const, 0)
        while not self.ended:
            start = time.perf_counter()
            left = self.interval
            while left > 0:
                steps = self._pace(left)
                made = min(steps, SAME)
                kernels.advance(self.state, self.const, made)
                left = left * (steps - made) / steps
            self.wall_time += time.perf_counter() - start
            self._audit()
            self._guard()
            for hook in hooks:
                hook(self)
        return self

    def _pace(self, left):
        """Set the length of the next steps; returns how many fill the time that is left of the interval [s]."""
        numerics, state = self.patch.numerics, self.state
        fastest, node = self.patch.frequency(self.const, state)
        if not np.isfinite(fastest):
            raise UnstableError("a brick is inverted", where=f"node {node}", when=self._when())
        damping = max(numerics.solid_viscosity, numerics.fibre_viscosity)
        longest = numerics.safety * 2 / fastest * (np.sqrt(1 + damping**2) - damping)
        steps = int(np.ceil(left / longest))
        speed = np.sqrt((state.v**2).sum(axis=1).max())
        state.pace[0] = left / steps
        state.pace[1] = 2 * max(GROWTH * speed, self.strike_velocity) * state.pace[0]
        return steps

    def _audit(self):
        state, sums = self.state, self.state.sums.sum(axis=0)
        contact, nose = state.contact.sum(axis=0), state.nose.sum(axis=0)
        energies = [
            sums[solid_kernels.KINETIC],
            state.nose_energy[0],
            sums[solid_kernels.BARS],
            sums[solid_kernels.SOLID] - state.half.sum() - sums[solid_kernels.DAMPED],
            sums[solid_kernels.HOURGLASS],
            contact[0] + nose[kernels.NOSE],
            sums[solid_kernels.VISCOUS] + sums[solid_kernels.DAMPED] + contact[1] + nose[kernels.LOST],
            sums[solid_kernels.FAILED],
        ]
        balance = sum(energies) - self.strike_energy - self._rest
        failed = np.count_nonzero(~state.alive)
        row = [self.time, state.speed[2], state.position[2], -state.push[2], state.pace[0], failed, *self._tensions()]
        self.samples.append(np.array([*row, *energies, balance]))

    def _tensions(self):
        """Largest tension of warp and weft, and the mean under the nose of their two middle yarns."""
        peaks, means = [], []
        place = 0
        for family, count in enumerate(self.patch.count):
            tensions = np.array([
                self.patch.section_tension(self.const, self.state, yarn) for yarn in range(place, place + count)
            ])  # fmt: skip
            peaks.append(tensions.max())
            middle = tensions[(count - 1) // 2 : count // 2 + 1]
            reach = self.patch.projectile.radius / (2 * self.patch.mesh.w[family]) * self.patch.per_crossing
            half = 0.5 * tensions.shape[1]
            means.append(middle[:, max(int(half - reach), 0) : int(np.ceil(half + reach))].mean())
            place += count
        return *peaks, *means

    def _guard(self):
        """Stop a run that has become unphysical, and say where."""
        row, speed = self.samples[-1], np.sqrt((self.state.v**2).sum(axis=1))
        if not (np.isfinite(row).all() and np.isfinite(speed).all()):
            where = self._place(np.argmin(np.isfinite(speed)))
            raise UnstableError("a number is not finite", where=where, when=self._when())
        drift = abs(row[SAMPLES.index("balance")]) / self.strike_energy
        if drift > self.drift_limit:
            told = f"the energy balance is off by {100 * drift:.2g} % of the strike energy"
            raise UnstableError(told, where=self._place(np.argmax(speed)), when=self._when())

    def _when(self):
        return f"after {self.time * 1e6:.3g} us (step {self.steps})"

    def _place(self, node):
        mesh = self.patch.mesh
        yarn = int(np.searchsorted(self.const.first, node, side="right")) - 1
        x, y, z = self.state.x[node] * 1e3
        return f"node {int(node)} of {mesh.names[yarn]} ({x:.3g}, {y:.3g}, {z:.3g} mm)"
