"""Time integration beside a plain loop: cost of an element and step, and what the parts of a step cost.

Run with nothing else on the machine:

    python benchmarks/plain_loop.py [--repeats 9] [--steps 300] [--out FILE.json]

The yardstick is the same membrane (variational form with viscosity and trellis, S-720, 203 mm, one element per
crossover) as a numba loop over two-dimensional arrays without any of this project's kernels: no blocks, no SIMD type,
no failure, contact or energies. Its forces are compared with those of the kernels first. Both move all elements in
every step, in alternated runs on one core. Medians of CPU time; `ratio` is a plain step over one of the kernels, which
includes contact, failure and the work of all forces.
"""

from __future__ import annotations

import argparse
import math
import os
import statistics
import time
from pathlib import Path

import numpy as np
from numba import njit
from shell import machine, one_core, publish

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.jit.compile import entry
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.element_kernels import element_forces
from shellfabric.membrane.model import Panel
from shellfabric.membrane.motion_kernels import move_rows
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile import contact_kernels
from shellfabric.projectile.window_kernels import place_near_nose
from shellfabric.surface.nodal_force_kernels import give_impulses

plain = njit(cache=True, error_model="numpy", fastmath=True)


@plain
def gradient(l1, l2, grid, table):
    """(dW/dp, dW/dq, ...) [J] of the biquadratic potential at one pair of stretches."""
    x0, rx, top1, y0, ry, top2, across = grid
    p, q = max((l1 - x0) * rx, 0.0), max((l2 - y0) * ry, 0.0)
    cell1, cell2 = math.floor(min(p, top1)), math.floor(min(q, top2))
    c, p, q = table[int(cell1 * across + cell2)], p - cell1, q - cell2
    along = c[0] + q * (c[4] + q * c[6]) + 2 * p * (c[1] + q * (c[5] + q * c[7]))
    return along, c[2] + p * (c[4] + p * c[5]) + 2 * q * (c[3] + p * (c[6] + p * c[7]))


@plain
def shear_slope(sine, law):
    """dU/d(sin gamma) [Pa] of the trellis law."""
    G1, G2, gamma1, gamma2 = law
    x = min(abs(sine), 0.999)
    angle = math.asin(x)
    middle = min(max(angle - gamma1, 0.0), gamma2 - gamma1)
    stress = (
        G1 * angle
        + 0.5 * (G2 - G1) / (gamma2 - gamma1) * middle**2
        + (G2 - G1) * max(angle - gamma2, 0.0)
    )
    return math.copysign(stress / math.sqrt(1 - x * x), sine)


@plain
def plain_step(u, v, f, kick, edges, before, forces, constants, dt, mirrors):
    """One step: velocities and places of the nodes from their forces f (3, ni+1, nj+1), then their new forces."""
    inv_dx, inv_dy, per1, per2, y1, y2, cv1, cv2, V, law, grid, table = constants
    (A, B), (l1, l2), (own1, own2, given1, given2, sine, cross, turn1, turn2) = (
        edges,
        before[:2],
        forces,
    )
    old1, old2 = before[2:]
    _, m, n = u.shape
    ni, nj = m - 1, n - 1
    for c in range(3):
        for i in range(m):
            for j in range(n):
                v[c, i, j] += kick[i, j] * f[c, i, j]
        if mirrors and c == 0:
            v[0, 0, :] = 0.0
        if mirrors and c == 1:
            v[1, :, 0] = 0.0
        for i in range(m):
            for j in range(n):
                u[c, i, j] += dt * v[c, i, j]
                f[c, i, j] = 0.0
    for i in range(ni):
        for j in range(n):
            a, b, c = (
                1.0 + inv_dx * (u[0, i + 1, j] - u[0, i, j]),
                inv_dx * (u[1, i + 1, j] - u[1, i, j]),
                0.0,
            )
            c = inv_dx * (u[2, i + 1, j] - u[2, i, j])
            A[0, i, j], A[1, i, j], A[2, i, j] = a, b, c
            old1[i, j] = l1[i, j]
            l1[i, j] = math.sqrt(a * a + b * b + c * c)
    for i in range(m):
        for j in range(nj):
            a, b = (
                inv_dy * (u[0, i, j + 1] - u[0, i, j]),
                1.0 + inv_dy * (u[1, i, j + 1] - u[1, i, j]),
            )
            c = inv_dy * (u[2, i, j + 1] - u[2, i, j])
            B[0, i, j], B[1, i, j], B[2, i, j] = a, b, c
            old2[i, j] = l2[i, j]
            l2[i, j] = math.sqrt(a * a + b * b + c * c)
    for i in range(ni):
        for j in range(n):
            a, b = max(j - 1, 0), min(j, nj - 1)
            mean = 0.25 * (l2[i, a] + l2[i, b] + l2[i + 1, a] + l2[i + 1, b])
            along, across = gradient(l1[i, j], mean, grid, table)
            own1[i, j], given2[i, j] = per1 * along, per2 * across
    for i in range(m):
        a, b = max(i - 1, 0), min(i, ni - 1)
        for j in range(nj):
            mean = 0.25 * (l1[a, j] + l1[a, j + 1] + l1[b, j] + l1[b, j + 1])
            along, across = gradient(mean, l2[i, j], grid, table)
            given1[i, j], own2[i, j] = per1 * along, per2 * across
    for i in range(ni):
        for j in range(nj):
            dot = 0.0
            for c in range(3):
                dot += (A[c, i, j] + A[c, i, j + 1]) * (B[c, i, j] + B[c, i + 1, j])
            sine[i, j] = dot / ((l1[i, j] + l1[i, j + 1]) * (l2[i, j] + l2[i + 1, j]))
    for i in range(ni):
        for j in range(nj):
            along, over = l1[i, j] + l1[i, j + 1], l2[i, j] + l2[i + 1, j]
            slope = V * shear_slope(sine[i, j], law)
            # shifted by one, with zeros about them: what lies beyond the panel has no trellis
            cross[i + 1, j + 1] = slope / (along * over)
            turn1[i + 1, j + 1], turn2[i + 1, j + 1] = (
                slope * sine[i, j] / along,
                slope * sine[i, j] / over,
            )
    for i in range(ni):
        for j in range(n):
            a, b = max(j - 1, 0), min(j, nj - 1)
            N = 0.5 * (
                own1[i, j]
                + 0.25 * (given1[i, a] + given1[i, b] + given1[i + 1, a] + given1[i + 1, b])
            )
            pull = (
                y1[i, j] * (N + cv1 * (l1[i, j] - old1[i, j]))
                - turn1[i + 1, j + 1]
                - turn1[i + 1, j]
            )
            own1[i, j] = inv_dx * pull / l1[i, j]
    for i in range(m):
        a, b = max(i - 1, 0), min(i, ni - 1)
        for j in range(nj):
            N = 0.5 * (
                own2[i, j]
                + 0.25 * (given2[a, j] + given2[a, j + 1] + given2[b, j] + given2[b, j + 1])
            )
            pull = (
                y2[i, j] * (N + cv2 * (l2[i, j] - old2[i, j]))
                - turn2[i + 1, j + 1]
                - turn2[i, j + 1]
            )
            own2[i, j] = inv_dy * pull / l2[i, j]
    for c in range(3):
        for i in range(ni):
            for j in range(n):
                a, b = max(j - 1, 0), min(j, nj - 1)
                sheared = cross[i + 1, j + 1] * (B[c, i, b] + B[c, i + 1, b])
                sheared += cross[i + 1, j] * (B[c, i, a] + B[c, i + 1, a])
                force = own1[i, j] * A[c, i, j] + inv_dx * sheared
                f[c, i, j] += force
                f[c, i + 1, j] -= force
        for i in range(m):
            a, b = max(i - 1, 0), min(i, ni - 1)
            for j in range(nj):
                sheared = cross[i + 1, j + 1] * (A[c, b, j] + A[c, b, j + 1])
                sheared += cross[i, j + 1] * (A[c, a, j] + A[c, a, j + 1])
                given1[i, j] = own2[i, j] * B[c, i, j] + inv_dy * sheared
            for j in range(nj):
                f[c, i, j] += given1[i, j]
            for j in range(nj):
                f[c, i, j + 1] -= given1[i, j]


@plain
def plain_steps(steps, u, v, f, kick, edges, before, forces, constants, dt, mirrors):
    for _ in range(steps):
        plain_step(u, v, f, kick, edges, before, forces, constants, dt, mirrors)


class Plain:
    """The plain membrane of a panel, at rest in the state of the panel's nodes."""

    def __init__(self, panel, state):
        const, (ni, nj) = panel.constants(), panel.counts
        nodes = lambda flat: flat[: (ni + 1) * (nj + 1)].reshape(ni + 1, nj + 1).copy()  # noqa: E731
        empty = lambda *shape: np.zeros(shape)  # noqa: E731
        self.u, self.v = (np.array([nodes(part) for part in of]) for of in (state.u, state.v))
        self.f, self.dt, self.mirrors = np.zeros_like(self.u), const.dt, const.mirror_x
        self.kick = nodes(state.dt_over_mass)
        self.edges = empty(3, ni, nj + 1), empty(3, ni + 1, nj)
        warp, weft = (ni, nj + 1), (ni + 1, nj)
        self.before = np.ones(warp), np.ones(weft), np.ones(warp), np.ones(weft)
        self.forces = (
            empty(*warp),
            empty(*weft),
            empty(*weft),
            empty(*warp),
            empty(ni, nj),
            *empty(3, ni + 2, nj + 2),
        )
        y1, y2 = (nodes(y) for y in state.yarn_length)
        self.constants = (
            const.inv_dx,
            const.inv_dy,
            const.force_per_slope1,
            const.force_per_slope2,
            np.ascontiguousarray(y1[:-1]),
            np.ascontiguousarray(y2[:, :-1]),
            const.cv1,
            const.cv2,
            const.trellis_volume,
            (const.G1, const.G2, const.gamma1, const.gamma2),
            const.table_grid,
            const.potential_coefficients,
        )

    def run(self, steps):
        plain_steps(
            steps,
            self.u,
            self.v,
            self.f,
            self.kick,
            self.edges,
            self.before,
            self.forces,
            self.constants,
            self.dt,
            self.mirrors,
        )


@entry(_nrt=False)
def elements_only(state, const, work, times):
    """Motion of all nodes and forces of all elements, so many times."""
    for _ in range(times):
        for block in range((const.ni + const.rows_per_block - 1) // const.rows_per_block):
            first, last = (
                block * const.rows_per_block,
                min(const.ni, (block + 1) * const.rows_per_block),
            )
            move_rows(state, const, first, last if last < const.ni else last + 1)
            element_forces(state, const, block, first, last, work)


@entry(_nrt=False)
def nose_only(state, const, work, times):
    for _ in range(times):
        give_impulses(state, const, state.f_contact, state.nose_window)
        place_near_nose(state, const)
        contact_kernels.contact_forces(state, const, work.contact_scratch)


@entry(_nrt=False)
def failure_only(state, const, work, times):
    for _ in range(times):
        ply_kernels.apply_failure(state, const, work)


@entry()
def audit_only(state, const, out, times):
    for _ in range(times):
        ply_kernels.energies(state, const, out)


def cpu(function, *arguments):
    start = time.process_time()
    function(*arguments)
    return time.process_time() - start


def shaken(panel):
    """A solver in motion everywhere: what 40 steps have made of random velocities of 0.5 m/s."""
    solver, rng = PackSolver(panel, 92.5, 1.0), np.random.default_rng(1)
    state, solver.exchange = solver.state, np.inf  # no checks of the energy
    for part in state.v:
        part[: state.mass.size] = np.where(
            state.dt_over_mass > 0, rng.uniform(-0.5, 0.5, state.mass.size), 0.0
        )
    state.first_row = 0
    state.end_row = panel.counts[0]
    solver.advance(np.empty((40, 3)))
    return solver


def difference(panel):
    """Largest difference of the nodes' forces between both, over the largest force [-]; viscosity is left out."""
    state = shaken(panel).state
    other = Plain(panel, state)
    other.dt, other.kick[:] = 0.0, 0.0
    other.run(2)
    for part in state.v:
        part[:] = 0.0
    work, rows = panel.work(), panel.constants()._replace(dt=0.0)
    elements_only(state, rows, work, 2)
    (ni, nj), total = panel.counts, np.array(state.f_int) + np.array(state.f_int_above)
    found = total[:, : (ni + 1) * (nj + 1)].reshape(other.f.shape)
    for forces in (found, other.f):  # what the planes of symmetry take
        forces[0, 0], forces[1, :, 0] = 0.0, 0.0
    return float(np.abs(found - other.f).max() / np.abs(found).max())


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=9)
    arguments.add_argument("--steps", type=int, default=300)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    model = CellModel(catalogue.load("S-720").with_effective_density())
    panel = Panel(model.table(201), numerics=Numerics(threads=1), yarn_failure=False)
    const, work, steps = panel.constants(), panel.work(), chosen.steps
    report = {
        "machine": machine(),
        "elements": panel.elements,
        "steps": steps,
        "force_difference": difference(panel),
    }
    per, times = 1e9 / (steps * panel.elements), {}
    history, out = np.empty((steps, 3)), np.empty(5)
    with one_core():
        for repeat in range(chosen.repeats + 1):
            solver = shaken(panel)
            state = solver.state
            other = Plain(panel, state)
            state.v[2][0] = other.v[2, 0, 0] = 92.5
            parts = {
                "plain": (other.run, steps),
                "kernels": (solver.advance, history),
                "elements": (elements_only, state, const, work, steps),
                "nose": (nose_only, state, const, work, steps),
                "failure": (failure_only, state, const, work, steps),
                "audit, each": (audit_only, state, const, out, steps),
            }
            for name, call in parts.items():
                used = cpu(*call) * per
                if repeat:  # the first compiles
                    times.setdefault(name, []).append(used)
    report["cpu_ns_per_element_step"] = {
        name: round(statistics.median(values), 2) for name, values in times.items()
    }
    ratios = [one / two for one, two in zip(times["plain"], times["kernels"])]
    report["ratio"] = {
        "median": round(statistics.median(ratios), 2),
        "range": [round(x, 2) for x in (min(ratios), max(ratios))],
    }
    report["load_average_after"] = os.getloadavg()[0]
    publish(report, chosen.out)


if __name__ == "__main__":
    main()
