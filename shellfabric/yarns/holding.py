"""Estimate the friction between yarns with which plies of yarns that may slip would stop a nose, as
pinned ones do.

A yarn of tension T, whose kink has the angle a, is pushed aside with a force in proportion to
T sin(a). Friction mu at its crossings holds it with one in proportion to mu T. The ratio
mu / sin(a)^2 decides. For a yarn that is struck across, sin(a)^2 is 2^(2/3) (V / c)^(2/3), of the
velocity V and the wave speed c (Smith, McCrackin and Schiefer 1958). The friction is thus
k (V / c)^(2/3). The factor k is no single number: it differs between fabrics by more than it is
known for one, and falls with the friction on the nose, which drags the yarns along (holding.toml).
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from shellfabric.membrane.model import Panel

WIDEST = 4.0  # radius [spacings] of the noses from which the factors come


@dataclass(frozen=True)
class Bisection:
    """Frictions between yarns with which one ply lets a nose pass, and stops it.

    Parameters
    ----------
    family : of noses
    shot : fabric and velocity [m/s]
    nose_friction : [-] on the nose
    passes, stops : k [-] of both
    """

    family: str
    shot: tuple[str, float]
    nose_friction: float
    passes: float
    stops: float


@cache
def read_bisections() -> tuple[Bisection, ...]:
    """Read the bisections, each of the place that asks for most."""
    content = tomllib.loads((Path(__file__).parent / "holding.toml").read_text("utf-8"))
    return tuple(_read(family, row) for family, rows in content.items() for row in rows)


def _read(family, row):
    ratio = (row["velocity"] / row["wave_speed"]) ** (2 / 3)
    shot = row["fabric"], row["velocity"]
    ends = row["passes"] / ratio, row["stops"] / ratio
    return Bisection(family, shot, row["nose_friction"], *ends)


@cache
def find_factors(family: str | None, nose_friction: float = 0.0) -> tuple[float, float]:
    """Find the range (low, high) of k [-] over the bisections of a family of noses.

    Of each shot those of the roughest nose count that is no rougher than this one: the range is too high
    for a nose between two, and does not rise with the friction.

    Parameters
    ----------
    family : None is any nose, and takes all families together
    nose_friction : [-] on the nose
    """
    of_shots: dict[tuple, list[Bisection]] = {}
    for one in read_bisections():
        if family in (one.family, None):
            of_shots.setdefault((one.family, one.shot), []).append(one)
    worst = []
    for rows in of_shots.values():
        known = max(one.nose_friction for one in rows if one.nose_friction <= nose_friction)
        # a rougher nose that was found to ask for more, by the width of a bracket, asks for it here too
        rough = [one for one in rows if one.nose_friction >= known]
        worst.append(max(rough, key=lambda one: one.stops))
    return min(one.passes for one in worst), max(one.stops for one in worst)


def friction_to_hold(
    panel: Panel, velocity: float, nose_friction: float | None = None
) -> tuple[float, float] | None:
    """Return the range (low, high) [-] of the friction between yarns with which a ply stops a nose.

    With less than `low` the nose pushed yarns aside and passed in all bisections of its family,
    with more than `high` it was stopped in all.

    Parameters
    ----------
    velocity : [m/s] of the nose
    nose_friction : [-] on the nose; None takes that of the panel's projectile

    Returns
    -------
    None for a nose wider than in these runs, for a ply with a backing, and for a weave with floats,
    which hold a yarn at fewer places than those of the bisections
    """
    if not panel.weave.pattern.is_plain:
        return None
    shot = panel.projectile
    spacing = 2 * min(panel.weave.w)
    if panel.backing is not None or shot.radius > WIDEST * spacing:
        return None
    if nose_friction is None:
        nose_friction = shot.friction
    wave = np.mean([yarn.wave_speed for yarn in panel.weave.yarns])
    ratio = float((velocity / wave) ** (2 / 3))
    low, high = find_factors(shot.known.held_as, float(nose_friction))
    return low * ratio, high * ratio


def friction_of_plies(
    panels: Sequence[Panel], velocity: float, nose_friction: float | None = None
) -> tuple[float, float] | None:
    """Return the range (low, high) [-] of the friction between yarns with which plies stop a nose,
    by the ply that asks for most (`friction_to_hold`); of several plies rather too much.

    Parameters
    ----------
    velocity, nose_friction : as of `friction_to_hold`

    Returns
    -------
    None where there is none of any ply
    """
    found = [friction_to_hold(panel, velocity, nose_friction) for panel in panels]
    known = [needed for needed in found if needed is not None]
    return max(known, key=lambda needed: needed[1], default=None)
