"""Checkpoints of a pack's march as HDF5, written whole or not at all; a resumed run goes on bit for bit."""

from __future__ import annotations

from collections import namedtuple

import numpy as np

from fabrics import run_cache
from fabrics.files import replace_whole
from shellfabric.output import checkpoint

Kept = namedtuple("Kept", "force touched energy")  # of what holds torn cloth apart; the rest follows from the plies
_FORMAT = "weavecell pack checkpoint 2"


class Checkpoints(checkpoint.Checkpoints):
    """Write a checkpoint every interval [s] of the run's time, over the last one."""

    def write(self, march):
        """Write the checkpoint."""
        write(march, self.path)


def stamp(march):
    """Digests of everything that determines a run: plies, tables, knobs, contact, strike velocity, code."""
    known = march.strike_velocity, march.chunk, march.measure, march.panel.numerics.precision
    known += march.pack.gaps, march.pack.contact, march.panel.backing
    for const, state in zip(march.consts, march.states):
        known += const._asdict(), state.mass, state.inverse_mass
    return run_cache.stamp(known, "shellfabric.impact.pack")


def write(march, path):
    """Write the states and the records of a march."""
    import h5py

    with replace_whole(path) as beside, h5py.File(beside, "w") as file:
        file.attrs.update(format=_FORMAT, **stamp(march))
        for group, arrays in _groups(march):
            checkpoint.store(file, group, arrays)
        checkpoint.store_records(file, march)
        file["rest"], file["ply_samples"] = march._rest, np.array(march.ply_samples)
        for number, shots in enumerate(march.snapshots):
            for p, shot in enumerate(shots):
                checkpoint.store_snapshot(file, f"{number:05d}/{p:02d}", shot)


def read(march, path):
    """Bring a fresh march to the state of a checkpoint.

    Raises
    ------
    InputError : the file is missing, broken, of another run, or of other code
    """
    with checkpoint.opened(path, _FORMAT, stamp(march)) as file:
        for group, arrays in _groups(march):
            checkpoint.restore(file, group, arrays)
        checkpoint.restore_records(file, march)
        march._rest[:], march.ply_samples[:] = file["rest"][()], list(file["ply_samples"][()])
        march.snapshots[:] = [
            tuple(checkpoint.snapshot(group) for _, group in sorted(shots.items()))
            for _, shots in sorted(file.get("snapshots", {}).items())
        ]


def _groups(march):
    """(name in the file, named tuple) of all that marches."""
    plies = [(f"plies/{p:02d}", state) for p, state in enumerate(march.states)]
    pairs = [(f"pairs/{p:02d}", pair) for p, pair in enumerate(march.pairs)]
    stops = Kept(*(getattr(march.stops, name) for name in Kept._fields))
    return [*plies, *pairs, ("stack", march.stack), ("stops", stops)]
