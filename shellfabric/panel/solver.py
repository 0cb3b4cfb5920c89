"""Marching a panel and its projectile through time: chunks of steps, an audit after each, and hooks.

Several threads can share the work: each has the nodes and elements of some blocks, in each step the same for all, and
they wait for each other (see `team`). What comes out is the same to the last bit with any number of them.

The march knows no physics: the kernels make the steps, `audit` samples them, hooks look on. A hook is called as
hook(march) after every chunk and reads what it likes; `shellfabric.output.hooks` has some.

Energy audit. Each entry is computed on its own, not from the others: the balance, their sum less the energy at the
start, is what they disagree by. What the yarns store follows from their stretches. In the equilibrium form, whose
forces are no gradient, the work done on them is more or less than that: the difference is the entry "cell". In the
variational form that entry is what a step loses where yarns stiffen (`membrane_kernels.yarns`), which is told by the
slopes of their forces: a force that is wrong stays in the balance.
"""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from fabrics.errors import InputError, UnstableError
from shellfabric.backing import coupling
from shellfabric.cloth import boundary_kernels
from shellfabric.jit import barrier
from shellfabric.panel import boundary, quality
from shellfabric.panel import step_kernels as kernels
from shellfabric.panel.model import Panel
from shellfabric.panel.perforation import passed
from shellfabric.projectile import contact_kernels, dynamics

OUTCOMES = {kernels.RUNNING: "in flight", kernels.STOPPED: "stopped", kernels.PERFORATED: "perforated"}
ENERGIES = (
    "kinetic_fabric",
    "kinetic_projectile",
    "elastic_projectile",
    "plastic_projectile",
    "stored",
    "cell",
    "shear",
    "bending",
    "jam",
    "viscous",
    "contact",
    "friction",
    "failed",
    "grip",
    "external",
    *coupling.NAMES,
    "balance",
)
OUTRUN = 1.0  # see `fastest`
EXCHANGE = 0.05  # share of the strike energy that may be exchanged from one check of the balance to the next
GIFT_LIMIT = 0.01  # share of the strike energy that a contact may seem to have given
SAMPLES = ("t", "v", "z", "failed_yarns", "reaction_warp", "reaction_weft", *ENERGIES)


class March:
    """One run: the panel's state, and what has been recorded of it.

    Parameters
    ----------
    panel : Panel
    strike_velocity : [m/s]
    end_time : [s]
    interval : [s] between audits; rounded to whole steps
    drift_limit : share of the strike energy that the balance may reach before the run is called unstable

    Attributes
    ----------
    state, const : what the kernels work on
    threads : that share the work
    behind : backing.coupling.Behind, the block behind the cloth, or None
    samples : list of rows, one an audit, in the order of SAMPLES; energies and forces are of the whole panel
    fine : list of (steps, columns) after each step, `dynamics.columns` of the projectile: z [m], velocity [m/s] and
        force [N] (of the modelled part), and of a bar velocities [m/s] and places [m] of tip, tail and centre of mass
    snapshots : list of snapshots.Snapshot, where a hook takes them
    measure, histories : what a histories.Recorder records, where there is one, and its rows
    outcome : "in flight", "stopped" or "perforated"
    checks : of the energy balance between audits (see `_chunk`)
    exchange : share of the strike energy that may be exchanged from one check to the next; infinite for none
    monitor : quality.Monitor, what the quality indicators need besides the result
    passed : audits in a row that found no held cloth ahead of the nose (see `plug`); the second ends the run
    wall_time : [s] spent in the kernels that march

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    def __init__(self, panel: Panel, strike_velocity, end_time, *, interval=2e-6, drift_limit=0.05):
        for key, value in (("strike_velocity", strike_velocity), ("end_time", end_time), ("interval", interval)):
            if not 0 < value < np.inf:
                raise InputError(key=key, value=value, allowed="above 0")
        self.panel, self.strike_velocity, self.end_time = panel, float(strike_velocity), float(end_time)
        self.const, self.state, self._work = panel.constants(), panel.state(strike_velocity), panel.work()
        self.threads = barrier.threads_for(panel.numerics.threads, panel.elements)
        self._works = [self._work, *(panel.work() for _ in range(self.threads - 1))]
        self._ends = boundary.ends(panel)
        self.chunk = max(1, round(interval / self.const.dt))
        self.last_step = int(np.ceil(end_time / self.const.dt))
        self.columns = len(dynamics.columns(panel.projectile))
        self.drift_limit = drift_limit
        self.samples, self.fine, self.snapshots = [], [], []
        self.measure, self.histories = None, []
        self.behind = None
        if panel.backing is not None:
            self.behind = coupling.Behind(panel.backing, panel, self.const)
            self.behind.follow(self.state)
        self.reason, self.wall_time = kernels.RUNNING, 0.0
        self.passed, self.checks, self.exchange = 0, 0, EXCHANGE
        self._zero = self._rest = 0.0
        self.monitor = quality.Monitor(self)
        self._audit()

    @property
    def steps(self):
        """Steps made."""
        return int(self.state.counter[kernels.STEP])

    @property
    def time(self):
        """[s]"""
        return self.steps * self.const.dt

    @property
    def ended(self):
        """Whether the run is over."""
        return self.reason != kernels.RUNNING or self.steps >= self.last_step

    @property
    def outcome(self):
        return OUTCOMES.get(self.reason, "unstable")

    @property
    def strike_energy(self):
        """[J]"""
        return self.panel.projectile.energy(self.strike_velocity)

    energy_names = ENERGIES

    @property
    def parts(self):
        """(Panel, Constants, State) of each ply."""
        return ((self.panel, self.const, self.state),)

    @property
    def _allowed(self):
        """[J] energy that the modelled part may exchange between two checks of the energy balance."""
        return self.exchange * self.strike_energy * self.panel.share

    def sample(self, name):
        """(n,) one column of the samples."""
        return np.array([row[SAMPLES.index(name)] for row in self.samples])

    def run(self, hooks=()):
        """March to the end, or to where the run goes wrong.

        Raises
        ------
        UnstableError : a number that is not finite, a balance beyond its limit, a contact that gives energy, or a
            node that crosses an element in one step (`fastest`); samples and state stay as they are
        """
        with ThreadPoolExecutor(max(1, self.threads - 1)) as others:
            self._call(others)
            try:
                self.advance(np.empty((0, self.columns)))  # compiled before the clock starts
                self._call(others)
                while not self.ended:
                    fine = np.empty((min(self.chunk, self.last_step - self.steps), self.columns))
                    made = self._chunk(fine, others)
                    self.fine.append(fine[:made])
                    self._audit()
                    self._guard()
                    self.monitor.audited()
                    self._look_for_plug()
                    for hook in hooks:
                        hook(self)
            finally:
                self.advance(np.empty((0, self.columns)))  # lets the others go
        return self

    def _chunk(self, fine, others):
        """Make as many steps as there are rows in `fine`, or fewer where the run ends; returns how many.

        Between audits the energy is checked as often as EXCHANGE of the strike energy has been exchanged.
        """
        made = 0
        while made < len(fine):
            start = time.perf_counter()
            steps, self.reason = self.advance(fine[made:])
            self.wall_time += time.perf_counter() - start
            made += steps
            self._call(others)
            if self.reason != kernels.CHECK:
                break
            self.reason = kernels.RUNNING
            if made == len(fine):
                break
            try:
                self._check()
            except UnstableError:
                self.fine.append(fine[:made])  # what was computed is kept
                raise
        return made

    def _check(self):
        """Audit the energy and guard the run without recording a sample, unless the guard stops it."""
        self.checks += 1
        self._audit()
        self._guard()
        self._drop()

    def _drop(self):
        """Forget the last sample."""
        self.samples.pop()

    def _call(self, others):
        """Have the other threads wait for the next steps while this one sees to what is between: waking takes them
        longer than a step. They meet in new memory, as some may not have left the meeting before."""
        self._shared = np.zeros_like(self._work.shared)
        for me, work in enumerate(self._works[1:] if self.behind is None else (), 1):
            others.submit(kernels.follow, self.state, self.const, work, self._shared, me, self.threads)

    def advance(self, fine):
        """Make as many steps as there are rows in `fine`, or fewer where the run ends or a check of the energy is due:
        (steps made, why)."""
        if self.behind is not None:
            return self._advance_backed(fine)
        work, allowed = self._work, self._allowed
        return kernels.lead(self.state, self.const, work, len(fine), fine, self._shared, self.threads, allowed)

    def _advance_backed(self, fine):
        """As `advance`, one step at a time, each followed by the block's."""
        made, reason = 0, kernels.RUNNING
        while made < len(fine) and reason == kernels.RUNNING:
            reason = self._step(fine[made : made + 1])
            made += 1
        return made, reason

    def _step(self, row):
        """One step of cloth, projectile and block; why it should be the last."""
        shared = self._work.shared
        shared[:] = 0
        _, reason = kernels.lead(self.state, self.const, self._work, 1, row, shared, 1, self._allowed / self.chunk)
        self.behind.follow(self.state)
        return reason

    def _audit(self):
        state, const, share = self.state, self.const, self.panel.share
        out = np.empty(5)
        kernels.energies(state, const, out)
        *projectile, speed = dynamics.audit(state, const, state.reaction + state.outer)
        sums = state.sums.sum(axis=0)
        if not self.samples:
            self._rest = out[kernels.STORED]
        # what the forces have worked that is neither stored nor lost; where they are a gradient, by the steps alone
        cell = sums[kernels.WORK] - (out[kernels.STORED] - self._rest) - sums[kernels.LOST]
        energies = [
            out[kernels.KINETIC] + state.rim_sums[boundary_kernels.KINETIC],
            *projectile,
            out[kernels.STORED],
            sums[kernels.OVER] if self.const.variational else cell,
            out[kernels.SHEAR],
            out[kernels.BENDING],
            out[kernels.JAM],
            sums[kernels.VISCOUS],
            state.contact_energy[contact_kernels.CONTACT],
            state.contact_energy[contact_kernels.FRICTION],
            sums[kernels.LOST] + sums[kernels.TORN],
            state.rim_sums[boundary_kernels.GRIPPED],
            state.rim_sums[boundary_kernels.EXTERNAL],
            *(self.behind.energies() if self.behind else np.zeros(len(coupling.NAMES))),
        ]
        total = sum(energies)
        if not self.samples:
            self._zero = total
        energies = np.array([*energies, total - self._zero]) / share
        self.samples.append(
            np.array(
                [self.time, speed, state.position[2] + const.top, self._failed() / share, *self._reactions(), *energies]
            )
        )

    def _failed(self):
        """Failed yarn segments of the modelled part; those on a plane of symmetry belong to it by half."""
        shape = self.const.ni + 1, self.const.s
        families = zip(self.state.failed, self.panel.segments())
        return float(sum(np.sum(failed[: shape[0] * shape[1]].reshape(shape) * n) for failed, n in families))

    def _reactions(self):
        """[N] tension at the edge of the warp and of the weft yarn nearest the impact point."""
        c, g0, g1 = self.const, self.state.g0, self.state.g1
        warp_node, weft_node = (i * c.s + j for i, j in self._ends)
        warp = -(g0[0][warp_node] + g1[0][warp_node]) * self.panel.weave.w2 * 2 / (c.dy * (0.5 if c.mirror_y else 1))
        weft = -(g0[1][weft_node] + g1[1][weft_node]) * self.panel.weave.w1 * 2 / (c.dx * (0.5 if c.mirror_x else 1))
        return warp, weft

    def _guard(self):
        """Stop a run that has become unphysical, and say where."""
        row, v = self.samples[-1], np.array(self.state.v)
        when = f"after {self.time * 1e6:.3g} us (step {self.steps})"
        speed = np.sqrt((v**2).sum(axis=0))
        if not (np.isfinite(row).all() and np.isfinite(speed).all()):
            self.reason = kernels.NOT_FINITE
            raise UnstableError("a number is not finite", where=self._place(np.argmin(np.isfinite(speed))), when=when)
        k = int(np.argmax(speed))
        told = gift(row[SAMPLES.index("contact")], self.strike_energy)
        if told:
            self.reason = kernels.NOT_FINITE
            raise UnstableError(f"the contact {told}", where=self._place(k), when=when)
        if speed[k] > fastest(self.const):
            self.reason = kernels.NOT_FINITE
            raise UnstableError(f"a node moves at {speed[k]:.3g} m/s", where=self._place(k), when=when)
        drift = abs(row[SAMPLES.index("balance")]) / self.strike_energy
        if drift > self.drift_limit:
            self.reason = kernels.NOT_FINITE
            told = f"the energy balance is off by {100 * drift:.2g} % of the strike energy"
            raise UnstableError(told, where=self._place(k), when=when)

    def _look_for_plug(self):
        """End a run in which cut-out cloth is all that is left before the projectile."""
        if self.reason != kernels.RUNNING or self.state.counter[kernels.FAILURES] == 0 or self.behind is not None:
            return
        self.passed = self.passed + 1 if passed(self.state, self.const) else 0
        if self.passed == 2:
            self.reason = kernels.PERFORATED

    def _place(self, k):
        return f"node ({int(k) // self.const.s}, {int(k) % self.const.s})"


def fastest(const):
    """[m/s] the highest speed of a node that a run goes on with: OUTRUN = 1 of an element's shorter side in a step.

    Nodes are fast without any instability. The nose throws light ones at twice its own velocity and more, a yarn that
    breaks at the strain e lets go of its free end at 2 e c, with c the wave speed of the cloth, and the free corner of
    a panel that is drawn in cracks as a whip does. None of this is bounded by the strike velocity alone. What central
    differences cannot follow is a change of shape within a step: their bound takes the stiffness as constant over it,
    while one end of a segment that moves by the segment's length has turned it over. As the step is a share of the time
    that a wave takes over an element (`panel`), such a node is faster than sound in the cloth. Below the bound the
    energy balance tells whether a run is good, and ends it if not.
    """
    return OUTRUN * min(const.dx, const.dy) / const.dt


def gift(taken, strike_energy):
    """What to say of a contact that has taken in `taken` [J]: springs and dampers store and lose, they cannot give."""
    share = -taken / strike_energy
    return f"has given {100 * share:.2g} % of the strike energy that it never took" if share > GIFT_LIMIT else ""
