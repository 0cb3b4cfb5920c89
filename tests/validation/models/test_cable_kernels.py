"""The kernels of the cable net against a plain twin that knows only nodes and a list of bars."""

from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.projectile.sdf_kernels import flat
from validation.models.cable import contact_kernels
from validation.models.cable import step_kernels as kernels
from validation.models.cable.model import CableNet, CableNumerics

FABRIC = catalogue.load("S-726")


def small(symmetry="quarter", **numerics):
    """A net of about ten crossovers from the middle to the edge, odd blocks, unequal yarns and counts."""
    knobs = CableNumerics(contact_points=4, block=25, **numerics)
    return CableNet(FABRIC, (0.020, 0.024), symmetry=symmetry, numerics=knobs)


class Twin:
    """The same model, one bar and one point of the surface at a time."""

    def __init__(self, net, speed):
        c, weave = net.constants(), net.fabric.weave
        self.c, (ni, nj) = c, net.counts
        self.X = np.array([[c.x0 + i * c.dx, c.y0 + j * c.dy, 0] for i in range(ni + 1) for j in range(nj + 1)])
        self.x, self.v, self.m = self.X.copy(), np.zeros_like(self.X), np.zeros(len(self.X))
        mirror_x, mirror_y = {"quarter": (True, True), "half": (True, False), "whole": (False, False)}[net.symmetry]
        self.mirrors, self.shape, self.of_edge = (mirror_x, mirror_y), (ni + 1, nj + 1), {}
        self.forces, self.gone = defaultdict(float), set()
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
                    L0 = (c.dx, c.dy)[family]
                    bar = {"family": family, "a": k, "b": other, "k": stiffness, "S0": S0, "L": L0, "drag": 0.0}
                    self.bars.append(bar)
                    self.of_edge[family, i, j] = bar
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
        for i in range(self.shape[0] - 1):
            for j in range(self.shape[1] - 1):
                if not self.eroded(i, j):
                    self.touch(i, j)

    def pull(self, bar):
        d = self.x[bar["b"]] - self.x[bar["a"]]
        L = np.linalg.norm(d)
        rate, e = L - bar["L"], max(L - bar["S0"], 0.0)
        T = bar["k"] * e
        drag = max(self.c.cv * bar["k"] * rate, -T) if T > 0 else 0.0
        if bar["k"] > 0 and e > self.c.failure_elongation[bar["family"]]:
            self.lost += 0.5 * bar["k"] * max(e - rate, 0.0) * e
            bar["k"] = T = drag = 0.0
        self.viscous += 0.5 * (drag + bar["drag"]) * rate
        bar["L"], bar["drag"] = L, drag
        self.f[bar["a"]] += (T + drag) * d / L
        self.f[bar["b"]] -= (T + drag) * d / L

    def whole(self, family, i, j):
        """Whether there is an unbroken bar from node (i, j), or one that it is an image of."""
        node = [i, j]
        for axis, mirrored in enumerate(self.mirrors):
            if mirrored and node[axis] < 0:
                node[axis] = -node[axis] - (axis == family)
        bar = self.of_edge.get((family, *node))
        return bar is not None and bar["k"] > 0

    def eroded(self, i, j):
        """Whether nothing holds an element any more."""
        x = self.x.reshape(*self.shape, 3)
        warp = self.whole(0, i, j) or self.whole(0, i, j + 1)
        weft = self.whole(1, i, j) or self.whole(1, i + 1, j)
        wide = [
            np.linalg.norm(x[i + 1, j] - x[i, j] + x[i + 1, j + 1] - x[i, j + 1])
            > 2 * self.c.erosion_gap_ratio * self.c.dx,
            np.linalg.norm(x[i, j + 1] - x[i, j] + x[i + 1, j + 1] - x[i + 1, j])
            > 2 * self.c.erosion_gap_ratio * self.c.dy,
        ]
        if (not warp and (not weft or wide[0])) or (not weft and wide[1]):
            self.gone.add((i, j))
        return (i, j) in self.gone

    def shares(self, i, j, s, t):
        """[(slot, signs, weight)] of the point (s, t) of element (i, j)."""
        m, n, own = i + (s > 0.5), j + (t > 0.5), (1 if s < 0.5 else -1, 1 if t < 0.5 else -1)
        runs = [
            self.whole(0, m - 1, n) and self.whole(0, m, n),
            self.whole(1, m, n - 1) and self.whole(1, m, n),
        ]
        for a in (-1, 1):
            for b in (-1, 1):
                weighs = (a == own[0] or runs[0]) and (b == own[1] or runs[1]) and (a, b) != own
                if weighs and not (self.whole(0, min(m, m + a), n + b) or self.whole(1, m + a, min(n, n + b))):
                    return self.sum_up(m, n, basis_of(s - (s > 0.5), False), basis_of(t - (t > 0.5), False))
        return self.sum_up(m, n, basis_of(s - (s > 0.5), runs[0]), basis_of(t - (t > 0.5), runs[1]))

    def sum_up(self, m, n, along, across):
        """The shares of the nodes about node (m, n), whose images lie beyond planes of symmetry."""
        found = []
        for a in range(3):
            for b in range(3):
                if along[a] * across[b] > 0:
                    p, q = m + a - 1, n + b - 1
                    signs = np.array([-1 if p < 0 else 1, -1 if q < 0 else 1, 1])
                    found.append((abs(p) * self.shape[1] + abs(q), signs, along[a] * across[b]))
        return found

    def touch(self, i, j):
        c = self.c
        for a in range(c.points_per_side):
            for b in range(c.points_per_side):
                s, t = (a + 0.5) / c.points_per_side, (b + 0.5) / c.points_per_side
                shares = self.shares(i, j, s, t)
                x = sum(w * signs * self.x[k] for k, signs, w in shares) - [0, 0, self.z]
                v = sum(w * signs * self.v[k] for k, signs, w in shares) - [0, 0, self.speed]
                r = np.hypot(x[0], x[1])
                depth, n_r, n_z = flat(r, x[2], c.projectile_radius, c.edge_radius)
                n = np.array([n_r * x[0] / r, n_r * x[1] / r, n_z]) if r > 0 else np.array([0, 0, n_z])
                left = 0.5 * (self.whole(0, i, j + (t > 0.5)) + self.whole(1, i + (s > 0.5), j))
                f = np.zeros(3)
                if depth < 0:
                    f = left * max(0.0, -c.point_law.damping * n @ v - c.point_law.stiffness * depth) * n
                self.contact -= 0.5 * (f + self.forces[i, j, a, b]) @ v * c.dt
                self.forces[i, j, a, b] = f
                for k, signs, w in shares:
                    self.f[k] += w * signs * f
                self.reaction -= f[2]


def basis_of(s, bent):
    """Weights of the node before, the nearest, the one behind, on a parabola or on straight lines."""
    if bent:
        return (0.5 - s) ** 2 / 2, 0.75 - s**2, (0.5 + s) ** 2 / 2
    return max(-s, 0.0), 1 - abs(s), max(s, 0.0)


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
        kernels.run_steps(state, const, 1, history)
        twin.step()
        size = len(twin.X)
        assert np.abs(state.u[:, :size].T - (twin.x - twin.X)).max() < 1e-12
    assert state.counter[kernels.FAILURES] == sum(bar["k"] == 0 for bar in twin.bars) >= failures
    assert state.projectile_velocity[2] == pytest.approx(twin.speed, rel=1e-9)
    sums = state.energy_sums[[kernels.VISCOUS, contact_kernels.CONTACT, kernels.LOST]]
    assert sums == pytest.approx([twin.viscous, twin.contact, twin.lost], rel=1e-6, abs=1e-12)


def test_every_bar_once():
    """No bar where there is none: not past the edges, nor from the end of a row to the beginning of the next."""
    for symmetry in ("quarter", "half", "whole"):
        net = small(symmetry)
        stiff = (
            net.state(1.0).stiffness[:, : (net.counts[0] + 1) * (net.counts[1] + 1)].reshape(2, net.counts[0] + 1, -1)
        )
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
            state.active_rows[:] = 0, const.ni
        kernels.run_steps(state, const, 150, history)
        histories.append((history, state.u.copy(), state.active_rows[1]))
    assert histories[0][2] < net.counts[0]
    assert np.array_equal(histories[0][1], histories[1][1])
    assert np.array_equal(histories[0][0], histories[1][0])
