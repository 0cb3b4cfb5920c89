"""The grid of a body of metal is the body: each element a ring of hexahedra."""

from types import SimpleNamespace as Given

import numpy as np
import pytest

from weavecell.results import vtk


def test_rings_have_the_volume_of_their_elements():
    """Two elements of unlike size off the axis; a polygon of 24 sides is 1.1 % smaller than its circle."""
    pytest.importorskip("pyvista")
    nodes = np.array([[1.0, 0.0], [3.0, 0.0], [4.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 2.0]])
    corners = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    found = Given(
        nodes=nodes,
        place=np.array([7.0, -5.0, 3.0]),
        drawn=Given(corners=corners, jacketed=np.array([False, True])),
        plastic=np.array([0.2, 0.5]),
        strain=np.array([0.3, 0.7]),
    )
    made = vtk.body(found)
    volumes = np.abs(made.compute_cell_sizes()["Volume"]).reshape(2, vtk.AROUND)
    polygon = vtk.AROUND / 2 * np.sin(2 * np.pi / vtk.AROUND)
    assert volumes.sum(axis=1) == pytest.approx([polygon * 2 * 8, polygon * 2 * 7], rel=1e-6)
    assert volumes.max(axis=1) == pytest.approx(volumes.min(axis=1), rel=1e-6)
    jacket = np.array(made["jacket"]).reshape(2, -1)
    assert (jacket == [[0], [1]]).all()
    assert made.center[:2] == pytest.approx((7.0, -5.0))
