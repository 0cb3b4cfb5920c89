"""What a sweep came to: a table of its rows, or its shots.

The folder of `weavecell sweep`
    scene.toml      the input file
    inputs/         copies of the files that the input file names
    sweep.csv       a row for each combination
    sweep.json      the same, and provenance
    sweep.png       the quantity against the first key
    report.html     all of it on one page
    runs/           a file for each finished run, from which `--resume` goes on
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import entries, unit_of
from weavecell.answers.result import Result, figure, plain
from weavecell.answers.shot import ShotResult
from weavecell.answers.study_result import StudyResult
from weavecell.answers.target import Target
from weavecell.results import display, out_folder
from weavecell.results.finding import Answer
from weavecell.results.keys import find_axis
from weavecell.results.left_out import LeftOut, say_nominal
from weavecell.scenes import impact as scenes
from weavecell.scenes.varied_setup import read_key

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.indicator import Indicator

# what a notebook shows of each shot
_SHOWN = (
    "fabric",
    "strike_velocity_m_s",
    "outcome",
    "residual_velocity_m_s",
    "max_deflection_m",
    "cut_yarns",
    "checks",
)


NAMES = ("sweep.json", "sweep.csv", "sweep.png", *out_folder.INPUT, "report.html")


def with_unit(key: str, value: Any) -> Any:
    """Return a value in SI units as a file has it."""
    unit = unit_of(entries(scenes.Scene).get(key)) or "1"
    if isinstance(value, list):
        return [with_unit(key, part) for part in value]
    if unit == "1" or isinstance(value, bool) or not isinstance(value, (int, float)):
        return value
    return f"{value!r} {unit}"


def say_changes(changes: Mapping[str, Any]) -> str:
    """Say what a row changes."""
    said = (f"{say_key(key)} {with_unit(key, value)}" for key, value in changes.items())
    return ", ".join(said)


def say_key(key: str) -> str:
    """Say a key of an input file, such as "panel opening"; a key without a table is a factor."""
    words = key.replace(".", " ").replace("_", " ")
    if "." not in key:
        words = f"factor on {words}"
    # it is the only one that has a velocity
    return words.replace("projectile strike velocity", "strike velocity")


@explain_frozen
@dataclass(frozen=True, repr=False)
class SweepTable(StudyResult):
    """An input file over values of its keys.

    Parameters
    ----------
    quantity : "shot", "critical-velocity" or "v50"
    keys : of the input file
    rows : {key or name of a result: value} of each combination
    targets : the Target of each

    Examples
    --------
    >>> table = wc.sweep("S-720", over=["run.end_time=5 us,10 us", "projectile.strike_velocity=150 m/s"])
    >>> len(table.to_dataframe())
    2
    """

    kind = "sweep"

    quantity: str
    keys: tuple[str, ...]
    rows: tuple[dict[str, Any], ...]
    targets: tuple[Target, ...]

    @property
    def target(self) -> Target:  # type: ignore[override]
        """The first."""
        return self.targets[0]

    @property
    def draws_strengths(self) -> bool:
        """As in `StudyResult`: a V50 draws them."""
        return self.quantity == "v50"

    @property
    def fired(self) -> ImpactSetup:
        """As in `StudyResult`, of the first row."""
        from weavecell.runs import table

        if self.quantity == "shot":
            return self.target.setup
        if self.draws_strengths:
            return table.as_fired(super().fired)
        return super().fired

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As in `StudyResult`; and what each row takes of all that nobody gave."""
        if self.quantity == "v50":
            return super().left_out
        return (*say_nominal(self.target.setup, "v50"), *super().left_out)

    @property
    def _drawn(self):
        """The `Quantity` of its columns."""
        from weavecell.runs.sweep import QUANTITIES

        return QUANTITIES[self.quantity]

    def summary(self) -> dict[str, Any]:
        """Count the rows of each outcome."""
        return dict(Counter(row["outcome"] for row in self.rows)) | self._what_is_doubtful()

    def _columns(self):
        from pandas import DataFrame

        return DataFrame(self.rows)

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many rows are doubtful."""
        count = sum(str(row.get("checks", "")).startswith("doubtful") for row in self.rows)
        if not count:
            return ()
        return (f"{count} of {counted(len(self.rows), 'row')}",)

    @property
    def answer(self) -> Answer:
        """The lowest and the highest of the rows."""
        quantity = self._drawn
        label = find_axis(quantity.column).words
        found = [
            (row[quantity.column], self._changes(row).replace("panel ", ""))
            for row in self.rows
            if row.get(quantity.column) is not None
        ]
        outcomes = Counter(row["outcome"] for row in self.rows)
        value = ended = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
        if any(one for one, _ in found):
            (low, least), (high, most) = min(found), max(found)
            value = f"{label} {low:.3g} m/s ({least}) to {high:.3g} m/s ({most})"
        over = f"{counted(len(self.rows), 'row')} over {self._varied_words}: {ended}"
        return self._find_answer(self.title, value, over=over)

    @property
    def title(self) -> str:
        quantity = self.quantity.replace("-", " ")
        return f"{self.target.setup.name}, {quantity} over {self._varied_words}"

    @property
    def _varied_words(self):
        """The keys that vary, in words."""
        return ", ".join(map(say_key, self._varied))

    @property
    def _varied(self):
        """The keys with more than one value; the first key if none has."""
        varied = [key for key in self.keys if len({str(row[key]) for row in self.rows}) > 1]
        return varied or self.keys[:1]

    def draw(self, pyplot: Any) -> Figure:
        """Draw the quantity against the first key that varies."""
        from weavecell.report import pictures_uncertainty

        quantity = self._drawn
        x, label = self._abscissa()
        return pictures_uncertainty.sweep(
            pyplot, x, label, self.to_dataframe(), self._varied[1:], quantity
        )

    def _changes(self, row):
        """The keys that a row changes, of those that vary, in words."""
        return say_changes({key: row[key] for key in self._varied})

    def _abscissa(self):
        """(values, label) of the first key that varies: numbers with their unit, areal densities for numbers of
        plies, or texts."""
        key = self._varied[0]
        if key == "panel.plies":
            return [row["areal_density_kg_m2"] for row in self.rows], "areal density [kg/m²]"
        # a key without a table is a factor
        if "." not in key:
            return [row[key] for row in self.rows], say_key(key)
        values = []
        for panel in self.targets:
            if panel.case is None:
                values.append(read_key(panel.setup, key))
                continue
            value = panel.case.scene
            for part in key.split("."):
                value = getattr(value, part)
            values.append(value)
        words = say_key(key)
        # a text, a table or a truth value has no place on an axis
        if not {*map(type, values)} <= {int, float}:
            return [str(row[key]) for row in self.rows], words
        unit = unit_of(entries(scenes.Scene)[key]) or "1"
        _, factor = display.choose_unit(unit)
        return [factor * value for value in values], display.heading(words, unit)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        content: dict[str, Any] = {"quantity": self.quantity, "rows": self.rows}
        return {
            "sweep.json": content,
            "sweep.csv": self.to_csv(),
            "sweep.png": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        from weavecell.runs.sweep import INTERVAL, MIXED, QUANTITIES

        quantity = QUANTITIES[self.quantity]
        lines = []
        for row in self.rows:
            value = row.get(quantity.column)
            if value is None:
                words = row["outcome"]
            else:
                words = f"{value:.1f} m/s, {row['outcome']}"
            if row["outcome"] in (INTERVAL, MIXED):
                words += f" from {row['lower_m_s']:.1f} to {row['upper_m_s']:.1f} m/s"
            doubt = ""
            if row.get("checks", "").startswith("doubtful"):
                doubt = f", {row['checks']}"
            lines.append(f"{self._changes(row)}: {words}{doubt}")
        return lines


@explain_frozen
@dataclass(frozen=True, repr=False)
class SweepResult(Result, Sequence):
    """Results of several shots, in their order; an unstable one has the outcome "unstable".

    Parameters
    ----------
    shots : tuple of ShotResult

    Examples
    --------
    >>> shots = wc.sweep([wc.setup("S-720", 150, opening="20 mm", end_time="10 us")])
    >>> len(shots), shots[0].outcome
    (1, 'in flight')
    """

    shots: tuple[ShotResult, ...]

    def __len__(self) -> int:
        return len(self.shots)

    def __getitem__(self, index: Any) -> Any:
        return self.shots[index]

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Each quality check of the shot in which it is worst, without unstable shots."""
        from shellfabric.membrane import quality

        return quality.worst(shot.checks for shot in self.shots if shot.outcome != "unstable")

    def _what(self):
        strikes = []
        for shot in self.shots:
            if shot.doubtful and shot.outcome != "unstable":
                strikes.append(f"{shot.strike_velocity:g} m/s")
        return (
            f"sweep of {counted(len(self.shots), 'shot')}, doubtful at {', '.join(strikes)}; worst"
        )

    def summary(self) -> dict[str, Any]:
        """Count the shots of each outcome and the doubtful ones, and give the worst checks in
        words."""
        outcomes: list[str] = [shot.outcome for shot in self.shots]
        return {
            "shots": len(self.shots),
            **{name: outcomes.count(name) for name in dict.fromkeys(outcomes)},
            "doubtful": sum(shot.doubtful for shot in self.shots),
            "checks": self.checks_text,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        counts = ", ".join(
            f"{value} {name}"
            for name, value in self.summary().items()
            if name not in ("shots", "checks")
        )
        return [f"{counted(len(self.shots), 'shot')}: {counts}"]

    def _columns(self):
        from pandas import DataFrame

        return DataFrame(
            {key: value for key, value in shot.summary().items() if plain(value)}
            for shot in self.shots
        )

    def _notebook_table(self):
        return self._labelled_columns(*_SHOWN)

    def plot(self) -> Figure:
        """Draw a matplotlib figure: residual against strike velocity [m/s], a line an outcome."""
        from weavecell.report import pictures_uncertainty
        from weavecell.runs.sweep import QUANTITIES

        strikes = [shot.strike_velocity for shot in self.shots]
        label = find_axis("strike_velocity_m_s").label
        drawn = strikes, label, self.to_dataframe(), ["outcome"], QUANTITIES["shot"]
        return figure(pictures_uncertainty.sweep, *drawn)
