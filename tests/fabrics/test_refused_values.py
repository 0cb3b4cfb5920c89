"""What the objects of fabrics refuse: one line that says what is wrong. Files are refused by rows of tests/refusals."""

from dataclasses import replace

import numpy as np
import pytest

from fabrics import assumed, catalogue, ply_laws, variants
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from fabrics.friction.pull_out import PullOutLaw
from fabrics.plate_curve import PlateCurve
from fabrics.surface import ResponseSurface
from fabrics.trellis import touching_angle
from fabrics.weave import height_from_length
from fabrics.yarn import WeavingDamage
from unitcell3d.identify.ratio_law import RatioLaw
from validation.models import variants as comparison

S720, S726, GLASS = (catalogue.load(name) for name in ("S-720", "S-726", "glass-balanced"))
BARE = replace(S720, laws=None, shear=None, solid_laws=None)
# of no family of fibres
UNKNOWN = replace(
    S720.with_yarns(E=20e9), solid_laws=None, ply_contact=None, areal_density_measured=None
)


def damage(**changes):
    return WeavingDamage(
        **({"modulus": 0.9, "strength": 0.9, "source": "made up", "status": "assumed"} | changes)
    )


def surface(**changes):
    axes = {"d1": np.linspace(0, 3e-5, 4), "d2": np.linspace(0, 2e-5, 3)}
    return ResponseSurface(
        **(axes | dict.fromkeys(("T1", "T2", "F_c", "h1", "h2"), np.zeros((4, 3))) | changes)
    )


REFUSED = [
    (lambda: catalogue.load("S-999"), "fabric = 'S-999': must be one of S-720"),
    (lambda: catalogue.load("none.toml"), "none.toml: the fabric file cannot be read"),
    (lambda: height_from_length(1e-3, 1.9e-3), ".*at least the cell length"),
    (lambda: touching_angle(1.27e-3, 1.27e-3), ".*below the spacing"),
    (lambda: S720.with_yarns(crimp=1.5), "crimp"),
    (lambda: GLASS.with_effective_density(), "fabric glass-balanced has no effective"),
    (
        lambda: assumed.with_strain_rate(GLASS),
        r".*glass-balanced has no \[strain_rate\].*no numbers of E-glass yarns",
    ),
    (
        lambda: assumed.with_strain_rate(UNKNOWN),
        r".*S-720 has no \[strain_rate\].*none of para-aramid",
    ),
    (lambda: ply_laws.default(UNKNOWN), r".*has no \[solid\] "),
    (lambda: comparison.with_law_form(BARE, "printed"), "fabric S-720 has no"),
    (lambda: variants.with_shear(BARE, G1=1e6), "fabric S-720 has no"),
    (lambda: variants.with_solids(BARE, E_c=1e9), "fabric S-720 has no"),
    (
        lambda: variants.with_failure_length(S720, 0.0),
        "failure_length = 0.0: must be a positive number",
    ),
    (lambda: damage(modulus=0.0), "weaving_damage.modulus"),
    (lambda: damage(strength=1.1), "weaving_damage.strength"),
    (lambda: damage(strength=float("nan")), "weaving_damage.strength"),
    (lambda: damage(status="likely"), "weaving_damage.status"),
    (lambda: damage(source=""), "weaving_damage.source"),
    (lambda: CompressionLaw(-1e-5, 6e-5), "a = "),
    (lambda: CompressionLaw(4e-5, float("nan")), "b = "),
    (lambda: CompressionLaw(0.0, 6e-5), "b = "),
    (lambda: CompressionLaw(4e-5, 6e-5, "cubic"), "form = "),
    (
        lambda: CompressionLaw.fit([0, 0, 0, 1, 2], [0, 0, 0, 1e-6, 2e-6]),
        ".*at least three samples",
    ),
    (lambda: RatioLaw.fit([1, 2, 0], [0, 0, 0], [1e-6, 2e-6, 0]), ".*at least five samples"),
    (lambda: PullOutLaw.fit((3.0, 3.0), (1.0, 1.0)), ".*two different"),
    (lambda: PlateCurve.pressure_law(0.2665, 3), "plies = 3: must be 1, 4, 8 or 16"),
    (lambda: PlateCurve.pressure_law(0.14), ".*above 0.1483 kg/m2, where K'' vanishes"),
    (lambda: surface(d1=np.array([0, 2e-5, 1e-5, 3e-5])), "d1: must be a rising axis"),
    (lambda: surface(T1=np.zeros((3, 4))), "T1: must be finite, of shape"),
]


@pytest.mark.parametrize("make, line", REFUSED, ids=range(len(REFUSED)))
def test_one_line_says_what_is_wrong(make, line):
    with pytest.raises(InputError, match=f"^{line}") as caught:
        make()
    assert "\n" not in str(caught.value)
