"""`weavecell compare`: A against B, on outcomes that are drawn and not computed."""

import json
from dataclasses import replace

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.scene_text import impact_scene
from weavecell.runs import table
from weavecell.studies import unknown
from weavecell.studies.inputs import read_scatter
from weavecell.studies.strengths import FACTORS

# no test here looks at what a picture shows
pytestmark = pytest.mark.usefixtures("drawn_once")

# of the areal density in the drawn velocities: by the root the specific energies of all panels were one
POWER = 0.6
fired = []

# frictions that are given
NOT_DRAWN = dict.fromkeys(("friction_between_yarns", "friction_on_nose", "friction_between_plies"))


def fake_fire(setup, velocity, draw):
    fired.append((setup.plies, draw.number, draw.stride))
    panel = draw.number * (draw.stride or setup.plies)
    values = unknown.draw(setup, draw.scatter, draw.seed, draw.number, panel)[1]
    factors = {key: values[name] for key, name in FACTORS.items()}
    failing = 200.0 * setup.areal_density**POWER * factors["modulus"]
    hit = velocity > failing
    left = 0.6 * velocity if hit else 0.0
    more = {"drawn": factors, "weakest": (0.9, 0.8), "balance": 1e-4}
    return table.Shot(velocity, left, bool(hit), draw.number, **more)


@pytest.fixture(autouse=True)
def drawn_outcomes(monkeypatch):
    fired.clear()
    monkeypatch.setattr(table, "fire", fake_fire)


def test_two_fabrics_with_their_masses():
    found = wc.compare("S-726", "S-728", shots=30)
    masses = [wc.fabric(name).weave.areal_density for name in ("S-726", "S-728")]
    assert found.areal_densities == pytest.approx(masses)
    # of the projectile of 3 g at each V50, over the areal density of the same panel
    energies = [0.5 * found.targets[0].setup.projectile.mass * V**2 for V in found.values]
    a, b = (energy / mass for energy, mass in zip(energies, masses))
    assert found.specific_energies == pytest.approx((a, b))
    assert abs(a / b - 1) > 1e-3
    by_mass = found.difference_by_mass
    assert by_mass.value == pytest.approx(a - b, abs=0.3 * by_mass.span.half)
    assert by_mass.span.low < by_mass.value < by_mass.span.high
    true = 200 * (masses[0] ** POWER - masses[1] ** POWER)
    assert found.interval[0] < true < found.interval[1]
    assert found.difference.value == pytest.approx(true, abs=0.5 * abs(true) + 1)
    assert all(one.v50_low < one.v50 < one.v50_high for one in (found.a, found.b))
    assert (found.verdict == "better") == (found.interval[0] > 0)
    assert (found.verdict == "worse") == (found.interval[1] < 0)
    printed = found.details()
    assert f"mass of A: {100 * (masses[0] / masses[1] - 1):+.1f} % against B" in printed


def test_two_lay_ups_are_drawn_alike_ply_by_ply(tmp_path, succeed):
    for name, plies in (("two", 2), ("three", 3)):
        text = impact_scene(fabric="S-728", panel=f"plies = {plies}")
        (tmp_path / f"{name}.toml").write_text(text)
    out = succeed("compare two.toml three.toml --shots 12 --jobs 1 --out r")
    lines = out.splitlines()
    assert lines[-1] == "files       r/report.html"
    assert "A, 2 x S-728, or B, 3 x S-728: which is better?" in lines
    assert "; as a whole A is worse: V50 of A less B -" in out
    assert "; A has 33 % less mass" in out
    assert {stride for _, _, stride in fired} == {3}
    numbers = {plies: [n for p, n, _ in fired if p == plies] for plies in (2, 3)}
    assert numbers[2] == numbers[3] == list(range(12))
    written = json.loads((tmp_path / "r/difference.json").read_text())
    assert written["verdict"] == "worse"
    assert written["high_m_s"] < 0
    assert written["b_areal_density_kg_m2"] == pytest.approx(1.5 * written["a_areal_density_kg_m2"])
    for name in ("a/report.html", "b/v50.json", "report.html", "difference.csv", "difference.svg"):
        assert (tmp_path / "r" / name).is_file()


def test_a_hybrid_that_is_resumed_fires_nothing_again(tmp_path, succeed):
    plies = '[[panel.ply]]\nname = "S-728"\n[[panel.ply]]\nname = "S-726"\ncount = 2\n'
    hybrid = impact_scene(fabric="S-728", extra=plies).replace('name = "S-728"\n', "", 1)
    (tmp_path / "hybrid.toml").write_text(hybrid)
    (tmp_path / "plain.toml").write_text(impact_scene(fabric="S-728", panel="plies = 3"))
    line = "compare hybrid.toml plain.toml --shots 12 --jobs 1 --out r"
    first = succeed(line)
    assert len(fired) == 24
    assert succeed(f"{line} --resume") == first
    assert len(fired) == 24
    succeed(line.replace("--shots 12", "--shots 16") + " --resume")
    assert len(fired) < 24 + 32
    assert "A, 1 x S-728 + 2 x S-726" in first


def test_the_same_panel_is_refused_before_a_shot():
    """Also by another velocity or end, which a V50 does not read."""
    setup = wc.setup("S-728", 100.0)
    for other in ("S-728", setup, replace(setup, strike_velocity=120.0, end_time=3e-4)):
        with pytest.raises(InputError, match=r"target, other = 'S-728 and S-728': must be two"):
            wc.compare("S-728" if other == "S-728" else setup, other, shots=12)


def test_b_less_a_is_a_less_b_turned_round():
    one, other = (wc.compare(*pair, shots=12) for pair in (("S-726", "S-728"), ("S-728", "S-726")))
    assert other.difference.value == -one.difference.value != 0
    assert other.values == one.values[::-1]


def test_a_table_of_tests_is_sent_to_the_command_that_reads_it(tmp_path, command):
    (tmp_path / "tests.csv").write_text("velocity [m/s], outcome\n80, PP\n120, CP\n")
    code, out, err = command("compare", "tests.csv", "S-720")
    assert (code, out) == (2, "")
    assert (
        err == "error: tests.csv: is a table of tests; must be read by `weavecell reduce tests`\n"
    )
    with pytest.raises(InputError, match="must be read by `reduce_tests`"):
        wc.compare("S-720", tmp_path / "tests.csv")


def test_what_else_differs_and_the_doubts_of_each_are_named(monkeypatch):
    a, b = (wc.setup("S-728", 90.0, opening=side) for side in ("0.1 m", "0.2 m"))
    found = wc.compare(a, b, shots=8)
    assert found.other_differences == ["opening"]
    assert "A and B also differ in: opening" in found.details()
    monkeypatch.setattr(
        type(found.a), "doubts", property(lambda one: (f"doubt of {id(one)}",)), raising=True
    )
    assert found.doubts[:2] == (f"A: doubt of {id(found.a)}", f"B: doubt of {id(found.b)}")


def test_aims_are_the_same_share_of_a_cell():
    a, b = (wc.setup(name, 90.0, crossovers="yarns") for name in ("S-726", "S-728"))
    drawn = [unknown.draw(s, read_scatter(), 4, 7, 7)[0] for s in (a, b)]
    aims = [np.divide(s.impact_point, s.fabric.weave.w) for s in drawn]
    np.testing.assert_allclose(*aims)


def test_a_row_of_a_sweep_is_the_v50_of_its_input():
    swept = wc.sweep("S-728", over={"panel.opening": ["150 mm"]}, quantity="v50", shots=8)
    one = wc.v50("S-728", opening="150 mm", shots=8)
    (row,) = swept.rows
    assert row["outcome"] == "fitted"
    assert (row["v10_m_s"], row["v50_m_s"]) == (one.velocities["V10"].value, one.v50)
    assert swept.answer.value.startswith(f"V50 {one.v50:.3g} m/s")


def test_a_setup_of_python_is_answered_too():
    """It has no words for its projectile."""
    found = wc.v50(wc.setup("S-728", 90.0, opening="150 mm"), shots=8)
    assert found.answer.subject == "S-728, V50"


def test_a_forecast_fires_nothing():
    size = wc.compare("S-726", "S-728", shots=12, check=True)
    assert size.shots == 2 * 12
    plan = wc.compare.plan("S-726", "S-728", shots=12, seed=5)
    assert [(one.shots, one.seed, one.target.title) for one in plan.plans] == [
        (12, 5, "S-726"),
        (12, 5, "S-728"),
    ]
    assert not fired
