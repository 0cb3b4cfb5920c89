"""Input files of other solvers, read back: LS-DYNA by dynakw, Abaqus by meshio, OpenRadioss by columns.

No reader of OpenRadioss files is packaged; the test reads its fixed columns itself, strictly. dynakw knows no bars and
no titles of sets: they are read in the same way.
"""

import re
from itertools import chain
from types import SimpleNamespace

import meshio
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fabrics import catalogue
from meshing import patch
from tests import unlike
from tests.meshing.hexahedra import vector_areas, volumes
from tests.weavecell.decks.deck_readers import blocks, columns
from weavecell.decks import mesh_deck, mesh_files
from weavecell.decks.linear_material import linearise
from weavecell.decks.mesh_abaqus import SIDES


def check_elements(mesh, read):
    """What a file holds, by number from 1, against the mesh, in its order.

    points : (n, 3); hexes : (e, 8); parts : names of the hexahedra's yarns; shells : (q, 4)
    bars : {number: (nodes, area)}; bar_sets : {name: numbers}
    """
    assert_allclose(read.points, mesh.points, rtol=1e-9, atol=1e-18)
    assert_array_equal(read.hexes, mesh.hexes + 1)
    assert read.parts == list(np.array(mesh.names)[mesh.yarn])
    shells = np.ravel([*chain(*mesh.shells.values())]) + 1
    assert_array_equal(np.ravel(read.shells), shells)
    pairs = np.concatenate(mesh.bars) + 1
    areas = np.concatenate(mesh.bar_area)
    numbers = sorted(read.bars)
    assert numbers == list(range(len(mesh.hexes) + 1, len(mesh.hexes) + 1 + len(pairs)))
    nodes, area = zip(*map(read.bars.get, numbers))
    assert_array_equal(nodes, pairs)
    assert area == pytest.approx(areas, rel=6e-5)
    for name, bars in zip(mesh.names, mesh.bars):
        nodes, _ = zip(*map(read.bars.get, read.bar_sets[f"{name}_fibre"]))
        assert_array_equal(nodes, bars + 1)


def test_parts_of_bars_are_of_yarns_of_their_own_family():
    """By the name of the part, on a patch of unlike yarns; each bar once."""
    mesh = patch.build(catalogue.load("S-726"), (2, 3), size=(2, 2, 1))
    made = mesh_deck.deck(mesh, catalogue.load("S-726"))
    own = {family: set() for family in (0, 1)}
    for family, pairs in zip(mesh.families, mesh.bars):
        own[family] |= set(map(tuple, pairs + 1))
    bars = made.select_parts("bar")
    for part in bars:
        family = ("warp", "weft").index(part.name.partition("_")[0])
        assert part.family == family
        assert set(map(tuple, part.nodes)) <= own[family]
    assert sum(len(part.nodes) for part in bars) == sum(map(len, own.values()))


def check_sets(mesh, sets, unions):
    """Nodes (k,) or quadrilaterals (q, 4) by name, from 1, and the names in unions of them, against the mesh."""
    assert set(sets) == set(mesh.faces)
    for name, found in sets.items():
        assert np.array_equal(found, mesh.groups[name] + 1), name
    assert unions == {
        name: found for name, found in mesh.collected.items() if name not in mesh.faces
    }


def materials(mesh):
    return linearise(catalogue.load(mesh.fabric), mesh.Vf0)


def written(mesh, path):
    mesh_files.write(mesh, catalogue.load(mesh.fabric), path)
    text = path.read_text(encoding="ascii")
    assert any("Units: m, kg, s, N, Pa" in line for line in text.splitlines()[:8])
    return text


def integers(line, width=10):
    return list(map(int, columns(line, [width] * (len(line) // width))))


def members(lines):
    return list(chain(*map(integers, lines)))


def dyna_elements(path):
    """Points, hexahedra, shells, and the names of their parts, as dynakw reads them."""
    dynakw = pytest.importorskip("dynakw")
    names = {}
    found = {}
    with dynakw.DynaKeywordReader(str(path)) as reader:
        for keyword in reader.keywords():
            found[keyword.full_keyword] = cards = keyword.cards
            if keyword.full_keyword == "*PART":
                names[int(cards["Card 2"]["PID"][0])] = cards["Card 1"]["HEADING"][0].strip()
    nodes = found["*NODE"]["Card 1"]
    solids = found["*ELEMENT_SOLID"]
    assert_array_equal(nodes["NID"], np.arange(len(nodes["NID"])) + 1)
    corners = []
    shells = found.get("*ELEMENT_SHELL", {}).get("Card 1", {"PID": []})
    if len(shells["PID"]):
        corners = np.stack([shells[f"N{i}"] for i in range(1, 5)], axis=1)
    return SimpleNamespace(
        points=np.stack([nodes[k] for k in "XYZ"], axis=1),
        hexes=np.stack([solids["nodes"][f"N{i}"] for i in range(1, 9)], axis=1),
        shells=corners,
        parts=list(map(names.get, solids["Card 1"]["PID"])),
        shell_parts=list(map(names.get, shells["PID"])),
    )


def test_dyna_is_read_back(mesh, tmp_path):
    found = blocks(written(mesh, tmp_path / "a.k").splitlines(), "*", "$")
    assert found[0][0] == "*KEYWORD"
    assert found[-1][0] == "*END"
    read = dyna_elements(tmp_path / "a.k")
    areas = {}
    section = {}
    numbers = {}
    bars = {}
    read.bar_sets = {}
    sets = {}
    unions = {}
    for header, lines in found:
        if header == "*SECTION_BEAM":
            number, form = integers(lines[0])
            assert form == 3
            areas[number] = columns(lines[1], [10])[0]
        elif header == "*PART":
            part, section[part], _ = integers(lines[1])
        elif header.startswith("*SET_"):
            kind = header.split("_")[1]
            name = lines[0]
            rest = members(lines[2:])
            numbers[kind, integers(lines[1])[0]] = name
            if "_ADD" in header:
                unions[name] = tuple(numbers[kind, number] for number in rest)
            elif kind == "BEAM":
                read.bar_sets[name] = rest
            else:
                sets[name] = np.reshape(rest, (-1, 4)) if kind == "SEGMENT" else rest
        elif header == "*ELEMENT_BEAM":
            for line in lines:
                number, part, *nodes = integers(line, 8)
                bars[number] = nodes, part
    read.bars = {number: (nodes, areas[section[part]]) for number, (nodes, part) in bars.items()}
    check_elements(mesh, read)
    check_sets(mesh, sets, unions)
    assert read.shell_parts == [
        f"{name}_shell" for name, quads in mesh.shells.items() for _ in quads
    ]
    solids = [lines for header, lines in found if "ORTHOTROPIC" in header]
    for lines, name, material, number in zip(
        solids, ("warp", "weft"), materials(mesh), (1, 4), strict=True
    ):
        expected = [number, material.solid_density, material.axial, *[material.transverse] * 2]
        assert columns(lines[1], [10] * 8)[:5] == pytest.approx(expected, rel=1e-4)
        assert columns(lines[2], [10] * 4)[:3] == pytest.approx([material.shear] * 3, rel=1e-4)
        # AOPT 0: axes of the element
        assert lines[0] == name
        assert columns(lines[2], [10] * 4)[3] == 0


def test_the_first_edge_of_an_element_is_its_fibre(mesh):
    """Which LS-DYNA (AOPT 0) and OpenRadioss (Ip 20) take for its axis."""
    edge = mesh.points[mesh.hexes[:, 1]] - mesh.points[mesh.hexes[:, 0]]
    # the nodes are where gmsh measures them to be, within 1e-11 of an edge
    assert_allclose(
        edge / np.linalg.norm(edge, axis=1, keepdims=True), mesh.fibre, rtol=0, atol=1e-10
    )


def abaqus_elements(path):
    """Points, hexahedra with the names of their parts, and shells, as meshio reads them; and its sets of nodes."""
    found = meshio.read(path)
    hexes = []
    shells = []
    parts = []
    for number, block in enumerate(found.cells):
        if block.type == "hexahedron":  # of one yarn, which is the one set that it is in
            (name,) = (name for name, members in found.cell_sets.items() if len(members[number]))
            hexes.append(block.data + 1)
            parts += [name] * len(block.data)
        elif block.type == "quad":
            shells.extend(block.data + 1)
    elements = SimpleNamespace(
        points=found.points, hexes=np.concatenate(hexes), shells=shells, parts=parts
    )
    return elements, found.point_sets


def test_abaqus_is_read_back(mesh, tmp_path):
    found = blocks(written(mesh, tmp_path / "a.inp").splitlines(), "*", "**")
    read, node_sets = abaqus_elements(tmp_path / "a.inp")
    bars = {}
    areas = {}
    axes = {}
    sides = {}
    read.bar_sets = {}
    for header, lines in found:
        name = header.split("=")[-1]
        fields = [line.rstrip(",").split(",") for line in lines]
        if header != "*HEADING":
            assert max(map(len, chain(*fields)), default=0) <= 20
        if header.startswith("*ELEMENT, TYPE=T3D2"):
            for number, *ends in np.array(fields, int):
                bars[number] = ends, name
        elif header.startswith("*SOLID SECTION") and lines:
            areas[re.search(r"ELSET=([^,]+)", header)[1]] = float(fields[0][0])
        elif header.startswith("*ELSET"):
            read.bar_sets[name] = list(map(int, chain(*fields)))
        elif header.startswith("*DISTRIBUTION,"):
            axes = {int(number): numbers for number, *numbers in fields[1:]}
        elif header.startswith("*SURFACE"):
            element, side = (np.array([(int(a), int(b[1:])) for a, b in fields]) - 1).T
            sides[name] = mesh.hexes[element[:, None], SIDES[side]]
    read.bars = {number: (nodes, areas[part]) for number, (nodes, part) in bars.items()}
    check_elements(mesh, read)
    surfaces = {name: quads for name, quads in mesh.groups.items() if quads.ndim == 2}
    assert set(sides) == set(surfaces)
    for name, quads in surfaces.items():
        assert np.array_equal(np.sort(sides[name]), np.sort(quads)), name
        # C3D8 lists the nodes of a side as seen from inside the element; so it is the right element's side.
        inward = vector_areas(mesh.points[sides[name]])
        assert_allclose(inward, -vector_areas(mesh.points[quads]), rtol=1e-9, atol=1e-20)
    for name in set(mesh.groups) - set(surfaces):
        assert np.array_equal(np.unique(node_sets[name]), mesh.groups[name]), name
    axes = np.array([*map(axes.get, range(1, len(mesh.hexes) + 1))], float)
    assert_allclose(axes[:, :3], mesh.fibre, rtol=0, atol=1e-9)
    assert np.linalg.norm(np.cross(axes[:, :3], axes[:, 3:]), axis=1).min() > 0.5


def radioss(text):
    """keyword -> {number: lines}; for elements number is the part. The order of the file is kept."""
    assert text.startswith("#RADIOSS STARTER\n")
    found = {}
    for header, lines in blocks(text[text.index("/BEGIN") :].splitlines(), "/", "#"):
        *keyword, last = header[1:].split("/")
        if last.isdigit():
            found.setdefault("/".join(keyword), {})[int(last)] = lines
        else:
            found["/".join([*keyword, last])] = lines
    assert list(found)[-1] == "END"
    return found


def elements(found, keyword):
    """{number: (nodes, part)}"""
    read = {}
    for part, lines in found.get(keyword, {}).items():
        for line in lines:
            number, *nodes = integers(line)
            read[number] = nodes, part
    return read


def test_radioss_is_read_back(mesh, tmp_path):
    found = radioss(written(mesh, tmp_path / "a_0000.rad"))
    assert [line.split() for line in found["BEGIN"][2:]] == [["kg", "m", "s"]] * 2
    nodes = np.array([columns(line, [10, 20, 20, 20]) for line in found["NODE"]])
    assert_array_equal(nodes[:, 0], np.arange(len(nodes)) + 1)
    part = {number: (lines[0], *integers(lines[1])) for number, lines in found["PART"].items()}
    area = {number: columns(lines[1], [20, 20])[0] for number, lines in found["PROP/TYPE2"].items()}
    bricks = elements(found, "BRICK")
    bars = elements(found, "TRUSS")
    shells = elements(found, "SHELL")
    hexes, of = zip(*map(bricks.get, sorted(bricks)))
    read = SimpleNamespace(
        points=nodes[:, 1:], hexes=hexes, shells=[quad for quad, _ in shells.values()]
    )
    read.parts = [part[number][0] for number in of]
    read.bars = {number: (pair, area[part[p][1]]) for number, (pair, p) in bars.items()}
    read.bar_sets = {lines[0]: members(lines[1:]) for lines in found["GRTRUS/TRUS"].values()}
    check_elements(mesh, read)
    sets = {lines[0]: members(lines[1:]) for lines in found["GRNOD/NODE"].values()}
    sets |= {
        lines[0]: [integers(line)[1:] for line in lines[1:]] for lines in found["SURF/SEG"].values()
    }
    unions = {}
    for union, kind in (("GRNOD/GRNOD", "GRNOD/NODE"), ("SURF/SURF", "SURF/SEG")):
        for name, *lines in found.get(union, {}).values():
            unions[name] = tuple(found[kind][number][0] for number in members(lines))
    check_sets(mesh, sets, unions)
    # orthotropic solids on the element's edge 1-2 (Ip 20), fully integrated (Isolid 17); every part has its own
    solid = found["PROP/TYPE6"][1]
    assert integers(solid[1])[0] == 17
    assert columns(solid[3], [20, 20, 20, 10, 10, 10])[4] == 20
    thickness = {
        columns(lines[3], [10, 10, 20])[2] for lines in found.get("PROP/TYPE1", {}).values()
    }
    assert thickness == ({2e-5} if mesh.shells else set())
    laws = {**found["MAT/LAW12"], **found["MAT/LAW1"]}
    properties = {**found["PROP/TYPE6"], **found["PROP/TYPE2"], **found.get("PROP/TYPE1", {})}
    for name, prop, material in part.values():
        assert prop in properties
        assert name.startswith(laws[material][0].split()[0])
    for material, number in zip(materials(mesh), (1, 4)):
        density, moduli, _, shear = (
            columns(line, [20] * (len(line) // 20)) for line in laws[number][1:5]
        )
        expected = [
            material.solid_density,
            material.axial,
            *[material.transverse] * 2,
            *[material.shear] * 3,
        ]
        assert [*density, *moduli, *shear] == pytest.approx(expected, rel=1e-12)
        assert len(laws[number]) == 11


def test_materials_at_rest_are_those_of_their_own_family():
    """By hand from the numbers of an unlike warp and weft: eqs. 3-2 and 3-10, half of the mass in the bars."""
    fabric = unlike.fabric()
    fibre = [yarn.fibre_density for yarn in fabric.weave.yarns]
    warp, weft = linearise(fabric, (0.72, 0.61))
    assert (warp.fibre, weft.fibre) == pytest.approx((96e9, 79.68e9))
    assert (warp.axial, weft.axial) == pytest.approx((0.72e6, 0.61e6))
    assert (warp.transverse, weft.transverse) == pytest.approx((1.8e9, 1.24e9))
    assert (warp.shear, weft.shear) == pytest.approx((0.7e9, 0.43e9))
    assert (warp.packed, weft.packed) == pytest.approx((2e9, 2e9))
    assert (warp.failure_strain, weft.failure_strain) == pytest.approx((0.03, 0.0393))
    assert warp.bar_density == pytest.approx(0.5 * fibre[0])
    assert weft.solid_density == pytest.approx(0.5 * 0.61 * fibre[1])


def test_bars_and_solids_together_have_the_mass_of_the_yarns():
    fabric = catalogue.load("S-731")
    mesh = patch.build(fabric, (2, 2), size=(16, 12, 2))
    volume = volumes(mesh.points, mesh.hexes)
    for number, family in enumerate(mesh.families):
        material = materials(mesh)[family]
        lengths = np.linalg.norm(np.diff(mesh.points[mesh.bars[number]], axis=1)[:, 0], axis=1)
        mass = material.bar_density * (lengths * mesh.bar_area[number]).sum()
        mass += material.solid_density * volume[mesh.yarn == number].sum()
        assert mass == pytest.approx(
            2 * mesh.S0[family] * fabric.weave.yarns[family].linear_density, rel=2e-3
        )
