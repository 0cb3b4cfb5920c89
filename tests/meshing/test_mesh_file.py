"""Meshes that gmsh made elsewhere: read back, of a changed section, in any numbering, or refused."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.base.errors import InputError
from meshing import crossover, generate
from meshing.generate import Groups, of_script, run_script
from meshing.inputs import YARNS
from meshing.mesh import assemble
from meshing.mesh_file import MeshFile
from meshing.session import gmsh_session

SIZE = (5, 4, 2)


def meshed(script, folder, dimension=3):
    """A .msh file of a script, as a user makes it in gmsh."""
    (folder / "mine.geo").write_text(script)
    path = folder / "my.msh"
    with gmsh_session("mine") as gmsh:
        gmsh.open(str(folder / "mine.geo"))
        gmsh.model.mesh.generate(dimension)
        gmsh.write(str(path))
    return MeshFile.load(path)


def rewritten(script, place, text):
    """The script with the first match of a pattern replaced."""
    found, count = re.subn(place, text, script, count=1)
    assert count == 1
    return found


def test_a_crossover_is_two_boxes_of_twelve_curves():
    """Corners, curves, surfaces and volumes of the geometry; the other points are those of the splines."""
    script = crossover.build(catalogue.load("S-726"), size=SIZE).script
    with gmsh_session("count") as gmsh:
        run_script(gmsh, script)
        count = {dim: len(gmsh.model.getEntities(dim)) for dim in (1, 2, 3)}
        assert count == {1: 2 * 12, 2: 2 * 6, 3: 2}
        if hasattr(gmsh.model.mesh, "getElementQualities"):  # since gmsh 4.9
            (elements,) = gmsh.model.mesh.getElements(3)[1][:1]
            worst = min(gmsh.model.mesh.getElementQualities(elements, "minSICN"))
            assert worst > 0


@pytest.mark.parametrize("name", ["S-720", "S-731"])
def test_the_geometry_handed_out_gives_the_same_crossover(name, tmp_path):
    fabric = catalogue.load(name)
    plain = crossover.build(fabric, size=SIZE)
    read = crossover.build(fabric, size=meshed(plain.script, tmp_path))
    assert_array_equal(read.hexes, plain.hexes)
    assert_allclose(read.points, plain.points, rtol=0, atol=1e-15)  # gmsh writes 16 digits
    assert {key: len(quads) for key, quads in read.faces.items()} == {
        key: len(quads) for key, quads in plain.faces.items()
    }
    for ours, theirs in zip(plain.bar_area, read.bar_area):
        assert theirs == pytest.approx(ours, rel=1e-9)
    # from the nodes alone, where the mesh was asked for by fibre fractions
    assert read.Vf0 == pytest.approx(plain.Vf0, rel=1e-4)
    assert read.shift == pytest.approx(plain.shift, abs=1e-10)


def test_a_section_changed_in_gmsh_is_the_one_that_is_meshed(tmp_path):
    """A warp of another formula and more elements: area, fibre fraction and heights are those of the formula."""
    fabric = catalogue.load("S-720")
    plain = crossover.build(fabric, size=SIZE)
    half = 9.2e-5
    width = plain.sections[0].width
    script = rewritten(
        plain.script, r"q = [^;]*;", f"q = {half} * (1 - 0.93 * (2 * v / {width})^4);"
    )
    script = rewritten(script, r"across = 4;", "across = 7;")
    mine = crossover.build(fabric, size=meshed(script, tmp_path))
    assert mine.grids[0].shape == mine.grids[1].shape == (6, 8, 3)

    def q(v):
        return half * (1 - 0.93 * (2 * v / width) ** 4)

    places = mine.points[mine.grids[0]]
    y = places[0, :, 0, 1]
    assert (places[2, :, -1, 2] - places[2, :, 0, 2]) / 2 == pytest.approx(q(y), rel=1e-4)
    area = 4e6 * quad(lambda v: 1e6 * q(1e-6 * v), 0, 1e6 * y[-1])[0] * 1e-18
    yarn = fabric.weave.yarns[0]
    assert mine.Vf0[0] == pytest.approx(yarn.A_s * (1 + yarn.crimp) / area, rel=2e-3)
    assert mine.Vf0[0] != pytest.approx(plain.Vf0[0], rel=0.02)
    assert mine.Vf0[1] == pytest.approx(plain.Vf0[1], rel=1e-4)


def test_a_script_is_meshed_once_a_process(monkeypatch):
    """Two builds of one crossover, whose arrays are their own, and one of another fabric."""
    of_script.cache_clear()
    scripts = []
    run = generate.run_script

    def counted(gmsh, script):
        scripts.append(script)
        run(gmsh, script)

    monkeypatch.setattr(generate, "run_script", counted)
    first, second = (crossover.build(catalogue.load("S-731"), size=SIZE) for _ in range(2))
    first.points[0] += 1e-3
    assert_allclose(second.points[0], first.points[0] - 1e-3, atol=1e-12)
    crossover.build(catalogue.load("S-728"), size=SIZE)
    assert len(scripts) == 2
    assert scripts[0] == first.script
    with pytest.raises(ValueError, match="read-only"):
        of_script(first.script, "S-731").points[0] = 0.0


def test_places_do_not_depend_on_the_numbers_that_gmsh_gives():
    """Nodes numbered at random, elements in another order and begun at another corner: one mesh."""
    fabric = catalogue.load("S-731")
    plain = crossover.build(fabric, size=SIZE)
    groups = of_script(plain.script, "plain")
    rng = np.random.default_rng(4)
    number = rng.permutation(len(groups.points))
    points = np.empty_like(groups.points)
    points[number] = groups.points
    # turns of a hexahedron about its k axis, and of a facet
    turn = [1, 2, 3, 0, 5, 6, 7, 4]
    hexes = {name: rng.permutation(number[of])[:, turn] for name, of in groups.hexes.items()}
    quads = {
        name: rng.permutation(number[of])[:, [3, 2, 1, 0]] for name, of in groups.quads.items()
    }
    found = assemble(Groups(points, quads, hexes), YARNS, (0, 1), True, fabric.weave)
    assert_array_equal(found["points"], plain.points)
    assert_array_equal(found["hexes"], plain.hexes)
    for name, faces in plain.faces.items():
        assert_array_equal(found["faces"][name], faces)


REFUSED = [
    (r"Transfinite Volume \{[^}]*\};", "", "no hexahedra in a physical volume warp"),
    (
        r'Physical Surface\(StrCat\(name, "_tip"\)\) = high_flank\(\);',
        "",
        "no quadrilaterals in a physical surface warp_tip",
    ),
    (r'name = "weft"', 'name = "fill"', "no hexahedra in a physical volume weft"),
    (
        r"stations\(\) = \{0.0, [\d.e-]+\}",
        "stations() = {0.0, 0.0006}",
        "the warp runs from 0 to 0.6 mm, but the counts of S-720 want 0 to 0.635 mm",
    ),
    (
        r"height\(\) = \{[\d.e-]+",
        "height() = {0.00013",
        "the centreline of the warp rises by 130 um, but the crimp of S-720 gives 120.3 um",
    ),
    (
        r"q = [\d.e-]+",
        "q = 6e-5",
        "gives the fibres a volume fraction of 1.157, which must be up to",
    ),
]


@pytest.mark.parametrize("place, text, line", REFUSED, ids=[line[:30] for *_, line in REFUSED])
def test_one_line_says_what_a_mesh_lacks(place, text, line, tmp_path):
    fabric = catalogue.load("S-720")
    script = rewritten(crossover.build(fabric, size=SIZE).script, place, text)
    with pytest.raises(InputError, match=f"^my.msh: .*{line}"):
        crossover.build(fabric, size=meshed(script, tmp_path))


def test_what_is_no_mesh_of_hexahedra_is_refused(tmp_path):
    """No file, a text, a mesh of the surfaces alone, and an option beside a file."""
    fabric = catalogue.load("S-720")
    with pytest.raises(
        InputError, match=r"mesh = .*none\.msh': must be a mesh file that can be read"
    ):
        MeshFile.load(tmp_path / "none.msh")
    text = MeshFile("notes.msh", b"to be done")
    with pytest.raises(InputError, match=r"notes\.msh: "):
        crossover.build(fabric, size=text)
    script = crossover.build(fabric, size=SIZE).script
    with pytest.raises(InputError, match=r"my\.msh: no hexahedra in a physical volume warp"):
        crossover.build(fabric, size=meshed(script, tmp_path, dimension=2))
    file = meshed(script, tmp_path)
    with pytest.raises(InputError, match="section = 'sine': must be left out if the mesh is read"):
        crossover.build(fabric, size=file, section="sine")
    with pytest.raises(InputError, match="domain = 'whole': must be quarter if the mesh is read"):
        crossover.build(fabric, size=file, domain="whole")
