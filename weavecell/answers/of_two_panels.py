"""What the comparisons of two panels share: what is compared, what it is called, and what else differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics.base import run_cache
from weavecell.answers.study_result import DrawnResult
from weavecell.answers.target import list_assumptions
from weavecell.report import installed
from weavecell.results.left_out import lines_of

if TYPE_CHECKING:
    from pandas import DataFrame

    from weavecell.answers.target import Target
    from weavecell.report.page import Section, Table

# fields of a set-up that a comparison is about
COMPARED = (
    *("fabric", "laws", "surface", "lay_up", "plies", "stacking", "ply_gap", "ply_friction"),
    *("bending", "cell_model", "packed_area", "contact", "grading", "elements_per_crossover"),
    *("strike_velocity", "table_size"),
)


class OfTwoPanels(DrawnResult):
    """What results about two panels share. A derived class has what raises NotImplementedError
    here, and the names of the files and folders that it writes."""

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        raise NotImplementedError

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

    def _write(self, folder):
        from weavecell.results import provenance

        a, b = self.targets
        text = "\n".join(f"# {panel.name}\n{panel.text}" for panel in (a, b) if panel.text)
        stamp = provenance.stamp(text, *a.setup.fabrics, setup=b.setup)
        self._save_each(folder)
        self._write_files(folder, stamp)
        if installed.can_draw():
            self._write_report(folder, stamp)

    def _save_each(self, out: Path) -> None:
        """Write what has folders of its own; nothing of most."""

    def _write_report(self, out, stamp):
        """Write the page."""
        raise NotImplementedError

    def _write_page(
        self,
        out: Path,
        stamp: object,
        tables: Sequence[Table],
        more: Sequence[Section],
        points: Sequence[str],
        seconds: dict[str, float],
    ) -> None:
        """Write the page that has both.

        Parameters
        ----------
        tables : of both
        more : sections below the result
        points : lines that follow what is printed
        seconds : {what was computed: wall time}
        """
        from weavecell.report import chapters, page, pictures

        name = next(Path(file).stem for file in self.files() if file.endswith(".svg"))
        picture = pictures.draw_figure(name, "", self.draw)
        sections = [page.Section("result", "A and B", "", (), tuple(tables)), *more]
        lines = (*self.lines(), *lines_of(self.left_out), *points)
        sections.append(page.Section("remarks", "Remarks", points=lines, folded=True))
        shots = [chapters.describe_shot(panel.setup, panel.scene) for panel in self.targets]
        lead = " ".join(f"{side}: {shot}" for side, shot in zip("AB", shots))
        fabrics = {f.name: f for panel in self.targets for f in panel.setup.fabrics}
        content = (lead, [*fabrics.values()], sections, stamp, seconds, self.answer, (), (picture,))
        chapters.write(out, *content)
