"""Checkpoints of a run as HDF5, written whole or not at all; a resumed run goes on bit for bit.
Needs h5py.

What is kept of a solver: `loop.driver.ExplicitSolver.checkpoint_arrays`, `checkpoint_records`,
`counters`, its step history and its snapshots. A checkpoint carries digests
of all that determines the run and its records, the code among it, and is refused by any other run;
and one of its own bytes, so that a changed state is refused too.
"""

from __future__ import annotations

import time
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.files import write_hdf5
from fabrics.base.read_formats import read_hdf5
from shellfabric.jit.table import Row
from shellfabric.loop.hooks import Every
from shellfabric.loop.snapshots import Snapshot

if TYPE_CHECKING:
    from shellfabric.loop.driver import ExplicitSolver

FORMAT = "weavecell checkpoint 6"
MOST_WALL = 30.0  # [s] after which a checkpoint is written wherever the run stands
LEAST_WALL = 10.0  # [s] between checkpoints of a command: what it saves of a shorter run takes as long to compute again


class Checkpoints(Every):
    """Write a checkpoint every interval [s] of the run's time, and after `MOST_WALL` of wall time,
    over the last one.

    Parameters
    ----------
    path, interval : of the file, and [s]
    least_wall : [s] of wall time from the first sample, and from each checkpoint, in which no other
        is written
    """

    def __init__(self, path: FilePath, interval: float, least_wall: float = 0.0) -> None:
        super().__init__(interval)
        self.path = path
        self.least_wall = least_wall
        self._written: float | None = None  # [s] of the clock

    def __call__(self, solver: ExplicitSolver) -> None:
        now = time.monotonic()
        if self._written is None:
            self._written = now
        passed = now - self._written
        if (self.due(solver) and passed >= self.least_wall) or passed >= MOST_WALL:
            write(solver, self.path)
            self._written = time.monotonic()


def stamp(solver: ExplicitSolver) -> dict[str, Any]:
    """Digest all that determines a run and its records."""
    known, module = solver.checkpoint_identity()
    return run_cache.stamp(known, module)


def write(solver: ExplicitSolver, path: FilePath) -> None:
    """Write the state and the records of a solver."""
    with write_hdf5(path, FORMAT, sealed=True, **stamp(solver)) as file:
        file.attrs.update({name: getattr(solver, name) for name in solver.counters})
        for name, array in _arrays(solver):
            file[f"arrays/{name}"] = np.array(array)
        for name, rows in solver.checkpoint_records().items():
            file[f"records/{name}"] = np.array(rows)
        file["steps"] = np.concatenate(
            [np.empty((0, solver.history_columns)), *solver.step_history]
        )
        file["chunks"] = np.array([len(part) for part in solver.step_history], np.int64)
        for number, snapshot in enumerate(solver.snapshots):
            _store_snapshot(file, f"snapshots/{number:05d}", snapshot)


def read(solver: ExplicitSolver, path: FilePath) -> None:
    """Bring a fresh solver to the state of a checkpoint.

    Raises
    ------
    InputError : the file is missing, changed, of another run, or of other code
    """
    with read_hdf5(path, FORMAT, what="checkpoint", sealed=True) as file:
        run_cache.check_stamp(file.attrs, stamp(solver), path)
        _restore(solver, file)


def _restore(solver, file):
    for name, array in _arrays(solver):
        array[...] = file[f"arrays/{name}"][()]
    for name, rows in solver.checkpoint_records().items():
        rows[:] = list(file[f"records/{name}"][()])
    for name in solver.counters:
        setattr(solver, name, file.attrs[name].item())
    ends = np.cumsum(file["chunks"][()])
    if ends.size:
        solver.step_history[:] = np.split(file["steps"][()], ends[:-1])
    else:
        solver.step_history[:] = []
    solver.snapshots[:] = [_snapshot(part) for _, part in sorted(file.get("snapshots", {}).items())]


def _arrays(solver):
    """(name, array) of the arrays that are kept: of a row what its table says, the rest follows
    from the run."""
    for group, value in solver.checkpoint_arrays().items():
        if isinstance(value, Row):
            arrays = vars(value)  # of totals too, whose numbers attributes give
            for name in value.kept():
                yield from _leaves(f"{group}/{name}", arrays[name])
        else:
            yield group, value


def _leaves(name, value):
    """(name, array) of an array, or of all in a tuple."""
    if isinstance(value, tuple):
        for number, part in enumerate(value):
            yield from _leaves(f"{name}/{number}", part)
    else:
        yield name, value


def _store_snapshot(file, name, snapshot):
    """Keep a snapshot: a Snapshot, an array or a number, or a tuple of these."""
    if is_dataclass(snapshot):
        for entry in fields(snapshot):
            file[f"{name}/{entry.name}"] = getattr(snapshot, entry.name)
    elif isinstance(snapshot, tuple):
        for number, part in enumerate(snapshot):
            _store_snapshot(file, f"{name}/{number:02d}", part)
    else:
        file[name] = snapshot


def _snapshot(stored):
    """The snapshot that a group or a dataset holds."""
    if not hasattr(stored, "items"):
        return stored[()]
    if "nodes" in stored:
        return Snapshot(*(stored[entry.name][()] for entry in fields(Snapshot)))
    return tuple(_snapshot(part) for _, part in sorted(stored.items()))
