"""The explicit solver of a patch of solid yarns: steps as long as the state allows.

Bricks that are pressed to their packing are two orders stiffer than at rest, so the bound of the time
step is found anew after every few steps. Energies are of the instant of the last forces. Fibres,
hourglass control and contacts have potentials, which are evaluated as they stand; the solids' law
has none: their entry is the work that they have taken (`fabrics.yarn_stress_kernels`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.guards import ENERGY_ERROR_LIMIT
from shellfabric.loop.driver import RUNNING, ExplicitSolver
from validation.models.solids import facet_kernels, step_kernels
from validation.models.solids.model import SolidPatch

SAME = 16  # steps of one length
GROWTH = (
    1.5  # by which the fastest node may speed up meanwhile: sets how long clear facets may wait
)


class SolidSolver(ExplicitSolver):
    """One run of a patch that is struck.

    Parameters
    ----------
    patch : SolidPatch, with a projectile
    strike_velocity : [m/s]
    end_time : [s]
    interval : [s] between samples
    energy_error_limit : share of the strike energy that the energy error may reach before the run
        counts as unstable

    Attributes
    ----------
    row : SolidRow, what the kernels work on

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    def __init__(
        self,
        patch: SolidPatch,
        strike_velocity: float,
        end_time: float,
        *,
        interval: float = 0.25e-6,
        energy_error_limit: float = ENERGY_ERROR_LIMIT,
    ) -> None:
        super().__init__(
            patch.projectile,
            strike_velocity,
            end_time,
            interval=interval,
            energy_error_limit=energy_error_limit,
        )
        self.patch = patch
        self.share = patch.mesh.share
        self.row = patch.row(self.strike_velocity)
        self._sample()

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.row.steps)

    @property
    def time(self) -> float:
        """[s] of the places."""
        return float(self.row.time)

    @property
    def sample_spacing(self) -> float:
        """[s] from one sample to the next."""
        return self.interval

    @property
    def ended(self) -> bool:
        """Whether the end time is reached."""
        return self.reason != RUNNING or self.time > self.end_time - 0.5 * self.interval

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """Make as many steps as there are rows in `history`; their length has been set."""
        step_kernels.run_steps(self.row, len(history))
        return len(history), RUNNING

    def _advance_to_sample(self):
        """Fill the interval with steps whose length is set anew after every `SAME` of them."""
        left = self.interval
        with self._clock():
            while left > 0:
                steps = self._set_time_step(left)
                facet_kernels.choose_partners(self.row)
                made, _ = self.advance(self._rows(min(steps, SAME)))
                left = left * (steps - made) / steps

    def _set_time_step(self, left):
        """Set the length of the next steps; return how many fill the time that is left of the
        interval [s]."""
        numerics = self.patch.numerics
        fastest, node = self.patch.frequency(self.row)
        if not np.isfinite(fastest):
            self.stop("a brick is inverted", self.where(0, node))
        ratio = max(numerics.solid_viscosity, numerics.fibre_viscosity)
        longest = numerics.cfl * 2 / fastest * (np.sqrt(1 + ratio**2) - ratio)
        steps = int(np.ceil(left / longest))
        speed = np.sqrt((self.row.v**2).sum(axis=1).max())
        self.row.dt = left / steps
        self.row.reach = 2 * max(GROWTH * speed, self.strike_velocity) * self.row.dt
        return steps

    def observe(self) -> tuple[dict[str, float], dict[str, float]]:
        """Return what a sample has, and the energies [J] of the modelled part."""
        row = self.row
        energies = {
            "kinetic_fabric": row.kinetic_energy,
            "kinetic_projectile": row.projectile_energy,
            "fibres": row.fibre_energy,
            "solids": row.solid_work - row.half_work - row.solid_damping,
            "hourglass": row.hourglass_energy,
            "contact": row.contact_energy.sum() + row.tip_energy.sum() + row.nose_energy.sum(),
            "friction": row.friction_work,
            "viscous": row.solid_damping + row.fibre_damping + row.contact_damping,
            "failure_dissipation": row.failure_energy,
        }
        observed = {
            "v": row.nose_velocity[2],
            "z": row.nose_position[2],
            "force": -row.nose_force[2] / self.share,
            "dt": float(row.dt),
            "failed_bars": float(np.count_nonzero(~row.bar_intact)),
            "torn_bricks": float(np.count_nonzero(row.torn)),
        }
        return observed, energies

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """Return the speeds of the nodes. None is too fast: a brick that is turned over ends the run
        (`_set_time_step`)."""
        return [(np.sqrt((self.row.v**2).sum(axis=1)), np.inf)]

    def where(self, part: int, node: int) -> str:
        """Say where a node is."""
        mesh = self.patch.mesh
        yarn = int(np.searchsorted(self.row.first_node, node, side="right")) - 1
        name = ("warp", "weft")[mesh.families[yarn]]
        x, y, z = self.row.x[node] * 1e3
        place = f"({x:.3g}, {y:.3g}, {z:.3g} mm)"
        return f"node {int(node)} of {name} {mesh.numbers[yarn] + 1} {place}"

    def checkpoint_identity(self) -> tuple[Any, str]:
        """Return what determines the run: all that a checkpoint does not keep."""
        kept = self.row.kept()
        fixed = {name: value for name, value in self.row.nested().items() if name not in kept}
        numerics = self.patch.numerics
        # the aim is where the nose begins, of which a checkpoint has how far it has come
        return (self.strike_velocity, self.interval, self.patch.aim, numerics, fixed), __name__

    def checkpoint_arrays(self) -> dict[str, Any]:
        """Return the arrays of the state."""
        return {"patch": self.row}
