"""Resolved yarns of weaves with floats: at rest, against the cell, torn, beside each other, mirrored."""

from dataclasses import replace

import numpy as np
import pytest
from yarn_patches import energy, free_zone

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.pattern import Pattern
from shellfabric.cell.model import CellModel
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns import zone_kernels
from shellfabric.yarns.model import YarnZone, aim
from shellfabric.yarns.patch import YarnPatch
from validation.cases.weaves import compare_with_cell
from weavecell.studies import unknown

BASE = catalogue.load("S-728")
SPHERE = Projectile(mass=0.69e-3, radius=2.78e-3, shape="sphere")


def woven(text):
    """S-728 in another weave, with twice its crimp: half of its spacings, twice as steep."""
    weave = replace(BASE.weave, pattern=Pattern.read(text))
    fabric = replace(BASE, weave=weave)
    return fabric.with_yarns(crimp=[2 * yarn.crimp for yarn in weave.yarns])


def patch(text, crossings=(9, 8), **values):
    """A patch that begins in the middle of floats."""
    model = CellModel(woven(text), mean_crossing=True)
    given = {"rim_rows": 0, "first": (-3, 5)}
    return YarnPatch(model, crossings, **given | values)


def shot(text, opening=0.034, **values):
    fabric = woven(text)
    given = {"projectile": SPHERE, "opening": opening, "table_size": 51, "end_time": 36e-6}
    given |= {"symmetry": "whole", "impact_point": aim(fabric.weave)}
    given |= {"crossovers": YarnZone(8e-3, 0.2)}
    return ImpactSetup(fabric, 250.0, **given | values)


@pytest.mark.parametrize("weave", ["basket 2x2", "twill 3/1", "satin 5"])
def test_a_patch_at_rest_has_no_forces_and_the_crimp_of_its_yarns(weave):
    made = patch(weave)
    zone = free_zone(made)
    zone_kernels.inner_forces(zone)
    assert abs(zone.f).max() < 1e-12
    assert energy(zone) < 1e-24
    # an index that leans to a flank is where the kernel finds it
    inner = np.moveaxis(zone.place, 0, -1)[1:-1, 1:-1]
    assert inner == pytest.approx(made.rest[0][1:-1, 1:-1], abs=1e-9)
    assert abs(inner - inner.round()).max() > 0.05
    # over whole repeats, away from the rim
    repeat = made.weave.pattern.matrix.shape[1]
    length = zone.rest_length[: zone.nodes[0]][2 : 2 + 2 * repeat].sum()
    assert length / (repeat * made.spacing[0]) - 1 == pytest.approx(made.weave.warp.crimp)


@pytest.mark.parametrize("weave", ["basket 2x2", "twill 2/2"])
def test_tensions_of_a_patch_are_those_of_the_cell_within_7_percent(weave):
    """12 x 12 pinned crossings led apart, unlike along warp and weft; compared in the middle repeat."""
    found = compare_with_cell(woven(weave), [0.028, 0.016], first=(-3, 5))
    assert found["tangled"] == 0
    assert found["warp"] == pytest.approx(1, rel=0.07)
    assert found["weft"] == pytest.approx(1, rel=0.07)


def test_yarns_of_a_group_come_as_close_as_a_diameter_and_others_leave_room_for_a_yarn():
    """Points of a yarn look at the next one towards the line of flight."""
    first = 1, 0
    basket = patch("basket 2x2", (6, 8), first=first)
    distance = basket.arrays(basket.critical_step).closest_distance
    nodes, warp_yarns = basket.layout[2][0], basket.layout[1][0]
    points = distance[: nodes * warp_yarns].reshape(warp_yarns, nodes)[:, 2:-2:2]
    # warp yarns 1, 2 3, 4 5, 6 7, 8: the middle one is the fifth of the patch, number 5
    beside = np.array([number + np.sign(4 - number) for number in range(8)])
    same_group = (np.arange(8) + 1) // 2 == (beside + 1) // 2
    # a round yarn of closest packed fibres; two that lie flat have their width
    diameter = np.sqrt(4 / np.pi * basket.weave.warp.A_s / (np.pi / np.sqrt(12)))
    flat = 0.9 * basket.beside["touch_distance"][0]
    assert diameter < flat < np.sqrt(3) * diameter
    assert points[same_group] == pytest.approx(diameter)
    assert points[~same_group] == pytest.approx(flat)


@pytest.mark.parametrize("weave", ["basket 2x2", "twill 2/2", "satin 5"])
def test_a_torn_panel_keeps_its_energy(weave):
    result = run_impact(shot(weave))
    assert result.cut_yarns[-1] > 1.5
    assert result.energies["crossover_friction"][-1] > 1e-3 * result.strike_energy
    assert result.energy_error_max < 0.005
    assert result.energy_error_max > 0


def test_a_quarter_of_a_basket_of_threes_does_what_the_whole_does():
    """Its middle lines are those of the middle yarns of groups. Through the tear; some 12 us after it the cut ends,
    which are slack and so have no viscosity, take the rounding from 1e-16 to 1e-6."""
    aimed = {"impact_point": (0.0, 0.0), "end_time": 27e-6}
    whole, quarter = (
        run_impact(shot("basket 3x3", symmetry=symmetry, **aimed))
        for symmetry in ("whole", "quarter")
    )
    assert whole.cut_yarns[-1] > 1.5
    np.testing.assert_allclose(quarter.velocity, whole.velocity, rtol=1e-9)
    assert quarter.cut_yarns[-1] == pytest.approx(whole.cut_yarns[-1])


@pytest.mark.parametrize(
    "weave, symmetry", [("basket 2x2", "half"), ("twill 2/2", "quarter"), ("basket 1x2", "half")]
)
def test_a_plane_that_is_none_of_the_pattern_is_refused(weave, symmetry):
    with pytest.raises(InputError) as refused:
        shot(weave, symmetry=symmetry, impact_point=(0.0, 0.0)).panel()
    assert refused.value.key == "symmetry"
    assert weave in str(refused.value)


@pytest.mark.parametrize("opening", [0.034, (0.034, 0.036), 0.036])
def test_the_middle_of_a_panel_is_one_crossing_of_the_repeat_whatever_its_size(opening):
    """In twill 2/1 the first warp is over the first weft and over the next, under the one before."""
    panel = shot("twill 2/1", opening).panel()
    (i0, _), (j0, _) = panel.rim_rows
    weft, warp = (count // 2 - first - 1 for count, first in zip(panel.counts, (i0, j0)))
    assert list(panel.patch.up(0)[warp, weft - 1 : weft + 2]) == [-1, 1, 1]


def test_an_aim_is_anywhere_in_the_repeat():
    weave = woven("basket 2x3").weave
    places = np.array([aim(weave, seed) for seed in range(200)]) / (2 * np.array(weave.w))
    # six weft yarns are crossed along the warp, four warp yarns along the weft
    assert abs(places).max(axis=0) == pytest.approx([3, 2], rel=0.05)
    setup = shot("basket 2x3")
    axes = unknown.ROWS[:2]
    shares = [[row.share(7, number, 0) for row in axes] for number in range(256)]
    struck = [
        unknown.put_all(setup, unknown.ALIKE, dict(zip((row.name for row in axes), each)))
        for each in shares
    ]
    drawn = np.array([each.impact_point for each in struck])
    assert np.ptp(drawn / (2 * np.array(weave.w)), axis=0) == pytest.approx([6, 4], rel=0.05)
