"""Response surfaces: interpolation of known order, lines independent of their route, interruption, refinement."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from equations import end_forces
from numpy.testing import assert_allclose, assert_array_equal

from fabrics.surface import ResponseSurface
from unitcell3d.identify.interpolant import QUANTITIES, Interpolant, errors
from unitcell3d.identify.response_surface import sample

TINY = (4, 3, 2)
END = 12e-6
SMALL = {"d1": (0.0, END), "d2": (0.0, END), "points": (5, 5), "size": TINY}
FORCES = ("T1", "T2", "F_c")


def analytic(function, n):
    d = np.linspace(0, 30e-6, n)
    values = function(*np.meshgrid(d / 30e-6, d / 30e-6, indexing="ij"))
    return ResponseSurface(d, d, *(values for _ in QUANTITIES))


def test_bicubic_surfaces_are_met_exactly():
    surface = analytic(lambda x, y: 1 + x**3 * y**2 - 2 * x * y**3, 7)
    x, y = np.random.default_rng(0).uniform(0, 1, (2, 50))
    ours = Interpolant(surface)("T1", 30e-6 * x, 30e-6 * y)
    assert_allclose(ours, 1 + x**3 * y**2 - 2 * x * y**3, atol=1e-12)
    assert errors(surface)["T1"].largest < 1e-12


def test_error_is_of_fourth_order_and_the_estimate_bounds_it():
    def function(x, y):
        return np.exp(x) * np.cos(2 * y)

    x, y = np.random.default_rng(0).uniform(0, 1, (2, 400))
    true = []
    estimates = []
    for n in (11, 21, 41):
        surface = analytic(function, n)
        true.append(abs(Interpolant(surface)("F_c", 30e-6 * x, 30e-6 * y) - function(x, y)).max())
        estimates.append(errors(surface)["F_c"].largest)
    assert np.all(np.log2(np.array(true[:-1]) / true[1:]) > 3.3)
    # left out, a line makes the spacing twice as wide there
    assert all(miss < estimate < 100 * miss for estimate, miss in zip(estimates, true))


@pytest.fixture(scope="module")
def pool():
    with ThreadPoolExecutor(1) as pool:
        yield pool


@pytest.fixture(scope="module")
def whole(s720, pool):
    return sample(s720, **SMALL, executor=pool)


def corner(surface):
    return [getattr(surface, name)[-1, -1] for name in FORCES]


def test_rows_end_where_other_routes_end(whole, s720, tiny):
    """Stem and row against the diagonal, and back from beyond."""
    goal = (END, END)
    beyond = (20e-6, 16e-6)
    for route in ([goal], [goal, beyond, goal]):
        assert end_forces(tiny, s720, route, step=1.2e-6) == pytest.approx(
            corner(whole.surface), rel=1e-5
        )


def test_surface_rises_from_rest(whole):
    surface = whole.surface
    assert abs(surface.T1[0, 0]) < 1e-2
    assert np.all(np.diff(surface.T1[:, 1:], axis=0) > 0)
    assert np.all(np.diff(surface.T2[1:], axis=1) > 0)
    assert np.all(np.diff(surface.h1, axis=0) < 0)
    assert str(TINY) in surface.provenance
    assert surface.fabric == "S-720"


def test_interrupted_and_resumed_is_the_same_to_the_last_bit(whole, s720, pool, tmp_path):
    kept = {"executor": pool, "folder": tmp_path / "runs"}
    resumed_at = []

    def stop_at_half(share):
        if share >= 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sample(s720, **SMALL, **kept, on_progress=stop_at_half)
    assert len(list(kept["folder"].iterdir())) == 3
    resumed = sample(s720, **SMALL, **kept, resume=True, on_progress=resumed_at.append)
    assert resumed_at == pytest.approx([1 / 6, 1 / 2, 2 / 3, 5 / 6, 1])
    for name in QUANTITIES:
        assert np.array_equal(getattr(resumed.surface, name), getattr(whole.surface, name)), name


@pytest.mark.slow
def test_processes_give_the_same(whole, s720):
    """Any number of them to the last bit; this process, which may have more BLAS threads, to rounding."""
    one, two = (sample(s720, **SMALL, jobs=n).surface for n in (1, 2))
    for name in QUANTITIES:
        assert np.array_equal(getattr(one, name), getattr(two, name)), name
        assert np.allclose(
            getattr(one, name), getattr(whole.surface, name), rtol=1e-5, atol=1e-5
        ), name


def test_lines_are_added_where_contact_sets_in(whole, s720, pool):
    """Missed lines lie at small displacements: there the grid becomes dense, and what is missed smaller."""
    finer = sample(s720, **SMALL, tolerance=6.5e-3, executor=pool)
    d1 = finer.surface.d1
    d2 = finer.surface.d2
    coarse = whole.surface.d1
    assert min(d1.size, d2.size) > 5
    assert d1[1] - d1[0] < d1[-1] - d1[-2]
    misses = [
        max(found.errors[name].largest / getattr(found.surface, name).max() for name in FORCES)
        for found in (finer, whole)
    ]
    assert misses[0] < 6.5e-3 < misses[1]
    # what both grids hold, they hold alike
    assert set(coarse) <= set(d1) & set(d2)
    i = np.searchsorted(d1, coarse)
    j = np.searchsorted(d2, coarse)
    assert_array_equal(finer.surface.T1[np.ix_(i, j)], whole.surface.T1)


def test_a_slack_corner_has_no_contact(s720, pool):
    """Ends pushed together: the yarns lose each other, and the surface goes on through it."""
    found = sample(
        s720, d1=(-2e-6, 6e-6), d2=(-2e-6, 6e-6), points=(5, 5), size=TINY, executor=pool
    )
    assert found.surface.F_c[0, 0] < 1e-2
    assert abs(found.surface.T1[0, 0]) < 5e-2
    assert found.surface.F_c[-1, -1] > 1


def test_friction_is_taken_over_from_line_to_line(whole, s720, tiny, pool):
    """A corner of the surface is the end of one run that stretches the weft first and then the warp."""
    found = sample(s720, **SMALL, friction=0.3, executor=pool).surface
    assert 1.01 < found.F_c[-1, -1] / whole.surface.F_c[-1, -1] < 1.15
    assert "friction 0.3" in found.provenance
    run = end_forces(tiny, s720, [(0.0, END), (END, END)], friction=0.3, step=3e-6)
    assert run == pytest.approx(corner(found), rel=1e-5)
