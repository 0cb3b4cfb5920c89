"""The strength of yarns at their length in the panel: (gauge length / length)^(1 / shape) times the stated one."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import weavecell as wc
from fabrics import data_sheet
from fabrics.fabric import Fabric
from shellfabric.impact.setup import ImpactSetup, Ply
from shellfabric.impact.strengths import YarnStrength
from shellfabric.membrane.yarn_lengths import find_yarn_lengths
from shellfabric.plies.model import Pack
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from tests import unlike

SIDES = (0.050, 0.036)  # [m] along warp and weft
BALL = Projectile(shape="sphere", radius=2.5e-3)


def made(**changes) -> ImpactSetup:
    fabric = replace(unlike.fabric(), gauge_length=0.31, weibull_shape=9.0)
    given = {"opening": SIDES, "projectile": BALL, "elements_per_crossover": 1, "table_size": 21}
    return ImpactSetup(fabric, 60.0, **given | changes)


def strength(fabric: Fabric, family: int, length: float) -> float:
    """Of a yarn that is straight over `length` [m] once its crimp is gone."""
    yarn = fabric.weave.yarns[family]
    longer = (1 + yarn.crimp) * length
    return yarn.failure_strain * yarn.EA * (0.31 / longer) ** (1 / 9.0)


def of_middle(panel):
    """(warp, weft) strengths that the criterion has for the lines in the middle."""
    const = panel.constants()
    return [
        float(lines.strength[lines.strength.size // 2])
        for lines in (const.warp_lines, const.weft_lines)
    ]


def test_the_assumed_numbers_are_those_of_a_fabric_without_its_own():
    known = data_sheet.entries()
    plain = Fabric("plain", unlike.fabric().weave)
    assert plain.gauge_length == known["gauge_length"].value
    assert plain.weibull_shape == known["weibull_shape"].value
    of_catalogue = wc.fabric("S-728")
    for key in ("gauge_length", "weibull_shape"):
        assert getattr(of_catalogue, key) == known[key].value
        assert of_catalogue.sources[key]["status"] == "assumed"


def test_a_fabric_file_gives_its_own(tmp_path):
    path = tmp_path / "own.toml"
    yarn = 'linear_density = "1100 dtex"\nfibre_density = "1.44 g/cm^3"\nmodulus = "90 GPa"\nfailure_strain = "3.3 %"\n'
    tables = "".join(
        f'[{name}]\n{yarn}crimp = "1 %"\ncount = "8 / cm"\n' for name in ("warp", "weft")
    )
    path.write_text(f'gauge_length = "250 mm"\nweibull_shape = 9.5\n{tables}')
    own = wc.fabric(path)
    assert (own.gauge_length, own.weibull_shape) == (0.25, 9.5)
    assert own.sources["weibull_shape"]["status"] == "user"


@pytest.mark.parametrize("symmetry", ["quarter", "half", "other half", "whole"])
@pytest.mark.parametrize("boundary", ["clamped", ("clamped", "free")])
def test_yarns_have_the_strength_of_whole_yarns_whatever_part_is_modelled(symmetry, boundary):
    setup = made(symmetry=symmetry, boundary=boundary)
    panel = setup.panel()
    expected = [strength(setup.fabric, family, SIDES[family]) for family in (0, 1)]
    assert_allclose(of_middle(panel), expected, rtol=1e-12)
    assert_allclose(panel.strengths, expected, rtol=1e-12)
    state = panel.state(1.0)
    assert not np.any(state.failed)


def test_meshes_and_draws_without_scatter_are_alike():
    setup = made(symmetry="whole")
    expected = of_middle(setup.panel())
    for mesh in ({"elements_per_crossover": 2}, {"grading": ((9, 0.5), (np.inf, 1))}):
        changed = replace(setup, **{"elements_per_crossover": None} | mesh)
        assert of_middle(changed.panel()) == expected
    drawn = replace(setup, strength=YarnStrength(np.inf)).target().plies[0]
    for one, other in zip(all_strengths(drawn), all_strengths(setup.panel())):
        assert_array_equal(one, other)


def all_strengths(panel):
    const = panel.constants()
    return const.warp_lines.strength, const.weft_lines.strength


def test_the_stated_strength_is_taken_without_the_effect():
    """To the bit."""
    setup = made(length_effect=False)
    panel = setup.panel()
    assert of_middle(panel) == [yarn.strength for yarn in setup.fabric.weave.yarns]
    assert panel.length_factors == (1.0, 1.0)
    assert "times that" not in setup.failure_in_words(False)


def test_unlike_plies_have_the_strength_of_their_own_fabric_and_length():
    first, second, _ = (
        replace(one, gauge_length=0.31, weibull_shape=9.0) for one in unlike.fabrics()
    )
    turned = Ply(second, angle=0.5 * np.pi, gap=1e-4)
    setup = made(lay_up=(Ply(first, gap=1e-4), turned), plies=2, symmetry="whole")
    pack: Pack = setup.target()
    assert_allclose(of_middle(pack.plies[0]), [strength(first, k, SIDES[k]) for k in (0, 1)])
    # the warp of the turned ply is the weft of its panel
    along = strength(second, 1, SIDES[0]), strength(second, 0, SIDES[1])
    assert_allclose(of_middle(pack.plies[1]), along)
    words = setup.failure_in_words(False)
    assert f"{along[1]:.0f} / {along[0]:.0f} N (second, warp / weft; " in words


def test_resolved_yarns_have_the_strength_of_pinned_ones():
    setup = made(symmetry="whole", crossovers=YarnZone(8e-3, friction=0.2))
    panel = setup.panel()
    zone = panel.zone()
    for family in (0, 1):
        n = zone.first[family] + 2 * zone.nodes[family]
        assert zone.strength[n] == pytest.approx(strength(setup.fabric, family, SIDES[family]))
    assert_allclose(of_middle(panel), panel.strengths)


@pytest.mark.parametrize("round", [False, True])
@pytest.mark.parametrize("angle", [0.0, 0.4, -1.1, 0.5 * np.pi])
def test_lengths_are_chords_of_the_opening(round, angle):
    """Against steps of 10 um along the yarn through the impact point."""
    weave = unlike.fabric().weave
    sides = (0.05, 0.05) if round else (0.05, 0.03)
    point = np.array([0.006, -0.004])
    found = find_yarn_lengths(weave, sides, angle, tuple(point), round)
    steps = 1e-5 * np.arange(-6000, 6001)
    for family, yarn in enumerate(weave.yarns):
        turn = angle + 0.5 * np.pi * family
        places = point + steps[:, None] * [np.cos(turn), np.sin(turn)]
        if round:
            inside = np.hypot(*places.T) < 0.025
        else:
            inside = np.all(abs(places) < 0.5 * np.array(sides), axis=1)
        assert found[family] == pytest.approx((1 + yarn.crimp) * 1e-5 * inside.sum(), abs=3e-5)


def test_tables_of_short_strong_yarns_reach_further():
    """Above 1.15 of the stated strength by a quarter of it, so that openings share tables."""
    assert made(opening=0.08).cell().reach == 1.25
    assert made(opening=0.04).cell().reach == made(opening=0.041).cell().reach == 1.5
    assert (
        made(opening=0.2).cell().reach
        == made(opening=0.04, length_effect=False).cell().reach
        == 1.0
    )
