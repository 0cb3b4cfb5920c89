"""The version is written in several files, once in each; the packaging files name what the package needs."""

import re
import tomllib
from pathlib import Path

import fabrics

ROOT = Path(__file__).parents[2]


def text(name):
    return (ROOT / name).read_text("utf-8")


def test_all_files_have_the_version_of_the_code():
    version = fabrics.__version__
    assert tomllib.loads(text("pyproject.toml"))["tool"]["setuptools"]["dynamic"]["version"] == {
        "attr": "fabrics.__version__"
    }
    assert re.search(r"^version: (.*)$", text("CITATION.cff"), re.MULTILINE)[1] == version
    assert f'version = "{version}"' in text("packaging/conda/meta.yaml")
    released = re.findall(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", text("CHANGELOG.md"), re.MULTILINE)
    assert released[0][0] == version
    assert re.search(r"^date-released: (.*)$", text("CITATION.cff"), re.MULTILINE)[1] == released[0][1]


def test_the_recipe_needs_what_the_package_needs():
    project = tomllib.loads(text("pyproject.toml"))["project"]
    recipe = text("packaging/conda/meta.yaml").lower()
    needed = [*project["dependencies"], *project["optional-dependencies"]["app"]]
    names = [re.match(r"[\w-]+", each)[0].lower() for each in needed]
    assert [name for name in names if f"- {name}" not in recipe] == []
    assert all("UNTESTED" in text(f"packaging/{name}") for name in ("Dockerfile", "conda/meta.yaml"))
