"""From a fabric's data to its compression law, by way of the 3D crossover: paths and plates solved, kept, evaluated.

Every path of every fabric is a case of its own, in a process with one thread, so that it comes out the same to the last
bit whichever process solves it, and when. A finished case is kept as a file at once; a run that is taken up again
begins with those whose inputs and code are the same (`fabrics.base.run_cache`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from dataclasses import dataclass, replace
from pathlib import Path
from queue import Empty
from typing import Any

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.executors import CONTEXT, cancel, open_executor
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from meshing import crossover as mesher
from meshing import patch
from meshing.crossover import Crossover
from meshing.inputs import Size
from meshing.mesh_file import MeshFile
from meshing.patch import Patch
from unitcell3d.cases import biaxial_and_platens, periodic_cell
from unitcell3d.identify.calibration import PLATES, Calibration, evaluate
from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.load_stepping import Steps

PATHS = {"warp only": (1.0, 0.0), "weft only": (0.0, 1.0), "equibiaxial": (1.0, 1.0)}
# both yarns at their failure strain together, where a shot presses them hardest on each other, and on by a tenth for
# the contact force of the cell, up to a tenth above that in 3D (docs/reports/material-tests.md), and by another
BOTH = "both beyond failure"
BEYOND = 1.2
# of a fabric without a published law, whose shots press harder: to a force over the one at failure, or to that strain
PRESSED = 1.5
FARTHEST = 2.0
CASES = len(PATHS) + 2  # of a fabric: the paths, that of both yarns, and the platens


@dataclass(frozen=True)
class Job:
    """One path of one fabric; `ratio` (d1, d2), or None between plates; `friction` Coulomb's coefficient.

    `beyond` is the mean fibre strain at its end over the failure strain; fibres do not fail. With `pressed` it ends too
    where the contact force is so many times the one at failure.
    """

    name: str
    fabric: Fabric
    size: Size
    ratio: tuple | None
    friction: float = 0.0
    beyond: float = 1.0
    pressed: float | None = None
    fibre_fraction: str | None = None

    @property
    def numerics(self) -> Numerics:
        """What it is solved with."""
        return Numerics(friction=self.friction, fibre_fraction=self.fibre_fraction)

    @property
    def key(self) -> str:
        """Key of its result: of what it is solved with, and of the code."""
        return run_cache.key(
            (
                self.fabric,
                self.size,
                self.ratio,
                self.beyond,
                self.pressed,
                self.numerics,
                Steps(),
            ),
            __name__,
        )

    def file(self, folder: FilePath) -> Path:
        """Return the job's file in the folder of its fabric."""
        return Path(folder) / file_of(self.name)


def file_of(path: str) -> str:
    """Return the name of the file with the history of a path."""
    return f"{path.replace(' ', '-')}.h5"


def names() -> list[str]:
    """Return the names of the files with the histories of the default paths."""
    return [file_of(path) for path in (*PATHS, BOTH, PLATES)]


def path_jobs(
    fabric: Fabric,
    size: Size,
    friction: float = 0.0,
    paths: Mapping[str, Sequence[float]] | None = None,
    fibre_fraction: str | None = None,
) -> list[Job]:
    """List the biaxial paths of a calibration: those of `PATHS` and `BOTH`, or {name: (d1, d2)
    ratio} that are given."""
    jobs = [
        Job(name, fabric, size, tuple(map(float, ratio)), friction, fibre_fraction=fibre_fraction)
        for name, ratio in (PATHS if paths is None else paths).items()
    ]
    if paths is None:
        ratio = biaxial_and_platens.displacements_at_failure(fabric)
        last = Job(BOTH, fabric, size, ratio, friction, BEYOND, fibre_fraction=fibre_fraction)
        if fabric.laws is None:
            last = replace(last, beyond=FARTHEST, pressed=PRESSED)
        jobs.append(last)
    return jobs


def calibrate(fabric: Fabric, *, out: FilePath | None = None, **choices: Any) -> Calibration:
    """Calibrate the compression law of one fabric; returns its `calibration.Calibration`.

    Parameters
    ----------
    fabric : Fabric, with solid laws
    out : directory for histories and laws, or None
    **choices : as in `calibrate_all`

    Raises
    ------
    InputError : the fabric cannot be meshed, or a size or path is not allowed
    UnstableError : no path got far enough for a fit
    """
    found = calibrate_all([fabric], folder=lambda name: out, **choices)[fabric.name]
    if isinstance(found, Exception):
        raise found
    return found


def calibrate_all(
    fabrics: Sequence[Fabric],
    *,
    size: Size,
    plates_size: Size = "coarse",
    friction: float = 0.0,
    paths: Mapping[str, Sequence[float]] | None = None,
    fibre_fraction: str | None = None,
    folder: Callable[[str], FilePath | None] = lambda name: None,
    laws: bool = True,
    resume: bool = False,
    executor: str | Executor = "local",
    jobs: int = 1,
    on_progress: Callable[[str, str, float], object] | None = None,
) -> dict[str, Calibration | Exception]:
    """Calibrate several fabrics, their paths beside each other; one that fails does not end the others.

    Parameters
    ----------
    fabrics : of Fabric, with solid laws
    size, plates_size : mesh sizes of the biaxial paths and of the plate compression (`meshing.crossover.build`);
        a MeshFile is the mesh of both
    friction : [-] Coulomb's coefficient between the yarns, and between yarns and plates
    paths : {name: (d1, d2) ratio}, each to fibre failure; by default warp only, weft only, equibiaxial, and both yarns
        beyond failure
    fibre_fraction : "mesh", "stated" or None, which enters the law of the solid (`material.numerics.Numerics`)
    folder : function of a fabric's name giving the directory for its histories and laws, or None
    laws : whether the laws are written as well; not where more is to be added to them before
    resume : take finished paths from their files, unless these are of other inputs or of other code
    executor, jobs : as in `fabrics.base.executors.open_executor`; local processes also tell of each step
    on_progress : called as on_progress(fabric name, path name, share of that path)

    Returns
    -------
    {fabric name: Calibration, or the InputError or UnstableError that ended it}

    Raises
    ------
    InputError : a choice that is wrong for all of them
    """
    if paths is not None and (not paths or PLATES in paths):
        raise InputError(
            key="paths",
            value=sorted(paths),
            allowed=f"at least one, none of them called {PLATES!r}",
        )
    Numerics(friction=friction, fibre_fraction=fibre_fraction)  # refuses what is not allowed
    begun = time.perf_counter()
    if isinstance(size, MeshFile):
        plates_size = size  # the platens press the same sections
    run = _Run(folder, laws, resume, on_progress if on_progress is not None else _silent)
    for fabric in fabrics:
        # the longest first: plates take the most steps
        plates = Job(PLATES, fabric, plates_size, None, friction, fibre_fraction=fibre_fraction)
        run.add(fabric, [plates, *path_jobs(fabric, size, friction, paths, fibre_fraction)])
    run.solve(executor, jobs)
    names = [*((*PATHS, BOTH) if paths is None else paths), PLATES]
    for fabric in fabrics:
        run.finish(fabric, names, (str(size), str(plates_size)), friction, begun)
    return {fabric.name: run.outcomes[fabric.name] for fabric in fabrics}


def _silent(fabric, path, share):
    pass


class _Run:
    """Jobs to do, histories done, and what ended a fabric."""

    def __init__(self, folder, laws, resume, on_progress):
        self._folder = folder
        self._laws = laws
        self._resume = resume
        self._on_progress = on_progress
        self._open = []
        self._done = {}
        self.outcomes = {}

    def add(self, fabric, jobs):
        """Take in the jobs of a fabric; those that are done come from their files."""
        try:
            for size in dict.fromkeys(job.size for job in jobs):
                mesher.build(fabric, size=size)  # bad input ends here, in this process
        except InputError as problem:
            self.outcomes[fabric.name] = problem
            return
        for job in jobs:
            kept = self._kept(job)
            if kept is None:
                self._open.append(job)
            else:
                self._done[fabric.name, job.name] = kept
                self._on_progress(fabric.name, job.name, 1.0)

    def _kept(self, job):
        folder = self._folder(job.fabric.name)
        if not self._resume or folder is None or not job.file(folder).exists():
            return None
        notes = Record.notes(job.file(folder))
        if notes.get("key") != job.key:
            return None
        return Record.read(job.file(folder)), notes["seconds"]

    def solve(self, executor, jobs):
        """Solve the open jobs, plates first, and keep each as it comes."""
        if not self._open:
            return
        queue = None
        first = ()
        if executor == "local":
            queue = CONTEXT.Queue()
            first = (_take_queue, queue)
        waiting = sorted(self._open, key=lambda job: job.ratio is not None)
        with open_executor(executor, min(jobs, len(waiting)), fresh=True, first=first) as pool:
            futures = {}
            for job in waiting:
                futures[pool.submit(run_job, job)] = job
            pending = set(futures)
            try:
                while pending:
                    finished, pending = wait(pending, timeout=0.2, return_when=FIRST_COMPLETED)
                    self._forward_progress(queue)
                    for future in finished:
                        self._take(futures[future], future)
            finally:
                for future in pending:
                    cancel(future)

    def _forward_progress(self, queue):
        try:
            while queue is not None:
                fabric, path, share = queue.get_nowait()
                # what a path says of itself may come after its result
                if (fabric, path) not in self._done:
                    self._on_progress(fabric, path, share)
        except Empty:
            pass

    def _take(self, job, future):
        try:
            history, seconds = future.result()
        except (InputError, UnstableError) as problem:
            self.outcomes[job.fabric.name] = problem
            return
        folder = self._folder(job.fabric.name)
        if folder is not None:
            history.write(job.file(folder), key=job.key, seconds=seconds)
        self._done[job.fabric.name, job.name] = history, seconds
        self._on_progress(job.fabric.name, job.name, 1.0)

    def finish(self, fabric, names, sizes, friction, begun):
        """Evaluate a fabric's histories and write what they give."""
        if fabric.name in self.outcomes:
            return
        done = {name: self._done[fabric.name, name] for name in names}
        seconds = {name: elapsed for name, (_, elapsed) in done.items()}
        try:
            found = evaluate(
                fabric,
                {name: history for name, (history, _) in done.items()},
                sizes,
                seconds | {"all": time.perf_counter() - begun},
                friction,
            )
        except UnstableError as problem:
            self.outcomes[fabric.name] = problem
            return
        if self._laws and self._folder(fabric.name) is not None:
            found.write(self._folder(fabric.name))
        self.outcomes[fabric.name] = found


def build_mesh(fabric: Fabric, size: Size) -> Crossover | Patch:
    """Mesh what stands for a weave: a crossover, or with floats the cell of its pattern."""
    pattern = fabric.weave.pattern
    if pattern.is_plain:
        return mesher.build(fabric, size=size)
    return patch.build(fabric, pattern.cell[:2], size=size)


def run_job(job: Job) -> tuple[Record, float]:
    """Run one job: (Record, wall time [s])."""
    begun = time.perf_counter()

    def on_progress(share, row):
        if _queue is not None:
            _queue.put((job.fabric.name, job.name, share))

    same: dict[str, Any] = {"numerics": job.numerics, "hooks": (on_progress,)}
    if job.ratio is None:
        crossover = mesher.build(job.fabric, size=job.size)
        history = biaxial_and_platens.plate_compression(crossover, job.fabric, **same)
    else:
        same |= {"beyond": job.beyond, "pressed": job.pressed}
        mesh = build_mesh(job.fabric, job.size)
        if isinstance(mesh, Patch):
            history = periodic_cell.to_failure(mesh, job.fabric, job.ratio, **same)
        else:
            history = biaxial_and_platens.biaxial(mesh, job.fabric, job.ratio, **same)
    return replace(history, facts=history.facts | {"case": job.name}), time.perf_counter() - begun


_queue = None  # of a worker process, set once when it starts


def _take_queue(queue):
    global _queue
    _queue = queue
