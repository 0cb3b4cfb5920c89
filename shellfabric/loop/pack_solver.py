"""The explicit solver of a panel: of one ply, or of a pack of several.

The energies of the plies add up (`ply_audit`); projectile and backing block, where there is one
behind the last ply, have theirs. Several plies have the work done on the contact between them
besides, and the work of the friction there. Threads share
the plies of a pack; the results are the same to the last bit with any number of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from shellfabric.block import coupling
from shellfabric.guards import ENERGY_ERROR_LIMIT, speed_limit
from shellfabric.jit import barrier
from shellfabric.jit.compile import compiling_units
from shellfabric.jit.table import UNIFORM, Rows
from shellfabric.loop import compile_ahead, dent_checks, loop, ply_audit
from shellfabric.loop import pack_memory as memory
from shellfabric.loop.driver import OUTCOMES, PERFORATED, RUNNING, STOPPED, ExplicitSolver
from shellfabric.membrane import edges, quality
from shellfabric.membrane.indicator import Indicator
from shellfabric.membrane.model import Panel
from shellfabric.membrane.perforation import held, nothing_ahead, passed
from shellfabric.metal import body as metal
from shellfabric.parts import make_table, parts_of
from shellfabric.plies import near_kernels
from shellfabric.plies.arrays import on_grids
from shellfabric.plies.frame_kernels import BEFORE, BEHIND
from shellfabric.plies.model import Pack
from shellfabric.projectile import dynamics, frames
from shellfabric.state import Constants
from shellfabric.yarns.past_ply import nodes_past

FAULTS = {
    near_kernels.NOT_RESOLVED: "has not converged",
    near_kernels.NO_ROOM: "has no room for more facets that are near each other",
    near_kernels.CROSSED: "has found facets that cross",
}
# a contact can store and lose energy, but not give any
CONTACTS = {
    "contact": "the contact with the nose",
    "ply_contact": "the contact between plies",
    "ply_friction": "the friction between plies",
    "ply_collisions": "the guard between plies",
}
# what makes the parts of a run besides those of its plies: (pack, constants, velocity) -> parts
OF_A_RUN = dynamics.make_bodies, metal.make_bodies, coupling.make_blocks
ALONE_INTERVAL = 2e-5  # [s] between samples, about, while a part goes on alone
PLY_SAMPLES = (
    "cut_yarns",
    "reaction_warp",
    "reaction_weft",
    "push",
    "deflection",
    "energy",
    "peak_warp",
    "peak_weft",
    "pull_in",
    "critical_strain_warp",
    "critical_strain_weft",
)


class PackSolver(ExplicitSolver):
    """One run of one ply or several.

    Parameters
    ----------
    target : Pack, or the Panel of a single ply
    strike_velocity, end_time, interval, energy_error_limit : as ExplicitSolver

    Attributes
    ----------
    pack : Pack, of one ply too
    plies : ((Panel, Constants, State), ...) of the plies, in the order in which the projectile
        meets them
    parts : (plies, ...) of parts.Part, what acts in the step of each ply
    panel, const, state : of the first ply
    states, consts, stack, contact : what the kernels work on; of a single ply the contact between
        plies has no points
    ply_samples : list of (plies, 11), one a sample, in the order of PLY_SAMPLES: of the whole ply;
        `push` is the force of the nose on it, `deflection` the largest of its fabric
        (`ply_audit.deflection`), `energy` what it moves with, stores and has lost, the peaks its
        highest tensions so far [N] (`peak_tensions`), `pull_in` [m] the largest displacement of a yarn's end
        out of its clamp, the critical strains those of the fabric where a yarn is nearest to its
        strength (`ply_audit.critical_strains`)
    step_history : `dynamics.columns` of the projectile: z [m], velocity [m/s] and force [N] (of the
        modelled part), and of a bar velocities [m/s] and places [m] of tip, tail and centre of mass
    samples : of the whole panel, forces summed over plies
    snapshots : list of tuples of Snapshot, one a ply, where a hook takes them
    measure, histories : what a histories.Recorder records, where there is one, and its rows
    monitor : quality.Monitor, what the quality indicators need besides the result
    alone_from : [s] from which on a part goes on alone, and plies and projectile stay as they are;
        NaN where none does
    alone_for : [s] for which it has

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive, or more elements than
        memory holds
    """

    counters = (*ExplicitSolver.counters, "alone_from", "alone_for")
    module = "shellfabric.impact.run"  # whose code determines a run

    def __init__(
        self,
        target: Panel | Pack,
        strike_velocity: float,
        end_time: float,
        *,
        interval: float = 2e-6,
        energy_error_limit: float = ENERGY_ERROR_LIMIT,
    ) -> None:
        pack = Pack.of(target)
        memory.check(pack.plies)
        super().__init__(
            pack.plies[0].projectile,
            strike_velocity,
            end_time,
            interval=interval,
            energy_error_limit=energy_error_limit,
        )
        self.pack = pack
        self.consts = pack.constants()
        self.states, self.stack = pack.states(strike_velocity)
        self.contact = pack.plies_contact(self.consts, self.states)
        if len(pack.plies) > 1:
            self.states = on_grids(self.states, self.contact)
        self._graded = self.consts[0]._numba_type_ != Constants.types[UNIFORM]
        self.parts = self._join_parts()
        self._loaded: dict[int, Any] = {}
        self.plies = tuple(zip(pack.plies, self.consts, self.states))
        self.panel, self.const, self.state = self.plies[0]
        contacts = dict(CONTACTS)
        for part, _ in self._all_parts():
            contacts |= part.contacts
        self.contacts = contacts
        self._begin_run()

    def _join_parts(self):
        """Make the parts of the run, and have the steps of the plies call them and those of their
        own; the parts of each ply."""
        found = [list(parts_of(state.parts)) for state in self.states]
        for make in OF_A_RUN:
            for part in make(self.pack, self.consts, self.strike_velocity):
                found[part.ply].append(part)
        made = [part for parts in found for part in parts]
        for part in made:
            part.join(made)
        tables = [
            make_table(parts, self._graded, state) for parts, state in zip(found, self.states)
        ]
        self.states = tuple(
            state._replace(parts=table) for state, table in zip(self.states, tables)
        )
        self.consts = tuple(self._seen(p, const, found) for p, const in enumerate(self.consts))
        for part in made:
            if part.motion is not None:
                self.stack = self.stack._replace(motion=part.motion)
        return tuple(map(tuple, found))

    def _seen(self, ply, const, parts):
        """The constants of a ply with what it sees of its own parts, and of those of the run."""
        for place, own in enumerate(parts):
            for part in own:
                if place == ply or not part.of_ply:
                    const = part.seen(const, ply)
        return const

    def _all_parts(self):
        """((part, state of the ply in whose step it acts), ...)."""
        return [(part, state) for parts, state in zip(self.parts, self.states) for part in parts]

    def part(self, name: str) -> Any:
        """Return the first part of a name, or None."""
        for part, _ in self._all_parts():
            if part.name == name:
                return part
        return None

    @property
    def replaces_membrane(self) -> bool:
        """Whether a part stands in for the membrane under the nose."""
        return any(state.parts.replaces_membrane for state in self.states)

    def _begin_run(self):
        """Lay out what the kernels take, and take the first sample of the plies at rest."""
        pack = self.pack
        plies = len(self.plies)
        self._plies = Rows(self.states), Rows(self.consts)
        self._works = [Rows(pack.works())]
        compile_ahead.fill(int(self._graded), plies > 1)
        self.share = self.panel.share
        threads = barrier.threads_for(self.panel.numerics.threads, pack.elements)
        self.threads = min(threads, plies)  # which share the plies
        self.reduces_threads = self.panel.numerics.threads is None
        self.history_columns = len(dynamics.columns(self.stack.motion))
        self.ply_samples = []
        self.history_request = None
        self.histories = []
        self.alone_from = np.nan
        self.alone_for = 0.0
        # the forces at rest
        self._run_thread(self._rows(0), np.zeros(barrier.SLOTS, np.int64), 0, 1, np.inf)
        for parts, state, const in zip(self.parts, self.states, self.consts):
            for part in parts:
                part.begin(state, const, self.stack)
        self._works += [Rows(pack.works()) for _ in range(1, self.threads)]
        self._ends = [edges.ends(panel) for panel in pack.plies]
        self._rest = [ply_audit.stored_energy(const, state) for _, const, state in self.plies]
        self.monitor = quality.Monitor(self)
        self._begin(self.const.dt)

    @property
    def deepest(self) -> FloatArray:
        """(plies - 1,) [-] furthest that a ply and those behind it have closed, over the mean
        thickness of two."""
        thickness = self.contact.thickness
        closed = self.contact.pressure.max_closure[:-1]
        return closed / (0.5 * (thickness[1:] + thickness[:-1]))

    @property
    def step_loss(self) -> float:
        """[-] energy error of the last sample, with what yarns lose that stiffen in a step, over the
        strike energy; that of a run is at its end, so that no sampling decides on a shorter step."""
        both = self.sample("error") - self.sample("yarn_snap")
        return float(abs(both[-1]) / self.strike_energy)

    @property
    def part_indicators(self) -> tuple[Indicator, ...]:
        """Those of the parts."""
        found = list(quality.worst(part.indicators() for part, _ in self._all_parts()))
        found += dent_checks.indicators(self)
        return tuple(found)

    @property
    def held_apart(self) -> int:
        """[-] impulses that kept plies from passing through each other."""
        return int(self.contact.guard.n_impulses)

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.stack.steps)

    @property
    def time(self) -> float:
        """[s]"""
        return super().time + self.alone_for

    @property
    def fabric_ended(self) -> bool:
        """Whether plies and projectile stay as they are, and a part goes on alone."""
        return bool(np.isfinite(self.alone_from))

    @property
    def ended(self) -> bool:
        """Whether the run is over."""
        return super().ended or self.time >= self.end_time

    def _advance_to_sample(self):
        if not self.fabric_ended:
            super()._advance_to_sample()
            return
        if not self._shared[barrier.STOP]:
            self.advance(self._rows(0))  # lets the workers go, who would wait to the end
        part, _ = self._alone
        with self._clock():
            self.alone_for += part.go_on(ALONE_INTERVAL)
        self.step_history.append(self._rows(0))

    def _part_has_left(self):
        """Whether a part goes on alone from this sample."""
        return any(part.has_left(state) for part, state in self._all_parts())

    @property
    def _alone(self):
        """(part, state) of the part that goes on alone: the one that bears it."""
        return next(pair for pair in self._all_parts() if pair[0].goes_on)

    def run_worker(self, shared: IntArray, me: int) -> None:
        """Run the share of a thread, see ExplicitSolver."""
        self._run_thread(self._rows(0), shared, me, self.threads, np.inf)

    def _run_thread(self, history, shared, me, count, allowed):
        ply_arrays = (*self._plies, self.contact, self.stack, self._works[me])
        try:
            with compiling_units():
                return loop.advance(*ply_arrays, history, shared, me, count, allowed)
        except BaseException:
            shared[barrier.STOP] = barrier.ABORTED
            raise

    def neighbour_forces(self, ply: int) -> list[FloatArray]:
        """Return the forces [(3, slots) [N]] on the nodes of a ply by the plies before it and by
        those behind; [] of a single ply."""
        if len(self.plies) == 1:
            return []
        return list(self.contact.pressure.force[ply][:, :, : self.states[ply].mass.size])

    def normal_contact_forces(self, ply: int) -> list[FloatArray]:
        """Return the forces [(slots,)] [N] on the nodes of a ply along the normal, positive where
        they press on it: of the projectile; of several plies, or before a block, also of what is in
        front, and of what is behind.
        """
        state = self.states[ply]
        nose = state.f_contact[2]
        front = 0 * nose
        rear = 0 * nose
        before_block = state.f_block_cloth[2].size > 0
        if before_block:
            rear = -state.f_block_cloth[2]
        neighbours = self.neighbour_forces(ply)
        if neighbours:
            front = neighbours[BEFORE][2].copy()
            rear = rear - neighbours[BEHIND][2]
        if neighbours or before_block:
            return [nose, front, rear]
        return [nose]

    def _loaded_state(self, ply):
        """State of a ply, its contact forces those of all that touches it."""
        state = self.states[ply]
        neighbours = self.neighbour_forces(ply)
        if not neighbours:
            return state
        if ply not in self._loaded:
            self._loaded[ply] = state._replace(f_contact=np.array(state.f_contact))
        for loaded, nose, *others in zip(self._loaded[ply].f_contact, state.f_contact, *neighbours):
            loaded[:] = nose + sum(others)
        return self._loaded[ply]

    def _contact_energies(self):
        """{name: [J]} taken in by the contact between plies, of which it holds or damps the first
        and has lost the second with dropped elements; by the friction there and by collisions of
        plies, in the guard."""
        rubbed = float(self.contact.pressure.friction_work.sum())
        lost = float(self.contact.pressure.lost_energy.sum())
        return {
            "ply_contact": float(self.contact.pressure.work.sum()) - rubbed - lost,
            "ply_contact_lost": lost,
            "ply_friction": rubbed,
            "ply_collisions": float(self.contact.guard.work),
        }

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """Advance by steps, see ExplicitSolver."""
        return self._run_thread(history, self._shared, 0, self.threads, self.allowed_exchange)

    def observe(self) -> tuple[dict[str, float], dict[str, float]]:
        """Return what a sample has, see ExplicitSolver."""
        if self.fabric_ended:
            return self._observe_alone()
        plies = [
            ply_audit.energies(const, self._loaded_state(ply), self._rest[ply])
            for ply, const in enumerate(self.consts)
        ]
        pushes = np.array([state.f_contact_nose for state in self.states])
        force = np.array([self._of_first(ply, push) for ply, push in enumerate(pushes)]).sum(axis=0)
        force += self._of_first(-1, self.states[-1].f_block_nose)
        for part, state in self._all_parts():
            part.show(state)
        energies, speed = dynamics.audit(self.state, self.const, force, self.stack.motion)
        for one in plies:
            ply_audit.add_energies(energies, one)
        energies |= dict.fromkeys(coupling.NAMES, 0.0)  # of every run, for its tables
        samples: dict[str, float] = {}
        for part, _ in self._all_parts():
            samples |= part.samples()
            if not part.of_ply:
                ply_audit.add_energies(energies, part.energies())
        if len(plies) > 1:
            energies |= self._contact_energies()
        own = self._observe_plies([sum(one.values()) for one in plies], pushes[:, 2])
        self.ply_samples.append(own)
        observed = {
            "v": speed,
            "z": self.state.projectile_position[2] + self.const.foremost_offset,
        }
        observed |= dict(zip(PLY_SAMPLES[:3], own[:, :3].sum(axis=0)))
        return observed | samples, energies

    def energy_made(self) -> dict[str, float]:
        """Return what the parts have made, and the rest of the run, see ExplicitSolver."""
        made: dict[str, float] = {}
        for part, _ in self._all_parts():
            made |= part.energy_made()
        if made:
            rest = self.sample("error")[-1] * self.share - sum(made.values())
            made["the rest of the run"] = float(rest)
        return made

    def _observe_alone(self):
        """What a sample has while a part goes on alone: the rest as at the last sample."""
        last = dict(zip(self.sample_names, self.samples[-1]))
        energies = {name: last[name] * self.share for name in self.energy_names[:-1]}
        observed = {name: last[name] for name in self.sample_names[1:] if name not in energies}
        del observed["error"]
        part, _ = self._alone
        self.ply_samples.append(self.ply_samples[-1].copy())
        return observed | part.samples(), energies | part.energies()

    def _of_first(self, ply, vector):
        """A vector (3,) of the frame of a ply in that of the first."""
        angles = self.pack.angles
        return frames.turned_back(vector, frames.axes(angles[ply] - angles[0]))

    def _observe_plies(self, energies, pushes):
        """(plies, 11) in the order of PLY_SAMPLES, from the plies' energies [J] and the forces on
        the nose [N]."""
        rows = []
        self._held = []
        for ply, (panel, const, state) in enumerate(self.plies):
            held_elements = None
            if state.failures:
                held_elements = held(state, const)
            self._held.append(held_elements)
            row = [
                ply_audit.cut_yarns(panel, const, state),
                *ply_audit.edge_reactions(panel, const, state, self._ends[ply]),
                -pushes[ply] / self.share,
                ply_audit.deflection(const, state, held_elements),
                energies[ply] / self.share,
                *state.peak_tension,
                ply_audit.pull_in(const, state),
                *ply_audit.critical_strains(panel, const, state),
            ]
            rows.append(row)
        return np.array(rows)

    def _drop_sample(self):
        super()._drop_sample()
        self.ply_samples.pop()

    @property
    def largest_deflection(self) -> float:
        """[m] of the last ply; NaN of a panel that is perforated, whose torn ends fly by chance: mirror
        images of one shot differ by 5 %."""
        if self.outcome == OUTCOMES[PERFORATED]:
            return np.nan
        return float(self.ply_sample("deflection")[:, -1].max())

    def ply_sample(self, name: str) -> FloatArray:
        """Return one column (n, plies) of the plies' samples."""
        return np.array([rows[:, PLY_SAMPLES.index(name)] for rows in self.ply_samples])

    @property
    def contact_force(self) -> FloatArray:
        """(n,) [N] along the normal on the whole projectile against its flight, from plies and
        block: the mean over the steps since the sample before, 0 at the first. The sum of force
        times interval is the momentum lost.

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
            [
                ply_audit.peak_tensions(panel, const, state, self.steps)
                for panel, const, state in self.plies
            ]
        )

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """Return the speeds of the nodes, see ExplicitSolver."""
        limit = lambda panel: speed_limit(self.strike_velocity, panel.weave.yarns)  # noqa: E731
        found = [
            (np.sqrt((np.array(state.v) ** 2).sum(axis=0)), limit(panel))
            for panel, _, state in self.plies
        ]
        return found + [speeds for _, speeds in self._moving_parts()]

    def _moving_parts(self):
        """[(part, its `Part.speeds`)] of those that have nodes of their own."""
        found = [(part, part.speeds(self.strike_velocity)) for part, _ in self._all_parts()]
        return [(part, speeds) for part, speeds in found if speeds is not None]

    def where(self, part: int, node: int) -> str:
        """Say where a node is, see ExplicitSolver."""
        if part >= len(self.plies):
            mover, _ = self._moving_parts()[part - len(self.plies)]
            return mover.where(node)
        row = self.plies[part][1].row_stride
        place = f"node ({int(node) // row}, {int(node) % row})"
        if len(self.plies) == 1:
            return place
        return f"ply {part + 1}, {place}"

    def sampled(self) -> None:
        """Sample the quality indicators, and end a run that has gone on after the stop.

        The guard makes its lists anew, as a run does that is resumed here: they have an order.
        """
        if not self.fabric_ended:
            self.monitor.sampled(self)
            self._count_past()
        self.contact.lists.remake = 1
        turned = int(self.stack.stop_step)
        if turned and (
            self.time - turned * self.const.dt >= self.stack.after_stop
            or self.steps >= self.last_step
            or self.time >= self.end_time
        ):
            self.reason = STOPPED
        elif turned and not self.fabric_ended and self._part_has_left():
            self.alone_from = self.time

    def look(self) -> int:
        """Tell whether only cut-out fabric is left ahead of the nose, and none before a block, see
        ExplicitSolver. The kernels ask by a clock of their own: samples do not move the end of a run."""
        meets_parts = any(part.meets_nose for part, _ in self._all_parts())
        clear: Callable[..., bool] = nothing_ahead if meets_parts else passed
        if all(clear(state, const) for _, const, state in self.plies):
            return PERFORATED
        return RUNNING

    def _count_past(self):
        """Count the nodes of resolved yarns that are past the next ply, at every EVERY-th sample."""
        if len(self.plies) == 1 or len(self.samples) % quality.EVERY:
            return
        for p, apart in enumerate(np.diff(self.pack.places)):
            for zone in (part.zone for part in self.parts[p] if part.name == "yarns"):
                both = zip(*self.plies[p : p + 2])
                past = int(np.count_nonzero(nodes_past(zone, *both, float(apart))))
                zone.most_past = max(zone.most_past, past)

    def guard_model(self) -> None:
        """Check the guards of the parts and of a pack, see ExplicitSolver."""
        for part, state in self._all_parts():
            wrong = part.guard(state)
            if wrong is not None:
                self.stop(*wrong)
        fault = int(self.contact.guard.fault)
        if fault:
            self.stop(f"the guard between plies {FAULTS[fault]}", "the pack")

    def checkpoint_identity(self) -> tuple[Any, str]:
        """Return what determines the run, see ExplicitSolver."""
        pack = self.pack
        known: tuple[Any, ...] = (self.strike_velocity, self.steps_per_sample, self.history_request)
        known += (
            pack.gaps,
            pack.contact,
            pack.friction,
            pack.laws,
            pack.angles,
        )
        for parts, (_, const, state) in zip(self.parts, self.plies):
            known += _at_rest(const), state.mass, state.inverse_mass
            known += tuple(part.identity() for part in parts)
        return known, self.module

    def checkpoint_arrays(self) -> dict[str, Any]:
        """Return the arrays of the state, see ExplicitSolver. Of the contact between plies, the
        rest follows from what its tables keep."""
        found: dict[str, Any] = {f"plies/{p:02d}": state for p, state in enumerate(self.states)}
        for p, parts in enumerate(self.parts):
            for number, part in enumerate(parts):
                place = f"parts/{p:02d}/{number:02d} {part.name}"
                found |= {f"{place}/{name}": row for name, row in part.rows().items()}
        return found | {
            "contact": self.contact,
            "contact/lists": self.contact.lists,
            "contact/pressure": self.contact.pressure,
            "contact/guard": self.contact.guard,
            "stack": self.stack,
            "monitor": self.monitor.found,
            "coarse depth": self.monitor.coarse_depth,
            "fastest nodes": self.monitor.fastest,
        }

    def checkpoint_records(self) -> dict[str, list[Any]]:
        """Return the records, see ExplicitSolver."""
        return super().checkpoint_records() | {
            "ply_samples": self.ply_samples,
            "histories": self.histories,
        }


def _at_rest(const):
    """{name: value} of the constants of a ply, but for the profile of a body that changes: that
    follows from the part which moves it."""
    known = const.nested()
    nose = {name: value for name, value in known["nose"].items() if name != "profile"}
    return known | {"nose": nose}
