"""Checkpoints of a solid patch's march: an interrupted run goes on bit for bit. Needs h5py."""

from __future__ import annotations

import numpy as np

from fabrics import run_cache
from fabrics.files import replace_whole
from shellfabric.output import checkpoint

_FORMAT = "weavecell solid patch checkpoint 2"


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


def stamp(march):
    """Digests of everything that determines a run and its records, the code among it."""
    known = march.strike_velocity, march.interval, march.patch.numerics.safety, march.const._asdict()
    return run_cache.stamp(known, "shellfabric.solid.solver")


def write(march, path):
    """Write the state and the records of a march."""
    import h5py

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs.update(format=_FORMAT, **stamp(march))
        file.attrs["wall_time"] = march.wall_time
        checkpoint.store(file, "state", march.state)
        file["samples"] = np.array(march.samples)
        for number, (when, places) in enumerate(march.snapshots):
            file[f"snapshots/{number:05d}"] = places
            file[f"snapshots/{number:05d}"].attrs["t"] = when


def read(march, path):
    """Bring a fresh march to the state of a checkpoint.

    Raises
    ------
    InputError : the file is missing, broken, of another run, or of other code
    """
    with checkpoint.opened(path, _FORMAT, stamp(march)) as file:
        checkpoint.restore(file, "state", march.state)
        march.wall_time = float(file.attrs["wall_time"])
        march.samples[:] = list(file["samples"][()])
        march.snapshots[:] = [
            (float(part.attrs["t"]), part[()]) for _, part in sorted(file.get("snapshots", {}).items())
        ]
