"""Crimp by hand or from micrographs, element sizes found or given, and the deliberate bad cases of both builders."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from meshing import crossover, patch

BUILDERS = [crossover.build, patch.build]


def test_micrograph_crimp_is_that_of_table_a_3():
    """Source thesis Table A-3: S-720 with 3.21 and 2.68 %; the yarns get longer and higher by it (eqs 4-4, 4-5)."""
    fabric = catalogue.load("S-720")
    hand, micrograph = (crossover.build(fabric, size="coarse", crimp=crimp) for crimp in ("hand", "micrograph"))
    for i, (by_hand, by_picture) in enumerate([(0.0218, 0.0321), (0.0139, 0.0268)]):
        assert hand.S0[i] == pytest.approx(2 * hand.w[i] * (1 + by_hand), rel=1e-12)
        assert micrograph.S0[i] == pytest.approx(2 * hand.w[i] * (1 + by_picture), rel=1e-12)
        assert micrograph.h0[i] > 1.1 * hand.h0[i]
    line = micrograph.points[micrograph.grids[0][:, 0].mean(axis=-1).astype(int)]
    assert 2 * np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(micrograph.S0[0], rel=1e-3)


@pytest.mark.parametrize("name", ["S-726", "S-727", "S-728", "S-731", "S-745"])
def test_every_fabric_meshes_with_micrograph_crimp(name):
    assert crossover.build(catalogue.load(name), size="coarse", crimp="micrograph").min_scaled_jacobian > 0.5


def test_bad_crimp():
    with pytest.raises(InputError) as caught:
        crossover.build(catalogue.load("S-720"), crimp="guessed")
    assert str(caught.value) == "crimp = 'guessed': must be hand or micrograph"
    with pytest.raises(InputError) as caught:
        crossover.build(replace(catalogue.load("S-720"), micrograph={}), crimp="micrograph")
    assert str(caught.value) == ("fabric S-720 has no micrographs of warp and weft: its crimp is that measured by hand")


@pytest.mark.parametrize("build", BUILDERS)
@pytest.mark.parametrize("length", [4e-5, 1e-4, 3e-4])
def test_no_edge_is_longer_than_the_length_asked_for(build, length):
    mesh = build(catalogue.load("S-726"), size=length)
    corners = mesh.points[mesh.hexes]
    along, across = (np.abs(np.diff(corners[:, [0, k]], axis=1)[:, 0]) for k in (1, 3))
    assert max(along[:, :2].max(), across[:, :2].max()) <= length * (1 + 1e-9)
    assert max(section.thickness for section in mesh.sections) / (mesh.grids[0].shape[2] - 1) <= length


def test_automatic_size_keeps_the_proportions_of_an_element():
    """Two layers; edges along and across at most 1.5 element heights of the thinner yarn, and no finer than needed."""
    for name in ("S-720", "S-731", "S-745"):
        mesh = crossover.build(catalogue.load(name), size="auto")
        nx, ny, nz = (n - 1 for n in mesh.grids[0].shape)
        height = min(section.thickness for section in mesh.sections) / 2
        assert nz == 2
        assert max(mesh.w) / nx <= 1.5 * height < max(mesh.w) / (nx - 1)
        half = max(section.half_width for section in mesh.sections)
        assert half / ny <= 1.5 * height < half / (ny - 1)


@pytest.mark.parametrize("build", BUILDERS)
def test_overlap_refused(build):
    with pytest.raises(InputError) as caught:
        build(catalogue.load("S-720"), section="ellipse", overlap="refuse")
    limit = ", more than the 4.3 um that a shift may remove" if build is crossover.build else ""
    assert str(caught.value) == (
        f"the ellipse sections of warp and weft overlap by 40.5 um{limit}: narrow them, or let the overlap be solved"
    )


@pytest.mark.parametrize("build", BUILDERS)
def test_no_gap_and_yarns_too_wide_for_their_crossing(build):
    weave = catalogue.load("S-731").weave
    with pytest.raises(InputError) as caught:
        build(catalogue.load("S-731"), section="sine", width=(2 * weave.w2, 2 * weave.w1))
    assert str(caught.value) == (
        "the sine sections of warp and weft overlap by 44.0 um even at the closest packing of the fibres "
        "(Vf0 = 0.907): try other widths or another section"
    )


@pytest.mark.parametrize("build", BUILDERS)
def test_width_above_the_spacing(build):
    with pytest.raises(InputError) as caught:
        build(catalogue.load("S-720"), width=(1.2e-3, 1.4e-3))
    assert str(caught.value) == "weft width = 0.0014: must be above 0 and at most the spacing, 0.00127 m"


@pytest.mark.parametrize("build", BUILDERS)
def test_negative_crimp(build):
    fabric = catalogue.load("S-720")
    pictures = fabric.micrograph | {"weft": fabric.micrograph["weft"] | {"crimp": -0.01}}
    with pytest.raises(InputError) as caught:
        build(replace(fabric, micrograph=pictures), crimp="micrograph")
    assert str(caught.value) == "crimp = -0.01: must be a fraction from 0 to below 1 (0.02 or 2 %)"


def test_the_width_of_the_yarns_is_that_of_the_sections():
    """Without gap and width a mesh has the fabric's widths; a gap replaces them."""
    fabric = replace(catalogue.load("S-728"), yarn_width=(1.3e-3, None), section="sine")
    sections = [crossover.build(fabric, size="coarse", **gap).section_fit.requested for gap in ({}, {"gap": 1e-4})]
    spacing = [2 * w for w in fabric.weave.w][::-1]
    assert [section.width for section in sections[0]] == pytest.approx([1.3e-3, spacing[1]])
    assert [section.width for section in sections[1]] == pytest.approx([s - 1e-4 for s in spacing])
