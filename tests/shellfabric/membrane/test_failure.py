"""The failure criterion: mean over a length, low-pass over its time, each line by itself."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import grid
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from panels import make_panel

from shellfabric.membrane import failure, failure_kernels

STEPS = 4000


def hat_mean(x, values, whole, place, length, mirrored):
    """Mean of what is constant about each line, by a sum over many small steps; broken lines left out."""
    y = np.linspace(place - length, place + length, STEPS + 1)
    y = 0.5 * (y[1:] + y[:-1])
    y = y[(y <= x[-1]) & (mirrored | (y >= x[0]))]
    line = np.searchsorted(0.5 * (x[1:] + x[:-1]), abs(y))  # the plane of symmetry is at 0
    weight = whole[line] * (1 - abs(y - place) / length)
    return (weight * values[line]).sum() / weight.sum()


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(st.floats(0.2, 3.0), min_size=4, max_size=30),
    st.floats(0.1, 5.0),
    st.booleans(),
    st.randoms(),
)
def test_means_are_integrals_of_the_hat(sides, length, mirrored, random):
    """On any grid and for any length, not only whole numbers of elements, with broken lines and a plane of symmetry."""
    x = np.insert(np.cumsum(sides), 0, 0.0)
    first, weights = failure.mean_weights(x, length, mirrored)
    values = np.array([random.uniform(0, 1) for _ in x])
    whole = np.array([random.random() < 0.8 for _ in x])
    line = random.randrange(x.size)
    whole[line] = True
    near = first[line] + np.arange(weights.shape[1])
    part = weights[line] * whole[near]
    expected = hat_mean(x, values, whole, x[line], length, mirrored)
    assert part @ values[near] / part.sum() == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("mirrored", [False, True])
def test_weights_add_up_to_one_within_the_grid(mirrored):
    x = np.linspace(0.0, 10.0, 41)
    first, weights = failure.mean_weights(x, 1.3, mirrored)
    inner = (x <= 8.6) & (mirrored | (x >= 1.4))
    assert_allclose(weights.sum(axis=1)[inner], 1.0, rtol=1e-12)
    assert np.all((first >= 0) & (first + weights.shape[1] <= x.size))


def test_a_length_below_half_an_element_leaves_the_line_alone():
    first, weights = failure.mean_weights(np.arange(5.0), 0.5, True)
    assert weights.shape[1] == 1
    assert_allclose(weights[:, 0], [1.0, 1.0, 1.0, 1.0, 0.5])
    assert_array_equal(first, np.arange(5))


def prepared(**changes):
    """A panel, its state and its constants."""
    panel = make_panel(**changes)
    return panel, panel.state(1.0), panel.constants()


def step(state, const, family=0):
    """One step of the criterion over the whole panel; how many edges break."""
    count = failure_kernels.find_failures(const, state, family, 0, const.ni + family)
    failure_kernels.break_edges(const, state, family, 0, const.ni)
    return count


@pytest.mark.parametrize("elements", [1, 3])
@pytest.mark.parametrize("family", [0, 1])
def test_a_tension_that_is_held_breaks_yarns_after_its_time(elements, family):
    """dF/dt = (M - F) / t_f from half of the strength on: held at 1.2 of it, after t_f ln(0.7 / 0.2)."""
    panel, state, const = prepared(elements_per_crossover=elements)
    weave = panel.weave
    yarn = weave.yarns[family]
    count = (weave.warp_count, weave.weft_count)[family]
    speed = (yarn.EA * count / weave.areal_density) ** 0.5
    time = 2 * max(panel.fabric.failure_length, panel.spacing[family]) / speed
    state.T[family][:] = 1.2 * yarn.strength
    steps = 1
    while step(state, const, family) == 0:
        steps += 1
        assert steps < 1000
    assert steps * const.dt == pytest.approx(time * np.log(0.7 / 0.2), abs=1.01 * const.dt)
    assert state.peak_tension[family] > yarn.strength


def test_what_is_below_half_of_the_strength_is_not_followed():
    """F stays where it is, and no row is looked at again; a tension that falls is followed back to it."""
    panel, state, const = prepared()
    strength = panel.weave.warp.strength
    before = state.filtered_tension[0].copy()
    state.T[0][:] = 0.49 * strength
    assert step(state, const) == 0
    assert_array_equal(state.filtered_tension[0], before)
    assert not state.warm_rows.any()
    assert state.peak_tension[0] == pytest.approx(0.49 * strength)
    state.T[0][:] = 0.9 * strength
    step(state, const)
    assert state.warm_rows[0, : const.ni].all()
    state.T[0][:] = 0.0
    for _ in range(200):
        step(state, const)
    assert not state.warm_rows.any()
    assert_array_equal(state.filtered_tension[0], before)


def test_each_line_breaks_by_itself_and_a_hole_does_not_shield_its_rim():
    """One line past the strength breaks alone; the mean beside it leaves it out."""
    panel, state, const = prepared(elements_per_crossover=4, symmetry="whole", boundary="free")
    strength = panel.weave.warp.strength
    row, middle = (count // 2 for count in panel.counts)
    T = grid(const, state.T[0])
    intact = grid(const, state.intact_fraction[0])
    T[row, middle] = 3.0 * strength
    T[row, middle - 1 : middle + 2 : 2] = 0.9 * strength
    for _ in range(200):
        step(state, const)
    expected = np.ones_like(intact)
    expected[:, -1] = intact[:, -1]
    assert intact[row, middle] == 0.0
    assert intact[row, middle - 2 : middle + 3].sum() == 4.0
    assert grid(const, state.yarn_length[0])[row, middle] == 0.0
    lines = const.warp_lines
    at = middle + 1
    part = lines.weights[at] * (np.arange(lines.weights.shape[1]) + lines.first[at] != middle)
    near = slice(lines.first[at], lines.first[at] + part.size)
    expected = part @ T[row, near] / part.sum()
    assert failure_kernels.mean_tension(const, state, 0, row, at) == pytest.approx(
        expected, rel=1e-12
    )
    assert expected > 0.5 * 0.9 * strength


def test_all_edges_are_judged_before_one_is_removed():
    """What breaks in a step does not depend on the order of lines: all of a block at once."""
    panel, state, const = prepared(elements_per_crossover=2, boundary="free")
    state.T[1][:] = 1e3 * panel.weave.weft.strength
    assert step(state, const, 1) == (const.ni + 1) * const.nj
    assert not state.intact_fraction[1].any()


def test_the_length_is_the_fabrics():
    panel = make_panel()
    fabric = replace(panel.fabric, failure_length=2e-3)
    table = replace(panel.table, model=replace(panel.table.model, fabric=fabric))
    wide = replace(panel, table=table).constants().warp_lines
    assert wide.weights.shape[1] > panel.constants().warp_lines.weights.shape[1]
