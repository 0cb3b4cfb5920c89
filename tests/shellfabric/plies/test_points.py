"""Formulas of a contact point: for eight at once what they are for one, and both what plain Python says."""

import numpy as np
import pytest
from numba import njit
from numpy.testing import assert_allclose, assert_array_equal

from shellfabric.jit.simd import load, store, where
from shellfabric.plies.law_kernels import law_at
from shellfabric.plies.point_kernels import (
    newton_matrix,
    normal_equations,
    offset_after,
    solve,
    unearned,
)

N = 8
STEP = 7.0
THICKNESS = 0.23


@njit
def laws(table, cell, closures, one, eight):
    for k in range(N):
        one[0, k], one[1, k], one[2, k] = law_at(table, cell, closures[k])
    force, damping, energy = law_at(table, cell, load(closures, 0))
    store(eight[0], 0, force)
    store(eight[1], 0, damping)
    store(eight[2], 0, energy)


def test_law_of_one_and_of_eight():
    rng = np.random.default_rng(11)
    table = rng.uniform(0.5, 2.0, (5, 4))
    cell = 0.3
    # of the first cell, of the others, beyond the last, and below 0
    closures = np.array([0.11, 0.35, 0.71, 0.93, 1.27, 1.55, 6.1, -0.2])
    one, eight = np.empty((2, 3, N))
    laws(table, cell, closures, one, eight)
    assert_array_equal(one, eight)
    for k, closure in enumerate(np.maximum(closures, 0.0)):
        row = min(int(closure / cell), 4)
        force, stiffness, damping, energy = table[row]
        rest = closure - row * cell
        expected = force + stiffness * rest, damping, energy + (force + stiffness * rest / 2) * rest
        assert one[:, k] == pytest.approx(expected, rel=1e-14)


@njit
def parts(closures, motions, touched, lasts, kept, one, eight):
    for k in range(N):
        memory = touched[k], lasts[k], kept[k]
        one[k] = unearned(closures[k], motions[k], memory, STEP, THICKNESS)
    memory = load(touched, 0), load(lasts, 0), load(kept, 0)
    store(eight, 0, unearned(load(closures, 0), load(motions, 0), memory, STEP, THICKNESS))


def test_unearned_closure_of_one_and_of_eight():
    """Of points that touched a step ago and before; that jumped, came by motion, and left in part."""
    last_steps = np.array([6.0, 6.0, 6.0, 6.0, 5.0, 3.0, 6.0, 0.0])
    closures = np.array([0.061, 0.051, 0.083, 0.022, 0.047, 0.0013, 0.012, 0.035])
    motions = np.array([0.004, 0.031, 0.001, -0.002, 0.006, 0.0002, -0.003, 0.034])
    lasts = np.array([0.057, 0.0201, 0.037, 0.058, 0.041, 0.052, 0.014, 0.019])
    kept = np.array([0.013, 0.0071, 0.0093, 0.049, 0.027, 0.038, 0.033, 0.0051])
    one, eight = np.empty((2, N))
    parts(closures, motions, last_steps, lasts, kept, one, eight)
    assert_array_equal(one, eight)
    for k in range(N):
        touched = last_steps[k] == STEP - 1
        jump = closures[k] - motions[k] - lasts[k] * touched
        part = kept[k] * touched
        if abs(jump) > 0.01 * THICKNESS:
            part = max(part + jump, 0.0)
        assert one[k] == pytest.approx(min(part, closures[k]), abs=1e-15)
    assert 0.0 in one
    assert one[6] == closures[6]


@njit
def step(w, slopes, second):
    """Return the step towards the closest point, what is left after it, and both conditions."""
    plain, along, solvable, near = normal_equations(w, slopes, 1.0)
    a, b = solve(newton_matrix(plain, w, second, near), along)
    return a, b, offset_after(w, slopes, second, a, b), solvable, near


@njit
def vector(x, m, k):
    return x[3 * m, k], x[3 * m + 1, k], x[3 * m + 2, k]


@njit
def vector8(x, m):
    return load(x[3 * m], 0), load(x[3 * m + 1], 0), load(x[3 * m + 2], 0)


@njit
def steps(x, one, eight):
    """x : (18, 8) offset, two slopes and three second slopes of eight points, three components each."""
    for k in range(N):
        slopes = vector(x, 1, k), vector(x, 2, k)
        second = vector(x, 3, k), vector(x, 4, k), vector(x, 5, k)
        a, b, after, solvable, near = step(vector(x, 0, k), slopes, second)
        one[0, k] = a
        one[1, k] = b
        for c in range(3):
            one[2 + c, k] = after[c]
        one[5, k] = solvable
        one[6, k] = near
    slopes = vector8(x, 1), vector8(x, 2)
    second = vector8(x, 3), vector8(x, 4), vector8(x, 5)
    a, b, after, solvable, near = step(vector8(x, 0), slopes, second)
    store(eight[0], 0, a)
    store(eight[1], 0, b)
    store(eight[2], 0, after[0])
    store(eight[3], 0, after[1])
    store(eight[4], 0, after[2])
    store(eight[5], 0, where(solvable, 1.0, 0.0))
    store(eight[6], 0, where(near, 1.0, 0.0))


def test_step_to_the_closest_point_of_one_and_of_eight():
    """Of points within the thickness and beyond it, over convex and concave fabric, and a line."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=(6, 3, N))
    x[0] *= [0.2, 0.4, 0.7, 0.3, 2.5, 3.1, 0.25, 0.35]
    x[3:] *= [0.1, 0.2, 0.1, 3.0, 0.2, 0.3, 4.0, 0.1]
    x[2, :, 7] = 1.7 * x[1, :, 7]
    one, eight = np.empty((2, 7, N))
    steps(x.reshape(18, N), one, eight)
    assert_array_equal(one, eight)
    convex = []
    for k in range(N - 1):
        w, y_a, y_b, aa, ab, bb = x[:, :, k]
        matrix = np.array([[y_a @ y_a, y_a @ y_b], [y_a @ y_b, y_b @ y_b]])
        along = np.array([y_a @ w, y_b @ w])
        height = w @ w - along @ np.linalg.solve(matrix, along)
        curved = matrix - [[w @ aa, w @ ab], [w @ ab, w @ bb]]
        near = height < 1.0
        convex.append(np.linalg.det(curved) > 0.1 * np.linalg.det(matrix) and curved[0, 0] > 0)
        if near and convex[-1]:
            matrix = curved
        assert one[5:, k].tolist() == [1.0, near]
        assert_allclose(one[:2, k], np.linalg.solve(matrix, along), rtol=1e-12)
    assert one[5, -1] == 0.0
    assert len(set(convex)) == 2
    assert len(set(one[6, :-1])) == 2
