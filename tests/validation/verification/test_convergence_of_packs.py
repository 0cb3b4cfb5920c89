"""Packs on several meshes: what is made of the runs, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from validation.verification.mesh_convergence import packs, packs_page


def shot(V, outcome, value):
    return packs.Shot(V, outcome, 0.0, 2 * value, 3 * value, 4 * value, (1e-5, float("inf")), 100, 1.0, 1e-4)


def found(n):
    """First order: values 10 + 1 / 2n times a factor."""
    value = 10 + 0.5 / n
    return packs.Found(
        value - 0.1, value + 0.1, (9.0, 12.0), shot(70.0, "stopped", value), shot(150, "perforated", value)
    )


def test_tables_hold_limits_failure_times_and_changes():
    """Limit 10 of values 10 + 1 / 2n; twice the stiffness with twice all values; a part of the cases has a page too."""
    base = {packs.Case("S-726", 4, n): found(n) for n in (1, 2, 4)}
    varied = {packs.Case("S-726", 4, 2, "stiff", stiffness=2.0): found(0.025)}
    text = packs_page.pages({**base, **varied}, packs.plan())
    assert "| 4 | S-726 | peak tension of the warp, N | 31.5 | 30.75 | 30.38 | 30 | Richardson | +2.5 | 5 |" in text
    assert "| 10.5 (9 to 12) | 10.25 (9 to 12) | 10.12 (9 to 12) |" in text
    assert "| 4 | S-726 | 1 | 150 | 10.0, none |" in text
    assert "| stiff | 4 | S-726 | **+192.7** |" in text
    assert "No case" in packs_page.pages({}, packs.plan())
    assert "| 4 | S-726 | absorbed energy, J | 20.5 |" in packs_page.pages(
        {packs.Case("S-726", 4, 2): found(2)}, packs.plan()
    )


def test_levels_of_a_pack_share_the_outer_mesh():
    one, two = (packs.setup(packs.Case("S-728", 2, level)) for level in (1, 2))
    first = two.grading[0][0]
    one, two = (replace(ply, table_size=11).panel() for ply in (one, two))
    assert one.lines_per_crossover == 1
    assert two.lines_per_crossover == 2
    for x, y, w in zip(one.lines(), two.lines(), one.weave.w):
        np.testing.assert_allclose(x[x > first * 2 * w * 1.001], y[y > first * 2 * w * 1.001])


def test_cases_come_from_the_cheapest_with_the_references_first():
    found = packs.cases(["S-728"], [2, 4], [1, 2, 3], ["time step x 1/2", "gap + 0.05 mm"])
    assert [(case.plies, case.level) for case in found[:2]] == [(2, 2), (4, 2)]
    weights = [packs.weight(case) for case in found[2:]]
    assert weights == sorted(weights)
    changed = {case.variation: case for case in found if case.variation}
    assert packs.setup(changed["gap + 0.05 mm"]).ply_gap == pytest.approx(packs.setup(found[1]).ply_gap + 5e-5)
    base, half = (packs.setup(case) for case in (found[1], changed["time step x 1/2"]))
    assert half.contact.courant == base.contact.courant / 2
    assert half.numerics.cfl == base.numerics.cfl / 2
    assert len(found) == 2 * 3 + 2


def test_study_brackets_the_critical_velocity_and_its_mixed_zone(tmp_path, monkeypatch):
    """Bisection over shots that perforate above 123.4 m/s but for one at 127.1."""

    def fake(function, places, **more):
        return [shot(V, "perforated" if V > 123.4 and abs(V - 127.1) > 1 else "stopped", 1.0) for _, V in places]

    monkeypatch.setattr(packs.run_cache, "results", fake)
    got = packs.study(packs.Case("S-728", 4, 2), None, tmp_path)
    assert got.low <= 123.4 <= got.high
    assert got.high - got.low <= 1.0
    assert got.mixed is not None
    assert got.mixed[1] == pytest.approx(127.1, abs=1)
    assert (got.stop.velocity, got.through.velocity) == (86, 185)
    with pytest.raises(TimeoutError):
        packs.study(packs.Case("S-728", 4, 2), None, tmp_path, ends=0.0)
