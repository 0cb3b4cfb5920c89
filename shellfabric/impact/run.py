"""Run of an impact: its solver with its hooks, from the start or from a checkpoint, and again where the first
run asks for a shorter step (`attempts`)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from fabrics.base.checks import FilePath, positive
from fabrics.base.errors import InputError, UnstableError
from shellfabric.cell.model import CellTable
from shellfabric.impact.attempts import Attempt
from shellfabric.impact.result import ImpactResult, collect_result
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import checkpoint, histories
from shellfabric.loop import pack_memory as memory
from shellfabric.loop.driver import Hook, run_to_end
from shellfabric.loop.hooks import Snapshots
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.plies.model import Pack

# share of the thickness by which the nose moves in the shortest run, and its fewest steps
CONTACT = 0.1
FEWEST_STEPS = 10


def check_impact(
    setup: ImpactSetup,
    table: CellTable | None = None,
    target: Pack | None = None,
    written: bool = False,
) -> Pack:
    """Refuse what no impact can be run of; return what is struck.

    Parameters
    ----------
    setup, table, target : of `run_impact`, which begins with this
    written : whether pictures and files are made of the results

    Raises
    ------
    InputError : a set-up that cannot be used, or that needs more memory than is free
    """
    made = target or setup.target(table)
    memory.check(made.plies, setup.snapshots, written)
    if setup.snapshot_interval is not None:
        positive(setup, "snapshot_interval")
    if setup.history:
        histories.Recorder(made.plies, setup.history)
    _check_times(setup, made.time_step)
    return made


def _check_times(setup, time_step):
    """Refuse a run in which nothing happens, and samples that are closer than steps, or never taken."""
    touched = CONTACT * setup.fabric.weave.thickness / setup.strike_velocity
    least = max(touched, FEWEST_STEPS * time_step)
    if setup.end_time < least:
        allowed = f"at least {1e6 * least:.2g} us, in which the nose moves a tenth of a thickness"
        raise InputError(key="end_time", value=_in_us(setup.end_time), allowed=allowed)
    step = f"a time step, {1e9 * time_step:.3g} ns"
    if setup.snapshot_interval is not None and setup.snapshot_interval < time_step:
        value = _in_us(setup.snapshot_interval)
        raise InputError(key="snapshot_interval", value=value, allowed=f"at least {step}")
    if setup.history and not time_step <= setup.history.interval <= setup.end_time:
        allowed = f"from {step}, to the end of the run, {_in_us(setup.end_time)}"
        raise InputError(key="interval", value=_in_us(setup.history.interval), allowed=allowed)


def _in_us(time):
    return f"{1e6 * time:.4g} us"


def run_impact(
    setup: ImpactSetup,
    *,
    hooks: Iterable[Hook] = (),
    resume: FilePath | None = None,
    table: CellTable | None = None,
    target: Pack | None = None,
) -> ImpactResult:
    """Run an impact, and again if a run loses too much to the length of its step (`attempts`).

    Parameters
    ----------
    setup : ImpactSetup
    hooks : called as hook(solver) after every audit, of a run that ends since another follows too
    resume : path of a checkpoint of the same set-up to go on from; the result is that of the
        uninterrupted run, bit for bit
    table : CellTable that a set-up of the same cell has filled, or None
    target : that of the set-up with changes of its own, such as strengths of its yarns; None makes
        it

    Raises
    ------
    InputError : a set-up or checkpoint that cannot be used
    UnstableError : the run became unphysical; its attribute `result` holds what was computed
    """
    made = check_impact(setup, table, target)
    attempt = Attempt(made)
    if resume is not None:
        attempt, solver = _resume(setup, attempt, resume)
    else:
        solver = _make_solver(setup, made)
    kept = tuple(hooks)
    while True:
        result = _run_recorded(setup, solver, attempt, kept)
        following = attempt.follow(solver)
        if following is None:
            return result
        attempt = following
        solver = _make_solver(setup, attempt.target)


def _make_solver(setup, target):
    """The solver of a shot at `target`."""
    velocity = setup.strike_velocity
    interval = setup.sample_interval
    solver = PackSolver(target, velocity, setup.end_time, interval=interval)
    solver.history_request = setup.history
    return solver


def _resume(setup, first, path):
    """(attempt, solver) at a checkpoint of the first run, or of one that follows it."""
    problems = []
    for attempt in first.possible():
        solver = _make_solver(setup, attempt.target)
        try:
            checkpoint.read(solver, path)
        except InputError as problem:
            problems.append(problem)
        else:
            return attempt, solver
    raise problems[0] from None


def _run_recorded(setup, solver, attempt, hooks):
    """The result of a solver's run, with what the set-up records."""
    own: list[Hook] = []
    if setup.history:
        own.append(histories.Recorder(solver.pack.plies, setup.history))
    if setup.snapshot_interval is not None:
        own.append(Snapshots(setup.snapshot_interval))
    return run_to_end(
        solver, (*own, *hooks), lambda: collect_result(setup, solver, attempt.step_factor)
    )


def run_impact_or_partial(setup: ImpactSetup, **others: Any) -> tuple[ImpactResult, str]:
    """Fire the shot: (result of `run`, why it became unstable or ""); of an unstable run the result
    is what it had computed.

    Raises
    ------
    UnstableError : a run that became unstable before it had a result
    """
    try:
        return run_impact(setup, **others), ""
    except UnstableError as problem:
        if problem.result is None:
            raise
        return problem.result, str(problem)
