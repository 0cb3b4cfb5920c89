"""The site: its pages, their length and width, the commands that they print, and words that users search for."""

import ast
import importlib.util
import re
import tomllib

import pytest

from tests import printed_commands
from tests.printed_commands import GUIDE, PAGES, ROOT

DOCS = ROOT / "docs"
MOST_WORDS, MOST_COLUMNS, MOST_LETTERS = 30_000, 5, 120


def text(page):
    return (ROOT / page).read_text("utf-8")


def test_the_guide_has_its_pages_in_their_order():
    assert {path.stem for path in DOCS.glob("*.md")} == set(GUIDE)
    guide = re.search(r"```\{toctree\}\n:caption: Guide\n(.*?)```", text("docs/index.md"), re.DOTALL)[1]
    assert [name for name in guide.split() if name in GUIDE] == list(GUIDE[1:])


@pytest.mark.parametrize("page", PAGES)
def test_tables_and_code_are_narrow(page):
    """Columns of tables, and letters of what a reader types; output may be wider, it scrolls."""
    rows = [line for line in text(page).splitlines() if re.match(r"\|[ :|-]+\|$", line)]
    assert [row for row in rows if row.count("|") - 1 > MOST_COLUMNS] == []
    lines = [line for part in printed_commands.of(page) for line in part.text.splitlines()]
    assert [line for line in lines if len(line) > MOST_LETTERS] == []


@pytest.mark.parametrize("page", PAGES)
def test_printed_commands_exist_and_have_their_files(page):
    """Each command with its options; each file is in the repository or made before on the page."""
    made = set()
    for kind, written, name in printed_commands.of(page):
        if kind == "file":
            made.add(name)
            tomllib.loads(written) if name.endswith(".toml") else None
            continue
        if kind == "python":
            made |= set(re.findall(r"""["']([\w./-]+\.(?:toml|csv|json))["']""", written))
            continue
        argv = printed_commands.words(written)
        if argv[0] == "python":
            checked_python(argv)
            continue
        try:
            command, values = printed_commands.parsed(argv)
        except Exception as problem:  # of click, or of the click that typer has
            pytest.fail(f"{page}: {written}: {getattr(problem, 'message', problem)}")
        reads, makes = printed_commands.files(command, values)
        missing = [file for file in reads if not ((ROOT / file).exists() or in_one_of(file, made))]
        assert not missing, (page, written, missing)
        made |= set(makes)


def in_one_of(file, made):
    return any(file == one or file.startswith(f"{one}/") for one in made)


def checked_python(argv):
    """A script of the repository, or a module that takes the options."""
    if argv[1] != "-m":
        assert (ROOT / argv[1]).exists(), argv
        return
    found = importlib.util.find_spec(argv[2])
    assert found is not None, argv
    folder = ROOT / argv[2].replace(".", "/")
    sources = [*folder.glob("*.py")] if folder.is_dir() else [folder.with_suffix(".py")]
    program = "".join(path.read_text("utf-8") for path in sources)
    assert [word for word in argv[3:] if word.startswith("--") and f'"{word}"' not in program] == [], argv


@pytest.mark.parametrize("page", PAGES)
def test_printed_python_is_of_the_public_interface(page):
    import weavecell

    for kind, written, _ in printed_commands.of(page):
        if kind == "python":
            names = {
                node.attr
                for node in ast.walk(ast.parse(written))
                if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "wc"
            }
            assert [name for name in names if name not in weavecell.__all__] == []


def test_a_wrong_command_is_found():
    with pytest.raises(Exception, match=r"(?i)no such option"):
        printed_commands.parsed(["weavecell", "impact", "x.toml", "--outt", "y"])
    with pytest.raises(AssertionError, match="missing"):
        printed_commands.parsed(["weavecell", "impact"])
    assert printed_commands.parsed(["weavecell", "fabrics", "new", "x.toml"])[0] == "weavecell fabrics new"
    assert printed_commands.files("weavecell impact", {"scene": "a/b.toml", "out": "results/x"}) == (
        ["a/b.toml"], ["results/x", "results/b"],
    )  # fmt: skip
