"""A second opinion on the V50 of a pack: a regression line through tests, without any mechanics.

Cunniff (Proc. 18th Int. Symp. on Ballistics, 1999) draws the V50 of packs of all fibres as one
curve of two dimensionless numbers,

    V50 / U*^(1/3) = f(X),   U* = sigma eps / (2 rho) sqrt(E / rho),   X = A_d A_p / m

with strength, failure strain, density and modulus of the fibre as woven, areal density of the
pack, presented area and mass of the projectile. His points are not at hand: f is a power law
through five V50 of woven Twaron, so that for this fabric the line repeats its tests. Its numbers,
scatter and source are in inputs.toml.
"""

from __future__ import annotations

from math import cos, pi

import numpy as np

from fabrics import assumed
from shellfabric.impact.setup import ImpactSetup
from weavecell.studies import inputs

FAMILIES = ("para-aramid", "UHMWPE")
DISAGREES = 0.25  # difference over the V50 of the line, from which the report says so


def velocity_scale(setup: ImpactSetup) -> float:
    """Compute U*^(1/3) [m/s], the mean of all yarns of the pack by mass."""
    scales = []
    masses = []
    for ply in range(setup.plies):
        for yarn in setup.fabric_of(ply).weave.yarns:
            energy = yarn.E * yarn.failure_strain**2 / (2 * yarn.fibre_density)  # [J/kg]
            scales.append((energy * yarn.wave_speed) ** (1 / 3))
            masses.append(yarn.linear_density)
    return float(np.average(scales, weights=masses))


def mass_ratio(setup: ImpactSetup) -> float:
    """Compute X [-]: mass of the pack in the path of the projectile over the mass of the
    projectile."""
    projectile = setup.projectile
    area = pi * projectile.radius**2
    return setup.areal_density * area / (projectile.mass * cos(projectile.obliquity))


def v50(setup: ImpactSetup) -> float:
    """Compute V50 of the line [m/s]."""
    line = inputs.table("regression_line")
    power = mass_ratio(setup) ** line["exponent"].value
    return line["factor"].value * power * velocity_scale(setup)


def remarks(setup: ImpactSetup, computed: float) -> list[str]:
    """Write a line with the V50 of the regression beside the computed one [m/s], for a pack of
    aramid or UHMWPE without a block behind it; none for others."""
    families = [assumed.family_of(fabric) for fabric in setup.fabrics]
    known = all(family is not None and family.name in FAMILIES for family in families)
    if setup.plies == 1 or setup.backing is not None or not known:
        return []
    line = inputs.table("regression_line")
    expected = v50(setup)
    text = f"Regression through tests of packs (Cunniff's numbers): {expected:.0f} m/s"
    text += f" +- {line['scatter'].value:.0%}"
    tested = line["mass_ratio"]
    ratio = mass_ratio(setup)
    if not tested.low <= ratio <= tested.high:
        text += f"; extrapolated, X = {ratio:.2g}, tests {tested.low:g} to {tested.high:g}"
    off = computed / expected - 1
    if abs(off) > DISAGREES:
        text += f"; the computed velocity DISAGREES with it by {off:+.0%}"
    return [f"{text}."]
