"""`panel.areal_density`: packs of one mass, whatever a ply of their fabric weighs."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.scene_text import impact_scene
from weavecell.api.target import resolve_target

SMALL = {"opening": "40 mm", "end_time": "5 us"}
FABRICS = ("S-720", "S-728", "S-745")
ASKED = 2.1  # [kg/m2]


@pytest.mark.parametrize("name", FABRICS)
def test_a_mass_is_the_nearest_number_of_plies(name):
    """Of a pack that is asked for in words, in a file or in Python."""
    of_ply = wc.fabric(name).weave.areal_density
    plies = {
        wc.setup(name, "90 m/s", areal_density=text, **SMALL).plies
        for text in ("2.1 kg/m^2", "2100 g/m^2")
    }
    (count,) = plies
    assert abs(count * of_ply - ASKED) <= 0.5 * of_ply
    assert count > 1


def test_three_fabrics_of_one_mass_differ_in_plies():
    counts = [wc.setup(name, "90 m/s", areal_density=ASKED, **SMALL).plies for name in FABRICS]
    assert len(set(counts)) == 3


def test_a_file_says_it_and_a_sweep_varies_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = impact_scene(fabric="S-728", panel='areal_density = "1.2 kg/m^2"')
    (tmp_path / "pack.toml").write_text(scene)
    found = resolve_target("pack.toml", {}, "v50")
    assert found.setup.plies == found.scene.panel.plies == 5
    assert found.title == "5 x S-728"
    over = {"panel.areal_density": ["0.5 kg/m^2", "1.4 kg/m^2"], "fabric.name": ["S-728", "S-720"]}
    plan = wc.sweep.plan("pack.toml", over=over)
    assert [target.setup.plies for target in plan.panels] == [2, 2, 6, 5]
    wanted = [0.5, 0.5, 1.4, 1.4]
    for target, mass in zip(plan.panels, wanted):
        assert target.setup.areal_density == pytest.approx(mass, abs=0.13)


def test_two_fabrics_are_compared_at_one_mass():
    plan = wc.compare.plan("S-728", "S-745", areal_density="2.1 kg/m^2", opening="70 mm")
    assert [panel.setup.plies for panel in (plan.a, plan.b)] == [9, 4]


@pytest.mark.parametrize(
    "keys, words",
    [
        (
            {"areal_density": "1 g/m^2"},
            "areal_density = '0.001 kg/m^2': must be that of 1 to 100 plies",
        ),
        (
            {"areal_density": "2 kg/m^2", "plies": 3},
            "plies = 3: must be left out beside areal_density",
        ),
        (
            {"areal_density": "2 kg/m^2", "ply": [{"count": 2}]},
            "must be left out beside areal_density",
        ),
        (
            {"areal_density": "0.24 kg/m^2", "ply_friction": 0.3},
            "must be left out for a single ply",
        ),
        ({"areal_density": "5 mm"}, "must be an areal density above 0"),
    ],
)
def test_what_contradicts_it_is_refused(keys, words):
    with pytest.raises(InputError) as problem:
        wc.setup("S-728", "90 m/s", **SMALL, **keys)
    assert words in str(problem.value)


def test_it_is_left_out_of_what_asks_for_plies():
    with pytest.raises(InputError, match=r"areal_density = '2 kg/m.2': must be left out"):
        wc.plies("S-728", stop="FSP 1.10 g", at="200 m/s", areal_density="2 kg/m^2")
