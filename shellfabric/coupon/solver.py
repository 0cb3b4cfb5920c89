"""A run of a coupon: its grips are moved step by step, the rest relaxes (`dynamic_relaxation`), and
what goes wrong is named.

Yarns that have passed one another and a yarn at its strength are looked for here; what one test
alone can suffer (shear in bands) is handed in by that test (`quasistatic`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray, IntArray
from fabrics.base.errors import UnstableError
from shellfabric.coupon import dynamic_relaxation
from shellfabric.coupon.dynamic_relaxation import State
from shellfabric.coupon.model import Coupon

FLOOR = 1e-4  # of a yarn's strength, for each held node: see `Result.force_floor`
# [floors] reaction below which a state is unloaded: the shape of slack yarns is not unique, and its reaction is
# noise. Strips of S-720 with 1.4 to 2.1 floors differ by 10 to 25 % with the last digit of a start or the
# tolerance; frames and bias coupons of 5.2 floors and more by nothing that is read
UNLOADED = 3.0


@dataclass(frozen=True)
class Result:
    """A test that has been run.

    Parameters
    ----------
    coupon : Coupon
    grips : (n,) int, number of the grip that holds a node, from 1; 0 is free
    states : of `dynamic_relaxation.relax_path`, one a load step
    prescribed : (steps,) elongation [m], shear angle [rad] or strain [-]
    outcome : "complete", "yarn at its strength" or "unstable"
    force_floor : [N] norm of the reaction below which a step is relaxed to a share of this floor
    """

    coupon: Coupon
    grips: np.ndarray
    states: tuple[State, ...]
    prescribed: np.ndarray
    outcome: str
    force_floor: float

    def force(self, grip: int, axis: int) -> FloatArray:
        """Return the force (steps,) [N] of a grip on the coupon, along axis 0 or 1."""
        return np.array([state.reaction[self.grips == grip, axis].sum() for state in self.states])

    @property
    def unloaded(self) -> BoolArray:
        """(steps,) whether a state carries nothing that is determined: a reaction below UNLOADED
        floors."""
        reaction = np.array([state.history[-1, 1] for state in self.states])
        return reaction < UNLOADED * self.force_floor

    def shear(self, step: int = -1) -> FloatArray:
        """Return the shear angles (q,) [rad] after a step."""
        return self.coupon.shear_angles(self.states[step].x)


def run(
    coupon: Coupon,
    grips: IntArray,
    path: Callable[[float], FloatArray],
    size: float,
    steps: int,
    hooks: Iterable[Callable[..., object]] = (),
    *,
    failure: bool = False,
    **relaxing: Any,
) -> Result:
    """Pull a coupon and pack the result.

    Parameters
    ----------
    coupon : Coupon
    grips : (n,) int, see Result
    path : path(load) -> (n, 2) [m] where the held nodes shall be at a share of the whole
    size : of what is prescribed, at the end of the path
    steps : of load, all alike
    hooks : besides that for folds, see `dynamic_relaxation.relax_path`
    failure : whether the run ends where a yarn reaches its strength
    relaxing : other keywords of `dynamic_relaxation.relax_path`

    Raises
    ------
    UnstableError : as `dynamic_relaxation.relax_path`; its attribute `result` holds the run
    """
    held = grips > 0
    strength = max(yarn.strength for yarn in coupon.weave.yarns)
    force_floor = FLOOR * strength * sqrt(held.sum())
    all_hooks = [*hooks, no_fold(coupon)]
    if failure:
        all_hooks.append(at_strength(coupon))

    def pack(states, outcome):
        return Result(
            coupon,
            grips,
            states,
            size * np.array([state.load for state in states]),
            outcome,
            force_floor,
        )

    try:
        states, ended = dynamic_relaxation.relax_path(
            coupon,
            coupon.points,
            held,
            path,
            np.arange(1, steps + 1) / steps,
            force_floor=force_floor,
            hooks=all_hooks,
            **relaxing,
        )
    except UnstableError as problem:
        problem.result = pack(problem.states, "unstable")  # type: ignore[attr-defined]
        raise
    return pack(states, "yarn at its strength" if ended else "complete")


def no_fold(coupon: Coupon) -> Callable[[State], None]:
    """Return a hook that ends a run in which an element has folded."""

    def hook(state):
        gamma = coupon.shear_angles(state.x)
        worst = int(np.argmax(np.abs(gamma)))
        if abs(gamma[worst]) >= pi / 2:
            raise UnstableError(
                "an element has folded: its yarns have passed one another",
                where=f"element {worst}",
                when=f"at {state.load:.3g} of the load",
            )

    return hook


def at_strength(coupon: Coupon) -> Callable[[State], bool]:
    """Return a hook that ends a run once the mean tension of a yarn has reached its strength."""

    def hook(state):
        tensions = coupon.mean_tensions(state.x)
        yarns = coupon.weave.yarns
        return any(T.max() >= yarn.strength for T, yarn in zip(tensions, yarns))

    return hook
