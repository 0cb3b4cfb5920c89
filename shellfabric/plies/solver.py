"""Marching a pack and its projectile through time; see `march`, of which this is the form for several plies.

The audit adds up the plies' energies, each as that of a single ply, and has one entry more: "plies", what the contact
between them has taken in. What each ply does is recorded beside it (PLY_SAMPLES).
"""

from __future__ import annotations

import numpy as np

from fabrics.errors import InputError, UnstableError
from shellfabric.backing import coupling
from shellfabric.cloth import boundary_kernels
from shellfabric.jit import barrier
from shellfabric.panel import boundary, quality
from shellfabric.panel import step_kernels as kernels
from shellfabric.panel.perforation import passed
from shellfabric.panel.solver import ENERGIES, EXCHANGE, March, fastest, gift
from shellfabric.plies import contact_kernels, step_kernels, torn_contact_kernels
from shellfabric.plies.model import Pack, lists
from shellfabric.projectile import dynamics
from shellfabric.projectile.contact_kernels import CONTACT, FRICTION

PACK_ENERGIES = (*ENERGIES[:-1], "plies", ENERGIES[-1])
PACK_SAMPLES = ("t", "v", "z", "failed_yarns", "reaction_warp", "reaction_weft", *PACK_ENERGIES)
PLY_SAMPLES = ("failed_yarns", "reaction_warp", "reaction_weft", "push", "deflection", "energy")
WARP, WEFT = 0, 1


class PackMarch(March):
    """One run of a pack: the plies' states, and what has been recorded of them.

    Parameters
    ----------
    pack : Pack
    strike_velocity, end_time, interval, drift_limit : as March

    Attributes
    ----------
    states, consts, stack, pairs, stops : what the kernels work on
    samples : list of rows, one an audit, in the order of PACK_SAMPLES; of the whole pack, forces summed over plies
    ply_samples : list of (plies, 6), one an audit, in the order of PLY_SAMPLES: of the whole ply; `push` is the force
        of the nose on it, `deflection` that at the impact point, `energy` what it moves with, stores and has lost
    snapshots : list of PackSnapshot, where a hook takes them

    The others are those of March.

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    def __init__(self, pack: Pack, strike_velocity, end_time, *, interval=2e-6, drift_limit=0.05):
        for key, value in (("strike_velocity", strike_velocity), ("end_time", end_time), ("interval", interval)):
            if not 0 < value < np.inf:
                raise InputError(key=key, value=value, allowed="above 0")
        self.pack = pack = pack.in_step_with(strike_velocity)
        self.panel = pack.plies[0]
        self.strike_velocity, self.end_time = float(strike_velocity), float(end_time)
        self.consts, (self.states, self.stack) = pack.constants(), pack.states(strike_velocity)
        self.pairs = pack.pairs(self.consts, self.states)
        self.stops = pack.stops(self.consts, self.states)
        self.const, self.state = self.consts[0], self.states[0]
        self._lists = tuple(lists(items) for items in (self.states, self.consts, self.pairs))
        self.threads = min(barrier.threads_for(self.panel.numerics.threads, pack.elements), len(pack.plies))
        self._works = [lists(pack.works()) for _ in range(self.threads)]
        self._shared = np.zeros(barrier.ROOM, np.int64)
        self._ends = [boundary.ends(ply) for ply in pack.plies]
        self.chunk = max(1, round(interval / self.const.dt))
        self.last_step = int(np.ceil(end_time / self.const.dt))
        self.drift_limit = drift_limit
        self.samples, self.ply_samples, self.fine, self.snapshots = [], [], [], []
        self.measure, self.histories = None, []
        self.columns, self.behind = len(dynamics.columns(self.panel.projectile)), None
        if self.panel.backing is not None:
            self.behind = coupling.Behind(self.panel.backing, pack.plies[-1], self.consts[-1])
            self.behind.follow(self.states[-1])
        self.reason, self.wall_time = kernels.RUNNING, 0.0
        self.passed, self.checks, self.exchange = 0, 0, EXCHANGE
        self.monitor = quality.Monitor(self)
        self._zero, self._rest = 0.0, np.zeros(len(pack.plies))
        self._audit()

    @property
    def steps(self):
        """Steps made."""
        return int(self.stack.counter[kernels.STEP])

    @property
    def peaks(self):
        """(plies, 2) [N] highest tension of warp and weft so far, each in the ply's own weave."""
        return np.array([state.peak for state in self.states])

    @property
    def deepest(self):
        """(plies - 1,) [-] deepest that a ply has come into the next, over the thickness: at 1 it would be through."""
        return self._of_pairs(contact_kernels.DEEPEST)

    @property
    def squeezed(self):
        """(plies - 1,) [-] furthest that the contact of a ply with the next has given way, over the thickness.

        `deepest` without what is found inside another fold of loose cloth, which loads no spring.
        """
        return self._of_pairs(contact_kernels.SQUEEZED)

    def _of_pairs(self, entry):
        both = np.array([pair.energy[entry] / pair.thickness for pair in self.pairs])
        return both.reshape(2, -1).max(axis=0)[: len(self.states) - 1]

    @property
    def held_apart(self):
        """(2,) [-] how often torn cloth was kept off other cloth, and how often that did not succeed."""
        return self.stops.energy[[torn_contact_kernels.HELD, torn_contact_kernels.MISSED]]

    def sample(self, name):
        """(n,) one column of the samples."""
        return np.array([row[PACK_SAMPLES.index(name)] for row in self.samples])

    def ply_sample(self, name):
        """(n, plies) one column of the plies' samples."""
        return np.array([rows[:, PLY_SAMPLES.index(name)] for rows in self.ply_samples])

    def _call(self, others):
        self._shared = np.zeros(barrier.ROOM, np.int64)
        states, consts, pairs = self._lists
        for me, works in enumerate(self._works[1:] if self.behind is None else (), 1):
            others.submit(
                step_kernels.follow, states, consts, pairs, self.stack, self.stops, works, self._shared, me,
                self.threads,
            )  # fmt: skip

    def advance(self, fine):
        """Make as many steps as there are rows in `fine`, or fewer where the run ends: (steps made, why)."""
        if self.behind is not None:
            return self._advance_backed(fine)
        states, consts, pairs = self._lists
        work, shared, count = self._works[0], self._shared, self.threads
        return step_kernels.lead(
            states, consts, pairs, self.stack, self.stops, work, len(fine), fine, shared, count, self._allowed
        )

    def _drop(self):
        super()._drop()
        self.ply_samples.pop()

    energy_names = PACK_ENERGIES

    @property
    def parts(self):
        return tuple(zip(self.pack.plies, self.consts, self.states))

    def _step(self, row):
        """One step of plies, projectile and block; the block is at rest while the last ply is."""
        self._shared[:] = 0
        states, consts, pairs = self._lists
        works, shared = self._works[0], self._shared
        _, reason = step_kernels.lead(
            states, consts, pairs, self.stack, self.stops, works, 1, row, shared, 1, self._allowed / self.chunk
        )
        if self.stack.awake[-1]:
            self.behind.follow(self.states[-1])
        return reason

    def _audit(self):
        const, share = self.const, self.panel.share
        parts = np.array([self._ply_energies(p) for p in range(len(self.states))])
        total = parts.sum(axis=0)
        force = self.stack.reactions.sum(axis=0) + self.states[-1].outer
        *projectile, speed = dynamics.audit(self.state, const, force)
        block = self.behind.energies() if self.behind else np.zeros(len(coupling.NAMES))
        pressed = sum(pair.energy[contact_kernels.TAKEN] for pair in self.pairs)
        pressed += self.stops.energy[torn_contact_kernels.TAKEN]
        energies = np.concatenate([total[:1], projectile, total[1:], block, [pressed]])
        if not self.samples:
            self._zero = energies.sum()
        energies = np.append(energies, energies.sum() - self._zero) / share
        plies = np.column_stack(
            [
                [self._failed_in(p) / share for p in range(len(self.states))],
                np.array([self._reactions_of(p) for p in range(len(self.states))]),
                -self.stack.reactions[:, 2] / share,
                [self._deflection(p) for p in range(len(self.states))],
                parts.sum(axis=1) / share,
            ]
        )
        z = self.stack.places[0, 2] + const.top
        failed, warp, weft = plies[:, :3].sum(axis=0)
        self.samples.append(np.array([self.time, speed, z, failed, warp, weft, *energies]))
        self.ply_samples.append(plies)

    def _ply_energies(self, p):
        """(12,) [J] of the modelled part of a ply, in the order of ENERGIES but for projectile, block and balance."""
        state, const, out = self.states[p], self.consts[p], np.empty(5)
        kernels.energies(state._replace(contact=self._pushes(p)), const, out)
        sums = state.sums.sum(axis=0)
        if not self.samples:
            self._rest[p] = out[kernels.STORED]
        cell = sums[kernels.WORK] - (out[kernels.STORED] - self._rest[p]) - sums[kernels.LOST]
        return np.array(
            [
                out[kernels.KINETIC] + state.rim_sums[boundary_kernels.KINETIC],
                out[kernels.STORED],
                sums[kernels.OVER] if const.variational else cell,
                out[kernels.SHEAR],
                out[kernels.BENDING],
                out[kernels.JAM],
                sums[kernels.VISCOUS],
                state.contact_energy[CONTACT],
                state.contact_energy[FRICTION],
                sums[kernels.LOST] + sums[kernels.TORN],
                state.rim_sums[boundary_kernels.GRIPPED],
                state.rim_sums[boundary_kernels.EXTERNAL],
            ]
        )

    def _pushes(self, p):
        """Forces of nose and neighbours on the nodes of a ply, by component."""
        total = [force.copy() for force in self.states[p].contact]
        near, back = self.pairs[: len(self.pairs) // 2], self.pairs[len(self.pairs) // 2 :]
        neighbours = [near[p - 1].on_rear, back[p - 1].on_front] if p > 0 else []
        neighbours += [near[p].on_front, back[p].on_rear] if p < len(self.states) - 1 else []
        neighbours += [self.stops.force[p]]
        for forces in neighbours:
            for whole, force in zip(total, forces):
                whole += force[: whole.size]  # that of torn cloth is as wide as the largest ply
        return tuple(total)

    def _failed_in(self, p):
        """Failed yarn segments of a ply; see March._failed."""
        const, total = self.consts[p], 0.0
        for axis, (failed, mirrored) in enumerate(zip(self.states[p].failed, self.panel.mirrors[::-1])):
            lines = np.moveaxis(failed[: (const.ni + 1) * const.s].reshape(-1, const.s), 1 - axis, 0)
            total += np.count_nonzero(lines) - 0.5 * mirrored * np.count_nonzero(lines[0])
        return total

    def _reactions_of(self, p):
        """[N] tension at the edge of the warp and of the weft yarn of a ply nearest the impact point."""
        c, state, weave = self.consts[p], self.states[p], self.pack.plies[p].weave
        warp_node, weft_node = (i * c.s + j for i, j in self._ends[p])
        warp = -(state.g0[0][warp_node] + state.g1[0][warp_node]) * weave.w2 * 2 / (c.dy * (0.5 if c.mirror_y else 1))
        weft = -(state.g0[1][weft_node] + state.g1[1][weft_node]) * weave.w1 * 2 / (c.dx * (0.5 if c.mirror_x else 1))
        return warp, weft

    def _deflection(self, p):
        """[m] of the node at the impact point."""
        c = self.consts[p]
        return self.states[p].u[2][(0 if c.mirror_x else c.ni // 2) * c.s + (0 if c.mirror_y else c.nj // 2)]

    def _guard(self):
        """Stop a run that has become unphysical, and say where."""
        row = self.samples[-1]
        when = f"after {self.time * 1e6:.3g} us (step {self.steps})"
        for p, state in enumerate(self.states):
            speed = np.sqrt((np.array(state.v) ** 2).sum(axis=0))
            k, told = int(np.argmax(speed)), ""
            if not np.isfinite(speed).all():
                k, told = int(np.argmin(np.isfinite(speed))), "a number is not finite"
            elif speed[k] > fastest(self.consts[p]):
                told = f"a node moves at {speed[k]:.3g} m/s"
            if told:
                self.reason = kernels.NOT_FINITE
                raise UnstableError(told, where=f"ply {p + 1}, {self._place(k, p)}", when=when)
        self._guard_plies()
        drift = abs(row[PACK_SAMPLES.index("balance")]) / self.strike_energy
        if not drift <= self.drift_limit:
            self.reason = kernels.NOT_FINITE
            told = f"the energy balance is off by {100 * drift:.2g} % of the strike energy"
            raise UnstableError(told, where=f"{len(self.states)} plies", when=when)
        for name, told in (("contact", "the contact with the nose"), ("plies", "the contact between plies")):
            given = gift(row[PACK_SAMPLES.index(name)], self.strike_energy)
            if given:
                self.reason = kernels.NOT_FINITE
                raise UnstableError(f"{told} {given}", where=f"{len(self.states)} plies", when=when)

    def _guard_plies(self):
        """Stop a run in which whole cloth has come through whole cloth."""
        half = len(self.pairs) // 2
        for p, pair in enumerate(self.pairs):
            if pair.energy[contact_kernels.PASSED]:
                one, other = (p, p + 1) if p < half else (p - half + 1, p - half)
                element = int(pair.energy[contact_kernels.WHERE]) // pair.points**2
                i, j = divmod(element, self.consts[one].nj)
                step = int(pair.energy[contact_kernels.WHEN])
                self.reason = kernels.NOT_FINITE
                raise UnstableError(
                    f"ply {one + 1} has come through ply {other + 1}", where=f"ply {one + 1}, element ({i}, {j})",
                    when=f"after {step * self.const.dt * 1e6:.3g} us (step {step})",
                )  # fmt: skip

    def _look_for_plug(self):
        """End a run in which cut-out cloth is all that is left before the projectile."""
        failed = self.stack.counters[:, kernels.FAILURES].any()
        if self.reason != kernels.RUNNING or not failed or self.behind is not None:
            return
        through = all(passed(state, const) for state, const in zip(self.states, self.consts))
        self.passed = self.passed + 1 if through else 0
        if self.passed == 2:
            self.reason = kernels.PERFORATED

    def _place(self, k, p=0):
        s = self.consts[p].s
        return f"node ({int(k) // s}, {int(k) % s})"
