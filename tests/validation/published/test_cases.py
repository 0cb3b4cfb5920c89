"""Cases of the published tests: each has the masses, stiffnesses and laws that it says, and comes out as stored."""

from dataclasses import replace
from math import sqrt

import pytest

from fabrics import catalogue
from shellfabric.membrane.numerics import Numerics
from tests.shellfabric.panels import BLOCK
from validation.cases import block, impact

S728 = catalogue.load("S-728")


def test_waves_in_a_ply_are_slower_than_in_a_lone_yarn():
    shot = impact.shot(
        fabric="S-720", velocity=92.5, elements_per_crossover=1, history={"interval": "1 us"}
    )
    assert shot["outcome"] == "stopped"
    for family, yarn in zip(("warp", "weft"), catalogue.load("S-720").weave.yarns):
        fronts = [shot["fronts"][f"{kind} {family}"] for kind in ("transverse", "longitudinal")]
        assert fronts[0] < fronts[1] < yarn.wave_speed / sqrt(2)
    assert 0.5 < shot["kinetic"] < 4


def test_a_torn_ply_on_a_fine_mesh_gains_no_energy():
    """Lines beside a failed yarn are drawn out beyond the cell's table; with the polynomials of its last cells there
    this shot gained 5 % of its energy and was stopped."""
    change = {"size": 2.0, "mass": 4.0}
    shot = impact.shot(
        fabric="S-728",
        velocity=285.0,
        projectile="FSP 1.10 g",
        change=change,
        elements_per_crossover=8,
    )
    assert shot["energy_error_max"] < 2e-3


@pytest.mark.parametrize("plies, modulus, mass", [(1, 5.0, 1.155), (4, 1.0, 1.155)])
def test_a_target_has_the_mass_and_modulus_of_its_case(plies, modulus, mass):
    """Table 6-2: areal density 1.155 kg/m2 of 1 or 4 plies, modulus 480 and 96 GPa."""
    solver = block.march(
        plies, modulus, mass, boundary="clamped", block=BLOCK, elements=1, opening=0.05
    )
    weaves = [ply.weave for ply in solver.pack.plies]
    ply = solver.pack.plies[0]
    assert len(weaves) == plies
    assert sum(weave.areal_density for weave in weaves) == pytest.approx(mass, rel=1e-9)
    # E A of a yarn is that of S-728 times the factor, whatever the mass
    assert weaves[0].warp.EA == pytest.approx(modulus * 96e9 * 1.7039e-4 / 1440, rel=1e-3)
    assert not ply.yarn_failure
    # stiff yarns take half the usual step; that of the contact may be shorter
    assert ply.time_step == pytest.approx(
        0.5 * replace(ply, numerics=Numerics()).time_step, rel=1e-12
    )
    assert solver.const.dt == solver.pack.time_step <= ply.time_step


def test_fabrics_of_other_size_or_fibre_are_similar():
    """The same closure, relative to the size, at the same pressure; other fibres leave the mass."""
    large = impact.changed(S728, size=2.0, mass=4.0)
    assert large.weave.areal_density == pytest.approx(2 * S728.weave.areal_density)
    assert large.weave.thickness == pytest.approx(2 * S728.weave.thickness)
    for law, wide in zip(S728.laws, large.laws):
        assert wide.d(4 * 3.0) == pytest.approx(2 * law.d(3.0))
    other = impact.changed(S728, yarns={"E": 2.0, "failure_strain": 0.7, "fibre_density": 1.4})
    old = S728.weave.warp
    new = other.weave.warp
    assert other.weave.areal_density == pytest.approx(S728.weave.areal_density)
    ratios = (
        new.E / old.E,
        new.failure_strain / old.failure_strain,
        new.fibre_density / old.fibre_density,
    )
    assert ratios == pytest.approx((2.0, 0.7, 1.4))
