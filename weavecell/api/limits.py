"""The critical velocity of a panel or pack: what was found, its files, and what is printed of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import (
    InputError,
    UndecidedError,
    UnstableError,
    WeavecellError,
)
from fabrics.fabric import Fabric
from weavecell.answers.critical_velocity import NAMES, CriticalVelocityResult
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableSearchKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import LOOKS, StudySize
from weavecell.api.target import resolve_target
from weavecell.report import checks
from weavecell.results import one_table

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.studies.ballistic_limit import Shot
    from weavecell.studies.limit_scan import ScanRange
NO_LIMIT = "a panel whose yarns do not fail has no limit"


@dataclass(frozen=True)
class LimitPlan(Plan[CriticalVelocityResult]):
    """What a search of a limit is about to do.

    Parameters
    ----------
    target : Target
    tolerance : [m/s] of the bracket; None of a pack, that of `usual_tolerance`
    v50_shots, residual_shots : numbers of shots
    scan : ScanRange, or None
    only_mixed : whether it is scanned only where outcomes mix
    """

    files = NAMES

    target: Target
    tolerance: float | None
    v50_shots: int
    residual_shots: int
    scan: ScanRange | None
    only_mixed: bool

    @property
    def inputs(self) -> Sequence[object]:
        """The set-up: any of its searches go on from the same shots."""
        from weavecell.studies import inputs

        return [inputs.use_one_thread(self.target.setup, strike_velocity=1.0)]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time."""
        from weavecell.studies import limit as limits

        fired = self.residual_shots + self.v50_shots
        if self.scan is not None:
            steps = round((self.scan.above + self.scan.below) / self.scan.step)
            fired += LOOKS if self.only_mixed else steps
        panel = self.target
        width = self.tolerance or limits.usual_tolerance(panel.setup.target())
        return StudySize.estimate(
            panel.setup, panel.title, fired, 1, tolerance=width, scene=panel.scene
        )

    def run(self, running: Running) -> CriticalVelocityResult:
        """Search the limit."""
        study = self._search(self.target, running)
        result = CriticalVelocityResult(
            self.target, study.limit, study.fit, scan=study.scan, wall_time=running.wall_time
        )
        return running.save(result)

    def _search(self, panel, running):
        from weavecell.studies import limit as limits

        return limits.search(
            panel.setup,
            tolerance=self.tolerance,
            v50_shots=self.v50_shots,
            residual_shots=self.residual_shots,
            scan=self.scan,
            only_mixed=self.only_mixed,
            stage=lambda title: running.stage(title, checks.describe_shot),
            folder=running.kept,
            **running.how.pool,
        )

    def give_up(self, running: Running, problem: BaseException) -> None:
        """Write the shots so far, and the input."""
        keep(running.ended, problem, self.target, running.folder)


@command(LimitPlan)
@explain_keywords(ResumableSearchKeywords, Keywords)
def critical_velocity(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    tolerance: float | str | None = None,
    v50_shots: int | None = None,
    residual_shots: int | None = None,
    scan: bool | None = None,
    check: bool = False,
    **options: Unpack[ResumableSearchKeywords],
) -> LimitPlan:
    """Find the critical velocity (ballistic limit) of a ply or pack by bisection, and fit the
    residual velocities of its shots.

    A shot 2 to 8 % below the bracket and one above it, of the search or besides, show whether
    outcomes mix; only then the velocities about the bracket are scanned, unless `scan` is given. If
    a shot stops although a slower one perforates, no single critical velocity exists: the result is
    doubtful, and has the zone of mixed outcomes. A doubtful shot counts with its outcome, but a bracket or a mixed zone
    that ends with one is doubtful too (`bracket_checks`).

    Torn plies scatter: two shots of one pack that differ by 1e-6 part, as two tests do. The limit of a
    pack therefore is its V50 with a 95 % interval, from the residual velocities of eight shots 3 to
    15 % above a bracket of 5 % (`weavecell.studies.pack_limit`). Its outcomes may mix.

    The set-up of a fabric is one ply of 203 mm, clamped, and a flat cylinder of 3 g and 5.5 mm. A
    shot ends with its outcome, so these keys of an input file are ignored: title,
    projectile.strike_velocity, run.end_time, backing.after_stop, run.snapshot_interval,
    run.checkpoint_interval, run.outputs. [history] is rejected.

    The folder `out` then has report.html, critical-velocity.json, shots.csv, residual-velocity.svg,
    scene.toml, and runs/ with a file for each shot, from which `resume` goes on. If the search
    fails or is interrupted, it has the input and the shots so far.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or
        a set-up of `setup`
    tolerance : largest difference between highest stop and lowest perforation [m/s]; if not given 1
        m/s of one ply, about 5 % of a pack
    v50_shots : shots 3 to 15 % above the bracket, of whose residual velocities V50 is made; if not
        given 8 of a pack that is not scanned, 0 of one ply
    residual_shots : shots from 3 % above the limit to twice the limit, for the Lambert-Jonas fit; if
        not given 2, and 0 where there are `v50_shots`; 8 make its intervals narrow
    scan : scan the velocities about the bracket for mixed outcomes: always, or never; if not given
        where the shots of the search have some. A shot every 2 %, until all of 25 % above the highest
        stop perforate and all of 10 % below the lowest perforation stop
    check : run nothing and write nothing: forecast shots and CPU time
    **options : jobs, executor, out and resume; beside a fabric also keywords of `setup` but history

    Returns
    -------
    CriticalVelocityResult

    Raises
    ------
    InputError : as `setup`; or the panel stops the projectile at all velocities, or at none
    UndecidedError : a shot neither stopped nor perforated
    UnstableError : a shot became unstable; its attribute `shots` has the shots before

    Examples
    --------
    >>> limit = wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="100 mm")
    >>> round(limit.critical_velocity, -1), limit.bracket_checks  # [m/s]
    (90.0, 'ok')
    """
    from weavecell.studies import pack_limit, strengths
    from weavecell.studies.limit_scan import ScanRange

    width = None
    if tolerance is not None:
        width = quantities.read_positive(tolerance, "m/s", "tolerance")
    if residual_shots is not None:
        residual_shots = quantities.read_whole(residual_shots, "residual_shots", 0)
    if v50_shots is not None:
        v50_shots = quantities.read_whole(v50_shots, "v50_shots", 0)
    panel = resolve_target(target, options, "limit", function="critical_velocity")
    with panel.name_problems():
        strengths.require_failure(panel.setup, NO_LIMIT)
    if width is not None:
        _refuse_wide(width, tolerance, panel.setup)
    panel = panel.nominal()
    pack = panel.setup.plies > 1
    if v50_shots is None:
        v50_shots = pack_limit.SHOTS if pack and scan is not True else 0
    if residual_shots is None:
        residual_shots = 0 if v50_shots else 2
    # mixed outcomes are part of the scatter that the interval of V50 holds
    scanned = scan is not False and not (v50_shots and scan is None)
    if width is None and not pack:
        width = 1.0
    return LimitPlan(
        panel,
        width,
        v50_shots,
        residual_shots,
        ScanRange() if scanned else None,
        scan is None,
    )


def keep(ended: Sequence[Shot], problem: BaseException, panel: Target, folder: Path | None) -> None:
    """Write the shots of a search that an error or the user ended; the error has them too."""
    if not isinstance(problem, (WeavecellError, KeyboardInterrupt)):
        return
    shots = sorted(ended, key=lambda shot: shot.strike_velocity)
    if isinstance(problem, (UndecidedError, UnstableError)):
        problem.shots = tuple(shots)
    if folder is not None and (shots or not isinstance(problem, InputError)):
        kind = CriticalVelocityResult.kind
        table = one_table.frame(one_table.columns(shots, kind), kind)
        files.write(folder / "shots.csv", one_table.csv(table))
        panel.keep_input(folder)


def _refuse_wide(width, tolerance, setup):
    """Refuse a tolerance [m/s] as wide as the limit is likely to be high, below which no shot is fired."""
    from weavecell.studies.ballistic_limit import first_guess

    # with yarns that friction chooses the search begins pinned
    guess = first_guess(replace(setup, instead=None).target())
    if width >= guess:
        allowed = f"below {guess:.0f} m/s, where the search for this limit begins"
        raise InputError(key="tolerance", value=tolerance, allowed=allowed)
