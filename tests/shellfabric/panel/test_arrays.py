"""Arrays of a panel at rest: sizes, masses, what edges hold, strengths, blocks."""

import numpy as np
import pytest
from conftest_tools import grid

from shellfabric.panel.model import Numerics

SYMMETRIES = ("quarter", "half", "whole")


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_masses_are_those_of_the_modelled_area(small, symmetry):
    panel = small(symmetry=symmetry)
    const, state = panel.constants(), panel.state(50.0)
    mass, corner = grid(const, state.mass), 0.25 * panel.weave.areal_density * const.dx * const.dy
    assert state.mass.sum() == pytest.approx(panel.weave.areal_density * const.ni * const.nj * const.dx * const.dy)
    sides = [2 * w * 24 for w in panel.weave.w]  # of 24 x 24 crossovers as a whole
    assert state.mass.sum() == pytest.approx(panel.weave.areal_density * sides[0] * sides[1] * panel.share)
    np.testing.assert_allclose(mass[1:-1, 1:-1], 4 * corner, rtol=1e-14)
    np.testing.assert_allclose(mass[[0, 0, -1, -1], [0, -1, 0, -1]], corner, rtol=1e-14)
    assert const.projectile_mass == pytest.approx(panel.projectile.mass * panel.share, rel=1e-14)
    assert const.free_dofs == (*(0.0 if mirrored else 1.0 for mirrored in panel.mirrors), 1.0)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
@pytest.mark.parametrize("edge", ["clamped", "free", ("clamped", "free")])
def test_held_nodes_have_no_inverse_mass(small, symmetry, edge):
    panel = small(symmetry=symmetry, edge=edge)
    const, state = panel.constants(), panel.state(50.0)
    free = np.ones((const.ni + 1, const.nj + 1), bool)
    warp, weft = edge if isinstance(edge, tuple) else (edge, edge)
    if warp == "clamped":
        free[-1] = False
        free[0] &= panel.mirrors[0]
    if weft == "clamped":
        free[:, -1] = False
        free[:, 0] &= panel.mirrors[1]
    inverse = grid(const, state.inverse_mass)
    np.testing.assert_allclose(inverse * grid(const, state.mass), free, rtol=0, atol=1e-15)
    assert not state.inverse_mass[(const.ni + 1) * const.row_stride :].any()  # beyond the panel there is nothing
    np.testing.assert_array_equal(state.dt_over_mass, const.dt * state.inverse_mass)


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_all_arrays_of_nodes_have_room_for_whole_vectors(small, symmetry):
    panel = small(symmetry=symmetry)
    const, state = panel.constants(), panel.state(50.0)
    assert const.row_stride == const.nj + 1
    assert (const.ni, const.nj) == panel.counts
    slots = (const.ni + 2) * const.row_stride + 16
    for name in ("u", "v", "f_int", "f_int_above", "stretch", "N", "yarn_length", "f_contact"):
        assert {part.size for part in getattr(state, name)} == {slots}, name
        assert all(part.ctypes.data % 64 == 0 for part in getattr(state, name)), name


@pytest.mark.parametrize("symmetry", SYMMETRIES)
def test_length_of_yarn_is_that_of_the_cloth(small, symmetry):
    """Yarns per metre times the area, of each family: the yarns on the rims and in planes of symmetry by half."""
    panel = small(symmetry=symmetry)
    const, state = panel.constants(), panel.state(50.0)
    area = const.ni * const.nj * const.dx * const.dy
    for count, length in zip((panel.weave.warp_count, panel.weave.weft_count), state.yarn_length):
        assert length.sum() == pytest.approx(count * area, rel=1e-12)
    warp, weft = (grid(const, length) for length in state.yarn_length)
    assert not warp[-1].any()
    assert not weft[:, -1].any()
    for length, whole in zip(state.yarn_length, state.intact_fraction):
        np.testing.assert_array_equal(whole, length != 0)
    for stretch in state.stretch:
        np.testing.assert_array_equal(stretch, 1.0)


def test_strength_of_each_yarn(small):
    panel = small()
    rng = np.random.default_rng(3)
    factors = tuple(rng.uniform(0.7, 1.3, count) for count in panel.yarn_counts)
    const = small(strength_factors=factors).constants()
    found = zip((const.yarn_strengths1, const.yarn_strengths2), (const.min_strength1, const.min_strength2))
    for (each, least), factor, yarn in zip(found, factors, panel.weave.yarns):
        np.testing.assert_allclose(each, factor * yarn.strength, rtol=1e-15)
        assert least == each.min()
    alike = panel.constants()
    for each, count, yarn in zip((alike.yarn_strengths1, alike.yarn_strengths2), panel.yarn_counts, panel.weave.yarns):
        np.testing.assert_array_equal(each, np.full(count, yarn.strength))
    never = small(failure=False).constants()
    assert np.isposinf(never.yarn_strengths1).all()
    assert np.isposinf(never.yarn_strengths2).all()


@pytest.mark.parametrize("block", [1, 150, 300, 2000])
@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
def test_blocks_cover_all_rows_once(small, symmetry, block):
    panel = small(symmetry=symmetry, numerics=Numerics(block=block))
    const, state, work = panel.constants(), panel.state(50.0), panel.work()
    blocks, rows = state.block_damage.size, const.rows_per_block
    last = const.ni - (blocks - 1) * rows
    assert 1 <= last <= rows  # all are of one size but the last, which is not empty
    assert rows >= min(6, const.ni)
    for name in ("tension_stale", "block_max_tension", "energy_sums"):
        assert len(getattr(state, name)) == blocks, name
    assert work.A[0].size == (rows + 4) * const.row_stride + 16  # of a block and two rows at either side of it


def test_scratch_shares_room_only_where_it_is_free_again(small):
    work = small().work()
    for late, early in (
        (work.T1, work.dW_own1),
        (work.T2, work.dW_own2),
        (work.f_over_stretch1, work.dW_crossing1),
        (work.f_over_stretch2, work.dW_crossing2),
    ):
        assert late is early
    apart = [*work.A, *work.B, work.stretch1, work.stretch2, work.dW_own1, work.dW_own2, work.dW_crossing1]
    for n, one in enumerate(apart):
        assert not any(np.shares_memory(one, other) for other in apart[:n])
