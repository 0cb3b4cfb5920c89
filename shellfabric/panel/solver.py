"""Explicit solvers of cloth: what panel and pack have in common, and the solver of one panel.

A panel is a pack of one ply. The energies of the plies add up (`ply_audit`); projectile and backing block, where there
is one behind the last ply, have theirs. The results are the same to the last bit with any number of threads: each has
the nodes and elements of some blocks, in each step the same for all.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fabrics.checks import FloatArray, IntArray
from shellfabric.backing import coupling
from shellfabric.driver.guards import speed_limit
from shellfabric.driver.solver import PERFORATED, RUNNING, ExplicitSolver
from shellfabric.jit import barrier
from shellfabric.panel import boundary, compile_ahead, grading, ply_audit, quality
from shellfabric.panel import step_kernels as kernels
from shellfabric.panel.model import Panel
from shellfabric.panel.perforation import held, passed
from shellfabric.projectile import dynamics

_OF_PROJECTILE = ("kinetic_projectile", "elastic_projectile", "plastic_projectile")
ENERGIES = (ply_audit.ENERGIES[0], *_OF_PROJECTILE, *ply_audit.ENERGIES[1:], *coupling.NAMES, "error")
OBSERVED = ("t", "v", "z", "failed_yarns", "reaction_warp", "reaction_weft")
SAMPLES = (*OBSERVED, *ENERGIES)
PLY_SAMPLES = (
    "failed_yarns", "reaction_warp", "reaction_weft", "push", "deflection", "energy", "peak_warp", "peak_weft",
    "pull_in", "slip",
)  # fmt: skip


class ClothSolver(ExplicitSolver):
    """One run of one ply or several; base of PanelSolver and PackSolver, which have the kernels.

    Parameters as ExplicitSolver; the plies are handed to `_start`.

    Attributes
    ----------
    parts : ((Panel, Constants, State), ...) of the plies, in the order in which the projectile meets them
    panel, const, state : of the first ply
    backing : backing.coupling.BackingCoupling, the block behind the last ply, or None
    ply_samples : list of (plies, 10), one a sample, in the order of PLY_SAMPLES: of the whole ply; `push` is the force
        of the nose on it, `deflection` the largest of its cloth (`ply_audit.deflection`), `energy` what it moves with,
        stores and has lost, the peaks its highest tensions so far [N] (`peak_tensions`), `pull_in` the largest way of a
        yarn's end out of its clamp and `slip` the longest piece of yarn that has passed through a crossover [m]
    step_history : `dynamics.columns` of the projectile: z [m], velocity [m/s] and force [N] (of the modelled part), and
        of a bar velocities [m/s] and places [m] of tip, tail and centre of mass
    measure, histories : what a histories.Recorder records, where there is one, and its rows
    monitor : quality.Monitor, what the quality indicators need besides the result
    perforated_samples : in a row, that found no held cloth ahead of the nose; the second ends the run
    """

    sample_names, energy_names = SAMPLES, ENERGIES
    counters = (*ExplicitSolver.counters, "perforated_samples")
    module = "shellfabric.impact.simulation"  # whose code determines a run

    def _start(self, parts, elements, most_threads=np.inf):
        """Take the first sample of the plies at rest, of all `elements`; at most so many threads can share them."""
        self.parts, (self.panel, self.const, self.state) = parts, parts[0]
        self.share = self.panel.share
        self.threads = min(barrier.threads_for(self.panel.numerics.threads, elements), most_threads)
        self.reduces_threads = self.panel.numerics.threads is None
        self.history_columns = len(dynamics.columns(self.panel.projectile))
        self.ply_samples, self.history_request, self.histories = [], None, []
        self.backing, self.perforated_samples = None, 0
        self.run_steps(self._rows(0), np.zeros(barrier.SLOTS, np.int64), 1, np.inf)  # the forces at rest
        if self.panel.backing is not None:
            last, const, state = self.parts[-1]
            self.backing = coupling.BackingCoupling(self.panel.backing, last, const)
            self.backing.step(state)
        self._ends = [boundary.ends(panel) for panel, _, _ in self.parts]
        self._rest = [ply_audit.stored_energy(const, state) for _, const, state in self.parts]
        self.monitor = quality.Monitor(self)
        self._begin(self.const.dt)

    @property
    def target(self) -> Any:
        """What is struck: the Panel of one ply, or the Pack of several."""
        return self.panel

    @property
    def places(self) -> FloatArray:
        """(plies,) [m] where the middle surfaces stand at rest, the first at 0."""
        return np.zeros(1)

    @property
    def deepest(self) -> FloatArray:
        """(plies - 1,) [-] deepest that a ply has come into the next, over the thickness: at 1 it would be through."""
        return np.zeros(0)

    @property
    def held_apart(self) -> FloatArray:
        """(2,) [-] how often torn cloth was kept off other cloth, and how often that did not succeed."""
        return np.zeros(2)

    def slip_summaries(self) -> tuple[Any, ...]:
        """(plies,) sliding.solver.SlipSummary of sliding crossovers so far; empty of pinned ones."""
        return ()

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.state.counter[kernels.STEP])

    @property
    def workers(self) -> int:
        """Number of threads besides the main one; a block is in step with one thread alone."""
        return self.threads - 1 if self.backing is None else 0

    def run_steps(self, history: FloatArray, shared: IntArray, count: int, allowed: float) -> tuple[int, int]:
        """The kernel's steps, with `count` - 1 workers: (steps made, why no more)."""
        raise NotImplementedError

    def neighbour_forces(self, ply: int) -> list[Any]:
        """[forces [N] on the nodes of a ply, by component] of what touches it besides the nose."""
        return []

    def normal_contact_forces(self, ply: int) -> list[FloatArray]:
        """[(slots,)] [N] on the nodes of a ply along the normal, positive where they press on it: of the projectile;
        before a block also of what is in front, and of what is behind.
        """
        state = self.parts[ply][2]
        found = [state.f_contact[2]]
        return found if self.backing is None else [*found, 0 * state.f_contact[2], -state.f_block_cloth[2]]

    def passed_lengths(self, ply: int) -> tuple[FloatArray, ...]:
        """((slots,), (slots,)) [m] of warp and weft that has passed through the nodes; () of pinned crossovers."""
        return ()

    def _loaded_state(self, ply):
        """State of a ply, its contact forces those of all that touches it."""
        state, neighbours = self.parts[ply][2], self.neighbour_forces(ply)
        if not neighbours:
            return state
        total = [force.copy() for force in state.f_contact]
        for forces in neighbours:
            for whole, force in zip(total, forces):
                whole += force[: whole.size]  # that of torn cloth is as wide as the largest ply
        return state._replace(f_contact=tuple(total))

    def contact_energies(self) -> tuple[float, ...]:
        """[J] of contacts but for those of the plies with the nose, in the order of energy_names."""
        return ()

    def block_moves(self) -> bool:
        """Whether the block has to be followed: it is at rest while the last ply is."""
        return True

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """See ExplicitSolver. Before a block, one step at a time, each followed by the block's."""
        if self.backing is None:
            return self.run_steps(history, self._shared, self.threads, self.allowed_exchange)
        made, reason = 0, RUNNING
        while made < len(history) and reason == RUNNING:
            allowed = self.allowed_exchange / self.steps_per_sample
            _, reason = self.run_steps(history[made : made + 1], self._shared, 1, allowed)
            made += 1
            if self.block_moves():
                self.backing.step(self.parts[-1][2])
        return made, reason

    def observe(self) -> tuple[Sequence[float], Sequence[float]]:
        """See ExplicitSolver."""
        plies = np.array([
            ply_audit.energies(const, self._loaded_state(ply), rest)
            for ply, ((_, const, _), rest) in enumerate(zip(self.parts, self._rest))
        ])  # fmt: skip
        pushes = np.array([state.f_contact_nose for _, _, state in self.parts])
        force = pushes.sum(axis=0) + self.parts[-1][2].f_block_nose
        *projectile, speed = dynamics.audit(self.state, self.const, force)
        total = plies.sum(axis=0)
        block = self.backing.energies() if self.backing else np.zeros(len(coupling.NAMES))
        own = self._observe_plies(plies.sum(axis=1), pushes[:, 2])
        self.ply_samples.append(own)
        z = self.state.projectile_position[2] + self.const.foremost_offset
        energies = [total[0], *projectile, *total[1:], *block, *self.contact_energies()]
        return [speed, z, *own[:, :3].sum(axis=0)], energies

    def _observe_plies(self, energies, pushes):
        """(plies, 10) in the order of PLY_SAMPLES, from the plies' energies [J] and the forces on the nose [N]."""
        rows = []
        self._held = [held(state, const) if state.counter[kernels.FAILURES] else None for _, const, state in self.parts]
        for ply, ((panel, const, state), ends, energy, push, cloth) in enumerate(
            zip(self.parts, self._ends, energies, pushes, self._held)
        ):
            failed = ply_audit.failed_segments(panel, const, state) / self.share
            reactions = ply_audit.edge_reactions(panel, const, state, ends)
            deflection = ply_audit.deflection(const, state, cloth)
            own = failed, *reactions, -push / self.share, deflection, energy / self.share
            slip = max((float(np.abs(passed).max()) for passed in self.passed_lengths(ply)), default=0.0)
            rows.append([*own, *state.peak_tension, ply_audit.pull_in(const, state), slip])
        return np.array(rows)

    def _drop_sample(self):
        super()._drop_sample()
        self.ply_samples.pop()

    def ply_sample(self, name: str) -> FloatArray:
        """(n, plies) one column of the plies' samples."""
        return np.array([rows[:, PLY_SAMPLES.index(name)] for rows in self.ply_samples])

    @property
    def contact_force(self) -> FloatArray:
        """(n,) [N] along the normal on the whole projectile against its flight, from plies and block: the mean over the
        steps since the sample before, 0 at the first. The sum of force times interval is the momentum lost.

        A sample's velocity stands at its step, half of whose force has acted by then.
        """
        force = np.concatenate([[0.0], *(rows[:, 2] for rows in self.step_history)]) / -self.share
        last = np.cumsum([len(rows) for rows in self.step_history])
        impulse = np.concatenate([[0.0], np.cumsum(0.5 * (force[1:] + force[:-1]))])[[0, *last]]
        return np.diff(impulse, prepend=0.0) / np.maximum(np.diff(last, prepend=[0, 0]), 1)

    @property
    def peak_tensions(self) -> FloatArray:
        """(plies, 2, 4) `ply_audit.peak_tensions` of each ply, in its own warp and weft."""
        return np.array(
            [ply_audit.peak_tensions(panel, const, state, self.steps) for panel, const, state in self.parts]
        )

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """See ExplicitSolver."""
        return [(np.sqrt((np.array(state.v) ** 2).sum(axis=0)), speed_limit(const)) for _, const, state in self.parts]

    def where(self, part: int, node: int) -> str:
        """See ExplicitSolver."""
        row = self.parts[part][1].row_stride
        place = f"node ({int(node) // row}, {int(node) % row})"
        return place if len(self.parts) == 1 else f"ply {part + 1}, {place}"

    def sampled(self) -> None:
        """Sample the quality indicators, and end a run in which cut-out cloth is all that is left ahead of the nose."""
        self.monitor.sampled()
        failed = any(state.counter[kernels.FAILURES] for _, _, state in self.parts)
        if self.reason != RUNNING or not failed or self.backing is not None:
            return
        through = all(passed(state, const, cloth) for (_, const, state), cloth in zip(self.parts, self._held))
        self.perforated_samples = self.perforated_samples + 1 if through else 0
        if self.perforated_samples == 2:
            self.reason = PERFORATED

    def guard_model(self) -> None:
        """See ExplicitSolver. A projectile that flies over a graded panel keeps to its first zone."""
        for ply, (panel, const, state) in enumerate(self.parts):
            if panel.sides is None or not const.window_follows:
                continue
            nose, zone = state.projectile_position, panel.first_zone()
            if not grading.covers(zone, panel.lines(), nose, panel.reach(), panel.mirrors):
                x, y = 1e3 * nose[:2]
                where = f"its nose at x = {x:.1f} mm, y = {y:.1f} mm of ply {ply + 1}"
                self.stop("the projectile leaves the first zone of the grading", where)

    def checkpoint_identity(self) -> tuple[Any, str]:
        """See ExplicitSolver."""
        known: tuple[Any, ...] = (self.strike_velocity, self.steps_per_sample, self.history_request)
        known += self.panel.numerics.precision, self.panel.backing
        for _, const, state in self.parts:
            known += const._asdict(), state.mass, state.inverse_mass
        return known, self.module

    def checkpoint_arrays(self) -> dict[str, Any]:
        """See ExplicitSolver."""
        plies = {f"plies/{p:02d}": state for p, (_, _, state) in enumerate(self.parts)}
        return plies | {"monitor": self.monitor.found}

    def checkpoint_records(self) -> dict[str, list[Any]]:
        """See ExplicitSolver."""
        return super().checkpoint_records() | {"ply_samples": self.ply_samples, "histories": self.histories}

    def checkpoint_extra(self) -> dict[str, Any]:
        """See ExplicitSolver."""
        return self.backing.block.arrays() if self.backing else {}

    def restore_extra(self, arrays: Mapping[str, Any]) -> None:
        """See ExplicitSolver."""
        if self.backing:
            self.backing.block.restore(arrays)


class PanelSolver(ClothSolver):
    """One run of a panel.

    Parameters
    ----------
    panel : Panel
    strike_velocity, end_time, interval, energy_error_limit : as ExplicitSolver

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    def __init__(
        self, panel: Panel, strike_velocity: float, end_time: float, *, interval: float = 2e-6,
        energy_error_limit: float = 0.05,
    ) -> None:  # fmt: skip
        super().__init__(
            panel.projectile, strike_velocity, end_time, interval=interval, energy_error_limit=energy_error_limit
        )
        const, state, self._works = panel.constants(), panel.state(strike_velocity), [panel.work()]
        compile_ahead.begin(state, const, self._works[0])
        self._start(((panel, const, state),), panel.elements)
        self._works += [panel.work() for _ in range(1, self.threads)]

    def run_steps(self, history: FloatArray, shared: IntArray, count: int, allowed: float) -> tuple[int, int]:
        """See ClothSolver."""
        return kernels.run_thread(
            self.state, self.const, self._works[0], len(history), history, shared, 0, count, allowed
        )

    def run_worker(self, shared: IntArray, me: int) -> None:
        """See ExplicitSolver."""
        kernels.run_thread(self.state, self.const, self._works[me], 0, self._rows(0), shared, me, self.threads, np.inf)
