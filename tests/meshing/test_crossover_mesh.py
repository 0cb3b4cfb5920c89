"""The crossover mesh: volumes, orientation, fibres and their bars, symmetry, closed surfaces, the node grids."""

import numpy as np
import pytest
from hexahedra import volumes

from fabrics import catalogue
from meshing.crossover import build
from meshing.grid import tributary_areas

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
WARP, WEFT = 0, 1
SIZES = ((6, 4, 2), (12, 8, 4), (24, 16, 8))


def mesh(name="S-720", size="coarse", **choices):
    return build(catalogue.load(name), size=size, **choices)


def sections_of_bars(crossover, yarn):
    """Bars and their areas by place: (nx, ny+1, nz+1, 2) and (nx, ny+1, nz+1)."""
    nx, *section = crossover.grids[yarn].shape
    shape = (nx - 1, *section)
    return crossover.bars[yarn].reshape(*shape, 2), crossover.bar_area[yarn].reshape(shape)


def lengths(crossover, yarn):
    """Polygon length of each fibre line (ny+1, nz+1)."""
    return np.linalg.norm(np.diff(crossover.points[crossover.grids[yarn]], axis=0), axis=-1).sum(axis=0)


@pytest.mark.parametrize("kind", ["sine", "ellipse"])
@pytest.mark.parametrize("name", WOVEN)
def test_every_hexahedron_is_right_side_out(name, kind):
    for domain in ("quarter", "whole"):
        crossover = mesh(name, domain=domain, section=kind)
        assert volumes(crossover.points, crossover.hexes).min() > 0
        assert crossover.min_scaled_jacobian > (0.8 if kind == "sine" else 0.4)


def test_worst_scaled_jacobian_of_a_sine_section_is_that_of_its_steepest_slopes():
    """Vertical edges, slope a along and b across: 1 / sqrt((1 + a^2)(1 + b^2)) where both are largest."""
    crossover = mesh(size=(32, 32, 2))
    expected = []
    for section, w, h in zip(crossover.sections, crossover.w, crossover.h0):
        a, b = np.pi * h / (2 * w), np.pi * section.thickness / (2 * section.width)
        expected.append(1 / np.sqrt((1 + a * a) * (1 + b * b)))
    assert crossover.min_scaled_jacobian == pytest.approx(min(expected), rel=5e-3)


@pytest.mark.parametrize("name", ["S-720", "S-731"])
@pytest.mark.parametrize("kind", ["sine", "ellipse"])
def test_yarn_volume_is_its_length_times_its_area(name, kind):
    """V -> S0 A_s / Vf0 with order two: only the polygon of the section differs from the lens."""
    errors = []
    for size in SIZES:
        crossover = mesh(name, size, section=kind, domain="whole")
        volume = volumes(crossover.points, crossover.hexes)
        errors.append(
            [
                1 - volume[crossover.yarn == i].sum() * crossover.Vf0[i] / crossover.S0[i] / crossover.fibre_area[i]
                for i in (WARP, WEFT)
            ]
        )
    errors = np.array(errors)
    assert np.all(errors > 0)
    assert np.all(errors[-1] < (1e-3 if kind == "sine" else 2e-3))
    assert np.allclose(np.log2(errors[:-1] / errors[1:]), 2, atol=0.2)


def test_all_fibres_have_the_length_of_the_yarn():
    """Every fibre line has one length, and it tends to S0 / 2 with order two."""
    for yarn in (WARP, WEFT):
        errors = []
        for size in SIZES:
            crossover = mesh("S-731", size)
            length = lengths(crossover, yarn)
            assert np.ptp(length) < 1e-12 * length.mean()
            errors.append(1 - length.mean() / (crossover.S0[yarn] / 2))
        assert 0 < errors[-1] < 1e-4
        assert np.allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.05)


@pytest.mark.parametrize(("domain", "share"), [("quarter", 0.5), ("whole", 1.0)])
@pytest.mark.parametrize("kind", ["sine", "ellipse"])
def test_bars_of_a_section_are_the_fibres_of_the_yarn(domain, share, kind):
    crossover = mesh(domain=domain, section=kind)
    assert crossover.share == share
    for yarn, spun in zip((WARP, WEFT), catalogue.load("S-720").weave.yarns):
        _, area = sections_of_bars(crossover, yarn)
        assert np.all(area > 0)
        assert area.sum(axis=(1, 2)) == pytest.approx(share * spun.A_s, rel=1e-13)


def test_bars_are_edges_along_the_fibre():
    crossover = mesh(domain="whole")
    edges = {tuple(pair) for i, j in ((0, 1), (3, 2), (4, 5), (7, 6)) for pair in crossover.hexes[:, [i, j]]}
    assert edges == {tuple(pair) for yarn in (WARP, WEFT) for pair in crossover.bars[yarn]}
    for yarn, axis in ((WARP, 0), (WEFT, 1)):
        along = np.diff(crossover.points[crossover.bars[yarn]], axis=1)[:, 0]
        assert np.all(along[:, axis] > 0)
        assert np.allclose(along[:, 1 - axis], 0, atol=1e-18)
        assert np.all(crossover.fibre[crossover.yarn == yarn][:, axis] > 0.8)
    assert np.allclose(np.linalg.norm(crossover.fibre, axis=1), 1)


def test_a_straightened_yarn_has_the_stiffness_of_its_fibres():
    """Bars laid straight over 2 w': the tension is EA (2 w' - S0) / S0 of eq. 4-4, up to the polygon length."""
    fabric = catalogue.load("S-720")
    crossover = mesh(size="medium")
    for yarn, spun in zip((WARP, WEFT), fabric.weave.yarns):
        pairs, area = sections_of_bars(crossover, yarn)
        rest = np.linalg.norm(np.diff(crossover.points[pairs], axis=-2)[..., 0, :], axis=-1)
        straight = rest * 1.01 * (crossover.S0[yarn] / 2) / rest.sum(axis=0)
        tension = (spun.E * area * (straight / rest - 1)).sum(axis=(1, 2)) / crossover.share
        assert tension == pytest.approx(0.01 * spun.EA, rel=5e-3)


def test_tributary_areas_are_the_nodal_shares_of_the_polygon():
    y = np.array([0.0, 1.0, 3.0])
    z = np.linspace(-1, 1, 3) * np.array([[2.0], [1.0], [0.5]])
    # thickness 4, 2, 1; strips 0..0.5, 0.5..2, 2..3; a quarter, a half and a quarter of each through the thickness
    strips = np.array([(4 + 3) / 2 * 0.5, (3 + 2) / 2 * 0.5 + (2 + 1.5) / 2, (1.5 + 1) / 2])
    assert tributary_areas(y, z) == pytest.approx(np.outer(strips, [0.25, 0.5, 0.25]))
    assert tributary_areas(y, z).sum() == pytest.approx((4 + 2) / 2 + (2 + 1) / 2 * 2)


@pytest.mark.parametrize("kind", ["sine", "ellipse"])
def test_the_whole_is_the_quarter_mirrored_twice(kind):
    quarter, whole = mesh("S-726", section=kind), mesh("S-726", section=kind, domain="whole")
    for yarn in (WARP, WEFT):
        nx, ny, _ = (n - 1 for n in quarter.grids[yarn].shape)
        part, full = quarter.points[quarter.grids[yarn]], whole.points[whole.grids[yarn]]
        assert full.shape[:2] == (2 * nx + 1, 2 * ny + 1)
        along, across = (1 if yarn == WARP else -1) * np.array([(-1, 1, 1), (1, -1, 1)]) * (1, 1, 1 - 2 * yarn)
        assert np.array_equal(full[nx:, ny:], part)
        assert np.allclose(full[nx::-1, ny:], part * along, rtol=0, atol=1e-18)
        assert np.allclose(full[nx:, ny::-1], part * across, rtol=0, atol=1e-18)
        _, areas = sections_of_bars(quarter, yarn)
        _, all_areas = sections_of_bars(whole, yarn)
        assert np.allclose(all_areas[0, ny + 1 :], areas[0, 1:], rtol=1e-12)
        assert np.allclose(all_areas[0, ny], 2 * areas[0, 0], rtol=1e-12)


@pytest.mark.parametrize("domain", ["quarter", "whole"])
def test_the_faces_of_a_yarn_close_its_volume(domain):
    """Divergence theorem on the outward faces: sum of x . n A = 3 V, and the vector area is zero."""
    crossover = mesh(domain=domain)
    volume = volumes(crossover.points, crossover.hexes)
    for yarn, name in ((WARP, "warp"), (WEFT, "weft")):
        quads = np.concatenate([q for key, q in crossover.faces.items() if key.startswith(name)])
        corners = crossover.points[quads]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
        # The flux of x through a bilinear face: the mean of its corners is not exact, its own 2 x 2 Gauss rule is.
        flux = 0.0
        for u in (-1, 1) / np.sqrt(3):
            for v in (-1, 1) / np.sqrt(3):
                shape = np.array([(1 - u) * (1 - v), (1 + u) * (1 - v), (1 + u) * (1 + v), (1 - u) * (1 + v)]) / 4
                du = np.array([-(1 - v), 1 - v, 1 + v, -(1 + v)]) / 4
                dv = np.array([-(1 - u), -(1 + u), 1 + u, 1 - u]) / 4
                x, xu, xv = (np.einsum("a,qax->qx", weight, corners) for weight in (shape, du, dv))
                flux += np.einsum("qx,qx->", x, np.cross(xu, xv))
        assert np.abs(normal.sum(axis=0)).max() < 1e-12 * np.abs(normal).sum()
        assert flux / 3 == pytest.approx(volume[crossover.yarn == yarn].sum(), rel=1e-10)


def test_groups_of_the_quarter():
    crossover = mesh()
    nx, ny, nz = (n - 1 for n in crossover.grids[WARP].shape)
    groups, points = crossover.groups, crossover.points
    counts = {"contact": nx * ny, "plate": nx * ny, "tip": nx * nz}
    nodes = {"end": (ny + 1) * (nz + 1)}
    for yarn, along, across in (("warp", "symx", "symy"), ("weft", "symy", "symx")):
        for part, count in counts.items():
            assert groups[f"{yarn}_{part}"].shape == (count, 4)
        assert len(groups[f"{yarn}_end"]) == nodes["end"] == len(groups[f"{yarn}_{along}"])
        assert len(groups[f"{yarn}_{across}"]) == (nx + 1) * (nz + 1)
        assert np.all(points[groups[f"{yarn}_symx"], 0] == 0)
        assert np.all(points[groups[f"{yarn}_symy"], 1] == 0)
    assert len(groups) == 12
    assert points[groups["warp_end"], 0] == pytest.approx(crossover.w[WARP], rel=1e-14)
    assert points[groups["weft_end"], 1] == pytest.approx(crossover.w[WEFT], rel=1e-14)
    on_planes = {(n, axis) for n, axis in np.argwhere(points[:, :2] == 0).tolist()}
    assert on_planes == {
        (n, axis) for axis, key in ((0, "symx"), (1, "symy")) for y in ("warp", "weft") for n in groups[f"{y}_{key}"]
    }


def test_groups_of_the_whole():
    crossover = mesh(domain="whole")
    names = {"contact", "plate", "tip", "end", "start"}
    assert set(crossover.groups) == {f"{yarn}_{name}" for yarn in ("warp", "weft") for name in names}
    assert crossover.points[crossover.groups["warp_start"], 0] == pytest.approx(-crossover.w[WARP], rel=1e-14)
    assert crossover.points[crossover.groups["weft_start"], 1] == pytest.approx(-crossover.w[WEFT], rel=1e-14)


def test_contact_faces_look_at_each_other_and_plates_away():
    crossover = mesh("S-731", domain="whole")
    for name, sign in (("warp_contact", -1), ("warp_plate", 1), ("weft_contact", 1), ("weft_plate", -1)):
        corners = crossover.points[crossover.faces[name]]
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        assert np.all(sign * normal[:, 2] > 0), name
    warp, weft = (crossover.points[crossover.faces[f"{yarn}_contact"]][..., 2] for yarn in ("warp", "weft"))
    plates = (crossover.points[crossover.faces[f"{yarn}_plate"]][..., 2] for yarn in ("warp", "weft"))
    top, bottom = plates
    assert top.max() > warp.max()
    assert bottom.min() < weft.min()


def test_grids_hold_every_node_once_in_its_place():
    crossover = mesh("S-731", (5, 4, 3))
    assert sorted(np.concatenate([g.ravel() for g in crossover.grids])) == list(range(len(crossover.points)))
    for yarn, axis in ((WARP, 0), (WEFT, 1)):
        grid = crossover.points[crossover.grids[yarn]]
        assert grid.shape[:3] == (6, 5, 4)
        assert np.all(np.diff(grid[..., axis], axis=0) > 0)
        assert np.all(np.diff(grid[..., 1 - axis], axis=1) > 0)
        assert np.all(np.diff(grid[..., 2], axis=2) > 0)
        assert np.array_equal(np.unique(crossover.hexes[crossover.yarn == yarn]), np.unique(crossover.grids[yarn]))
        middle = grid[:, :, 0, 2] / 2 + grid[:, :, -1, 2] / 2
        height = (middle[0] - middle[-1]) * (1 if yarn == WARP else -1)
        assert height == pytest.approx(crossover.h0[yarn], rel=1e-12)
    assert (
        crossover.points[crossover.grids[WARP]][..., 2].mean() > crossover.points[crossover.grids[WEFT]][..., 2].mean()
    )


def test_named_sizes_are_those_of_a_quarter():
    for size, shape in (("coarse", (9, 7, 3)), ("medium", (17, 13, 5)), ("fine", (25, 19, 7))):
        assert mesh(size=size).grids[WARP].shape == shape
    assert mesh(size="coarse", domain="whole").grids[WEFT].shape == (17, 13, 3)


def facet_gap(crossover):
    """Least gap of the bilinear contact facets of a quarter. Both are sums of a function of x and one of y, and
    linear between the stations of either yarn, so the least value is at the union of the stations."""
    lower = crossover.points[crossover.grids[WARP][:, :, 0]]
    upper = crossover.points[crossover.grids[WEFT][:, :, -1]].swapaxes(0, 1)
    least = -(lower[0, 0, 2] - upper[0, 0, 2])
    for axis in (0, 1):
        a, b = (np.moveaxis(sheet, axis, 0)[:, 0] for sheet in (lower, upper))
        s = np.union1d(a[:, axis], b[:, axis])
        s = s[s <= min(a[-1, axis], b[-1, axis])]
        least += np.min(np.interp(s, a[:, axis], a[:, 2]) - np.interp(s, b[:, axis], b[:, 2]))
    return least


@pytest.mark.parametrize("kind", ["sine", "ellipse"])
@pytest.mark.parametrize("name", WOVEN)
def test_facets_overlap_by_no_more_than_their_sag(name, kind):
    """Chords of two surfaces of curvature c stay within c ds^2 / 8 of them: the order-two price of flat facets."""
    for size in ("coarse", "medium", "fine"):
        crossover = mesh(name, size, section=kind)
        sag = 0.0
        for yarn, (w, h) in enumerate(zip(crossover.w, crossover.h0)):
            ds = w / (crossover.grids[yarn].shape[0] - 1)
            sag += h * (np.pi / (2 * w)) ** 2 * ds**2 / 8
        assert facet_gap(crossover) > -sag


def test_a_gap_between_yarns_narrows_both():
    wide, narrow = mesh(), mesh(gap=5e-5)
    for a, b in zip(wide.sections, narrow.sections):
        assert b.width == pytest.approx(a.width - 5e-5, rel=1e-12)
        assert b.area == pytest.approx(a.area, rel=1e-12)
