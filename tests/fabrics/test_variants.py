"""Every way to change a fabric, by what it keeps and what it changes."""

from dataclasses import fields, replace

import pytest

from fabrics import assumed, catalogue, variants
from fabrics.yarn import WeavingDamage
from validation.models import variants as comparison


@pytest.fixture(scope="module")
def fabric():
    return catalogue.load("S-720")


def test_areal_density_alone(fabric):
    """Twice the mass: the stiffness, strength and failure strain of the yarns stay, and so does all but E and mass."""
    heavy = variants.scale_areal_density(fabric, 2.0)
    assert heavy.weave.areal_density == 2 * fabric.weave.areal_density
    for before, after in zip(fabric.weave.yarns, heavy.weave.yarns):
        assert after.EA == pytest.approx(before.EA, rel=1e-15)
        assert after.wave_speed == pytest.approx(before.wave_speed / 2**0.5, rel=1e-15)
        assert replace(after, E=before.E, linear_density=before.linear_density) == before


def test_weaving_damage_scales_stiffness_and_strength(fabric):
    woven = fabric.with_weaving_damage(WeavingDamage(0.9, 0.8, "made up"))
    for before, after in zip(fabric.weave.yarns, woven.weave.yarns):
        assert after.EA == pytest.approx(0.9 * before.EA)
        assert after.strength == pytest.approx(0.8 * before.strength)
        assert after.wave_speed == pytest.approx(0.9**0.5 * before.wave_speed)
        assert after.linear_density == before.linear_density
        assert after.crimp == before.crimp
    assert woven.laws == fabric.laws
    assert woven.sources["weaving_damage.strength"] == {
        "value": 0.8,
        "source": "made up",
        "status": "assumed",
    }
    assert woven.sources.items() >= fabric.sources.items()


def test_yarns_one_value_or_two(fabric):
    both = fabric.with_yarns(crimp=0.01, E=(70e9, 80e9))
    assert [(yarn.crimp, yarn.E) for yarn in both.weave.yarns] == [(0.01, 70e9), (0.01, 80e9)]
    scaled = variants.scale_yarns(fabric, crimp=(2.0, 0.5))
    assert [new.crimp / old.crimp for new, old in zip(scaled.weave.yarns, fabric.weave.yarns)] == [
        2.0,
        0.5,
    ]
    assert variants.scale_yarns(fabric, E=1.0) == fabric.with_yarns() == fabric


def test_linear_density(fabric):
    assert variants.with_linear_density(fabric, "nominal") is fabric
    used = variants.with_linear_density(fabric)
    assert (
        tuple(yarn.linear_density for yarn in used.weave.yarns) == fabric.effective_linear_density
    )
    assert (
        variants.with_linear_density(replace(fabric, effective_linear_density=None)).weave
        == fabric.weave
    )


def test_straight_yarns_keep_the_shear_force_per_width(fabric):
    thin = comparison.with_straight_yarns(fabric)
    assert thin.weave.thickness < 0.05 * fabric.weave.thickness
    for angle in (0.05, 0.3, 0.8):
        forces = [one.shear.stress(angle) * one.weave.thickness for one in (fabric, thin)]
        assert forces[1] == pytest.approx(forces[0], rel=1e-12)


def test_trellis_and_laws(fabric):
    soft = variants.scale_shear(fabric, moduli=0.5, angles=2.0)
    # half the slope, twice as far
    assert soft.shear.stress(0.2) == pytest.approx(fabric.shear.stress(0.1), rel=1e-12)
    assert variants.with_shear(fabric, G2=fabric.shear.G1).shear.G2 == fabric.shear.G1
    half = variants.scale_laws(fabric, 0.5, 0.5)
    for before, after in zip(fabric.laws, half.laws):
        assert after.d(3.0) == pytest.approx(0.5 * before.d(3.0), rel=1e-12)
    assert [law.form for law in comparison.with_law_form(fabric, "printed").laws] == [
        "printed",
        "printed",
    ]


def test_solids(fabric):
    changed = variants.with_solids(fabric, Vf0=(0.6, 0.55))
    assert [law.Vf0 for law in changed.solid_laws] == [0.6, 0.55]
    stiff = comparison.scale_solids(fabric, {"E_c": 2.0})
    for before, after in zip(fabric.solid_laws, stiff.solid_laws):
        assert after.transverse_modulus(0.75) == pytest.approx(
            2 * before.transverse_modulus(0.75), rel=1e-12
        )


def test_failure_length(fabric):
    changed = variants.with_failure_length(fabric, 1e-3)
    assert changed.failure_length == 1e-3
    assert changed.assumed == ()
    assert replace(changed, failure_length=fabric.failure_length, assumed=fabric.assumed) == fabric


def test_a_right_angle_four_times(fabric):
    once = variants.rotated_90(fabric)
    assert (once.weave.w, once.weave.yarns, once.laws) == tuple(
        pair[::-1] for pair in (fabric.weave.w, fabric.weave.yarns, fabric.laws)
    )
    assert variants.rotated_90(once) == fabric


@pytest.mark.parametrize("name", catalogue.list_names())
def test_a_turned_fabric_has_all_pairs_exchanged(name):
    """All fields that are of (warp, weft), and the numbers of sources and ranges, which name their family."""
    known = assumed.with_ranges_of_guesses(assumed.with_solid_laws(catalogue.load(name)))
    unlike = replace(
        variants.with_solids(known, E_c=300e6),
        yarn_width=(1.1e-3, 1.3e-3),
        yarn_area=(1e-7, 2e-7),
        ranges={"warp.crimp": (0.5, 2.0), "solid.weft.E_c": (0.8, 1.3), "failure_length": (0.5, 2)},
        guessed=("shear.G1", "warp.modulus"),
    )
    warp, weft = unlike.solid_laws
    unlike = replace(unlike, solid_laws=(warp, replace(weft, E_c=500e6)))
    turned = variants.rotated_90(unlike)
    pairs = 0
    for entry in fields(unlike):
        value = getattr(unlike, entry.name)
        if (
            isinstance(value, tuple)
            and len(value) == 2
            and entry.name not in ("assumed", "guessed")
        ):
            assert getattr(turned, entry.name) == value[::-1], entry.name
            pairs += 1
    assert pairs >= 3
    assert turned.weave.yarns == unlike.weave.yarns[::-1]
    assert turned.ranges == {
        "weft.crimp": (0.5, 2.0),
        "solid.warp.E_c": (0.8, 1.3),
        "failure_length": (0.5, 2),
    }
    assert turned.guessed == ("shear.G1", "weft.modulus")
    assert turned.sources["weft.crimp"] == unlike.sources["warp.crimp"]
    assert assumed.transverse_moduli(turned) == (500e6, 300e6)
    assert variants.rotated_90(turned) == unlike


def test_laws_that_a_fabric_does_not_have_are_not_scaled(fabric):
    bare = replace(fabric, laws=None, shear=None)
    assert variants.scale_laws(bare, 2.0) == variants.scale_shear(bare, 2.0) == bare
