"""Woven patches: chequerboard, continuous yarns, fit of opposite ends, volumes, groups, likeness to the crossover."""

import numpy as np
import pytest
from hexahedra import volumes

from fabrics import catalogue
from fabrics.errors import InputError
from meshing import crossover
from meshing.patch import build

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
SMALL = (3, 2, 1)


def woven(name="S-720", count=(3, 4), size=SMALL, **choices):
    return build(catalogue.load(name), count, size=size, **choices)


def centre(patch, name):
    """(nx+1, 3) [m] middle line of a yarn."""
    grid = patch.points[patch.grids[patch.names.index(name)]]
    return grid[:, grid.shape[1] // 2].mean(axis=1)


def at(patch, warp, weft):
    """Heights of the centrelines of a warp and a weft yarn where they cross."""
    x, y = centre(patch, f"weft_{weft}")[0, 0], centre(patch, f"warp_{warp}")[0, 1]
    a, b = centre(patch, f"warp_{warp}"), centre(patch, f"weft_{weft}")
    return a[np.argmin(np.abs(a[:, 0] - x)), 2], b[np.argmin(np.abs(b[:, 1] - y)), 2]


def test_over_and_under_like_a_chequerboard():
    patch = woven("S-731")
    for i in (1, 2, 3):
        for j in (1, 2, 3, 4):
            warp, weft = at(patch, i, j)
            sign = 1 if (i + j) % 2 == 0 else -1
            assert (warp, weft) == pytest.approx((sign * patch.h0[0], -sign * patch.h0[1]), rel=1e-12)


def test_yarns_lie_at_their_spacing_and_end_between_crossings():
    patch = woven("S-726")
    assert patch.names == ("warp_1", "warp_2", "warp_3", "weft_1", "weft_2", "weft_3", "weft_4")
    assert patch.extent == pytest.approx((8 * patch.w[0], 6 * patch.w[1]))
    assert [centre(patch, f"warp_{i}")[0, 1] for i in (1, 2, 3)] == pytest.approx(np.array([-2, 0, 2]) * patch.w[1])
    assert [centre(patch, f"weft_{j}")[0, 0] for j in (1, 2, 3, 4)] == pytest.approx(
        np.array([-3, -1, 1, 3]) * patch.w[0]
    )
    for name in patch.names:
        line, axis = centre(patch, name), 0 if name.startswith("warp") else 1
        assert line[[0, -1], axis] == pytest.approx(np.array([-0.5, 0.5]) * patch.extent[axis], rel=1e-12)
        assert line[[0, -1], 2] == pytest.approx([0, 0], abs=1e-18)


def test_a_yarn_is_one_body_from_end_to_end():
    """Its nodes are one grid, no two in one place, shared by the bricks on both sides of every section."""
    patch = woven()
    for number, grid in enumerate(patch.grids):
        cells = 4 if patch.families[number] == 0 else 3
        assert grid.shape == (2 * SMALL[0] * cells + 1, 2 * SMALL[1] + 1, SMALL[2] + 1)
        hexes = patch.hexes[patch.yarn == number]
        assert np.array_equal(np.unique(hexes), np.sort(grid.ravel()))
        assert set(np.bincount(hexes.ravel())[grid[1:-1].ravel()]) == {2, 4}
        assert len(np.unique(np.round(patch.points[grid.ravel()], 12), axis=0)) == grid.size


def test_no_yarn_touches_another_of_its_family():
    patch = woven("S-745", (3, 3), section="sine")
    for family, axis in (("warp", 1), ("weft", 0)):
        reach = [patch.points[patch.grids[patch.names.index(f"{family}_{i}")]][..., axis] for i in (1, 2, 3)]
        assert reach[0].max() < reach[1].min() < reach[1].max() < reach[2].min()


def test_conforming_yarns_of_a_family_stand_side_by_side():
    """Their blunt edges meet where no gap is asked for, and leave it where one is."""
    for gap in (0.0, 2e-5):
        patch = woven("S-745", (3, 3), gap=gap)
        reach = [patch.points[patch.grids[patch.names.index(f"warp_{i}")]][..., 1] for i in (1, 2, 3)]
        assert reach[1].min() - reach[0].max() == pytest.approx(gap, abs=1e-12)


@pytest.mark.parametrize("kind", ["sine", "ellipse"])
@pytest.mark.parametrize("name", WOVEN)
def test_every_hexahedron_is_right_side_out_and_the_yarns_hold_their_fibres(name, kind):
    patch = woven(name, (2, 2), (6, 5, 2), section=kind)
    volume = volumes(patch.points, patch.hexes)
    assert volume.min() > 0
    for number, family in enumerate(patch.families):
        expected = 2 * patch.S0[family] * patch.fibre_area[family] / patch.Vf0[family]
        assert volume[patch.yarn == number].sum() == pytest.approx(expected, rel=0.03)
        of_section = patch.bar_area[number].reshape(len(patch.grids[number]) - 1, -1)
        assert of_section.sum(axis=1) == pytest.approx(patch.fibre_area[family], rel=1e-12)
        lines = np.diff(patch.points[patch.grids[number]], axis=0)
        assert np.linalg.norm(lines, axis=-1).sum(axis=0) == pytest.approx(2 * patch.S0[family], rel=2e-3)


@pytest.mark.parametrize("name", WOVEN)
def test_crossing_yarns_do_not_overlap(name):
    """Least gap of the smooth surfaces in a cell, from the centrelines and sections themselves."""
    patch = woven(name, (1, 1))
    (warp, weft), (w1, w2), (h1, h2) = patch.sections, patch.w, patch.h0
    x, y = np.linspace(0, weft.half_width, 500)[:, None], np.linspace(0, warp.half_width, 500)[None]
    lower = h1 * np.cos(np.pi * x / (2 * w1)) - warp.half_thickness(y)
    upper = weft.half_thickness(x) - h2 * np.cos(np.pi * y / (2 * w2))
    assert patch.shift == 0
    assert (lower - upper).min() > -1e-11
    assert patch.section_fit.report.endswith("left open") == (patch.section_fit.overlap < 0)


def test_one_crossing_is_the_whole_crossover():
    """Where neither has to shift the yarns (here both sections are densified) they are one mesh."""
    fabric = catalogue.load("S-731")
    one, other = build(fabric, (1, 1), size=(4, 3, 2)), crossover.build(fabric, domain="whole", size=(4, 3, 2))
    assert abs(other.shift) < 1e-11
    assert np.allclose(one.points, other.points, rtol=0, atol=1e-11)
    assert np.array_equal(one.hexes, other.hexes)
    for name, quads in other.faces.items():
        yarn, part = name.split("_")
        assert np.array_equal(one.faces[f"{yarn}_1_{part}"], quads)


def test_the_cell_of_four_crossovers_fits_itself():
    """Opposite ends of 2 x 2 are translations of each other: periodic."""
    patch = woven(count=(2, 2))
    for number, family in enumerate(patch.families):
        grid = patch.points[patch.grids[number]]
        step = np.zeros(3)
        step[family] = patch.extent[family]
        assert np.allclose(grid[-1], grid[0] + step, rtol=0, atol=1e-18)


def test_groups_are_named_by_yarn_and_by_family():
    patch = woven(count=(2, 3))
    groups, parts = patch.groups, ("contact", "plate", "tip", "end", "start")
    assert set(groups) == {f"{yarn}_{part}" for yarn in (*patch.names, "warp", "weft") for part in parts}
    assert len(groups["warp_2_contact"]) == 3 * 6 * 4  # crossings, elements along and across
    assert len(groups["weft_contact"]) == 3 * 2 * 6 * 4
    assert groups["warp_end"].tolist() == sorted([*groups["warp_1_end"], *groups["warp_2_end"]])
    assert patch.points[groups["warp_end"], 0] == pytest.approx(patch.extent[0] / 2)
    assert patch.points[groups["weft_start"], 1] == pytest.approx(-patch.extent[1] / 2)


def test_contact_faces_look_at_the_crossing_yarn_and_plates_away():
    """Over a crossing the contact face is the lower one, under it the upper one."""
    patch = woven("S-731", (2, 2))
    for number, family in enumerate(patch.families):
        for part, sign in (("contact", 1), ("plate", -1)):
            corners = patch.points[patch.faces[f"{patch.names[number]}_{part}"]]
            normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 2]
            middle = corners.mean(axis=1)
            cell = [np.floor(middle[:, axis] / (2 * patch.w[axis])).astype(int) + 1 for axis in (0, 1)]
            over = (cell[0] + cell[1]) % 2 == family
            assert np.array_equal(normal < 0, over if sign == 1 else ~over)


def test_the_faces_of_a_yarn_close():
    patch = woven()
    for name in patch.names:
        quads = np.concatenate([patch.faces[f"{name}_{part}"] for part in ("contact", "plate", "tip", "end", "start")])
        corners = patch.points[quads]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        assert np.abs(normal.sum(axis=0)).max() < 1e-12 * np.abs(normal).sum()


def test_a_square_inch_of_the_source_has_its_number_of_hexahedra():
    """Source thesis Table 4-3: 25.4 mm of S-720 in 160,000 solids, 400 in each of 20 x 20 crossovers (erratum E-34)."""
    patch = woven(count=(20, 20), size=(5, 5, 2))
    assert len(patch.hexes) == 160_000
    assert patch.extent == pytest.approx((25.4e-3, 25.4e-3), rel=1e-12)
    assert patch.min_scaled_jacobian > 0.9


@pytest.mark.parametrize("count", [(0, 2), (2, 1.5), 3, (1, 2, 3), "2x2", (True and 2, float("nan"))])
def test_bad_counts(count):
    with pytest.raises(InputError) as caught:
        woven(count=count)
    assert str(caught.value).endswith("must be two whole numbers from 1, of warp and of weft yarns")


def test_end_shells_are_the_end_faces():
    assert woven(count=(1, 2)).shells == {}
    patch = woven(count=(1, 2), end_shells=2e-5)
    names = {f"{yarn}_{part}" for yarn in patch.names for part in ("end", "start")}
    assert set(patch.shells) == names
    assert all(np.array_equal(quads, patch.faces[name]) for name, quads in patch.shells.items())
    with pytest.raises(InputError) as caught:
        woven(end_shells=0)
    assert str(caught.value) == "end_shells = 0: must be a positive thickness in m, or none"
