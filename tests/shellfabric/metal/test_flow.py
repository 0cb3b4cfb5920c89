"""The plastic flow of metals: Johnson and Cook's flow stress, and the return to it."""

from math import log

import pytest

from fabrics.metals import Metal
from shellfabric import flow_kernels
from shellfabric.metal.body import law_of

METAL = Metal(
    8900.0,
    124e9,
    0.34,
    yield_stress=9e7,
    hardening=2.9e8,
    hardening_exponent=0.31,
    rate_coefficient=0.025,
    reference_rate=2.0,
    softening_exponent=1.09,
    melting_temperature=1356.0,
    specific_heat=383.0,
)
LAW = law_of(METAL)


def stress(alpha, rate, heat):
    """Compute Johnson and Cook's flow stress of METAL, term by term."""
    hard = METAL.yield_stress + METAL.hardening * alpha**METAL.hardening_exponent
    fast = 1 + METAL.rate_coefficient * log(1 + rate / METAL.reference_rate)
    return hard * fast * (1 - (heat / METAL.melting_work) ** METAL.softening_exponent)


def test_the_flow_stress_is_that_of_johnson_and_cook():
    found = flow_kernels.metal_flow_stress(LAW, 0.3, 5000.0, 3e8)
    assert found == pytest.approx(stress(0.3, 5000.0, 3e8), rel=1e-12)
    molten = flow_kernels.metal_flow_stress(LAW, 0.3, 0.0, 9e9)
    assert 0 < molten < 1e-2 * stress(0.3, 0.0, 0.0)


@pytest.mark.parametrize("alpha", [0.0, 1e-6, 0.2, 3.0])
@pytest.mark.parametrize("over", [1.0001, 1.1, 5.0])
def test_the_return_solves_its_equation(alpha, over):
    dt = 2e-8
    heat = 1e8
    q = over * stress(alpha, 0.0, heat)
    low = 0.0
    high = q / (3 * METAL.shear)
    for _ in range(200):
        d = 0.5 * (low + high)
        if q - 3 * METAL.shear * d > stress(alpha + d, d / dt, heat):
            low = d
        else:
            high = d
    increment = flow_kernels.metal_flow_increment
    found = increment(q, LAW, alpha, heat, dt)
    assert 3 * METAL.shear * found == pytest.approx(3 * METAL.shear * low, abs=3e-9 * q)
    assert increment(0.99 * stress(alpha, 0.0, heat), LAW, alpha, heat, dt) == 0.0
