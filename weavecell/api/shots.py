"""One impact on one ply or several, from its input file or keywords to its folder of results."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError, interrupts
from fabrics.fabric import Fabric
from weavecell.answers.shot import NAMES, ShotResult, shot_of
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command, keep_runs
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import RunSize, StudySize
from weavecell.api.target import resolve_target
from weavecell.results import out_folder, progress, run_folder

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.studies.mesh_uncertainty import Shot


@dataclass(frozen=True)
class ShotPlan(Plan[ShotResult]):
    """A shot that is about to be fired.

    Parameters
    ----------
    target : Target
    uncertainty : whether a finer mesh is run too
    draws, seed : number of drawn shots beside it, and of all that is drawn
    written : whether files and pictures are made, which take memory
    """

    files = (*NAMES, run_folder.CHECKPOINTS)
    runs = ""

    target: Target
    uncertainty: bool
    draws: int
    seed: int
    written: bool

    @property
    def inputs(self) -> Sequence[object]:
        """The set-up."""
        from weavecell.studies import inputs

        return [inputs.use_one_thread(self.target.setup)]

    def key(self) -> str:
        """Return the digest of text, set-up, options and code."""
        given = (
            self.target.text,
            self.target.setup,
            self.uncertainty,
            (self.draws, self.seed),
        )
        return run_cache.key(given, "shellfabric.impact.run")

    def finished(self, folder: Path) -> ShotResult | None:
        """Return the result of this very shot that a folder holds; None without."""
        from weavecell.results import result_folder

        found = result_folder.find_whole(folder, NAMES, self.key())
        if found is None:
            return None
        return ShotResult.of_folder(found, self.target)

    def forecast(self) -> RunSize:
        """Forecast elements, steps, memory and CPU time of one shot, and name what is assumed."""
        panel = self.target
        size = RunSize.estimate(
            panel.setup, panel.shot_title, written=self.written, scene=panel.scene
        )
        choices = dict(size.said.choices)
        if self.uncertainty:
            choices["meshes"] = "two, for the error of the first"
        size = replace(size, said=replace(size.said, choices=tuple(choices.items())))
        if not self.draws:
            return size
        from weavecell.runs import table

        drawn = StudySize.estimate(
            table.as_fired(panel.setup), panel.title, self.draws, 0, drawn=True
        )
        return replace(size, beside=drawn)

    def run(self, running: Running) -> ShotResult:
        """Fire, run what else the answer rests on, and write all of it."""
        shooting = Shooting(self.target, running.folder, running.how.resume)
        if self.uncertainty:
            result, running.failure = shooting.compare_meshes()
        else:
            result, running.failure = shooting.fire()
        if self.draws and running.failure is None:
            result = _with_draws(result, self, running.folder)
        if running.folder is not None:
            self._save(result, running.folder)
        return result

    def _save(self, result, folder):
        """Write the result; only then its checkpoints and finished shots are no longer needed."""
        with progress.bar("Writing results"):
            result.save(folder)
        for checkpoint in run_folder.list_checkpoints(folder):
            checkpoint.unlink()
        for name in (out_folder.WINDOW, out_folder.DRAWS):
            run_cache.RunCache(folder / name).clear()

    def give_up(self, running: Running, problem: BaseException) -> None:
        """Say how an interrupted run goes on."""
        if not isinstance(problem, KeyboardInterrupt):
            return
        message = "interrupted"
        if running.folder is not None and run_folder.list_checkpoints(running.folder):
            message += f"; {option('resume')} goes on from its last checkpoint"
        raise run_folder.Interrupted(message) from None


@command(ShotPlan)
@explain_keywords(Keywords)
def impact(
    target: Fabric | FilePath | ImpactSetup | None,
    velocity: float | str | None = None,
    *,
    draws: int = 0,
    seed: int | None = None,
    uncertainty: bool = False,
    check: bool = False,
    out: FilePath | None = None,
    resume: bool = False,
    **options: Unpack[Keywords],
) -> ShotPlan:
    """Fire a projectile at a panel: histories, ParaView series, pictures and a report.

    It is one shot: each friction that nobody gave is in the middle of its range, and the nose strikes half-way
    between a gap and a crossover, with resolved yarns, unless the input says otherwise.

    A shot that is still in flight at the end time is a result with the outcome "in flight". A key of the
    input file that cannot be honoured is rejected.

    The folder then holds report.html, summary.json, histories.h5, panel.pvd with ``panel/*.vtu``,
    pictures/ and scene.toml; while the run goes on, checkpoint.h5.

    Parameters
    ----------
    target : input file of a ply or pack; in Python also a fabric, or a set-up of `setup`
    velocity : of a fabric, [m/s] of the strike
    draws : fire so many drawn shots beside it, as `v50` draws them, for the share that perforates with its
        interval of 90 %, and residual velocity and deflection that 1, 5 and 9 in 10 keep below
    seed : of all that is drawn, 1 if not given; refused without `draws`
    uncertainty : run a finer mesh too, and report the discretisation uncertainty of each result; of
        a shot that perforates, on both meshes, the mean over a window of +-8 % of the velocity with
        its standard error
    check : run nothing and write nothing: forecast elements, steps, memory and CPU time, and name
        what is assumed
    out : folder of the results; in Python None writes nothing
    resume : whether to continue an interrupted run from the folder; the state of an unfinished run
        of another version of the code is refused
    **options : beside a fabric, keywords of `setup`

    Returns
    -------
    ShotResult, one with a quality check beyond its limit (docs/reports/numerics.md) is `doubtful`
    and warns with `DoubtfulResult`. Where the folder to `resume` from holds the results of this very
    run, nothing is run: the ShotResult is read from it (`ShotResult.of_folder`). Its `draws` are the drawn shots

    Raises
    ------
    InputError : as `setup`
    UnstableError : the run became unphysical; its attribute `result` is the ShotResult up to then,
        which is written

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot.outcome, round(shot.residual_velocity)  # [m/s]
    ('in flight', 148)
    """
    panel = resolve_target(target, options, "shot", velocity, function="impact", one_shot=True)
    # a report describes the panel by what was built from an input file
    if panel.case is None and out is not None:
        raise InputError(
            key="out", allowed="left out beside a set-up: an input file, or a fabric, has a report"
        )
    count = quantities.read_whole(draws, "draws", 0)
    if not uncertainty:
        panel = panel.nominal()
    elif count:
        raise InputError(key="draws", value=draws, allowed="left out of several meshes")
    if count:
        from weavecell.runs import table
        from weavecell.studies import inputs, strengths

        seed = quantities.read_whole(1 if seed is None else seed, "seed", 0)
        with panel.name_problems():
            strengths.check_places(table.as_fired(panel.setup), inputs.read_scatter(), seed, count)
    else:
        quantities.refuse_unused({"seed": seed}, f"without {option('draws', '')}")
    return ShotPlan(panel, uncertainty, count, seed or 1, out is not None)


@dataclass(frozen=True)
class Shooting:
    """Shots at a target that make one result.

    Parameters
    ----------
    target : Target
    folder : of checkpoints and of the window; None if nothing is written
    resume : whether to go on from the checkpoints
    """

    target: Target
    folder: Path | None
    resume: bool

    def fire(self) -> tuple[ShotResult, UnstableError | None]:
        """Fire on one mesh.

        Returns
        -------
        result, failure : of the shot; the UnstableError that ended its run, or None
        """
        return self._result(self.shoot(self.target.setup), self.target)

    def compare_meshes(self) -> tuple[ShotResult, UnstableError | None]:
        """Fire as `fire` on a pair of meshes; the result is that of the target's own."""
        from weavecell.studies import mesh_uncertainty

        shot, pair = mesh_uncertainty.run_pair(self.target.setup, self.shoot_with_window)
        return self._result(shot, self.target, pair=pair)

    def _result(self, shot, target, **more):
        message = str(shot.failure or "")
        return shot_of(target, shot.result, message, target=target, **more), shot.failure

    def shoot(self, setup: ImpactSetup, table: CellTable | None = None, mesh: str = "") -> Shot:
        """Fire at a set-up on one mesh.

        Parameters
        ----------
        table : of the cell; None makes it
        mesh : its name, since each mesh has a checkpoint of its own: a state fits its mesh alone
        """
        from shellfabric.impact.run import check_impact, run_impact
        from shellfabric.loop.checkpoint import LEAST_WALL, Checkpoints
        from weavecell.studies.mesh_uncertainty import Shot

        checkpoint = self._checkpoint(mesh)
        kept = checkpoint is not None
        table = table or setup.table(kept=kept)
        # refused before the run, not when memory ends in the middle of it
        pack = check_impact(setup, table, written=kept)
        hooks: tuple[Checkpoints, ...] = ()
        again = None
        if checkpoint is not None:
            interval = self.target.checkpoint_interval
            hooks = (Checkpoints(checkpoint, interval, LEAST_WALL),)
            if self.resume and checkpoint.exists():
                again = checkpoint

        def run(hooks):
            return run_impact(setup, hooks=hooks, resume=again, table=table, target=pack)

        return Shot(*progress.run_with_bar(run, self.target.shot_title, hooks))

    def shoot_with_window(self, setup: ImpactSetup, table: CellTable, mesh: str = "") -> Shot:
        """Fire as `shoot`; and if the shot perforates, also at velocities about its own, since
        values jump with the velocity where yarns fail one by one."""
        # a single shot does not need it
        from weavecell.studies import window

        shot = self.shoot(setup, table, mesh)
        # a shot that holds has no staircase of failing yarns
        if shot.failure is not None or shot.result.outcome != "perforated":
            return shot
        with (
            keep_runs(self.folder, True, out_folder.WINDOW) as runs,
            progress.bar("Shots at other velocities") as advance,
        ):

            def report(done, count):
                return advance(done / count)

            about = window.fire_window(shot.result, folder=runs, report=report)
            return replace(shot, window=about)

    def _checkpoint(self, mesh):
        """Return the path of a mesh's checkpoint, or None if nothing is written."""
        if self.folder is None:
            return None
        name = "checkpoint"
        if mesh:
            name += f"-{mesh.replace(' ', '-')}"
        return self.folder / f"{name}.h5"


def _with_draws(shot, plan, folder):
    """Return the ShotResult with the drawn shots of a ShotPlan."""
    from weavecell.runs import passing
    from weavecell.studies import inputs

    logging.getLogger("weavecell").info(str(shot.answer))

    def compute():
        with (
            keep_runs(folder, True, out_folder.DRAWS) as runs,
            progress.bar(counted(plan.draws, "drawn shot")) as advance,
        ):
            return passing.fire_draws(
                plan.target.setup,
                inputs.read_scatter(),
                draws=plan.draws,
                seed=plan.seed,
                folder=runs,
                report=lambda done, of: advance(done / of, f"{done} of {of}"),
            )

    return replace(shot, draws=_compute_beside(shot, folder, "its drawn shots", compute))


def _compute_beside(shot, folder, about, compute):
    """What takes many more runs than the shot beside which it stands: compute(), or None if the user
    ends it and nothing is written. The numbers of the shot are written first.

    Raises
    ------
    run_folder.Interrupted : the user ended it, of a shot with a folder
    """
    if folder is not None:
        shot.save_numbers(folder)
    try:
        with interrupts():
            return compute()
    except KeyboardInterrupt:
        if folder is None:
            return None
        going_on = f"{option('resume')} goes on with {about}"
        message = f"interrupted; the numbers of the shot are in {folder}, {going_on}"
        raise run_folder.Interrupted(message) from None
