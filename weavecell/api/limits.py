"""The critical velocity of a panel or pack: what was found, its files, and what is printed of it.

The folder of `weavecell critical-velocity`
    scene.toml               the input file; that of a fabric is the standard one, and can be run
                             again or changed
    inputs/                  copies of the files that the input file names
    critical-velocity.json   bracket, scan, zone of mixed outcomes if there is one, fit, shots,
                             provenance
    shots.csv                one row a shot, by strike velocity
    residual-velocity.svg    residual against strike velocity
    report.html              all of it on one page
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import (
    InputError,
    UndecidedError,
    UnstableError,
    WeavecellError,
)
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.study_result import StudyResult
from weavecell.answers.target import list_assumptions
from weavecell.api import keywords, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableSearchKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import LOOKS, StudySize
from weavecell.api.target import resolve_target
from weavecell.report import checks
from weavecell.report.pictures_style import BLUE, GREEN, ORANGE, RED
from weavecell.report.plot import Layer, Plot
from weavecell.results import one_table, out_folder
from weavecell.results.finding import Answer
from weavecell.results.left_out import SAMPLING, LeftOut, say_nominal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.indicator import Indicator
    from weavecell.answers.target import Target
    from weavecell.studies.ballistic_limit import Limit, Shot
    from weavecell.studies.lambert_jonas import LambertJonas
    from weavecell.studies.limit_scan import ScanRange
    from weavecell.studies.pack_limit import PackV50

LOOK_OF: dict[str, dict[str, Any]] = {
    "perforated": {"color": RED, "mec": "white"},
    "stopped": {"mfc": "white", "mec": GREEN, "mew": 1.8},
}
NO_LIMIT = "a panel whose yarns do not fail has no limit"
NAMES = (
    "critical-velocity.json",
    "shots.csv",
    "residual-velocity.svg",
    *out_folder.INPUT,
    "report.html",
)


@dataclass(frozen=True)
class LimitPlan(Plan["CriticalVelocityResult"]):
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
    scan_above: float | str | None = None,
    scan_below: float | str | None = None,
    scan_step: float | str | None = None,
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
        where the shots of the search have some
    scan_above : range above the highest stop that is scanned for further stops; if not given 25 %.
        This and the next two are refused where nothing is scanned
    scan_below : range below the lowest perforation that is scanned for others; if not given 10 %
    scan_step : interval between shots of the scan; if not given 2 %
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
    given = {"above": scan_above, "below": scan_below, "step": scan_step}
    shares = {key: value for key, value in given.items() if value is not None}
    numbers = {key: quantities.number(value, "", f"scan_{key}") for key, value in shares.items()}
    with keywords.name_as_keyword("scan", given):
        around: ScanRange | None = ScanRange(**numbers)
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
    if scan is False or (v50_shots and scan is None):
        around = None
        unused = {f"scan_{key}": value for key, value in shares.items()}
        quantities.refuse_unused(unused, f"without a scan, which {option('scan')} makes")
    if width is None and not pack:
        width = 1.0
    return LimitPlan(
        panel,
        width,
        v50_shots,
        residual_shots,
        around,
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


@explain_frozen
@dataclass(frozen=True, repr=False)
class CriticalVelocityResult(StudyResult):
    """The critical velocity of a panel (ballistic limit).

    Parameters
    ----------
    target : `weavecell.answers.target.Target` that was shot at
    limit : `weavecell.studies.ballistic_limit.Limit`
    lambert_jonas : fit to the perforations
    scan : ScanRange about the bracket that was scanned, or None
    wall_time : [s]

    Examples
    --------
    >>> limit = wc.critical_velocity("S-720", tolerance="20 m/s", scan=False, residual_shots=0, opening="100 mm")
    >>> low, high = limit.bracket
    >>> low < limit.critical_velocity < high
    True
    """

    kind = "critical_velocity"

    target: Target
    limit: Limit
    lambert_jonas: LambertJonas
    scan: ScanRange | None = None
    wall_time: float = 0.0

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name the laws that are assumed."""
        return list_assumptions(self.target.setup)

    @property
    def fabric(self) -> Fabric:
        """The Fabric of the first ply."""
        return self.target.setup.fabric

    @property
    def shots(self) -> tuple[Shot, ...]:
        """All shots, by strike velocity."""
        return tuple(sorted(self.limit.shots, key=lambda shot: shot.strike_velocity))

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As in `StudyResult`; and the scan, if there was none."""
        found = (*say_nominal(self.target.setup, "v50"), *super().left_out)
        if self.scan is not None or self.v50 is not None:
            return found
        text = f"few outcomes beside the bracket were computed; {option('scan')} looks for mixed ones about it"
        return (*found, LeftOut(SAMPLING, "mixed outcomes", text, "--scan"))

    @property
    def critical_velocity(self) -> float | None:
        """[m/s] V50 of a pack, if there is one; else the middle of the bracket, None if stops and
        perforations are mixed (see `mixed_zone`)."""
        if self.v50 is not None:
            return self.v50.velocity
        if not self.limit.single:
            return None
        return float(self.limit.velocity)

    @cached_property
    def v50(self) -> PackV50 | None:
        """V50 of a pack with its interval, if at least four shots near its limit perforate; None of
        one ply."""
        from weavecell.studies import pack_limit

        if self.target.setup.plies == 1:
            return None
        return pack_limit.of_shots(self.limit.shots)

    @property
    def bracket(self) -> tuple[float, float]:
        """[m/s] the stop and the perforation that enclose it."""
        return float(self.limit.low), float(self.limit.high)

    @property
    def mixed_zone(self) -> tuple[float, float] | None:
        """(lowest perforation, highest stop) [m/s] where the outcomes are mixed, or None."""
        return self.limit.mixed_zone

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Each quality check of the shot in which it is worst, and without a V50 the width of the
        zone of mixed outcomes."""
        from shellfabric.membrane import quality
        from weavecell.studies import limit_scan

        worst = quality.worst(shot.checks for shot in self.limit.shots)
        if self.v50 is not None:
            return tuple(worst)
        return (*worst, limit_scan.indicator(self.limit))

    @property
    def bracket_checks(self) -> str:
        """ "ok", or which end of the bracket, or of the zone of mixed outcomes, is a doubtful shot,
        and why."""
        return checks.judge_bracket(self.limit)

    @property
    def answer(self) -> Answer:
        """The limit over what its shots cover, and what moves it."""
        from weavecell.studies import unknown

        limit = self.limit
        value = f"{limit.velocity:.3g} m/s, between {limit.low:.3g} and {limit.high:.3g}"
        if limit.mixed_zone is not None:
            value = "no single limit, outcomes mix from {:.3g} to {:.3g} m/s".format(
                *limit.mixed_zone
            )
        if self.v50 is not None:
            value = self.v50.words()
        over = f"{counted(len(limit.shots), 'shot')}: {unknown.say_run(self.target.setup, self.target.is_placed)}"
        return self._find_answer(self._name_shot("ballistic limit"), value, over=over)

    def _what(self):
        return ": ".join((f"{self.target.title}, critical velocity", *self._doubt()))

    @property
    def doubts(self) -> tuple[str, ...]:
        """As in `Result`; and if the limit rests on a doubtful shot."""
        ends: tuple[str, ...] = ()
        if self.bracket_checks != checks.OK:
            ends = ("the limit rests on a doubtful shot",)
        return (*ends, *super().doubts)

    def _doubt(self):
        """A line if the limit is not sound."""
        if self.bracket_checks == checks.OK:
            return []
        return [f"the limit rests on a {self.bracket_checks}"]

    def summary(self) -> dict[str, Any]:
        """Return the entries of critical-velocity.json (docs/reference.md), but of the shots their
        number and the worst checks of all in words, and what is assumed."""
        return {"answer": self.answer.value} | super().summary() | {"checks": self.checks_text}

    def _items(self):
        return self.shots

    def draw(self, pyplot: Any) -> Figure:
        """Draw residual against strike velocity [m/s], the bracket and the Lambert-Jonas curve."""
        return plot_of(self).draw(pyplot)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        content = {
            "format": "weavecell critical velocity 4",
            **one_table.facts(self, self.kind),
            "shots": one_table.records(self.shots, self.kind),
        }
        content |= checks.summary(self.checks)
        return {
            "critical-velocity.json": content,
            "shots.csv": self.to_csv(),
            "residual-velocity.svg": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        limit = self.limit
        count = len(limit.shots)
        if limit.mixed_zone is None:
            lines = [
                f"{self.title}: critical velocity {limit.velocity:.1f} m/s",
                f"stops at {limit.low:.2f} m/s, perforates at {limit.high:.2f} m/s; {counted(count, 'shot')}",
            ]
        else:
            low, high = limit.mixed_zone
            inside = [s.perforated for s in limit.shots if low <= s.strike_velocity <= high]
            perforate = inside.count(True)
            stop = inside.count(False)
            mixed = f"mixed outcomes from {low:.1f} to {high:.1f} m/s"
            lines = [
                f"{self.title}: no single critical velocity, {mixed}",
                f"lowest perforation {low:.2f} m/s, highest stop {high:.2f} m/s; {counted(count, 'shot')}",
                f"{counted(len(inside), 'shot')} in this zone: {perforate} perforate, {stop} stop",
            ]
        if self.v50 is not None:
            lines[0] = f"{self.title}: {self.v50.words()}"
        elif self.target.setup.plies > 1:
            way = option("v50_shots", "8")
            scatter = "the bracket is no error: shots of a pack scatter by some 2 %"
            lines.append(f"{scatter}; {way} gives V50 with its interval")
        lines += self._doubt()
        fit = self.lambert_jonas
        rms = ""
        if not fit.reason:
            rms = f", rms {fit.residual_rms:.1f} m/s"
        lines.append(f"Lambert-Jonas: {fit.words()}{rms}")
        return lines


def plot_of(found: CriticalVelocityResult) -> Plot:
    """Return residual against strike velocity: shots, bracket or zone, and fitted curve."""
    limit = found.limit
    fit = found.lambert_jonas
    strikes = [shot.strike_velocity for shot in found.shots]
    high = 1.02 * max(strikes)
    low = 0.94 * min(*strikes, limit.low)
    layers = []
    if not fit.reason:
        words = "Lambert-Jonas\n" + fit.words("\n")
        x, y = fit.sample(high)
        layers.append(Layer(words, x.tolist(), y.tolist(), look={"color": BLUE}))
    for outcome, look in LOOK_OF.items():
        of = [shot for shot in found.shots if shot.outcome == outcome]
        struck = [shot.strike_velocity for shot in of]
        left = [shot.residual_velocity for shot in of]
        layers.append(Layer(outcome, struck, left, "o", {"ms": 7, "zorder": 3} | look))
    name = "bracket of the limit"
    zone = (limit.low, limit.high)
    alpha = 0.8
    if limit.mixed_zone is not None:
        name = "mixed outcomes"
        zone = limit.mixed_zone
        alpha = 0.25
    label = f"{name}\n{zone[0]:.1f} to {zone[1]:.1f} m/s"
    layers.append(Layer(label, zone, look={"color": ORANGE, "alpha": alpha, "lw": 1}))
    title = found.title
    return Plot(
        title,
        x="strike_velocity_m_s",
        y="residual_velocity_m_s",
        layers=tuple(layers),
        xlim=(low, high),
        ylim=(-0.02 * high, high),
        diagonal="no loss of velocity",
    )
