"""The difference of two panels, with its interval and verdict.

The folder of `weavecell compare`
    difference.json      difference with its interval, verdict, masses, provenance
    difference.csv       a row for A, for B and for their difference
    difference.svg       the picture
    report.html          all of it on one page
    a/, b/               what `weavecell v50` writes of each
    runs/                a file for each finished run, from which --resume goes on
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fabrics.base import run_cache
from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from weavecell.answers.study_result import DrawnResult
from weavecell.answers.target import list_assumptions
from weavecell.answers.v50 import V50Result
from weavecell.report import installed
from weavecell.results.finding import Answer
from weavecell.results.left_out import LeftOut, lines_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from weavecell.answers.target import Target
    from weavecell.runs.difference import Difference

NAMES = ("difference.json", "difference.csv", "difference.svg", "report.html", "a/*", "b/*")
# [-] by which areal densities differ at most that V50 alone compares
ALIKE = 0.03
# fields of a set-up that a comparison is about
COMPARED = (
    *("fabric", "laws", "surface", "lay_up", "plies", "stacking", "ply_gap", "ply_friction"),
    *("bending", "cell_model", "packed_area", "contact", "grading", "elements_per_crossover"),
    *("strike_velocity", "table_size"),
)


class ComparedPanel(NamedTuple):
    """A row of the table: a panel, or A less B.

    Parameters
    ----------
    panel : what it is called
    v50, low, high : [m/s] with its interval
    areal_density : [kg/m2]
    specific_energy : [J m2/kg]
    """

    panel: str
    v50: float
    low: float
    high: float
    areal_density: float
    specific_energy: float


@explain_frozen
@dataclass(frozen=True, repr=False)
class ComparisonResult(DrawnResult):
    """Two panels or packs, A and B; the table has a row for each and one for A less B.

    Parameters
    ----------
    a, b : V50Result of each

    Examples
    --------
    >>> found = wc.compare("S-720", "S-728", shots=8, opening="30 mm", projectile="sphere 5.5 mm")
    >>> low, high = found.interval  # [m/s] of A less B
    >>> low < found.difference.value < high
    True
    """

    kind = "difference"

    a: V50Result
    b: V50Result

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        return self.a.target, self.b.target

    @property
    def names(self) -> tuple[str, str]:
        """What A and B are called: what is shot at, or the stem of the file where that is the
        same."""
        titles = [panel.title for panel in self.targets]
        if titles[0] == titles[1]:
            titles = [Path(panel.name).stem or panel.title for panel in self.targets]
        return f"A, {titles[0]}", f"B, {titles[1]}"

    @property
    def title(self) -> str:
        """Of picture and page."""
        return " or ".join(self.names)

    @property
    def areal_densities(self) -> tuple[float, float]:
        """[kg/m2] of A and of B, all plies."""
        a, b = (panel.setup.areal_density for panel in self.targets)
        return float(a), float(b)

    @property
    def other_differences(self) -> list[str]:
        """Names of what else differs between A and B, such as the opening: then the fabrics alone are
        not compared."""
        a, b = (panel.setup for panel in self.targets)
        named = [field.name for field in fields(a) if field.name not in COMPARED]
        return [
            name
            for name in named
            if run_cache.inputs_digest(getattr(a, name))
            != run_cache.inputs_digest(getattr(b, name))
        ]

    @property
    def heavier(self) -> float:
        """Areal density of A over that of B, less 1."""
        a, b = self.areal_densities
        return a / b - 1

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name what is assumed of the fabrics."""
        lines = [line for panel in self.targets for line in list_assumptions(panel.setup)]
        return tuple(dict.fromkeys(lines))

    def table(self) -> DataFrame:
        """Return the table with labels and units."""
        return self._labelled_columns()

    def _notebook_table(self):
        return self.table()

    @property
    def values(self) -> tuple[float, float]:
        """[m/s] V50 of A and of B."""
        return self.a.v50, self.b.v50

    @cached_property
    def difference(self) -> Difference:
        """V50 of A less that of B, with its interval."""
        from weavecell.runs.difference import Difference, subtract

        fewest = min(len(one.study.shots) for one in (self.a, self.b))
        middles = []
        for name, one in zip("AB", (self.a, self.b)):
            if one.study.posterior is None:
                return Difference.missing(fewest, f"all shots at {name} end alike")
            middles.append(one.study.posterior.middles)
        return Difference(subtract(*middles), fewest)

    @cached_property
    def difference_by_mass(self) -> Difference:
        """Energy of the projectile at V50 over areal density [J m2/kg], of A less that of B."""
        from weavecell.runs.difference import Difference, subtract

        by_velocity = self.difference
        if by_velocity.reason:
            return by_velocity
        energies = []
        for panel, one, density in zip(self.targets, (self.a, self.b), self.areal_densities):
            assert one.study.posterior is not None
            mass = panel.setup.projectile.mass
            energies.append(0.5 * mass * one.study.posterior.middles**2 / density)
        return Difference(subtract(*energies), by_velocity.shots)

    @property
    def interval(self) -> tuple[float, float]:
        """[m/s] (low, high) of the difference."""
        return self.difference.span.low, self.difference.span.high

    @property
    def verdict(self) -> str:
        """ "better" if A is better than B over the whole interval, "worse", or "not decided"."""
        return self.difference.verdict

    @property
    def shots_to_decide(self) -> int | None:
        """Number of shots at each after which the difference as it is would be decided; None if
        shots would not decide, or it is decided."""
        return self.difference.shots_to_decide()

    @property
    def specific_energies(self) -> tuple[float, float]:
        """[J m2/kg] energy of the projectile at V50 or limit over areal density, of A and of B."""
        a, b = (
            float(0.5 * panel.setup.projectile.mass * value**2 / density)
            for panel, value, density in zip(self.targets, self.values, self.areal_densities)
        )
        return a, b

    @property
    def checks(self) -> tuple:
        """As in `Result`, of both."""
        return (*self.a.checks, *self.b.checks)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of A and of B, and of their order."""
        from weavecell.studies import choice

        parts = [f"{x}: {doubt}" for x, one in zip("AB", (self.a, self.b)) for doubt in one.doubts]
        parts += choice.doubt_order([panel.setup for panel in self.targets])
        return tuple(parts)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What the numbers leave out, of A and of B."""
        return tuple(dict.fromkeys((*self.a.left_out, *self.b.left_out)))

    @property
    def answer(self) -> Answer:
        """Which is better, per areal density first where the two differ in it, and by how much."""
        from weavecell.runs.difference import UNDECIDED

        difference = self.difference
        subject = f"{', or '.join(self.names)}: which is better?"
        if difference.reason:
            return self._find_answer(subject, f"not decided: {difference.reason}")
        low, high = self.interval
        by = f"V50 of A less B {difference.value:+.3g} m/s ({low:+.3g} to {high:+.3g})"
        value = f"{_say_verdict(self.verdict)}: {by}"
        a, b = self.specific_energies
        count = counted(difference.shots, "drawn shot")
        each = f"{self.a.v50:.3g} and {self.b.v50:.3g} m/s, {a:.3g} and {b:.3g} J per kg/m²"
        over = f"{count} at each: {each}"
        if abs(self.heavier) > ALIKE:
            by_mass = self.difference_by_mass.verdict
            value = f"per areal density {_say_verdict(by_mass)}; as a whole {value}"
            more = "more" if self.heavier > 0 else "less"
            over += f"; A has {100 * abs(self.heavier):.0f} % {more} mass"
        advice = (self._what_decides(),) if self.verdict == UNDECIDED else ()
        return self._find_answer(subject, value, advice=advice, over=over)

    def _what_decides(self):
        """What would decide, in words."""
        from weavecell.runs.difference import MOST_SHOTS

        needed = self.shots_to_decide
        if needed is None:
            return f"`weavecell compare --shots {MOST_SHOTS}` would not decide it either"
        return f"`weavecell compare --shots {needed}` decides, if the difference stays"

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        difference = self.difference
        lines = [self.answer.line]
        for label, result, density, energy in zip(
            self.names, (self.a, self.b), self.areal_densities, self.specific_energies
        ):
            span = f"({result.v50_low:.1f} to {result.v50_high:.1f})"
            lines.append(
                f"{label}: V50 {result.v50:.1f} m/s {span}, {1e3 * density:.0f} g/m², "
                f"{energy:.1f} J per kg/m²"
            )
        lines.append(f"mass of A: {100 * self.heavier:+.1f} % against B")
        if not difference.reason:
            low, high = self.interval
            lines.append(
                f"difference by {counted(difference.shots, 'shot')} at each: {low:+.1f} to "
                f"{high:+.1f} m/s with {100 * difference.confidence:g} % confidence"
            )
        if self.other_differences:
            lines.append(f"A and B also differ in: {', '.join(self.other_differences)}")
        failures = (*self.a.study.failures, *self.b.study.failures)
        return lines + [f"Without an outcome: {failure}." for failure in failures]

    def _items(self):
        difference = self.difference
        spans = [(one.v50_low, one.v50_high) for one in (self.a, self.b)] + [self.interval]
        less = [one[0] - one[1] for one in (self.areal_densities, self.specific_energies)]
        return [
            ComparedPanel(name, value, *span, density, energy)
            for name, value, span, density, energy in zip(
                (*self.names, "A less B"),
                (*self.values, difference.value),
                spans,
                (*self.areal_densities, less[0]),
                (*self.specific_energies, less[1]),
            )
        ]

    def draw(self, pyplot: Any) -> Figure:
        """Draw V50 of A and B with their shots, and the difference below."""
        from weavecell.report import pictures_comparison

        return pictures_comparison.difference(pyplot, self)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `DrawnResult` does."""
        content = {"format": "weavecell difference 2", **self.summary()}
        return {
            "difference.json": content,
            "difference.csv": self.to_csv(),
            "difference.svg": None,
        }

    _written = NAMES

    def _write(self, folder):
        from weavecell.results import provenance

        a, b = self.targets
        text = "\n".join(f"# {panel.name}\n{panel.text}" for panel in (a, b) if panel.text)
        stamp = provenance.stamp(text, *a.setup.fabrics, setup=b.setup)
        for name, result in (("a", self.a), ("b", self.b)):
            (folder / name).mkdir(exist_ok=True)
            result.save(folder / name)
        self._write_files(folder, stamp)
        if installed.can_draw():
            self._write_report(folder, stamp)

    def _write_report(self, out, stamp):
        """Write the page that has both."""
        from weavecell.report import chapters, page, pictures

        picture = pictures.draw_figure("difference", "", self.draw)
        table = page.Table.from_frame(self.table())
        lines = (
            *self.lines(),
            *lines_of(self.left_out),
            "The pages of the two are a/report.html and b/report.html.",
        )
        sections = [
            page.Section("result", "A and B", tables=(table,)),
            page.Section("remarks", "Remarks", points=lines, folded=True),
        ]
        shots = [chapters.describe_shot(panel.setup, panel.scene) for panel in self.targets]
        lead = " ".join(f"{side}: {shot}" for side, shot in zip("AB", shots))
        fabrics = {f.name: f for panel in self.targets for f in panel.setup.fabrics}
        seconds = {"both studies": self.b.wall_time}
        content = (lead, [*fabrics.values()], sections, stamp, seconds, self.answer, (), (picture,))
        chapters.write(out, *content)


def _say_verdict(verdict):
    """Say better or worse, in words."""
    return verdict if verdict == "not decided" else f"A is {verdict}"
