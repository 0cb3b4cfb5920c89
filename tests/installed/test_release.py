"""The version is written in several files, once in each; the packaging files name what the package needs."""

import re

import yaml

import fabrics
from tests.installed.packages import ROOT, SETTINGS


def found(pattern, name):
    return re.findall(pattern, (ROOT / name).read_text("utf-8"), re.MULTILINE)


def test_all_files_have_the_version_of_the_code():
    version = fabrics.__version__
    assert SETTINGS["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "fabrics.__version__"}
    (released, date), *_ = found(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", "CHANGELOG.md")
    assert released == found(r"^version: (.*)$", "CITATION.cff")[0] == version
    assert date == found(r"^date-released: (.*)$", "CITATION.cff")[0]


def test_the_conda_environment_has_what_the_package_needs():
    """And its entries for pip are lines of a requirements file, which takes no option such as --no-deps."""
    *names, by_pip = yaml.safe_load((ROOT / "environment.yml").read_text("utf-8"))["dependencies"]
    project = SETTINGS["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["app"]]
    assert {re.match(r"[\w-]+", each)[0].lower() for each in needed} <= {
        re.match(r"[\w-]+", each)[0] for each in names
    }
    assert by_pip == {"pip": ["--editable ."]}
