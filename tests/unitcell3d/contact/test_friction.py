"""Coulomb friction of the contact: a block that is pushed along another, what is dissipated, and the crossover."""

from itertools import pairwise

import numpy as np
import pytest
from blocks import Blocks, block, level
from equations import end_forces, loaded, shares

from unitcell3d.model.crossover import CrossoverModel, Load, Numerics

E = 1e9
SIDE = 1e-3
MU = 0.3
DESCENT = 2e-7


class Pushed(Blocks):
    """The upper block is pressed down by its top, which is then driven along x; the lower one stands."""

    def __init__(self, cells, numerics):
        upper, lower = (np.linspace(0, SIDE, n + 1) for n in cells)
        # the upper block ends before the lower one, which it may slide over
        depth = np.linspace(0, SIDE / 2, 3)
        super().__init__(
            block(0, 0.1 * SIDE + 0.6 * upper, 0.2 * SIDE + 0.6 * upper, depth, level),
            block(1, lower, lower, depth, level),
            E,
            0.0,
            quarter=False,
            slide=False,
            numerics=numerics,
        )

    def drive(self, u, descent, along, steps):
        """Forces (steps, 3) [N] of the upper block on the lower, when the top is driven on to `along` [m]."""
        found = []
        start = u[self.top, 0].mean()
        for share in shares(steps):
            u[self.top] = [start + share * (along - start), 0, -descent]
            self._settle(u, self.free)
            self.surfaces.commit(self.points + u, self.numerics)
            found.append(self.contact[self.grids[1].ravel()].sum(axis=0))
        return -np.array(found)


def pushed(slip):
    pair = Pushed((2, 3), Numerics(penalty=1e15, toe=1e-12, friction=MU, slip=slip))
    u = np.zeros_like(pair.points)
    pair.drive(u, DESCENT, 0.0, 1)
    return pair, u


def ratios(pair, u, along, steps):
    force = pair.drive(u, DESCENT, along, steps)
    return -force[:, 0] / force[:, 2]


def test_a_block_sticks_below_the_friction_force_and_slides_at_it():
    """Driven a little it comes back, but for its edges; driven far it slides at the coefficient times the load."""
    pair, u = pushed(2e-7)
    (start,) = ratios(pair, u, 0.0, 1)  # blocks that bulge over each other's edges rub at once
    out = ratios(pair, u, 1e-8, 2)
    back = ratios(pair, u, 0.0, 2)
    assert out[1] - start == pytest.approx(2 * (out[0] - start), rel=0.02)
    assert abs(back[-1] - start) < 0.2 * (out[-1] - start)
    slide = ratios(pair, u, 1.2e-6, 8)
    assert np.all(np.diff(slide) > 0)
    assert slide[-2:] == pytest.approx(MU, rel=2e-3)
    assert ratios(pair, u, 1.1e-6, 1) < 0.9 * MU  # what has slid does not come back with it


def test_the_regularisation_slip_only_delays_the_sliding():
    found = [ratios(*pushed(slip), 1.2e-6, 8) for slip in (2e-7, 1e-7, 5e-8)]
    for force in found:
        assert force[-1] == pytest.approx(MU, rel=2e-3)
    coarse, fine = (abs(a - b).max() for a, b in pairwise(found))
    assert fine < coarse


def test_the_answer_depends_on_the_route_with_friction_alone(tiny, s720):
    """Warp first or weft first: apart with friction, less apart with less, and not without."""
    routes = [[(16e-6, 0.0), (16e-6, 16e-6)], [(0.0, 16e-6), (16e-6, 16e-6)]]
    apart = []
    for friction in (0.0, 0.005, 0.02):
        one, other = (end_forces(tiny, s720, route, friction) for route in routes)
        apart.append(abs(one - other).max() / one.max())
    assert apart[0] < 1e-6
    assert 1e-4 < apart[1] < 0.7 * apart[2]


def test_contact_with_friction_is_in_equilibrium(tiny, s720):
    """Every unknown's residual is nil and the contact still carries what the ends pull down."""
    model = CrossoverModel(tiny, s720, Numerics(friction=0.3))
    end = Load((12e-6, 4e-6))
    solver, state = loaded(model, end)
    solver.close()
    forces, contact, _ = model.forces(state.q, end)
    assert abs(model.constraints.reduce(forces)).max() < 1e-7 * contact
    for yarn, sign in ((0, -1), (1, 1)):
        assert forces[model.constraints.ends[yarn], 2].sum() == pytest.approx(
            sign * contact, rel=1e-5
        )
