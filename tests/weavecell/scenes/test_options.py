"""Options of a shot together: each shows in the results of `weavecell impact`, whatever the others are."""

import json
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from tests.scene_text import merged, toml
from weavecell.results.paraview import read_series

SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm", "strike_velocity": "400 m/s"},
    "panel": {"opening": "26 mm"},
    "run": {
        "end_time": "12 us", "snapshot_interval": "4 us", "checkpoint_interval": "6 us", "outputs": [],
        "elements_per_crossover": 1,
    },
}  # fmt: skip
BLOCK = {"size": ["60 mm", "60 mm", "30 mm"], "min_size": "2 mm", "growth": 1.5}
PULL = {"pull_in": "0.2 mm", "start": "0 us", "end": "10 us"}
NAMED = {"name": "FSP 1.10 g", "mass": None, "diameter": None, "edge_radius": None}
WHOLE = {"panel": {"symmetry": "whole"}}


def energy(name, least=1e-9):
    """Whether the energies of a name [J] at the end are above `least`."""
    return lambda shot, _: sum(abs(value) for key, value in shot.energies.items() if key.startswith(name)) > least


def elements(low, high):
    """Whether a ply has `low` to `high` times the elements of the plain shot."""
    return lambda shot, plain: low <= shot.elements / shot.plies / plain.elements <= high


def nine_times_the_steps(shot, plain):
    """The time step is a ninth of the plain one, whose Courant factor is 0.9."""
    return shot.steps / shot.end_time_s == pytest.approx(9 * plain.steps / plain.end_time_s, rel=0.025)


# option -> (what the scene says, whether a shot shows it, given the shot and the plain one)
OPTIONS = {
    "pack": (
        {"panel": {"plies": 2, "ply_gap": "0.05 mm"}},
        lambda shot, plain: shot.plies == 2 and shot.ply_gap_m == pytest.approx(5e-5),
    ),
    "turned": ({"panel": {"stacking": "alternating"}}, lambda shot, _: shot.stacking == "alternating"),
    "ply friction": ({"panel": {"ply_friction": 0.3}}, energy("ply_friction")),
    "backing": ({"backing": BLOCK}, energy("backing", 1e-6)),
    "oblique": (
        merged(WHOLE, {"projectile": {"obliquity": "30 deg"}}),
        lambda shot, _: shot.v[0] == pytest.approx(400 * np.cos(np.radians(30))),
    ),
    "named": ({"projectile": NAMED}, lambda shot, _: shot.projectile.startswith("FSP 1.10 g, ")),
    "bar": ({"projectile": {"body": "elastic_bar"}}, energy("elastic_projectile", 1e-6)),
    "nose friction": ({"projectile": {"friction": 0.3, "shape": "hemisphere"}}, energy("friction")),
    "grip": ({"panel": {"boundary": {"weft": {"clamp_force": "2 N"}}}}, energy("clamp_friction")),
    "pull-in": ({"panel": {"boundary": {"weft": PULL}}}, energy("boundary_work")),
    "free": ({"panel": {"boundary": "free"}}, lambda shot, plain: shot.reaction < 0.5 * plain.reaction),
    "weave angle": (merged(WHOLE, {"panel": {"weave_angle": "30 deg"}}), elements(4.01, float("inf"))),
    "round": ({"panel": {"opening_shape": "round"}}, lambda shot, plain: shot.v[-1] != plain.v[-1]),
    "off the middle": (merged(WHOLE, {"panel": {"impact_point": ["4 mm", "0 mm"]}}), elements(4.01, float("inf"))),
    "whole": (WHOLE, elements(4, 4)),
    "yarns hold": ({"panel": {"yarn_failure": False}}, lambda shot, plain: shot.failed == 0 < plain.failed),
    "graded": (
        {"panel": {"grading": [[8, 1], [float("inf"), 2]], "opening": "60 mm"}},
        lambda shot, _: shot.elements < 23**2 * shot.plies,
    ),
    "sliding": (
        {"panel": {"crossovers": "sliding", "crossover_friction": 0.1, "crossover_cohesion": "0.01 N"}},
        energy("crossover_friction"),
    ),
    "elements": ({"run": {"elements_per_crossover": 2}}, elements(4, 4)),
    "measure": ({"history": {"warp": ["0 mm", "2.6 mm"]}}, lambda shot, _: shot.followed == 3),
    "cfl": ({"numerics": {"cfl": 0.1}}, nine_times_the_steps),
    "viscosity": (
        {"numerics": {"stretch_viscosity": 0.2}},
        lambda shot, plain: shot.energies["viscous"] > plain.energies["viscous"],
    ),
    "law": ({"fabric": {"law": {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}}}, lambda shot, _: "scene" in shot.law_name),
    "bending": ({"fabric": {"bending": "1e-6 N m^2"}}, energy("bending")),
    "written": (
        {"title": "mine", "run": {"outputs": ["paraview"]}},
        lambda shot, _: (shot.title, shot.times) == ("mine", [4, 8, 12]),
    ),
    "accuracy": (
        {"accuracy": {"residual_velocity": "50 %"}},
        lambda shot, _: shot.accuracy["targets"] == {"residual_velocity": 0.5},
    ),
}  # fmt: skip
# chosen so that each option of the panel stands beside each of the shot that it may
TOGETHER = [
    "whole, written, viscosity", "cfl", "yarns hold, round",
    "pack, turned, ply friction, grip, measure",
    "pack, backing, bar, cfl",
    "pack, oblique, nose friction, free",
    "pack, weave angle, named, ply friction",
    "pack, graded, turned, pull-in",
    "pack, sliding, turned, nose friction",
    "pack, round, bending, turned",
    "pack, backing, off the middle, ply friction, yarns hold",
    "pack, elements, law, free",
    "oblique, bar, grip, bending",
    "oblique, sliding, measure, free",
    "oblique, weave angle, nose friction, yarns hold",
    "oblique, round, law, measure",
    "backing, nose friction, free",
    "backing, graded, measure, written",
    "backing, weave angle, bending",
    "bar, round, elements, law",
    "bar, sliding, free, written",
    "weave angle, off the middle, measure",
    "accuracy, pack, turned, ply friction, grip, measure",
    "accuracy, bar, bending",
]  # fmt: skip


@pytest.fixture
def shoot(command, tmp_path):
    """The results of `weavecell impact` with options, by name."""

    def run(*names):
        table = SHOT
        for name in names:
            table = merged(table, OPTIONS[name][0])
        folder, path = tmp_path / "r", tmp_path / "scene.toml"
        path.write_text(toml(table))
        code, _, err = command("impact", path, "--out", folder)
        assert code == 0, err
        summary = json.loads((folder / "summary.json").read_text())
        with h5py.File(folder / "histories.h5") as file:
            v = file["histories/velocity"][()]
            reaction = max(file[f"plies/histories/reaction_{side}"][()].max() for side in ("warp", "weft"))
            followed = len(file["measured/00/yarns"]) if "measured" in file else 0
        series = read_series(folder / "panel.pvd") if (folder / "panel.pvd").exists() else []
        more = {"energies": summary["energies_at_end_J"], "failed": summary["failed_yarn_segments"]}
        more |= {"v": v, "reaction": reaction, "followed": followed, "times": [round(1e6 * time) for _, time in series]}
        return SimpleNamespace(**{"stacking": "", "plies": 1} | summary | more)

    return run


@pytest.fixture(scope="module")
def known():
    return {}


@pytest.mark.parametrize("together", TOGETHER)
def test_options_show_together(shoot, known, together):
    if not known:
        known["plain"] = shoot()
    names = together.split(", ")
    shot = shoot(*names)
    assert [name for name in names if not OPTIONS[name][1](shot, known["plain"])] == []


def test_every_option_is_shot():
    assert {name for together in TOGETHER for name in together.split(", ")} == set(OPTIONS)
