"""The explicit solver of a pack of plies; see `panel.solver`, whose ClothSolver a panel and a pack have in common.

The energies have two entries more than those of a panel: "ply_contact" and "ply_friction", the work done on the contact
between plies, and that of the friction there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fabrics.checks import FloatArray, IntArray
from shellfabric.jit.borrowed_list import Items
from shellfabric.panel.solver import ENERGIES, OBSERVED, ClothSolver
from shellfabric.panel.step_kernels import STEP
from shellfabric.plies import compile_ahead, contact_simd_kernels, step_kernels, torn_contact_kernels
from shellfabric.plies.model import Pack

PACK_ENERGIES = (*ENERGIES[:-1], "ply_contact", "ply_friction", ENERGIES[-1])
PACK_SAMPLES = (*OBSERVED, *PACK_ENERGIES)


class PackSolver(ClothSolver):
    """One run of a pack.

    Parameters
    ----------
    pack : Pack
    strike_velocity, end_time, interval, energy_error_limit : as ExplicitSolver

    Attributes
    ----------
    states, consts, stack, pairs, stops : what the kernels work on
    samples : in the order of PACK_SAMPLES; of the whole pack, forces summed over plies
    snapshots : list of tuples of Snapshot, one a ply, where a hook takes them

    The others are those of ClothSolver.

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    sample_names, energy_names = PACK_SAMPLES, PACK_ENERGIES
    contacts = (
        ("contact", "the contact with the nose"), ("ply_contact", "the contact between plies"),
        ("ply_friction", "the friction between plies"),
    )  # fmt: skip

    def __init__(
        self, pack: Pack, strike_velocity: float, end_time: float, *, interval: float = 2e-6,
        energy_error_limit: float = 0.05,
    ) -> None:  # fmt: skip
        super().__init__(
            pack.plies[0].projectile, strike_velocity, end_time, interval=interval,
            energy_error_limit=energy_error_limit,
        )  # fmt: skip
        self.pack = pack = pack.in_step_with(strike_velocity)
        self.consts, (self.states, self.stack) = pack.constants(), pack.states(strike_velocity)
        self.pairs = pack.pairs(self.consts, self.states)
        self.stops = pack.stops(self.consts, self.states)
        self._lists = tuple(Items(items) for items in (self.states, self.consts, self.pairs))
        self._works = [Items(pack.works())]
        if type(self) is PackSolver:
            compile_ahead.begin(self._lists, self._works[0], self.stack, self.stops)
        self._start(tuple(zip(pack.plies, self.consts, self.states)), pack.elements, len(pack.plies))
        self._works += [Items(pack.works()) for _ in range(1, self.threads)]

    @property
    def target(self) -> Pack:
        """See ClothSolver."""
        return self.pack

    @property
    def places(self) -> FloatArray:
        """See ClothSolver."""
        return self.pack.places

    _sum: Callable[..., float] = staticmethod(np.sum)  # in numpy's order, which differs from `sum` in the last digit

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.stack.counter[STEP])

    @property
    def peaks(self) -> FloatArray:
        """(plies, 2) [N] highest tension of warp and weft so far, each in the ply's own weave."""
        return np.array([state.peak_tension for state in self.states])

    @property
    def deepest(self) -> FloatArray:
        """See ClothSolver."""
        return self._of_pairs(contact_simd_kernels.MAX_DEPTH)

    @property
    def squeezed(self) -> FloatArray:
        """(plies - 1,) [-] furthest that the contact of a ply with the next has given way, over the thickness.

        `deepest` without what is found inside another fold of loose cloth, which loads no spring.
        """
        return self._of_pairs(contact_simd_kernels.MAX_COMPRESSION)

    def _of_pairs(self, entry):
        both = np.array([pair.energy[entry] / pair.thickness for pair in self.pairs])
        return both.reshape(2, -1).max(axis=0)[: len(self.states) - 1]

    @property
    def held_apart(self) -> FloatArray:
        """See ClothSolver."""
        return self.stops.energy[[torn_contact_kernels.CORRECTIONS, torn_contact_kernels.UNRESOLVED]]

    def run_steps(self, history: FloatArray, shared: IntArray, count: int, allowed: float) -> tuple[int, int]:
        """See ClothSolver."""
        states, consts, pairs = self._lists
        return step_kernels.run_thread(
            states, consts, pairs, self.stack, self.stops, self._works[0], len(history), history, shared, 0, count,
            allowed,
        )  # fmt: skip

    def run_worker(self, shared: IntArray, me: int) -> None:
        """See ExplicitSolver."""
        states, consts, pairs = self._lists
        step_kernels.run_thread(
            states, consts, pairs, self.stack, self.stops, self._works[me], 0, self._rows(0), shared, me, self.threads,
            np.inf,
        )  # fmt: skip

    def block_moves(self) -> bool:
        """See ClothSolver."""
        return bool(self.stack.awake[-1])

    def contact_energies(self) -> tuple[float, ...]:
        """(2,) [J] taken in by the contact between plies, and by the friction there."""
        taken = sum(pair.energy[contact_simd_kernels.WORK] for pair in self.pairs)
        rubbed = float(sum(pair.energy[contact_simd_kernels.FRICTION_WORK] for pair in self.pairs))
        return taken + self.stops.energy[torn_contact_kernels.WORK] - rubbed, rubbed

    def neighbour_forces(self, ply: int) -> list[Any]:
        """See ClothSolver: of both neighbours, and of torn cloth."""
        near, back = self.pairs[: len(self.pairs) // 2], self.pairs[len(self.pairs) // 2 :]
        found = [near[ply - 1].f_rear, back[ply - 1].f_front] if ply > 0 else []
        found += [near[ply].f_front, back[ply].f_rear] if ply < len(self.states) - 1 else []
        return [*found, self.stops.f[ply]]

    def normal_contact_forces(self, ply: int) -> list[FloatArray]:
        """See ClothSolver: of the projectile, of the plies in front and behind, and of torn cloth along the flight."""
        pressing, forces = super().normal_contact_forces(ply), [force[2] for force in self.neighbour_forces(ply)]
        nothing, split = np.zeros_like(pressing[0]), 2 if ply > 0 else 0
        nose, front, rear = pressing if self.backing else (*pressing, nothing, nothing)
        return [nose, sum(forces[:split], front), rear - sum(forces[split:-1], nothing), forces[-1][: nothing.size]]

    def guard_model(self) -> None:
        """Stop a run in which whole cloth has come through whole cloth."""
        super().guard_model()
        half = len(self.pairs) // 2
        for p, pair in enumerate(self.pairs):
            if pair.energy[contact_simd_kernels.PASSED_COUNT]:
                one, other = (p, p + 1) if p < half else (p - half + 1, p - half)
                rows, j = divmod(int(pair.energy[contact_simd_kernels.PASSED_POINT]), self.consts[one].nj)
                i = rows // pair.points_per_side**2
                step = int(pair.energy[contact_simd_kernels.PASSED_STEP])
                self.stop(
                    f"ply {one + 1} has come through ply {other + 1}", f"ply {one + 1}, element ({i}, {j})",
                    f"after {step * self.const.dt * 1e6:.3g} us (step {step})",
                )  # fmt: skip

    def checkpoint_identity(self) -> tuple[Any, str]:
        """See ExplicitSolver."""
        known, module = super().checkpoint_identity()
        return (*known, self.pack.gaps, self.pack.contact, self.pack.friction, self.pack.laws), module

    def checkpoint_arrays(self) -> dict[str, Any]:
        """See ExplicitSolver. Of what holds torn cloth apart, the rest follows from the plies."""
        pairs = {f"pairs/{p:02d}": pair for p, pair in enumerate(self.pairs)}
        stops = {f"stops/{name}": getattr(self.stops, name) for name in ("f", "window", "energy")}
        return super().checkpoint_arrays() | pairs | stops | {"stack": self.stack}
