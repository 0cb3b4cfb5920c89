"""Meshes of a crossover and of woven patches: volumes, orientation, fibres and bars, symmetry, surfaces, node grids."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hexahedra import vector_areas, volumes
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import catalogue
from meshing import crossover as mesher
from meshing import geometry, overlap, patch
from meshing.generate import of_script
from meshing.mesh import assemble, tributary_areas

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
# numbers of the yarns, and of the axes along them
WARP = 0
WEFT = 1
SMALL = (3, 2, 1)
SIZES = ((6, 4, 2), (12, 8, 4), (24, 16, 8))
# [m] to which gmsh measures its curves: nodes differ by 1e-14 to 4e-12 m as its
# Mesh.LcIntegrationPrecision and the number of points differ, in no order
NODE = 5e-12
# to which its splines follow the cosine with our number of points, over the height; see the test of their order
SPLINE = 1e-6


def mesh(name="S-720", size="coarse", **choices):
    return mesher.build(catalogue.load(name), size=size, **choices)


def woven(name="S-720", count=(3, 4), size=SMALL, **choices):
    return patch.build(catalogue.load(name), count, size=size, **choices)


def lengths(made, yarn):
    """Polygon length of each fibre line (ny+1, nz+1)."""
    return np.linalg.norm(np.diff(made.points[made.grids[yarn]], axis=0), axis=-1).sum(axis=0)


@pytest.mark.parametrize(
    "name, kind, quality",
    [
        ("S-731", "sine", 0.8),
        ("S-727", "ellipse", 0.4),
        *(
            pytest.param(name, kind, quality, marks=pytest.mark.slow)
            for name in WOVEN
            for kind, quality in (("sine", 0.8), ("ellipse", 0.4))
            if (name, kind) not in (("S-731", "sine"), ("S-727", "ellipse"))
        ),
    ],
)
def test_every_hexahedron_is_right_side_out_and_the_yarns_hold_their_fibres(name, kind, quality):
    """In a quarter of a crossover (half a yarn, half of its fibres), in a whole one, and in two crossings a yarn."""
    for crossings, share, made in (
        (0.5, 0.5, mesh(name, (6, 5, 2), section=kind)),
        (1, 1, mesh(name, (6, 5, 2), section=kind, domain="whole")),
        (2, 1, woven(name, (2, 2), (6, 5, 2), section=kind)),
    ):
        volume = volumes(made.points, made.hexes)
        assert volume.min() > 0
        assert made.min_scaled_jacobian > quality
        for number, family in enumerate(made.families):
            length = crossings * made.S0[family]
            area = share * made.fibre_area[family]
            assert volume[made.yarn == number].sum() == pytest.approx(
                length * area / made.Vf0[family], rel=0.03
            )
            of_section = made.bar_area[number].reshape(len(made.grids[number]) - 1, -1)
            assert of_section.min() > 0
            assert of_section.sum(axis=1) == pytest.approx(area, rel=1e-12)
            assert lengths(made, number) == pytest.approx(length, rel=2e-3)


def test_worst_scaled_jacobian_of_a_sine_section_is_that_of_its_steepest_slopes():
    """Vertical edges, slope a along and b across: 1 / sqrt((1 + a^2)(1 + b^2)) where both are largest."""
    crossover = mesh(size=(32, 32, 2))
    expected = []
    for section, w, h in zip(crossover.sections, crossover.w, crossover.h0):
        a = np.pi * h / (2 * w)
        b = np.pi * section.thickness / (2 * section.width)
        expected.append(1 / np.sqrt((1 + a * a) * (1 + b * b)))
    assert crossover.min_scaled_jacobian == pytest.approx(min(expected), rel=5e-3)


@pytest.mark.parametrize("name", ["S-720", "S-731"])
@pytest.mark.parametrize("kind, error", [("sine", 1e-3), ("ellipse", 2e-3)])
def test_yarn_volume_is_its_length_times_its_area(name, kind, error):
    """V -> S0 A_s / Vf0 with order two: only the polygon of the section differs from the lens."""
    errors = []
    for size in SIZES:
        crossover = mesh(name, size, section=kind, domain="whole")
        volume = volumes(crossover.points, crossover.hexes)
        volumes_of_yarns = [volume[crossover.yarn == yarn].sum() for yarn in (WARP, WEFT)]
        expected = np.multiply(crossover.S0, crossover.fibre_area) / crossover.Vf0
        errors.append(1 - volumes_of_yarns / expected)
    errors = np.array(errors)
    assert np.all(errors > 0)
    assert np.all(errors[-1] < error)
    assert_allclose(np.log2(errors[:-1] / errors[1:]), 2, atol=0.2)


def test_all_fibres_have_the_length_of_the_yarn():
    """Every fibre line has one length, and it tends to S0 / 2 with order two."""
    for yarn in (WARP, WEFT):
        errors = []
        for size in SIZES:
            crossover = mesh("S-731", size)
            length = lengths(crossover, yarn)
            assert np.ptp(length) < NODE
            errors.append(1 - length.mean() / (crossover.S0[yarn] / 2))
        assert 0 < errors[-1] < 1e-4
        assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.05)


def test_bars_are_edges_along_the_fibre():
    crossover = mesh(domain="whole")
    edges = {
        tuple(pair)
        for i, j in ((0, 1), (3, 2), (4, 5), (7, 6))
        for pair in crossover.hexes[:, [i, j]]
    }
    assert edges == {tuple(pair) for yarn in (WARP, WEFT) for pair in crossover.bars[yarn]}
    for yarn in (WARP, WEFT):
        along = np.diff(crossover.points[crossover.bars[yarn]], axis=1)[:, 0]
        assert np.all(along[:, yarn] > 0)
        assert_allclose(along[:, 1 - yarn], 0, atol=NODE)
        assert np.all(crossover.fibre[crossover.yarn == yarn][:, yarn] > 0.8)
    assert np.allclose(np.linalg.norm(crossover.fibre, axis=1), 1)


def test_tributary_areas_are_the_nodal_shares_of_the_polygon():
    y = np.array([0.0, 1.0, 3.0])
    z = np.linspace(-1, 1, 3) * np.array([[2.0], [1.0], [0.5]])
    # thickness 4, 2, 1; strips 0..0.5, 0.5..2, 2..3; a quarter, a half and a quarter of each through the thickness
    strips = np.array([(4 + 3) / 2 * 0.5, (3 + 2) / 2 * 0.5 + (2 + 1.5) / 2, (1.5 + 1) / 2])
    assert tributary_areas(y, z) == pytest.approx(np.outer(strips, [0.25, 0.5, 0.25]))
    assert tributary_areas(y, z).sum() == pytest.approx((4 + 2) / 2 + (2 + 1) / 2 * 2)


@pytest.mark.parametrize("kind", ["sine", "ellipse"])
def test_the_whole_is_the_quarter_mirrored_twice(kind):
    quarter = mesh("S-726", section=kind)
    whole = mesh("S-726", section=kind, domain="whole")
    for yarn in (WARP, WEFT):
        nx, ny, _ = (n - 1 for n in quarter.grids[yarn].shape)
        part = quarter.points[quarter.grids[yarn]]
        full = whole.points[whole.grids[yarn]]
        assert full.shape[:2] == (2 * nx + 1, 2 * ny + 1)
        along, across = (1 - 2 * yarn) * np.array([(-1, 1, 1), (1, -1, 1)]) * (1, 1, 1 - 2 * yarn)
        assert_allclose(full[nx:, ny:], part, rtol=0, atol=NODE)
        assert_allclose(full[nx::-1, ny:], part * along, rtol=0, atol=NODE)
        assert_allclose(full[nx:, ny::-1], part * across, rtol=0, atol=NODE)
        areas, all_areas = (
            made.bar_area[yarn][: np.prod(made.grids[yarn].shape[1:])].reshape(
                made.grids[yarn].shape[1:]
            )
            for made in (quarter, whole)
        )
        assert_allclose(all_areas[ny + 1 :], areas[1:], rtol=1e-6)
        assert_allclose(all_areas[ny], 2 * areas[0], rtol=1e-6)


@pytest.mark.parametrize("domain", ["quarter", "whole"])
@pytest.mark.parametrize("yarn", [WARP, WEFT])
def test_the_faces_of_a_yarn_close_its_volume_and_look_outwards(domain, yarn):
    """Each edge is met once in each direction; sum of x . n A = 3 V, but for the warp of the faces."""
    made = mesh(domain=domain)
    name = made.names[yarn]
    quads = np.concatenate([quads for key, quads in made.faces.items() if key.startswith(name)])
    edges = np.stack([quads, np.roll(quads, 1, axis=1)], axis=-1).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges)
    assert_array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))
    corners = made.points[quads]
    areas = vector_areas(corners)
    volume = volumes(made.points, made.hexes[made.yarn == yarn]).sum()
    assert np.sum(corners.mean(axis=1) * areas) / 3 == pytest.approx(volume, rel=1e-3)


def test_groups_of_the_quarter_and_of_the_whole():
    quarter = mesh()
    whole = mesh(domain="whole")
    nx, ny, nz = (n - 1 for n in quarter.grids[WARP].shape)
    sizes = {"contact": nx * ny, "plate": nx * ny, "tip": nx * nz, "end": (ny + 1) * (nz + 1)}
    groups = quarter.groups
    for axis, (yarn, plane) in enumerate((("warp", "symx"), ("weft", "symy"))):
        assert {part: len(groups[f"{yarn}_{part}"]) for part in sizes} == sizes
        on_plane = np.flatnonzero(quarter.points[:, axis] == 0)
        assert sorted([*groups[f"warp_{plane}"], *groups[f"weft_{plane}"]]) == on_plane.tolist()
        for made, part, side in ((quarter, "end", 1), (whole, "end", 1), (whole, "start", -1)):
            places = made.points[made.groups[f"{yarn}_{part}"], axis]
            assert places == pytest.approx(side * made.w[axis], rel=1e-14)
    assert len(groups) == 12
    parts = ("contact", "plate", "tip", "end", "start")
    assert set(whole.groups) == {f"{yarn}_{part}" for yarn in ("warp", "weft") for part in parts}


def test_grids_hold_every_node_once_in_its_place():
    crossover = mesh("S-731", (5, 4, 3))
    assert sorted(np.concatenate([g.ravel() for g in crossover.grids])) == list(
        range(len(crossover.points))
    )
    for yarn in (WARP, WEFT):
        grid = crossover.points[crossover.grids[yarn]]
        assert grid.shape[:3] == (6, 5, 4)
        assert np.all(np.diff(grid[..., yarn], axis=0) > 0)
        assert np.all(np.diff(grid[..., 1 - yarn], axis=1) > 0)
        assert np.all(np.diff(grid[..., 2], axis=2) > 0)
        assert_array_equal(
            np.unique(crossover.hexes[crossover.yarn == yarn]), np.unique(crossover.grids[yarn])
        )
        middle = grid[:, :, 0, 2] / 2 + grid[:, :, -1, 2] / 2
        height = (middle[0] - middle[-1]) * (1 - 2 * yarn)
        assert height == pytest.approx(crossover.h0[yarn], rel=1e-12)
    warp, weft = (crossover.points[grid][..., 2].mean() for grid in crossover.grids)
    assert warp > weft


def test_named_sizes_are_those_of_a_quarter():
    for size, shape in (("coarse", (9, 7, 3)), ("medium", (17, 13, 5)), ("fine", (25, 19, 7))):
        assert mesh(size=size).grids[WARP].shape == shape
    assert mesh(size="coarse", domain="whole").grids[WEFT].shape == (17, 13, 3)


def test_yarns_go_over_and_under_like_a_chequerboard_at_their_spacing():
    """z = +-h cos(pi (x - x of the first crossing) / 2 w), up where the numbers of warp and weft have an even sum."""
    weave = woven("S-731", (3, 4))
    assert weave.names == ("warp_1", "warp_2", "warp_3", "weft_1", "weft_2", "weft_3", "weft_4")
    assert weave.extent == pytest.approx((8 * weave.w[0], 6 * weave.w[1]))
    # of the crossings along each
    places = [2 * w * (np.arange(n) - (n - 1) / 2) for w, n in zip(weave.w, (4, 3))]
    for number, family in enumerate(weave.families):
        place = number - 3 * family
        grid = weave.points[weave.grids[number]]
        line = grid[:, grid.shape[1] // 2].mean(axis=1)
        along = line[:, family]
        across = line[:, 1 - family]
        assert across == pytest.approx(places[1 - family][place], abs=1e-18)
        assert along[[0, -1]] == pytest.approx(
            np.array([-0.5, 0.5]) * weave.extent[family], rel=1e-12
        )
        up = (-1) ** (place + family)
        z = (
            up
            * weave.h0[family]
            * np.cos(np.pi * (along - places[family][0]) / (2 * weave.w[family]))
        )
        assert line[:, 2] == pytest.approx(z, abs=SPLINE * weave.h0[family])


def test_a_yarn_is_one_body_from_end_to_end():
    """Its nodes are one grid, no two in one place, shared by the bricks on both sides of every section."""
    weave = woven()
    for number, grid in enumerate(weave.grids):
        cells = 4 if weave.families[number] == 0 else 3
        assert grid.shape == (2 * SMALL[0] * cells + 1, 2 * SMALL[1] + 1, SMALL[2] + 1)
        hexes = weave.hexes[weave.yarn == number]
        assert_array_equal(np.unique(hexes), np.sort(grid.ravel()))
        assert set(np.bincount(hexes.ravel())[grid[1:-1].ravel()]) == {2, 4}
        assert len(np.unique(np.round(weave.points[grid.ravel()], 12), axis=0)) == grid.size


def test_yarns_of_a_family_stand_side_by_side():
    """Lenses apart; the blunt edges of conforming warps meet where no gap is asked for, and leave it where one is."""
    for choices, gap in (({"section": "sine"}, None), ({}, 0.0), ({"gap": 2e-5}, 2e-5)):
        weave = woven("S-745", (2, 2), **choices)
        across = [
            weave.points[grid][..., 1 - family] for grid, family in zip(weave.grids, weave.families)
        ]
        warps, wefts = (high.min() - low.max() for low, high in (across[:2], across[2:]))
        assert wefts > 0
        assert warps > 0 if gap is None else warps == pytest.approx(gap, abs=1e-12)


def test_one_crossing_is_the_whole_crossover():
    """Where neither has to shift the yarns (here both sections are densified) they are one mesh."""
    fabric = catalogue.load("S-731")
    one = patch.build(fabric, (1, 1), size=(4, 3, 2))
    other = mesher.build(fabric, domain="whole", size=(4, 3, 2))
    assert abs(other.shift) < 1e-11
    assert_allclose(one.points, other.points, rtol=0, atol=1e-11)
    assert_array_equal(one.hexes, other.hexes)
    for name, quads in other.faces.items():
        yarn, part = name.split("_")
        assert_array_equal(one.faces[f"{yarn}_1_{part}"], quads)


def test_copies_of_yarns_are_what_gmsh_makes_of_the_script_of_all():
    """gmsh meshes two yarns of a family; warp and weft, over and under, even and odd counts differ."""
    made = woven("S-731", (3, 4))
    whole = assemble(
        of_script(made.script, "all"),
        made.names,
        made.families,
        False,
        catalogue.load("S-731").weave,
    )
    assert_allclose(made.points, whole["points"], rtol=0, atol=NODE)
    assert_array_equal(made.hexes, whole["hexes"])
    assert made.faces.keys() == whole["faces"].keys()
    for face, quads in whole["faces"].items():
        assert_array_equal(made.faces[face], quads)
    assert_allclose(np.concatenate(made.bar_area), np.concatenate(whole["bar_area"]), rtol=1e-6)


def test_the_cell_of_four_crossovers_fits_itself():
    """Opposite ends of 2 x 2 are translations of each other: periodic."""
    weave = woven(count=(2, 2))
    for number, family in enumerate(weave.families):
        grid = weave.points[weave.grids[number]]
        step = np.zeros(3)
        step[family] = weave.extent[family]
        assert_allclose(grid[-1], grid[0] + step, rtol=0, atol=NODE)


def test_groups_are_named_by_yarn_and_by_family():
    weave = woven(count=(2, 3))
    groups = weave.groups
    parts = ("contact", "plate", "tip", "end", "start")
    assert set(groups) == {
        f"{yarn}_{part}" for yarn in (*weave.names, "warp", "weft") for part in parts
    }
    assert len(groups["warp_2_contact"]) == 3 * 6 * 4  # crossings, elements along and across
    assert len(groups["weft_contact"]) == 3 * 2 * 6 * 4
    assert groups["warp_end"].tolist() == sorted([*groups["warp_1_end"], *groups["warp_2_end"]])
    assert weave.points[groups["warp_end"], 0] == pytest.approx(weave.extent[0] / 2)
    assert weave.points[groups["weft_start"], 1] == pytest.approx(-weave.extent[1] / 2)
    shells = woven(count=(2, 3), end_shells=2e-5).shells
    assert weave.shells == {}
    assert set(shells) == {f"{yarn}_{part}" for yarn in weave.names for part in ("end", "start")}
    assert all(np.array_equal(quads, weave.faces[name]) for name, quads in shells.items())


def test_contact_faces_look_at_the_crossing_yarn_and_plates_away():
    """Over a crossing the contact face is the lower one, under it the upper one."""
    weave = woven("S-731", (2, 2))
    for number, family in enumerate(weave.families):
        for part, sign in (("contact", 1), ("plate", -1)):
            corners = weave.points[weave.faces[f"{weave.names[number]}_{part}"]]
            normal = vector_areas(corners)[:, 2]
            middle = corners.mean(axis=1)
            cell = [
                np.floor(middle[:, axis] / (2 * weave.w[axis])).astype(int) + 1 for axis in (0, 1)
            ]
            over = (cell[0] + cell[1]) % 2 == family
            assert_array_equal(normal < 0, over if sign == 1 else ~over)


def thrown(face, points, places):
    """Heights of bilinear facets (q, 4) above places (n, 2), by search: NaN off them."""
    z = np.full(len(places), np.nan)
    for corners in points[face]:
        low = corners[:, :2].min(axis=0)
        high = corners[:, :2].max(axis=0)
        inside = np.all((places >= low) & (places < high), axis=1)
        s, t = ((places[inside] - low) / (high - low)).T
        for corner in corners:
            right, far = corner[:2] > (low + high) / 2
            z_part = (s if right else 1 - s) * (t if far else 1 - t) * corner[2]
            z[inside] = np.where(np.isnan(z[inside]), 0, z[inside]) + z_part
    return z


@pytest.mark.parametrize("domain", ["quarter", "whole"])
def test_least_gap_is_that_of_points_thrown_on_the_facets(domain):
    made = mesh("S-745", (5, 4, 2), domain=domain)
    corners = np.meshgrid(*(np.unique(made.points[:, axis].round(12)) for axis in (0, 1)))
    inside = 0.999999 * np.stack(corners, axis=-1).reshape(-1, 2)
    places = np.concatenate([np.random.default_rng(3).uniform(-1, 1, (2000, 2)) * made.w, inside])
    warp, weft = (
        thrown(made.groups[f"{name}_contact"], made.points, places) for name in ("warp", "weft")
    )
    gap = np.nanmin(warp - weft)
    assert made.least_gap == pytest.approx(gap, rel=1e-3)


def test_facets_overlap_by_their_sag_alone():
    """Conforming smooth sections touch everywhere: what is left is the facets' sag, a quarter at half the size."""
    gaps = [mesh("S-728", (4 * n, 3 * n, n)).least_gap for n in (2, 4, 8)]
    assert -1e-6 < gaps[0] < 0
    assert [a / b for a, b in pairwise(gaps)] == pytest.approx([4, 4], rel=0.2)


def test_a_patch_has_the_gap_of_its_crossing():
    one = mesh("S-728", (4, 3, 1)).least_gap
    assert woven("S-728", (2, 3), (4, 3, 1)).least_gap == pytest.approx(one, rel=1e-6)


def test_twice_the_points_bring_the_splines_eight_times_nearer(monkeypatch):
    """The distance of the nodes from the formula is that of our splines, not of gmsh's arithmetic: 24 pm here."""
    misses = []
    for points in (30, 60, 120):
        monkeypatch.setattr(geometry, "SAMPLES", points)
        crossover = mesh("S-731", (12, 8, 4))
        nodes = crossover.points[crossover.grids[WARP]]
        height = crossover.h0[WARP]
        middle = height * np.cos(np.pi * nodes[..., 0] / (2 * crossover.w[WARP]))
        half = nodes[..., 2] - middle
        misses.append(np.abs(half - half[0]).max() / height)
    assert misses[1] < 0.3 * SPLINE
    assert_allclose(np.divide(misses[:-1], misses[1:]), 8, rtol=0.1)


def test_a_whole_crossover_is_four_quarters_also_where_a_shift_closes_an_overlap():
    """S-720, whose sines overlap: the same least gap, and no side of it is shifted the other way."""
    fabric = catalogue.load("S-720")
    quarter, whole = (
        mesher.build(fabric, domain=domain, size=(2, 2, 2)) for domain in ("quarter", "whole")
    )
    assert whole.least_gap == pytest.approx(quarter.least_gap, abs=1e-12)
    assert abs(whole.points[:, :2].sum(axis=0)).max() < 1e-9


@pytest.mark.parametrize("name", ["S-720", "S-745"])
def test_the_least_gap_is_the_same_from_below(name):
    """Turned over, the weft lies above the warp, and the layers of nodes run the other way."""
    above = mesh(name, (5, 4, 2), domain="whole")
    turned = SimpleNamespace(
        points=above.points * (1, 1, -1),
        grids=[grid[..., ::-1] for grid in above.grids],
        families=above.families,
    )
    assert overlap.least_gap(turned) == pytest.approx(above.least_gap, rel=1e-12)
