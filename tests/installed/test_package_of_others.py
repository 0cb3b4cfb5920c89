"""A package of somebody else, in a folder outside the checkout and installed by pip: its fabric, projectile and code
are in the lists, and are shot at, fired and written to like our own."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.installed.packages import ROOT

SETTINGS = """\
[build-system]
requires = ["setuptools"]
build-backend = "setuptools.build_meta"

[project]
name = "acme-weaves"
version = "1.0"

[project.entry-points."weavecell.fabrics"]
acme = "acme_weaves"

[project.entry-points."weavecell.projectiles"]
acme = "acme_weaves.noses"

[project.entry-points."weavecell.decks"]
acme = "acme_weaves.deck"

[tool.setuptools]
packages = ["acme_weaves", "acme_weaves.noses"]

[tool.setuptools.package-data]
"*" = ["*.toml"]
"""
NOSE = """\
shape = "hemisphere"
mass = { value = "1.7 g", source = "scales", status = "measured" }
diameter = "6.2 mm"
edge_radius = "0.3 mm"
"""
DECK = """\
from weavecell.decks.ls_dyna import KEYWORD, LAW
from weavecell.decks.ls_dyna import write as write_ours

NAME = "Acme code"


def names(name):
    return [f"{name}.acme"]


def write(deck, name):
    return {f"{name}.acme": write_ours(deck, name)[f"{name}.k"]}
"""
PROGRAM = """\
import weavecell as wc

print(*wc.fabrics().index.intersection(["S-720", "Acme 930"]))
bullet = wc.projectiles().loc["Acme 1.7 g"]
print(bullet["nose"], bullet["mass [g]"], bullet["metal"])
print("scales" in str(wc.show("Acme 1.7 g")), "930 dtex" in str(wc.show("Acme 930")))
law = {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}
short = {"opening": "20 mm", "end_time": "10 us", "crossovers": "pinned", "law": law}
shot = wc.setup("Acme 930", "150 m/s", projectile="Acme 1.7 g", **short)
print(shot.fabric.name, shot.projectile.shape, shot.projectile.mass)
print(wc.export(shot, "acme", "deck").code)
try:
    wc.export(shot, "acm", "deck")
except wc.InputError as problem:
    print(problem)
"""
EXPECTED = """\
Acme 930 S-720
hemisphere 1.7 rigid
True True
Acme 930 hemisphere 0.0017
Acme code
to = 'acm': must be lsdyna or radioss or acme
"""


@pytest.fixture(scope="module")
def acme(tmp_path_factory):
    """run(program, *arguments, at=folder) beside the package."""
    folder = tmp_path_factory.mktemp("acme")
    package = folder / "source" / "acme_weaves"
    (package / "noses").mkdir(parents=True)
    for module, text in (("__init__", ""), ("noses/__init__", ""), ("deck", DECK)):
        (package / f"{module}.py").write_text(text)
    fabric = ROOT / "tests" / "weavecell" / "own_fabrics" / "twaron-930.toml"
    shutil.copy(fabric, package / "Acme 930.toml")
    (package / "noses" / "Acme 1.7 g.toml").write_text(NOSE)
    (package.parent / "pyproject.toml").write_text(SETTINGS)
    pip = ["pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation"]
    place = folder / "site"
    subprocess.run([sys.executable, "-m", *pip, "--target", place, package.parent], check=True)

    def run(*command, at):
        paths = os.pathsep.join([str(place), str(ROOT)])
        environment = os.environ | {"PYTHONPATH": paths, "OMP_NUM_THREADS": "1"}
        return subprocess.run(
            [sys.executable, *command], cwd=at, env=environment, capture_output=True, text=True
        )

    return run


@pytest.mark.slow(9)
def test_a_package_of_others_is_listed_and_used(acme, tmp_path):
    done = acme("-c", PROGRAM, at=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == EXPECTED
    assert (tmp_path / "deck" / "Acme 930.acme").read_text().startswith("*KEYWORD")
    lists = acme("-m", "weavecell", "fabrics", "list", at=tmp_path)
    assert "Acme 930" in lists.stdout
