"""Packs on several meshes, times of failure, and V50 on graded panels: what is made of the runs, and a small run."""

import numpy as np
import pytest

from fabrics.errors import InputError
from shellfabric.impact.single_ply import ImpactSetup
from validation.verification import graded_v50
from validation.verification.mesh_convergence import failure_times, packs

LEVELS = (1, 2, 4)


def row(outcome, value):
    return outcome, value, 2 * value, 3 * value, 4 * value, 100, 1e-4


def test_quantities_of_a_pack_converge_with_the_order_of_their_values():
    """First order, limit 10: the fast shots give velocity and energy, the slow ones the tensions."""
    slow, fast = ([row(outcome, 10 + k / n) for n in LEVELS] for outcome, k in (("stopped", 1), ("perforated", 2)))
    found = packs.quantities("S-726", LEVELS, [*slow, *fast])
    assert [entry.name.partition(" at ")[0] for entry in found] == [
        "residual velocity", "absorbed energy", "peak tension of the warp", "peak tension of the weft",
    ]  # fmt: skip
    np.testing.assert_allclose([entry.extrapolation.limit for entry in found], [10, 20, 30, 40])
    np.testing.assert_allclose([entry.extrapolation.order for entry in found], 1.0, rtol=1e-6)


def test_a_pack_of_another_outcome_is_refused():
    rows = [row("stopped", 1.0)] * 3 + [row("perforated", 1.0)] * 2 + [row("stopped", 0.0)]
    with pytest.raises(InputError, match="stopped at level 4"):
        packs.quantities("S-726", LEVELS, rows)


def test_levels_of_a_pack_share_the_outer_mesh():
    one, two = (packs.ply("S-728", level) for level in (1, 2))
    first = two.grading[0][0]
    assert one.lines_per_crossover == 1
    assert two.lines_per_crossover == 2
    for x, y, w in zip(one.lines(), two.lines(), one.weave.w):
        np.testing.assert_allclose(x[x > first * 2 * w * 1.001], y[y > first * 2 * w * 1.001])


def test_tables_of_the_failure_times():
    shots = [(100.0 + n, 5.0, 84e-6 if V > 170 else float("inf")) for n in failure_times.MESHES
             for V in failure_times.STRIKES]  # fmt: skip
    text = failure_times.tables(shots, [(170.0 + n, 170.5 + n) for n in failure_times.BISECTED])
    assert "| 150 | 101.0 (inf) | 102.0 (inf) | 103.0 (inf) |" in text
    assert "| 180 | 101.0 (84) | 102.0 (84) | 103.0 (84) |" in text
    assert "171.0 to 171.5 | 172.0 to 172.5" in text


def test_first_zones_hold_what_comes_under_the_nose():
    """All gradings are accepted, with the crimp of nearly all drawn panels."""
    first, zones = graded_v50.gradings("S-726")
    assert first > graded_v50.LEAST
    assert zones[0] is None
    for grading in zones[1:]:
        ImpactSetup(
            graded_v50.catalogue.load("S-726"), 1.0, opening=0.203, symmetry="whole", table_size=11, grading=grading
        ).panel()


def test_rows_of_the_comparison():
    """V50 of each mesh, outcomes that differ, and residual velocities of the shots that perforate on both."""
    meshes = len(graded_v50.ZONES)
    shots = [graded_v50.Shot(100.0 + k, (0.0 if k < 5 else 50.0,) * meshes, (2.0,) + (0.5,) * (meshes - 1))
             for k in range(10)]  # fmt: skip
    shots[4] = graded_v50.Shot(104.0, (0.0, *(40.0,) * (meshes - 1)), (2.0,) + (0.5,) * (meshes - 1))
    rows = graded_v50.rows_of("S-720", shots)
    assert [line[3] for line in rows] == ["0 of 10", *["1 of 10"] * (meshes - 1)]
    assert [line[4].split()[0] for line in rows] == ["104.50", *["103.50"] * (meshes - 1)]
    assert [line[5] for line in rows] == ["0.00"] * meshes
    assert [line[7] for line in rows] == ["1.00", *["0.25"] * (meshes - 1)]
