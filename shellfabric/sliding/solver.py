"""The explicit solver of a panel with sliding crossovers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.checks import FloatArray, IntArray
from shellfabric.panel import ply_audit
from shellfabric.panel.model import Panel
from shellfabric.panel.solver import ENERGIES, OBSERVED, ClothSolver, PanelSolver
from shellfabric.projectile import dynamics
from shellfabric.sliding import step_kernels as kernels
from shellfabric.sliding.flow_kernels import PULLED_OUT
from shellfabric.sliding.model import SlidingPanel, Slip, grid

SLIP_WORK = ("crossover_friction", "crossover_stops", "slip_residual")  # of slip.work, see `slip_energy_kernels`
STORED_FORCES = ("friction", "stop", "residual")  # of the last step, from which the work of the next is computed
SLIDING_ENERGIES = (*ENERGIES[:-1], *SLIP_WORK, "error")


@dataclass(frozen=True)
class SlipSummary:
    """What the slip of a run came to.

    Parameters
    ----------
    pulled_out_length : [m] longest length of yarn that has passed through a crossover
    largest_window : [m] widest distance between neighbouring yarns at the end, along whole segments
    pulled_out_segments : segments whose yarn end has left a crossover, without failure, of the modelled part
    friction_work : [J] work of friction at the crossovers, of the whole panel
    """

    pulled_out_length: float
    largest_window: float
    pulled_out_segments: int
    friction_work: float

    @classmethod
    def of(cls, panel: Panel, state: Any, slip: Slip, share: float) -> SlipSummary:
        """The summary of a ply, of which the part `share` is modelled."""
        windows = [0.0]
        for stretch, intact, side in zip(state.stretch, state.intact_fraction, panel.spacing):
            whole = grid(intact, panel) > 0
            if whole.any():
                windows.append(float(side * grid(stretch, panel)[whole].max()))
        return cls(
            pulled_out_length=float(max(np.abs(passed).max() for passed in slip.passed)),
            largest_window=max(windows),
            pulled_out_segments=int(slip.counter[PULLED_OUT]),
            friction_work=float(slip.work[0]) / share,
        )


class SlidingSolver(ClothSolver):
    """One run of a panel with sliding crossovers, by one thread.

    Parameters
    ----------
    panel : SlidingPanel
    strike_velocity, end_time, interval, energy_error_limit : as ExplicitSolver

    Attributes
    ----------
    slip : model.Slip

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    energy_names = SLIDING_ENERGIES
    sample_names = (*OBSERVED, *SLIDING_ENERGIES)

    def __init__(
        self, panel: SlidingPanel, strike_velocity: float, end_time: float, *, interval: float = 2e-6,
        energy_error_limit: float = 0.05,
    ) -> None:  # fmt: skip
        super().__init__(
            panel.projectile, strike_velocity, end_time, interval=interval, energy_error_limit=energy_error_limit
        )
        const, state, work = panel.constants(), panel.state(strike_velocity), panel.work()
        self.slip = panel.slip(state)
        self._states = state, state._replace(stretch=self.slip.x)
        effective = {name: np.zeros_like(getattr(work, name)) for name in ("stretch1", "stretch2")}
        self._works = work, work._replace(**effective)
        self._start(((panel, const, state),), panel.elements, most_threads=1)

    def run_steps(self, history: FloatArray, shared: IntArray, count: int, allowed: float) -> tuple[int, int]:
        """See ClothSolver."""
        return kernels.run_steps(self._states, self.const, self.slip, self._works, len(history), history, allowed)

    def run_worker(self, shared: IntArray, me: int) -> None:
        """See ExplicitSolver: there is one thread."""

    def observe(self) -> tuple[Sequence[float], Sequence[float]]:
        """See ExplicitSolver."""
        _, const, state = self.parts[0]
        ply = ply_energies(self._states, const, self.slip, self._rest[0])
        *projectile, speed = dynamics.audit(self.state, const, state.f_contact_nose)
        own = self._observe_plies(np.array([ply.sum()]), np.array([state.f_contact_nose[2]]))
        self.ply_samples.append(own)
        z = state.projectile_position[2] + const.foremost_offset
        energies = [ply[0], *projectile, *ply[1:], *np.zeros(len(ENERGIES) - len(ply) - 4), *self.slip.work]
        return [speed, z, *own[:, :3].sum(axis=0)], energies

    def passed_lengths(self, ply: int) -> tuple[FloatArray, ...]:
        """See ClothSolver."""
        return tuple(self.slip.passed)

    def slip_summaries(self) -> tuple[SlipSummary, ...]:
        """See ClothSolver."""
        return (SlipSummary.of(self.panel, self.state, self.slip, self.share),)

    def checkpoint_identity(self) -> tuple[Any, str]:
        """See ExplicitSolver."""
        known, module = super().checkpoint_identity()
        return (*known, self.panel.friction), module

    def checkpoint_arrays(self) -> dict[str, Any]:
        """See ExplicitSolver."""
        return super().checkpoint_arrays() | slip_arrays(self.slip, "slip")


def ply_energies(states: tuple[Any, Any], const: Any, slip: Slip, rest: Any) -> FloatArray:
    """(12,) [J] of a ply, as `ply_audit.energies`, with the energies of its slip.

    Parameters
    ----------
    states : its state, and the same with the effective stretches in the place of the stretches
    rest : of `ply_audit.energies`
    """
    out = np.empty(5)
    kernels.energies(states, const, slip, out)
    found = ply_audit.energies(const, states[1], rest)
    place = {name: n for n, name in enumerate(ply_audit.ENERGIES)}
    found[place["kinetic_fabric"]] = out[0] + out[3]
    found[place["yarn_strain"]], found[place["shear"]], found[place["jamming"]] = out[1], out[2], out[4]
    return found


def slip_arrays(slip: Slip, folder: str) -> dict[str, Any]:
    """{name in a checkpoint: array} of what a ply's slip has become."""
    names = ("share", "inv_share", "x", "config", "q", "q_before", *STORED_FORCES, "removed", "passed")
    found = {f"{folder}/{name}/{n}": part for name in names for n, part in enumerate(getattr(slip, name))}
    found |= {f"{folder}/tail/{n}{m}": part for n, pair in enumerate(slip.tail) for m, part in enumerate(pair)}
    return found | {f"{folder}/{name}": getattr(slip, name) for name in ("row_slips", "counter", "work")}


def solver_of(panel: Panel, strike_velocity: float, end_time: float, **others: Any) -> PanelSolver | SlidingSolver:
    """The solver of a panel, by its crossovers; parameters as PanelSolver."""
    if isinstance(panel, SlidingPanel):
        return SlidingSolver(panel, strike_velocity, end_time, **others)
    return PanelSolver(panel, strike_velocity, end_time, **others)
