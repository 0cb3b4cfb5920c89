"""Every column of a table against the field of the shot that it is named after, on numbers that are all different."""

from dataclasses import replace
from types import SimpleNamespace as Given

import numpy as np
import pytest

import weavecell as wc
from shellfabric.impact.run import run_impact
from shellfabric.plies.gap import gap_between
from weavecell.answers.v50 import V50Result
from weavecell.results import impact, one_table
from weavecell.results.impact import ImpactRecord, _describe_stacking
from weavecell.results.impact_shapes import Cut
from weavecell.runs import sweep, table, v50
from weavecell.studies import limit as limit_study
from weavecell.studies import shot_row, window
from weavecell.studies.ballistic_limit import KeptShots, Limit, Shot
from weavecell.studies.inputs import Scatter

FIELDS = (
    "residual_velocity",
    "absorbed_energy",
    "max_deflection",
    "energy_error_max",
)


def result_of(number, outcome="perforated"):
    """A made-up result of a shot."""
    values = {name: 100.0 * number + k for k, name in enumerate(FIELDS, 1)}
    others = {
        "outcome": outcome,
        "peak_tension": (100.0 * number + 11, 100.0 * number + 12),
        "cut_yarns": np.array([0.0, 100.0 * number + 21]),
        "checks": (),
        "setup": Given(strike_velocity=100.0 * number + 31),
    }
    return Given(**values, **others)


ROW = {
    "outcome": "perforated",
    "residual_velocity_m_s": 301.0,
    "absorbed_energy_J": 302.0,
    "max_deflection_m": 303.0,
    "energy_error_max": 304.0,
    "peak_tension_warp_N": 311.0,
    "peak_tension_weft_N": 312.0,
    "cut_yarns": 321.0,
    "checks": "ok",
}


def test_a_row_of_a_sweep():
    assert shot_row.row_of(result_of(3)) == ROW
    assert shot_row.row_of(result_of(3), "too fast") == ROW | {"outcome": "unstable"}


def test_a_row_of_a_window_and_its_means():
    assert window._row(result_of(3)) == ROW | {"strike_velocity_m_s": 331.0}
    rows = tuple(
        window._row(result_of(n, outcome))
        for n, outcome in enumerate(("stopped", "perforated", "perforated", "perforated"), 1)
    )
    found = window.Window(281.0, rows)
    # all numbers lie on lines: at 281 m/s, half way from 231 to 331, the means are those half way
    for name, value in (
        ("residual_velocity", 251.0),
        ("absorbed_energy", 252.0),
        ("cut_yarns", 271.0),
    ):
        mean, error = found.mean(name)
        assert mean == pytest.approx(value)
        assert error == pytest.approx(0.0, abs=1e-9)
        told = found.summary()["mean"][window.QUANTITIES[name][0]]
        assert told == pytest.approx(value)
    assert found.summary()["stopped"] == 1


SHOTS = tuple(
    Shot(
        v,
        0.3 * v * through,
        ("stopped", "perforated")[through],
        v * 1e-6,
        v + 1,
        (v + 2, v + 3),
        v * 1e-5,
        v + 4,
    )
    for v, through in ((70.0, 0), (95.0, 1), (80.0, 0), (110.0, 1))
)
OF_A_LIMIT = {
    "strike_velocity_m_s": "strike_velocity",
    "residual_velocity_m_s": "residual_velocity",
    "outcome": "outcome",
    "end_time_s": "time",
    "cut_yarns": "cut_yarns",
    "energy_error_max": "balance",
    "checks": "status",
}


def test_the_table_of_a_limit():
    table = one_table.columns(SHOTS, "critical_velocity")
    for heading, field in OF_A_LIMIT.items():
        assert table[heading] == [getattr(shot, field) for shot in SHOTS]
    for family, name in enumerate(("warp", "weft")):
        wanted = [shot.peak_tension[family] for shot in SHOTS]
        assert table[f"peak_tension_{name}_N"] == wanted
    assert table.keys() == {*OF_A_LIMIT, "peak_tension_warp_N", "peak_tension_weft_N"}


def test_a_limit_knows_its_ends_and_its_shots():
    limit = Limit(80.0, 95.0, SHOTS)
    assert (limit.velocity, limit.half_width) == (87.5, 7.5)
    assert [shot.strike_velocity for shot in limit.ends] == [80.0, 95.0]
    assert (limit.highest_stop, limit.lowest_perforation) == (80.0, 95.0)
    early = Shot(75.0, 12.0, "perforated", 1e-4, 1, (1, 2), 0.0, 1.0)
    mixed = Limit(80.0, 95.0, (*SHOTS, early))
    assert mixed.mixed_zone == (75.0, 80.0)
    assert [shot.strike_velocity for shot in mixed.ends] == [75.0, 80.0, 95.0]


def test_a_row_of_a_critical_velocity(monkeypatch):
    found = Given(limit=Limit(80.0, 95.0, SHOTS))
    monkeypatch.setattr(sweep.limits, "search", lambda *_, **__: found)
    row = sweep.critical_velocity(Given(plies=1), 1.0)
    wanted = {"critical_velocity_m_s": 87.5, "lower_m_s": 80.0, "upper_m_s": 95.0, "shots": 4}
    assert {key: row[key] for key in wanted} == wanted
    assert row["outcome"] == "single limit"


def test_the_table_of_a_v50():
    names = ("modulus", "crimp_warp", "crimp_weft")
    shots = []
    for n in range(3):
        factors = [10.0 * n + k for k in range(1, 4)]
        frictions = {
            "friction_between_yarns": 0.1 + 0.05 * n,
            "friction_on_nose": 0.02 + 0.07 * n,
        }
        told = {"drawn": dict(zip(names, factors)) | frictions, "weakest": (n + 0.1, n + 0.2)}
        told |= {"impact_point": (n, -n), "balance": 0.01 * n}
        one = table.Shot(90.0 + n, 30.0 + n, n > 1, n, **told)
        shots.append(one)
    found = V50Result(Given(shots=shots), Given(setup=Given(crossovers=1)), 1, 1, 0.0)._columns()
    assert found["number"] == [0, 1, 2]
    assert found["strike_velocity_m_s"] == [90.0, 91.0, 92.0]
    assert found["residual_velocity_m_s"] == [30.0, 31.0, 32.0]
    assert found["outcome"] == ["stopped", "stopped", "perforated"]
    assert found["energy_error_max"] == [0.0, 0.01, 0.02]
    for k, name in enumerate(names, 1):
        assert found[name] == [k, 10 + k, 20 + k]
    for family, name in enumerate(("warp", "weft"), 1):
        assert found[f"weakest_{name}"] == pytest.approx([n + 0.1 * family for n in range(3)])
    assert found["impact_point_x_m"] == [0, 1, 2]
    assert found["impact_point_y_m"] == [0, -1, -2]
    assert found["friction_between_yarns"] == pytest.approx([0.1, 0.15, 0.2])
    assert found["friction_on_nose"] == pytest.approx([0.02, 0.09, 0.16])
    assert "friction_between_plies" not in found


@pytest.fixture(scope="module")
def shot():
    """A brief shot at two unlike plies, of the solver and of the application."""
    plies = [{"name": "S-726"}, {"name": "S-728", "angle": "90 deg"}]
    setup = wc.setup(
        None,
        "150 m/s",
        ply=plies,
        ply_gap="0.1 mm",
        opening="20 mm",
        elements_per_crossover=1,
        end_time="12 us",
        symmetry="half",
    )
    written = wc.impact(setup)
    return run_impact(written.target.setup), written


def test_a_shot_its_row_and_its_summary_have_the_same_numbers(shot):
    """Name by name: of the solver's result, the row of a sweep and the summary of a shot."""
    result, written = shot
    told, row = written.summary(), shot_row.row_of(result)
    for name in row.keys() & told.keys() - {"checks"}:
        assert told[name] == row[name], name
    assert {
        "peak_tension_warp_N",
        "peak_tension_weft_N",
        "absorbed_energy_J",
    } <= row.keys() & told.keys()
    assert len({row[name] for name in row if name.endswith(("_N", "_J", "_m"))}) == 4


def test_peaks_of_a_pack_are_those_of_ply_and_family(shot):
    result, written = shot
    told = written.summary()
    for family, name in enumerate(("warp", "weft")):
        each = result.peaks[:, family, 0]
        assert each[0] != each[1]
        ply = int(np.argmax(each))
        assert told[f"peak_tension_{name}_N"] == each[ply] == result.peak_tension[family]
        assert told[f"peak_tension_{name}_ply"] == ply + 1
        # a yarn as short as the opening is stronger than the stated one
        strength = result.panels[ply].strengths[family]
        assert strength > result.panels[ply].weave.yarns[family].strength
        share = told[f"peak_tension_{name}_over_strength"]
        assert share == pytest.approx(each[ply] / strength)
        histories = result.plies[f"peak_{name}"]
        assert histories[-1].tolist() == each.tolist()


def test_peaks_of_warp_and_weft_may_be_in_other_plies():
    """Tension, share of its own strength, time, place and ply of each family."""
    record = Given(
        peak_tension=np.array([[70.0, 20.0], [50.0, 80.0]]),
        peak_tension_time=np.array([[1.0, 2.0], [3.0, 4.0]]),
        peak_tension_place=np.array([[(1, 2), (3, 4)], [(5, 6), (7, 8)]]),
        strength=np.array([[100.0, 200.0], [400.0, 800.0]]),
    )
    warp, weft = ImpactRecord.peaks.fget(record).values()
    assert (warp.tension, warp.share, warp.time, list(warp.place), warp.ply) == (
        70,
        0.7,
        1,
        [1, 2],
        1,
    )
    assert (weft.tension, weft.share, weft.time, list(weft.place), weft.ply) == (
        80,
        0.1,
        4,
        [7, 8],
        2,
    )


@pytest.mark.parametrize("names", [("S-726", "S-728"), ("S-728", "S-726"), ("S-726", "S-726")])
def test_the_gap_of_a_pack_is_told_as_it_is_between_its_plies(names):
    """With the range and the source of these two, where it is not given."""
    plies = [{"name": name} for name in names]
    setup = wc.setup(None, "150 m/s", ply=plies, opening="20 mm", elements_per_crossover=1)
    target = setup.target()
    told = _describe_stacking(setup, target)
    between = gap_between(*map(setup.fabric_of, (0, 1)))
    assert target.gaps[0] == pytest.approx(between.value)
    assert told["ply_gap_low_m"] == pytest.approx(between.low)
    assert told["ply_gap_high_m"] == pytest.approx(between.high)
    assert told["ply_gap_source"] == between.source
    assert told["ply_fabrics"] == list(names)
    own = [gap_between(*2 * (setup.fabric_of(ply),)).high for ply in (0, 1)]
    assert len({*own, between.high}) == (1 if names[0] == names[1] else 3)


def test_the_cone_of_a_pack_is_that_of_its_last_ply():
    """Straight sides that meet the flat fabric at other places in each ply, at each instant."""
    x = np.linspace(-0.03, 0.05, 161)
    rest = np.array([0.0, 4e-4, 9e-4])
    feet = np.array([[21e-3, 17e-3, 13e-3], [33e-3, 27e-3, 22e-3]])
    cuts = []
    for number, of_plies in enumerate(feet, 1):
        heights = (np.maximum(0.0, 5e-3 * (1 - abs(x) / foot)) for foot in of_plies)
        lines = tuple(np.column_stack([x, z + place]) for z, place in zip(heights, rest))
        cuts.append(Cut(number * 1e-5, 0.0, lines))
    record = Given(cuts=tuple(cuts), z_rest=rest)
    assert ImpactRecord.cone_radius.fget(record) == pytest.approx(feet[:, -1], rel=0.01)
    assert ImpactRecord.cut_times.fget(record) == pytest.approx([1e-5, 2e-5])


@pytest.mark.parametrize("end, wanted", [(50e-6, 10e-6), (5e-6, 5e-6)])
def test_half_of_the_energy_is_that_of_what_is_lost_at_the_end(end, wanted, monkeypatch):
    """Of a nose that is thrown back, and so has lost less than when it stood still."""
    monkeypatch.setattr(impact.Shape, "from_snapshot", lambda one: one.t)
    clock = np.arange(6) * 10e-6
    kinetic = np.array([100.0, 62.0, 45.0, 0.0, 30.0, 40.0])
    snapshots = [(Given(t=t),) for t in clock[1:]]
    result = Given(energies={"kinetic_projectile": kinetic}, time=clock, snapshots=snapshots)
    final = (Given(time=end),)
    found = impact._half_energy(result, final)
    # a short run has no snapshot before its end
    assert found == ((wanted,) if end > 10e-6 else final)


def test_columns_of_a_shot_are_its_histories(shot):
    """Each history of the table is the field of its name; sums over plies are of the family of their name."""
    result, written = shot
    table = written.to_dataframe()
    for name in ("warp", "weft"):
        wanted = result.plies[f"reaction_{name}"].sum(axis=1)
        assert list(table[f"reaction_{name}_N"]) == list(wanted)
    warp, weft = (result.plies[f"reaction_{name}"] for name in ("warp", "weft"))
    assert not np.array_equal(warp, weft)
    fields = {"velocity_m_s": "velocity", "deflection_m": "deflection", "time_s": "time"}
    for column, field in fields.items():
        assert list(table[column]) == list(getattr(result, field)), column
    for name, history in result.energies.items():
        if f"energy_{name}_J" in table:
            assert list(table[f"energy_{name}_J"]) == list(history), name


def test_a_stop_with_a_little_velocity_left_is_a_stop_of_the_curve():
    """Of a limit and of a V50: the fit is that without what is left."""
    slow = Shot(85.0, 4.0, "stopped", 1e-4, 0, (1.0, 2.0), 0.0, 1.0)
    limit = Limit(85.0, 95.0, (*SHOTS, slow))
    still = Limit(85.0, 95.0, (*SHOTS, replace(slow, residual_velocity=0.0)))
    assert limit_study.residual_fit(limit) == limit_study.residual_fit(still)
    fits = []
    for left in (4.0, 0.0):
        shots = [(s.strike_velocity, s.residual_velocity, s.perforated) for s in SHOTS]
        drawn = [
            table.Shot(*shot, n, balance=0.0)
            for n, shot in enumerate([*shots, (85.0, left, False)])
        ]
        fits.append(v50.Study(tuple(drawn), None, Scatter()).lambert_jonas)
    assert fits[0] == fits[1]


def test_a_kept_shot_is_of_its_own_velocity(tmp_path):
    setup = wc.setup("S-720", "90 m/s", opening="20 mm", elements_per_crossover=1)
    kept = KeptShots(tmp_path, setup)
    kept.keep(SHOTS[0], 70.2, 0.0)
    assert kept.of(70.2, 0.0) == SHOTS[0]
    assert kept.of(70.3, 0.0) is None
    assert kept.of(70.2, 0.1) is None
