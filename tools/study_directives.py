"""The directives `study-table` and `study-figure` of the reports: see study_pages.py."""

from __future__ import annotations

from typing import ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive, directives
from study_pages import DATA, ROOT, draw, read, rows_of, shown

FIGURES = ROOT / "docs" / "generated" / "studies"


class StudyTable(Directive):
    """A table of a CSV."""

    required_arguments = 1
    option_spec: ClassVar = {"columns": directives.unchanged, "where": directives.unchanged}

    def run(self):
        """Make the table of a study."""
        [name] = self.arguments
        self.state.document.settings.record_dependencies.add(str(DATA / f"{name}.csv"))
        try:
            made, count, columns, rows = rows_of(name, **self.options)
        except (OSError, ValueError) as problem:
            raise self.error(str(problem)) from None
        group = nodes.tgroup(cols=len(columns))
        group += [nodes.colspec(colwidth=1) for _ in columns]
        head, body = nodes.thead(), nodes.tbody()
        head += _row(columns)
        body += [_row(row) for row in rows]
        group += [head, body]
        title = nodes.title(text=f"{len(rows)} of {count} rows of data/{name}.csv: {shown(made)}")
        return [nodes.table("", title, group, classes=["study"])]


def _row(cells):
    row = nodes.row()
    row += [nodes.entry("", nodes.paragraph(text=cell)) for cell in cells]
    return row


class StudyFigure(Directive):
    """The figure of a study, drawn from its CSV."""

    required_arguments = 1
    has_content = True

    def run(self):
        """Draw the figure of a study."""
        [name] = self.arguments
        self.state.document.settings.record_dependencies.add(str(DATA / f"{name}.csv"))
        path = FIGURES / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        draw(name).savefig(path, dpi=100)
        caption = f"{' '.join(self.content)} {shown(read(name)[0])}.".strip()
        image = nodes.image(uri=f"/generated/studies/{name}.png", alt=caption)
        return [nodes.figure("", image, nodes.caption(text=caption))]


def setup(app):
    """Register the directives."""
    app.add_directive("study-table", StudyTable)
    app.add_directive("study-figure", StudyFigure)
    return {"parallel_read_safe": True}
