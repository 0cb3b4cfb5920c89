"""One yarn pulled through the crossover: Coulomb's limit, what resists without friction, equilibrium, and what is
refused."""

import numpy as np
import pytest

from fabrics.errors import InputError, UnstableError
from meshing import crossover as mesher
from unitcell3d.cases import pull_out
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.pull_out import PullLoad, PullOutModel
from unitcell3d.solver.record import Record

MU = 0.2


@pytest.fixture(scope="module")
def whole(s720):
    return mesher.build(s720, domain="whole", size=(4, 3, 2))


@pytest.fixture(scope="module")
def pulled(whole, s720):
    """Two transverse loads, the warp pulled far enough to slide."""
    loads = np.array(pull_out.displacements(s720, 0))[[1, 3]]
    return pull_out.pull_out(whole, s720, loads, numerics=Numerics(friction=MU))


def test_the_threshold_is_linear_in_the_contact_force(pulled):
    assert pulled.failed == ""
    law = pull_out.fit(pulled, "4,3,2")
    F_c, T_f = pull_out.thresholds(pulled)
    assert F_c[1] > 1.5 * F_c[0] > 0
    assert law.mu_eff == pytest.approx(MU, rel=0.2)  # yarns that are wrapped press on each other obliquely too
    assert abs(law.c0) < 0.1 * T_f[-1]
    assert law.friction == MU
    assert law.status == "literature"


def test_it_sticks_before_it_slides(pulled):
    """The axial force rises at a falling rate; it is the friction and what the normal pressures take."""
    for number in (0, 1):
        of = (pulled["load"] == number) & (pulled["pull"] > 0)
        P = pulled["P"][of]
        assert np.all(np.diff(P) > -1e-2 * P.max())
        assert P[1] - P[0] > 3 * abs(P[-1] - P[-2])
        assert pulled["mobilised"][of][-1] >= pull_out.SLIDING
        assert P[-1] - pulled["P_geometric"][of][-1] <= 1.1 * MU * pulled["F_c"][of][-1]
    before = (pulled["pull"] == 0) & (pulled["d2"] > 0)
    assert np.abs(pulled["P"][before]).max() < 1e-6 * pulled["F_c"].max()


def test_without_friction_only_the_crimp_resists(whole, s720, pulled):
    loads = pull_out.displacements(s720, 0)[-1:]
    free = pull_out.pull_out(whole, s720, loads, numerics=Numerics(friction=0.0), rows=6)
    assert free.failed == ""
    assert np.abs(free["P"]).max() < 0.25 * pulled["P"].max()
    assert free["P"] == pytest.approx(free["P_geometric"], abs=1e-6 * free["F_c"].max())


def test_the_pull_is_in_equilibrium(whole, s720):
    """What the pulled yarn takes from the crossing yarn is what the ends of that take from the fabric."""
    model = PullOutModel(whole, s720, Numerics(friction=MU))
    found = pull_out.path_following.follow(
        model, [PullLoad(), PullLoad((0.0, 6e-6)), PullLoad((0.0, 6e-6), 2e-6)], lambda state, load: {}, rows=[3, 1]
    )
    forces, _, _ = model.forces(found.q, PullLoad((0.0, 6e-6), 2e-6))
    weft = np.unique(whole.grids[1])
    P = model.axial_force(forces)
    assert P > 1e-2
    assert forces[weft, 0].sum() == pytest.approx(-P, rel=1e-9)
    ends = np.concatenate([whole.grids[1][end].ravel() for end in (0, -1)])
    assert forces[ends, 0].sum() == pytest.approx(-P, rel=1e-4)


def test_platens_press_the_yarns_together(whole, s720):
    """The contact force before the pull is that of the platens; in sliding, friction is Coulomb's share of it."""
    pressure = 0.5e6
    found = pull_out.pull_out(whole, s720, pressures=(pressure,), numerics=Numerics(friction=MU))
    assert found.failed == ""
    pressed = int(np.flatnonzero(found["pull"] == 0)[-1])
    force = found["F_plate"][pressed].mean()
    assert force == pytest.approx(pressure * s720.weave.cell_area, rel=0.1)  # interpolated between two states
    assert found["F_c"][pressed] == pytest.approx(force, rel=0.05)
    assert np.abs(found["P"][: pressed + 1]).max() < 1e-6 * force
    assert np.ptp(found["plates"][pressed:]) == 0
    (F_c,), (T_f,) = pull_out.thresholds(found)
    assert T_f == pytest.approx(MU * F_c, rel=0.15)
    assert found["T2"][pressed:].max() > 1  # it draws the crossing yarn along, which takes the pull as a string


def test_a_record_survives_its_file(pulled, tmp_path):
    pulled.write(tmp_path / "case.h5")
    again = Record.read(tmp_path / "case.h5")
    np.testing.assert_array_equal(pull_out.thresholds(again), pull_out.thresholds(pulled))


def test_what_is_refused(whole, coarse, s720):
    for loads in ((), (0.0,), (-1e-6,), (np.inf,)):
        with pytest.raises(InputError, match="displacements"):
            pull_out.pull_out(whole, s720, loads)
    with pytest.raises(InputError, match="at least one positive pressure"):
        pull_out.pull_out(whole, s720, pressures=(-1e6,))
    with pytest.raises(InputError, match="left out where displacements"):
        pull_out.pull_out(whole, s720, (1e-6,), pressures=(1e6,))
    with pytest.raises(InputError, match="pull"):
        pull_out.pull_out(whole, s720, (1e-6,), pull=0.0)
    with pytest.raises(InputError, match="whole"):
        PullOutModel(coarse, s720)


def test_a_yarn_that_has_not_slid_has_no_law(pulled):
    short = Record(
        {name: column[pulled["mobilised"] < 0.5] for name, column in pulled.columns.items()}, {}, pulled.u, "S-720",
        "pull-out", facts=pulled.facts,
    )  # fmt: skip
    with pytest.raises(UnstableError, match="slid at 0 of 2"):
        pull_out.fit(short)
