"""Cost of the energy checks and of the quality monitor: share of a run's CPU time, S-720, one ply, 250 us.

    python benchmarks/checks.py [--repeats 20]

Each run has its monitor and its checks timed call by call, so that runs need not be compared with one another. What
the kernels add to a step, a sum over blocks, is timed on its own.
"""

from __future__ import annotations

import argparse
import statistics
import time

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.jit.compile import entry
from shellfabric.loop import ply_kernels
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import Numerics


@entry()
def many(state, times):
    """What `loop.advance` adds to a step, so many times."""
    exchanged, before = 0.0, 0.0
    for _ in range(times):
        state.contact_work += 1.0
        now = ply_kernels.internal_work(state)
        exchanged, before = exchanged + abs(now - before), now
    return exchanged


def shares(panel, velocity, interval):
    """(monitor, checks, kernel) as shares of the CPU time of one run [-], and how many checks there were."""
    march, spent = (
        PackSolver(panel, velocity, 250e-6, interval=interval),
        {"sampled": 0.0, "_check_energy": 0.0},
    )
    for owner, name in ((march.monitor, "sampled"), (march, "_check_energy")):
        setattr(owner, name, _timed(getattr(owner, name), spent, name))
    start = time.process_time()
    march.run()
    total = time.process_time() - start
    ply_kernels.internal_work(march.state)
    many(march.state, 1)
    start = time.process_time()
    many(march.state, 100_000)
    kernel = (time.process_time() - start) / 100_000 * march.steps
    return spent["sampled"] / total, spent["_check_energy"] / total, kernel / total, march.checks


def _timed(function, spent, name):
    def timed():
        start = time.process_time()
        function()
        spent[name] += time.process_time() - start

    return timed


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=20)
    repeats = arguments.parse_args().repeats
    panel = Panel(
        CellModel(catalogue.load("S-720").with_effective_density()).table(201),
        numerics=Numerics(threads=1),
    )
    for velocity, interval in ((92.5, 2e-6), (155.0, 2e-6), (92.5, 10e-6), (300.0, 10e-6)):
        found = [shares(panel, velocity, interval) for _ in range(repeats)]
        monitor, checks, kernel = (
            100 * statistics.median(row[k] for row in found) for k in range(3)
        )
        print(
            f"{velocity:g} m/s, audits every {1e6 * interval:g} us: monitor {monitor:.2f} %, {found[0][3]} checks "
            f"{checks:.2f} %, kernel {kernel:.3f} % of the run (medians of {repeats})",
            flush=True,
        )


if __name__ == "__main__":
    main()
