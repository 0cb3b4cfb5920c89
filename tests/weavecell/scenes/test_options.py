"""Options of a shot together: each shows in its record, whatever the others are."""

import tomllib
from functools import cache

import numpy as np
import pytest
from test_keys_reach import read

import weavecell as wc
from tests.scene_text import merged
from tests.weavecell.session_runs import SCENES, set_up

FAST = {
    "projectile": {"strike_velocity": "400 m/s"},
    "panel": {"opening": "26 mm", "crossovers": "pinned"},
}
SHOT = merged(SCENES["small"], FAST | {"run": {"end_time": "12 us", "elements_per_crossover": 1}})
# option: what the scene says; "" takes a key away
OPTIONS = read(
    tomllib.loads("""
pack = { panel = { plies = 2, ply_gap = "0.05 mm" } }
turned = { panel = { stacking = "alternating" } }
"ply friction" = { panel = { ply_friction = 0.3 } }
backing = { backing = { modulus = "100 MPa", size = ["60 mm", "60 mm", "30 mm"], min_size = "3 mm", growth = 1.5 } }
oblique = { panel = { symmetry = "whole" }, projectile = { obliquity = "30 deg" } }
named = { projectile = { name = "FSP 1.10 g", mass = "", diameter = "", edge_radius = "" } }
bar = { projectile = { body = "elastic_bar" } }
"nose friction" = { projectile = { friction = 0.3, shape = "hemisphere" } }
grip = { panel = { boundary = { weft = { clamp_force = "2 N" } } } }
"pull-in" = { panel = { boundary = { weft = { pull_in = "0.2 mm", start = "0 us", end = "10 us" } } } }
free = { panel = { boundary = "free" } }
"weave angle" = { panel = { symmetry = "whole", weave_angle = "30 deg" } }
round = { panel = { opening_shape = "round" } }
"off the middle" = { panel = { symmetry = "whole", impact_point = ["4 mm", "0 mm"] } }
whole = { panel = { symmetry = "whole" } }
"yarns hold" = { panel = { yarn_failure = false } }
graded = { panel = { grading = [[8, 1], [inf, 2]], opening = "60 mm" } }
elements = { run = { elements_per_crossover = 2 } }
measure = { history = { warp = ["0 mm", "2.6 mm"] } }
cfl = { numerics = { cfl = 0.1 } }
viscosity = { numerics = { stretch_viscosity = 0.2 } }
law = { fabric = { law = { a = "0.01 mm", b = "0.02 mm N^(1/3)" } } }
bending = { fabric = { bending = "1e-6 N m^2" } }
""")
)


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


def another_velocity(shot, plain):
    return shot.velocity[-1] != plain.velocity[-1]


def off_the_middle(shot, plain):
    """Places are from the impact point: the middle of the grid is beside it, or the grid reaches further."""
    places = shot.final[0].nodes[:, 0]
    beside = 0.5 * (places.min() + places.max()) == pytest.approx(-4e-3, abs=1e-5)
    return beside or elements(4.01, np.inf)(shot, plain)


def far_edge(shot):
    """[m] place of the edge across the warp, whose clamped nodes stay where they are."""
    return shot.final[0].nodes[:, 0].max()


# option: whether a shot shows it, given the shot and the plain one
SHOWN = {
    "pack": lambda shot, _: shot.count == 2 and shot.gaps == pytest.approx([5e-5]),
    "turned": lambda shot, _: shot.pack["stacking"] == "alternating",
    "ply friction": energy("ply_friction"),
    "backing": energy("backing", 1e-6),
    "oblique": lambda shot, _: shot.velocity[0] == pytest.approx(400 * np.cos(np.radians(30))),
    "named": lambda shot, _: shot.mass == pytest.approx(1.1e-3),
    "bar": energy("elastic_projectile", 1e-6),
    "nose friction": energy("friction"),
    "grip": energy("clamp_friction"),
    "pull-in": energy("boundary_work"),
    "free": lambda shot, plain: far_edge(shot) < far_edge(plain) - 1e-6,
    "weave angle": elements(4.01, np.inf),
    "round": another_velocity,
    "off the middle": off_the_middle,
    "whole": elements(4, 4),
    "yarns hold": lambda shot, plain: shot.cut_yarns[-1] == 0 < plain.cut_yarns[-1],
    "graded": lambda shot, _: shot.elements < 23**2 * shot.count,
    "elements": elements(4, 4),
    "measure": lambda shot, _: len(shot.measured[0].yarns) == 3,
    "cfl": nine_times_the_steps,
    "viscosity": lambda shot, plain: shot.energies["viscous"][-1] > plain.energies["viscous"][-1],
    "law": another_velocity,
    "bending": energy("bending"),
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
        table = merged(table, OPTIONS[name])
        # a grading says how large the elements are
        if name == "graded":
            table = merged(table, {"run": {"elements_per_crossover": None}})
    return wc.sweep([set_up(table)])[0]


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
@pytest.mark.parametrize("together", TOGETHER)
def test_options_show_together(together):
    shot = record(together)
    assert [name for name in together.split(", ") if not SHOWN[name](shot, record(""))] == []


def test_every_option_is_shot():
    assert (
        {name for together in TOGETHER for name in together.split(", ")}
        == set(OPTIONS)
        == set(SHOWN)
    )
