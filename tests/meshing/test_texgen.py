"""TexGen files as plain weaves: geometry against what TexGen was asked for, other weaves and broken files refused."""

import importlib.util
import json
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import quad

from fabrics import assumed, catalogue
from fabrics.errors import InputError
from meshing import crossover
from meshing.texgen.comparison import compare, shape_deviation
from meshing.texgen.geometry import WeaveGeometry
from weavecell.commands.mesh import build

if importlib.util.find_spec("pytexgen") is None:
    pytest.skip("TexGen is not installed", allow_module_level=True)

# in a process of its own: TexGen crashes one that has loaded the rest. X yarns of its weave run along x.
MAKE = """
import json, math, sys
import pytexgen as texgen
given = json.load(sys.stdin)
n = given["yarns"]
weave = texgen.CTextileWeave2D(n, n, 1.0, given["thickness"], given["refine"], False)
weave.SetGeometryScale(given["unit"])
for i in range(n):
    for axis, key in (("X", "warp"), ("Y", "weft")):
        spacing, width, height, _ = given[key]
        getattr(weave, f"Set{axis}YarnSpacings")(i, spacing)
        getattr(weave, f"Set{axis}YarnWidths")(i, width)
        getattr(weave, f"Set{axis}YarnHeights")(i, height)
    weave.SwapPosition(i, i)
for i in range(2 * n):
    _, width, height, shape = given["warp" if i < n else "weft"]
    if shape == "lens":
        section = texgen.CSectionLenticular(width, height)
    elif shape != "ellipse":
        section = texgen.CSectionPowerEllipse(width, height, shape)
    if shape != "ellipse":
        weave.GetYarn(i).AssignSection(texgen.CYarnSectionConstant(section))
if given["fibres"]:
    weave.SetYarnLinearDensity(600.0, "g/km")
    weave.SetFibreDensity(1.44, "g/cm^3")
texgen.AddTextile("weave", weave)
if given["turn"]:
    x, y, z, angle = given["turn"]
    texgen.GetTextile("weave").Rotate(texgen.WXYZ(texgen.XYZ(x, y, z), math.radians(angle)))
if given["lost"]:
    texgen.GetTextile("weave").GetYarn(0).ClearRepeats()
texgen.SaveToXML(given["file"], "weave", getattr(texgen, "OUTPUT_" + given["output"]))
"""
BALANCED = {"warp": (1.0, 0.8, 0.15, "ellipse"), "weft": (1.0, 0.8, 0.15, "ellipse"), "thickness": 0.3}
UNBALANCED = {"warp": (1.0, 0.8, 0.15, "lens"), "weft": (1.2, 0.9, 0.2, 0.6), "thickness": 0.35}
REST = """key,warp,weft
linear_density,600 dtex,700 dtex
fibre_density,1.44 g/cm^3,
modulus,90 GPa,
failure_strain,3 %,
"""


def make(path, cell, **options):
    given = {"yarns": 2, "unit": "mm", "refine": False, "turn": None, "fibres": False, "output": "STANDARD",
             "lost": False, "file": str(path), **cell, **options}  # fmt: skip
    subprocess.run([sys.executable, "-c", MAKE], input=json.dumps(given), capture_output=True, text=True, check=True)
    return path


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("texgen")
    return {
        "balanced": make(folder / "balanced.tg3", BALANCED),
        "unbalanced": make(folder / "unbalanced.tg3", UNBALANCED),
        "twill": make(folder / "twill.tg3", BALANCED, yarns=3),
    }


def area(width, height, shape):
    """Closed forms: ellipse; lens of two arcs; x = W/2 cos t, z = h/2 sin^n t of the power ellipse."""
    if shape == "ellipse":
        return np.pi / 4 * width * height
    if shape == "lens":
        radius = (width**2 + height**2) / (4 * height)
        angle = 2 * np.arcsin(width / (2 * radius))
        return radius**2 * (angle - np.sin(angle))
    return quad(lambda x: height * (1 - (2 * x / width) ** 2) ** (shape / 2), -width / 2, width / 2)[0]


def check(weave, cell, unit=1e-3):
    """Spacing, section and height of the path are those that TexGen was given."""
    for f, (yarn, key) in enumerate(zip(weave.yarns, ("warp", "weft"))):
        spacing, width, height, shape = cell[key]
        across = cell[("weft", "warp")[f]][0]
        assert [yarn.spacing, yarn.cell] == pytest.approx([unit * spacing, unit * across])
        assert [yarn.width, yarn.thickness] == pytest.approx([unit * width, unit * height], rel=1e-3)
        assert yarn.area == pytest.approx(unit**2 * area(width, height, shape), rel=2e-3)
        assert yarn.amplitude == pytest.approx(unit * cell["thickness"] / 4, rel=1e-6)
        slope = np.pi * yarn.amplitude / yarn.cell  # of a sinusoid, whose crimp is slope^2 / 4 of order two
        assert yarn.crimp == pytest.approx(slope**2 / 4, rel=0.06)


@pytest.mark.parametrize(("name", "cell"), [("balanced", BALANCED), ("unbalanced", UNBALANCED)])
def test_the_geometry_is_what_texgen_was_given(files, name, cell):
    weave = WeaveGeometry.read(files[name])
    check(weave, cell)
    assert weave.name == f"{name}.tg3"
    heights = [cell["thickness"] / 2 + cell[key][2] for key in ("warp", "weft")]
    assert weave.thickness == pytest.approx(1e-3 * max(heights), rel=1e-3)
    assert weave.yarns[0].linear_density is None


@pytest.mark.parametrize("turn", [(0, 0, 1, 30), (0, 0, 1, -40), (1, 0, 0, 90), (0, 1, 0, 20), (0, 0, 1, 180)])
def test_turned_axes_and_other_units_change_nothing(tmp_path, turn):
    check(WeaveGeometry.read(make(tmp_path / "a.tg3", UNBALANCED, turn=turn, unit="um")), UNBALANCED, unit=1e-6)


def test_turned_by_a_right_angle_warp_and_weft_are_exchanged(tmp_path):
    weave = WeaveGeometry.read(make(tmp_path / "a.tg3", UNBALANCED, turn=(0, 0, 1, 90)))
    check(weave, {**UNBALANCED, "warp": UNBALANCED["weft"], "weft": UNBALANCED["warp"]})


def test_fibres_of_the_file_and_a_file_of_parameters_alone(tmp_path):
    weave = WeaveGeometry.read(make(tmp_path / "a.tg3", BALANCED, fibres=True, output="MINIMAL", yarns=2))
    check(weave, BALANCED)
    assert weave.yarns[1].linear_density == pytest.approx(600e-6)
    assert weave.yarns[1].fibre_density == pytest.approx(1440)


def test_four_by_four_yarns_are_the_same_weave(tmp_path):
    """A larger cell, whose yarns cross by turns: the pattern of the small one, four times."""
    path = tmp_path / "a.tg3"
    script = MAKE.replace(
        "    weave.SwapPosition(i, i)\n", "    [weave.SwapPosition(i, j) for j in range(i % 2, n, 2)]\n"
    )
    given = {"yarns": 4, "unit": "mm", "refine": False, "turn": None, "fibres": False, "output": "STANDARD",
             "lost": False, "file": str(path), **UNBALANCED}  # fmt: skip
    subprocess.run([sys.executable, "-c", script], input=json.dumps(given), capture_output=True, text=True, check=True)
    check(WeaveGeometry.read(path), UNBALANCED)


def refused(path, *words):
    with pytest.raises(InputError) as problem:
        WeaveGeometry.read(path)
    text = str(problem.value)
    assert text.startswith(f"{path}: ")
    assert len(text.splitlines()) == 1
    for word in words:
        assert word in text
    return problem.value


def test_a_twill_is_refused(files):
    found = refused(
        files["twill"], "do not pass over and under each other by turns", "must be one unit cell of a plain"
    )
    assert found.key == "weave"


def test_other_textiles_are_refused(tmp_path, files):
    """The balanced cell with one yarn that does not repeat, is moved, narrower or turned, and without its weft."""
    refused(make(tmp_path / "a.tg3", BALANCED, lost=True), "do not repeat together along and across")
    head, *yarns = files["balanced"].read_text().split("<Yarn ")
    end = yarns[3].partition("</Yarn>")[2]
    for change, words in (
        (('Position="1.000000000000e+00, 0.000000000000e+00', 'Position="1.0, 0.3'), "a yarn is not straight"),
        (('value="0.000000000000e+00, 2.0', 'value="0.000000000000e+00, 2.5'), "do not repeat together"),
        (('Width="8', 'Width="7'), "two yarns of one direction differ in width, 0.7 and 0.8 mm"),
        (('Position="2.0', 'Position="2.5'), "a yarn does not end where it repeats"),
    ):  # fmt: skip
        changed = yarns[0].replace(*change, 1)
        assert changed != yarns[0], change
        (tmp_path / "b.tg3").write_text("<Yarn ".join([head, changed, *yarns[1:]]))
        refused(tmp_path / "b.tg3", words)
    (tmp_path / "c.tg3").write_text("<Yarn ".join([head, *yarns[:2]]) + end)
    refused(tmp_path / "c.tg3", "do not run in two directions at right angles")


@pytest.mark.parametrize("content", [
    b"", b"garbage", bytes(range(256)), b'<?xml version="1.0"?><a/>',
    b'<?xml version="1.0"?><TexGenModel version="3.14.0"></TexGenModel>',
])  # fmt: skip
def test_garbage_is_refused(tmp_path, content):
    (tmp_path / "a.tg3").write_bytes(content)
    refused(tmp_path / "a.tg3", "must be a TexGen file (.tg3) of one textile")


def test_a_file_that_crashes_texgen_is_refused(files, tmp_path):
    text = files["balanced"].read_text()
    (tmp_path / "a.tg3").write_text(text.replace('Position="', 'Position="x'))
    refused(tmp_path / "a.tg3", "TexGen cannot read it")
    (tmp_path / "b.tg3").write_text(text.replace('GeometryScale="mm"', 'GeometryScale="ells"'))
    refused(tmp_path / "b.tg3", "GeometryScale = '1 ells'")
    refused(tmp_path / "none.tg3", "cannot be read")


def test_without_pytexgen_the_message_says_what_to_install(files, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    refused(files["balanced"], "pip install weavecell[texgen]")


def test_commands_make_a_fabric_its_mesh_and_the_comparison(files, tmp_path, command):
    (tmp_path / "rest.csv").write_text(REST)
    path = files["unbalanced"]
    code, out, err = command("fabrics", "new", "mine.toml", "--texgen", path, "--from", "rest.csv")
    assert code == 0, err
    fabric, weave = catalogue.load(tmp_path / "mine.toml"), WeaveGeometry.read(path)
    assert "assumed: crimp" not in out
    assert fabric.sources["weft.crimp"]["source"] == "TexGen file unbalanced.tg3"
    assert fabric.weave.warp_count == pytest.approx(1000)
    assert fabric.weave.weft_count == pytest.approx(1 / 1.2e-3, rel=1e-5)
    assert fabric.yarn_width == pytest.approx((0.8e-3, 0.9e-3), rel=1e-3)
    laws = assumed.with_solid_laws(fabric).solid_laws
    fractions = [yarn.A_s / drawn.area for yarn, drawn in zip(fabric.weave.yarns, weave.yarns)]
    assert [law.Vf0 for law in laws] == pytest.approx(fractions, rel=1e-5)

    code, out, err = command("mesh", "mine.toml", "--mesh", "coarse", "--texgen", path, "--format", "vtu", "--out", "m")
    assert code == 0, err
    compared = json.loads((tmp_path / "m" / "mesh.json").read_text())["texgen"]
    assert compared["file"] == "unbalanced.tg3"
    for family, drawn in zip(("warp", "weft"), weave.yarns):
        found = compared[family]
        assert found["section_area_m2"]["texgen"] == pytest.approx(drawn.area)
        assert abs(found["crimp"]["deviation"]) < 1e-4
        assert abs(found["path_amplitude_m"]["deviation"]) < 0.02
        assert 0 < found["path_rms_over_thickness"] < 0.01
        assert found["section_width_m"]["mesh"] < found["section_width_m"]["texgen"]  # tips are cut
    assert "warp, section area, mm²" in out
    assert "path, rms distance over yarn height" in out

    code, out, err = command("mesh", "S-720", "--mesh", "coarse", "--texgen", path, "--out", "other")
    assert code == 2
    assert "unbalanced.tg3: a crossover is 1.2 mm long along the warp, of S-720 1.27 mm" in err
    assert not (tmp_path / "other").exists()


def test_a_twill_makes_no_fabric_file(files, tmp_path, command):
    (tmp_path / "rest.csv").write_text(REST)
    code, out, err = command("fabrics", "new", "mine.toml", "--texgen", files["twill"], "--from", "rest.csv")
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert not (tmp_path / "mine.toml").exists()


def test_values_of_the_user_replace_those_of_texgen_and_what_is_missing_is_reported(files, tmp_path, command):
    (tmp_path / "rest.csv").write_text(REST + "crimp,2 %,1.5 %\n")
    assert command("fabrics", "new", "a.toml", "--texgen", files["unbalanced"], "--from", "rest.csv")[0] == 0
    assert catalogue.load(tmp_path / "a.toml").weave.warp.crimp == pytest.approx(0.02)
    (tmp_path / "rest.csv").write_text(REST.replace("modulus,90 GPa,\n", ""))
    code, _, err = command("fabrics", "new", "b.toml", "--texgen", files["unbalanced"], "--from", "rest.csv")
    assert (code, err) == (2, 'error: rest.csv: modulus: is missing; must be such as "90 GPa"\n')


def test_a_section_too_small_for_its_fibres_is_refused(files, tmp_path, command):
    (tmp_path / "rest.csv").write_text(REST.replace("600 dtex", "1200 dtex"))
    code, _, err = command("fabrics", "new", "a.toml", "--texgen", files["unbalanced"], "--from", "rest.csv")
    assert code == 2
    assert "a.toml: warp.section_area = '0.0805" in err
    assert "must be at least 0.09189 mm^2" in err


def test_our_own_crossover_drawn_in_texgen_has_no_deviation():
    """The comparison itself: outline and path of the mesh, given as if they were TexGen's."""
    from meshing.texgen.geometry import YarnGeometry

    mesh = crossover.build(catalogue.load("S-720"), size="coarse")
    yarns = []
    for f in (0, 1):
        y = mesh.sections[f].stations(200)
        across = np.concatenate([-y[:0:-1], y])
        upper = mesh.sections[f].half_thickness(across)
        outline = np.concatenate([np.column_stack([across, -upper]), np.column_stack([across, upper])[::-1]])
        x = np.linspace(-2 * mesh.w[f], 2 * mesh.w[f], 401)
        path = np.column_stack([x, mesh.h0[f] * np.cos(np.pi * x / (2 * mesh.w[f]))])
        yarns.append(YarnGeometry(2 * mesh.w[1 - f], 2 * mesh.w[f], path, np.roll(outline, 77, axis=0), None, None))
        assert shape_deviation(yarns[f].outline * [1, 1.1], mesh.sections[f]) == pytest.approx(1 - 1 / 1.1, rel=1e-3)
    for found in compare(WeaveGeometry("own", tuple(yarns), 1.0), mesh).values():
        offs = [value["deviation"] if isinstance(value, dict) else value for value in found.values()]
        assert offs == pytest.approx([0] * 7, abs=2e-3)


def test_the_width_of_the_yarns_is_that_of_the_sections(tmp_path):
    """Without gap and width a mesh has the fabric's widths; a gap replaces them."""
    from dataclasses import replace

    fabric = replace(catalogue.load("S-728"), yarn_width=(1.3e-3, None), section="sine")
    found = [build(fabric, size="coarse", **more).section_fit.requested for more in ({}, {"gap": 1e-4})]
    spacing = [2 * w for w in fabric.weave.w][::-1]
    assert [section.width for section in found[0]] == pytest.approx([1.3e-3, spacing[1]])
    assert [section.width for section in found[1]] == pytest.approx([s - 1e-4 for s in spacing])
