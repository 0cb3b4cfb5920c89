"""The weave in its own cell: the quarter's answer, four crossovers, rigid turns, tangent, edges, and shear."""

import numpy as np
import pytest
from equations import assert_model_tangent, assert_tangent, dense
from numpy.testing import assert_allclose, assert_array_equal

from meshing import crossover as mesher
from meshing import patch
from unitcell3d.cases import biaxial_and_platens, periodic_cell
from unitcell3d.contact.edge_contact_kernels import edge_pass
from unitcell3d.identify import shear_fit
from unitcell3d.model.periodic_cell import CellLoad, CellModel
from unitcell3d.solver.newton import Newton

SIZE = (3, 2, 2)
REACH = 10e-6


@pytest.fixture(scope="module")
def whole(s720):
    """Conforming sections need no shift, so that crossover and patch are the same geometry."""
    return mesher.build(s720, size=SIZE, domain="whole", section="conforming")


@pytest.fixture(scope="module")
def four(s720):
    return patch.build(s720, (2, 2), size=SIZE, section="conforming")


@pytest.fixture(scope="module")
def model(whole, s720):
    return CellModel(whole, s720)


def test_one_with_glides_and_four_with_repetition_equal_the_quarter(whole, four, s720):
    """Biaxial tensions and contact force within 1e-6 (found 3e-9): the end conditions say the same."""
    quarter = mesher.build(s720, size=SIZE, section="conforming")
    history = biaxial_and_platens.biaxial(quarter, s720, (1, 1), max_displacement=REACH)
    expected = [history[name][-1] for name in ("T1", "T2", "F_c")]
    for mesh in (whole, four):
        record = periodic_cell.biaxial(mesh, s720, (REACH, REACH), rows=4)
        assert record.failed == ""
        assert [record[key][-1] for key in ("T1", "T2", "F_c")] == pytest.approx(expected, rel=1e-6)
        assert abs(record["moment"][-1]) < 1e-9


def test_load_drives_the_weave_as_a_trellis():
    """Yarns keep their lengths, enclose 90 degrees less gamma, and the derivatives are those of the parameters."""
    w = (0.6e-3, 0.5e-3)
    load = CellLoad(w, (6e-6, -5e-6), 0.4)
    lengths = np.linalg.norm(load.F, axis=0)
    assert lengths == pytest.approx([1.01, 0.99])
    assert load.F[:, 0] @ load.F[:, 1] / lengths.prod() == pytest.approx(np.sin(0.4))
    step = 1e-6
    turned = [CellLoad(w, load.d, 0.4 + s * step).drive for s in (1, -1)]
    assert (turned[0] - turned[1]) / (2 * step) == pytest.approx(load.by_gamma, abs=1e-9)
    for yarn in (0, 1):
        move = 1e-9 * np.eye(2)[yarn]
        moved = [CellLoad(w, tuple(np.add(load.d, s * move)), 0.4).drive for s in (1, -1)]
        assert (moved[0] - moved[1]) / 2e-9 == pytest.approx(load.by_d[yarn], rel=1e-6, abs=1e-6)


def test_a_yarn_that_the_trellis_turns_bears_no_force(model):
    """The drive turns each yarn as a rigid body: without contact nothing resists."""
    load = CellLoad(model.w, gamma=0.5)
    x = model.positions(np.zeros(model.size), load)
    model._deform(x)
    assert abs(model._solids.residual()).max() < 1e-12
    bars = np.zeros_like(x)
    model.fibres.forces(x, model.numerics, bars)
    assert abs(bars).max() < 1e-9


def test_tangent_is_the_derivative(model):
    """Crossing, edges and ties together, in a sheared state where all of them act."""
    load = CellLoad(model.w, (4e-6, 4e-6), 0.35)
    rng = np.random.default_rng(3)
    q = 2e-7 * rng.standard_normal(model.size)
    warp = np.unique(model.constraints.unknown[3 * model.crossover.grids[0].ravel() + 2])
    q[warp[warp >= 0]] -= 2e-6
    model.forces(q, load)
    assert np.all(model.surfaces.forces[: model.crossings] != 0)
    model.system(q, load)
    model.forces(q, load)
    model.system(q, load)
    direction = rng.standard_normal(model.size)
    assert_model_tangent(model, q, load, direction)


def test_moment_and_tensions_are_the_work_of_the_load(model, four, s720):
    """Per crossing of one or of four, on a state that is no equilibrium too: internal forces . d(positions) by
    gamma, d1 and d2."""
    for cell in (model, CellModel(four, s720)):
        load = CellLoad(cell.w, (5e-6, 3e-6), 0.2)
        q = 1e-7 * np.random.default_rng(4).standard_normal(cell.size)
        forces = cell.forces(q, load)[0]
        step = 1e-7
        moved = [cell.positions(q, CellLoad(cell.w, load.d, 0.2 + s * step)) for s in (1, -1)]
        work = np.sum(forces * (moved[0] - moved[1])) / (2 * step)
        assert cell.crossings * cell.moment(forces, load) == pytest.approx(work, rel=1e-6)
        moved = [cell.positions(q, CellLoad(cell.w, (5e-6 + s * 1e-9, 3e-6), 0.2)) for s in (1, -1)]
        work = np.sum(forces * (moved[0] - moved[1])) / 2e-9
        assert 2 * cell.crossings * cell.tensions(forces, load)[0] == pytest.approx(work, rel=1e-6)


def test_stick_state_is_that_of_the_crossings_alone(model):
    """Edges slide without friction: they keep no anchors."""
    before = model.stick_state
    assert before.size == sum(
        side.anchors.size for pair in model.surfaces.pairs[: model.crossings] for side in pair
    )
    model.stick_state = before + 0.25
    assert_array_equal(model.stick_state, before + 0.25)
    model.stick_state = before


NODES = 6
TOWARD = np.array([0.0, 1.0, 0.0])
AREA = 0.7
PENALTY = 10.0
TOE = 0.01
FIRST = np.arange(NODES)
SECOND = np.arange(NODES, 2 * NODES)


@pytest.fixture
def crossing():
    """Two wavy edges that cross at 33 degrees, 0.1 through each other."""
    rng = np.random.default_rng(0)
    s = np.linspace(-2.5, 2.5, NODES)
    edges = [
        np.stack(
            [
                s,
                y + 0.02 * rng.standard_normal(NODES),
                slope * s + 0.02 * rng.standard_normal(NODES),
            ],
            axis=1,
        )
        for y, slope in ((0.05, 0.3), (-0.05, -0.3))
    ]
    return np.concatenate(edges)


def touch(x, places=None, values=None):
    forces = np.zeros_like(x)
    nodes = np.full(8, -1)
    none = np.empty((0, 0), np.int64)
    found = edge_pass(
        x,
        FIRST,
        SECOND,
        TOWARD,
        AREA,
        PENALTY,
        TOE,
        nodes,
        forces,
        none if places is None else places,
        np.zeros((1, 3, 3)) if values is None else values,
    )
    return forces, nodes, *found


def test_edges_push_each_other_apart_in_balance(crossing):
    forces, nodes, gap, force = touch(crossing)
    assert gap == pytest.approx(-0.1, abs=0.05)
    assert force == pytest.approx(PENALTY * AREA * (-gap - TOE / 2))
    assert set(nodes[:4]) <= set(FIRST)
    assert set(nodes[4:]) <= set(SECOND)
    assert abs(forces.sum(axis=0)).max() < 1e-14
    assert abs(np.cross(crossing, forces).sum(axis=0)).max() < 1e-13
    # internal: the first is held back from the second
    assert forces[FIRST, 1].sum() == pytest.approx(force, rel=0.01)
    apart = crossing + np.where(np.arange(2 * NODES)[:, None] < NODES, 0, 1) * [0, 0.3, 0]
    assert touch(apart)[3] == 0


@pytest.mark.parametrize("edge", [FIRST, SECOND], ids=["first", "second"])
@pytest.mark.parametrize("side", [-1, 1])
def test_an_edge_that_ends_before_the_other_does_not_touch_it(edge, side, crossing):
    """Its nearest point is its end, about which the curves would go on through each other."""
    ended = crossing.copy()
    ended[edge] += side * 2.9 * np.array([1, 0, 0.3 if edge is FIRST else -0.3])
    forces, nodes, gap, force = touch(ended)
    assert (gap, force, nodes[0]) == (np.inf, 0.0, -1)
    assert not forces.any()


def test_tangent_of_edges_is_the_derivative_and_symmetric(crossing):
    n = len(crossing)
    nodes = touch(crossing)[1]
    values = np.zeros((n * n, 3, 3))
    touch(crossing, nodes[:, None] * n + nodes[None], values)
    K = dense(values, n)
    assert_allclose(K, K.T, atol=1e-12)
    direction = np.random.default_rng(1).standard_normal(crossing.shape)
    assert_tangent(K, lambda x: touch(x)[0], crossing, direction, 1e-4)


def test_sheared_weave_stiffens_and_its_work_is_its_moment(whole, s720):
    """Under some tension to 0.2 rad: the moment rises from 0, and with it the contact force."""
    record = periodic_cell.shear(whole, s720, 0.2, stretch=(4e-6, 4e-6), rows=4)
    assert record.failed == ""
    turned = record["gamma"] > 0
    assert abs(record["moment"][~turned]).max() < 1e-9
    assert np.all(np.diff(record["moment"][turned]) > 0)
    assert record["F_c"][-1] > record["F_c"][~turned][-1]
    assert record["tau"][-1] == pytest.approx(
        record["moment"][-1] / s720.weave.cell_area / s720.weave.thickness
    )


def test_shear_is_the_same_to_both_sides(model):
    """The weave sheared the other way is its mirror image: the moment changes its sign alone."""
    solver = Newton(model)
    found = []
    for sign in (1, -1):
        q = np.zeros(model.size)
        for share in np.linspace(0.1, 1, 6):
            load = CellLoad(model.w, (5e-6 * share, 5e-6 * share), sign * 0.05 * share)
            state = solver.solve(q, load)
            q = state.q
        found.append((model.moment(state.forces, load), *model.tensions(state.forces, load)))
    solver.close()
    assert found[0][0] == pytest.approx(-found[1][0], rel=1e-4)
    assert found[0][1:] == pytest.approx(found[1][1:], rel=1e-6)


@pytest.mark.slow
def test_four_sheared_crossovers_equal_one_with_glides(whole, four, s720):
    records = [
        periodic_cell.shear(mesh, s720, 0.1, stretch=(4e-6, 4e-6), rows=2) for mesh in (whole, four)
    ]
    for key in ("moment", "T1", "T2", "F_c"):
        assert records[1][key][-1] == pytest.approx(records[0][key][-1], rel=1e-6), key


@pytest.mark.slow
def test_shear_to_locking(s720):
    """S-720 slack: no stiffness worth the name at first, 50 times as much at 0.8 rad; neighbours meet on the way."""
    mesh = mesher.build(s720, size=(4, 3, 2), domain="whole")
    record = periodic_cell.shear(mesh, s720, 0.8)
    assert record.failed == "" or record["gamma"][-1] > 0.6
    slope = np.gradient(record["tau"], record["gamma"])
    assert slope[-1] > 50 * slope[1]
    assert record["F_side"][-1].min() > 0
    fit = shear_fit.fit(record["gamma"], record["tau"])
    assert 0.2 < fit.law.gamma1 < fit.law.gamma2
