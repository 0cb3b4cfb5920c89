"""A claim is missed when the product is wrong in what its check computes from, by the condition that is meant.

That all these claims are reproduced by the product as it stands is held in `test_claims.py`.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from shellfabric.cell.model import CellModel
from shellfabric.coupon.model import Coupon
from shellfabric.membrane.model import Panel
from shellfabric.projectile.bar import Bar
from validation.claims import checks, judge, runner
from validation.claims import claims as data
from validation.claims.checks import compression, weave

CLAIMS = {claim.id: claim for claim in data.load()}
KERNELS = compression.crossover_kernels
OFF_THE_EQUATIONS = [
    name
    for name, claim in CLAIMS.items()
    if "off the equations" in {c.name for c in claim.conditions}
]


def scaled(function, factor, *places):
    """The function with these places of its result, all without any, multiplied by a factor."""

    def wrong(*arguments):
        result = function(*arguments)
        if not places:
            return factor * result
        return tuple(
            factor * part if place in places else part for place, part in enumerate(result)
        )

    return wrong


def stiffer_states(solve):
    """Every state of the coupled cell with a thousandth more tension."""

    def stiffer(self, *stretches):
        state = solve(self, *stretches)
        return state | {"T1": 1.001 * state["T1"], "T2": 1.001 * state["T2"]}

    return stiffer


def softer_laws(used_laws):
    """Laws with twice the compression."""
    laws = used_laws.fget
    return property(
        lambda self: tuple(CompressionLaw(2 * law.a, law.b) if law.a else law for law in laws(self))
    )


def another_power(compress):
    """A compression that falls with the square root of the force in place of its third root."""
    return lambda F, a, b, shift: (
        a - a * (1 + F / (b / a) ** 3) ** -0.5,
        b / 3 * (F + shift) ** (-4 / 3),
    )


def changed_fabric(load, change, only=None):
    """The catalogue with a change of all fabrics or of one."""
    return lambda name: change(load(name)) if only in (None, name) else load(name)


def other_shear(fabric, modulus):
    return replace(
        fabric, shear=replace(fabric.shear, **{modulus: 1.01 * getattr(fabric.shear, modulus)})
    )


def stiffer_warp(fabric):
    warp = fabric.weave.warp
    stiffer = replace(warp, E=1.1 * warp.E, failure_strain=warp.failure_strain / 1.2)
    return replace(fabric, weave=replace(fabric.weave, warp=stiffer))


OFF = dict.fromkeys(OFF_THE_EQUATIONS, "off the equations")
G1, G2 = (partial(other_shear, modulus=modulus) for modulus in ("G1", "G2"))
# what is wrong: owner, attribute, how it is wrong, {claim: what the miss says}
PLANTED = {
    "mass of the bar's nodes": (
        Bar,
        "nodal_mass",
        lambda mass: property(scaled(mass.fget, 1.1)),
        {"geom-projectile": "solid"},
    ),
    "masses of a panel": (
        Panel,
        "masses",
        lambda masses: scaled(masses, 1.05),
        {"impact1-mass-of-cell": "density", "geom-areal-density-s726": "nominal"},
    ),
    "modulus from which the linear density is inferred": (
        catalogue,
        "load",
        lambda load: changed_fabric(load, G2),
        {"geom-areal-density-s726": "denier of G2"},
    ),
    "first shear modulus of one fabric": (
        catalogue,
        "load",
        lambda load: changed_fabric(load, G1, "S-731"),
        {"shear-g1": "greatest"},
    ),
    "stiffness of the warp": (
        catalogue,
        "load",
        lambda load: changed_fabric(load, stiffer_warp),
        {"cell-contact-region": "", "biaxial-single-balanced": ""},
    ),
    "states of the cell": (CellModel, "solve", stiffer_states, OFF),
    "laws of the cell": (CellModel, "used_laws", softer_laws, OFF),
    "power of the law that the cell evaluates": (
        KERNELS,
        "compression",
        another_power,
        {
            "compr-a-asymptote": "off the law",
            "compr-derivative": "difference",
            "compr-vanwyk-equivalence": "exponent",
        },
    ),
    "slope of the law that the cell evaluates": (
        KERNELS,
        "compression",
        lambda compress: scaled(compress, 2.0, 1),
        {"compr-derivative": "difference"},
    ),
    "slope of the contact force": (
        KERNELS,
        "contact_force",
        lambda force: scaled(force, 1.01, 1),
        {"cell-slope-derivative": "difference"},
    ),
    "forces of a coupon": (
        Coupon,
        "forces",
        lambda forces: scaled(forces, 2.0, 0),
        {"cell-stress-resultant": "relative difference"},
    ),
    "trellis that stretches its yarns": (
        weave,
        "trellis",
        lambda made: scaled(made, 1.001, 1),
        {"shear-thickness-constant": "relative change"},
    ),
    "gap between plies": (
        checks,
        "compression_gap",
        lambda gap: lambda density, plies: 1e-4,
        {"compr-gap-formula": "difference"},
    ),
    "pressure of records": (
        compression.PlateCurve,
        "at",
        lambda at: lambda self, pressure: at(self, 0.8 * np.asarray(pressure)),
        {"compr-teflon-subtract": ""},
    ),
}


@pytest.mark.parametrize(
    "defect, name",
    [(defect, name) for defect, (*_, claims) in PLANTED.items() for name in claims],
)
def test_a_defect_of_the_product_misses_the_claim(monkeypatch, defect, name):
    owner, attribute, wrong, claims = PLANTED[defect]
    assert len(OFF_THE_EQUATIONS) == 18
    monkeypatch.setattr(owner, attribute, wrong(getattr(owner, attribute)))
    record = runner.check(CLAIMS[name], {})
    assert record.verdict == judge.MISSED
    assert claims[name] in record.miss
