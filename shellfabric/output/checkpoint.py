"""Checkpoints of a march as HDF5, written whole or not at all; a resumed run goes on bit for bit.

What the marches of a panel, of a pack (`pack_checkpoint`) and of a solid patch (`solid_checkpoint`) keep alike is here.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import fields

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError
from fabrics.files import replace_whole
from shellfabric.output.hooks import Every
from shellfabric.output.snapshots import Snapshot

_FORMAT = "weavecell checkpoint 2"


class Checkpoints(Every):
    """Write a checkpoint every interval [s] of the run's time, over the last one."""

    def __init__(self, path, interval):
        super().__init__(interval)
        self.path = path

    def __call__(self, march):
        if self.due(march):
            self.write(march)

    def write(self, march):
        """Write the checkpoint."""
        write(march, self.path)


def stamp(march):
    """Digests of all that determines a run and its records: panel, table, knobs, strike velocity, measures, code."""
    precision, backing = march.panel.numerics.precision, march.panel.backing
    known = march.strike_velocity, march.chunk, march.measure, precision, backing
    known += march.const._asdict(), march.state.mass, march.state.inverse_mass
    return run_cache.stamp(known, "shellfabric.impact.single_ply")


def write(march, path):
    """Write the state and the records of a march."""
    import h5py

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs.update(format=_FORMAT, **stamp(march))
        store(file, "state", march.state)
        store_records(file, march)
        file["histories"] = np.array(march.histories)
        for number, shot in enumerate(march.snapshots):
            store_snapshot(file, f"{number:05d}", shot)


def read(march, path):
    """Bring a fresh march to the state of a checkpoint.

    Raises
    ------
    InputError : the file is missing, broken, of another run, or of other code
    """
    with opened(path, _FORMAT, stamp(march)) as file:
        restore(file, "state", march.state)
        restore_records(file, march)
        march.histories[:] = list(file["histories"][()])
        march.snapshots[:] = [snapshot(group) for _, group in sorted(file.get("snapshots", {}).items())]


@contextmanager
def opened(path, form, stamp):
    """A checkpoint to read from; InputError if it is missing, broken, of another run, or of other code."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != form:
                raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(form))
            run_cache.check_stamp(file.attrs, stamp, path)
            yield file
    except (OSError, KeyError) as problem:
        raise InputError(f"is not a readable checkpoint ({problem})", file=path) from None


def store(file, group, arrays):
    """Keep the entries of a named tuple that are arrays, or several; constants follow from the run."""
    for name, value in zip(arrays._fields, arrays):
        if _kept(value):
            file[f"{group}/{name}"] = np.array(value)


def restore(file, group, arrays):
    """Put what `store` has kept into the arrays."""
    for name, value in zip(arrays._fields, arrays):
        if _kept(value):
            stored = file[f"{group}/{name}"][()]
            for array, part in zip(value, stored) if isinstance(value, tuple) else [(value, stored)]:
                array[...] = part


def _kept(value):
    return isinstance(value, np.ndarray) or (isinstance(value, tuple) and isinstance(value[0], np.ndarray))


def store_records(file, march):
    """What a march of cloth has recorded, with the block behind it."""
    file.attrs["reason"], file.attrs["wall_time"], file.attrs["zero"] = march.reason, march.wall_time, march._zero
    file.attrs["passed"] = march.passed
    file["monitor"] = march.monitor.found
    for name, values in (march.behind.block.arrays() if march.behind else {}).items():
        file[f"block/{name}"] = values
    file["samples"] = np.array(march.samples)
    file["fine"] = np.concatenate(march.fine) if march.fine else np.empty((0, march.columns))
    file["chunks"] = np.array([part.shape[0] for part in march.fine], np.int64)


def restore_records(file, march):
    """Put what `store_records` has kept into the march."""
    if march.behind:
        march.behind.block.restore({name: data[()] for name, data in file["block"].items()})
    march.reason, march.wall_time = int(file.attrs["reason"]), float(file.attrs["wall_time"])
    march._zero, march.passed = float(file.attrs["zero"]), int(file.attrs["passed"])
    march.monitor.found[:] = file["monitor"][()]
    march.samples[:] = list(file["samples"][()])
    march.fine[:] = np.split(file["fine"][()], np.cumsum(file["chunks"][()])[:-1]) if len(file["chunks"]) else []


def store_snapshot(file, name, shot):
    """Keep a snapshots.Snapshot."""
    for entry in fields(Snapshot):
        file[f"snapshots/{name}/{entry.name}"] = getattr(shot, entry.name)


def snapshot(group):
    """The Snapshot that a group holds."""
    return Snapshot(*(group[entry.name][()] for entry in fields(Snapshot)))
