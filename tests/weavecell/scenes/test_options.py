"""Options of a shot together: each shows in its record, whatever the others are."""

from functools import cache

import numpy as np
import pytest

import weavecell as wc
from tests.scene_text import merged
from tests.weavecell.session_runs import SCENES, set_up

FAST = {"projectile": {"strike_velocity": "400 m/s"}, "panel": {"opening": "26 mm"}}
SHOT = merged(SCENES["small"], FAST | {"run": {"end_time": "12 us", "elements_per_crossover": 1}})
BLOCK = {"size": ["60 mm", "60 mm", "30 mm"], "min_size": "2 mm", "growth": 1.5}
PULL = {"pull_in": "0.2 mm", "start": "0 us", "end": "10 us"}
NAMED = {"name": "FSP 1.10 g", "mass": None, "diameter": None, "edge_radius": None}
WHOLE = {"panel": {"symmetry": "whole"}}


def energy(name, least=1e-9):
    """Whether the energies of a name [J] at the end are above `least`."""
    return lambda shot, _: (
        sum(abs(part[-1]) for key, part in shot.energies.items() if key.startswith(name)) > least
    )


def elements(low, high):
    """Whether a ply has `low` to `high` times the elements of the plain shot."""
    return lambda shot, plain: low <= shot.elements / shot.count / plain.elements <= high


def nine_times_the_steps(shot, plain):
    """The time step is a ninth of the plain one, whose Courant factor is 0.9."""
    return shot.steps / shot.time[-1] == pytest.approx(9 * plain.steps / plain.time[-1], rel=0.025)


def far_edge(shot):
    """[m] place of the edge across the warp, whose clamped nodes stay where they are."""
    return shot.final[0].nodes[:, 0].max()


# option -> (what the scene says, whether a shot shows it, given the shot and the plain one)
OPTIONS = {
    "pack": (
        {"panel": {"plies": 2, "ply_gap": "0.05 mm"}},
        lambda shot, _: shot.count == 2 and shot.gaps == pytest.approx([5e-5]),
    ),
    "turned": (
        {"panel": {"stacking": "alternating"}},
        lambda shot, _: shot.pack["stacking"] == "alternating",
    ),
    "ply friction": ({"panel": {"ply_friction": 0.3}}, energy("ply_friction")),
    "backing": ({"backing": BLOCK}, energy("backing", 1e-6)),
    "oblique": (
        merged(WHOLE, {"projectile": {"obliquity": "30 deg"}}),
        lambda shot, _: shot.velocity[0] == pytest.approx(400 * np.cos(np.radians(30))),
    ),
    "named": ({"projectile": NAMED}, lambda shot, _: shot.mass == pytest.approx(1.1e-3)),
    "bar": ({"projectile": {"body": "elastic_bar"}}, energy("elastic_projectile", 1e-6)),
    "nose friction": ({"projectile": {"friction": 0.3, "shape": "hemisphere"}}, energy("friction")),
    "grip": ({"panel": {"boundary": {"weft": {"clamp_force": "2 N"}}}}, energy("clamp_friction")),
    "pull-in": ({"panel": {"boundary": {"weft": PULL}}}, energy("boundary_work")),
    "free": (
        {"panel": {"boundary": "free"}},
        lambda shot, plain: far_edge(shot) < far_edge(plain) - 1e-6,
    ),
    "weave angle": (
        merged(WHOLE, {"panel": {"weave_angle": "30 deg"}}),
        elements(4.01, float("inf")),
    ),
    "round": (
        {"panel": {"opening_shape": "round"}},
        lambda shot, plain: shot.velocity[-1] != plain.velocity[-1],
    ),
    "off the middle": (
        merged(WHOLE, {"panel": {"impact_point": ["4 mm", "0 mm"]}}),
        elements(4.01, float("inf")),
    ),
    "whole": (WHOLE, elements(4, 4)),
    "yarns hold": (
        {"panel": {"yarn_failure": False}},
        lambda shot, plain: shot.cut_yarns[-1] == 0 < plain.cut_yarns[-1],
    ),
    "graded": (
        {"panel": {"grading": [[8, 1], [float("inf"), 2]], "opening": "60 mm"}},
        lambda shot, _: shot.elements < 23**2 * shot.count,
    ),
    "elements": ({"run": {"elements_per_crossover": 2}}, elements(4, 4)),
    "measure": (
        {"history": {"warp": ["0 mm", "2.6 mm"]}},
        lambda shot, _: len(shot.measured[0].yarns) == 3,
    ),
    "cfl": ({"numerics": {"cfl": 0.1}}, nine_times_the_steps),
    "viscosity": (
        {"numerics": {"stretch_viscosity": 0.2}},
        lambda shot, plain: shot.energies["viscous"][-1] > plain.energies["viscous"][-1],
    ),
    "law": (
        {"fabric": {"law": {"a": "0.01 mm", "b": "0.02 mm N^(1/3)"}}},
        lambda shot, plain: shot.velocity[-1] != plain.velocity[-1],
    ),
    "bending": ({"fabric": {"bending": "1e-6 N m^2"}}, energy("bending")),
}
# chosen so that each option of the panel stands beside each of the shot that it may
TOGETHER = [
    "whole, viscosity",
    "cfl",
    "yarns hold, round",
    "pack, turned, ply friction, grip, measure",
    "pack, backing, bar, cfl",
    "pack, oblique, nose friction, free",
    "pack, weave angle, named, ply friction",
    "pack, graded, turned, pull-in",
    "pack, turned, nose friction",
    "pack, round, bending, turned",
    "pack, backing, off the middle, ply friction, yarns hold",
    "pack, elements, law, free",
    "oblique, bar, grip, bending",
    "oblique, measure, free",
    "oblique, weave angle, nose friction, yarns hold",
    "oblique, round, law, measure",
    "backing, nose friction, free",
    "backing, graded, measure",
    "backing, weave angle, bending",
    "bar, round, elements, law",
    "bar, free",
    "weave angle, off the middle, measure",
]


@cache
def record(together):
    """The record of the shot with options, by name."""
    table = SHOT
    for name in together.split(", ") if together else ():
        table = merged(table, OPTIONS[name][0])
    return wc.sweep([set_up(table)])[0]


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
@pytest.mark.parametrize("together", TOGETHER)
def test_options_show_together(together):
    shot = record(together)
    assert [name for name in together.split(", ") if not OPTIONS[name][1](shot, record(""))] == []


def test_every_option_is_shot():
    assert {name for together in TOGETHER for name in together.split(", ")} == set(OPTIONS)
