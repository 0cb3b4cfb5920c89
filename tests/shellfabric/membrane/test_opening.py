"""The opening between the edges of a panel is the one that was asked for, whatever the weave and the mesh."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from panels import table

from fabrics import catalogue
from shellfabric.impact.setup import OPENING_ERROR, ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from weavecell.decks import ls_dyna, model

NAMES = catalogue.list_names()


def fabric_of(name, warp, weft):
    """A fabric of the catalogue with other counts of its yarns."""
    fabric = catalogue.load(name)
    weave = fabric.weave
    counts = {"warp_count": warp * weave.warp_count, "weft_count": weft * weave.weft_count}
    return replace(fabric, weave=replace(weave, **counts))


def setup_of(fabric, **changes):
    """A shot at one ply of a fabric, which needs no law of its yarns."""
    small = Projectile(radius=1.5e-3, edge_radius=0.3e-3)
    given = {"strike_velocity": 90.0, "projectile": small, "cell_model": "decoupled"}
    return ImpactSetup(fabric=fabric, **given | changes)


def edges(panel):
    """(2,) [m] between the lines at the edges of the whole panel, its modelled part mirrored."""
    found = []
    for x, mirrored in zip(panel.lines(), panel.mirrors):
        found.append(2 * x[-1] if mirrored else x[-1] - x[0])
    return np.array(found)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    name=st.sampled_from(NAMES),
    counts=st.tuples(st.floats(0.6, 1.6), st.floats(0.6, 1.6)),
    sides=st.tuples(st.floats(0.03, 0.4), st.floats(0.03, 0.4)),
    mesh=st.sampled_from([{}, {"elements_per_crossover": 1}, {"elements_per_crossover": 3}]),
    symmetry=st.sampled_from(["quarter", "half", "whole"]),
    boundary=st.sampled_from(["clamped", "free"]),
)
def test_every_panel_has_its_opening(name, counts, sides, mesh, symmetry, boundary):
    """Graded (the default of clamped edges) or not, and for every modelled part on the same lines."""
    fabric = fabric_of(name, *counts)
    # four crossovers at least, and those under the nose
    assume(min(sides) > 16 * max(fabric.weave.w))
    setup = setup_of(fabric, opening=sides, boundary=boundary, **mesh)
    whole = replace(setup, symmetry="whole")
    panels = [one.panel(one.plain_table()) for one in (replace(setup, symmetry=symmetry), whole)]
    for panel in panels:
        assert_allclose(edges(panel), sides, rtol=1e-9)
        assert_allclose(panel.held_opening, sides, rtol=1e-9)
    area = np.prod(sides)
    assert panels[0].areas.sum() / panels[0].share == pytest.approx(area, rel=1e-9)
    for mine, all_of_them, mirrored in zip(panels[0].lines(), panels[1].lines(), panels[0].mirrors):
        half = all_of_them[all_of_them.size // 2 :] if mirrored else all_of_them
        assert_allclose(mine, half, rtol=0, atol=1e-12)


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    side=st.floats(0.08, 0.3),
    along=st.floats(-0.3, 0.3),
    across=st.floats(-0.3, 0.3),
    mesh=st.sampled_from([{}, {"elements_per_crossover": 1}, {"elements_per_crossover": 3}]),
)
def test_a_panel_struck_off_its_middle_has_its_edges_where_they_are_given(
    side, along, across, mesh
):
    """Its edges lie at different distances from the impact point, all on lines of the grid."""
    struck = np.array([along, across]) * side
    changes = {"opening": side, "impact_point": tuple(struck), "symmetry": "whole"} | mesh
    setup = setup_of(table().model.fabric, **changes)
    panel = setup.panel(setup.plain_table())
    assert_allclose(panel.held_opening, side, rtol=1e-9)
    for x, middle in zip(panel.lines(), struck):
        for edge in (-0.5 * side, 0.5 * side):
            assert np.abs(x + middle - edge).min() < 1e-9 * side


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    crossings=st.integers(6, 30),
    spacings=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
    resolved=st.booleans(),
)
def test_a_panel_is_struck_where_it_is_aimed_at_on_the_weave(crossings, spacings, resolved):
    """With elements that are all alike: pinned or resolved, a crossover lies in the middle of an opening of
    an even number of spacings, and the others around it."""
    spacing = 2 * np.array(table().model.fabric.weave.w)
    crossings *= 2
    changes = {"opening": tuple(crossings * spacing), "symmetry": "whole"}
    changes |= {"impact_point": tuple(spacings * spacing), "elements_per_crossover": 1}
    if resolved:
        changes |= {"crossovers": YarnZone(half_width=np.inf), "cell_model": "compressible"}
        assume(crossings > 2 * np.abs(spacings).max() + 12)
    setup = setup_of(table().model.fabric, **changes)
    panel = setup.panel(setup.plain_table())
    for x, aim, step in zip(panel.lines(), spacings, spacing):
        crossovers = x / step + aim
        assert_allclose(crossovers, np.round(crossovers), atol=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"round": True},
        {"weave_angle": 0.5, "symmetry": "whole"},
    ],
)
def test_an_edge_that_follows_yarns_is_told(changes):
    """Of a staircase the held nodes are counted by hand: all that do not move."""
    setup = setup_of(table().model.fabric, opening=0.12, **changes)
    (line,) = [note for note in setup.notes if "in place of" in note]
    panel = setup.panel(setup.plain_table())
    assert abs(np.array(panel.held_opening) / 0.12 - 1).max() > OPENING_ERROR
    assert f"{1e3 * panel.held_opening[0]:.1f} by {1e3 * panel.held_opening[1]:.1f} mm" in line
    assert "in place of 120.0 by 120.0" in line


@pytest.mark.parametrize("opening", [0.16, 0.15, 0.12])
def test_a_deck_has_the_opening(opening):
    setup = setup_of(table().model.fabric, opening=opening, cell_model="compressible")
    deck = model.build(setup, ls_dyna, "kg-m-s", "plane", title="S-720, 90 m/s", source="published")
    x, y, _ = deck.plies[0].points.T
    assert 2 * x.max() == pytest.approx(opening, rel=1e-9)
    assert 2 * y.max() == pytest.approx(opening, rel=1e-9)
    lines = "".join(ls_dyna.write(deck, "ply").values()).splitlines()
    titles = [after for line, after in pairwise(lines) if line.endswith("TITLE")]
    assert titles
    assert not any("," in title for title in titles)
