"""The pin-jointed cable model of a fabric (thesis section 4.4.2), the shell's decoupled limit: masses at crossovers,
joined along warp and weft by bars that carry tension only. No crimp exchange, compression or shear stiffness. Bars of
natural length S0 whose nodes are L apart (both as much longer than a crossover's as the panel's elements are) have

    e = max(L - S0, 0),   T = k e,   k = EA / S0     (crimp is slack, S0 > L at rest; erratum E-18: strain beyond crimp)

and pull with T and, while taut, a viscous force on their rate; never less than nothing in all. Bars do not fail. Time
goes by central differences.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.projectile import contact
from validation.models.cable import net_kernels as kernels
from validation.values import largest

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup

CONTACT_DAMPING = 0.5  # ratio to critical
VISCOSITY = 0.1  # damping ratio of the highest mode of the taut net, as in the shell


def time_step(frequency: float, cfl: float, viscosity: float) -> tuple[float, float]:
    """Compute (dt [s], cv [-]) for the highest frequency `frequency` [rad/s]; cv as in
    `net_kernels.pull`.

    No direction of a node sees more than both families, so that w^2 <= 4 (k1 + k2) / M, with M the
    mass of the two yarns in a cell, however the net folds. Along a flat yarn the wave runs at 2 w1
    sqrt(k1 / M), c / sqrt 2 for equal yarns without crimp (erratum E-38). The viscous force acts on
    the change of length of the step before, which limits the step to (2 / w) (sqrt(1 + xi^2) - xi).

    cfl : Courant factor, the time step over its bound
    viscosity : damping ratio of the highest mode
    """
    dt = cfl * 2 / frequency * ((1 + viscosity**2) ** 0.5 - viscosity)
    return dt, 2 * viscosity / (frequency * dt)


@dataclass(frozen=True)
class NetResult:
    """What an impact on a net came to. Energies and forces are of the whole net.

    Parameters
    ----------
    energies : {name: (n,)} [J], a sample every 2 us; error is the sum less the energy at the start
    step_history : (steps, 4) time [s], nose position [m], velocity [m/s] at half steps, force on the projectile [N]
    reactions : {"warp", "weft", "edges": (steps,)} [N] after each step: pulls of the middle yarns on a clamp, along the
        yarns at rest, and the force of all clamps on the net, along z
    wall_time : [s]
    """

    energies: dict
    step_history: np.ndarray
    reactions: dict
    wall_time: float

    @property
    def energy_error_max(self) -> float:
        """[-] largest error of the energy balance over the strike energy."""
        return largest(self.energies["error"]) / self.energies["kinetic_projectile"][0]


class CableNet:
    """A quarter of a net at rest, touched by the projectile: the nodes, masses, clamps and nose of a shell.

    Parameters
    ----------
    setup : of one ply with clamped edges and an element per crossover, struck in its middle by a flat cylinder
    cfl : Courant factor. It could be near one but for crimp: bars that snap taut between two steps cost energy, as the
        square of the step (docs/reports/numerics.md)
    viscosity : damping ratio of the highest mode of the taut net
    penalty : stiffness of the contact, in units of the touching mass / dt^2
    """

    def __init__(
        self,
        setup: ImpactSetup,
        *,
        cfl: float = 0.4,
        viscosity: float = VISCOSITY,
        penalty: float = 0.3,
    ):
        panel = setup.panel(setup.plain_table())
        weave = panel.weave
        const = panel.constants()
        self.setup = setup
        # elements are longer than crossovers so that they fill the opening, and bars with them
        self.S0 = [S0 * d / (2 * w) for S0, d, w in zip(weave.S0, panel.spacing, weave.w)]
        self.yarns_a_line = panel.yarns_a_line
        bars = zip(weave.yarns, self.yarns_a_line, self.S0)
        stiffness = [yarn.EA * count / S0 for yarn, count, S0 in bars]
        mass = weave.areal_density * const.dx * const.dy
        self.dt, self.cv = time_step(2 * (sum(stiffness) / mass) ** 0.5, cfl, viscosity)
        shared = mass / const.points_per_side**2
        law = contact.point_law(
            shared, penalty * shared / self.dt**2, CONTACT_DAMPING, cfl, self.dt
        )
        self.const = const._replace(dt=self.dt, point_law=law)
        self.state = panel.state(setup.strike_velocity)
        shape = (const.ni + 1, const.row_stride)
        slots = self.state.mass.size
        n = shape[0] * shape[1]
        self.stiffness = np.zeros((2, slots))
        self.kick = np.tile(self.dt * self.state.inverse_mass, (3, 1))
        warp, weft = self.stiffness[:, :n].reshape(2, *shape)
        warp[:-1], weft[:, :-1] = stiffness
        warp[:, 0] *= 0.5  # planes of symmetry cut the bars that lie in them, and keep their nodes
        weft[0] *= 0.5
        free = self.kick[:, :n].reshape(3, *shape)
        free[0, 0] = free[1, :, 0] = 0.0
        self.length = np.repeat([[const.dx], [const.dy]], slots, axis=1)
        self.drag = np.zeros((2, slots))
        self.spent = np.zeros(2)
        self.clamped = np.flatnonzero(free[2] == 0)
        self.ends = const.ni * const.row_stride, const.nj
        self.room = np.zeros((2, 3, n + const.row_stride)), contact.scratch()

    def arguments(self) -> tuple:
        """Return the arguments of `net_kernels.forces`."""
        bars = self.S0, self.cv, self.stiffness, self.length, self.drag
        return self.state, self.const, *bars, *self.room, self.spent

    def march(self, steps: int) -> FloatArray:
        """Make steps until the projectile stops; a row each, whose columns are those of `net_kernels`."""
        history = np.zeros((steps, kernels.COLUMNS))
        state, const, *others = self.arguments()
        return history[
            : kernels.march(state, const, self.kick, *others, self.clamped, self.ends, history)
        ]

    def energies(self) -> dict[str, float]:
        """Compute the energies {name: [J]} of the whole net at the present whole step.

        The kinetic ones are m v(n-1/2) v(n+1/2) / 2, the form that central differences conserve in a linear system.
        """
        state = self.state
        const = self.const
        v = np.array(self.state.v)
        shot = state.projectile_velocity
        push = self.dt * np.array(const.free_dofs) * state.f_contact_nose
        stretched = np.maximum(self.length - np.array(self.S0)[:, None], 0.0)
        own = {
            "kinetic_fabric": 0.5
            * np.sum(state.mass * v * (v + self.kick * np.array(state.f_int))),
            "kinetic_projectile": 0.5 * shot @ (const.projectile_mass * shot + push),
            "yarn_strain": 0.5 * np.sum(self.stiffness * stretched**2),
            "viscous": self.spent[kernels.VISCOUS],
            "contact": self.spent[kernels.CONTACT],
        }
        return {name: 4 * float(energy) for name, energy in own.items()}

    def run(self) -> NetResult:
        """March until the projectile stops or the end time of the set-up has passed."""
        began = time.perf_counter()
        rows = []
        samples = [self.energies()]
        left = int(np.ceil(self.setup.end_time / self.dt))
        every = max(1, round(2e-6 / self.dt))
        while left > 0:
            rows.append(self.march(min(every, left)))
            samples.append(self.energies())
            left = left - every if rows[-1][-1, kernels.V_Z] > 0 else 0
        energies = {name: np.array([sample[name] for sample in samples]) for name in samples[0]}
        total = np.sum(list(energies.values()), axis=0)
        history = np.concatenate(rows)
        clock = self.dt * np.arange(1, len(history) + 1)
        force = 4 * history[:, kernels.NOSE_FORCE]
        middle = history[:, kernels.MIDDLE :] / self.yarns_a_line
        reactions = {"warp": middle[:, 0], "weft": middle[:, 1]}
        reactions["edges"] = 4 * history[:, kernels.CLAMP_FORCE]
        return NetResult(
            energies | {"error": total - total[0]},
            np.column_stack([clock, history[:, [kernels.Z, kernels.V_Z]], force]),
            reactions,
            time.perf_counter() - began,
        )
