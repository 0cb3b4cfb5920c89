"""Packs whose yarns slide through their crossovers: the pack, and its explicit solver.

Each ply has the fluxes and shares of `sliding.model`. Contact and friction between plies act on the nodes, as in a pack
of pinned plies: the yarn that moves through a node does not rub on the next ply.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from fabrics.checks import FloatArray, IntArray
from fabrics.errors import InputError
from shellfabric.jit.borrowed_list import Items
from shellfabric.panel.model import Panel
from shellfabric.panel.solver import OBSERVED, ClothSolver
from shellfabric.plies.model import Pack
from shellfabric.plies.solver import PACK_ENERGIES, PackSolver
from shellfabric.projectile import dynamics
from shellfabric.sliding import solver as sliding
from shellfabric.sliding.model import SlidingPanel, Slip
from shellfabric.sliding.solver import SLIP_WORK, SlipSummary, ply_energies, slip_arrays
from shellfabric.sliding_plies import step_kernels as kernels

SLIDING_PACK_ENERGIES = (*PACK_ENERGIES[:-1], *SLIP_WORK, "error")


class SlidingPack(Pack):
    """A Pack of SlidingPanels; parameters as Pack.

    Raises
    ------
    InputError : as Pack
    """

    @property
    def friction_of_crossovers(self) -> tuple[Any, ...]:
        """(plies,) CrossoverFriction."""
        return tuple(cast(SlidingPanel, ply).friction for ply in self.plies)

    def _slip_constants(self, mass, stiffness):
        """Stick between plies is bounded by the mass of one family alone, where the other slides through the nodes."""
        lightest = min(1.0 if ply.friction.pins else min(ply.own_masses) for ply in self.plies)
        return super()._slip_constants(lightest * mass, stiffness)


class SlidingPackSolver(PackSolver):
    """One run of a pack with sliding crossovers.

    Parameters
    ----------
    pack : SlidingPack
    strike_velocity, end_time, interval, energy_error_limit : as ExplicitSolver

    Attributes
    ----------
    slips : (plies,) sliding.model.Slip

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    energy_names = SLIDING_PACK_ENERGIES
    sample_names = (*OBSERVED, *SLIDING_PACK_ENERGIES)

    def _start(self, parts, elements, most_threads=np.inf):
        """Lay out the slip of each ply before the first sample."""
        panels, consts, states = zip(*parts)
        self.slips: tuple[Slip, ...] = tuple(panel.slip(state) for panel, state in zip(panels, states))
        self._effective = [state._replace(stretch=slip.x) for state, slip in zip(states, self.slips)]
        room = lambda state: tuple(np.zeros_like(force) for force in state.f_contact)  # noqa: E731
        self._loaded = [state._replace(f_contact=room(state)) for state in states]
        self._plies = tuple(Items(items) for items in (states, self._effective, self._loaded, consts, self.slips))
        self._pair_works = [self._works_of_a_thread()]
        super()._start(parts, elements, most_threads)
        self._pair_works += [self._works_of_a_thread() for _ in range(1, self.threads)]

    def _works_of_a_thread(self):
        """(scratch, the same with room for the effective stretches) of one thread, each a list of the plies'."""
        works, found = self.pack.works(), {}
        for work in works:
            if id(work) not in found:
                room = {name: np.zeros_like(getattr(work, name)) for name in ("stretch1", "stretch2")}
                found[id(work)] = work._replace(**room)
        return Items(works), Items([found[id(work)] for work in works])

    def run_steps(self, history: FloatArray, shared: IntArray, count: int, allowed: float) -> tuple[int, int]:
        """See ClothSolver."""
        return kernels.run_thread(
            self._plies, self._lists[2], self.stack, self.stops, self._pair_works[0], len(history), history, shared, 0,
            count, allowed,
        )  # fmt: skip

    def run_worker(self, shared: IntArray, me: int) -> None:
        """See ExplicitSolver."""
        kernels.run_thread(
            self._plies, self._lists[2], self.stack, self.stops, self._pair_works[me], 0, self._rows(0), shared, me,
            self.threads, np.inf,
        )  # fmt: skip

    def _ply_energies(self, ply):
        """(12,) [J] of a ply, as ply_audit.energies, with those of its slip."""
        _, const, state = self.parts[ply]
        loaded = self._loaded_state(ply)
        effective = loaded._replace(stretch=state.stretch), loaded._replace(stretch=self.slips[ply].x)
        return ply_energies(effective, const, self.slips[ply], self._rest[ply])

    def observe(self) -> tuple[Sequence[float], Sequence[float]]:
        """See ExplicitSolver."""
        plies = np.array([self._ply_energies(ply) for ply in range(len(self.parts))])
        pushes = np.array([state.f_contact_nose for _, _, state in self.parts])
        *projectile, speed = dynamics.audit(self.state, self.const, pushes.sum(axis=0))
        total = plies.sum(axis=0)
        own = self._observe_plies(plies.sum(axis=1), pushes[:, 2])
        self.ply_samples.append(own)
        z = self.state.projectile_position[2] + self.const.foremost_offset
        work = np.sum([slip.work for slip in self.slips], axis=0)
        block = np.zeros(len(self.energy_names) - len(total) - len(projectile) - len(work) - 3)
        energies = [total[0], *projectile, *total[1:], *block, *self.contact_energies(), *work]
        return [speed, z, *own[:, :3].sum(axis=0)], energies

    def passed_lengths(self, ply: int) -> tuple[FloatArray, ...]:
        """See ClothSolver."""
        return tuple(self.slips[ply].passed)

    def slip_summaries(self) -> tuple[SlipSummary, ...]:
        """See ClothSolver."""
        plies = zip(self.pack.plies, self.states, self.slips)
        return tuple(SlipSummary.of(panel, state, slip, self.share) for panel, state, slip in plies)

    def checkpoint_identity(self) -> tuple[Any, str]:
        """See ExplicitSolver."""
        known, module = super().checkpoint_identity()
        return (*known, cast(SlidingPack, self.pack).friction_of_crossovers), module

    def checkpoint_arrays(self) -> dict[str, Any]:
        """See ExplicitSolver."""
        found: dict[str, Any] = {}
        for p, slip in enumerate(self.slips):
            found |= slip_arrays(slip, f"slip/{p:02d}")
        return super().checkpoint_arrays() | found


def pack_of(ply: Any, plies: int, **others: Any) -> Pack:
    """The pack of a first ply, by its crossovers; parameters as Pack.stacked."""
    return _kind(ply).stacked(ply, plies, **others)


def laid_up(plies: Sequence[tuple[Any, bool]], **others: Any) -> Pack:
    """The pack of a lay-up, by its crossovers; parameters as Pack.laid_up."""
    return _kind(plies[0][0]).laid_up(plies, **others)


def _kind(ply):
    return SlidingPack if isinstance(ply, SlidingPanel) else Pack


def solver_of(pack: Panel | Pack, strike_velocity: float, end_time: float, **others: Any) -> ClothSolver:
    """The solver of a pack or of a single ply, by its crossovers; parameters as PackSolver and PanelSolver.

    Raises
    ------
    InputError : sliding plies in a pack that is none of sliding plies
    """
    if isinstance(pack, Panel):
        return sliding.solver_of(pack, strike_velocity, end_time, **others)
    if isinstance(pack, SlidingPack):
        return SlidingPackSolver(pack, strike_velocity, end_time, **others)
    if any(isinstance(ply, SlidingPanel) for ply in pack.plies):
        raise InputError(key="crossovers", value="sliding", allowed="pinned in a Pack that is no SlidingPack")
    return PackSolver(pack, strike_velocity, end_time, **others)
