"""Pages of the documentation: where their numbers come from, and their figures."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = {str(path.relative_to(ROOT)): path.read_text("utf-8") for path in sorted(DOCS.rglob("*.md"))
         if not {"generated", "_build"} & set(path.relative_to(DOCS).parts)}  # fmt: skip
PAGES["README.md"] = (ROOT / "README.md").read_text("utf-8")
FIGURE = re.compile(r"!\[([^]]*)\]\((?:\.\./|docs/|reports/)*figures/([\w.-]+)\)")
# sections of validation.md whose numbers are of the commands that they name
# tables of a checkout with changes that take more than ten minutes of one core to compute again: the shots of the
# calibration chain of six fabrics, and 2,816 shots of the Sobol indices


def sections(text):
    """{heading: text} of the sections of a page."""
    return {part.splitlines()[0]: part for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]}


def rows(text, columns):
    """{fabric: cells} of the rows of fabrics of a table with that many columns."""
    cells = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| S-")]
    return {row[0]: row[1:] for row in cells if len(row) == columns}


def test_critical_velocities_are_those_of_the_reports():
    """The table of validation.md rounds the bisections of one-ply.md and convergence.md to 1 m/s."""
    stated = rows(sections(PAGES["docs/validation.md"])["Critical velocities of the six fabrics"], 4)
    one_ply = PAGES["docs/reports/one-ply.md"].partition("<!-- limits of")[2].partition("<!-- end of limits")[0]
    converged = [line for line in PAGES["docs/reports/convergence.md"].splitlines() if "critical velocity, m/s" in line]
    four = {name: cells for name, *cells in (line.strip("| ").split(" | ") for line in converged) if len(cells) == 12}
    limits = rows(one_ply, 7)
    assert list(stated) == list(limits) == list(four)
    for name, (one, fine, captions) in stated.items():
        assert float(one) == pytest.approx(float(limits[name][2]), abs=0.501)
        assert float(fine) == pytest.approx(float(four[name][4]), abs=0.501)
        assert captions.replace(" to ", " / ") == limits[name][0]


def test_every_figure_is_on_a_page_and_every_page_has_its_figures():
    shown = {name for text in PAGES.values() for _, name in FIGURE.findall(text)}
    assert shown == {path.name for path in DOCS.rglob("figures/*")}


def shown_as_code(text):
    """Lines of a page that would show an equation as code: indented blocks, and fences."""
    outside = re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL)
    return re.findall(r"^(?: {4,}\S.*|```.*)$", outside, flags=re.MULTILINE)


def test_equations_of_the_theory_are_typeset_in_the_symbols_of_its_table():
    pages = [PAGES[f"docs/theory-{name}.md"] for name in ("cell", "panel")]
    text, _, table = pages[0].partition("## Symbols")
    assert all(page.count("\n$$\n") > 30 and shown_as_code(page) == [] for page in pages)
    assert shown_as_code("so that\n\n    T = EA e\n") == ["    T = EA e"]
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if line.startswith("| $")]
    equations = " ".join(re.findall(r"\$\$[^$]+\$\$|\$[^$]+\$", text + pages[1]))
    assert [sign for row in rows for sign in re.findall(r"\$([^$]+)\$", row[0]) if sign not in equations] == []
    packages = ("fabrics", "meshing", "unitcell3d", "shellfabric")
    names = set(re.findall(r"\w+", " ".join(p.read_text("utf-8") for x in packages for p in (ROOT / x).rglob("*.py"))))
    assert [name for row in rows for name in re.findall(r"`(\w+)`", row[3]) if name not in names] == []
    assert len(rows) > 35
    assert all(len(row) == 4 and row[2] for row in rows)


REPORTS = [name for name in PAGES if name.startswith("docs/reports/") and not name.endswith("index.md")]
AT_TABLES = {"backing.md", "cards.md", "fit.md", "pack-limits.md"}  # have their commits below their tables, or none


@pytest.mark.parametrize("name", REPORTS)
def test_reports_begin_with_a_question_and_with_commit_and_date(name):
    title, question, *head = PAGES[name].split("\n\n")[:5]
    assert title.startswith("# ")
    if Path(name).name not in AT_TABLES:
        assert re.fullmatch(r"\*.*\?\*", question)
        assert re.search(r"\b[0-9a-f]{7,12}\b[^.]*2026-\d\d-\d\d", " ".join(head))


def test_the_index_of_reports_has_each_of_them_once():
    index = PAGES["docs/reports/index.md"]
    stated, listed = (
        re.findall(r"^\| \[[^]]+\]\(([\w-]+)\.md\)", index, re.MULTILINE),
        index.partition("```{toctree}")[2],
    )
    names = sorted(Path(name).stem for name in REPORTS)
    assert sorted(stated) == names
    assert sorted(re.findall(r"^[a-z0-9-]+$", listed, re.MULTILINE)) == names
