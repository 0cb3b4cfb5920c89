"""Ballistic limits of packs: the search, and the fabrics with other fibres and sizes."""

import pytest

from fabrics import catalogue
from validation.published.packs import limits


def test_a_fabric_of_another_size_is_similar():
    fabric = catalogue.load("S-728")
    large = limits.changed(fabric, limits.Case(("S-728",), size=2.0, mass=4.0))
    assert large.weave.areal_density == pytest.approx(2 * fabric.weave.areal_density)
    assert large.weave.thickness == pytest.approx(2 * fabric.weave.thickness)
    for law, wide in zip(fabric.laws, large.laws):  # the same closure, relative to its size, at the same pressure
        F = 3.0
        assert wide.d(4 * F) == pytest.approx(2 * law.d(F))


def test_factors_leave_the_mass():
    fabric = catalogue.load("S-728")
    other = limits.changed(fabric, limits.Case(("S-728",), factors=(2.0, 0.7, 1.4)))
    (old, _), (new, _) = fabric.weave.yarns, other.weave.yarns
    assert other.weave.areal_density == pytest.approx(fabric.weave.areal_density)
    assert (new.E / old.E, new.failure_strain / old.failure_strain) == pytest.approx((2.0, 0.7))
    assert new.fibre_density / old.fibre_density == pytest.approx(1.4)


def test_one_fine_ply_weighs_as_much_as_four():
    fabric = catalogue.load("S-728")
    plies, size, mass, _ = limits.SIZES[-1]
    heavy = limits.changed(fabric, limits.Case(("S-728",) * plies, size=size, mass=mass))
    assert heavy.weave.areal_density * plies == pytest.approx(2 * fabric.weave.areal_density)
    assert heavy.weave.warp_count == pytest.approx(2 * fabric.weave.warp_count)
    assert heavy.laws[0].d(3.0) == pytest.approx(size * fabric.laws[0].d(3.0 / mass))


def test_a_case_with_friction_is_a_pack_with_friction():
    pack = limits.pack(limits.Case(("S-728",) * 2, elements=1, frictions=(0.1, 0.2, 0.3)))
    assert (pack.friction, pack.plies[0].projectile.friction) == (0.1, 0.3)
    assert [one.mu for one in pack.crossovers] == [0.2, 0.2]


def test_a_torn_ply_on_a_fine_mesh_gains_no_energy():
    """Lines beside a failed yarn are drawn out beyond the cell's table; with the polynomials of its last cells there
    this shot gained 5 % of its energy and was stopped."""
    coarse = limits.Case(("S-728",), size=2.0, mass=4.0, elements=8)
    assert limits.shoot(coarse, 285.0)["balance"] < 2e-3
