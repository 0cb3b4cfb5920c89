"""The critical velocity of a panel or pack, with its shots.

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

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.study_result import StudyResult
from weavecell.answers.target import list_assumptions
from weavecell.report import checks
from weavecell.report.pictures_style import BLUE, GREEN, ORANGE, RED
from weavecell.report.plot import Layer, Plot
from weavecell.results import one_table, out_folder
from weavecell.results.finding import Answer
from weavecell.results.left_out import SAMPLING, LeftOut, say_nominal

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
NAMES = (
    "critical-velocity.json",
    "shots.csv",
    "residual-velocity.svg",
    *out_folder.INPUT,
    "report.html",
)


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
