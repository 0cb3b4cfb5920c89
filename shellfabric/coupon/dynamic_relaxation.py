"""Dynamic relaxation with kinetic damping: all velocities are zeroed at each peak of the kinetic energy,
which leaves no damping coefficient to choose. Between,

    v <- v + f / m,    x <- x + v        (time step 1, fictitious masses m)

m = (1 + margin) b / 4 with b the largest value so far of the bounds on the row sums of the stiffness:
the highest frequency is below 2 (Gershgorin). The largest so far, because a yarn that has just gone
slack has a node without stiffness, which a small force would throw across its neighbours.

A state is settled at |f on free nodes| <= tolerance x max(|f on held nodes|, force_floor).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import BoolArray, FloatArray
from fabrics.base.errors import UnstableError

MARGIN = 0.05  # for the growth of the stiffness within one step


@dataclass(frozen=True)
class State:
    """A body after relaxation.

    Parameters
    ----------
    load : [-] share of the path of the supports
    x : (n, d) [m] nodes
    reaction : (n, d) [N] force of the supports on the body, zero on free nodes
    energies : those that the body returns with its forces
    history : (iterations, 2) [N] norms of the out-of-balance force and of the reaction
    residual : [-] the first over the greater of the second and force_floor, at the end
    settled : whether the residual is within the tolerance
    """

    load: float
    x: np.ndarray
    reaction: np.ndarray
    energies: tuple
    history: np.ndarray
    residual: float
    settled: bool

    @property
    def iterations(self) -> int:
        return len(self.history)


def relax(
    forces: Callable,
    x: FloatArray,
    held: BoolArray,
    *,
    tolerance: float = 1e-4,
    force_floor: float = 0.0,
    max_iterations: int = 50_000,
    load: float = 1.0,
) -> State:
    """Relax a body from x.

    Parameters
    ----------
    forces : forces(x) -> f (n, d) [N], b (n,) [N/m] bound on the block row sums of the stiffness,
        energies
    x : (n, d) [m] start, the held nodes where they shall be
    held : (n,) bool
    tolerance : [-] of the out-of-balance force against the reaction
    force_floor : [N] reaction below which a body counts as unloaded
    max_iterations : after which the state is returned unsettled
    load : [-] what to call the state
    """
    x = np.array(x, float)
    free = ~held
    heaviest = 0.0
    v = np.zeros_like(x)
    energy = 0.0
    history = []
    settled = False
    while True:
        f, bound, energies = forces(x)
        out = float(sums.norm(f[free]))
        reaction = float(sums.norm(f[held]))
        history.append((out, reaction))
        settled = out <= tolerance * max(reaction, force_floor)
        if settled or len(history) >= max_iterations or not np.isfinite(out + reaction):
            break
        heaviest = np.maximum(heaviest, bound)
        mass = 0.25 * (1 + MARGIN) * heaviest
        kick = np.divide(1.0, mass, out=np.zeros_like(mass), where=free & (mass > 0))[:, None] * f
        if energy == 0.0:
            v = 0.5 * kick
            energy = float(np.sum(mass[:, None] * v * v))
        else:
            faster = v + kick
            now = float(np.sum(mass[:, None] * faster * faster))
            if now < energy:
                # the peak lies about half a step back
                x -= 0.5 * v
                energy = 0.0
                continue
            v = faster
            energy = now
        x += v
    scale = max(reaction, force_floor)
    if scale > 0 or np.isnan(scale):
        residual = out / scale
    else:
        residual = float(out > 0)
    return State(
        load, x, np.where(held[:, None], -f, 0.0), energies, np.array(history), residual, settled
    )


def relax_path(
    body: Any,
    x: FloatArray,
    held: BoolArray,
    path: Callable,
    loads: Sequence[float] | FloatArray,
    *,
    tolerance: float = 1e-4,
    force_floor: float = 0.0,
    max_iterations: int = 50_000,
    hooks: Iterable[Callable[[State], object]] = (),
    progress: Callable[..., object] | None = None,
    done: Iterable[State] = (),
) -> tuple[tuple[State, ...], bool]:
    """Move the supports of a body step by step and relax it at each.

    Each step starts from the last two states, extrapolated; the first, and one after a body that
    carried nothing and so had no definite shape, from the last state with the supports' motion
    spread over the body.

    Parameters
    ----------
    body : has forces(x) as in `relax`, and spread(u, held) -> (n, d) [m], a smooth motion with u on
        the held nodes
    x : (n, d) [m] nodes at rest
    held : (n,) bool
    path : path(load) -> (n, d) [m] where the held nodes shall be; other rows are not read
    loads : rising shares of the path
    tolerance, force_floor, max_iterations : as in `relax`
    hooks : called as hook(state) after every step; one may end the run by an UnstableError, or by
        returning True
    progress : called as progress(state) after every step that the run goes on from
    done : states of the first loads, from an interrupted run: the others come out as they would
        have, bit for bit

    Returns
    -------
    the states, one a step, and whether a hook ended the run

    Raises
    ------
    UnstableError : a step did not settle, or a hook's; its attribute `states` holds what was
        computed, the state that was refused last
    """
    states = list(done)
    ended = False
    for load in loads[len(states) :]:
        target = path(load)
        start = _start(body, x, held, states, load, target, force_floor)
        start[held] = target[held]
        state = relax(
            body.forces,
            start,
            held,
            tolerance=tolerance,
            force_floor=force_floor,
            max_iterations=max_iterations,
            load=load,
        )
        try:
            if not np.isfinite(state.residual):
                raise UnstableError(
                    "the forces are no longer finite", when=f"at {load:.3g} of the load"
                )
            answers = [hook(state) for hook in hooks]
            ended = any(answers)
            if not state.settled:
                raise _not_settled(body, state, held, tolerance)
        except UnstableError as problem:
            problem.states = (*states, state)  # type: ignore[attr-defined]
            raise
        states.append(state)
        if ended:
            break
        if progress is not None:
            progress(state)
    return tuple(states), ended


def _start(body, x, held, states, load, target, force_floor):
    """(n, d) [m] from where a load step begins: see `relax_path`."""
    known = [(0.0, np.array(x, float)), *((state.load, state.x) for state in states)]
    done, last = known[-1]
    # it carried a load, and so had a definite shape
    if states and states[-1].history[-1, 1] > force_floor:
        before, earlier = known[-2]
        return last + (load - done) / (done - before) * (last - earlier)
    return last + body.spread(np.where(held[:, None], target - last, 0.0), held)


def _not_settled(body, state, held, tolerance):
    return UnstableError(
        f"no equilibrium was found: after {state.iterations} iterations the out-of-balance force is "
        f"{state.residual:.2g} of the reaction, the tolerance is {tolerance:g}; "
        "try more load steps, or more iterations (max_iterations)",
        where=f"node {_worst(body, state, held)}",
        when=f"at {state.load:.3g} of the load",
    )


def _worst(body, state, held):
    """Number of the free node that is farthest out of balance."""
    out = sums.norm(body.forces(state.x)[0], axis=1)
    return int(np.argmax(np.where(held, 0.0, out)))
