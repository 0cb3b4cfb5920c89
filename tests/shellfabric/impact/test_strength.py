"""Strength by strain rate: the law and its limits."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics.base.errors import InputError
from fabrics.families.strain_rate import RateLaw
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane import failure_kernels

LAW = RateLaw((100.0, 1000.0, 10000.0), (1.0, 1.2, 1.6))


@pytest.fixture
def ready(fabric):
    """The fabric with a law of the strain rate."""
    return replace(fabric, strain_rate=LAW)


@pytest.fixture
def panel_of(tables, small):
    """A small panel of a fabric."""

    def make(fabric, **changes):
        table = tables["variational"]
        return small(
            table=replace(table, model=replace(table.model, fabric=fabric)),
            symmetry="whole",
            **changes,
        )

    return make


@pytest.mark.parametrize("elements", [1, 2])
@pytest.mark.parametrize("rate", [50.0, 400.0, 3000.0, 30000.0])
def test_pulled_at_a_steady_rate_a_yarn_fails_by_the_law(ready, panel_of, rate, elements):
    """Its strain at failure is that of the data sheet times the ratio at the rate, on every mesh."""
    panel = panel_of(ready, rate_dependence=True, elements_per_crossover=elements)
    state = panel.state(1.0)
    const = panel.constants()
    yarn = panel.weave.warp
    const.warp_lines.filter_factor[:] = 1.0  # no delay
    reached = 0.985 * yarn.failure_strain
    step = rate * const.dt
    while True:
        reached += step
        state.T[0][:] = yarn.EA * reached
        if failure_kernels.find_failures(const, state, 0, 6, 7):
            break
        assert reached < 2 * yarn.failure_strain
    expected = yarn.failure_strain * LAW.strength_at(rate)
    assert expected * 0.99 - step < reached < expected * 1.001 + step
    if rate >= LAW.rates[0]:
        assert reached > expected * 0.999 - step
    assert state.loads_at_failure / state.failed_segments == pytest.approx(
        reached / yarn.failure_strain
    )


def test_a_load_that_is_held_breaks_a_yarn_in_time(ready, panel_of):
    """Between the strengths at two rates, after what the law's damage per time says; ringing about it does not count
    twice."""
    panel = panel_of(ready, rate_dependence=True)
    state = panel.state(1.0)
    const = panel.constants()
    yarn = panel.weave.warp
    const.warp_lines.filter_factor[:] = 1.0  # no delay
    # where the strength is that at 316 1/s, and ln(rate) rises by ln(10) / 0.2
    steps = 0
    held = 1.1
    while True:
        state.T[0][:] = yarn.strength * (held + 0.02 * (-1) ** steps)
        if failure_kernels.find_failures(const, state, 0, 6, 7):
            break
        steps += 1
    growth = np.log(10.0) / 0.2
    rate = growth * 100.0 * np.exp(growth * 0.1) / yarn.failure_strain * np.cosh(0.02 * growth)
    assert (steps + 1) * const.dt == pytest.approx(1 / rate, abs=1.01 * const.dt)


@pytest.mark.parametrize("plies", [1, 2])
def test_a_shot_knows_at_which_strengths_its_yarns_have_failed(ready, shoot, plies):
    shot = shoot(
        200.0,
        fabric=ready,
        plies=plies,
        elements_per_crossover=1,
        symmetry="whole",
        rate_dependence=True,
    )
    assert shot.failures[:, 0].sum() >= shot.cut_yarns[-1] > 0
    count, ratio = shot.failures[0]
    assert 1.0 < ratio / count < 1.61


def test_a_faster_modulus_is_that_of_the_whole_run(ready):
    law = replace(LAW, modulus=(1.0, 1.1, 1.2))
    setup = ImpactSetup(replace(ready, strain_rate=law), 100.0, rate_dependence=True)
    model = setup.cell()
    assert model.fabric.weave.warp.E == pytest.approx(1.2 * setup.fabric.weave.warp.E)
    assert model.fabric.weave.warp.strength == pytest.approx(setup.fabric.weave.warp.strength)
    assert model.reach == 1.6
    assert replace(setup, rate_dependence=False).cell().fabric is setup.fabric


def test_without_data_it_is_refused(ready, panel_of):
    with pytest.raises(
        InputError, match="rate_dependence = True: must be false: fabric S-720 has no strain_rate"
    ):
        panel_of(replace(ready, strain_rate=None), rate_dependence=True)
