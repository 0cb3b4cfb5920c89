"""Properties of cells, panels and projectiles that hold for every fabric and shot of `tests.fuzz.scenes`.

The cheap part of the fuzzing: no step of a march is made. A failing example is shrunk by hypothesis; write it as files
for `weavecell impact` with `scene.write(folder)`.
"""

import tempfile

import numpy as np
import pytest
from hypothesis import given, note
from hypothesis import strategies as st

from shellfabric.cell.model import CellModel
from tests.fuzz import runs, scenes
from tests.scene_text import toml

SHARE = st.floats(0, 1)
PLACE = st.tuples(SHARE, SHARE)


def setup_of(scene):
    note(toml(scene.scene) + toml(scene.fabric))
    with tempfile.TemporaryDirectory() as folder:
        return runs.setup_of(scene.write(folder))[1]


def model_of(setup):
    return CellModel(
        setup.fabric, setup.laws, setup.crossover_gap, setup.cell_model, setup.cell_formulation
    )


def stretches(model, place):
    return tuple(low + share * (high - low) for (low, high), share in zip(model.range(), place))


def test_a_scene_is_named_by_seed_and_index(tmp_path):
    one, again, other = (scenes.scene(7, k) for k in (3, 3, 4))
    assert one == again
    assert one.fabric != other.fabric
    asked, setup = runs.setup_of(one.write(tmp_path))
    assert asked.title == setup.fabric.name.rpartition("-")[0] == "fuzz-7-3"


@given(scenes.scenes(), st.lists(PLACE, min_size=4, max_size=4))
def test_tensions_are_not_negative_and_forces_are_the_gradient(scene, places):
    model = model_of(setup_of(scene))
    weave = model.fabric.weave
    x, y = np.array([stretches(model, place) for place in places]).T
    found = model.solve(x, y)
    step = 1e-6
    for key, yarn in zip(("T1", "T2"), weave.yarns):
        assert np.all(found[key] >= -1e-9 * yarn.strength)
    assert np.all(found["W"] >= -1e-12 * weave.warp.strength * weave.w1)
    if model.cell_formulation == "equilibrium":
        return
    for key, (a, b), w, yarn in (
        ("N1", (step, 0), weave.w1, weave.warp),
        ("N2", (0, step), weave.w2, weave.weft),
    ):
        ahead = model.solve(x + a, y + b)
        behind = model.solve(x - a, y - b)
        slope = (ahead["W"] - behind["W"]) / (4 * w * step)
        # a kink, where contact begins or a yarn is straight
        bend = abs(ahead[key] + behind[key] - 2 * found[key])
        assert np.all(abs(slope - found[key]) <= 1e-5 * yarn.strength + bend)


@given(scenes.scenes(), PLACE, PLACE)
def test_a_yarn_that_is_stretched_further_is_not_slacker(scene, one, other):
    """At the other's stretch, of a tension and of the force conjugate to it."""
    model = model_of(setup_of(scene))
    x1, y1 = stretches(model, one)
    x2, y2 = stretches(model, other)
    for family, yarn in enumerate(model.fabric.weave.yarns):
        ends = ((x1, y1), (x2, y1)) if family == 0 else ((x1, y1), (x1, y2))
        low, high = (model.solve(*end) for end in sorted(ends, key=lambda end: end[family]))
        assert high[f"T{family + 1}"] >= low[f"T{family + 1}"] - 1e-9 * yarn.strength


@given(scenes.scenes())
def test_table_and_panel(scene):
    """The table is finite, fabric at rest has no forces, and the panel's step is a positive share of its bound."""
    setup = setup_of(scene)
    assert 20 <= setup.strike_velocity <= 700
    assert 0.199 <= 1e3 * setup.projectile.mass <= 20.01
    table = model_of(setup).table(41)
    for values in (
        *table.values.values(),
        table.spline,
        table.tension1,
        table.tension2,
    ):
        assert np.isfinite(values).all()
    rest = table.model.solve(1.0, 1.0)
    for family, yarn in enumerate(setup.fabric.weave.yarns):
        assert abs(rest[f"N{family + 1}"]) <= 1e-9 * yarn.strength
    panel = setup.panel(table)
    assert 0 < panel.time_step <= panel.critical_step < 1e-5
    assert panel.elements > 0
    assert np.all(panel.masses() > 0)


@given(scenes.scenes(), st.lists(st.tuples(*[st.floats(-3, 3)] * 3), min_size=6, max_size=6))
def test_distance_of_a_projectile(scene, points):
    """Signed, with a gradient of length 1, and changing by no more than the step; the body starts at the panel.

    Inside, on the axis, where the nearest side may be any, the gradient may be 0.
    """
    shot = setup_of(scene).projectile
    places = shot.radius * np.array(points)
    found = [shot.distance(place) for place in places]
    for place, (distance, gradient) in zip(places, found):
        assert np.isfinite(distance)
        of_the_axis = distance < 0 and np.linalg.norm(np.cross(place, shot.frame[2])) < 1e-12
        assert np.linalg.norm(gradient) == pytest.approx(1, abs=1e-9) or of_the_axis
    for a in range(len(places)):
        step = np.linalg.norm(places[a] - places[a - 1])
        assert abs(found[a][0] - found[a - 1][0]) <= step + 1e-12
    inside = -(shot.shoulder + 0.1 * shot.radius) * shot.frame[2]
    assert shot.distance(inside)[0] < 0
    assert shot.start()[2] <= 1e-12
    assert shot.top >= 0
