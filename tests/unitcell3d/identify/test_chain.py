"""Intervals of the compression law from those of the solid's constants, with a closed form in place of the paths."""

from types import SimpleNamespace

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from fabrics.base.executors import InProcess
from fabrics.compression import CompressionLaw
from unitcell3d.identify import chain
from unitcell3d.identify.chain import combine
from unitcell3d.identify.solid_record import with_solid_laws

A = 4e-5
B = 5e-5
F = np.geomspace(0.1, 100, 25)
NONE = np.empty(0), np.empty(0)


def fabric_of(s720, *logarithms):
    return with_solid_laws(s720, np.log([2e9, 0.3, 0.02]) + np.array(logarithms), 0.7)


def path(job, _=None):
    """a as the root of E_c over 2 GPa, downwards, b as K_r over 0.02."""
    solid = job.fabric.solid_laws[0]
    return F, CompressionLaw(A * (2e9 / solid.E_c) ** 0.5, B * solid.K_r / 0.02, "regularised").d(F)


@pytest.fixture
def intervals(s720, tmp_path_factory, monkeypatch):
    """The LawInterval of a fit with three directions, its paths computed by the function that is given."""
    ends = [(-0.2, 0, 0), (0.2, 0, 0)], [(0, -0.3, 0), (0, 0.3, 0)], [(0, 0, -0.4), (0.1, 0, 0.5)]
    limits = tuple(tuple(fabric_of(s720, *end) for end in pair) for pair in ends)
    fit = SimpleNamespace(fabric=fabric_of(s720, 0, 0, 0), limits=limits)

    def of(path_of):
        monkeypatch.setattr(chain, "_path", lambda job: path_of(job, limits))
        folder = tmp_path_factory.mktemp("paths")
        return chain.law_intervals([fit], folder=folder, executor=InProcess())[0]

    return of


def test_changes_along_the_directions_add_as_squares(intervals):
    found = intervals(path)
    assert found.law.a == pytest.approx(A, rel=1e-3)
    # ln a: +-0.1 on the first direction, 0 and -0.05 on the third; ln b: -0.4 and 0.5 on the third
    assert np.log(np.array(found.a) / A) == pytest.approx([-np.hypot(0.1, 0.05), 0.1], abs=2e-3)
    assert np.log(np.array(found.b) / B) == pytest.approx([-0.4, 0.5], abs=2e-3)
    other = CompressionLaw(2 * A, 3 * B, "regularised")
    assert found.around(other)["a"] == pytest.approx(np.multiply(found.a, 2), rel=1e-2)
    assert found.around(other)["b"] == pytest.approx(np.multiply(found.b, 3), rel=1e-2)


def test_an_end_without_a_path_is_left_out_and_a_solid_without_one_has_no_law(intervals):
    def some(job, limits):
        return NONE if job.fabric.solid_laws == limits[2][1].solid_laws else path(job)

    found = intervals(some)
    assert found.ends[2][1] is None
    assert np.log(np.array(found.b) / B) == pytest.approx([-0.4, 0], abs=2e-3)
    assert isinstance(intervals(lambda *_: NONE), UnstableError)


def test_changes_of_unknowns_add_as_squares_on_each_side():
    """Of two changes on one side the larger counts; nothing goes down where no end does."""
    assert combine(10.0, [(7.0, 13.0), (14.0, 6.0)]) == pytest.approx((5.0, 15.0))
    assert combine(1.0, [(1.5, 2.0), (None, 1.0), ()]) == pytest.approx((1.0, 2.0))


def test_a_linear_function_of_normal_unknowns_has_its_own_interval():
    slopes = np.array([3.0, -1.0, 0.5])
    half = np.array([0.1, 0.2, 0.4])
    ends = [(5 - s * h, 5 + s * h) for s, h in zip(slopes, half)]
    width = np.sqrt(np.sum((slopes * half) ** 2))
    assert combine(5.0, ends) == pytest.approx((5 - width, 5 + width))
