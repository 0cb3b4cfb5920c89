"""The version is written in several files, once in each; the packaging files name what the package needs."""

import re

import fabrics
from tests.installed.packages import ROOT, SETTINGS


def found(pattern, name):
    return re.findall(pattern, (ROOT / name).read_text("utf-8"), re.MULTILINE)


def test_all_files_have_the_version_of_the_code():
    version = fabrics.__version__
    assert SETTINGS["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "fabrics.__version__"}
    assert found(r'version = "(.*)"', "packaging/conda/meta.yaml")[0] == version
    (released, date), *_ = found(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", "CHANGELOG.md")
    assert released == found(r"^version: (.*)$", "CITATION.cff")[0] == version
    assert date == found(r"^date-released: (.*)$", "CITATION.cff")[0]


def test_the_recipe_needs_what_the_package_needs():
    project, recipe = SETTINGS["project"], (ROOT / "packaging/conda/meta.yaml").read_text("utf-8").lower()
    needed = [*project["dependencies"], *project["optional-dependencies"]["app"]]
    names = [re.match(r"[\w-]+", each)[0].lower() for each in needed]
    assert [name for name in names if f"- {name}" not in recipe] == []
