"""The step towards the closest point of a ply, bounded to the elements that a search may reach."""

import numpy as np
import pytest

from shellfabric.jit.compile import entry
from shellfabric.plies import pressure_kernels

ROOM = (0.0, 2.0), (5.0, 4.0)  # (low, high) [elements] along a and b


@entry()
def bounded(w, slopes, step, place, room):
    return pressure_kernels.bounded_step(w, slopes, step, place, room)


def draw(seed):
    """A flat surface of oblique sides and a point beside it: (offset w, slopes (2, 3), place, the step to
    the closest point of the whole plane, the bounded step)."""
    random = np.random.default_rng(seed)
    slopes = random.normal(size=(2, 3)) + np.array([[3.0, 1.0, 0.0], [1.0, 2.0, 0.0]])
    place = random.uniform(*ROOM)
    w = random.normal(size=3) + slopes.T @ random.choice([-6, -1, 1, 6], 2)
    step = np.linalg.lstsq(slopes.T, w, rcond=None)[0]
    found = bounded(tuple(w), tuple(map(tuple, slopes)), tuple(step), tuple(place), ROOM)
    return w, slopes, place, step, np.array(found)


@pytest.mark.parametrize("seed", range(12))
def test_a_bounded_step_is_the_best_that_stays_in_the_room(seed):
    """No point of the side at which the step is cut is closer."""
    w, slopes, place, step, found = draw(seed)
    low, high = np.array(ROOM) - place
    assert np.all(found >= low - 1e-12)
    assert np.all(found <= high + 1e-12)
    if np.all((low <= step) & (step <= high)):
        assert found == pytest.approx(step)
        return
    cut = 1
    if not low[0] <= step[0] <= high[0]:
        cut = 0
    other = 1 - cut
    assert found[cut] == pytest.approx(np.clip(step, low, high)[cut])
    ways = np.zeros((2001, 2))
    ways[:, cut] = found[cut]
    ways[:, other] = np.linspace(low[other], high[other], 2001)
    distances = np.linalg.norm(w - ways @ slopes, axis=1)
    assert np.linalg.norm(w - found @ slopes) <= distances.min() + 1e-9


def test_the_draws_reach_every_side():
    sides = set()
    for seed in range(12):
        _, _, place, _, found = draw(seed)
        end = np.round(place + found, 9)
        sides |= {(k, end[k]) for k in (0, 1) if end[k] in (ROOM[0][k], ROOM[1][k])}
    assert sides == {(0, 0.0), (0, 5.0), (1, 2.0), (1, 4.0)}
