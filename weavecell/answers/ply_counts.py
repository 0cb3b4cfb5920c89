"""The plies of each fabric that stop a threat.

The folder has, beside runs/ with a file for each run, report.html, plies.json, plies.csv (a row a fabric),
shots.csv, shares.csv (the picture), plies.svg and scene.toml.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property
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
    from weavecell.report.page import Section
    from weavecell.runs.measurement import Count, Measurement
    from weavecell.runs.plies import PliesOfFabric

NAMES = (
    "plies.json",
    "plies.csv",
    "shots.csv",
    "shares.csv",
    "plies.svg",
    *out_folder.INPUT,
    "report.html",
)


@dataclass(frozen=True)
class FabricRow:
    """A row of the table: a fabric, its plies and what they weigh.

    Parameters
    ----------
    fabric : its name
    plies, plies_low, plies_high : with what tests say of the model; None where all outcomes are alike
    model, model_low, model_high : by the model alone
    areal_density, thickness : [kg/m2], [m] of these plies
    v50, low, high : [m/s] of that pack, as tests say
    margin : [-] of this V50 over the velocity that is stopped, less 1
    group : number among groups by areal density, the lightest 1; fabrics of one are not decided
    """

    fabric: str
    plies: int | None
    plies_low: int | None
    plies_high: int | None
    model: int | None
    model_low: int | None
    model_high: int | None
    areal_density: float
    thickness: float
    v50: float
    low: float
    high: float
    margin: float
    group: int


@explain_frozen
@dataclass(frozen=True, repr=False)
class PliesResult(DrawnStudy):
    """The fewest plies of each fabric that stop a threat; the table has a row a fabric.

    Parameters
    ----------
    found : tuple of `weavecell.runs.plies.PliesOfFabric`, of each fabric
    targets : tuple of Target, each with the plies that were found
    stop : the threat in words
    seed : of the shots
    wall_time : [s]

    Examples
    --------
    >>> found = wc.plies("S-728", stop="FSP 1.10 g", at="120 m/s", shots=4, opening="50 mm")
    >>> found.by_model["S-728"].plies <= found.counts["S-728"].plies
    True
    """

    kind = "ply_counts"

    found: tuple[PliesOfFabric, ...]
    targets: tuple[Target, ...]
    stop: str
    seed: int
    wall_time: float

    @property
    def target(self) -> Target:  # type: ignore[override]
        """The first."""
        return self.targets[0]

    @property
    def names(self) -> list[str]:
        """Names of the fabrics."""
        return [target.setup.fabric.name for target in self.targets]

    @property
    def title(self) -> str:
        return f"plies that stop {self.stop} at {self.velocity:g} m/s in {100 * self.sure:g} % of shots"

    @property
    def velocity(self) -> float:
        """[m/s] that is stopped."""
        return self.found[0].velocity

    @property
    def sure(self) -> float:
        """Probability of a stop that was asked for."""
        return self.found[0].sure

    @property
    def counts(self) -> dict[str, Count]:
        """{fabric: (plies, low, high)} with what tests say of the model; without those that are not determined."""
        return {name: one.by_tests for name, one in self._known.items()}

    @property
    def by_model(self) -> dict[str, Count]:
        """{fabric: (plies, low, high)} by the model alone."""
        return {name: one.by_model for name, one in self._known.items()}

    @property
    def _known(self):
        of_each = dict(zip(self.names, self.found))
        return {name: one for name, one in of_each.items() if one.posterior is not None}

    @property
    def groups(self) -> list[list[str]]:
        """Fabrics by areal density, the lightest first; the order within a group is not decided. An error of the
        model that two fabrics share cancels."""
        from weavecell.runs.plies import group, real_counts

        masses = {}
        for name, one in self._known.items():
            real = real_counts(one.posterior, one.reference, one.velocity, one.sure)
            masses[name] = real * self._weave(name).areal_density
        return group(masses)

    def _weave(self, name):
        return self.targets[self.names.index(name)].setup.fabric.weave

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots have which checks beyond their limits; and an order that pinned yarns do not decide."""
        from weavecell.runs.passing import count_doubts
        from weavecell.studies import choice

        counts = [
            f"{name}: {doubt}"
            for name, one in zip(self.names, self.found)
            for doubt in count_doubts(one.shots, one.failures)
        ]
        order = choice.doubt_order([target.setup for target in self.targets])
        return (*counts, *(order if len(self.found) > 1 else ()))

    @property
    def answer(self) -> Answer:
        """The plies of each fabric, and what to measure first."""
        from weavecell.runs import v50
        from weavecell.studies import unknown

        ranked = [name for group in self.groups for name in group]
        lost = [name for name in self.names if name not in ranked]
        shots = [shot for one in self.found for shot in one.shots]
        passed = sum(shot.perforated for shot in shots)
        parts = [f"{counted(len(shots), 'drawn shot')}, {passed} pass"]
        alike = [f"{name} not determined: all outcomes are alike" for name in lost]
        if not ranked:
            return self._find_answer(self.title, "; ".join(alike), over=parts[0])
        shown = ranked[:2]
        others = [f"{len(ranked) - 2} more"] if len(ranked) > 2 else []
        value = ", ".join([f"{name} {self.counts[name].words()}" for name in shown] + others)
        model = ", ".join(self.by_model[name].words() for name in shown)
        rows = {row.fabric: row for row in self._items()}
        weights = " and ".join(f"{rows[name].areal_density:.3g}" for name in shown)
        parts.append(f"{weights} kg/m²")
        if len(ranked) > 1:
            first = self.groups[0]
            decided = f"{first[0]} is lightest" if len(first) == 1 else "lightest not decided"
            parts[-1] += f", {decided}"
        least = self._known[ranked[0]]
        # the least plies are those of the first; a test of its V50 has no mover beside which it stands
        advice = tuple(one.advice for one in least.measure(ranked[0])[:2] if one.is_worth)
        movers = [
            Mover(name, unknown.ADVICE.get(name, ""), width, len(least.shots) >= v50.MANY)
            for name, width in least.moved.items()
        ]
        said = "; ".join([f"plies: {value}; by the model alone {model}", *alike])
        return self._find_answer(self.title, said, movers, advice, over="; ".join(parts))

    @cached_property
    def measurements(self) -> tuple[Measurement, ...]:
        """As in `DrawnStudy`, of the plies of each fabric."""
        from weavecell.runs.measurement import rank

        return rank(part for name, one in self._known.items() for part in one.measure(name))

    def summary(self) -> dict[str, Any]:
        """Return what was asked for, and the plies of each fabric."""
        content: dict[str, Any] = {
            "velocity_m_s": self.velocity,
            "sure": self.sure,
            "shots": sum(len(one.shots) for one in self.found),
            "plies": {name: list(count) for name, count in self.counts.items()},
            "plies_by_model": {name: list(count) for name, count in self.by_model.items()},
        }
        return content | self._what_is_assumed()

    def _items(self):
        numbers = {name: k for k, group in enumerate(self.groups, 1) for name in group}
        return [
            self._row(name, one, numbers.get(name, 0)) for name, one in zip(self.names, self.found)
        ]

    def _row(self, name, one, number):
        if one.posterior is None:
            return FabricRow(name, *(None,) * 6, *(nan,) * 6, number)
        plies, weave = one.by_tests.plies, self._weave(name)
        v50 = one.v50(plies)
        masses = plies * weave.areal_density, plies * weave.thickness
        margin = v50.value / one.velocity - 1
        return FabricRow(name, *one.by_tests, *one.by_model, *masses, *v50, margin, number)

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        lines = [f"{self.answer.value}."]
        for row, one in zip(self._items(), self.found):
            if one.posterior is None:
                lines.append(
                    f"{row.fabric}: not determined, {counted(len(one.shots), 'shot')} end alike."
                )
                continue
            tests = "".join(
                f"; tested {counted(t.plies, 'ply')}: {t.velocity:g} m/s" for t in one.tests
            )
            lines.append(
                f"{row.fabric}: plies {one.by_tests.words()}, {row.areal_density:.3g} kg/m², "
                f"{1e3 * row.thickness:.2g} mm; V50 {row.v50:.3g} m/s ({row.low:.3g} to {row.high:.3g}), "
                f"{100 * row.margin:+.0f} %; by the model alone {one.by_model.words()}{tests}."
            )
        error = self.found[0].error
        for name, rows in (("V50", error.factor), ("exponent of plies", error.growth)):
            lines.append(
                f"Computed less measured, {name}: {rows.mean:+.2g} ± {rows.deviation:.2g}, {rows.size} scored rows."
            )
        tied = [" and ".join(group) for group in self.groups if len(group) > 1]
        lines += [f"Not decided by areal density: {words}." for words in tied]
        lines += [
            f"Without an outcome: {failure}." for one in self.found for failure in one.failures
        ]
        return lines + self.notes

    def _own_chapters(self) -> list[Section]:
        """What to measure first, by fabric."""
        from weavecell.report.page import Section, Table

        columns = "plies of", "measured", "to", "plies then", "by", "read by"
        rows = []
        for one in self.measurements:
            row = one.answer.removeprefix("plies of "), one.quantity, one.known_words
            rows.append((*row, one.words(one.then), one.test, one.reader))
        return [Section("first", "What to measure first", tables=(Table(columns, tuple(rows)),))]

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        content = {**self.summary(), "stop": self.stop, "wall_time": self.wall_time}
        content |= self._what_to_measure() | {"groups": self.groups}
        content["model_error"] = asdict(self.found[0].error)
        return {
            "plies.json": content,
            "plies.csv": self.to_csv(),
            "shots.csv": self.shots.to_csv(index=False),
            "shares.csv": self.shares.to_csv(index=False),
            "plies.svg": None,
        }

    @cached_property
    def shares(self) -> DataFrame:
        """The table of the picture: the share that stops by fabric and plies."""
        from pandas import DataFrame, concat

        tables = [DataFrame({"fabric": name, **one.shares()}) for name, one in self._known.items()]
        return concat(tables, ignore_index=True) if tables else DataFrame({"fabric": []})

    @property
    def shots(self) -> Any:
        """The table of the shots, a row each, with fabric and plies."""
        from pandas import concat

        from weavecell.results import one_table
        from weavecell.runs.table import list_drawn

        tables = []
        for name, one in zip(self.names, self.found):
            columns = dict(one_table.columns(one.shots, "v50")) | list_drawn(one.shots)
            table = one_table.frame(columns, "v50")
            table.insert(0, "plies", one.counts)
            table.insert(0, "fabric", name)
            tables.append(table)
        return concat(tables, ignore_index=True)

    def draw(self, pyplot: Any) -> Figure:
        """Draw the share that stops against the number of plies, a panel a fabric."""
        from weavecell.report import pictures_uncertainty

        return pictures_uncertainty.plies(pyplot, self.shares, self.to_dataframe(), self.sure)
