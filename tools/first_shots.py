"""Measure the first run of each kind after `make setup`, which has compiled the kernels of one ply.

    python tools/first_shots.py OUT.csv

Each kind starts from a copy of the cache that the set-up leaves, in a process of its own, and runs
twice: what the first takes more is compiling. Minutes of one core. The runs are those of
tools/compile_kernels.py, which are too short to tell a user's own time of marching.
"""

from __future__ import annotations

import argparse
import csv
import os
import resource
import shutil
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

HEADING = "kind", "first_cpu_s", "first_wall_s", "again_cpu_s"


def main() -> None:
    """Write the table, or run one kind."""
    from tools.compile_kernels import list_runs

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--kind", help="run this kind alone, and write nothing")
    chosen = parser.parse_args()
    runs = dict(list_runs())
    if chosen.kind:
        runs[chosen.kind]()
        return
    ply, *others = runs
    with TemporaryDirectory() as folder, chosen.out.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(HEADING)
        set_up = Path(folder, "ply")
        _run(ply, set_up)
        for kind in (ply, *others):
            cache = Path(folder, "kind")
            shutil.copytree(set_up, cache)
            first, wall = _run(kind, cache)
            again, _ = _run(kind, cache)
            shutil.rmtree(cache)
            table.writerow([kind, f"{first:.1f}", f"{wall:.1f}", f"{again:.1f}"])
            out.flush()


def _run(kind, cache):
    """CPU seconds and seconds of a run of a kind in a process of its own, with these kernels."""
    began = time.perf_counter()
    before = _cpu_seconds()
    command = [sys.executable, __file__, os.devnull, "--kind", kind]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(cache)}
    subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
    return _cpu_seconds() - before, time.perf_counter() - began


def _cpu_seconds():
    """CPU seconds of all processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
