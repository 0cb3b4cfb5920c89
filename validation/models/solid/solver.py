"""The explicit solver of a solid patch: steps as long as the state allows; see `driver.solver`.

Bricks that are pressed to their packing are two orders stiffer than at rest. The bound of the time step is found anew
after every few steps.

Energies are of the instant of the last forces. Fibres, hourglass control and contacts have potentials, which are
evaluated as they stand. The solids' law has none: their entry is the work that they have taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Self

import numba
import numpy as np

from fabrics.checks import FloatArray
from shellfabric.driver.guards import ENERGY_ERROR_LIMIT
from shellfabric.driver.solver import RUNNING, ExplicitSolver, Hook
from validation.models.solid import solid_kernels
from validation.models.solid import step_kernels as kernels

# TBB, numba's first choice, has spun for ever at the end of a parallel loop beside the TBB that gmsh and VTK load
numba.config.THREADING_LAYER_PRIORITY = ["omp", "workqueue", "tbb"]  # type: ignore[attr-defined]

if TYPE_CHECKING:
    from validation.models.solid.model import SolidPatch

ENERGIES = (
    "kinetic_fabric",
    "kinetic_projectile",
    "fibres",
    "solids",
    "hourglass",
    "contact",
    "viscous",
    "failure_dissipation",
    "error",
)
SAMPLES = ("t", "v", "z", "push", "dt", "failed_bars", *ENERGIES)
SAME = 16  # steps of one length
GROWTH = 1.5  # by which the fastest node may speed up meanwhile: sets for how long clear contacts may rest


class SolidSolver(ExplicitSolver):
    """One run.

    Parameters
    ----------
    patch : SolidPatch
    strike_velocity : [m/s]
    end_time : [s]
    interval : [s] between samples
    energy_error_limit : share of the strike energy that the energy error may reach before the run counts as unstable
    threads : of numba; None leaves its setting. They change no bit of the result

    Attributes
    ----------
    const, state : what the kernels work on
    samples : list of rows, one a sample, in the order of SAMPLES; the first is after one interval

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    sample_names, energy_names = SAMPLES, ENERGIES

    def __init__(
        self, patch: SolidPatch, strike_velocity: float, end_time: float, *, interval: float = 0.25e-6,
        energy_error_limit: float = ENERGY_ERROR_LIMIT, threads: int | None = None,
    ) -> None:  # fmt: skip
        super().__init__(
            patch.projectile, strike_velocity, end_time, interval=interval, energy_error_limit=energy_error_limit
        )
        self.patch, self._numba_threads = patch, threads
        self.const, self.state = patch.ready(strike_velocity)
        kernels.forces(self.state, self.const, 0.0)  # compiled before any clock starts
        # coarse facets overlap at rest, and store what they then give
        self.energy_at_start = self.strike_energy + self.state.contact_energy[:, 0].sum()

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.state.counter[0])

    @property
    def time(self) -> float:
        """[s] of the places."""
        return float(self.state.time[0])

    @property
    def sample_spacing(self) -> float:
        """[s] from one sample to the next."""
        return self.interval

    @property
    def ended(self) -> bool:
        """Whether the end time is reached."""
        return self.reason != RUNNING or self.time > self.end_time - 0.5 * self.interval

    def run(self, hooks: Iterable[Hook] = ()) -> Self:
        """See ExplicitSolver."""
        if self._numba_threads is not None:
            numba.set_num_threads(self._numba_threads)
        return super().run(hooks)

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """See ExplicitSolver; the length of the steps has been set."""
        kernels.run_steps(self.state, self.const, len(history))
        return len(history), RUNNING

    def _advance_to_sample(self):
        """Fill the interval with steps whose length is set anew after every SAME of them."""
        left = self.interval
        with self._clock():
            while left > 0:
                steps = self._set_time_step(left)
                made, _ = self.advance(self._rows(min(steps, SAME)))
                left = left * (steps - made) / steps

    def _set_time_step(self, left):
        """Set the length of the next steps; returns how many fill the time that is left of the interval [s]."""
        numerics, state = self.patch.numerics, self.state
        fastest, node = self.patch.frequency(self.const, state)
        if not np.isfinite(fastest):
            self.stop("a brick is inverted", f"node {node}")
        damping = max(numerics.solid_viscosity, numerics.fibre_viscosity)
        longest = numerics.cfl * 2 / fastest * (np.sqrt(1 + damping**2) - damping)
        steps = int(np.ceil(left / longest))
        speed = np.sqrt((state.v**2).sum(axis=1).max())
        state.step_sizes[0] = left / steps
        state.step_sizes[1] = 2 * max(GROWTH * speed, self.strike_velocity) * state.step_sizes[0]
        return steps

    def observe(self) -> tuple[Sequence[float], Sequence[float]]:
        """See ExplicitSolver."""
        state, sums = self.state, self.state.energy_sums.sum(axis=0)
        contact, nose = state.contact_energy.sum(axis=0), state.nose_sums.sum(axis=0)
        energies = [
            sums[solid_kernels.KINETIC],
            state.projectile_energy[0],
            sums[solid_kernels.BARS],
            sums[solid_kernels.SOLID] - state.half_step_work.sum() - sums[solid_kernels.DAMPED],
            sums[solid_kernels.HOURGLASS],
            contact[0] + nose[kernels.NOSE],
            sums[solid_kernels.VISCOUS] + sums[solid_kernels.DAMPED] + contact[1] + nose[kernels.LOST],
            sums[solid_kernels.FAILED],
        ]
        failed = np.count_nonzero(~state.bar_intact)
        row = [
            state.projectile_velocity[2],
            state.projectile_position[2],
            -state.f_contact_nose[2],
            state.step_sizes[0],
            failed,
        ]
        return row, energies

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """See ExplicitSolver. No node is too fast: a brick that is turned over ends the run (`_set_time_step`)."""
        return [(np.sqrt((self.state.v**2).sum(axis=1)), np.inf)]

    def where(self, part: int, node: int) -> str:
        """See ExplicitSolver."""
        mesh = self.patch.mesh
        yarn = int(np.searchsorted(self.const.first_node, node, side="right")) - 1
        x, y, z = self.state.x[node] * 1e3
        return f"node {int(node)} of {mesh.names[yarn]} ({x:.3g}, {y:.3g}, {z:.3g} mm)"
