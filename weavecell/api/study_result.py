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

    @property
    def title(self) -> str:
        """Of picture and page."""
        return self.target.title

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

    @property
    def headline(self) -> tuple[str, str]:
        """What was looked for, and what was found, in a few words."""
        return "Result", self.lines()[0]

    def table(self) -> DataFrame:
        """The table of the page, columns with their units."""
        return self._columns_shown()

    def _shown(self):
        return self._columns_shown()

    def files(self) -> dict[str, Any]:
        """{file beside the page: what it holds}: a dict for JSON, to which the provenance is added, a text for CSV;
        nothing for the picture (.svg or .png)."""
        raise NotImplementedError

    def plot(self) -> Figure:
        """A matplotlib figure."""
        return figure(self.draw)

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.report import page, pictures, study_page
        from weavecell.results import json_file, provenance

        out, stamp = Path(out), provenance.stamp(self.target.text, setup=self.target.setup)
        if self.target.text:
            files.write(out / "scene.toml", self.target.text)
        for name, content in self.files().items():
            kind = name.partition(".")[2]
            if kind == "json":
                json_file.write(out / name, content | {"provenance": stamp})
            else:
                files.write(out / name, content or pictures.render(self.draw, kind=kind))
        page.write(study_page.page(self, stamp), out / "report.html")

    def __str__(self) -> str:
        return "\n".join(self.lines())
