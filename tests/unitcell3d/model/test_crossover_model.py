"""The assembled crossover: constraints, tangent, symmetry, balance."""

from dataclasses import replace

import numpy as np
import pytest
from equations import assert_model_tangent

from fabrics import catalogue
from fabrics.base.errors import InputError
from meshing import crossover as mesher
from unitcell3d.assembly import constraints
from unitcell3d.material.numerics import Numerics, fraction_of
from unitcell3d.model import crossover as crossover_model
from unitcell3d.model.crossover import CrossoverModel, Load


@pytest.fixture(scope="module")
def model(tiny, s720):
    return CrossoverModel(tiny, s720)


@pytest.fixture(scope="module")
def pressed(model):
    """Unknowns and a load with contact, taut and slack fibres, and both plates at work."""
    load = Load((4e-6, 6e-6), 0.97 * model.plates.at_rest)
    rng = np.random.default_rng(7)
    q = 2e-7 * rng.standard_normal(model.size)
    lower = np.concatenate([model.constraints.unknown[3 * model.crossover.grids[0].ravel() + 2]])
    q[np.unique(lower[lower >= 0])] -= 4e-6  # the warp onto the weft
    return q, load


def test_end_face_turns_about_the_two_fold_axis(tiny, s720):
    fixed = constraints.build(tiny.grids, len(tiny.points), quarter=True)
    q = np.random.default_rng(0).standard_normal(fixed.size)
    d = (0.3, -0.2)
    u = fixed.displacement(q, d)
    for yarn, grid in enumerate(tiny.grids):
        face = u[grid[-1]]
        axial = constraints.AXIAL[yarn]
        width = constraints.WIDTH[yarn]
        assert np.allclose(face[..., axial] - d[yarn], -(face[:, ::-1, axial] - d[yarn]))
        assert np.allclose(face[..., 2], -face[:, ::-1, 2])
        assert np.allclose(face[..., width], face[:, ::-1, width])
        assert np.all(u[grid[0], axial] == 0)
        assert np.all(u[grid[:, 0], width] == 0)


def test_reduction_is_the_transpose_of_the_expansion(tiny):
    """Virtual work: forces . displacement = reduced forces . unknowns, and the end force is conjugate to d."""
    fixed = constraints.build(tiny.grids, len(tiny.points), quarter=True)
    rng = np.random.default_rng(1)
    q = rng.standard_normal(fixed.size)
    f = rng.standard_normal(tiny.points.shape)
    work = np.sum(f * fixed.displacement(q, (0, 0)))
    assert fixed.reduce(f) @ q == pytest.approx(work, rel=1e-12)
    for yarn in (0, 1):
        d = np.eye(2)[yarn]
        moved = np.sum(f * fixed.displacement(np.zeros(fixed.size), d))
        assert fixed.end_force(f, yarn) == pytest.approx(moved, rel=1e-12)


def test_tangent_is_the_derivative(model, pressed):
    q, load = pressed
    _, contact, plates = model.forces(q, load)
    assert contact > 0
    assert plates.max() > 0
    model.system(q, load)
    direction = np.random.default_rng(2).standard_normal(model.size)
    assert_model_tangent(model, q, load, direction)


def test_pattern_grows_only_where_contact_moves_far(s720, coarse):
    model = CrossoverModel(coarse, s720)
    grid = coarse.grids[0]
    fixed = model.constraints
    q = np.zeros(model.size)
    lower = fixed.unknown[3 * grid.ravel() + 2]
    q[np.unique(lower[lower >= 0])] -= 5e-6
    model.forces(q, Load())
    rows = len(model.pattern.values)
    assert not model.system(q, Load())
    q[fixed.unknown[3 * grid[1:-1].ravel()]] -= 0.06e-3  # more than half a cell of the weft
    model.forces(q, Load())
    assert model.system(q, Load())
    assert len(model.pattern.values) > rows
    assert not model.system(q, Load())


def test_the_fibre_fraction_of_the_law_is_the_one_that_is_chosen():
    """S-726 states 0.70 and 0.62, its sections have room for 0.73 and 0.65: only V_c / Vf0 counts from rest on."""
    fabric = catalogue.load("S-726")
    mesh = mesher.build(fabric, size=(2, 2, 1))
    family = np.asarray(mesh.families)[mesh.yarn]
    for chosen, expected in (
        ("mesh", mesh.Vf0),
        ("stated", (0.70, 0.62)),
        (None, (0.70, 0.62)),  # as published together with V_c
    ):
        model = CrossoverModel(mesh, fabric, Numerics(fibre_fraction=chosen))
        assert crossover_model._cell_laws(mesh, fabric, chosen)[:, 3] == pytest.approx(
            np.asarray(expected)[family]
        )
        squeezed = model.points * (1, 1, 0.9)
        model._deform(squeezed)
        forces = model._solids.residual()
        if chosen == "mesh":
            dense = abs(forces).max()
    # the denser yarn is closer to packed, and stiffer
    assert abs(forces).max() < 0.98 * dense
    with pytest.raises(InputError, match="fibre_fraction = 'own': must be mesh or stated"):
        Numerics(fibre_fraction="own")


def told(packed, at_rest, family="warp"):
    """Sources of V_c and Vf0 of a family."""
    return {f"solid.{family}.V_c": {"source": packed}, f"solid.{family}.Vf0": {"source": at_rest}}


@pytest.mark.parametrize(
    ("warp", "weft", "assumed", "expected"),
    [
        (("Table 3-2", "Table 3-2 (nominal)"), ("Table 3-2", "Table 3-2"), (), "stated"),
        (("Table 3-2", "Table 3-2"), ("Table 3-2", "micrographs"), (), "mesh"),
        (("packing of fibres", "Table 3-2"), ("Table 3-2", "Table 3-2"), (), "mesh"),
        (("", ""), ("", ""), (), "mesh"),
        (("Table 3-2", "Table 3-2"), ("Table 3-2", "Table 3-2"), ("solid",), "mesh"),
    ],
)
def test_a_pair_of_one_source_belongs_together(warp, weft, assumed, expected):
    sources = told(*warp) | told(*weft, "weft")
    fabric = replace(catalogue.load("S-720"), sources=sources, assumed=assumed)
    assert fraction_of(fabric) == expected


def test_the_pairs_of_the_catalogue():
    """Kevlar has the pair of S-720; of glass V_c alone is that of Kevlar."""
    fractions = {name: fraction_of(catalogue.load(name)) for name in catalogue.list_names()}
    assert fractions["S-720"] == fractions["S-731"] == "stated"
    assert fractions["glass-balanced"] == "mesh"
