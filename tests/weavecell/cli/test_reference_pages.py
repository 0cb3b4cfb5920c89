"""The reference pages of the site hold every command, every option and every key of a scene."""

import json
import re
from pathlib import Path

import pytest
import typer

from weavecell.cli.app import program

ROOT = Path(__file__).parents[3]


@pytest.fixture
def pages(tool):
    return tool("reference_pages")


def test_every_command_and_option_is_on_the_page(pages):
    text = pages.cli()
    found = list(pages.commands(typer.main.get_command(program()), "weavecell"))
    assert len(found) > 15
    for name, command in found:
        part = text[text.index(f"## {name}\n") :].split("\n## ")[0]
        for one in command.params:
            assert one.opts[0] in part or one.metavar in part or one.name == "help", (name, one.name)
        assert "[bold]" not in part


def test_schemas_hold_every_table(pages, tmp_path):
    from weavecell.scenes.impact import Scene

    pages.write(tmp_path)
    schema = json.loads((tmp_path / "scene.schema.json").read_text())
    assert set(schema["properties"]) == set(Scene.model_fields)
    assert schema["$defs"]["ProjectileTable"]["properties"]["mass"]["description"].startswith(
        "mass, with a mean density from 0.5 to 23 g/cm^3"
    )
    assert (tmp_path / "cli.md").exists()
    assert (tmp_path / "coupon.schema.json").exists()


def test_every_page_of_the_folder_is_on_the_site():
    """Sphinx warns of a page that is in no table of contents; this one needs no Sphinx."""
    index, reports = ((ROOT / "docs" / name / "index.md").read_text("utf-8") for name in ("", "reports"))
    listed = set(re.findall(r"^([\w/-]+)$", index, re.MULTILINE))
    listed |= {f"reports/{name}" for name in re.findall(r"^([\w/-]+)$", reports, re.MULTILINE)}
    assert {name.removesuffix(".md") for name in documents()} - {"index", "reports/index"} <= listed


def documents():
    """Names of the pages under docs/, without those that a build writes there."""
    paths = (path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md"))
    return [str(path) for path in paths if path.parts[0] not in ("generated", "_build")]


def anchors(text):
    """Anchors of the headings of a page, as GitHub and MyST make them."""
    heads = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", ["README.md", "CONTRIBUTING.md", *(f"docs/{name}" for name in documents())])
def test_every_link_and_picture_leads_somewhere(page):
    """Sphinx checks the pages of the site; this also README, CONTRIBUTING and pictures, without Sphinx."""
    text = (ROOT / page).read_text("utf-8")
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
        if re.match(r"https?:|mailto:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (ROOT / page).parent / path if path else ROOT / page
        if "generated/" in path:
            continue  # made by the build
        assert file.exists(), (page, target)
        if anchor:
            assert anchor in anchors(file.read_text("utf-8")), (page, target)


def test_every_figure_is_on_a_page():
    pages = ("README.md", *(f"docs/{name}" for name in documents()))
    text = "".join((ROOT / page).read_text("utf-8") for page in pages)
    figures = [path.name for path in sorted((ROOT / "docs").rglob("figures/*"))]
    assert [name for name in figures if f"figures/{name}" not in text] == []
