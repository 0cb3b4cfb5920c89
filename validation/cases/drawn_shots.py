"""Random shots at plies and packs, each of another fabric, projectile and panel: a number and a seed determine one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from fabrics.variants import with_linear_density
from shellfabric.impact.setup import ImpactSetup
from shellfabric.plies.pack_keys import STACKINGS
from shellfabric.projectile.projectile import Projectile
from validation.models.variants import KEVLAR
from weavecell.studies import inputs

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

END = 600e-6

# how far a drawn scene goes from the thesis's: factors on a fabric's numbers, and ranges
FACTORS = {
    "modulus": 0.2,
    "areal_density": 0.2,
    "crimp_warp": 0.3,
    "crimp_weft": 0.3,
    "failure_strain": 0.15,
    "compression_a": 0.3,
    "compression_b": 0.3,
    "trellis_stiffness": 0.3,
    "trellis_angles": 0.2,
}
VELOCITY = (40.0, 300.0)
OPENING = (0.1, 0.25)
MASS = (1e-3, 8e-3)
RADIUS = (2.2e-3, 4.5e-3)
# of drawn packs: most plies, velocity of two plies [m/s], opening [m], gap [m]
MOST_PLIES = 4
PACK_VELOCITY = (60.0, 300.0)
PACK_OPENING = (0.08, 0.12)
GAP = (2e-5, 2e-4)
PACK_END = 400e-6


def base(name: str) -> Fabric:
    """Load a fabric of the catalogue with the linear densities that the thesis's runs used, if it
    has such."""
    return with_linear_density(catalogue.load(name))


def drawn(number: int, seed: int) -> ImpactSetup:
    """Draw the random scene of a number and a seed."""
    draw = np.random.default_rng((seed, number))
    name = str(draw.choice(KEVLAR))
    factors = {key: float(1 + draw.uniform(-wide, wide)) for key, wide in FACTORS.items()}
    fabric = replace(inputs.scale_fabric(base(name), **factors), name=f"{name}, changed")
    shape = str(draw.choice(["flat", "hemisphere", "sphere"]))
    radius = float(draw.uniform(*RADIUS))
    shot = Projectile(
        float(draw.uniform(*MASS)), radius, radius if shape == "sphere" else 3e-4, shape
    )
    low, high = np.log(VELOCITY)
    velocity = round(float(np.exp(draw.uniform(low, high))), 1)
    width, height = draw.uniform(*OPENING, 2)
    opening = (float(width), float(height))
    return ImpactSetup(
        fabric, velocity, projectile=shot, opening=opening, end_time=END, symmetry="whole"
    )


def drawn_pack(number: int, seed: int) -> ImpactSetup:
    """Draw the random pack of a number and a seed: the drawn ply and projectile, in a smaller
    opening, 2 to 4 times."""
    ply = drawn(number, seed)
    draw = np.random.default_rng((seed, number, 2))
    plies = int(draw.integers(2, MOST_PLIES + 1))
    stacking = str(draw.choice(STACKINGS))
    low, high = np.log(PACK_VELOCITY)
    velocity = round(float(np.exp(draw.uniform(low, high)) * (plies / 2) ** 0.5), 1)
    opening: Any = tuple(float(side) for side in draw.uniform(*PACK_OPENING, 2))
    return replace(
        ply,
        strike_velocity=velocity,
        opening=opening,
        end_time=PACK_END,
        plies=plies,
        stacking=stacking,
        ply_gap=float(draw.uniform(*GAP)),
    )
