"""Yarns that differ in strength: what is drawn, the shot without scatter, and a sweep over seeds."""

from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.impact.strengths import YarnStrength, draw_strengths
from shellfabric.yarns.model import YarnZone
from weavecell.answers.v50 import V50Result
from weavecell.runs import table
from weavecell.studies import inputs, strengths

ALIKE_BUT_STRENGTH = replace(inputs.read_scatter(), modulus=0.0, crimp=0.0)

# frictions that are given
NOT_DRAWN = dict.fromkeys(("friction_between_yarns", "friction_on_nose", "friction_between_plies"))


@pytest.fixture(scope="module")
def setup(fabric):
    return ImpactSetup(fabric, 90.0, opening=0.03048, end_time=60e-6, table_size=51)


def test_every_yarn_of_every_ply_is_drawn(setup):
    """Ply p of draw k has the strengths of number k N + p: no two are alike, and none depends on the others."""
    given = replace(setup, elements_per_crossover=1, plies=2, stacking="alternating", ply_gap=1e-4)
    drawn = strengths.draw_panel(given, ALIKE_BUT_STRENGTH, 7, 3)
    first, second = drawn.pack.plies
    for p, ply in enumerate((first, second)):
        wanted = draw_strengths(14.3, 7, 6 + p, ply.yarn_counts)
        assert_array_equal(ply.strength_factors[0], wanted[0])
    assert drawn.weakest[0] == min(ply.strength_factors[0].min() for ply in (first, second))
    assert not np.isin(second.strength_factors[0], first.strength_factors[0]).any()
    assert drawn.factors == {"modulus": 1.0, "crimp_warp": 1.0, "crimp_weft": 1.0}
    whole = replace(given, symmetry="whole", strength=YarnStrength(14.3, seed=7))
    of_a_scene = whole.target()
    of_a_v50 = strengths.draw_panel(given, ALIKE_BUT_STRENGTH, 7, 0).pack
    for one, other in zip(of_a_scene.plies, of_a_v50.plies):
        assert_array_equal(one.strength_factors[1], other.strength_factors[1])


def test_resolved_yarns_are_struck_at_another_point_in_each_draw(setup):
    """Within a spacing of the crossover that is nearest to the impact point of the set-up."""
    aim = (1e-4, 2e-4)
    given = replace(setup, opening=0.04, impact_point=aim, crossovers=YarnZone(8e-3))
    drawn = [strengths.draw_panel(given, ALIKE_BUT_STRENGTH, 7, number).pack for number in range(4)]
    points = [pack.plies[0].impact_point for pack in drawn]
    assert len(set(points)) == 4
    spacing = drawn[0].plies[0].spacing
    assert np.all(abs(np.array(points)) <= spacing)
    again = strengths.draw_panel(given, ALIKE_BUT_STRENGTH, 7, 2).pack
    assert again.plies[0].impact_point == points[2]


def test_shots_at_resolved_yarns_have_their_impact_points(setup):
    """Drawn points are in the table of shots; of pinned yarns, all struck at one point, they are not."""
    drawn_there = {"impact_point": (1e-4, -2e-4), "weakest": (0.9, 0.8)}
    shot = table.Shot(90.0, 0.0, False, 0, **drawn_there, balance=1e-3)
    columns = {}
    for crossovers in (YarnZone(), None):
        target = SimpleNamespace(setup=replace(setup, crossovers=crossovers))
        result = V50Result(SimpleNamespace(shots=[shot]), target, 1, 1, 0.0)
        columns[crossovers] = result.to_dataframe()
    drawn = columns[YarnZone()]
    assert (drawn.impact_point_x_m[0], drawn.impact_point_y_m[0]) == (1e-4, -2e-4)
    assert (drawn.weakest_warp[0], drawn.weakest_weft[0]) == (0.9, 0.8)
    assert not [name for name in columns[None] if "impact" in name]


def test_plies_of_a_draw_are_of_one_roll(setup):
    """Modulus and crimp are one value for all plies of a draw, and scale the laws that a set-up names as well."""
    given = replace(setup, elements_per_crossover=1, plies=2, ply_gap=1e-4)
    drawn = strengths.draw_panel(given, inputs.read_scatter(), 7, 3)
    one, other = drawn.pack.plies
    assert one.fabric == other.fabric
    assert one.fabric.weave.warp.E == pytest.approx(
        setup.fabric.weave.warp.E * drawn.factors["modulus"]
    )
    assert drawn.factors["modulus"] != 1
    laws = inputs.scale_setup(replace(setup, laws=setup.fabric.laws), compression_a=2.0).laws
    assert laws[0].a == 2 * setup.fabric.laws[0].a


def test_yarns_of_one_strength_make_the_plain_shot(setup):
    whole = replace(setup, symmetry="whole")
    plain, drawn = map(run_impact, (whole, replace(whole, strength=YarnStrength(inf))))
    assert drawn.residual_velocity == plain.residual_velocity
    assert drawn.peak_tension == plain.peak_tension


def test_strengths_are_of_whole_panels_that_fail(setup):
    with pytest.raises(InputError, match="symmetry = 'quarter': must be whole"):
        replace(setup, strength=YarnStrength(14.3))
    with pytest.raises(InputError, match="strength: must be left out: the yarns do not fail"):
        replace(setup, symmetry="whole", yarn_failure=False, strength=YarnStrength(14.3))
    assert wc.setup("S-720", "90 m/s", strength={"weibull_shape": 14.3}).symmetry == "whole"


def test_a_deck_has_one_strength(tmp_path):
    setup = wc.setup("S-720", "90 m/s", opening="20 mm", strength={"weibull_shape": 14.3})
    with pytest.raises(InputError, match="left out: cards have one strength"):
        wc.export(setup, "lsdyna", tmp_path / "deck")
    assert not (tmp_path / "deck").exists()
