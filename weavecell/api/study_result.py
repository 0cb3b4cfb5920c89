"""What the results of studies of many shots share: their files, their picture, and what is printed of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import files
from fabrics.checks import FilePath
from weavecell.api.result import Result, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from weavecell.scenes.target import Target


class StudyResult(Result):
    """Shots at a target. A derived class has the target as a field, and what raises NotImplementedError here."""

    target: Target
    wall_time: float  # [s]; of a result with a page

    @property
    def title(self) -> str:
        """Of picture and page."""
        return self.target.title

    @property
    def limit_sensitivity(self) -> str:
        """How a limit changes over the range of an assumed failure length, in a sentence; "" where that is given."""
        from weavecell.studies import assumed_range

        targets = getattr(self, "targets", (self.target,))
        return assumed_range.limit_sensitivity(fabric for one in targets for fabric in one.setup.fabrics)

    @property
    def notes(self) -> list[str]:
        """What the set-up notes of itself."""
        return [f"Note: {note}." for note in self.target.setup.notes]

    def lines(self) -> list[str]:
        """What is printed, and stands at the top of a page."""
        raise NotImplementedError

    def draw(self, pyplot: Any) -> Figure:
        """The picture."""
        raise NotImplementedError

    def table(self) -> DataFrame:
        """The table of the page, columns with their units; of a result without a page that of `to_dataframe`."""
        return self.to_dataframe()

    def _shown(self):
        return self._columns_shown()

    def files(self) -> dict[str, Any]:
        """{file: what it holds}: a dict for JSON, to which the provenance is added, a text for CSV; nothing for the
        picture (.svg or .png) and the page (.html)."""
        raise NotImplementedError

    def plot(self) -> Figure:
        """A matplotlib figure."""
        return figure(self.draw)

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.report import chapters, page, pictures
        from weavecell.results import json_file, provenance

        out, stamp = Path(out), provenance.stamp(self.target.text, setup=self.target.setup)
        if self.target.text:
            files.write(out / "scene.toml", self.target.text)
        for name, content in self.files().items():
            stem, _, kind = name.partition(".")
            if kind == "json":
                json_file.write(out / name, content | {"provenance": stamp})
            elif kind == "html":
                picture = page.Figure(pictures.render(self.draw, kind="png"), "png", "", stem)
                table = page.Table.of(self.table())
                result = page.Section(stem, "Result", " ".join(self.lines()), (picture,), (table,))
                footer = f"weavecell {stamp['weavecell']}, {stamp['date']}"
                sections = result, chapters.making(stamp, {"study": self.wall_time})
                page.write(page.Report(self.title, "", (), sections, footer), out / name)
            else:
                files.write(out / name, content or pictures.render(self.draw, kind=kind))

    def __str__(self) -> str:
        return "\n".join(self.lines())
