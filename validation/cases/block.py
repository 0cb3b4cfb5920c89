"""Blocks of clay, gelatine and tissue simulant: a ball that falls on one, and the targets of thesis section 6.5."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics import backings
from shellfabric.backing.block import Backing
from shellfabric.projectile.projectile import Projectile
from validation.models.bare_impact import strike
from validation.published.pencilling import study

BALL = Projectile(mass=1.0, shape="sphere", radius=31.75e-3)
SPEED = float(np.sqrt(2 * 9.81 * 2.0))  # [m/s] after a fall of 2 m


def drop(*, material: str, min_size: float) -> dict[str, float]:
    """The drop test of clay calibration (NIJ 0101.04, as quoted by the National Research Council, Testing of Body Armor
    Materials, Phase III, 2012): a steel ball of 63.5 mm and 1 kg falls 2.0 m on a block of 610 x 610 x 140 mm.

    Its weight during the dent, 1 % of its energy, is left out, and so is friction.

    Parameters
    ----------
    material : of `fabrics.backings`
    min_size : [m] edge of the smallest hexahedra

    Returns
    -------
    dict with deepest, left [m], volume [m3], turn [s], hexahedra; error, hourglass [-] of the energy of the ball
    """
    block = Backing(
        material=backings.load(material), size=(0.61, 0.61, 0.14), min_size=min_size, refined_depth=0.045, growth=1.4
    )
    found = strike(block, BALL, SPEED, 0.03, after=2e-3)
    start, turn = found.energies["projectile"][0], int(np.argmax(found.z))
    return {
        "deepest": float(found.z[turn]),
        "left": found.block.back_face_signature,
        "volume": found.block.volume,
        "turn": float(found.t[turn]),
        "hexahedra": len(found.block.bricks),
        "error": float(np.abs(found.energies["error"]).max() / start),
        "hourglass": float(found.energies["hourglass"][turn] / start),
    }


def target(
    *, plies: int, modulus: float = 1.0, mass: float = 0.0, edge: str = "free", elements: int = 2
) -> dict[str, Any]:
    """A target of Table 6-2 before its block, or the bare block without plies; keywords of `study.Case`, `study.shoot`.

    Returns
    -------
    dict with outcome, end [s], depth, crater, half_width [m], wall [deg] against the face, eroded hexahedra, error,
    hourglass [-] of the energy lost
    """
    found = study.bare() if plies == 0 else study.shoot(study.Case(plies, modulus, mass), edge=edge, elements=elements)
    glass = found.energies.get("backing_hourglass", found.energies.get("hourglass"))
    lost = found.energies.get("kinetic_projectile", found.energies.get("projectile"))
    return {
        "outcome": found.outcome,
        "end": float(found.t[-1]),
        "depth": found.depth,
        "crater": found.crater_depth,
        "half_width": found.half_width,
        "wall": float(np.degrees(found.steepness)),
        "error": found.balance,
        "eroded": None if found.block is None else int(found.block.gone.sum()),
        "hourglass": float(glass[-1] / (lost[0] - lost[-1])),
    }
