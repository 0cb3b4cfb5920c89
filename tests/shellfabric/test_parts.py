"""Steps of a part in one of the run: how many there are, and when each is."""

import numpy as np
import pytest

from shellfabric.parts import own_steps
from shellfabric.subcycle_kernels import make_steps


@pytest.mark.parametrize("seed", range(5))
def test_there_are_as_few_own_steps_as_the_bound_allows(seed):
    dt, longest = np.random.default_rng(seed).uniform(1e-9, 1e-6, 2)
    count = own_steps(dt, longest)
    assert dt / count <= longest * (1 + 1e-9)
    assert count == 1 or dt / (count - 1) > longest


@pytest.mark.parametrize("count", [1, 3, 7])
def test_a_whole_number_of_steps_is_not_raised_by_rounding(count):
    longest = 0.1 / 3
    assert own_steps(count * longest, longest) == count


def test_own_steps_fill_the_step_of_the_run():
    made = []

    def step(body, dt, left):
        made.append((body, dt, left))

    make_steps(step, "a body", 4, 1e-6)
    assert [body for body, _, _ in made] == ["a body"] * 4
    assert [dt for _, dt, _ in made] == pytest.approx([0.25e-6] * 4)
    assert [left for _, _, left in made] == pytest.approx([0.75e-6, 0.5e-6, 0.25e-6, 0.0])
