"""Packs on several meshes: what is made of the runs, and a small run."""

from dataclasses import replace

import numpy as np

from validation.verification.mesh_convergence import packs


def test_levels_of_a_pack_share_the_outer_mesh():
    one, two = (packs.setup(packs.Case("S-728", 2, level)) for level in (1, 2))
    first = two.grading[0][0]
    one, two = (replace(ply, table_size=11).panel() for ply in (one, two))
    assert one.lines_per_crossover == 1
    assert two.lines_per_crossover == 2
    for x, y, w in zip(one.lines(), two.lines(), one.weave.w):
        np.testing.assert_allclose(x[x > first * 2 * w * 1.001], y[y > first * 2 * w * 1.001])
