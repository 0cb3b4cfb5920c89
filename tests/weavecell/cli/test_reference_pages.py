"""The reference pages of the site hold every command, every option and every key of a scene."""

import json
import re
import sys
from pathlib import Path

import pytest
import typer

from weavecell.cli.app import app

ROOT = Path(__file__).parents[3]


@pytest.fixture
def pages(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import reference_pages

    yield reference_pages
    sys.modules.pop("reference_pages")


def test_every_command_and_option_is_on_the_page(pages):
    text = pages.cli()
    found = list(pages.commands(typer.main.get_command(app), "weavecell"))
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
        "mass [kg]; a mass above 0"
    )
    assert (tmp_path / "cli.md").exists()
    assert (tmp_path / "coupon.schema.json").exists()


def test_every_page_of_the_folder_is_on_the_site():
    """Sphinx warns of a page that is in no table of contents; this one needs no Sphinx."""
    index = (ROOT / "docs" / "index.md").read_text("utf-8")
    listed = set(re.findall(r"^([\w/-]+)$", index, re.MULTILINE))
    assert {path.stem for path in (ROOT / "docs").glob("*.md")} - {"index"} <= listed
