"""A package of somebody else, in a folder outside the checkout and installed by pip: its fabric, projectile, part and
code are in the lists, and are shot at, fired, computed and written to like our own."""

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

[project.entry-points."weavecell.parts"]
foundation = "acme_weaves.foundation:Foundation"

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
PART = """\
from shellfabric.jit.table import Row, number
from shellfabric.parts import Part
from shellfabric.state import unit


class FoundationRow(Row):
    stiffness = number("N/m3", "pressure of the foundation over its deflection")


@unit("number", own=FoundationRow)
def foundation_forces(state, const, own, first, last, acting):
    energy = 0.0
    spring = own.stiffness * const.dx * const.dy
    for k in range(first * const.row_stride, (last + 1) * const.row_stride):
        energy += 0.5 * spring * state.u[2][k] ** 2
        if acting:
            state.f_int[2][k] -= spring * state.u[2][k]
    return energy


class Foundation(Part):
    keys = {"stiffness": "N/m^3"}
    name = energy = "part_foundation"
    forces = foundation_forces

    def __init__(self, panel, stiffness):
        self.row = FoundationRow(stiffness=stiffness)
        self.stiffness = 0.25 * stiffness / panel.weave.areal_density
"""
FIRED = """\
import weavecell as wc

short = {"opening": "30 mm", "end_time": "20 us"}
part = {"foundation": {"stiffness": "2e10 N/m^3"}}
plain = wc.impact("S-720", "60 m/s", crossovers="pinned", **short)
shot = wc.impact("S-720", "60 m/s", parts=part, out="shot", **short)
stored = shot.energies["part_foundation"]
print(shot.target.setup.crossovers, wc.load("shot").energies["part_foundation"][-1] == stored[-1])
print(stored[-1] > 0.01 * shot.strike_energy, shot.energy_error_max < 2e-3)
print(shot.velocity[-1] < plain.velocity[-1])
print(shot.target.setup.frame_in_words[-1])
for parts, more in (
    ({"foundation": {"stiffness": "2e10 N/m^2"}}, {}),
    ({"foundation": {}}, {}),
    ({"fundation": {"stiffness": "2e10 N/m^3"}}, {}),
    (part, {"crossovers": "yarns"}),
):
    try:
        wc.setup("S-720", "60 m/s", parts=parts, **more, **short)
    except wc.InputError as problem:
        print(problem)
"""
SAID = """\
None True
True True
True
Each ply has the part foundation of an installed package, stiffness 2e+10 N/m^3.
parts.foundation.stiffness = '2e10 N/m^2': must be a text with a unit that converts to N/m^3, such as "1 N/m^3"
parts.foundation = {}: must be a table with stiffness
parts.fundation = 'fundation': unknown part, did you mean "foundation"? allowed: foundation
parts: must be left out with resolved yarns
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
    for module, text in (
        ("__init__", ""),
        ("noses/__init__", ""),
        ("deck", DECK),
        ("foundation", PART),
    ):
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


@pytest.mark.slow(20)
def test_a_part_of_others_acts_in_a_shot(acme, tmp_path):
    """Its kernel compiles its own file alone."""
    done = acme("-c", FIRED, at=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == SAID
