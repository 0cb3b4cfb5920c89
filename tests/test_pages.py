"""What README and the documentation print: commands parse, links lead somewhere, numbers are those of the data."""

import importlib
import importlib.util
import json
import os
import re
import shlex
import subprocess
import tomllib
from pathlib import Path

import pytest

from shellfabric.guards import ENERGY_ERROR_LIMIT, ENERGY_GAIN_LIMIT
from shellfabric.membrane.quality import CHECKS
from tests import printed_commands
from tests.printed_commands import PAGES, ROOT
from validation import program

TEXTS = {
    str(path.relative_to(ROOT)): path.read_text("utf-8")
    for path in (
        ROOT / "README.md",
        ROOT / "CONTRIBUTING.md",
        *sorted((ROOT / "docs").rglob("*.md")),
        *sorted((ROOT / "validation" / "reports").glob("*.md")),
    )
    if "generated" not in path.parts
}
CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def test_the_first_two_commands_of_readme_set_up_a_bare_machine():
    """Both depend on the set-up, in the Makefile too."""
    first = re.search(r"```sh\n(.*?)```", TEXTS["README.md"], re.DOTALL)
    assert first[1].split("\n")[:2] == ["make demo", "make test"]
    makefile = (ROOT / "Makefile").read_text("utf-8")
    assert re.search(r"^demo: setup\b", makefile, re.MULTILINE)
    assert re.search(r"^test: setup\b", makefile, re.MULTILINE)
    command = ["make", "--dry-run", "demo", "test"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_pages_and_numbers_made_from_code_and_data_are_up_to_date(tool):
    """Else: python tools/pages.py"""
    assert tool("pages").stale() == []


def test_results_written_by_hand_do_not_become_more(tool):
    """Else: fill them from the data by a mark (tools/page_values.py). Fewer: python tools/page_numbers.py --write"""
    numbers = tool("page_numbers")
    allowed = numbers.allowed()
    more = {
        page: count for page, count in numbers.counted().items() if count > allowed.get(page, 0)
    }
    assert more == {}


def test_readme_and_docs_do_not_grow_beyond_what_anybody_reads(tool):
    """Else: take out what stands twice; a report whose question is settled becomes a few lines."""
    numbers = tool("page_numbers")
    pages = numbers.words()
    assert {"README.md", "docs/limits.md", "docs/generated/input.md"} <= set(pages)
    assert sum(pages.values()) < numbers.MOST_WORDS


def test_numbers_of_a_page_are_told_apart(tool, tmp_path):
    numbers = tool("page_numbers")
    page = tmp_path / "page.md"
    page.write_text(
        "A ply leaves 114.8 m/s, more than `3.7 %` off; target 2.5 %, friction 0.17, 61 x 83 mm.\n\n"
        "| strike, 47 m/s | left | tests |\n| --- | --- | --- |\n| 53 m/s | 29.3 m/s | 31.9 m/s |\n\n"
        "<!-- = strength-limits[share=0.9] critical velocity [m/s] : .1f -->101.4<!-- / --> m/s\n"
    )
    found = {number: kind for kind, _, number, *_ in numbers.of_page(page)}
    expected = {"114.8": "prose", "3.7": "prose", "47": "label", "53": "label", "29.3": "table"}
    assert found == expected | {"31.9": "test"}


MARK = "<!-- = measured[id=gelatine 10 %] {} -->{}<!-- / -->"


def test_a_mark_is_filled_from_the_data(tool):
    values = tool("page_values")
    rows = {row["id"]: row for row in values.read(values.DATA / "measured.csv")[1]}
    row = rows["gelatine 10 %"]
    text = values.filled(MARK.format("computed : .1f", "17"))
    assert text == MARK.format("computed : .1f", f"{float(row['computed']):.1f}")
    ratio = float(row["computed"]) / float(row["measured"])
    asked = "computed over measured : +.0f%"
    assert values.filled(MARK.format(asked, "")) == MARK.format(
        asked, f"{100 * (ratio - 1):+.0f} %"
    )
    with pytest.raises(ValueError, match="no row"):
        values.value("measured[id=moon] computed : .1f")
    with pytest.raises(ValueError, match="no column"):
        values.value("measured[id=gelatine 10 %] weight : .1f")


@pytest.fixture
def made_up(tool, monkeypatch, tmp_path):
    """The module that fills marks, with one file of data: limits of two noses on two fabrics."""
    values = tool("page_values")
    monkeypatch.setattr(values, "DATA", tmp_path)
    (tmp_path / "noses.csv").write_text(
        "# made up\n"
        "nose,fabric,strike [m/s],limit [m/s],95 %\n"
        "flat,S-720,80,100,90 / 130\n"
        "flat,S-728,90,130,110 / 150\n"
        "cone,S-728,95,50,40 / 70\n"
        "cone,S-720,85,40,30 / 55\n"
        "ogive,S-720,86,,\n"
    )
    return values


@pytest.mark.parametrize(
    ("asked", "text"),
    [
        ("noses[nose=flat; fabric=S-728] 95 %#2 : .0f", "150"),
        ("noses[nose=flat; fabric=S-728] limit [m/s] over strike [m/s] : +.1f%", "+44.4 %"),
        (
            "noses[nose=cone; fabric=S-728] limit [m/s] over [nose=flat; fabric=S-720] limit [m/s] : .2f",
            "0.50",
        ),
        ("mean noses[strike [m/s]=85..90] limit [m/s] : .1f", "85.0"),
        ("error noses[strike [m/s]=85..90] limit [m/s] : .1f", "45.0"),
        ("count noses[nose=o*] : d", "1"),
        # c*e: cone, neither flat nor ogive
        ("most noses[nose=c*e] limit [m/s] : .0f", "50"),
        ("count noses[fabric=*20] : d", "3"),
        ("noses[nose=flat; fabric=S-728] fabric : s", "S-728"),
        ("code fabrics/data_sheet.toml over the value, ply_gap, high : .1f", "2.3"),
    ],
)
def test_a_mark_takes_ratios_parts_ranges_and_means(made_up, asked, text):
    assert made_up.value(asked) == text


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("noses[nose=flat] limit [m/s] : .1f", "2 values"),
        ("noses[nose=ogive] limit [m/s] : .1f", "1 values"),
        ("noses[fabric=S-728; nose=cone] limit [m/s] over [nose=flat] limit [m/s] : .1f", "2 rows"),
        ("noses[colour=red] limit [m/s] : .1f", "no column 'colour'"),
        ("noses limit [m/s]", "no mark"),
    ],
)
def test_a_mark_that_means_several_rows_or_none_is_refused(made_up, asked, told):
    with pytest.raises(ValueError, match=told):
        made_up.value(asked)


def test_a_row_of_a_table_is_made_of_the_rows_that_are_alike(made_up):
    limit = "limit [m/s]"
    off = f"{{[fabric=S-728] {limit} over [fabric=S-720] {limit}:+.0f%}}"
    head = f"<!-- rows noses[{limit}=1..200] by nose | {{nose}} | {{[fabric=S-720] {limit}:.0f}} | {off} -->\n"
    head += "| nose | S-720 | S-728 off |\n| --- | ---: | ---: |\n"
    rows = "| flat | 100 | +30 % |\n| cone | 40 | +25 % |\n"
    end = "<!-- / -->"
    assert made_up.filled(head + "| flat | 90 | |\n" + end) == head + rows + end
    # the ogive has no row of S-728
    with pytest.raises(ValueError, match="0 rows"):
        made_up.filled(head.replace(f"[{limit}=1..200]", "") + end)


def test_a_change_of_a_file_changes_every_page_that_quotes_it(tool, monkeypatch, tmp_path):
    values = tool("page_values")
    texts = {page: TEXTS[page] for page in values.pages()}
    quoting = {
        page for page, text in texts.items() if re.search(r"<!-- [^>]*strength-limits", text)
    }
    assert len(quoting) == 3
    for path in values.DATA.iterdir():
        (tmp_path / path.name).symlink_to(path)
    changed = tmp_path / "strength-limits.csv"
    text = changed.read_text("utf-8")
    changed.unlink()
    changed.write_text(text.replace("101.38", "99.38").replace("106.51", "104.51"), "utf-8")
    monkeypatch.setattr(values, "DATA", tmp_path)
    assert {page for page, text in texts.items() if values.filled(text) != text} == quoting


@pytest.mark.parametrize("page", PAGES)
def test_printed_commands_exist_and_have_their_files(page):
    """Each command with its options; each file is in the repository or made before on the page; Python is public."""
    import weavecell

    made = set()
    for kind, written, name in printed_commands.of(page):
        if kind == "file":
            made.add(name)
            if name.endswith(".toml"):
                tomllib.loads(written)
        elif kind == "python":
            made |= set(re.findall(r"""["']([\w./-]+\.(?:toml|csv|json))["']""", written))
            names = set(re.findall(r"\bwc\.(\w+)", written))
            assert names <= set(weavecell.__all__), page
        elif kind == "output":
            continue
        elif written.startswith("python"):
            words = printed_commands.words(written)
            assert words[1] == "-m" or (ROOT / words[1]).exists(), written
        else:
            reads, makes = printed_commands.files(
                *printed_commands.parsed(printed_commands.words(written))
            )
            ours = [file for file in reads if not (ROOT / file).exists()]
            assert [
                file for file in ours if not any(f"{file}/".startswith(f"{one}/") for one in made)
            ] == [], written
            made |= set(makes)


def test_a_wrong_command_is_found():
    with pytest.raises(Exception, match=r"(?i)no such option"):
        printed_commands.parsed(["weavecell", "impact", "x.toml", "--outt", "y"])
    with pytest.raises(AssertionError, match="missing"):
        printed_commands.parsed(["weavecell", "impact"])
    found = printed_commands.files("weavecell impact", {"scene": "a/b.toml", "out": "results/x"})
    assert found == (["a/b.toml"], ["results/x", "results/b"])


def programs():
    """(module, words) of all programs of ours that a page tells to run, with their options."""
    found = (
        re.findall(r"python -m ((?:validation|tests|weavecell)\.[^`#\n]*)", text)
        for text in TEXTS.values()
    )
    return sorted({tuple(shlex.split(line)) for lines in found for line in lines})


@pytest.mark.parametrize("words", programs(), ids=" ".join)
def test_a_printed_program_understands_its_options(words):
    """Nothing is run."""
    name, *options = words
    spec = importlib.util.find_spec(name)
    assert spec is not None
    file = f"{name}.__main__" if spec.submodule_search_locations else name
    if name.startswith("validation"):
        if "unitcell3d" in (ROOT / f"{file.replace('.', '/')}.py").read_text():
            pytest.importorskip("dolfinx")
        program.options(importlib.import_module(file).main, {}, options)


@pytest.mark.parametrize("page", TEXTS)
def test_every_link_and_picture_leads_to_a_file_in_git(page, tracked):
    """Sphinx checks the pages of the site; this also README, CONTRIBUTING and pictures, as a forge shows them."""
    assert_links_lead_somewhere(page, TEXTS[page], tracked)


@pytest.fixture(scope="module")
def tracked():
    """Files that git keeps; None where the tests run without its folder."""
    if not (ROOT / ".git").exists():
        return None
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return {(ROOT / name).resolve() for name in listed.stdout.splitlines()}


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "generated").glob("*.md")), ids=str)
def test_links_of_pages_made_from_code_lead_somewhere(page, tracked):
    assert_links_lead_somewhere(page.relative_to(ROOT), page.read_text("utf-8"), tracked)


def test_pages_that_only_the_site_has_are_made(tool):
    """With a heading, and links from their folder that lead somewhere; the list of pages of the site has each."""
    found = tool("reference_pages").site_pages()
    assert len(found) == 10
    listed = TEXTS["docs/index.md"] + TEXTS["docs/reports/index.md"]
    made = {(ROOT / "docs" / "generated" / name).resolve() for name in found}
    for name, text in found.items():
        assert text.startswith("# "), name
        assert_links_lead_somewhere(f"docs/generated/{name}", text, made=made)
        assert f"generated/{name.removesuffix('.md')}\n" in listed, name


def assert_links_lead_somewhere(page, text, tracked=None, made=()):
    for target in re.findall(r"\]\(([^)\s]+)\)", CODE.sub("", text)):
        path, _, anchor = target.partition("#")
        # the folder of a page that only the site has need not be there
        file = ROOT / page
        if path:
            file = Path(os.path.normpath(file.parent / path))
        if re.match(r"https?:|mailto:", target):
            continue
        # another page that only the site has
        if file in made:
            continue
        assert file.exists(), target
        if tracked is not None and file.is_file():
            assert file.resolve() in tracked, f"{target} is not kept in git"
        if anchor:
            heads = re.findall(r"^#+ (.*)$", CODE.sub("", file.read_text("utf-8")), re.MULTILINE)
            anchors = {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}
            assert anchor in anchors, target


@pytest.mark.parametrize("page", TEXTS)
def test_a_forge_shows_no_directive_as_text(page):
    """Directives of the site stand in comments; there are no roles."""
    shown = re.sub(r"<!--.*?-->", "", TEXTS[page], flags=re.DOTALL)
    assert not re.search(r"```\{|\{\w+\}`|-->", shown)


@pytest.mark.parametrize("page", TEXTS)
def test_no_line_of_a_paragraph_begins_with_a_mark(page):
    """A reader of Markdown takes such a line as HTML: it ends the paragraph, and links in it are plain text."""
    assert re.findall(r"^ *<!-- = .*", TEXTS[page], re.MULTILINE) == []


@pytest.mark.parametrize("page", TEXTS)
def test_no_blank_line_ends_a_table(page):
    """A reader of Markdown takes the rows behind it as plain text."""
    lines = [*TEXTS[page].splitlines(), "", ""]
    split = []
    for number, line in enumerate(lines[1:-2], 1):
        within = lines[number - 1].startswith("|") and lines[number + 1].startswith("|")
        begins = re.match(r"\|[ :|-]+$", lines[number + 2])
        if not line.strip() and within and not begins:
            split.append(number + 1)
    assert split == []


def test_every_figure_is_on_a_page():
    shown = {name for text in TEXTS.values() for name in re.findall(r"figures/([\w.-]+)\)", text)}
    assert {path.name for path in (ROOT / "docs").rglob("figures/*")} <= shown


STUDIES = [
    (page, kind, name, options)
    for page, text in TEXTS.items()
    for kind, name, options in re.findall(
        r"^```\{study-(\w+)\} (\S+)\n(.*?)```", text, re.MULTILINE | re.DOTALL
    )
]


@pytest.mark.parametrize(
    "page, kind, name, options", STUDIES, ids=lambda text: str(text).splitlines()[:1]
)
def test_tables_and_figures_of_studies_are_in_their_files(tool, page, kind, name, options):
    pages = tool("study_pages")
    if kind == "table":
        pages.rows_of(name, **dict(re.findall(r"^:(\w+): (.*)$", options, re.MULTILINE)))
    else:
        [axes, *_] = pages.draw(name).axes
        assert axes.lines
        assert axes.get_xlabel() != "fabric" or axes.get_xticklabels()[0].get_text() == "S-720"


def test_a_line_of_a_figure_is_of_the_rows_that_its_legend_names(tool):
    """The title of the legend has the columns of its labels, in their order."""
    pages = tool("study_pages")
    compared = 0
    for name in {name for _, kind, name, _ in STUDIES if kind == "figure"} - {"measured", "scored"}:
        [axes, *_] = pages.draw(name).axes
        legend = axes.get_legend()
        asked = pages.picture(name)
        if legend is None or not legend.get_title().get_text() or isinstance(asked["y"], list):
            continue
        columns = legend.get_title().get_text().split(", ")
        for line in axes.lines:
            values = line.get_label().split(", ")
            rows = [row for row in pages.read(name)[1] if [row[key] for key in columns] == values]
            expected = [float(row[asked["y"]]) for row in rows]
            assert list(line.get_ydata()) == expected != [], (name, line.get_label())
            compared += 1
    assert compared > 6


def test_every_page_that_data_and_code_name_is_there():
    """But those of tables that are kept from pages until a stated date."""
    named = {}
    for folder in (
        "docs/reports/data",
        "validation",
        "fabrics",
        "weavecell",
        "shellfabric",
        "unitcell3d",
        "examples",
    ):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix in (".csv", ".toml", ".py") and "kept" not in path.parts:
                found = re.findall(r"\bdocs/[\w/.-]+\.(?:md|csv)\b", path.read_text("utf-8"))
                named |= dict.fromkeys(found, path)
    assert {page: path for page, path in named.items() if not (ROOT / page).exists()} == {}


STATED = {  # words of a page before a limit in %, and the limit of the code
    r"stopped at an energy error of ([\d.]+) %": ENERGY_ERROR_LIMIT,
    r"more than ([\d.]+) % of the strike energy ends the run": ENERGY_GAIN_LIMIT,
    r"Above ([\d.]+) % of the strike energy the result is marked doubtful": CHECKS[
        "energy error"
    ].limit,
}


@pytest.mark.parametrize("words, limit", STATED.items())
def test_a_limit_is_the_same_on_every_page_and_in_the_code(words, limit):
    texts = " ".join(" ".join(TEXTS.values()).split())
    assert set(map(float, re.findall(words, texts))) == {100 * limit}


def test_the_head_of_the_bar_example_says_what_the_run_gives():
    head = (ROOT / "examples/S-720-bar.toml").read_text("utf-8").partition("title")[0]
    known = json.loads((ROOT / "tests/golden/impact-S-720-bar.json").read_text("utf-8"))["numbers"]
    text = " ".join(head.replace("#", " ").split())
    assert f"{1e3 * known['bar.shortening']:.2f} mm shorter" in text
    assert (f"{known['residual_velocity']:.0f} m/s left" in text) == (
        known["outcome"] == "perforated"
    )
