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
NUMBER = re.compile(r"(?<![\w.-])\d+\.\d+(?![\w.]|-)")
# sections of results.md whose numbers are of a command that they name, and single numbers of that kind
OF_COMMANDS = {"Demonstration", "Cost"}
# tables of a checkout with changes that take more than ten minutes of one core to compute again: the shots of the
# calibration chain of six fabrics, and 2,816 shots of the Sobol indices
LONG = {"docs/reports/calibration.md": ["0298315e53c7"], "docs/reports/scatter.md": ["bbd68ba95eb2"]}
TIMES = {"14.5"}  # minutes of `weavecell validate`


def sections(text):
    """{heading: text} of the sections of a page."""
    return {part.splitlines()[0]: part for part in re.split(r"^## ", text, flags=re.MULTILINE)[1:]}


def not_found(section):
    """Numbers with a decimal point of a section of results.md that are on none of the pages that it names."""
    names = set(re.findall(r"\(([\w/-]+\.md)", section))
    texts = [PAGES[f"docs/reports/{name}"] for name in names]
    known = {float(number) for text in texts for number in re.findall(r"\d+(?:\.\d+)?", text)}
    rounded = known | {round(number, digits) for number in known for digits in (2,)}
    return [number for number in NUMBER.findall(section) if float(number) not in rounded and number not in TIMES]


@pytest.mark.parametrize(
    "heading", [name for name in sections(PAGES["docs/reports/results.md"]) if name not in OF_COMMANDS]
)
def test_numbers_of_results_are_on_the_pages_that_it_names(heading):
    section = sections(PAGES["docs/reports/results.md"])[heading]
    assert ".md)" in section
    assert not_found(section) == []


def test_a_number_that_is_on_no_page_is_found():
    section = sections(PAGES["docs/reports/results.md"])["Outcomes of one ply"]
    assert not_found(section.replace("122.9", "987.6")) == ["987.6"]


def test_every_stamp_is_of_a_commit_without_changes():
    found = {name: re.findall(r"\b([0-9a-f]{8,}) \+ changes", text) for name, text in PAGES.items()}
    assert {name: commits for name, commits in found.items() if commits} == LONG


def test_every_figure_is_on_a_page_and_every_page_has_its_figures():
    shown = {name for text in PAGES.values() for _, name in FIGURE.findall(text)}
    assert shown == {path.name for path in DOCS.rglob("figures/*")}


def test_figures_are_described():
    short = [
        f"{name}: {alt!r}" for name, text in PAGES.items() for alt, _ in FIGURE.findall(text) if len(alt.split()) < 2
    ]
    assert short == []


def test_pages_name_what_made_their_tables():
    """A page with a table between marks names the command that puts it there."""
    for name, text in PAGES.items():
        for module in re.findall(r"<!-- [\w ,]* of (validation\.[\w.]+)", text):
            assert f"python -m {module}" in text or "weavecell" in text or name == "README.md", (name, module)
