"""Weaving damage: stiffness and strength scale by the retained shares, and the sources say where these come from."""

import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.yarn import WeavingDamage


@pytest.mark.parametrize(("modulus", "strength"), [(1.0, 1.0), (0.9, 0.8), (1.0, 0.8), (0.8, 0.9)])
def test_stiffness_and_strength_scale(modulus, strength):
    fabric = catalogue.load("S-726")
    woven = fabric.with_weaving_damage(WeavingDamage(modulus, strength, "made up"))
    for before, after in zip(fabric.weave.yarns, woven.weave.yarns):
        assert after.EA == pytest.approx(modulus * before.EA)
        assert after.strength == pytest.approx(strength * before.strength)
        assert after.wave_speed == pytest.approx(modulus**0.5 * before.wave_speed)
        assert (after.linear_density, after.crimp) == (before.linear_density, before.crimp)
    assert woven.laws == fabric.laws
    assert woven.sources["weaving_damage.strength"] == {"value": strength, "source": "made up", "status": "assumed"}
    assert woven.sources.items() >= fabric.sources.items()


@pytest.mark.parametrize(
    ("key", "value"),
    [("modulus", 0.0), ("strength", 1.1), ("strength", float("nan")), ("status", "likely"), ("source", "")],
)
def test_bad_values(key, value):
    given = {"modulus": 0.9, "strength": 0.9, "source": "made up", "status": "assumed"} | {key: value}
    with pytest.raises(InputError, match=f"weaving_damage.{key}"):
        WeavingDamage(**given)
