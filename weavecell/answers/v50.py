"""The V50 of drawn panels, with its shots.

The folder has, beside runs/ with a file for each run, report.html, v50.csv (curves), shots.csv,
v50.json, v50.png and scene.toml.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from math import nan
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from weavecell.answers.study_result import DrawnStudy
from weavecell.results import out_folder
from weavecell.results.finding import Answer, Mover

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from weavecell.answers.target import Target
    from weavecell.runs.measurement import Measurement
    from weavecell.runs.span import Span
    from weavecell.runs.v50 import Study


NAMES = (
    "v50.json",
    "v50.csv",
    "shots.csv",
    "shots.h5",
    "v50.png",
    *out_folder.INPUT,
    "report.html",
)


@explain_frozen
@dataclass(frozen=True, repr=False)
class V50Result(DrawnStudy):
    """The probability of perforation over all that is drawn; the table has a row a shot.

    Parameters
    ----------
    study : `weavecell.runs.v50.Study`, with shots and the answer that they tell
    target : `weavecell.answers.target.Target` that was shot at
    seed, batch : of the shots
    wall_time : [s]

    Examples
    --------
    >>> found = wc.v50("S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> found.velocities["V10"].value < found.v50
    True
    """

    kind = "v50"

    study: Study
    target: Target
    seed: int
    batch: int
    wall_time: float

    @property
    def velocities(self) -> dict[str, Span]:
        """{"V10", "V50", "V90": (value, low, high) [m/s]} that 1 in 10, half and 9 in 10 shots pass, with
        intervals of 90 %; empty where all outcomes are alike."""
        if self.study.posterior is None:
            return {}
        return self.study.posterior.velocities

    @property
    def v50(self) -> float:
        """[m/s] that half of the shots pass; NaN where all outcomes are alike."""
        return self._v50.value

    @property
    def v50_low(self) -> float:
        """[m/s] of its interval of 90 %."""
        return self._v50.low

    @property
    def v50_high(self) -> float:
        """[m/s] of the same interval."""
        return self._v50.high

    @property
    def _v50(self):
        from weavecell.runs.span import Span

        return self.velocities.get("V50", Span(nan, nan, nan))

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

    def summary(self) -> dict[str, Any]:
        """Return V10, V50 and V90 with their intervals, and what decides."""
        return self.study.summary() | self._what_is_assumed()

    @property
    def shots(self) -> DataFrame:
        """The table of the shots, a row each: what was drawn and what came of it."""
        return self.to_dataframe()

    def _items(self):
        return self.study.shots

    def _columns(self):
        from weavecell.runs.table import list_drawn

        columns = dict(super()._columns()) | list_drawn(self.study.shots)
        if self.target.setup.crossovers is None:  # only those of resolved yarns are drawn
            del columns["impact_point_x_m"], columns["impact_point_y_m"]
        return columns

    @property
    def answer(self) -> Answer:
        """The velocities that half, 1 in 10 and 9 in 10 shots pass, and what moves them."""
        from weavecell.runs import v50
        from weavecell.studies import unknown

        found, shots = self.study.posterior, self.study.shots
        passed = sum(shot.perforated for shot in shots)
        over = f"{counted(len(shots), 'drawn shot')}, {passed} pass: {unknown.say_drawn(self.target.setup)}"
        subject = self._name_shot("V50")
        if found is None:
            return self._find_answer(subject, "not determined: all outcomes are alike", over=over)
        sure = len(shots) >= v50.MANY
        # the first is told with what it leaves
        first = {one.quantity: one.advice for one in self.measurements[:1] if one.is_worth}
        settles = {name: unknown.ADVICE.get(name, "") for name in found.widths} | first
        moved = [Mover(name, settles[name], width, sure) for name, width in found.widths.items()]
        return self._find_answer(subject, found.words(), moved, tuple(first.values()), over=over)

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """As in `DrawnStudy`, of the V50 of a cloth."""
        return self.study.measurements

    @property
    def title(self) -> str:
        return f"{self.target.title}, probability of perforation"

    def lines(self) -> list[str]:
        """Write the lines that are printed: shots, curves, the limit without scatter, assumptions."""
        study = self.study
        scatter = study.scatter
        shots = study.shots
        perforations = [shot.velocity for shot in shots if shot.perforated]
        stops = [shot.velocity for shot in shots if not shot.perforated]
        remarks = [f"{self.answer.value}."]
        if study.posterior is not None:
            shares = [
                f"{name} {100 * share.value:.0f} % ({100 * share.low:.0f} to {100 * share.high:.0f})"
                for name, share in study.posterior.shares.items()
            ]
            remarks.append(
                f"Shares of the spread, which few shots rank at best: {', '.join(shares)}."
            )
        remarks.append(f"{study.six_shots.words()}.")
        fastest = max(stops, default=nan)
        slowest = min(perforations, default=nan)
        shape = scatter.shape
        if shape is None:
            shape = self.target.setup.fabric.weibull_shape
        remarks += [
            f"{counted(len(shots), 'shot')} in rounds of {self.batch}, {len(perforations)} perforated, seed "
            f"{self.seed}; slowest perforation {slowest:.1f} m/s, fastest stop {fastest:.1f} m/s; largest energy error "
            f"{100 * study.summary()['energy_error_max']:.2g} %.",
            f"Weibull shape {shape:g}; standard deviation of the modulus "
            f"{100 * scatter.modulus:g} %, of either crimp {100 * scatter.crimp:g} %, from panel to panel.",
        ]
        remarks += [f"Without an outcome: {failure}." for failure in study.failures]
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
        from weavecell.runs import table

        return table.grade_mesh(self.target.setup).grading

    def table(self) -> DataFrame:
        """Return V10, V50 and V90 with their intervals."""
        from pandas import DataFrame

        rows = [(name, *span) for name, span in self.velocities.items()]
        return DataFrame(
            rows, columns=["quantity", "value [m/s]", "low, 90 % [m/s]", "high, 90 % [m/s]"]
        )

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        from weavecell.studies import inputs
        from weavecell.studies.unknown import FRICTIONS

        study = self.study
        given = []
        of_yarns = self.target.setup.fabric.sources
        for name in ("gauge_length", "weibull_shape"):
            given.append({"name": name, **of_yarns[name]})
        for name, entry in inputs.table("spread").items():
            numbers = {"name": name, "value": entry.value}
            given.append(numbers | {"source": entry.source, "status": entry.status})
        content = {
            **study.summary(),
            **self._what_to_measure(),
            "unknown": {FRICTIONS[name].words: ends for name, ends in study.unknown.items()},
            "plies": self.target.setup.plies,
            "projectile": self.target.projectile,
            "lambert_jonas": asdict(study.lambert_jonas),
            "six_shots": asdict(study.six_shots),
            "failures": study.failures,
            "scatter": asdict(study.scatter),
            "grading": self._zones(),
            "inputs": given,
            "wall_time": self.wall_time,
        }
        return {
            "v50.json": content,
            "v50.csv": self.table().to_csv(index=False, float_format="%.6g"),
            "shots.csv": self.to_csv(),
            "shots.h5": self.shots,
            "v50.png": None,
        }

    def draw(self, pyplot: Any) -> Figure:
        """Draw probability of perforation and residual velocity against strike velocity [m/s]."""
        from weavecell.report import pictures_uncertainty

        return pictures_uncertainty.perforation(pyplot, self.study)
