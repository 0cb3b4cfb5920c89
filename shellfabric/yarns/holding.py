"""Estimate the friction between yarns with which plies of yarns that may slip would stop a nose, as
pinned ones do.

A yarn of tension T, whose kink has the angle a, is pushed aside with a force in proportion to
T sin(a). Friction mu at its crossings holds it with one in proportion to mu T. The ratio
mu / sin(a)^2 decides. For a yarn that is struck across, sin(a)^2 is 2^(2/3) (V / c)^(2/3), of the
velocity V and the wave speed c (Smith, McCrackin and Schiefer 1958). The friction is thus
k (V / c)^(2/3). The factor k is no single number: it differs between fabrics by more than it is
known for one (holding.toml).
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from shellfabric.membrane.model import Panel

BISECTIONS = tomllib.loads((Path(__file__).parent / "holding.toml").read_text("utf-8"))
WIDEST = 4.0  # radius [spacings] of the noses from which the factors come


@cache
def find_factors(family: str | None) -> tuple[float, float]:
    """Find the range (low, high) of k [-] over the bisections of a family of noses; None is any
    nose, and takes both families together."""
    rows = [row for name, rows in BISECTIONS.items() if family in (name, None) for row in rows]
    ratios = [(row["velocity"] / row["wave_speed"]) ** (2 / 3) for row in rows]
    low = min(row["passes"] / ratio for row, ratio in zip(rows, ratios))
    high = max(row["stops"] / ratio for row, ratio in zip(rows, ratios))
    return low, high


def friction_to_hold(panel: Panel, velocity: float) -> tuple[float, float] | None:
    """Return the range (low, high) [-] of the friction between yarns with which a ply stops a nose.

    With less than `low` the nose pushed yarns aside and passed in all bisections of its family,
    with more than `high` it was stopped in all.

    Parameters
    ----------
    velocity : [m/s] of the nose

    Returns
    -------
    None for a nose wider than in these runs, for a ply with a backing, and for a weave with floats,
    which hold a yarn at fewer places than those of the bisections
    """
    if not panel.weave.pattern.is_plain:
        return None
    spacing = 2 * min(panel.weave.w)
    if panel.backing is not None or panel.projectile.radius > WIDEST * spacing:
        return None
    wave = np.mean([yarn.wave_speed for yarn in panel.weave.yarns])
    ratio = float((velocity / wave) ** (2 / 3))
    low, high = find_factors(panel.projectile.known.held_as)
    return low * ratio, high * ratio


def friction_of_plies(panels: Sequence[Panel], velocity: float) -> tuple[float, float] | None:
    """Return the range (low, high) [-] of the friction between yarns with which plies stop a nose,
    by the ply that asks for most (`friction_to_hold`); of several plies rather too much.

    Parameters
    ----------
    velocity : [m/s] of the nose

    Returns
    -------
    None where there is none of any ply
    """
    found = [friction_to_hold(panel, velocity) for panel in panels]
    known = [needed for needed in found if needed is not None]
    return max(known, default=None)
