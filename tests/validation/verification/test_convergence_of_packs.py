"""Packs on several meshes, times of failure, and V50 on graded panels: what is made of the runs, and a small run."""

from dataclasses import replace

import numpy as np
import pytest

from shellfabric.impact.simulation import ImpactSetup
from validation.verification import graded_v50
from validation.verification.mesh_convergence import failure_times, packs, packs_page


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


def test_every_variation_makes_a_case():
    names = [name for name in packs.plan()["variations"] if name != "plies"]
    for case in packs.cases(["S-728"], [4], [2], names):
        packs.setup(case)


def test_study_goes_on_from_kept_shots_and_stops_at_its_budget(tmp_path, monkeypatch):
    """Bisection over shots that perforate above 123.4 m/s but for one at 130; nothing kept is computed again."""
    fired = []

    def fake(places):
        fired.extend(V for _, V in places)
        return [shot(V, "perforated" if V > 123.4 and abs(V - 127.1) > 1 else "stopped", 1.0) for _, V in places]

    monkeypatch.setattr(packs.run_cache, "results", lambda function, places, **more: fake(places))
    monkeypatch.setattr(packs, "weight", lambda case: 1.0)
    study = packs.Study(tmp_path)
    got = study.run(packs.Case("S-728", 4, 2), None)
    assert got.low <= 123.4 <= got.high
    assert got.high - got.low <= 1.0
    assert got.mixed is not None
    assert got.mixed[1] == pytest.approx(127.1, abs=1)
    assert (got.stop.velocity, got.through.velocity) == (86, 185)
    with pytest.raises(TimeoutError):
        packs.Study(tmp_path, ends=0.0).run(packs.Case("S-728", 4, 2), None)


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
    assert first > graded_v50.v50.LEAST
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
