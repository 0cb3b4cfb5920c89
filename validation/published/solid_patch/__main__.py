"""python -m validation.published.solid_patch [--count 20] [--velocity 60] [--threads 2] [--out FOLDER] [--resume]

A patch of solid yarns with fibre bars under impact, and the shell of the same size beside it. Writes solid_patch.h5,
summary.txt, histories.png, patch.png and end.vtu; a checkpoint every 2 us, from which --resume goes on bit for bit.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from fabrics.errors import UnstableError
from fabrics.files import write_whole
from shellfabric.output import checkpoint
from validation.program import program
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


def main(
    *,
    fabric: str = "S-720",
    count: int = 20,
    size: tuple[int, int, int] = (5, 5, 2),
    velocity: float = 60.0,
    end_time: float = 42.0,
    threads: int = 2,
    out: Path = Path("results/solid_patch"),
    resume: bool = False,
) -> None:
    run = march(fabric, count, size, velocity, 1e-6 * end_time, threads=threads)
    beside = shell(run)  # a second; it also refuses a patch that is too small for the shot
    saved = out / "checkpoint.h5"
    if resume:
        checkpoint.read(run, saved)
    problem, start = None, time.process_time()
    try:
        run.run([progress, checkpoint.Checkpoints(saved, 8 * run.interval)])
    except UnstableError as found:
        problem = found
    processor = None if resume else time.process_time() - start
    lines = summary(run, beside, processor)
    source = f"{SOURCE_SECONDS} s on {SOURCE_PROCESSORS} processors (thesis Table 4-3, 160000 bricks, 42 us)"
    text = "\n".join(f"{name:24}{value}" for name, value in [*lines, ("source", source)])
    print(text)
    write(run, beside, out / "solid_patch.h5")
    with write_whole(out / "summary.txt") as file:
        file.write(text + "\n")
    pictures.histories(run, beside, out / "histories.png")
    pictures.scene(run, out / "patch.png")
    pictures.paraview(run, out / "end.vtu")
    if problem is not None:
        raise problem


if __name__ == "__main__":
    program(
        main,
        count="warp and weft yarns, even",
        size="bricks of a quarter crossover: NX NY NZ",
        velocity="m/s",
        end_time="us",
        resume="go on from a checkpoint of this code",
    )
