"""One yarn pulled through the crossover: Coulomb's limit, what resists without friction, equilibrium.

Stored numbers are those of their mesh; the tolerance admits another compiler's rounding through the steps, not another
answer.
"""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fabrics.base.errors import UnstableError
from fabrics.base.record import Record
from unitcell3d.cases import pull_out
from unitcell3d.model.crossover import Numerics
from unitcell3d.model.pull_out import PullLoad, PullOutModel
from unitcell3d.solver.path_following import follow

MU = 0.2


def pull(mesh, fabric):
    """Two transverse loads, the warp pulled far enough to slide."""
    loads = np.array(pull_out.displacements(fabric, 0))[[1, 3]]
    return pull_out.pull_out(mesh, fabric, loads, numerics=Numerics(friction=MU))


@pytest.fixture(scope="module")
def pulled(few, s720):
    return pull(few, s720)


@pytest.mark.slow(10)
def test_the_threshold_is_linear_in_the_contact_force(whole, s720):
    """Yarns that are wrapped press on each other obliquely too: the slope is 3 % above the coefficient."""
    pulled = pull(whole, s720)
    assert pulled.failed == ""
    law = pull_out.fit(pulled)
    F_c, T_f = pull_out.thresholds(pulled)
    assert F_c == pytest.approx((3.9663, 11.4555), rel=5e-3)
    assert law.mu_eff == pytest.approx(0.20659, rel=5e-3)
    assert abs(law.c0) < 0.01 * T_f[-1]


def test_thresholds_of_few_elements_stay(pulled, tmp_path):
    """And are read back from a file."""
    assert pulled.failed == ""
    F_c, T_f = pull_out.thresholds(pulled)
    assert F_c == pytest.approx((3.5237, 10.9338), rel=5e-3)
    assert T_f == pytest.approx((0.74117, 2.18135), rel=5e-3)
    assert pull_out.fit(pulled).mu_eff == pytest.approx(0.19435, rel=5e-3)
    pulled.write(tmp_path / "case.h5")
    again = Record.read(tmp_path / "case.h5")
    assert_array_equal(pull_out.thresholds(again), (F_c, T_f))


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
    assert abs(pulled["P"][before]).max() < 1e-6 * pulled["F_c"].max()


def test_without_friction_only_the_crimp_resists(few, s720, pulled):
    loads = pull_out.displacements(s720, 0)[-1:]
    free = pull_out.pull_out(few, s720, loads, numerics=Numerics(friction=0.0), rows=6)
    assert free.failed == ""
    assert abs(free["P"]).max() < 0.25 * pulled["P"].max()
    assert free["P"] == pytest.approx(free["P_geometric"], abs=1e-6 * free["F_c"].max())


def test_the_pull_is_in_equilibrium(few, s720):
    """What the pulled yarn takes from the crossing yarn is what the ends of that take from the fabric."""
    model = PullOutModel(few, s720, Numerics(friction=MU))
    loads = [PullLoad(), PullLoad((0.0, 6e-6)), PullLoad((0.0, 6e-6), 2e-6)]
    states = []

    def row(state, load):
        states.append(state)
        return {}

    follow(model, loads, row, rows=[3, 1])
    forces, _, _ = model.forces(states[-1].q, loads[-1])
    weft = np.unique(few.grids[1])
    P = model.axial_force(forces)
    assert P > 1e-2
    assert forces[weft, 0].sum() == pytest.approx(-P, rel=1e-9)
    ends = np.concatenate([few.grids[1][end].ravel() for end in (0, -1)])
    assert forces[ends, 0].sum() == pytest.approx(-P, rel=1e-4)


@pytest.mark.slow
def test_platens_press_the_yarns_together(whole, s720):
    """The contact force before the pull is that of the platens; in sliding, friction is Coulomb's share of it."""
    pressure = 0.5e6
    found = pull_out.pull_out(
        whole, s720, pressures=(pressure,), numerics=Numerics(friction=MU), rows=8
    )
    assert found.failed == ""
    pressed = int(np.flatnonzero(found["pull"] == 0)[-1])
    force = found["F_plate"][pressed].mean()
    assert force == pytest.approx(pressure * s720.weave.cell_area, rel=5e-3)
    assert found["F_c"][pressed] == pytest.approx(force, rel=5e-3)
    assert abs(found["P"][: pressed + 1]).max() < 1e-6 * force
    assert np.ptp(found["plates"][pressed:]) == 0
    (F_c,), (T_f,) = pull_out.thresholds(found)
    assert (F_c, T_f / F_c) == pytest.approx((1.1687, 0.2085), rel=5e-3)
    # it draws the crossing yarn along, which takes the pull as a string
    assert found["T2"].max() == pytest.approx(1.533, rel=5e-3)


def test_a_yarn_that_has_not_slid_has_no_law(pulled):
    columns = {name: column[pulled["mobilised"] < 0.5] for name, column in pulled.columns.items()}
    with pytest.raises(UnstableError, match="slid at 0 of 2"):
        pull_out.fit(Record(columns, {}, pulled.facts))
