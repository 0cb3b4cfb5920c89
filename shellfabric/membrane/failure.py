"""What the failure criterion has for the grid lines of a panel: strengths, weights of means,
low-pass factors.

The criterion and its equations: `membrane.failure_kernels`.
"""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.base.checks import FloatArray, IntArray
from fabrics.fabric import Fabric
from shellfabric.membrane.criterion_kernels import load_of
from shellfabric.membrane.grid import PanelGrid
from shellfabric.state import FailureLines, Numbers, RateTable

# of the strength: below it a tension is followed without a delay, above it low-passed
WATCHED = 0.5


def lines_of(panel: PanelGrid) -> tuple[FailureLines, FailureLines]:
    """Return (warp, weft) FailureLines: of the lines j = const along the warp, i = const along the
    weft."""
    x = panel.lines()
    sides = panel.element_sides
    families = []
    factors = panel.strength_factors or tuple(np.ones(count) for count in panel.yarn_counts)
    law = panel.rate_law
    for own, yarn in enumerate(panel.weave.yarns):
        across = 1 - own
        strength = (
            panel.strengths[own] * np.asarray(factors[own], float)[panel.nearest_yarns[across]]
        )
        if not panel.yarn_failure:
            strength = np.full_like(strength, inf)
        first, weights = mean_weights(x[across], panel.fabric.failure_length, panel.mirrors[across])
        families.append(
            FailureLines(
                strength=strength,
                half_strength=half_strength(Numbers.of(panel), strength, yarn.EA, law, own),
                first=first,
                weights=weights,
                filter_factor=filter_factor(panel.fabric, own, sides[own], panel.time_step),
            )
        )
    return families[0], families[1]


def rate_table(law: FloatArray) -> RateTable:
    """Return what kernels need of a law of the strain rate (2, 3, loads), as `Panel.rate_law`."""
    load, rate, growth = (np.ascontiguousarray(law[:, row]) for row in range(3))
    return RateTable(load=load, rate=rate, growth=growth)


def half_strength(
    numbers: Any, strength: FloatArray, stiffness: float, law: FloatArray, family: int
) -> FloatArray:
    """Return the tension [N] below which an edge of a family is followed without a delay: a share of
    that at which the criterion has it fail.

    Parameters
    ----------
    numbers : row of the `PanelNumbers`
    strength : (n,) [N]; infinite where yarns do not fail
    stiffness : [N] EA of the yarn
    law : as `Panel.rate_law`
    """
    half = WATCHED * strength
    # thousands of segments have the strengths of a few yarns
    for value in np.unique(strength[np.isfinite(strength)]):
        half[strength == value] /= load_of.py_func(numbers, value, value, stiffness)
    if law.size:
        half *= law[family, 0, 0]
    return half


def filter_factor(fabric: Fabric, family: int, side: ArrayLike, dt: float) -> FloatArray:
    """Compute the share [-] of the way to the present tension that the low-pass goes in a step dt
    [s], of edges of the length `side` [m]: its time is that of a wave over twice the failure
    length, or edge."""
    wave_speed = fabric.weave.tension_wave_speed(family)
    times = 2 * np.maximum(fabric.failure_length, side) / wave_speed
    return -np.expm1(-dt / times)


def mean_weights(x: ArrayLike, length: float, mirrored: bool) -> tuple[IntArray, FloatArray]:
    """Compute the weights of the lines in the mean about each of them: the integral of max(0, 1 -
    |y| / length) / length.

    A line stands for the fabric up to halfway to its neighbours, so that the integral is exact for
    tensions that are constant there. Beyond the last line there is nothing.

    Parameters
    ----------
    x : (lines,) [m] positions of the lines, rising
    length : [m] half width of the mean
    mirrored : whether the first line is a plane of symmetry, behind which its neighbours have their
        images

    Returns
    -------
    first : (lines,) the first line that has a weight
    weights : (lines, n) [-] of the lines first ... first + n - 1, which add up to 1 away from the
        rims
    """
    x = np.asarray(x, float)
    middles = 0.5 * (x[1:] + x[:-1])
    low = np.insert(middles, 0, x[0])
    high = np.append(middles, x[-1])
    weights = _hat_integral(low, high, x, length)
    if mirrored:
        weights += _hat_integral(2 * x[0] - high, 2 * x[0] - low, x, length)
    present = weights > 0
    first = present.argmax(axis=1)
    count = (x.size - present[:, ::-1].argmax(axis=1) - first).max()
    first = np.minimum(first, x.size - count)
    return first, np.take_along_axis(weights, first[:, None] + np.arange(count), axis=1)


def _hat_integral(low, high, x, length):
    """(lines, lines) integral of the hat about x of the first index from low to high of the
    second."""
    ends = (np.clip((end - x[:, None]) / length, -1.0, 1.0) for end in (low, high))
    at_low, at_high = (end - 0.5 * end * np.abs(end) for end in ends)
    return at_high - at_low
