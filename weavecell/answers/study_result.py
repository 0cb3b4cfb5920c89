"""What the results of studies of many shots share: their files, their picture, and what is printed
of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base import files
from weavecell.answers.result import WrittenResult, figure
from weavecell.answers.target import list_assumptions
from weavecell.report import installed
from weavecell.results import one_table, out_folder
from weavecell.results.left_out import LeftOut, find_left_out, lines_of, summarise

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.report.page import Section
    from weavecell.runs.measurement import Measurement


class DrawnResult(WrittenResult):
    """A result with a picture and files. A derived class has what raises NotImplementedError
    here."""

    def draw(self, pyplot: Any) -> Figure:
        """Draw the picture."""
        raise NotImplementedError

    def files(self) -> dict[str, Any]:
        """Return {file beside the page: what it holds}: a dict for JSON, to which the provenance is
        added, a text for CSV; nothing for the picture (.svg or .png)."""
        raise NotImplementedError

    def plot(self) -> Figure:
        """Draw a matplotlib figure."""
        return figure(self.draw)

    def _write(self, folder: Path) -> None:
        from weavecell.results import provenance

        self._write_files(folder, provenance.stamp())

    def _write_files(self, folder, stamp):
        from weavecell.report import pictures
        from weavecell.results import json_file

        drawn = installed.can_draw()
        for name, content in self.files().items():
            kind = name.partition(".")[2]
            if kind == "json":
                content |= summarise(self.left_out) | self._answered()
                json_file.write(folder / name, content | {"provenance": stamp})
            elif kind == "h5":
                one_table.write_hdf5(content, folder / name, self.kind)
            elif content:
                files.write(folder / name, content)
            elif drawn:
                files.write(folder / name, pictures.render(self.draw, kind=kind))


class StudyResult(DrawnResult):
    """Shots at a target. A derived class has the target as a field, and what raises
    NotImplementedError here."""

    target: Target

    @property
    def title(self) -> str:
        """Of picture and page."""
        return self.target.title

    def _name_shot(self, question):
        """Say what is asked, and of what."""
        # a set-up has no words for its projectile
        nose = (self.target.projectile or "").partition(",")[0]
        return ", ".join(filter(None, (self.target.title, question, nose)))

    @property
    def draws_strengths(self) -> bool:
        """Whether each yarn that was shot at has a strength of its own."""
        return False

    @property
    def fired(self) -> ImpactSetup:
        """The set-up that its shots model."""
        from weavecell.studies import inputs

        return inputs.without_end(self.target.setup)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As in `Result`, of shots at the target."""
        return find_left_out(self.target.setup, drawn=self.draws_strengths)

    @property
    def notes(self) -> list[str]:
        """What the set-up notes of itself."""
        return [f"Note: {note}." for note in self.target.setup.notes]

    def table(self) -> DataFrame:
        """Return the table of the page, columns with their units."""
        return self._labelled_columns()

    def _notebook_table(self):
        return self._labelled_columns()

    @property
    def _written(self):
        return (*self.files(), *out_folder.INPUT, "report.html")

    def _write(self, folder):
        from weavecell.results import provenance

        stamp = provenance.stamp(self.target.text, setup=self.target.setup)
        self.target.keep_input(folder)
        self._write_files(folder, stamp)
        if installed.can_draw():
            self._write_report(folder, stamp)

    def _own_chapters(self) -> list[Section]:
        """Chapters of the page that other studies have not."""
        return []

    def _write_report(self, out, stamp):
        """Write the report: what was found with its picture and table, what is assumed, and
        sources."""
        from weavecell.report import chapters, checks, pictures
        from weavecell.report.page import Section, Table
        from weavecell.report.shot import chapters_shot

        setup = self.target.setup
        case = self.target.case
        beside = (pictures.draw_figure("result", "", self.draw),)
        table = Table.from_frame(self.table())
        sections = [Section("result", "Result", "", (), (table,))]
        sections += self._own_chapters()
        if self.draws_strengths:
            scatter = getattr(getattr(self, "study", None), "scatter", None)
            sections.append(chapters_shot.describe_unknown(setup, scatter))
        remarks = (*self.lines(), *lines_of(self.left_out))
        sections.append(Section("remarks", "Remarks", points=remarks, folded=True))
        laws = list_assumptions(setup)
        sections.append(chapters_shot.assumptions(self.fired, laws, drawn=self.draws_strengths))
        if self.checks:
            sections.append(checks.section(self.checks))
        seconds = {}
        if hasattr(self, "wall_time"):
            seconds["study"] = self.wall_time
        lead = chapters.describe_shot(setup, case and case.scene)
        # a sweep has a target for each row
        if hasattr(self, "targets"):
            lead = f"The first combination: {lead}"
        chapters.write(out, lead, setup.fabrics, sections, stamp, seconds, self.answer, (), beside)


class DrawnStudy(StudyResult):
    """A study whose shots are at drawn panels. A derived class has what raises NotImplementedError here."""

    @property
    def measurements(self) -> tuple[Measurement, ...]:
        """What measurements leave of the answer, what narrows it most first."""
        raise NotImplementedError

    def _what_to_measure(self):
        """Return the entry of a JSON file."""
        return {"measure_first": [one.entry() for one in self.measurements]}

    @property
    def draws_strengths(self) -> bool:
        """As in `StudyResult`."""
        return True

    @property
    def fired(self) -> ImpactSetup:
        """As in `StudyResult`: the whole panel of resolved yarns, on the mesh of drawn shots."""
        from weavecell.runs import table

        return table.as_fired(super().fired)
