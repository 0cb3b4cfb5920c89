"""Fabric of graded panels that comes under the projectile from beyond the fine mesh, and free fabric before a block,
whose mesh is graded too."""

from dataclasses import replace

import numpy as np
import pytest
from panels import BLOCK

from fabrics.catalogue import load
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane import quality
from shellfabric.projectile.projectile import Projectile

INF = float("inf")
RADIUS = 2.4e-3
ZONES = ((9, 1), (INF, 2))


def make_setup(**changes):
    given = {
        "projectile": Projectile(mass=0.5e-3, radius=RADIUS, shape="sphere"),
        "opening": 0.05,
        "table_size": 21,
    }
    return ImpactSetup(load("S-727"), 60.0, **given | changes)


def put_in_the_nose(solver, node, depth, height):
    """Move a node to this depth [m] in a sphere whose tip is at (0.3, -0.2, 4) mm, at the height [m] behind the tip."""
    (_, const, state) = solver.plies[0]
    tip = np.array([0.3e-3, -0.2e-3, 4e-3])
    state.projectile_position[:] = tip
    from_middle = RADIUS - depth
    along = np.sqrt(from_middle**2 - (RADIUS - height) ** 2)
    place = tip + np.array([0.6 * along, -0.8 * along, -height])
    x, y = (part[node] for part in solver.panel.coordinates())
    slot = node[0] * const.row_stride + node[1]
    for u, moved in zip(state.u, place - [x, y, 0.0]):
        u[slot] = moved


@pytest.mark.parametrize("symmetry", ["quarter", "whole"])
@pytest.mark.parametrize("beyond, depth", [(1, 0.7e-3), (2, 0.31e-3)])
def test_the_depth_of_coarse_fabric_is_that_of_its_node_in_the_nose(symmetry, beyond, depth):
    solver = PackSolver(make_setup(grading=ZONES, symmetry=symmetry).target(), 60.0, 1e-6)
    (_, end, j0, j1) = solver.const.window_limits
    put_in_the_nose(solver, (end + beyond, (j0 + j1) // 2), depth, 1.9e-3)
    solver.monitor._sample_coarse_fabric(solver)
    (check,) = (one for one in quality.of_solver(solver) if one.name == "coarse fabric in the nose")
    assert check.value == pytest.approx(depth / RADIUS, rel=1e-9)
    assert check.doubtful


def test_the_deepest_of_all_samples_counts():
    solver = PackSolver(make_setup(grading=ZONES).target(), 60.0, 1e-6)
    (_, end, j0, j1) = solver.const.window_limits
    seen = []
    for depth in (0.31e-3, 0.7e-3, 0.11e-3):
        put_in_the_nose(solver, (end + 1, (j0 + j1) // 2), depth, 1.9e-3)
        solver.monitor._sample_coarse_fabric(solver)
        seen.append(solver.monitor.coarse_depth.max())
    assert seen == pytest.approx([0.31e-3, 0.7e-3, 0.7e-3], rel=1e-9)


@pytest.mark.parametrize(
    "mesh, beyond", [({"grading": ZONES}, 0), ({"elements_per_crossover": 1}, 1)]
)
def test_fabric_that_touches_the_nose_is_not_coarse(mesh, beyond):
    """Of the contact window itself, and of a uniform panel."""
    solver = PackSolver(make_setup(**mesh).target(), 60.0, 1e-6)
    (_, end, j0, j1) = solver.const.window_limits
    put_in_the_nose(solver, (end - 1 + beyond, (j0 + j1) // 2), 0.7e-3, 1.9e-3)
    solver.monitor._sample_coarse_fabric(solver)
    assert solver.monitor.coarse_depth.max() == 0.0


@pytest.mark.parametrize(
    "changes, graded",
    [
        ({"boundary": "free", "backing": BLOCK}, True),
        ({"boundary": ("free", ("free", "free")), "backing": BLOCK, "plies": 3}, True),
        ({"boundary": "free"}, False),
        ({"boundary": ("clamped", "free"), "backing": BLOCK}, False),
        (
            {
                "boundary": "free",
                "backing": BLOCK,
                "symmetry": "whole",
                "impact_point": (4e-3, 0.0),
            },
            False,
        ),
    ],
)
def test_free_fabric_before_a_block_has_the_mesh_of_clamped_fabric(changes, graded):
    setup = make_setup(**changes)
    clamped = replace(setup, boundary="clamped")
    if graded:
        assert setup.meshed.grading == clamped.meshed.grading is not None
        assert setup.panel(setup.plain_table()).elements < 1000
    else:
        assert setup.meshed.grading is None


def test_free_fabric_before_a_block_moves_as_on_a_mesh_that_is_fine_everywhere():
    """The projectile is slowed down to less than a half, and fabric is drawn in."""
    setup = make_setup(boundary="free", backing=BLOCK, grading=ZONES, end_time=60e-6)
    velocities = []
    for one in (setup, replace(setup, grading=None, elements_per_crossover=1)):
        solver = PackSolver(one.target(), 60.0, one.end_time).run()
        velocities.append(solver.sample("v")[-1])
    assert velocities[0] < 30.0
    assert velocities[0] == pytest.approx(velocities[1], abs=0.01 * 60.0)
    assert velocities[0] != velocities[1]


def test_a_short_run_says_that_a_block_carries_free_fabric_along():
    short = make_setup(boundary="free", backing=BLOCK, end_time=400e-6)
    (note,) = (line for line in short.notes if "free edges" in line)
    assert "400 us" in note
    for changes in ({"end_time": 2e-3}, {"boundary": "clamped"}, {"backing": None}):
        assert not any("free edges" in line for line in replace(short, **changes).notes)
