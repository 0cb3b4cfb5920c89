"""Packs: one ply is a single ply, nothing goes through, the law between platens, stacking, and what ends a run."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import advance, collide, far_from_nose, momenta, same
from numpy.testing import assert_allclose

from fabrics import ply_laws
from fabrics.base.errors import InputError
from fabrics.ply_law import PlyLaw
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.arrays import nose_law
from shellfabric.plies.frame_kernels import BEHIND
from shellfabric.plies.model import Pack, PlyContact
from validation.models.ply_crossings import plies_cross

GAP = 0.1e-3


def test_far_behind_is_a_single_ply(ply, monkeypatch):
    far = Pack(
        (ply, ply), (0.5,), PlyContact(courant=10.0, damping=0.0)
    )  # which leaves the step to the plies
    # the nose's contact of a single ply is explicit
    explicit = lambda ply, mass, implicit: nose_law(ply, mass)  # noqa: E731
    monkeypatch.setattr("shellfabric.plies.model.nose_law", explicit)
    alone = far._in_step(ply)
    single = PackSolver(alone, 120.0, 20e-6).run()
    pack = PackSolver(far, 120.0, 20e-6).run()
    # the grid of a pack has room that a firm nose would need
    first = pack.states[0]
    for name in ("surface", "dv_other", "dv_contact"):
        first = first._replace(**{name: getattr(single.state, name)})
    assert same(single.state, first)
    assert single.sample("cut_yarns")[-1] > 0
    assert not pack.stack.awake[1]
    assert not any(u.any() for u in pack.states[1].u)


def test_fast_shots_at_thin_plies_do_not_pass_through(ply):
    """The wave that a nose drives into a pack leaves plies nearer to each other by v sqrt(A / K): more than their
    thickness, where the guard takes over."""
    pack = Pack.stacked(ply, 4, gap=0.0, law=ply_laws.solid_fibre(ply.fabric))
    step = pack.time_step
    courant = pack.contact.closing_courant
    period = (ply.weave.areal_density / pack.contact_laws[0].stiffness) ** 0.5
    assert step == pytest.approx(courant * period)
    assert step < ply.time_step
    march = PackSolver(pack, 2000.0, 30 * step, interval=step)
    march._guard = march.guard_model  # fabric tears at once
    seen = []
    march.run((lambda run: seen.append(plies_cross(run)),))
    assert march.held_apart > 0
    assert not any(seen)


@pytest.mark.parametrize("share", [1.0, 0.6, 0.3])
def test_a_column_of_plies_is_stable_on_the_steeper_branch(share):
    """Central differences of 12 masses, free at both ends, on springs 1 / share times as stiff as the law, with the
    law's dampers, whose velocity is that of half a step ago: no mode grows; with a step a quarter longer one does."""
    contact = PlyContact(resilience=share)
    nodes = 12
    ends = np.diff(np.eye(nodes), axis=0)
    stack = ends.T @ ends

    def largest(courant):
        pull = courant**2 / share * stack
        drag = 2 * contact.damping * courant * 0.5 * stack
        speeds = np.hstack([-pull, np.eye(nodes) - drag])
        places = np.hstack([np.eye(nodes), np.zeros((nodes, nodes))]) + speeds
        return abs(np.linalg.eigvals(np.vstack([places, speeds]))).max()

    assert largest(contact.closing_courant) < 1 + 1e-6
    assert largest(1.25 * contact.closing_courant) > 1.05


CONTACTS = {
    "damped": (PlyContact(), (0.35, 0.5)),
    "elastic": (PlyContact(damping=0.0, resilience=1.0, stiffness=1.0), (-0.02, 0.01)),
}


@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("grading", [None, ((7, 1), (np.inf, 2)), ((7, 0.5), (np.inf, 1))])
def test_colliding_plies_keep_momentum_and_energy(ply, grading, contact):
    free = replace(ply, boundary="free", symmetry="whole", opening=(0.034, 0.034), grading=grading)
    numbers, (least, most) = CONTACTS[contact]
    pack = Pack.stacked(free, 2, stacking="alternating", gap=20e-6, contact=numbers)
    march, before, energy = collide(pack, (0.0, 0.0, 20.0), 300)
    sums = momenta(march)
    assert_allclose(sums.sum(axis=0), before, atol=1e-12 * before[2])
    assert sums[1, 2] > 0.4 * before[2]
    assert abs(march.sample("error")[-1]) < 1e-6 * energy
    taken = march.sample("ply_contact")[-1] / energy
    # all of the rear ply but its rim is met; of what meets, the dead contact keeps less than half
    assert least < taken < most


@pytest.mark.parametrize("velocity", [158.0, 474.0])
def test_no_ply_goes_through_another(ply, velocity):
    """At the usual speed and at three times that."""
    wide = replace(ply, opening=(0.16, 0.16))  # waves do not come back in the time
    march = PackSolver(
        Pack.stacked(wide, 4, stacking="alternating", gap=GAP), velocity, 30e-6
    ).run()
    assert march.deepest.max() < 1.0
    assert (march.ply_samples[-1][:, 0].sum() > 0) == (velocity > 200)
    assert not plies_cross(march)


LAWS = {"solid": None, "weave": PlyLaw([0.0, 20e-6, 35e-6, 45e-6], [0.0, 0.5e6, 4e6, 19e6], 1.4e13)}


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("plies", [2, 8])
def test_a_pack_between_platens_has_the_law(ply, plies, law):
    """Closed check, up to 50 MPa: the outer plies are moved towards each other and held, those between them are free.

    The pack is N - 1 closures nearer; each of them is that of the law at the pressure of the pack.
    """
    free = replace(ply, boundary="free", symmetry="whole", opening=(0.012, 0.012))
    march = far_from_nose(Pack.stacked(free, plies, gap=0.0, law=LAWS[law]))
    closed = 0.0
    for p in (0, -1):
        march.states[p].dt_over_mass[:] = 0.0  # platens: no force moves them
    area = march.const.ni * march.const.dx * march.const.nj * march.const.dy
    for pressure in (1e6, 5e6, 19e6, 50e6):
        closure = float(march.pack.contact_laws[0].closure_at(pressure))
        for p, state in enumerate(march.states):
            state.v[2][:] = (plies - 1 - p) * (closure - closed) / (100 * march.const.dt)
        advance(march, 100)
        for state in march.states:
            state.v[2][:] = 0.0
        closed = closure
        advance(march, 100)
        for p in range(plies - 1):
            assert -march.contact.pressure.force[p, BEHIND, 2].sum() / area == pytest.approx(
                pressure, rel=0.01
            )


def test_bad_packs_are_reported(ply):
    whole = replace(ply, symmetry="whole")
    graded = replace(ply, grading=((8, 1), (np.inf, 2)))
    for key, plies, gaps in (
        ("plies", (), ()),
        ("gaps", (ply, ply), ()),
        ("gap", (ply, ply), (-1e-6,)),
        ("symmetry", (ply, whole), (GAP,)),
        ("one grading", (ply, graded), (GAP,)),
    ):
        with pytest.raises(InputError, match=key):
            Pack(plies, gaps)
    for bad in ({"courant": 0.0}, {"stiffness": -1.0}, {"damping": -1.0}, {"points": 0}):
        with pytest.raises(InputError, match=next(iter(bad))):
            PlyContact(**bad)
