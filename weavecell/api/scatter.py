"""V50: shots at panels of which all that nobody gave is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import UnstableError
from fabrics.fabric import Fabric
from weavecell.answers.v50 import NAMES, V50Result
from weavecell.api import quantities
from weavecell.api.command import Plan, Report, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize
from weavecell.api.target import resolve_target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.studies.inputs import Scatter


@dataclass(frozen=True)
class V50Plan(Plan[V50Result]):
    """Shots at drawn panels that are about to be fired.

    Parameters
    ----------
    target : Target
    scatter : `weavecell.studies.inputs.Scatter`
    shots, batch, seed : number of shots, of those of a round, and of all random numbers
    within : [-] half width of the interval of V50, over V50, at which it ends; 0 fires all shots
    """

    files = NAMES

    target: Target
    scatter: Scatter
    shots: int
    batch: int
    seed: int
    within: float = 0.0

    @property
    def inputs(self) -> Sequence[object]:
        """Set-up, scatter and seed: any number of its shots go on from the same ones."""
        from weavecell.studies import inputs

        fired_at = inputs.use_one_thread(self.target.setup, strike_velocity=1.0)
        return [(fired_at, self.scatter, self.seed)]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time."""
        from weavecell.runs import table

        words: dict[str, Any] = {"scene": self.target.scene, "drawn": True}
        fired = table.as_fired(self.target.setup)
        return StudySize.estimate(fired, self.target.title, self.shots, 0, **words)

    def run(self, running: Running) -> V50Result:
        """Fire."""
        with running.count(f"{self.target.title}, drawn shots") as part:
            result = self.fire(running, part())
        running.save(result)
        if failures := result.study.failures:
            left_out = (
                f"{len(failures)} of {counted(self.shots, 'shot')} are left out of all estimates"
            )
            running.failure = UnstableError(f"{left_out}: {failures[0]}", result=result)
        return result

    def fire(self, running: Running[Any], report: Report, **more: Any) -> V50Result:
        """Fire; `more` of `v50.study`."""
        from weavecell.runs import v50 as analysis

        study = analysis.study(
            self.target.setup,
            self.scatter,
            shots=self.shots,
            batch=self.batch,
            seed=self.seed,
            within=self.within,
            report=report,
            **more,
            **running.cache,
        )
        return V50Result(study, self.target, self.seed, self.batch, running.wall_time)


@command(V50Plan)
@explain_keywords(ResumableKeywords, Keywords)
def v50(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    shots: int | None = None,
    batch: int | None = None,
    within: float | str | None = None,
    check: bool = False,
    seed: int = 1,
    **options: Unpack[StudyKeywords],
) -> V50Plan:
    """Find the velocities that 1 in 10, half and 9 in 10 shots pass, over all that nobody gave.

    Each shot hits a new panel, whose yarns have random strengths, at a random place of the weave and roll of
    the nose, with each friction that nobody gave drawn from its range; it is always computed whole, with
    resolved yarns unless the input pins them. Shots that become unstable, or neither stop nor perforate, are
    left out of all estimates. The set-up of a fabric is one ply of 203 mm, clamped, and a flat cylinder of 3 g and
    5.5 mm. These keys of an input file are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] is rejected.

    The folder `out` then has report.html, v50.csv, v50.json, v50.png, shots.csv, scene.toml, and
    runs/ with a file for each shot. If yarns are resolved, shots.csv has the drawn impact points.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or
        a set-up of `setup`
    shots : number of shots, at least 4; if not given 16, or at most 64 with `within`
    batch : shots of a round; outcomes so far decide the velocities of the next round. If not given 2
    within : fire no more shots once the interval of V50 is so narrow, half of it over V50, such as "5 %"
    check : run nothing and write nothing: forecast shots and CPU time
    seed : seed of all random numbers; the same seed draws the same panels
    **options : jobs, executor, out and resume; beside a fabric also keywords of `setup` but history

    Returns
    -------
    V50Result

    Raises
    ------
    InputError : as `critical_velocity`, fewer than four shots, or yarns that do not fail
    UnstableError : shots without an outcome; its attribute `result` is the V50Result of the others,
        which is written

    Examples
    --------
    >>> found = wc.v50("S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> found.v50_low < found.v50 < found.v50_high  # [m/s]
    True
    """
    from weavecell.runs import table
    from weavecell.runs import v50 as analysis
    from weavecell.studies import inputs, strengths

    scatter = inputs.read_scatter()
    narrow = 0.0
    if within is not None:
        narrow = quantities.read_positive(within, "", "within")
    if shots is None:
        shots = analysis.MOST_WITHIN if narrow else analysis.USUAL
    shots = quantities.read_whole(shots, "shots", analysis.LEAST)
    if batch is None:
        batch = analysis.BATCH
    sizes = {
        "shots": shots,
        "batch": quantities.read_whole(batch, "batch", 1),
        "seed": quantities.read_whole(seed, "seed", 0),
    }
    panel = resolve_target(target, options, "v50", function="v50").resolved()
    with panel.name_problems():
        fired = table.as_fired(panel.setup)
        strengths.check_places(fired, scatter, sizes["seed"], shots)
    return V50Plan(panel, scatter, **sizes, within=narrow)
