"""Strength by strain rate and by bending over the nose: the laws, their limits, energy, restart."""

from dataclasses import replace

import numpy as np
import pytest
from conftest_tools import Interrupted, Interrupting

from fabrics import assumed
from fabrics.errors import InputError
from fabrics.families.strain_rate import RateLaw
from shellfabric.cloth import failure_kernels
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.projectile import curvature_kernels
from shellfabric.projectile.projectile import Projectile

LAW = RateLaw((100.0, 1000.0, 10000.0), (1.0, 1.2, 1.6))
BOTH = {"rate_dependence": True, "nose_bending": True}
FIBRE = 12e-6


@pytest.fixture
def ready(fabric):
    """The fabric with a law of the strain rate and a diameter of its fibres."""
    return replace(fabric, strain_rate=LAW, fibre_diameter=FIBRE)


@pytest.fixture
def panel_of(tables, small):
    """A small panel of a fabric."""

    def make(fabric, **changes):
        table = tables["variational"]
        return small(table=replace(table, model=replace(table.model, fabric=fabric)), symmetry="whole", **changes)

    return make


@pytest.mark.parametrize("elements", [1, 2])
@pytest.mark.parametrize("rate", [50.0, 400.0, 3000.0, 30000.0])
def test_pulled_at_a_steady_rate_a_yarn_fails_by_the_law(ready, panel_of, rate, elements):
    """Its strain at failure is that of the data sheet times the ratio at the rate, on every mesh."""
    panel = panel_of(ready, rate_dependence=True, elements_per_crossover=elements)
    state, const, yarn = panel.state(1.0), panel.constants(), panel.weave.warp
    reached, step = 0.985 * yarn.failure_strain, rate * const.dt
    while True:
        reached += step
        state.T[0][:] = yarn.EA * reached
        if failure_kernels.detect_failures(const, state, 0, 6, 7):
            break
        assert reached < 2 * yarn.failure_strain
    expected = yarn.failure_strain * LAW.strength_at(rate)
    assert expected * 0.99 - step < reached < expected * 1.001 + step
    if rate >= LAW.rates[0]:
        assert reached > expected * 0.999 - step
    count, tensions, _ = state.failure_sums
    assert tensions / count == pytest.approx(reached / yarn.failure_strain)


def test_a_load_that_is_held_breaks_a_yarn_in_time(ready, panel_of):
    """Between the strengths at two rates, after what the law's damage per time says; ringing about it does not count
    twice."""
    panel = panel_of(ready, rate_dependence=True)
    state, const, yarn = panel.state(1.0), panel.constants(), panel.weave.warp
    steps, held = 0, 1.1  # where the strength is that at 316 1/s, and ln(rate) rises by ln(10) / 0.2
    while True:
        state.T[0][:] = yarn.strength * (held + 0.02 * (-1) ** steps)
        if failure_kernels.detect_failures(const, state, 0, 6, 7):
            break
        steps += 1
    growth = np.log(10.0) / 0.2
    rate = growth * 100.0 * np.exp(growth * 0.1) / yarn.failure_strain * np.cosh(0.02 * growth)
    assert (steps + 1) * const.dt == pytest.approx(1 / rate, abs=1.01 * const.dt)


SQRT = 0.5**0.5
PLACES = [  # where, of a flat nose of radius 2.75 mm and rim 0.3 mm; direction, radius of curvature
    ((1e-3, 0.0, 0.0), (1.0, 0.0, 0.0), np.inf),
    ((2.45e-3 + 0.3e-3 * SQRT, 0.0, -0.3e-3 * (1 - SQRT)), (SQRT, 0.0, -SQRT), 0.3e-3),
    ((2.45e-3 + 0.3e-3 * SQRT, 0.0, -0.3e-3 * (1 - SQRT)), (1.0, 0.0, 0.0), 0.3e-3),  # turned into the surface
    ((2.75e-3, 0.0, -2e-3), (0.0, 1.0, 0.0), 2.75e-3),
    ((2.75e-3, 0.0, -2e-3), (0.0, 0.0, 1.0), np.inf),
]


@pytest.mark.parametrize(("place", "along", "radius"), PLACES)
@pytest.mark.parametrize("depth", [0.0, -0.02e-3])
def test_the_nose_bends_a_yarn_by_its_curvature_along_it(ready, panel_of, place, along, radius, depth):
    """Whatever the depth at which a point lies below the surface."""
    const = panel_of(ready, nose_bending=True).constants()
    normal = panel_of(ready).projectile.distance(np.array(place) * (1 - 1e-6))[1]
    point = tuple(np.array(place) + depth * normal)
    found = curvature_kernels.nose_curvature(const, depth, point, tuple(normal), along)
    assert found == pytest.approx(1 / radius, rel=1e-4, abs=1e-6)


def test_a_ball_bends_alike_everywhere(ready, panel_of):
    const = panel_of(ready, nose_bending=True, projectile=Projectile(shape="sphere")).constants()
    x = 2.75e-3 * np.array([0.6, 0.0, -0.2])
    found = curvature_kernels.nose_curvature(const, 0.0, tuple(x), (0.6, 0.0, 0.8), (0.3, 0.8, 0.1))
    assert found == pytest.approx(1 / 2.75e-3, rel=1e-6)


@pytest.mark.parametrize("radius", [2e-6, 20e-6, 0.2e-3, 3.8e-3, 1e3])
def test_strain_of_bending(radius):
    """That of a fibre whose axis lies half its diameter above the surface; none on a flat one, below 1 on any edge."""
    found = curvature_kernels.fibre_bending(FIBRE, 1 / radius)
    assert found == pytest.approx((radius + FIBRE) / (radius + FIBRE / 2) - 1, rel=1e-9, abs=1e-16)
    assert curvature_kernels.fibre_bending(FIBRE, 0.0) == 0.0


@pytest.mark.parametrize("elements", [1, 2, 3])
def test_a_segment_takes_the_bending_of_its_own_lines(ready, panel_of, elements):
    """A yarn fails at the failure strain less the strain of bending, and its neighbours do not."""
    panel = panel_of(ready, nose_bending=True, elements_per_crossover=elements)
    state, const, yarn = panel.state(1.0), panel.constants(), panel.weave.warp
    state.active_rows[:] = 0, const.ni
    line, bent = 12 * elements, 0.01
    state.bending_strain[0][12 * elements * const.row_stride + line] = bent
    state.T[0][:] = yarn.EA * (yarn.failure_strain - bent) * (1 - 1e-9)
    assert failure_kernels.detect_failures(const, state, 0, 0, const.ni) == 0
    state.T[0][:] *= 1 + 2e-9
    assert failure_kernels.detect_failures(const, state, 0, 0, const.ni) == 1
    assert state.failed[0][12 * elements * const.row_stride + line] == 1
    assert state.failure_sums[2] == bent
    assert const.min_strength1 == pytest.approx(yarn.EA * (yarn.failure_strain - FIBRE / (2 * 0.3e-3 + FIBRE)))


QUICK = {"opening": 0.0508, "table_size": 101, "end_time": 60e-6}


def shoot(fabric, velocity=200.0, hooks=(), resume=None, **changes):
    return run(ImpactSetup(fabric, velocity, **{**QUICK, **changes}), hooks=hooks, resume=resume)


def test_laws_without_effect_change_no_digit(fabric):
    """A strength that is the same at all rates, and fibres without thickness, are as neither."""
    plain = shoot(fabric)
    idle = shoot(replace(fabric, strain_rate=RateLaw((1.0, 1e3), (1.0, 1.0)), fibre_diameter=1e-300), **BOTH)
    assert plain.failed_segments[-1] > 0
    np.testing.assert_array_equal(idle.v, plain.v)
    for name, energy in plain.energies.items():
        np.testing.assert_array_equal(idle.energies[name], energy)
    np.testing.assert_array_equal(idle.peaks, plain.peaks)


@pytest.mark.parametrize("plies", [1, 2])
def test_both_in_one_shot(ready, tmp_path, plies):
    """Energy is kept while yarns fail at raised and lowered strengths, and a resumed run is the same bit for bit."""
    made = {"plies": plies, "elements_per_crossover": 1, "symmetry": "whole", **BOTH}
    whole = shoot(ready, **made)
    assert whole.energy_error_max < 2e-3
    assert whole.failures[:, 0].sum() == whole.failed_segments[-1] > 0
    count, ratio, bent = whole.failures[0]
    assert 0.005 < bent / count < FIBRE / (2 * 0.3e-3 + FIBRE) * 1.000001
    assert ratio / count < 1.6 - bent / count / whole.panel.weave.warp.failure_strain + 0.01
    file = tmp_path / "checkpoint.h5"
    with pytest.raises(Interrupted):
        shoot(ready, hooks=[Interrupting(file, 4e-6, 12e-6)], **made)
    again = shoot(ready, resume=file, **made)
    np.testing.assert_array_equal(again.v, whole.v)
    np.testing.assert_array_equal(again.failures, whole.failures)


def test_a_faster_modulus_is_that_of_the_whole_run(ready):
    law = replace(LAW, modulus=(1.0, 1.1, 1.2))
    setup = ImpactSetup(replace(ready, strain_rate=law), 100.0, rate_dependence=True)
    model = setup.cell()
    assert model.fabric.weave.warp.E == pytest.approx(1.2 * setup.fabric.weave.warp.E)
    assert model.fabric.weave.warp.strength == pytest.approx(setup.fabric.weave.warp.strength)
    assert model.reach == 1.6
    assert replace(setup, rate_dependence=False).cell().fabric is setup.fabric


@pytest.mark.parametrize(
    ("key", "data", "changes", "said"),
    [
        (
            "rate_dependence",
            "strain_rate",
            {"strain_rate": None},
            "rate_dependence = True: must be false: fabric S-720",
        ),
        (
            "nose_bending",
            "fibre_diameter",
            {"fibre_diameter": None},
            "nose_bending = True: must be false: fabric S-720",
        ),
    ],
)
def test_without_data_it_is_refused(ready, panel_of, key, data, changes, said):
    with pytest.raises(InputError, match=f"{said} has no {data}"):
        panel_of(replace(ready, **changes), **{key: True})
    with pytest.raises(InputError, match=f"{key} = True: must be false where yarns do not fail"):
        panel_of(ready, failure=False, **{key: True})
    assert getattr(assumed.with_fibre_diameter(assumed.with_strain_rate(panel_of(ready).fabric)), data) is not None
