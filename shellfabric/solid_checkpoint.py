"""Checkpoints of a solid patch's march: an interrupted run goes on bit for bit. Needs h5py."""

from __future__ import annotations

import hashlib

import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole

_FORMAT = "weavecell solid patch checkpoint 1"


class SolidWriter:
    """Hook: writes a checkpoint after every `every` audits, and at the end."""

    def __init__(self, path, every=8):
        self.path, self.every = path, every

    def __call__(self, march):
        if march.ended or len(march.samples) % self.every == 0:
            write(march, self.path)


class SolidSnapshots:
    """Hook: keeps the places of all nodes after every `every` audits, and at the end, in march.snapshots."""

    def __init__(self, every):
        self.every = every

    def __call__(self, march):
        if march.ended or len(march.samples) % self.every == 0:
            march.snapshots.append((march.time, march.state.x.copy()))


def identity(march):
    """Digest of everything that determines a run and its records."""
    digest = hashlib.sha256(repr((march.strike_velocity, march.interval, march.patch.numerics.safety)).encode())
    for name, value in zip(march.const._fields, march.const):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    return digest.hexdigest()


def write(march, path):
    """Write the state and the records of a march."""
    import h5py

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs["format"], file.attrs["identity"] = _FORMAT, identity(march)
        file.attrs["wall_time"] = march.wall_time
        for name, value in zip(march.state._fields, march.state):
            file[f"state/{name}"] = value
        file["samples"] = np.array(march.samples)
        for number, (when, places) in enumerate(march.snapshots):
            file[f"snapshots/{number:05d}"] = places
            file[f"snapshots/{number:05d}"].attrs["t"] = when


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
            for name, value in zip(march.state._fields, march.state):
                value[...] = file[f"state/{name}"][()]
            march.wall_time = float(file.attrs["wall_time"])
            march.samples[:] = list(file["samples"][()])
            march.snapshots[:] = [
                (float(part.attrs["t"]), part[()]) for _, part in sorted(file.get("snapshots", {}).items())
            ]
    except (OSError, KeyError) as problem:
        raise InputError(f"is not a readable checkpoint ({problem})", file=path) from None
