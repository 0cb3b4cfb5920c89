"""What the facets of a mesh overlap by: against points thrown on them, and of order two in the element size."""

from itertools import pairwise

import numpy as np
import pytest

from fabrics import catalogue
from meshing import crossover, patch


def thrown(face, points, places):
    """Heights of bilinear facets (q, 4) above places (n, 2), by search: NaN off them."""
    z = np.full(len(places), np.nan)
    for corners in points[face]:
        low, high = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
        inside = np.all((places >= low) & (places < high), axis=1)
        s, t = ((places[inside] - low) / (high - low)).T
        for corner in corners:
            right, far = corner[:2] > (low + high) / 2
            z_part = (s if right else 1 - s) * (t if far else 1 - t) * corner[2]
            z[inside] = np.where(np.isnan(z[inside]), 0, z[inside]) + z_part
    return z


@pytest.mark.parametrize("domain", ["quarter", "whole"])
def test_least_gap_is_that_of_points_thrown_on_the_facets(domain):
    mesh = crossover.build(catalogue.load("S-745"), size=(5, 4, 2), domain=domain)
    corners = np.meshgrid(*(np.unique(mesh.points[:, axis].round(12)) for axis in (0, 1)))
    inside = 0.999999 * np.stack(corners, axis=-1).reshape(-1, 2)
    places = np.concatenate([np.random.default_rng(3).uniform(-1, 1, (2000, 2)) * mesh.w, inside])
    warp, weft = (thrown(mesh.groups[f"{name}_contact"], mesh.points, places) for name in ("warp", "weft"))
    gap = np.nanmin(warp - weft)
    assert mesh.least_gap == pytest.approx(gap, rel=1e-3)


def test_facets_overlap_by_their_sag_alone():
    """Conforming smooth sections touch everywhere: what is left is the facets' sag, a quarter at half the size."""
    fabric = catalogue.load("S-728")
    gaps = [crossover.build(fabric, size=(4 * n, 3 * n, n)).least_gap for n in (2, 4, 8)]
    assert -1e-6 < gaps[0] < 0
    assert [a / b for a, b in pairwise(gaps)] == pytest.approx([4, 4], rel=0.2)


def test_a_patch_has_the_gap_of_its_crossing():
    fabric = catalogue.load("S-728")
    gaps = [patch.build(fabric, (2, 3), size=(4, 3, 1)).least_gap, crossover.build(fabric, size=(4, 3, 1)).least_gap]
    assert gaps[0] == pytest.approx(gaps[1], rel=1e-6)
