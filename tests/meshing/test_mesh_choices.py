"""Crimp by hand or from micrographs, widths of the yarns, and element sizes found or given."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import catalogue
from meshing import crossover, patch


def test_micrograph_crimp_is_that_of_table_a_3():
    """Source thesis Table A-3: S-720 with 3.21 and 2.68 %; the yarns get longer and higher by it (eqs 4-4, 4-5)."""
    fabric = catalogue.load("S-720")
    hand, micrograph = (
        crossover.build(fabric, size="coarse", crimp=crimp) for crimp in ("hand", "micrograph")
    )
    for i, (by_hand, by_picture) in enumerate([(0.0218, 0.0321), (0.0139, 0.0268)]):
        assert hand.S0[i] == pytest.approx(2 * hand.w[i] * (1 + by_hand), rel=1e-12)
        assert micrograph.S0[i] == pytest.approx(2 * hand.w[i] * (1 + by_picture), rel=1e-12)
        assert micrograph.h0[i] > 1.1 * hand.h0[i]


@pytest.mark.parametrize("name", ["S-726", "S-727", "S-728", "S-731", "S-745"])
def test_every_fabric_meshes_with_micrograph_crimp(name):
    assert (
        crossover.build(catalogue.load(name), size="coarse", crimp="micrograph").min_scaled_jacobian
        > 0.5
    )


@pytest.mark.parametrize("build", [crossover.build, patch.build])
@pytest.mark.parametrize("length", [4e-5, 1e-4, 3e-4])
def test_no_edge_is_longer_than_the_length_asked_for(build, length):
    mesh = build(catalogue.load("S-726"), size=length)
    corners = mesh.points[mesh.hexes]
    for neighbour in (1, 3, 4):
        edges = np.linalg.norm(corners[:, neighbour] - corners[:, 0], axis=1)
        assert edges.max() <= length * (1 + 1e-6)


def test_automatic_size_keeps_the_proportions_of_an_element():
    """Two layers; edges along and across at most 1.5 element heights of the thinner yarn, and no finer than needed."""
    for name in ("S-720", "S-731", "S-745"):
        mesh = crossover.build(catalogue.load(name), size="auto")
        nx, ny, nz = (n - 1 for n in mesh.grids[0].shape)
        height = min(section.thickness for section in mesh.sections) / 2
        assert nz == 2
        fibre = max(mesh.S0) / 2
        assert fibre / nx <= 1.5 * height < fibre / (nx - 1)
        faces = [mesh.points[grid[0, :, -1]] for grid in mesh.grids]
        face = max(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in faces)
        assert face / ny <= 1.5 * height < 1.001 * face / (ny - 1)


def test_the_width_of_the_yarns_is_that_of_the_sections():
    """Without gap and width a mesh has the fabric's widths; a gap or widths replace them."""
    fabric = replace(catalogue.load("S-728"), yarn_width=(1.3e-3, None), section="sine")
    s1, s2 = [2 * w for w in fabric.weave.w][::-1]
    for choices, widths in (
        ({}, [1.3e-3, s2]),
        ({"gap": 1e-4}, [s1 - 1e-4, s2 - 1e-4]),
        ({"width": (1.25e-3, 1.2e-3)}, [1.25e-3, 1.2e-3]),
    ):
        requested = crossover.build(fabric, size="coarse", **choices).section_fit.requested
        assert [section.width for section in requested] == pytest.approx(widths)
