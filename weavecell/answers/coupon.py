"""What a quasi-static test on a piece of fabric, or a yarn pull-out, came to.

The folder of `weavecell coupon`
    scene.toml      the input file as it was given
    inputs/         copies of the files that the input file names
    histories.h5    measures, nodes and shear after every step, tensions at the end (`results.coupon`)
    coupon.csv      the measures as a table, one row a step or, of a pull-out, a sample of the load
    summary.json    outcome, measures at the end, provenance
    pictures/       coupon.png, and curves (.svg)
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted, for --resume; of no pull-out
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import installed, pictures_coupon
from weavecell.results import coupon as coupon_results
from weavecell.results import display, keys, out_folder
from weavecell.results.finding import Answer, join_parts
from weavecell.scenes.build import Case

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.membrane.indicator import Indicator

NAMES = (
    *out_folder.INPUT,
    "histories.h5",
    "summary.json",
    "coupon.csv",
    "pictures/*",
    "report.html",
)


@explain_frozen
@dataclass(frozen=True, repr=False)
class CouponResult(WrittenResult):
    """A quasi-static test on a piece of fabric.

    Parameters
    ----------
    record : `fabrics.base.record.Record`, a row a load step: what is prescribed, then what is
        measured
    solved : `shellfabric.coupon.solver.Result`
    case : `weavecell.scenes.build.Case` of the test
    checks : quality checks
    text : of the input file, "" if there is none

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> [round(float(angle), 3) for angle in frame.record["shear angle"]]  # [rad]
    [0.044, 0.087]
    """

    kind = "coupon"

    record: Record
    solved: Any
    case: Case
    checks: tuple[Indicator, ...] = ()
    text: str = ""

    @property
    def outcome(self) -> str:
        """ "complete", "yarn at its strength" or "unstable"."""
        return self.record.facts["outcome"]

    @property
    def fabric(self) -> Fabric:
        """Fabric of the coupon."""
        return self.case.fabric

    def summary(self) -> dict[str, Any]:
        """Return the outcome, the checks in words, and every quantity at the end with its unit."""
        last = {name: float(values[-1]) for name, values in self._columns().items()}
        return self.record.facts | {"checks": self.checks_text} | last | self._what_is_assumed()

    def _what(self):
        return self.record.facts["title"]

    def _columns(self):
        record = self.record
        units = {name: f"_{record.unit(name)}".removesuffix("_1") for name in record.columns}
        columns = {}
        for name, values in record.columns.items():
            columns[name.replace(" ", "_") + units[name]] = values
        return columns

    def to_dataframe(self) -> DataFrame:
        """Return the table of `Result`; its attrs name what is assumed."""
        table = super().to_dataframe()
        table.attrs.update(self._what_is_assumed())
        return table

    @property
    def answer(self) -> Answer:
        """How it ended, and what the test came to at its end."""
        measures = [f"{name} {text}" for name, text in self._list_measures().items()]
        value = join_parts([self.outcome, *measures], ", ")
        outcome = "unstable" if self.outcome == "unstable" else "stopped"
        over = ", ".join(self._list_assumed_laws())
        return self._find_answer(self.record.facts["title"], value, outcome=outcome, over=over)

    def _list_measures(self):
        """{what was prescribed or measured: text with its unit} at the end."""
        measures = self._collect_measures().items()
        return {name: display.text(values[-1], unit) for name, (unit, values) in measures}

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        return [f"{self.record.facts['title']}: {self.outcome}", *self.list_found()]

    def list_found(self) -> list[str]:
        """Write what the test came to, a line each."""
        facts = self.record.facts
        measures = self._list_measures().items()
        lines = [f"{name:<34}{text}{self._flag(name)}" for name, text in measures]
        lines += self._list_unloaded()
        share = facts["yarn_stiffness_share"]
        if share < 1:
            work = 100 * facts["softened_work_share"]
            lines.append(
                f"yarns computed with {share:.2g} of their stiffness, which takes {work:.2g} % of the work"
            )
        lines += self._list_assumed_laws()
        lines.append(
            f"{counted(facts['elements'], 'element')}, {counted(facts['iterations'], 'iteration')}, "
            f"residual {facts['residual_max']:.1e} at most, {facts['wall_time_s']:.1f} s"
        )
        return lines

    def _list_unloaded(self):
        """The line that says in which load steps the yarns are slack; none where in none."""
        slack = self.solved.unloaded
        if not slack.any():
            return []
        steps = ", ".join(map(str, 1 + np.flatnonzero(slack)))
        return [
            f"unloaded in {slack.sum()} of {counted(slack.size, 'load step')} ({steps}): the yarns are "
            "slack, and what is measured there is noise"
        ]

    def _flag(self, name):
        """What stands beside a number that was computed."""
        prescribed = name == self.record.facts.get("prescribed_name")
        if prescribed or not self._list_assumed_laws():
            return ""
        return " (assumed law)"

    def _lead(self):
        facts = self.record.facts
        elements = f"{counted(facts['elements'], 'element')}, "
        tested = self.case.scene.say_test(facts["fabric"], facts["steps"], elements)
        return f"{tested} {'. '.join(self._list_assumed_laws())}"

    def table(self) -> DataFrame:
        """Return all load steps, in the units of the report, with residual (out-of-balance force
        over the reaction), and "unloaded" where the yarns are slack."""
        states = self.solved.states
        return display.frame(self._collect_measures()).assign(
            residual=[f"{state.residual:.1e}" for state in states],
            iterations=[state.iterations for state in states],
            state=np.where(self.solved.unloaded, "unloaded", ""),
        )

    def _notebook_table(self):
        return self.table()

    def _collect_measures(self):
        """{column: (unit, values)} of what is measured."""
        columns = self.record.columns
        return {
            name: (keys.COUPON_MEASURES[name].unit, values)
            for name, values in columns.items()
            if name != coupon_results.UNLOADED
        }

    def figures(self) -> dict[str, tuple[str, Callable, tuple]]:
        """Return {file: (caption, function that draws it, its arguments beside pyplot)}."""
        record = self.record
        tolerance = self.case.scene.run.tolerance
        figures: dict[str, tuple[str, Callable, tuple]] = {
            "coupon": (
                "The coupon at the end, to scale. Left: shear of the elements. Right: tension of the yarns.",
                pictures_coupon.sheared_coupon,
                (record, self.solved),
            )
        }
        for name, beginnings, label, caption in pictures_coupon.CURVES[record.facts["test"]]:
            drawn = [measure for measure in record.columns if measure.startswith(beginnings)]
            if self.solved.unloaded.any():
                caption += " Hollow points: unloaded, the yarns are slack and the values noise."
            figures[name] = caption, pictures_coupon.curves, (record, drawn, label)
        caption = (
            "Dynamic relaxation: out-of-balance force on the free nodes over the reaction; "
            "lines end the load steps."
        )
        return figures | {
            "relaxation": (caption, pictures_coupon.relaxation, (self.solved, tolerance))
        }

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the quantities of the test in the unit of the first, against
        what is prescribed."""
        record = self.record
        first, *others = list(record.columns)[1:]
        names = [first, *(name for name in others if record.unit(name) == record.unit(first))]
        return figure(pictures_coupon.curves, record, names, first)

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the fabric after every load step for ParaView: coupon.pvd with coupon-NNNN.vtu;
        returns its path."""
        from weavecell.results import vtk

        folder = Path(folder)
        times = {}
        with out_folder.hold(folder, ("coupon.pvd", "coupon-*.vtu")):
            for step, state in enumerate(self.solved.states):
                nodes = np.column_stack([state.x, np.zeros(len(state.x))])
                name = f"coupon-{step:04d}.vtu"
                fabric = vtk.grid(nodes, self.solved.coupon.quads)
                fabric.cell_data["shear_angle_rad"] = self.solved.shear(step)
                vtk.write_grid(folder / name, fabric)
                times[name] = float(step + 1)
            vtk.write_series(folder / "coupon.pvd", times)
        return folder / "coupon.pvd"

    def _write_record(self, out):
        """Write histories.h5; the further entries of summary.json."""
        record = self.record
        coupon_results.write(out / "histories.h5", record, self.solved)
        last = {}
        for name, values in record.columns.items():
            row = {"value": values[-1], "unit": record.unit(name)}
            last[name] = row | self._what_is_assumed()
        return {"at_end": last}

    _written = NAMES

    def _write(self, folder):
        from weavecell.report import checks, page
        from weavecell.results import input_copies, json_file, provenance

        stamp = provenance.stamp(self.text, self.case.fabric)
        # paths of a coupon are those that were read
        input_copies.keep_input(folder, self.text, self.case.scene, Path())
        files.write(folder / "coupon.csv", self.to_csv())
        content = self.record.facts | self._write_record(folder) | checks.summary(self.checks)
        content |= self._what_is_assumed() | self._answered() | {"provenance": stamp}
        json_file.write_summary(folder / "summary.json", content)
        outputs = self.case.scene.run.outputs
        if not outputs or not installed.can_draw():
            return
        section = self._section()
        if "pictures" in outputs:
            page.write_pictures([section], folder / "pictures")
        if "report" in outputs:
            self._write_report(folder, section, stamp)

    def _section(self):
        """The chapter of the report with the curves and the load steps."""
        from weavecell.report import page, pictures

        facts = self.record.facts
        figures = []
        for name, (caption, draw, arguments) in self.figures().items():
            kind = "svg"
            if draw is pictures_coupon.sheared_coupon:
                kind = "png"
            figures.append(pictures.draw_figure(name, caption, draw, *arguments, kind=kind))
        lead = ""
        if facts["failure_message"]:
            lead = f"The run was stopped: {facts['failure_message']}."
        title = pictures_coupon.TESTS[facts["test"]].capitalize()
        return page.Section(
            "coupon", title, lead, tuple(figures), (page.Table.from_frame(self.table()),)
        )

    def _write_report(self, folder, section, stamp):
        from weavecell.report import chapters, checks

        case = self.case
        facts = self.record.facts
        lines = tuple(" ".join(line.split()) for line in self.list_found())
        section = replace(section, points=lines)
        laws = {case.law_name: case.laws}
        cell = chapters.cell(case.fabric, laws, case.scene.fabric.cell_model)
        chapters.write(
            folder,
            self._lead(),
            (case.fabric,),
            (section, cell, checks.section(self.checks)),
            stamp,
            {"test": facts["wall_time_s"]},
            self.answer,
        )


class PullOutResult(CouponResult):
    """A yarn drawn out of held crossovers.

    Parameters
    ----------
    record : `fabrics.base.record.Record`, a row a sample of the load
    solved : `shellfabric.coupon.pull_out.PullOutCurve`
    case, checks, text : as in `CouponResult`
    """

    to_vtk = None  # type: ignore[assignment]  # its states are not kept

    @property
    def peak(self) -> float:
        """[N] highest load."""
        return self.solved.peak

    @property
    def plateau(self) -> float | None:
        """[N] mean load while all crossovers slide; None if they never all do."""
        return self.solved.plateau

    def summary(self) -> dict[str, Any]:
        """Return set-up, loads, slip length and work of friction, each with its unit; the checks in
        words."""
        return self.record.facts | {"checks": self.checks_text} | self._what_is_assumed()

    def _list_measures(self):
        facts = self.record.facts
        plateau = "not reached"
        if self.plateau is not None:
            plateau = f"{self.plateau:.4g} N"
        friction = f"{facts['crossover_friction']:g}"
        if self.solved.coupon.mu is None:
            low, high = self.solved.coupon.assumed_friction.span
            friction += f", assumed ({low:g} .. {high:g})"
        return {
            "peak load": f"{self.peak:.4g} N",
            "plateau load": plateau,
            "friction between yarns": friction,
            "displacement of the crosshead": f"{1e3 * facts['displacement_m']:.4g} mm",
            "slip length at the peak": f"{1e3 * facts['slip_length_m']:.4g} mm",
            "crossovers that the yarn's end has left": f"{facts['crossovers_left']} of {facts['crossings']}",
            "work of friction": f"{1e3 * facts['crossover_friction_work_J']:.4g} mJ",
        }

    def list_found(self) -> list[str]:
        """Write what the test came to, a line each."""
        rows = [
            f"{name:<44}{text}{self._flag(name)}" for name, text in self._list_measures().items()
        ]
        return rows + self._list_assumed_laws()

    def _lead(self):
        return self.case.scene.say_test(self.record.facts["fabric"], 1)

    def table(self) -> DataFrame:
        """Return what it came to."""
        from pandas import DataFrame

        return DataFrame(self._list_measures().items(), columns=["quantity", "value"])

    def figures(self) -> dict[str, tuple[str, Callable, tuple]]:
        """Return the figures, as `CouponResult` does."""
        caption = "Load on the pulled yarn; below: crossovers that it slides through, and those that its end has left."
        return {"load": (caption, pictures_coupon.pull_out, (self.solved,))}

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the load, and the crossovers in slip and left, against the
        displacement."""
        return figure(pictures_coupon.pull_out, self.solved)

    def _write_record(self, out):
        coupon_results.write(out / "histories.h5", self.record)
        return {}
