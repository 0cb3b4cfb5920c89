"""V50: shots at panels whose yarns differ in strength.

The folder has, beside runs/ with a file for each run, report.html, v50.csv (curves), shots.csv,
v50.json, v50.png and scene.toml.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from math import inf, nan
from typing import TYPE_CHECKING, Any, Literal, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import UnstableError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize, shots_of_a_search
from weavecell.api.study_result import StudyResult
from weavecell.api.target import resolve_target
from weavecell.results import out_folder
from weavecell.results.left_out import brief_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
    from weavecell.api.target import Target
    from weavecell.studies.assumed_range import AssumedRange
    from weavecell.studies.inputs import Scatter
    from weavecell.studies.passing_shares import PassingShares
    from weavecell.studies.v50 import Study


NAMES = ("v50.json", "v50.csv", "shots.csv", "v50.png", *out_folder.INPUT, "report.html")


@dataclass(frozen=True)
class V50Plan(Plan["V50Result"]):
    """Shots at drawn panels that are about to be fired.

    Parameters
    ----------
    target : Target
    scatter : `weavecell.studies.inputs.Scatter`
    shots, batch, seed : number of shots, of those of a round, and of all random numbers
    over : what is changed for the range over what is assumed; None without one
    assumed_range : as it was asked for; False where nothing is assumed
    """

    files = NAMES

    target: Target
    scatter: Scatter
    shots: int
    batch: int
    seed: int
    over: ImpactSetup | None
    assumed_range: bool | str

    @property
    def inputs(self) -> Sequence[object]:
        """Set-up, scatter and seed: any number of its shots go on from the same ones."""
        from weavecell.studies import inputs

        fired_at = inputs.use_one_thread(self.target.setup, strike_velocity=1.0)
        return [(fired_at, self.scatter, self.seed)]

    def _count_range(self, over):
        """(searches, shots) of the range over what is assumed."""
        from weavecell.studies import assumed_range as ranges
        from weavecell.studies import v50 as analysis

        if over is None:
            return 0, 0
        repeats = 0
        if self.assumed_range is True:
            repeats = 2 * analysis.LARGEST + 2
        return ranges.searches(over), self.shots * repeats

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time."""
        from weavecell.studies import choice
        from weavecell.studies import v50 as analysis

        setup = self.target.setup
        searches, repeated = self._count_range(self.over)
        # where friction chooses, pinned yarns come first
        whole = analysis.as_fired(choice.with_pinned(setup))
        fired = self.shots + repeated
        words: dict[str, Any] = {"scene": self.target.scene, "drawn": True}
        size = StudySize.estimate(whole, self.target.title, fired, 1 + searches, repeated, **words)
        return size.with_choice(setup, self.shots, **words)

    def run(self, running: Running) -> V50Result:
        """Fire at the yarns that friction chooses, and search the range over what is assumed."""
        from weavecell.studies import v50 as analysis

        with running.count(f"{self.target.title}, repeated shots") as part:
            panel, over, chosen = self._choose_yarns(running)
            study = analysis.study(
                panel.setup,
                self.scatter,
                shots=self.shots,
                batch=self.batch,
                seed=self.seed,
                report=part(),
                **running.cache,
            )
            result = V50Result(study, panel, self.seed, self.batch, running.wall_time, chosen)
            running.save(result)
            if over is not None:
                self._say_cost_of_range(panel, over, running)
                ends = analysis.run_assumed_range(
                    over,
                    study,
                    again=self.assumed_range is True,
                    seed=self.seed,
                    report=part(),
                    **running.cache,
                )
                study = replace(study, assumed_range=ends)
                result = replace(result, study=study, wall_time=running.wall_time)
                running.save(result)
        if study.failures:
            left_out = f"{len(study.failures)} of {counted(self.shots, 'shot')} are left out of all estimates"
            running.failure = UnstableError(f"{left_out}: {study.failures[0]}", result=result)
        return result

    def _choose_yarns(self, running):
        """(Target, what is changed for the range, words on the choice) of pinned or resolved yarns."""
        from weavecell.studies import assumed_range as ranges
        from weavecell.studies import choice
        from weavecell.studies import v50 as analysis

        panel = self.target
        setup = panel.setup
        if setup.instead is None:
            return panel, self.over, ""
        found = analysis.choose_yarns(setup, **running.cache)
        fired_at = choice.with_pinned(setup)
        if found.resolved:
            fired_at = choice.with_resolved(setup)
            cost = StudySize.estimate(fired_at, panel.title, self.shots, 1).cost
            logging.getLogger("weavecell").info(f"{found}; {cost}")
        over = ranges.with_ends(fired_at, self.assumed_range)
        return replace(panel, setup=fired_at), over, str(found)

    def _say_cost_of_range(self, panel, over, running):
        searches, repeated = self._count_range(over)
        of_a_search = shots_of_a_search(panel.setup)
        share = (of_a_search * searches + repeated) / (of_a_search + self.shots)
        cost = f"{counted(searches, 'search')} and {counted(repeated, 'shot')}, about {share * running.wall_time:.2g} s"
        logging.getLogger("weavecell").info(f"range over what is assumed: at most {cost}")


@command(V50Plan)
@explain_keywords(ResumableKeywords, Keywords)
def v50(
    target: Fabric | FilePath | ImpactSetup | None,
    *,
    shots: int = 100,
    batch: int | None = None,
    assumed_range: bool | Literal["laws"] = False,
    check: bool = False,
    weibull_shape: float | None = None,
    modulus_cov: float | str | None = None,
    crimp_cov: float | str | None = None,
    seed: int = 1,
    **options: Unpack[StudyKeywords],
) -> V50Plan:
    """Find V0, V50 and V100 of a ply or pack whose yarns differ in strength, with intervals.

    Each shot hits a new panel, whose yarns have random strengths; it is always computed whole.
    Without scatter V50 is the critical velocity. Shots that become unstable, or neither stop nor
    perforate, are left out of all estimates. The set-up of a fabric is one ply of 203 mm, clamped,
    and a flat cylinder of 3 g and 5.5 mm. If no mesh is given, elements of one ply are a failure
    length long near the impact point and four crossovers far from it; a pack has the mesh of a
    shot. These keys of an input file are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; [history] and
    [accuracy] are rejected.

    The folder `out` then has report.html, v50.csv, v50.json, v50.png, shots.csv, scene.toml, and
    runs/ with a file for each shot. If yarns are resolved, shots.csv has the drawn impact points.

    Parameters
    ----------
    target : input file of a ply or pack, name of a fabric or its file; in Python also a Fabric, or
        a set-up of `setup`
    shots : number of shots, at least 4
    batch : shots of a round, at least 4; outcomes so far decide the velocities of the next round. If
        not given 10, or half of the shots, so that there are two rounds
    assumed_range : fire the shots again with both ends of the two assumptions that change the limit
        most, and with the two ends together that lower it, or raise it: six times as many shots,
        after two searches of the limit for each assumption. Without this option a command repeats
        only the searches, if a law or the crimp is assumed; "laws" does so in Python
    check : run nothing and write nothing: forecast shots and CPU time
    weibull_shape : Weibull shape of the yarns' strength, inf for yarns of one strength; this and the
        next two are those of weavecell/studies/inputs.toml if they are not given
    modulus_cov : coefficient of variation of the modulus from panel to panel
    crimp_cov : coefficient of variation of the crimp from panel to panel
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
    >>> curve = wc.v50("S-720", shots=8, batch=4, opening="100 mm", elements_per_crossover=1)
    >>> 85 < curve.v50 < 95  # [m/s]
    True
    """
    from weavecell.studies import assumed_range as ranges
    from weavecell.studies import choice, inputs, strengths
    from weavecell.studies import v50 as analysis

    if weibull_shape is not None and weibull_shape != inf:
        weibull_shape = quantities.read_positive(weibull_shape, "", "weibull_shape")
    own: dict[str, Any] = {"shape": weibull_shape}
    for key, value in (("modulus", modulus_cov), ("crimp", crimp_cov)):
        if value is None:
            own[key] = None
        else:
            own[key] = quantities.number(value, "", f"{key}_cov")
    scatter = replace(
        inputs.read_scatter(), **{key: value for key, value in own.items() if value is not None}
    )
    shots = quantities.read_whole(shots, "shots", analysis.LEAST)
    if batch is None:
        batch = analysis.usual_batch(shots)
    sizes = {
        "shots": shots,
        "batch": quantities.read_whole(batch, "batch", analysis.LEAST),
        "seed": quantities.read_whole(seed, "seed", 0),
    }
    panel = resolve_target(target, options, "v50", function="v50")
    with panel.name_problems():
        strengths.check(panel.setup, scatter)
    over = ranges.with_ends(panel.setup, assumed_range)
    if over is None:
        assumed_range = False
    if panel.setup.instead is not None:
        with panel.name_problems():
            # what resolved yarns do not have is refused first
            choice.with_resolved(panel.setup).target()
        over = None
    return V50Plan(panel, scatter, **sizes, over=over, assumed_range=assumed_range)


@explain_frozen
@dataclass(frozen=True, repr=False)
class V50Result(StudyResult):
    """The probability of perforation of panels or packs whose yarns differ in strength; the table
    has a row a shot.

    Parameters
    ----------
    study : `weavecell.studies.v50.Study`, with shots, fitted curves and the limit without scatter
    target : `weavecell.api.target.Target` that was shot at
    seed, batch : of the shots
    wall_time : [s]
    chosen : whether yarns are pinned or resolved, and why; "" where the input says it

    Examples
    --------
    >>> curve = wc.v50("S-720", shots=8, batch=4, opening="100 mm", elements_per_crossover=1)
    >>> curve.v50_low < curve.v50 < curve.v50_high
    True
    """

    kind = "v50"

    study: Study
    target: Target
    seed: int
    batch: int
    wall_time: float
    chosen: str = ""

    @property
    def v50(self) -> float:
        """[m/s] that half of the panels stop, of the probit; NaN where the shots do not determine
        it."""
        return float(self.study.curves["probit"].V50)

    @property
    def v50_low(self) -> float:
        """[m/s] of the interval of V50, at the level of the curve's confidence."""
        return float(self.study.curves["probit"].intervals["V50"][0])

    @property
    def v50_high(self) -> float:
        """[m/s] of the same interval."""
        return float(self.study.curves["probit"].intervals["V50"][1])

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots have which checks beyond their limits; and exchanged outcomes."""
        shots = self.study.shots
        counts = Counter(name for shot in shots for name in shot.doubtful)
        parts = [
            f"{name} in {count} of {counted(len(shots), 'shot')}"
            for name, count in counts.most_common()
        ]
        return (*parts, *filter(None, [self.study.six_shots.doubt]))

    @property
    def assumed_range(self) -> AssumedRange | None:
        """Of V50, or of the limit without scatter, over what is assumed."""
        return self.study.assumed_range

    def summary(self) -> dict[str, Any]:
        """Return V50 with its interval, the curve's standard deviation, the limit without scatter,
        and V50 of test series."""
        chosen = {"chosen": self.chosen} if self.chosen else {}
        return chosen | self._shares() | self.study.summary() | self._what_is_assumed()

    def _shares(self):
        """The entries of `passing_shares`; none without."""
        if self.passing_shares is None:
            return {}
        found = self.passing_shares.velocities
        return {f"passing_{100 * share:.0f}_percent_m_s": V for share, V in found.items()}

    def _items(self):
        return self.study.shots

    def _columns(self):
        columns = dict(super()._columns())
        if self.target.setup.crossovers is None:  # only those of resolved yarns are drawn
            del columns["impact_point_x_m"], columns["impact_point_y_m"]
        if not any(columns["widened"]):
            del columns["widened"]
        return columns

    @cached_property
    def passing_shares(self) -> PassingShares | None:
        """Velocities at which 1 in 10, half and 9 in 10 of the shots pass, where friction may not hold the
        yarns, so that the place decides; None of others, whose limits scatter about one V50."""
        from weavecell.studies import passing_shares

        shots = self.study.shots
        # limits of places lie about it, wherever a curve would put V50
        middle = 0.5 * sum(self.study.deterministic)
        if not shots or not passing_shares.may_slip(self.target.setup, middle):
            return None
        velocities = [shot.velocity for shot in shots]
        perforated = [shot.perforated for shot in shots]
        return passing_shares.PassingShares.of_shots(velocities, perforated)

    @property
    def headline(self) -> tuple[str, str]:
        around = self.assumed_range
        covered = brief_words(self.left_out, self.chosen)
        if self.passing_shares is not None:
            return "Passing", f"{self.passing_shares.words()} ({covered})"
        if self.study.curves["probit"].reason:
            return "V50", "not determined"
        curve = self.study.curves["probit"]
        sampled = f"{curve.span()} by the shots and a prior of their spread, 95 %"
        parts = [sampled, covered]
        if around is not None:
            span = f"{around.low:.1f} to {around.high:.1f} m/s"
            parts.insert(1, f"{around.quantity} over what is assumed: {span}")
        if self.target.setup.crossovers is not None:  # it rests on friction between yarns first
            parts.insert(0, parts.pop())
        return "V50", f"{self.v50:.1f} m/s ({'; '.join(filter(None, parts))})"

    @property
    def draws_strengths(self) -> bool:
        """As in `StudyResult`: it is what is studied."""
        return True

    @property
    def fired(self) -> ImpactSetup:
        """As in `StudyResult`: the whole panel, on the mesh of a V50."""
        from weavecell.studies import v50

        return v50.as_fired(super().fired)

    @property
    def title(self) -> str:
        return f"{self.target.title}: probability of perforation, {counted(len(self.study.shots), 'shot')}"

    def lines(self) -> list[str]:
        """Write the lines that are printed: shots, curves, the limit without scatter, assumptions."""
        from weavecell.studies import regression_line

        study = self.study
        scatter = self.study.scatter
        shots = self.study.shots
        perforations = [shot.velocity for shot in shots if shot.perforated]
        stops = [shot.velocity for shot in shots if not shot.perforated]
        low, high = study.deterministic
        remarks = [f"{' '.join(self.headline)}."]
        if self.chosen:
            remarks.append(f"{self.chosen[0].upper()}{self.chosen[1:]}.")
        if self.passing_shares is None:
            remarks += [f"{curve.words()}." for curve in study.curves.values()]
        else:
            remarks.append(
                "Friction may not hold the yarns, and the limit differs from place to place: no V50 with a spread, but "
                "shares of shots anywhere in a cell of the weave, at any roll, as fine as the steps between the shots."
            )
        remarks.append(f"{study.six_shots.words()}.")
        if len(shots) + len(study.failures) <= self.batch:
            remarks.append(
                "All shots are of one round, placed about the limit without scatter before any outcome was "
                "known: V50 is near that limit whatever it is; take a smaller batch, or more shots."
            )
        if study.assumed_range is not None:
            remarks.append(f"Over what is assumed: {study.assumed_range.words()}.")
        fastest = max(stops, default=nan)
        slowest = min(perforations, default=nan)
        remarks += [
            f"Without scatter the limit is between {low:.1f} and {high:.1f} m/s.",
            f"{counted(len(shots), 'shot')} in rounds of {self.batch}, {len(perforations)} perforated, seed "
            f"{self.seed}; slowest perforation {slowest:.1f} m/s, fastest stop {fastest:.1f} m/s; largest energy error "
            f"{100 * study.summary()['energy_error_max']:.2g} %.",
            f"Weibull shape {scatter.shape:g} at {1e3 * scatter.gauge_length:g} mm; standard deviation of the modulus "
            f"{100 * scatter.modulus:g} %, of either crimp {100 * scatter.crimp:g} %, from panel to panel.",
        ]
        if self.passing_shares is None:
            remarks.append("V0 and V100 are where 1 % and 99 % perforate.")
        if self.passing_shares is None and not study.curves["probit"].reason:
            remarks.append(study.series.words())
            remarks += regression_line.remarks(self.target.setup, self.v50)
        remarks += [f"Without an outcome: {failure}." for failure in study.failures]
        if study.widened:
            remarks.append(f"{study.widened}.")
        if study.doubtful:
            counts = Counter(name for shot in shots for name in shot.doubtful)
            names = ", ".join(f"{name} in {count}" for name, count in counts.most_common())
            remarks.append(
                f"{study.doubtful} of {counted(len(shots), 'shot')} are doubtful; checks beyond their limits: {names}."
            )
        remarks.append(f"Residual velocities, Lambert-Jonas: {study.lambert_jonas.words()}.")
        if (zones := self._zones()) is not None:
            sides = ", ".join(f"{side:g} up to {until:g}" for until, side in zones)
            remarks.append(
                f"Sides of the elements in crossovers, by the distance from the impact point: {sides}."
            )
        if zones != self.target.setup.grading:
            remarks.append(
                "This is the mesh of a V50, on which the limit is 2 to 5 % higher than on the mesh of a "
                "single shot or of critical-velocity: compare the two on one mesh (grading)."
            )
        return remarks + self.notes

    def _zones(self):
        from weavecell.studies import v50

        return v50.grade_mesh(self.target.setup).grading

    def table(self) -> DataFrame:
        """Return V0, V50, V100 and standard deviation of each fitted curve, with their
        intervals."""
        from pandas import DataFrame

        rows = []
        for link, curve in self.study.curves.items():
            for name in ("V0", "V50", "V100"):
                rows.append((link, name, getattr(curve, name), *curve.intervals[name]))
            scale = 1.0
            if curve.s:
                scale = curve.deviation / curve.s
            rows.append(
                (
                    link,
                    "standard deviation",
                    curve.deviation,
                    *(scale * s for s in curve.intervals["s"]),
                )
            )
        return DataFrame(
            rows,
            columns=["curve", "quantity", "value [m/s]", "low, 95 % [m/s]", "high, 95 % [m/s]"],
        )

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        from weavecell.studies import inputs

        study = self.study
        curves = {}
        for link, curve in study.curves.items():
            curves[link] = asdict(curve) | {"V0": curve.V0, "V100": curve.V100}
        given = []
        for name, entry in (inputs.table("weibull") | inputs.table("spread")).items():
            numbers = {"name": name, "value": entry.value}
            given.append(numbers | {"source": entry.source, "status": entry.status})
        content = {
            **self._shares(),
            **study.summary(),
            "plies": self.target.setup.plies,
            "projectile": self.target.projectile,
            "deterministic": study.deterministic,
            "series": asdict(study.series),
            "lambert_jonas": asdict(study.lambert_jonas),
            "six_shots": asdict(study.six_shots),
            "failures": study.failures,
            "assumed_range": study.assumed_range and study.assumed_range.summary(),
            "scatter": asdict(study.scatter),
            "grading": self._zones(),
            "curves": curves,
            "inputs": given,
            "wall_time": self.wall_time,
        }
        if self.chosen:
            content["chosen"] = self.chosen
        return {
            "v50.json": content,
            "v50.csv": self.table().to_csv(index=False, float_format="%.6g"),
            "shots.csv": self.to_csv(),
            "v50.png": None,
        }

    def draw(self, pyplot: Any) -> Figure:
        """Draw probability of perforation and residual velocity against strike velocity [m/s]."""
        from weavecell.report import pictures_uncertainty

        return pictures_uncertainty.perforation(pyplot, self.study, self.title)
