"""Friction between yarns that follows from measured pull-outs.

The folder of `weavecell reduce pull-out`
    pull-out.json        mu and c0 with intervals, scatter, provenance
    pull-outs.csv        every test with its peak and the computed one
    friction-keys.toml   what of it an input file takes
    pull-out.svg         measured and computed load against displacement; of peaks, against crossings
    report.html          all of it on one page
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.study_result import DrawnResult
from weavecell.report import installed
from weavecell.results import left_out
from weavecell.results.finding import Answer
from weavecell.results.left_out import LeftOut

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.scenes.build import Case
    from weavecell.studies.pull_out_tests import FittedFriction

KEYS = "friction-keys.toml"
NAMES = ("pull-out.json", "pull-outs.csv", KEYS, "pull-out.svg", "report.html")


@explain_frozen
@dataclass(frozen=True, repr=False)
class PullOutFriction(DrawnResult):
    """Friction between yarns from pull-outs; the table has a row a test.

    Parameters
    ----------
    case : `weavecell.scenes.build.Case` of the coupon
    friction : `weavecell.studies.pull_out_tests.FittedFriction`
    record : name of the file
    wall_time : [s] it took

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "10, 0.82\\n10, 0.95\\n20, 3.1\\n20, 3.4\\n"
    >>> _ = Path("peaks.csv").write_text("crossings, peak load [N]\\n" + rows)
    >>> found = wc.reduce_pull_out("S-728", "peaks.csv", tension="2 N")
    >>> len(found.to_dataframe()), found.doubtful
    (4, False)
    """

    kind = "pull_outs"

    case: Case
    friction: FittedFriction
    record: str
    wall_time: float = 0.0

    @property
    def fabric(self) -> Fabric:
        """Fabric whose yarns were drawn out."""
        return self.case.fabric

    @property
    def title(self) -> str:
        """Of picture and page."""
        return f"{self.fabric.name}, yarn pull-outs of {self.record}"

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the tests and of the fit."""
        return self.friction.doubts

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As in `Result`: what of the fabric the friction rests on."""
        rests = "crimp and compression law of the fabric, with which mu F_c is told"
        found = [LeftOut(left_out.DATA, "crimp and law of the fabric", rests)]
        if self.friction.is_flexible:
            text = "bending of the yarns, without which the load hardly grows with the tension"
            settle = f"give {option('bending', '')}, if it was measured"
            found.append(LeftOut(left_out.MODEL, "bending of the yarns", text, settle))
        return tuple(found)

    def summary(self) -> dict[str, Any]:
        """Return mu and c0 with standard errors and intervals, the scatter of the tests, and what is
        doubtful."""
        found = self.friction
        numbers = {
            "fabric": self.fabric.name,
            "record": self.record,
            "tests": len(found.tests),
            "confidence": self._confidence,
            "crossover_friction": found.mu,
            "crossover_friction_error": found.mu_error,
            "crossover_friction_interval": found.mu_interval and list(found.mu_interval),
            "crossover_cohesion_N": found.cohesion,
            "crossover_cohesion_interval_N": found.cohesion_interval
            and list(found.cohesion_interval),
            "repeat_scatter": found.scatter,
            "pairs": [list(pair) for pair in found.pairs],
        }
        return numbers | self._what_is_assumed()

    @property
    def _confidence(self):
        from weavecell.studies.pull_out_tests import CONFIDENCE

        return CONFIDENCE

    def _columns(self) -> Mapping[str, Any]:
        rows = []
        for group in self.friction.groups:
            computed = self.friction.computed(group.coupon)
            rows += [(test, computed) for test in group.tests]
        return {
            "test": [test.name for test, _ in rows],
            "pulled": [test.pulled for test, _ in rows],
            "crossings": [test.crossings for test, _ in rows],
            "tension_N": [test.tension for test, _ in rows],
            "peak_load_N": [test.peak for test, _ in rows],
            "computed_peak_load_N": [computed for _, computed in rows],
            "displacement_at_peak_m": [test.at_peak for test, _ in rows],
            "slack_m": [test.slack for test, _ in rows],
        }

    @property
    def answer(self) -> Answer:
        """The friction with its interval, and where to write it."""
        found = self.friction
        value = "friction between yarns is not told"
        advice = [
            "draw yarns through twice as many crossings too, five times each, for "
            "`weavecell reduce pull-out`"
        ]
        if found.mu is not None:
            value = f"friction between yarns {self._say_friction()}, c0 {self._say_cohesion()}"
            advice = [f"crossover_friction = {found.mu:.3g} in the input file ({KEYS})"]
        elif found.pairs:
            pairs = (f"mu {mu:.2g} with c0 {c0:.2g} N" for mu, c0 in found.pairs)
            value += f" by one length: {', or '.join(pairs)}"
        return self._find_answer(self.title, value, (), advice, over=self._say_tests())

    def _say_friction(self):
        found = self.friction
        text = f"{found.mu:.3f}"
        if found.mu_interval is None:
            return text
        low, high = found.mu_interval
        return f"{text} ± {high - found.mu:.3f} ({low:.3f} to {high:.3f}, {100 * self._confidence:.0f} %)"

    def _say_cohesion(self):
        found = self.friction
        text = f"{found.cohesion:.3g} N"
        if found.cohesion_interval is None:
            return text
        low, high = found.cohesion_interval
        return f"{text} ({low:.3g} to {high:.3g})"

    def _say_tests(self):
        """Say how many tests there are, and how they scatter."""
        found = self.friction
        numbers = dict.fromkeys(str(group.coupon.crossings) for group in found.groups)
        text = f"{counted(len(found.tests), 'test')} with {' and '.join(numbers)} crossings"
        if found.scatter is not None:
            text += f", scatter of repeats {100 * found.scatter:.2g} %"
        return text

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = [self.answer.line, self._say_tests()]
        for group in self.friction.groups:
            coupon = group.coupon
            computed = self.friction.computed(group.coupon)
            line = (
                f"{coupon.crossings} crossings, {coupon.pre_tension:g} N, {group.tests[0].pulled}: "
            )
            line += f"peak {group.mean:.3g} N in the mean of {counted(len(group.tests), 'test')}"
            if computed is not None:
                line += f", computed {computed:.3g} N"
            lines.append(line)
        return lines

    @property
    def keys(self) -> str:
        """The keys of an input file that follow."""
        found = self.friction
        lines = [f"# {self.title}, by `weavecell reduce pull-out`: {self._say_tests()}"]
        if found.mu is None:
            lines.append("# one length tells no friction; each of these pairs meets its peak")
            for mu, cohesion in found.pairs:
                lines.append(f"# crossover_friction = {mu:.3g} with c0 {cohesion:.3g} N")
            return "\n".join(lines) + "\n"
        spread = ""
        if found.mu_interval is not None:
            half = found.mu_interval[1] - found.mu
            spread = f'  # range of {100 * self._confidence:.0f} %: "{found.mu:.3f} ± {half:.3f}"'
        lines += [
            "[panel]",
            'crossovers = "yarns"',
            f"crossover_friction = {found.mu:.4g}{spread}",
            "",
            "# in [pull_out] of a coupon, beside the same crossover_friction:",
            f'# crossover_cohesion = "{found.cohesion:.4g} N"  # {self._say_cohesion()}',
        ]
        return "\n".join(lines) + "\n"

    def draw(self, pyplot: Any) -> Figure:
        """Draw load [N] against displacement [mm], measured and computed; of peaks, against the
        number of crossings."""
        from weavecell.report import pictures_records

        return pictures_records.draw_pull_outs(pyplot, self.friction, self.title)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds} that stands at the top of the module, but the page."""
        return {
            "pull-out.json": {"format": "weavecell pull-outs 1", **self.summary()},
            "pull-outs.csv": self.to_csv(),
            KEYS: self.keys,
            "pull-out.svg": None,
        }

    _written = NAMES

    def _write(self, folder):
        from weavecell.results import provenance

        stamp = provenance.stamp("", self.fabric)
        self._write_files(folder, stamp)
        if installed.can_draw():
            self._write_report(folder, stamp)

    def _write_report(self, folder, stamp):
        from weavecell.report import chapters, pictures
        from weavecell.report.page import Section, Table

        lead = (
            f"Yarns of {self.fabric.name} drawn through held crossovers, which slip at c0 + mu F_c."
        )
        table = Table.from_frame(self._labelled_columns())
        keys = ("Keys of an input file", self.keys)
        section = Section("tests", "Tests", "", (), (table,), tuple(self.lines()[2:]), (keys,))
        drawn = (pictures.draw_figure("result", "", self.draw),)
        seconds = {"fit": self.wall_time}
        answer = self.answer
        chapters.write(folder, lead, (self.fabric,), (section,), stamp, seconds, answer, (), drawn)
