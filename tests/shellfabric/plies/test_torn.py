"""Torn plies make no energy: the books of every contact point, the area that packed fabric keeps, shots made again."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from panels import areas, grid

from fabrics import catalogue
from shellfabric import guards
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.jit.table import Rows
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import packing_kernels, quality
from shellfabric.membrane.indicator import NOTED
from shellfabric.membrane.numerics import Numerics
from shellfabric.plies import law_kernels
from shellfabric.plies.numerics import PlyContact
from shellfabric.state import ERODED

S726 = catalogue.load("S-726").with_effective_density()
SHARE = PlyContact().resilience
SHOT = ImpactSetup(
    S726,
    300.0,
    plies=3,
    opening=0.03,
    elements_per_crossover=2,
    table_size=41,
    numerics=Numerics(threads=1),
)


def stored_by_points(contact):
    """[J] sum over all points of their area at rest times what the law gives back of what motion has closed them by."""
    total = 0.0
    parted = []
    pressure = contact.pressure
    for p, laws in enumerate(pressure.laws):
        nj = contact.nj[p]
        each = pressure.points_per_side**2
        for slot, closures in enumerate(pressure.last_closure):
            first = pressure.first_point[p]
            end = pressure.first_point[p + 1]
            touching = pressure.last_contact_step[slot, first:end] == contact.step
            for number in first + np.flatnonzero(touching):
                row, j = divmod(number - first, nj)
                area = pressure.area_ratio[pressure.first_element[p] + row // each * nj + j]
                closure = closures[number] - pressure.unearned_closure[slot, number]
                deepest = pressure.deepest_closure[slot, number]
                parted.append(closure < deepest)
                drawn = deepest - (deepest - closure) / SHARE
                stored = law_kernels.law_at(laws, pressure.law_cell[p], drawn)[2]
                total += area * SHARE * stored
    assert not parted or 0 < np.mean(parted) < 1
    return total


def least_area(march):
    """[-] of all elements that are fabric, over their area at rest, from their diagonals."""
    least = np.inf
    for panel, const, state in march.plies:
        x = np.stack([grid(u, panel) for u in state.u], axis=-1)
        x[..., :2] += np.stack(panel.coordinates(), axis=-1)
        area = areas(x) / (const.dx * const.dy)
        for (i, j), share in np.ndenumerate(area):
            k = np.uint64(i * const.row_stride + j)
            gone = state.element_flag[k] & ERODED
            if not gone and packing_kernels.is_fabric.py_func(state, const, k):
                least = min(least, share)
    return least


@cache
def shot(stiffness=1.0):
    """(solver, rows: work of the contact of plies so far, what it stores, the same by points [J], least area [-]).

    stiffness : factor on that of packed fabric
    """
    march = PackSolver(SHOT.target(), SHOT.strike_velocity, 50e-6, interval=1e-6)
    rows = []
    march.consts = tuple(
        const._replace(packing_stiffness=stiffness * const.packing_stiffness)
        for const in march.consts
    )
    march._plies = march._plies[0], Rows(march.consts)

    def book(run):
        work = run.sample("ply_contact")[-1] + run.sample("ply_contact_lost")[-1]
        stored = run.contact.pressure.spring_energy.sum() / run.share
        rows.append((work, stored, stored_by_points(run.contact) / run.share, least_area(run)))

    return march.run((book,)), np.array(rows).T


def test_the_contact_of_torn_plies_gives_no_more_than_it_took():
    """What it has taken and does not store only grows. Areas that change, and closures that jump, store more than was
    taken: 5 % of the strike energy came so in a shot of 4 x S-726."""
    march, (work, stored, by_points, _) = shot()
    assert march.sample("cut_yarns")[-1] > 20
    assert_allclose(stored, by_points, rtol=1e-9, atol=1e-9 * march.strike_energy)
    made = -np.minimum(np.diff(work - stored), 0.0).sum()
    assert made < 5e-4 * march.strike_energy
    lost = march.sample("ply_contact_lost")
    assert np.diff(lost).min() >= 0.0
    assert 0.0 < lost[-1] < 0.02 * march.strike_energy


def test_torn_fabric_keeps_the_area_of_its_packed_yarns():
    (_, (_, _, _, held)), (_, (_, _, _, let_go)) = shot(), shot(0.0)
    share = SHOT.packed_area
    assert let_go.min() < share
    assert held.min() > let_go.min()
    missing, without = (np.maximum(share - least, 0.0).sum() for least in (held, let_go))
    assert missing < without


def test_a_run_that_loses_too_much_to_its_step_is_made_again_once(monkeypatch):
    setup = ImpactSetup(
        S726, 200.0, opening=0.03, table_size=41, end_time=4e-6, numerics=Numerics(threads=1)
    )
    first = run_impact(setup)
    assert first.step_factor == 1.0
    monkeypatch.setattr(guards, "MOST_STEP_LOSS", 0.0)
    times = []
    again = run_impact(setup, hooks=(lambda run: times.append(run.const.dt),))
    assert again.step_factor == guards.SHORTER_STEPS[-1]
    assert again.steps / first.steps == pytest.approx(1 / again.step_factor, rel=0.02)
    assert len(set(times)) == 2


def test_collisions_of_plies_that_the_mesh_makes_are_said():
    march, _ = shot()
    found = {check.name: check for check in quality.of_solver(march)}["ply collisions"]
    share = march.sample("ply_collisions")[-1] / march.strike_energy
    assert found.value == pytest.approx(max(share, 0.0))
    assert quality.indicator("ply collisions", 0.17).doubtful
    assert quality.indicator("ply collisions", 0.07).status == NOTED
