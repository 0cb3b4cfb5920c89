"""Impact of a rigid projectile on the bare block, without fabric."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shellfabric.block import dent
from shellfabric.block.coupling import BackingResult, result_of
from shellfabric.projectile.projectile import Projectile

if TYPE_CHECKING:
    from shellfabric.block.block import Backing

RECORDED = 20  # a step in so many


@dataclass(frozen=True)
class Strike:
    """What a projectile without fabric does to a block: t, v, z [s, m/s, m] of its nose, energies {name: (n,)} [J] of
    the whole, the crater at the end (k, 2) [m], and the block at the end."""

    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    energies: dict
    crater: np.ndarray
    eroded: int
    block: BackingResult


def strike(
    backing: Backing,
    projectile: Projectile,
    velocity: float,
    end_time: float,
    *,
    after: float = 0.0,
) -> Strike:
    """Strike the bare block with a rigid projectile ("backing only" of thesis Figure 6-45), until
    it turns back or is through.

    Parameters
    ----------
    velocity : [m/s]
    end_time : [s] at the latest
    after : [s] for which it goes on after the projectile has turned back

    Raises
    ------
    InputError, UnstableError : as Block
    """
    # the projectile crosses at most a twentieth of the finest brick in a step
    dt = min(0.05 * backing.min_size / velocity, 0.5 * backing.longest_step)
    block = backing.block(dt)
    quarter = 0.25 * projectile.mass
    position = np.array([0.0, 0.0, backing.standoff])
    speed = np.array([0.0, 0.0, float(velocity)])
    rows = []
    depths = []
    energies = []
    last = np.inf
    for n in range(int(np.ceil(end_time / dt))):
        push = block.strike(position, speed, projectile)
        block.advance()
        kick = dt
        if n == 0:
            kick = 0.5 * dt
        before = speed[2]
        speed[2] += kick * push[2] / quarter
        mean = 0.5 * (before + speed[2])
        if speed[2] <= 0 and last == np.inf:
            last = n + int(np.ceil(after / dt))
        through = position[2] > backing.standoff + backing.size[2]
        stop = n >= last or through
        if n % RECORDED == 0 or stop:
            own = block.energies()
            own["projectile"] = 0.5 * quarter * mean**2
            own["error"] = sum(own.values()) - 0.5 * quarter * velocity**2
            rows.append((n * dt, mean, position[2] - backing.standoff))
            depths.append(dent.deepest(block.depth_map()))
            energies.append(4 * np.array(list(own.values())))
        position[2] += dt * speed[2]
        if stop:
            break
    t, v, z = np.array(rows).T
    named = {name: np.array(energies)[:, k] for k, name in enumerate(own)}
    made = result_of(block, t, np.array(depths))
    return Strike(t, v, z, named, block.crater(), int(np.count_nonzero(block.gone)), made)
