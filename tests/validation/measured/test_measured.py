"""Rows of what was measured, their statistics, and their coarse runs: as stored but for 2 % that round-off may do."""

from math import exp, hypot, sqrt
from types import SimpleNamespace as Given

import numpy as np
import pytest

from fabrics.base.errors import InputError
from validation import csv_file, origin, stale
from validation.measured import command, rows, statistics

KEPT = {row["id"]: row["coarse"] for row in csv_file.read(csv_file.DATA / "measured.csv")[1]}


def test_rows_have_an_id_of_their_own_a_source_and_a_number_or_a_reason():
    table = rows.read()
    assert len({row.id for row in table}) == len(table)
    for row in table:
        reason = row.assumed.startswith(("no model", "no data", "input"))
        assert row.source, row.id
        assert reason == (row.case is None), row.id
        assert reason or row.value, row.id


def test_bias_and_scatter_of_two_rows_and_of_one():
    """ln(M / E) of 0.3 and -0.1: mean 0.1, s^2 = 0.08; of tests of 10 % and of 30 %, which count as s / 2^(1/2)."""
    of = lambda sigma: statistics.of([1.0, 10.0], [exp(0.3), 10 * exp(-0.1)], [sigma, 10 * sigma])  # noqa: E731
    assert (of(0.1).sigma_model, of(0.1).bias) == pytest.approx((sqrt(0.07), exp(0.1 + 0.03)))
    assert (of(0.3).sigma_model, of(0.3).bias) == pytest.approx((sqrt(0.04), exp(0.1)))
    assert (
        str(statistics.of([2.0], [3.0], [0.2]))
        == "Statistics(bias=1.5, sigma_model=nan, sigma_test=0.1)"
    )


@pytest.mark.parametrize("over", [-2.2, -1.6, 0.3, 1.7])
def test_one_threshold_tells_what_is_within_on_pages_and_in_summaries(tool, over):
    """E +- 1.645 u_val of 90 %."""
    row = {"measured": "200", "computed": f"{200 + 7 * over}", "coarse": "", "sigma": "4"}
    row |= {"E": f"{7 * over}", "u_val": "7", "E_over_u_val": f"{over}"}
    row |= {"level": "ply", "quantity": "V50 of one ply"}
    within = abs(over) < 1.645
    assert statistics.is_within(row) == within
    (summary,) = command.summary([row])
    assert summary[statistics.WITHIN] == within
    assert summary["words"].startswith(f"{int(within)} of 1 within")
    assert tool("pages").count_within([row]).startswith(f"{int(within)} of 1 within")


def test_intervals_are_counted_by_level_and_outcomes_are_not(tool, monkeypatch):
    pages = tool("pages")
    rows = [("ply", 0.66), ("pack", -0.69), ("ply", -1.6), ("ply", 1.7), ("ply", "")]
    table = [{"level": level, "E_over_u_val": str(over)} for level, over in rows]
    monkeypatch.setattr(pages, "table", lambda name: table)
    lines = [line.strip("|").split("|") for line in pages.coverage_by_level().strip().splitlines()]
    told = {cells[0].strip(): [cell.strip() for cell in cells[1:]] for cells in lines[2:]}
    assert told == {
        "ply": ["3", "1 (33%)", "2 (67%)"],
        "pack": ["1", "0 (0%)", "1 (100%)"],
        "all": ["4", "1 (25%)", "3 (75%)"],
    }


def test_an_outcome_is_within_where_it_is_that_of_the_test():
    row = {"measured": "stopped", "computed": "", "coarse": "stopped", "E_over_u_val": ""}
    assert statistics.is_within(row)
    assert not statistics.is_within(row | {"computed": "perforated"})


SHOT = Given(
    outcome="stopped",
    energy_error_max=3e-4,
    plies={
        "pull_in": np.array([[1e-3, 2e-3], [4e-3, 3e-3]]),
        "cut_yarns": np.array([[0.0, 0.0, 9.0], [5.0, 0.0, 2.0]]),
    },
)
STRUCK = Given(
    z=np.array([0.0, 0.021, 0.017]),
    block=Given(back_face_signature=0.013),
    energies={"error": np.array([0.0, 0.2]), "projectile": np.array([50.0, 40.0])},
)
BAR = Given(length=0.031, width=0.009, energy_error=2e-4)
T_OF_TWO = 2.919986  # Student's t, 90 % on both sides, two degrees of freedom: printed tables
CLOSED = np.array([[35.0, 18.0], [37.0, 22.0], [39.0, 17.0]])
# of a measure: (value, standard error, error of energy)
COMPUTED = {
    "outcome": ("stopped", 0.0, 3e-4),
    "slip": (4.0, 0.0, 3e-4),
    "torn_plies": (2.0, 0.0, 3e-4),
    "depth": (21.0, 0.0, 4e-3),
    "dent": (13.0, 0.0, 4e-3),
    "bar_length": (31.0, 0.0, 2e-4),
    "bar_width": (9.0, 0.0, 2e-4),
    "limit": (300.0, hypot(5.0, 0.02 * 300.0), 7e-4),
    "growth": (1.5, 1.5 * hypot(hypot(5.0, 6.0) / 300, hypot(3.0, 4.0) / 200), 9e-4),
    "areal_density": (211.0, 0.0, 0.0),
    "thickness": (0.34, 0.0, 0.0),
    "closure_below": (37.0, 2.0 * sqrt(4 / 3) * T_OF_TWO / 1.645, 0.0),
    "closure_above": (19.0, sqrt(7) * sqrt(4 / 3) * T_OF_TWO / 1.645, 0.0),
}


def test_a_row_is_chosen_by_its_id_and_several_by_a_part_of_theirs():
    ids = ["pack, 9 mm", "pack, 9 mm, 300 mm", "ply"]
    assert command.choose(ids, "pack, 9 mm") == ["pack, 9 mm"]
    assert command.choose(ids, "9 mm") == ids[:2]
    assert command.choose(ids, "") == ids
    with pytest.raises(InputError, match=r"only = 'plies': must be part of one of pack, 9 mm, "):
        command.choose(ids, "plies")


@pytest.mark.parametrize("n", [2, 3, 5, 20])
def test_one_more_of_few_is_in_the_interval_of_90_percent(n):
    """On 40,000 made sets of n + 1 alike."""
    made = np.random.default_rng(n).normal(4.0, 3.0, (n + 1, 40_000))
    middle, error = statistics.of_one_more(made[:n])
    inside = np.abs(made[n] - middle) <= statistics.COVERAGE * error
    assert inside.mean() == pytest.approx(0.90, abs=0.008)


@pytest.mark.parametrize("name", ["S-726", "S-745"])
def test_a_closure_is_of_the_solids_of_the_other_fabrics(name):
    """Their V_c lies as far above the fibre fraction of the mesh as in their own fits."""
    pytest.importorskip("gmsh")
    own = {row["fabric"]: row for row in csv_file.read(rows.SOLIDS)[1]}
    found = rows._solids_of_others(name)
    kept = {key: float(row["E_c [GPa], 95 %"].partition("/")[0]) for key, row in own.items()}
    assert [one["E_c"] for one in found] == [
        pytest.approx(1e9 * E_c) for key, E_c in kept.items() if key != name
    ]
    # S-728 has the loosest yarns of all and S-731 the second densest: printed V_c of both would mislead
    left = {key: one["V_c"] for key, one in zip([key for key in own if key != name], found)}
    assert 0.2 < left["S-728"] < left["S-731"] < 0.6


def test_a_v50_is_that_of_drawn_shots():
    """Of a normal distribution whose 90 % interval is 3.29 standard deviations wide."""
    row = {"5 %": "107.1", "50 %": "126", "95 %": "140", "commit": "0123456789ab"}
    ran = command.drawn(row)
    assert float(ran["computed"]) == 126
    assert float(ran["error"]) == pytest.approx(32.9 / 3.29, rel=1e-4)
    assert (ran["coarse"], ran["energy_error"], ran["commit"]) == ("", "", "0123456789ab")
    assert command.drawn({"50 %": ""}) == command.drawn({}) == {}


def test_each_measure_is_what_its_name_says(monkeypatch):
    """Of made-up results in SI units, no two numbers of which are alike."""
    weave = Given(areal_density=0.211, thickness=0.34e-3)
    monkeypatch.setattr(rows, "_strike", lambda case: STRUCK)
    monkeypatch.setattr(rows, "_taylor", lambda case: BAR)
    monkeypatch.setattr(rows, "_closures", lambda case, fabric: CLOSED)
    monkeypatch.setattr(rows.wc, "impact", lambda setup: SHOT)
    monkeypatch.setattr(rows.wc, "fabric", lambda *_, **__: Given(weave=weave))

    def search(target, **_):
        if target == 2:
            return Given(velocity=200.0, half_width=3.0, shots=(Given(balance=9e-4),))
        shots = (Given(balance=7e-4), Given(balance=1e-4))
        return Given(velocity=300.0, half_width=5.0, shots=shots)

    monkeypatch.setattr(rows.ballistic_limit, "critical_velocity", search)

    def setup(**changes):
        plies = changes.get("panel.plies", 8)
        return Given(target=lambda: plies, strike_velocity=290.0)

    table = {"fabric": {"name": "S-720", "linear_density": "nominal"}}
    for measure, wanted in COMPUTED.items():
        case = Given(measure=measure, options={}, scene=table, setup=setup)
        assert rows.compute(case) == pytest.approx(wanted), measure
    named = {row.case.measure for row in rows.read() if row.case}
    assert named <= {*COMPUTED, rows.DRAWN}


# {id: reason} of rows whose kept values are of earlier code, until they are computed again
WAITING = {
    entry["row"]: entry["reason"] for entry in stale.read() if entry["study"] == stale.MEASURED
}
# [CPU s] of rows that run nightly, since a cheaper one is measured alike: the other projectile, the other gelatine
LONG = {"Prosser, fragment simulator": 70, "gelatine 10 %": 40}


def marked(row):
    """A row as a case; what is kept of one that waits says nothing of today's code."""
    marks = [pytest.mark.slow(LONG.get(row.id, 20))]
    if row.id in LONG:
        marks.append(pytest.mark.nightly)
    if row.id in WAITING:
        marks.append(pytest.mark.skip(reason=f"kept from before {WAITING[row.id]}"))
    return pytest.param(row, id=row.id, marks=marks)


@pytest.mark.parametrize("row", [marked(row) for row in rows.read() if row.coarse_case])
def test_the_coarse_run_is_as_stored(row):
    value, _, error = rows.compute(row.coarse_case)
    assert value == (
        KEPT[row.id] if isinstance(value, str) else pytest.approx(float(KEPT[row.id]), rel=0.02)
    )
    assert error < 0.02


def test_rows_of_the_documentation_take_committed_code_alone(monkeypatch):
    monkeypatch.setattr(origin, "changes", lambda: ["fabrics/new.py"])
    monkeypatch.setattr(command, "compute_each", lambda *_, **__: pytest.fail("it computed"))
    with pytest.raises(InputError, match=r"fabrics/new\.py is not as committed"):
        command.main(["crossover"], only="S-720 areal density")
