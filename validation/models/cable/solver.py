"""The explicit solver of the pin-jointed cable net (`cable.model`), and the result of an impact on it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fabrics.checks import FloatArray
from shellfabric.driver.guards import ENERGY_ERROR_LIMIT, speed_limit
from shellfabric.driver.solver import ExplicitSolver, Hook, run_to_end
from validation.models.cable import step_kernels as kernels
from validation.models.cable.model import CableNet, energies

ENERGIES = (
    "kinetic_fabric",
    "kinetic_projectile",
    "yarn_strain",
    "viscous",
    "contact",
    "failure_dissipation",
    "boundary_work",
    "error",
)
SAMPLES = ("t", "v", "z", *ENERGIES)


@dataclass(frozen=True)
class CableResult:
    """What an impact on a net came to; names as in `simulation.ImpactResult`. Energies and forces are of the whole net.

    Parameters
    ----------
    net : what was struck
    outcome : "stopped", "perforated" or "in flight"
    residual_velocity : [m/s] of the projectile at the end; 0 of one that has stopped
    t, v, nose_position : (n,) [s, m/s, m] instants of the audit; velocity and nose position of the projectile
    energies : {name: (n,)} [J] with the names of ENERGIES; error is the sum less the energy at the start
    peak_tension : (warp, weft) [N] over the run
    step_history : (steps, 4) time [s], nose position [m], velocity [m/s] at half steps, force on the projectile [N]
    reactions : {"warp", "weft", "edges": (steps,)} [N] after each step: pulls of the middle yarns on a clamp, along the
        yarns at rest, and the force of all clamps on the net, along z
    nodes : (ni+1, nj+1, 3) [m] of the quarter at the end
    failures : bars of the quarter that have failed
    steps, wall_time : cost of the run, [s]
    """

    net: CableNet
    outcome: str
    residual_velocity: float
    t: np.ndarray
    v: np.ndarray
    nose_position: np.ndarray
    energies: dict
    peak_tension: tuple[float, ...]
    step_history: np.ndarray
    reactions: dict
    nodes: np.ndarray
    failures: int
    steps: int
    wall_time: float

    @property
    def energy_error_max(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return float(np.max(np.abs(self.energies["error"])) / self.energies["kinetic_projectile"][0])


class CableSolver(ExplicitSolver):
    """One run of a net. Columns of step_history are those of `cable.step_kernels`.

    Parameters
    ----------
    net : CableNet
    strike_velocity, end_time, interval : as ExplicitSolver

    Raises
    ------
    InputError : a strike velocity, end time or interval that is not positive
    """

    sample_names, energy_names, history_columns = SAMPLES, ENERGIES, kernels.COLUMNS

    def __init__(self, net: CableNet, strike_velocity: float, end_time: float, *, interval: float = 2e-6) -> None:
        super().__init__(
            net.projectile, strike_velocity, end_time, interval=interval, energy_error_limit=ENERGY_ERROR_LIMIT
        )
        self.net, self.share = net, 0.25
        self.const, self.state = net.constants(), net.state(strike_velocity)
        self._begin(self.const.dt)

    @property
    def steps(self) -> int:
        """Steps made."""
        return int(self.state.counter[kernels.STEP])

    def advance(self, history: FloatArray) -> tuple[int, int]:
        """See ExplicitSolver."""
        made, reason = kernels.run_steps(self.state, self.const, len(history), history)
        torn = reason == kernels.RUNNING and made and self.state.counter[kernels.FAILURES]
        if torn and not history[:made, kernels.NOSE_FORCE].any() and not self._held_ahead():
            reason = kernels.PERFORATED
        return made, reason

    def _held_ahead(self):
        """Whether the middle of a bar that the clamps hold is still ahead of the edge, within the projectile's radius.

        Bars that are not connected to the clamps (a plug) do not count: the projectile may push them for good.
        """
        state, const = self.state, self.const
        n = (const.ni + 1) * const.row_stride
        family, near = np.nonzero(state.stiffness[:, :n])
        far = near + np.where(family == 0, const.row_stride, 1)
        _, part = connected_components(coo_array((np.ones(near.size), (near, far)), (n, n)), directed=False)
        x = state.u[:, :n] - [[0.0], [0.0], [state.projectile_position[2]]]
        x[:2] += [X.ravel() for X in self.net.coordinates()]
        middle = 0.5 * (x[:, near] + x[:, far])
        ahead = (middle[2] > -const.edge_radius) & (np.hypot(*middle[:2]) < const.projectile_radius)
        return bool(np.isin(part[near[ahead]], part[const.clamped_nodes]).any())

    def observe(self) -> tuple[Sequence[float], Sequence[float]]:
        """See ExplicitSolver. What is stored follows from the lengths of the bars, not from the work done on them."""
        state, const = self.state, self.const
        cloth, projectile, stored = energies(state, const)
        speed = state.projectile_velocity[2] + 0.5 * const.dt * state.f_contact_nose[2] / const.projectile_mass
        spent = state.energy_sums[kernels.VISCOUS], state.energy_sums[kernels.CONTACT], state.energy_sums[kernels.LOST]
        return [speed, state.projectile_position[2]], [cloth, projectile, stored, *spent, 0.0]  # clamps do no work

    def node_speeds(self) -> list[tuple[FloatArray, float]]:
        """See ExplicitSolver."""
        return [
            (np.sqrt((self.state.v**2).sum(axis=0)), speed_limit(self.strike_velocity, self.net.fabric.weave.yarns))
        ]

    def where(self, part: int, node: int) -> str:
        """See ExplicitSolver."""
        return f"node ({int(node) // self.const.row_stride}, {int(node) % self.const.row_stride}) of the cable net"


def run(
    net: CableNet, strike_velocity: float, end_time: float = 800e-6, *, audit_interval: float = 2e-6,
    hooks: Iterable[Hook] = (),
) -> CableResult:  # fmt: skip
    """Run an impact on a net until the projectile stops or is through, or `end_time` [s] has passed.

    Raises
    ------
    InputError : a time or velocity that is not positive
    UnstableError : as ExplicitSolver.run; its attribute `result` holds what was computed
    """
    solver = CableSolver(net, strike_velocity, end_time, interval=audit_interval)
    return run_to_end(solver, hooks, lambda: collect_result(solver))


def collect_result(solver: CableSolver) -> CableResult:
    """Gather what a run has recorded."""
    net, const, state = solver.net, solver.const, solver.state
    shape = (const.ni + 1, const.row_stride)
    size = shape[0] * shape[1]
    history = np.concatenate([np.empty((0, kernels.COLUMNS)), *solver.step_history])
    clock, forces = const.dt * np.arange(1, len(history) + 1), history[:, kernels.NOSE_FORCE] / solver.share
    return CableResult(
        net=net,
        outcome=solver.outcome,
        residual_velocity=solver.residual_velocity,
        t=solver.sample("t"),
        v=solver.sample("v"),
        nose_position=solver.sample("z"),
        energies={name: solver.sample(name) for name in ENERGIES},
        peak_tension=tuple(float(e * k) for e, k in zip(state.peak_elongation, net.stiffness)),
        step_history=np.column_stack([clock, history[:, [kernels.Z, kernels.V_Z]], forces]),
        reactions={
            "warp": history[:, kernels.MIDDLE].copy(),
            "weft": history[:, kernels.MIDDLE + 1].copy(),
            "edges": history[:, kernels.CLAMP_FORCE] / solver.share,
        },
        nodes=np.stack([*net.coordinates(), np.zeros(shape)], -1)
        + np.moveaxis(state.u[:, :size].reshape(3, *shape), 0, 2),
        failures=int(state.counter[kernels.FAILURES]),
        steps=solver.steps,
        wall_time=solver.wall_time,
    )
