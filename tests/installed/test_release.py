"""The version is written in several files, once in each; the packaging files name what the package needs."""

import re

import pytest
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


@pytest.mark.parametrize("place", [1, 2], ids=["unreleased", "newest release"])
def test_what_is_new_is_told_in_words_that_a_user_reads(place):
    """What differs from the release before, not how it came to it: a line replaces what it outdates."""
    sections = re.split(r"^## ", (ROOT / "CHANGELOG.md").read_text("utf-8"), flags=re.MULTILINE)
    assert sections[1].startswith("[Unreleased]")
    assert len(sections[place].split()) <= 1500


def test_the_conda_environment_has_what_the_package_needs():
    """And its entries for pip are lines of a requirements file, which takes no option such as --no-deps."""
    *names, by_pip = yaml.safe_load((ROOT / "environment.yml").read_text("utf-8"))["dependencies"]
    project = SETTINGS["project"]
    needed = [*project["dependencies"], *project["optional-dependencies"]["app"]]
    assert {re.match(r"[\w-]+", each)[0].lower() for each in needed} <= {
        re.match(r"[\w-]+", each)[0] for each in names
    }
    assert by_pip == {"pip": ["--editable ."]}


# an impact with pictures and report was run with these together, by Python 3.11 without a screen
RUN = """numpy 1.24.0, scipy 1.10.0, numba 0.60.0, pint 0.23, pydantic 2.5.0, typer 0.13.1, rich 13.0.0, jinja2 3.1.0,
matplotlib 3.6.3, pyvista 0.45.3, vtk 9.4.2, SALib 1.5.0, tomlkit 0.12.0, pandas 2.0.0, tqdm 4.64.0, trimesh 4.4.0,
h5py 3.8.0"""


def test_lower_bounds_are_versions_that_were_run(tool):
    """pandas 1.5 could not be installed beside SALib, typer 0.12 crashed, pyvista 0.43 with a free vtk too."""

    def number(version):
        return tuple(int(part) for part in f"{version}.0.0".split(".")[:3])

    run = dict(entry.split() for entry in RUN.replace("\n", " ").split(", "))
    bounds = dict(line.split("==") for line in tool("lower_bounds").lines())
    assert bounds.keys() == run.keys()
    assert {name for name in run if number(bounds[name]) < number(run[name])} == set()


def test_the_compiler_of_kernels_is_bounded_from_above(tool):
    """shellfabric/jit uses numba's compiler, not only its decorators."""
    assert tool("upper_bounds").bounded() == ["numba"]


def test_the_nightly_job_has_the_lowest_and_the_newest_packages():
    nightly = (ROOT / ".ci/nightly").read_text("utf-8")
    assert "make nightly" in nightly
    makefile = (ROOT / "Makefile").read_text("utf-8")
    (parts,) = re.findall(r"--keep-going --jobs 1 (.*)", makefile)
    assert {
        "test-nightly",
        "fuzz",
        "ledger",
        "printed",
        "docs-again",
        "package",
        "convergence",
    } <= {*parts.split()}
    for kind in ("wheel", "lowest", "newest", "base"):
        assert f"\ttools/package.sh {kind}\n" in makefile
