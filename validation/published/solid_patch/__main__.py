"""python -m validation.published.solid_patch [--count 20] [--velocity 60] [--threads 2] [--out FOLDER] [--resume]

A patch of solid yarns with fibre bars under impact, and the shell of the same size beside it. Writes solid_patch.h5,
summary.txt, histories.png, patch.png and end.vtu; a checkpoint every 2 us, from which --resume goes on bit for bit.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import Any

from fabrics.errors import UnstableError, run_program
from fabrics.files import write_whole
from shellfabric.output import checkpoint
from validation.published.solid_patch import pictures
from validation.published.solid_patch.study import SOURCE_PROCESSORS, SOURCE_SECONDS, march, shell, summary, write


def progress(run: Any) -> None:
    """Say every 2 us where the run is."""
    if len(run.samples) % 8 == 0:
        tension = max(run.sample("warp_peak")[-1], run.sample("weft_peak")[-1])
        print(
            f"{1e6 * run.time:6.2f} us  {run.steps:6d} steps  {run.sample('v')[-1]:8.3f} m/s  peak {tension:6.1f} N  "
            f"balance {1e3 * run.sample('balance')[-1]:+.3f} mJ  {run.wall_time:6.0f} s",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m validation.published.solid_patch", description=__doc__.split("\n\n")[1]
    )
    parser.add_argument("--fabric", default="S-720")
    parser.add_argument("--count", type=int, default=20, help="warp and weft yarns, even")
    parser.add_argument("--size", type=int, nargs=3, default=(5, 5, 2), metavar=("NX", "NY", "NZ"))
    parser.add_argument("--velocity", type=float, default=60.0, help="m/s")
    parser.add_argument("--end-time", type=float, default=42.0, help="us")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("results/solid_patch"))
    parser.add_argument("--resume", action="store_true", help="go on from a checkpoint of this code")
    options = parser.parse_args()
    run = march(
        options.fabric, options.count, options.size, options.velocity, 1e-6 * options.end_time, threads=options.threads
    )
    beside = shell(run)  # a second; it also refuses a patch that is too small for the shot
    saved = options.out / "checkpoint.h5"
    if options.resume:
        checkpoint.read(run, saved)
    problem, start = None, time.process_time()
    try:
        run.run([progress, checkpoint.Checkpoints(saved, 8 * run.interval)])
    except UnstableError as found:
        problem = found
    processor = None if options.resume else time.process_time() - start
    lines = summary(run, beside, processor)
    source = f"{SOURCE_SECONDS} s on {SOURCE_PROCESSORS} processors (thesis Table 4-3, 160000 bricks, 42 us)"
    text = "\n".join(f"{name:24}{value}" for name, value in [*lines, ("source", source)])
    print(text)
    write(run, beside, options.out / "solid_patch.h5")
    with write_whole(options.out / "summary.txt") as file:
        file.write(text + "\n")
    pictures.histories(run, beside, options.out / "histories.png")
    pictures.scene(run, options.out / "patch.png")
    pictures.paraview(run, options.out / "end.vtu")
    if problem is not None:
        raise problem


if __name__ == "__main__":
    run_program(main)
