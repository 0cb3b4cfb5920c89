"""Response surfaces: interpolation of known order, lines independent of their route, interruption, refinement."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from fabrics import run_cache
from fabrics.errors import InputError
from fabrics.surface import ResponseSurface
from unitcell3d.identify import interpolant
from unitcell3d.identify.interpolant import QUANTITIES, Interpolant, errors
from unitcell3d.identify.response_surface import sample
from unitcell3d.identify.surface_cache import Line, Partial
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import continue_to, rest_state
from unitcell3d.solver.newton import Newton

TINY = (4, 3, 2)
THIS = run_cache.stamp("this", "unitcell3d.identify.surface_cache")
SMALL = {"d1": (0.0, 12e-6), "d2": (0.0, 12e-6), "points": (5, 5), "size": TINY}


def _analytic(function, n):
    d = np.linspace(0, 30e-6, n)
    values = function(*np.meshgrid(d / 30e-6, d / 30e-6, indexing="ij"))
    return ResponseSurface(d, d, *(values for _ in QUANTITIES))


def test_bicubic_surfaces_are_met_exactly():
    surface = _analytic(lambda x, y: 1 + x**3 * y**2 - 2 * x * y**3, 7)
    x, y = np.random.default_rng(0).uniform(0, 1, (2, 50))
    ours = Interpolant(surface)("T1", 30e-6 * x, 30e-6 * y)
    assert np.allclose(ours, 1 + x**3 * y**2 - 2 * x * y**3, atol=1e-12)
    slope = Interpolant(surface)("T1", 30e-6 * x, 30e-6 * y, dd1=1) * 30e-6
    assert np.allclose(slope, 3 * x**2 * y**2 - 2 * y**3, atol=1e-10)
    assert errors(surface)["T1"].largest < 1e-12


def test_error_is_of_fourth_order_and_the_estimate_bounds_it():
    def function(x, y):
        return np.exp(x) * np.cos(2 * y)

    x, y = np.random.default_rng(0).uniform(0, 1, (2, 400))
    true, estimates = [], []
    for n in (11, 21, 41):
        surface = _analytic(function, n)
        true.append(np.abs(Interpolant(surface)("F_c", 30e-6 * x, 30e-6 * y) - function(x, y)).max())
        estimates.append(errors(surface)["F_c"].largest)
    orders = np.log2(np.array(true[:-1]) / true[1:])
    assert np.all(orders > 3.3)
    assert all(estimate > miss for estimate, miss in zip(estimates, true))
    # left out, a line makes the spacing twice as wide there
    assert all(estimate < 100 * miss for estimate, miss in zip(estimates, true))


@pytest.fixture(scope="module")
def pool():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture(scope="module")
def whole(s720, pool):
    return sample(s720, **SMALL, executor=pool)


def test_rows_end_where_other_routes_end(whole, s720, tiny):
    """Path independence to 1e-5: stem and row against the diagonal, and back from beyond."""
    T1, T2, F_c = (getattr(whole.surface, name)[-1, -1] for name in ("T1", "T2", "F_c"))
    model = CrossoverModel(tiny, s720)
    solver = Newton(model)
    goal, beyond = Load((12e-6, 12e-6)), Load((20e-6, 16e-6))
    shares = np.linspace(0, 1, 11)
    q = solver.solve(np.zeros(model.size), Load()).q
    for start, end in ((Load(), goal), (goal, beyond), (beyond, goal)):
        found = [state for _, state in continue_to(model, solver, q, start, end, shares)][-1]
        q = found.q
        if end is goal:
            assert [*model.tensions(found.forces), 4 * found.contact] == pytest.approx([T1, T2, F_c], rel=1e-5)
    solver.close()


def test_surface_rises_from_rest(whole):
    surface = whole.surface
    assert abs(surface.T1[0, 0]) < 1e-2
    assert np.all(np.diff(surface.T1[:, 1:], axis=0) > 0)
    assert np.all(np.diff(surface.T2[1:], axis=1) > 0)
    assert np.all(np.diff(surface.h1, axis=0) < 0)
    assert str(TINY) in surface.provenance
    assert surface.fabric == "S-720"


class _Interrupt(BaseException):
    pass


def test_interrupted_and_resumed_is_the_same_to_the_last_bit(whole, s720, pool, tmp_path):
    kept = tmp_path / "partial.h5"
    done = []

    def stop_after_three(share, text):
        done.append(text)
        if len(done) == 3:
            raise _Interrupt

    with pytest.raises(_Interrupt):
        sample(s720, **SMALL, executor=pool, partial=kept, on_progress=stop_after_three)
    again = []
    resumed = sample(
        s720,
        **SMALL,
        executor=pool,
        partial=kept,
        resume=True,
        on_progress=lambda share, text: again.append((share, text)),
    )
    assert len(again) == 3
    assert again[-1][0] == 1
    assert not set(done) & {text for _, text in again}
    for name in QUANTITIES:
        assert np.array_equal(getattr(resumed.surface, name), getattr(whole.surface, name)), name
    with pytest.raises(InputError, match="another surface"):
        sample(s720, **(SMALL | {"points": (6, 5)}), executor=pool, partial=kept, resume=True)


@pytest.mark.slow
def test_processes_give_the_same(whole, s720):
    """Any number of them to the last bit; this process, which may have more BLAS threads, to rounding."""
    one, two = (sample(s720, **SMALL, jobs=n).surface for n in (1, 2))
    for name in QUANTITIES:
        assert np.array_equal(getattr(one, name), getattr(two, name)), name
        assert np.allclose(getattr(one, name), getattr(whole.surface, name), rtol=1e-5, atol=1e-5), name


def test_lines_are_added_where_contact_sets_in(whole, s720, pool):
    """Missed lines lie at small displacements: there the grid becomes dense, and what is missed smaller."""
    finer = sample(s720, **SMALL, tolerance=2e-3, executor=pool)
    d1 = finer.surface.d1
    assert d1.size > 5
    spacing = np.diff(d1)
    assert spacing[0] < spacing[-1]
    assert set(SMALL_D) <= set(d1)
    worst = max(finer.errors[name].largest / getattr(finer.surface, name).max() for name in ("T1", "T2", "F_c"))
    assert worst < max(whole.errors[name].largest / getattr(whole.surface, name).max() for name in ("T1", "T2", "F_c"))
    # what both grids hold, they hold alike
    i, j = np.searchsorted(d1, SMALL_D), np.searchsorted(finer.surface.d2, SMALL_D)
    assert np.array_equal(finer.surface.T1[np.ix_(i, j)], whole.surface.T1)


SMALL_D = np.linspace(0, 12e-6, 5)


def test_a_slack_corner_has_no_contact(s720, pool):
    """Ends pushed together: the yarns lose each other, and the surface goes on through it."""
    found = sample(s720, d1=(-2e-6, 6e-6), d2=(-2e-6, 6e-6), points=(5, 5), size=TINY, executor=pool)
    assert found.surface.F_c[0, 0] < 1e-2
    assert abs(found.surface.T1[0, 0]) < 5e-2
    assert found.surface.F_c[-1, -1] > 1


def test_friction_is_taken_over_from_line_to_line(whole, s720, tiny, pool):
    """A corner of the surface is the end of one run that stretches the weft first and then the warp."""
    found = sample(s720, **SMALL, friction=0.3, executor=pool).surface
    assert 1.01 < found.F_c[-1, -1] / whole.surface.F_c[-1, -1] < 1.15
    assert "friction 0.3" in found.provenance
    model = CrossoverModel(tiny, s720, Numerics(friction=0.3))
    solver = Newton(model)
    corner, goal = Load((0.0, 12e-6)), Load((12e-6, 12e-6))
    q = rest_state(model, solver, Load()).q
    model.commit(q, Load())
    for start, end in ((Load(), corner), (corner, goal)):
        for share, state in continue_to(model, solver, q, start, end, np.linspace(0, 1, 5)):
            q = state.q
            model.commit(q, start.towards(end, share))
    solver.close()
    assert [*model.tensions(state.forces), 4 * state.contact] == pytest.approx(
        [found.T1[-1, -1], found.T2[-1, -1], found.F_c[-1, -1]], rel=1e-5
    )
    with pytest.raises(InputError, match="friction"):
        sample(s720, **SMALL, friction=0.3, tolerance=1e-2, executor=pool)


def test_partial_file_keeps_lines(tmp_path):
    line = Line(0, 1e-6, np.arange(3.0), np.ones((3, 5)), np.empty((0, 0)), np.empty((0, 0)), 1.5, 7)
    Partial(tmp_path / "p.h5", THIS, False).add("a line", line)
    again = Partial(tmp_path / "p.h5", THIS, True).lines["a line"]
    assert np.array_equal(again.values, line.values)
    assert again.iterations == 7
    assert Partial(tmp_path / "p.h5", THIS, False).lines == {}
    (tmp_path / "q.h5").write_text("no")
    with pytest.raises(InputError, match=r"q\.h5"):
        Partial(tmp_path / "q.h5", THIS, True)


def test_bad_input_is_one_line(s720, whole):
    for choices, word in (
        ({"d1": (1e-6, 1e-6)}, "d1"),
        ({"points": (3, 5)}, "points"),
        ({"points": (5, 500)}, "points"),
        ({"tolerance": 0.0}, "tolerance"),
        ({"jobs": 0}, "jobs"),
    ):
        with pytest.raises(InputError, match=word) as caught:
            sample(s720, **(SMALL | choices))
        assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="d2"):
        Interpolant(whole.surface)("T1", 1e-6, 1.0)
    few = ResponseSurface(*(np.arange(n) * 1e-6 for n in (4, 5)), *(np.zeros((4, 5)) for _ in QUANTITIES))
    with pytest.raises(InputError, match="d1"):
        interpolant.errors(few)
