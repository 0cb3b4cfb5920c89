"""Friction between yarns from the pull-outs of a laboratory.

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
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, plausible
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.files import parse_toml
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import validated
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from weavecell.answers.study_result import DrawnResult
from weavecell.api import coupons, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize
from weavecell.report import installed
from weavecell.results import left_out, out_folder
from weavecell.results.finding import Answer
from weavecell.results.left_out import LeftOut
from weavecell.scenes.panel import PanelTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.scenes.build import Case
    from weavecell.studies.pull_out_tests import FittedFriction, PullOutTest

KEYS = "friction-keys.toml"
NAMES = ("pull-out.json", "pull-outs.csv", KEYS, "pull-out.svg", "report.html")
# c0 of a coupon of which only the fabric and its cell are read
NO_MATTER = {"displacement": "1 mm", "crossover_cohesion": "1 N"}


@dataclass(frozen=True)
class PullOutPlan(Plan["PullOutFriction"]):
    """Pull-outs that are about to be reduced.

    Parameters
    ----------
    case : Case of the coupon, with fabric, law and cell
    tests : that were read
    record : name of their file
    """

    files = NAMES

    case: Case
    tests: tuple[PullOutTest, ...]
    record: str

    def forecast(self) -> WorkSize:
        """Count the tests, and the pull-outs that are computed for them."""
        groups = {test.group for test in self.tests}
        title = f"{self.case.fabric.name}, pull-outs of {self.record}"
        return WorkSize(title, {"test": len(self.tests), "computed peak": len(groups)})

    def run(self, running: Running) -> PullOutFriction:
        """Fit friction and c0."""
        from shellfabric.coupon.pull_out import PullOut
        from weavecell.studies import pull_out_tests as studies

        bending = self.case.scene.fabric.bending
        families = dict.fromkeys(test.pulled for test in self.tests)
        made = {
            pulled: PullOut(coupons.table_of(self.case, pulled), mu=0.0, bending=2 * (bending,))
            for pulled in families
        }
        low, high = assumed.friction_between_yarns(self.case.fabric).number.span
        usual = (low, 0.5 * (low + high), high)
        found = studies.reduce(self.tests, made, usual)
        result = PullOutFriction(self.case, found, self.record, running.wall_time)
        result.check_keys()
        return running.save(result)


@command(PullOutPlan)
def reduce_pull_out(
    fabric: Fabric | FilePath,
    record: FilePath,
    *,
    more: list[str] | None = None,
    crossings: int | None = None,
    tension: float | str | None = None,
    pulled: str | None = None,
    bending: float | str | None = None,
    law: FilePath | CompressionLaw | None = None,
    check: bool = False,
    out: FilePath | None = None,
) -> PullOutPlan:
    """Reduce yarn pull-outs of a laboratory to the friction between yarns, mu, and c0, with
    intervals.

    RECORD has the columns "displacement [mm]" and "force [N]", one test below the other, or "peak
    load [N]" with a row a test. Further columns, or options, say how many "crossings" the yarn was
    drawn through, or which "length [mm]", and, where they are known, "test", "pulled" (warp or
    weft), and "tension [N]" of each crossing yarn, or the "transverse load [N]" of all of them. Slack
    of the machine at the start does not matter.

    A crossover slips at c0 + mu F_c. Two numbers of crossings with some repeats tell both; one tells
    mu only if c0 is known. The fabric gives the contact force F_c by its crimp and its law.

    The folder then holds report.html, pull-out.json, pull-outs.csv, pull-out.svg, and
    friction-keys.toml for an input file.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    record : records or peaks (``*.csv``)
    more : further record, CROSSINGS=FILE, such as 20=twenty.csv; may be given again, in Python a list
    crossings : that the yarn of the first file is drawn through, if no column says it
    tension : of each crossing yarn, if no column says it [N], such as "2 N"
    pulled : "warp" or "weft", if no column says it; if not given warp
    bending : bending stiffness of a yarn [N m2], with which the load depends on the tension; if not
        given 0
    law : compression law of `weavecell calibrate` (law.json), in place of the fabric's; in Python
        also a CompressionLaw
    check : compute nothing and write nothing: count the tests
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    PullOutFriction

    Raises
    ------
    InputError : a wrong record, no number of crossings, a yarn that would break, or peaks that no
        friction explains

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = "10, 0.82\\n10, 0.95\\n20, 3.1\\n20, 3.4\\n"
    >>> _ = Path("peaks.csv").write_text("crossings, peak load [N]\\n" + rows)
    >>> found = wc.reduce_pull_out("S-728", "peaks.csv", tension="2 N")
    >>> round(found.friction.mu, 2)
    0.13
    """
    from weavecell.studies import pull_out_tests as studies

    given = {"bending": bending, "law": law}
    keys = {key: value for key, value in given.items() if value is not None}
    case = coupons.case_of(fabric, "pull_out", NO_MATTER | keys)
    weave = case.fabric.weave
    spacing = {"warp": 2 * weave.w1, "weft": 2 * weave.w2}
    usual: dict[str, Any] = {"pulled": None, "tension": None}
    if pulled is not None:
        family = studies.YARNS.get(str(pulled).lower())
        if family is None:
            raise InputError(key="pulled", value=pulled, allowed="warp or weft")
        usual["pulled"] = family
    if tension is not None:
        usual["tension"] = quantities.number(tension, "N", "tension")
        if not usual["tension"] >= 0:
            raise InputError(key="tension", value=tension, allowed="at least 0")
    count = None
    if crossings is not None:
        count = quantities.read_whole(crossings, "crossings", 1)
    tests = studies.read(record, spacing, crossings=count, **usual)
    for text in more or ():
        number, file = quantities.numbered_file("more", text, "crossings", least=1)
        tests += studies.read(file, spacing, crossings=number, **usual)
    return PullOutPlan(case, tuple(tests), Path(record).name)


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

    def check_keys(self) -> None:
        """Refuse a friction that the key of an input file does not allow."""
        mu = self.friction.mu
        if mu is None:
            return
        written = parse_toml(self.keys)["panel"]
        validated(PanelTable, {"opening": "100 mm", **written}, None)
        number = plausible.Number("panel.crossover_friction", "friction", mu)
        quantities.note([number])

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

    @out_folder.saving(*NAMES)
    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.results import provenance

        folder = Path(out)
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
