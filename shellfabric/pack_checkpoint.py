"""Checkpoints of a pack's march as HDF5, written whole or not at all; a resumed run goes on bit for bit."""

from __future__ import annotations

import hashlib
from dataclasses import fields

import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole
from shellfabric.hooks import Every
from shellfabric.measures import Snapshot

_FORMAT = "weavecell pack checkpoint 1"


class Checkpoints(Every):
    """Write a checkpoint every interval [s] of the run's time, over the last one."""

    def __init__(self, path, interval):
        super().__init__(interval)
        self.path = path

    def __call__(self, march):
        if self.due(march):
            write(march, self.path)


def identity(march):
    """Digest of everything that determines a run: plies, tables, knobs, contact, strike velocity."""
    precision = march.panel.numerics.precision
    known = (march.strike_velocity, march.chunk, march.measure, precision, march.pack.gaps, march.pack.contact)
    known += (march.panel.backing,)
    digest = hashlib.sha256(repr(known).encode())
    for const, state in zip(march.consts, march.states):
        for name, value in zip(const._fields, const):
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(value).tobytes())
        digest.update(state.mass.tobytes())
        digest.update(state.inverse_mass.tobytes())
    return digest.hexdigest()


def write(march, path):
    """Write the states and the records of a march."""
    import h5py

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs["format"], file.attrs["identity"] = _FORMAT, identity(march)
        file.attrs["reason"], file.attrs["wall_time"], file.attrs["zero"] = march.reason, march.wall_time, march._zero
        file.attrs["passed"] = march.passed
        for group, arrays in _groups(march):
            for name, value in zip(arrays._fields, arrays):
                if _kept(value):
                    file[f"{group}/{name}"] = np.array(value)
        for name, values in (march.behind.block.arrays() if march.behind else {}).items():
            file[f"block/{name}"] = values
        file["rest"] = march._rest
        file["samples"], file["ply_samples"] = np.array(march.samples), np.array(march.ply_samples)
        file["fine"] = np.concatenate(march.fine) if march.fine else np.empty((0, march.columns))
        file["chunks"] = np.array([part.shape[0] for part in march.fine], np.int64)
        for number, shots in enumerate(march.snapshots):
            for p, shot in enumerate(shots):
                for entry in fields(Snapshot):
                    file[f"snapshots/{number:05d}/{p:02d}/{entry.name}"] = getattr(shot, entry.name)


def read(march, path):
    """Bring a fresh march to the state of a checkpoint.

    Raises
    ------
    InputError : the file is missing, broken, or of another run
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            if file.attrs.get("format") != _FORMAT:
                raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(_FORMAT))
            if file.attrs["identity"] != identity(march):
                raise InputError("is the checkpoint of another run", file=path)
            for group, arrays in _groups(march):
                for name, value in zip(arrays._fields, arrays):
                    if not _kept(value):
                        continue
                    stored = file[f"{group}/{name}"][()]
                    for array, part in zip(value, stored) if isinstance(value, tuple) else [(value, stored)]:
                        array[...] = part
            if march.behind:
                march.behind.block.restore({name: data[()] for name, data in file["block"].items()})
            march.reason, march.wall_time = int(file.attrs["reason"]), float(file.attrs["wall_time"])
            march._zero, march.passed = float(file.attrs["zero"]), int(file.attrs["passed"])
            march._rest[:] = file["rest"][()]
            march.samples[:], march.ply_samples[:] = list(file["samples"][()]), list(file["ply_samples"][()])
            march.fine[:] = (
                np.split(file["fine"][()], np.cumsum(file["chunks"][()])[:-1]) if len(file["chunks"]) else []
            )
            march.snapshots[:] = [
                tuple(
                    Snapshot(*(shot[entry.name][()] for entry in fields(Snapshot))) for _, shot in sorted(shots.items())
                )
                for _, shots in sorted(file.get("snapshots", {}).items())
            ]
    except (OSError, KeyError) as problem:
        raise InputError(f"is not a readable checkpoint ({problem})", file=path) from None


def _groups(march):
    """(name in the file, named tuple) of all that marches."""
    plies = [(f"plies/{p:02d}", state) for p, state in enumerate(march.states)]
    pairs = [(f"pairs/{p:02d}", pair) for p, pair in enumerate(march.pairs)]
    return [*plies, *pairs, ("stack", march.stack)]


def _kept(value):
    """Whether an entry is an array, or several, and no constant."""
    return isinstance(value, np.ndarray) or (isinstance(value, tuple) and isinstance(value[0], np.ndarray))
