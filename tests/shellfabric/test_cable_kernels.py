"""The kernels of the cable net against a plain twin that knows only nodes and a list of bars."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric import cable_contact_kernels as contact_kernels
from shellfabric import cable_kernels as kernels
from shellfabric.cable import CableNet, CableNumerics
from shellfabric.shapes_kernels import flat

FABRIC = catalogue.load("S-726")


def small(symmetry="quarter", **numerics):
    """A net of about ten crossovers from the middle to the edge, odd blocks, unequal yarns and counts."""
    knobs = CableNumerics(contact_points=3, block=25, **numerics)
    return CableNet(FABRIC, (0.020, 0.024), symmetry=symmetry, numerics=knobs)


class Twin:
    """The same model, one bar and one point at a time."""

    def __init__(self, net, speed):
        c, weave = net.constants(), net.fabric.weave
        self.c, (ni, nj) = c, net.counts
        self.X = np.array(
            [
                [c.origin[0] + i * c.spacing[0], c.origin[1] + j * c.spacing[1], 0]
                for i in range(ni + 1)
                for j in range(nj + 1)
            ]
        )
        self.x, self.v, self.m = self.X.copy(), np.zeros_like(self.X), np.zeros(len(self.X))
        mirror_x, mirror_y = {"quarter": (True, True), "half": (True, False), "whole": (False, False)}[net.symmetry]
        self.free = np.ones_like(self.X)
        self.bars = []
        for i in range(ni + 1):
            for j in range(nj + 1):
                k = i * (nj + 1) + j
                on_x, on_y = i == 0 and mirror_x, j == 0 and mirror_y
                if i == ni or j == nj or (i == 0 and not mirror_x) or (j == 0 and not mirror_y):
                    self.free[k] = 0
                self.free[k, 0] *= not on_x
                self.free[k, 1] *= not on_y
                ends = [(0, k + nj + 1, 0.5 if on_y else 1.0)] if i < ni else []
                ends += [(1, k + 1, 0.5 if on_x else 1.0)] if j < nj else []
                for family, other, part in ends:
                    yarn, S0 = weave.yarns[family], weave.S0[family]
                    stiffness = part * yarn.EA / S0
                    L0 = c.spacing[family]
                    points = [0.0] * net._points()[0]
                    bar = {"family": family, "a": k, "b": other, "k": stiffness, "part": part, "S0": S0, "L": L0}
                    self.bars.append({**bar, "drag": 0.0, "f": points})
                    self.m[[k, other]] += 0.5 * part * S0 * yarn.linear_density
        self.f, self.z, self.speed, self.reaction = np.zeros_like(self.X), 0.0, speed, 0.0
        self.viscous = self.contact = self.lost = 0.0

    def step(self):
        c = self.c
        self.v += c.dt * self.f / self.m[:, None] * self.free
        self.speed += c.dt * self.reaction / c.projectile_mass
        self.x += c.dt * self.v
        self.z += c.dt * self.speed
        self.f = np.zeros_like(self.X)
        self.reaction = 0.0
        for bar in self.bars:
            self.pull(bar)
        for bar in self.bars:
            self.touch(bar)

    def pull(self, bar):
        d = self.x[bar["b"]] - self.x[bar["a"]]
        L = np.linalg.norm(d)
        rate, e = L - bar["L"], max(L - bar["S0"], 0.0)
        T = bar["k"] * e
        drag = max(self.c.cv * bar["k"] * rate, -T) if T > 0 else 0.0
        if bar["k"] > 0 and e > self.c.limit[bar["family"]]:
            self.lost += 0.5 * bar["k"] * max(e - rate, 0.0) * e
            bar["k"] = T = drag = 0.0
        self.viscous += 0.5 * (drag + bar["drag"]) * rate
        bar["L"], bar["drag"] = L, drag
        self.f[bar["a"]] += (T + drag) * d / L
        self.f[bar["b"]] -= (T + drag) * d / L

    def touch(self, bar):
        p = len(bar["f"])
        for q in range(p):
            t = (q + 0.5) / p
            x = (1 - t) * self.x[bar["a"]] + t * self.x[bar["b"]] - [0, 0, self.z]
            v = (1 - t) * self.v[bar["a"]] + t * self.v[bar["b"]] - [0, 0, self.speed]
            r = np.hypot(x[0], x[1])
            depth, n_r, n_z = flat(r, x[2], self.c.R, self.c.rho)
            n = np.array([n_r * x[0] / r, n_r * x[1] / r, n_z]) if r > 0 else np.array([0, 0, n_z])
            f = 0.0
            if depth < 0 and bar["k"] > 0:
                stiffness, damping = self.c.point_stiffness[bar["family"]], self.c.point_damping[bar["family"]]
                f = bar["part"] * max(0.0, -damping * n @ v - stiffness * depth)
            self.contact += 0.5 * (f + bar["f"][q]) * -(n @ v) * self.c.dt
            bar["f"][q] = f
            self.f[bar["a"]] += (1 - t) * f * n
            self.f[bar["b"]] += t * f * n
            self.reaction -= f * n[2]


@pytest.mark.parametrize(
    ("symmetry", "viscosity", "steps", "failures"),
    [("quarter", 0.1, 120, 3), ("half", 0.0, 40, 0), ("whole", 0.1, 40, 0)],
)
def test_step_is_the_plain_model(symmetry, viscosity, steps, failures):
    """At 450 m/s, through slack, contact and the first failures, to rounding."""
    net = small(symmetry, viscosity=viscosity)
    const, state, twin = net.constants(), net.state(450.0), Twin(net, 450.0)
    history = np.empty((1, kernels.COLUMNS))
    for _ in range(steps):
        kernels.advance(state, const, 1, history)
        twin.step()
        size = len(twin.X)
        assert np.abs(state.u[:, :size].T - (twin.x - twin.X)).max() < 1e-12
    assert state.counter[kernels.FAILURES] == sum(bar["k"] == 0 for bar in twin.bars) >= failures
    assert state.speed[2] == pytest.approx(twin.speed, rel=1e-9)
    sums = state.sums[[kernels.VISCOUS, contact_kernels.CONTACT, kernels.LOST]]
    assert sums == pytest.approx([twin.viscous, twin.contact, twin.lost], rel=1e-6, abs=1e-12)


def test_every_bar_once():
    """No bar where there is none: not past the edges, nor from the end of a row to the beginning of the next."""
    for symmetry in ("quarter", "half", "whole"):
        net = small(symmetry)
        stiff = net.state(1.0).stiff[:, : (net.counts[0] + 1) * (net.counts[1] + 1)].reshape(2, net.counts[0] + 1, -1)
        assert np.count_nonzero(stiff) == net.bars
        assert not stiff[0, -1].any()
        assert not stiff[1, :, -1].any()


def test_mass_of_the_net():
    net = small("whole")
    area = net.counts[0] * net.counts[1] * net.fabric.weave.cell_area
    mass, weave = net.state(1.0).mass.sum(), net.fabric.weave
    edges = 2 * sum(0.5 * n * S0 * yarn.linear_density for n, S0, yarn in zip(net.counts, weave.S0, weave.yarns))
    assert mass == pytest.approx(area * weave.areal_density + edges, rel=1e-12)
    assert small("quarter").state(1.0).mass.sum() == pytest.approx(mass / 4, rel=1e-12)


def test_only_what_the_wave_has_reached_is_worked_on_and_nothing_is_missed():
    """The window of active rows changes no bit of the motion."""
    net = replace(small(), opening=(0.060, 0.024))
    histories = []
    for whole in (False, True):
        const, state, history = net.constants(), net.state(100.0), np.empty((150, kernels.COLUMNS))
        if whole:
            state.rows[:] = 0, const.ni
        kernels.advance(state, const, 150, history)
        histories.append((history, state.u.copy(), state.rows[1]))
    assert histories[0][2] < net.counts[0]
    assert np.array_equal(histories[0][1], histories[1][1])
    assert np.array_equal(histories[0][0], histories[1][0])
