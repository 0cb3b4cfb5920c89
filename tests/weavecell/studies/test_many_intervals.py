"""Answers over what nobody knows, many at once: sweeps, and the difference of two panels."""

import json

import pytest

import weavecell as wc
from fabrics import backings
from fabrics.base.errors import InputError
from tests.scene_text import sphere_scene
from weavecell.studies import interval, interval_row, sweep
from weavecell.studies.interval import Interval, Run
from weavecell.studies.interval_difference import Pair
from weavecell.studies.places import CROSSOVER, GAP, Places

YARNS, NOSE, PLIES = interval.FRICTIONS
TWO = {YARNS: (0.1, 0.3), NOSE: (0.0, 0.2)}
SCENE = sphere_scene("24 mm", "18 us", 'crossovers = "yarns"\nzone = "8 mm"')
STRIKE = "projectile.strike_velocity"


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def answer(quantity, *rows):
    """An Interval over TWO: (place, friction between yarns, on the nose, entries of its row)."""
    runs = []
    for place, yarns, nose, row in rows:
        struck = {"strike_velocity_m_s": 150.0}
        runs.append(Run(place, {YARNS: yarns, NOSE: nose}, row | struck))
    return Interval(quantity, Places((CROSSOVER, GAP)), TWO, tuple(runs))


def shot(left, **row):
    outcome = "perforated" if left else "stopped"
    return {"outcome": outcome, "residual_velocity_m_s": left, "checks": "ok"} | row


def limit(low, high, **row):
    return {"outcome": "single limit", "lower_m_s": low, "upper_m_s": high, "checks": "ok"} | row


def test_a_row_of_a_sweep_has_both_ends_of_an_interval_and_what_decides():
    again = shot(61.0, checks="doubtful: slip", widened="cut yarns outside")
    found = answer(
        "shot",
        (CROSSOVER, 0.1, 0.0, shot(0.0)),
        (GAP, 0.1, 0.0, again),
        (CROSSOVER, 0.3, 0.2, shot(0.0)),
        (GAP, 0.3, 0.0, shot(22.0)),
        (GAP, 0.1, 0.2, shot(49.0)),
    )
    over = sweep.QUANTITIES["shot"].over_unknown
    assert over.ends == ("residual_velocity_low_m_s", "residual_velocity_high_m_s")
    assert over.is_span
    assert interval_row.make_row(found) == {
        "outcome": "depends",
        "residual_velocity_low_m_s": 0.0,
        "residual_velocity_high_m_s": 61.0,
        "decides": "the place, friction between yarns",
        "runs": 5,
        "checks": "doubtful: 1 of 5 runs",
        "widened": "1 of 5 runs with shots fired again with all yarns resolved: their zone was too small",
    }
    first = (CROSSOVER, 0.1, 0.0, limit(101.0, 103.0))
    alike = answer("critical-velocity", first, (GAP, 0.1, 0.0, limit(104.0, 105.0)))
    row = interval_row.make_row(alike)
    ends = row["critical_velocity_low_m_s"], row["critical_velocity_high_m_s"]
    assert (row["outcome"], row["decides"], *ends) == (
        "alike wherever it strikes",
        "",
        102.0,
        104.5,
    )
    differ = answer("critical-velocity", first, (GAP, 0.1, 0.0, limit(70.0, 74.0)))
    row = interval_row.make_row(differ)
    assert (row["outcome"], row["decides"]) == ("depends", "the place")
    lost = answer("critical-velocity", (CROSSOVER, 0.1, 0.0, {"outcome": "undecided: slow"}))
    row = interval_row.make_row(lost)
    assert (row["outcome"], row["critical_velocity_low_m_s"]) == ("undecided: slow", None)


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
def test_a_sweep_of_intervals_is_forecast_written_told_and_resumed(
    scene, tmp_path, monkeypatch, drawn_once
):
    over = {STRIKE: ["70 m/s", "120 m/s"]}
    size = wc.sweep(scene, over=over, interval=True, check=True)
    assert (size.shots, size.more.shots) == (6, 4)
    assert "if these do not agree, about 4 shots more; " in str(size)
    found = wc.sweep(scene, over=over, interval=True, out=tmp_path / "r")
    runs = json.loads((tmp_path / "r/sweep.json").read_text())["runs"]
    table = found.to_dataframe()
    for (_, row), of_row in zip(table.iterrows(), runs):
        left = [run["residual_velocity_m_s"] for run in of_row]
        ends = row["residual_velocity_low_m_s"], row["residual_velocity_high_m_s"]
        assert ends == pytest.approx((min(left), max(left)))
        assert row["runs"] == len(of_row)
        assert [run["place"] for run in of_row[:3]] == [CROSSOVER.name, GAP.name, CROSSOVER.name]
    assert table["residual_velocity_low_m_s"].nunique() == 2
    assert "in flight wherever it strikes" in found.lines()[1]
    assert "over strike velocity and what nobody knows" in found.headline[1]
    # a run alone is the shot that its entry says
    second = wc.sweep.plan(scene, over=over, interval=True).intervals[1].first[2]
    alone = wc.impact(second.setup)
    assert alone.residual_velocity == pytest.approx(runs[1][2]["residual_velocity_m_s"], rel=1e-9)
    # frictions are varied, and are not said to be left out
    (data,) = [part.text for part in found.left_out if part.kind == "assumed data"]
    assert "friction" not in data.replace("frictions are varied", "")
    again = wc.load(tmp_path / "r").to_dataframe()
    assert list(again) == list(table)
    monkeypatch.setattr("weavecell.studies.sweep.shot", None)
    again = wc.sweep(scene, over=over, interval=True, out=tmp_path / "r", resume=True)
    assert again.lines() == found.lines()


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_rows_that_do_not_agree_are_followed_up(scene, monkeypatch):
    """The gap lets through at the second velocity; friction raised there alone tells what decides."""
    fired = []

    def row(setup, quantity, tolerance):
        fired.append(setup)
        slow = setup.strike_velocity < 100
        if slow or not any(setup.impact_point):
            return shot(0.0)
        return shot(50.0 - 100 * setup.crossovers.friction)

    monkeypatch.setattr(sweep, "row", row)
    over = {STRIKE: ["80 m/s", "120 m/s"]}
    found = wc.sweep(scene, over=over, interval=True)
    assert [len(one.runs) for one in found.intervals] == [3, 5]
    assert list(found.to_dataframe()["outcome"]) == ["stopped", "depends"]
    assert len(fired) == 8
    told = "stopped to perforated with 40.0 m/s left: the place and friction between yarns decide; "
    assert found.lines()[1].startswith(f"strike velocity 120 m/s: {told}")


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("over", "options", "words"),
    [
        ({STRIKE: ["90 m/s"]}, {"quantity": "v50"}, "interval: must be left out of v50"),
        ({"panel.crossovers": ["pinned"]}, {}, "panel.crossovers = .pinned.: must be yarns, auto"),
        ({"panel.zone": ["3 mm"]}, {}, "zone"),
    ],
)
def test_what_no_interval_of_a_sweep_reads_is_refused(scene, over, options, words):
    if "panel.crossovers" in over:
        scene.write_text(SCENE.replace('zone = "8 mm"', ""))
    with pytest.raises(InputError, match=words):
        wc.sweep(scene, over=over, interval=True, check=True, **options)


def say_limit(setup):
    """[m/s] a made-up limit, which both frictions raise, and in a gap is lower."""
    friction = setup.crossovers.friction
    return 60 + 90 * friction + 40 * setup.projectile.friction - 14 * (setup.impact_point[0] != 0)


def fake_rows(monkeypatch, of_fabric):
    """Let the limit of a set-up be of_fabric[its fabric](set-up), in a bracket of 1.6 m/s."""

    def row(setup, quantity, tolerance):
        value = of_fabric[setup.fabric.name](setup)
        searched.append(setup)
        return limit(value - 0.7, value + 0.9)

    searched = []
    monkeypatch.setattr(sweep, "row", row)
    return searched


PANEL = {"opening": "30 mm", "crossovers": "yarns", "zone": "9 mm"}
PANEL["projectile"] = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_what_both_do_not_know_alike_cancels_in_their_difference(monkeypatch):
    """Each limit spans 24 m/s, their difference 9 to 12."""
    of_fabric = {
        "S-720": lambda setup: say_limit(setup) + 9 + 15 * setup.projectile.friction,
        "S-728": say_limit,
    }
    searched = fake_rows(monkeypatch, of_fabric)
    found = wc.compare("S-720", "S-728", interval=True, **PANEL)
    assert found.verdict == "better"
    assert found.interval == pytest.approx((9 - 1.6, 12 + 1.6))
    assert len(searched) == 6
    told = (
        "A is better wherever it strikes, by 7.4 to 13.6 m/s, friction between yarns 0.1 to 0.3, "
    )
    assert found.lines()[0] == f"A, S-720 or B, S-728: {told}friction on the nose 0 to 0.2"
    table = found.to_dataframe()
    assert (
        list(table["place_a"])
        == list(table["place_b"])
        == [CROSSOVER.name, GAP.name, CROSSOVER.name]
    )
    assert list(table["difference_m_s"]) == pytest.approx([9.0, 9.0, 12.0])
    assert table["a_m_s"].max() - table["a_m_s"].min() > 24
    other = wc.compare("S-728", "S-720", interval=True, **PANEL)
    assert (other.verdict, other.answer.partition(",")[0]) == (
        "worse",
        "A is worse wherever it strikes",
    )
    masses = [wc.fabric(name).weave.areal_density for name in ("S-720", "S-728")]
    energies = []
    for run_a, run_b in zip(*found.difference.runs):
        limits = [[run.row[end] for end in ("lower_m_s", "upper_m_s")] for run in (run_a, run_b)]
        (a, b), (c, d) = ([0.5 * 0.69e-3 * v**2 / m for v in of] for of, m in zip(limits, masses))
        energies += [a - d, b - c]
    span = f"{min(energies):+.1f} to {max(energies):+.1f} J per kg/m²"
    assert span in found.per_mass


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_where_a_friction_decides_which_is_better_it_is_named(monkeypatch):
    """S-720 is better at a friction between yarns of 0.1, S-728 at 0.3."""
    of_fabric = {
        "S-720": lambda setup: (
            90 + 20 * setup.projectile.friction - 5 * (setup.impact_point[0] != 0)
        ),
        "S-728": say_limit,
    }
    searched = fake_rows(monkeypatch, of_fabric)
    found = wc.compare("S-720", "S-728", interval=True, **PANEL)
    # three first runs of each, and each friction alone in the gap
    assert len(searched) == 10
    assert found.verdict == "not decided"
    values = found.to_dataframe()["difference_m_s"]
    assert list(values) == pytest.approx([21.0, 30.0, -1.0, 12.0, 26.0])
    assert (found.low, found.high) == pytest.approx((-2.6, 31.6))
    assert found.difference.effects == pytest.approx(
        {
            "friction between yarns": 18.0,
            "the place": 9.0,
            "friction on the nose": 4.0,
            "the width that the searches leave": 3.2,
        }
    )
    assert found.decides == ("friction between yarns",)
    told = "depends: A less B -2.6 to +31.6 m/s: friction between yarns decides; measure friction"
    assert found.answer.startswith(told)
    assert found.difference.weakest == (GAP, GAP)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_friction_that_one_side_gives_is_the_others_own(scene, tmp_path, monkeypatch, succeed):
    given = tmp_path / "given.toml"
    given.write_text(SCENE.replace("[run]", "crossover_friction = 0.17\n[run]"))
    fake_rows(monkeypatch, {"S-728": say_limit})
    monkeypatch.chdir(tmp_path)
    out = succeed("compare scene.toml given.toml --interval --jobs 1 --out r")
    assert "the same for both, whatever it is: friction on the nose" in out
    assert "unknown of A alone, or in a range of its own: friction between yarns" in out
    written = json.loads((tmp_path / "r/interval-difference.json").read_text())
    assert written["unknown"] == {
        "friction on the nose": [0.0, 0.2],
        "friction between yarns of A": [0.1, 0.3],
    }
    assert {row["friction_between_yarns_b"] for row in written["pairs"]} == {0.17}
    ends = {
        (row["friction_between_yarns_a"], row["friction_on_nose_a"]) for row in written["pairs"]
    }
    assert ends == {(0.1, 0.0), (0.3, 0.0), (0.1, 0.2), (0.3, 0.2)}
    # the nose cancels, and the friction of A alone decides
    assert all(row["friction_on_nose_a"] == row["friction_on_nose_b"] for row in written["pairs"])
    assert written["decides"] == ["friction between yarns of A"]
    assert (written["low_m_s"], written["high_m_s"]) == pytest.approx((-6.3 - 1.6, 11.7 + 1.6))
    assert f"A, scene or B, given: {written['answer']}" in out
    assert written["answer"] in (tmp_path / "r/report.html").read_text("utf-8")
    again = wc.load(tmp_path / "r")
    assert again.headline[1] == written["answer"]
    assert len(again.to_dataframe()) == written["pairs"].__len__()


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_other_fibres_share_no_friction_and_a_single_place_meets_each_of_the_others():
    """Kevlar beside glass; two plies, on which a chisel feels no place, beside one."""
    other = wc.compare.plan("S-728", "glass-balanced", interval=True, opening="120 mm").plan
    assert other.shared == {}
    assert [sorted(own) for own in other.own] == [sorted(TWO), sorted(TWO)]
    chisel = PANEL | {"projectile": "FSP 1.10 g"}
    fabric = wc.setup("S-728", 100, **chisel)
    pack = wc.setup("S-728", 100, **(chisel | {"plies": 2}))
    plan = wc.compare.plan(fabric, pack, interval=True).plan
    assert [(a.name, b.name) for a, b in plan.places] == [
        ("on a warp yarn", "on a crossover"),
        ("on a weft yarn", "on a crossover"),
    ]
    assert [*plan.own[1]] == [PLIES]
    # at B the shared ends with both ends of its own
    assert [len(runs) for runs in plan.first] == [3, 4]


def test_limits_of_packs_are_subtracted_with_their_intervals():
    """Newcombe's interval by hand: 3 and 6 m/s below and above."""
    of_pack = {"outcome": sweep.INTERVAL}
    a = limit(300.0, 309.0, critical_velocity_m_s=303.0) | of_pack
    b = limit(280.0, 292.0, critical_velocity_m_s=286.0) | of_pack
    runs = answer("critical-velocity", (CROSSOVER, 0.1, 0.0, a), (GAP, 0.1, 0.0, b)).runs
    value, low, high = Pair(*runs).subtract()
    assert (value, low, high) == pytest.approx((17.0, 17 - 45**0.5, 17 + 72**0.5))
    lost = Run(runs[0].place, runs[0].frictions, {"outcome": "undecided: slow"})
    assert Pair(lost, runs[1]).subtract() is None


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"quantity": "v50"}, "interval: must be left out of v50"),
        ({"assumed_range": True}, "left out of an interval"),
        ({"shots": 9}, "shots"),
        ({"crossovers": "pinned", "zone": None}, "crossovers = .pinned.: must be yarns, auto"),
    ],
)
def test_what_no_interval_of_a_comparison_reads_is_refused(options, words):
    with pytest.raises(InputError, match=words):
        wc.compare("S-720", "S-728", interval=True, check=True, **(PANEL | options))


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
def test_an_interval_before_clay_and_before_gelatine_has_the_block_in_each_run(scene):
    """Both stop more than nothing behind, and clay, which is denser, more than gelatine."""
    block = 'size = ["40 mm", "40 mm", "20 mm"]\nmin_size = "3 mm"\nrefined_depth = "6 mm"\ngrowth = 1.5'
    short = SCENE.replace("18 us", "11 us")
    scene.write_text(short + f'[backing]\nmaterial = "gelatine 10 %"\n{block}\n')
    over = {"backing.material": ["Roma Plastilina No. 1", "gelatine 10 %"]}
    plan = wc.sweep.plan(scene, over=over, interval=True)
    runs = [[run.setup for run in each.first] for each in plan.intervals]
    materials = [{run.backing.material for run in of_row} for of_row in runs]
    assert materials == [{backings.load(name)} for name in over["backing.material"]]
    assert [run.symmetry for run in runs[0]] == ["quarter", "whole", "quarter"]
    table = wc.sweep(scene, over=over, interval=True).to_dataframe()
    scene.write_text(short)
    over = {STRIKE: ["120 m/s"]}
    (free,) = wc.sweep(scene, over=over, interval=True).rows
    for end in ("low", "high"):
        clay, gelatine = table[f"residual_velocity_{end}_m_s"]
        assert clay < gelatine < free[f"residual_velocity_{end}_m_s"]


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_body_of_metal_is_refused_with_what_would_do(scene):
    nose = SCENE[SCENE.index("[projectile]") : SCENE.index("[panel]")]
    bullet = '[projectile]\nname = "9 mm FMJ 8.0 g"\nstrike_velocity = "300 m/s"\n'
    scene.write_text(SCENE.replace(nose, bullet).replace("24 mm", "80 mm"))
    words = (
        "projectile.body = .metal.: must be rigid in an interval: .* or one run, of pinned yarns"
    )
    over = {STRIKE: ["250 m/s"]}
    with pytest.raises(InputError, match=words):
        wc.sweep(scene, over=over, interval=True, check=True)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_friction_of_plies_is_varied_of_a_pack_and_not_of_one_ply():
    panel = PANEL | {"opening": "60 mm"}
    pack = wc.setup("S-728", 120, plies=2, **panel)
    one = wc.setup("S-728", 120, **panel)
    plan = wc.sweep.plan(pack, over={STRIKE: [120]}, interval=True).intervals[0]
    low, high = plan.unknown[PLIES]
    assert low < high
    assert [run.setup.ply_friction for run in plan.first] == [low, low, high]
    alone = [run for run in plan.plan_more(GAP) if run.setup.ply_friction == high]
    assert [run.frictions for run in alone] == [
        {YARNS: plan.unknown[YARNS][0], NOSE: plan.unknown[NOSE][0], PLIES: high}
    ]
    single = wc.sweep.plan(one, over={STRIKE: [120]}, interval=True).intervals[0]
    assert PLIES not in single.unknown
    assert {run.setup.ply_friction for run in single.first} == {one.ply_friction}
