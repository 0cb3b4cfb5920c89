"""Input files of other solvers, read back: LS-DYNA by dynakw, Abaqus by meshio and CalculiX, OpenRadioss by columns.

No reader of OpenRadioss files is packaged; the test reads its fixed columns itself, strictly. dynakw knows no bars:
they are read in the same way.
"""

import os
import re
import shutil
import subprocess
from itertools import pairwise

import meshio
import numpy as np
import pytest
from hexahedra import volumes

from fabrics import catalogue
from meshing import crossover, patch
from meshing.formats import export
from meshing.formats.abaqus import SIDES

WOVEN = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
SIZE = (3, 2, 1)
MESHES = {
    "quarter": lambda name: crossover.build(catalogue.load(name), size=SIZE),
    "patch": lambda name: patch.build(catalogue.load(name), (2, 3), size=SIZE, end_shells=2e-5),
}
CASES = [("quarter", name) for name in WOVEN] + [("patch", name) for name in WOVEN]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: "-".join(case))
def mesh(request):
    kind, name = request.param
    return MESHES[kind](name)


def written(mesh, path):
    export.write(mesh, path)
    return path.read_text(encoding="ascii")


def node_sets(mesh):
    return {name: nodes for name, nodes in mesh.groups.items() if nodes.ndim == 1}


def surfaces(mesh):
    return {name: quads for name, quads in mesh.groups.items() if quads.ndim == 2}


def columns(text, widths):
    """Fields of a line in fixed columns, as numbers; the line has just this length, every field is right-aligned."""
    assert len(text) == sum(widths), text
    bounds = np.cumsum([0, *widths])
    fields = [text[a:b] for a, b in pairwise(bounds)]
    assert all(field == field.rstrip() for field in fields), text
    return [float(f) if re.search(r"[.E]", f) else int(f) for f in fields]


def integers(line, width):
    return columns(line, [width] * (len(line) // width))


def blocks(text, mark, comment):
    """(header, lines) of each block that begins with `mark`."""
    found = []
    for line in text.splitlines():
        if line.startswith(mark):
            found.append((line, []))
        elif not line.startswith(comment):
            found[-1][1].append(line)
    return found


def check_bars(mesh, elements, sets):
    """elements: number -> (nodes, area); sets: name -> numbers. Against the mesh, in its order."""
    first = len(mesh.hexes) + 1
    pairs, areas = np.concatenate(mesh.bars) + 1, np.concatenate(mesh.bar_area)
    assert sorted(elements) == list(range(first, first + len(pairs)))
    assert np.array_equal([elements[e][0] for e in sorted(elements)], pairs)
    assert [elements[e][1] for e in sorted(elements)] == pytest.approx(areas, rel=6e-5)
    for name, bars in zip(mesh.names, mesh.bars):
        assert np.array_equal([elements[e][0] for e in sets[f"{name}_fibre"]], bars + 1)


# --- LS-DYNA -------------------------------------------------------------------------------------------------------


def test_dyna_read_by_dynakw(mesh, tmp_path):
    dynakw = pytest.importorskip("dynakw")
    path = tmp_path / "a.k"
    export.write(mesh, path)
    parts, node_lists, segments, nodes, solids, shells = {}, {}, {}, None, None, None
    with dynakw.DynaKeywordReader(str(path)) as reader:
        for keyword in reader.keywords():
            cards, name = keyword.cards, keyword.full_keyword
            if name == "*NODE":
                nodes = cards["Card 1"]
            elif name == "*PART":
                parts[int(cards["Card 2"]["PID"][0])] = cards["Card 1"]["HEADING"][0].strip()
            elif name == "*ELEMENT_SOLID":
                solids = cards
            elif name == "*ELEMENT_SHELL":
                shells = cards
            elif name == "*SET_NODE_LIST_TITLE":
                node_lists[int(cards["Card 1"]["SID"][0])] = np.stack(list(cards["Card 2"].values()), axis=1)
            elif name == "*SET_SEGMENT_TITLE":
                segments[int(cards["Card 1"]["SID"][0])] = np.stack(
                    [cards["Card 2"][f"N{i}"] for i in range(1, 5)], axis=1
                )
    assert np.array_equal(nodes["NID"], np.arange(len(mesh.points)) + 1)
    assert np.allclose(np.stack([nodes[k] for k in "XYZ"], axis=1), mesh.points, rtol=1e-9, atol=1e-18)
    assert np.array_equal(np.stack([solids["nodes"][f"N{i}"] for i in range(1, 9)], axis=1), mesh.hexes + 1)
    assert [parts[pid] for pid in solids["Card 1"]["PID"]] == [mesh.names[number] for number in mesh.yarn]
    if mesh.shells:
        quads = np.stack([shells["Card 1"][f"N{i}"] for i in range(1, 5)], axis=1)
        assert np.array_equal(quads, np.concatenate(list(mesh.shells.values())) + 1)
        of = [f"{name}_shell" for name, quads in mesh.shells.items() for _ in quads]
        assert [parts[pid] for pid in shells["Card 1"]["PID"]] == of
    else:
        assert shells is None
    lists = {name: nodes for name, nodes in node_sets(mesh).items() if name in mesh.faces}
    for (name, expected), found in zip(lists.items(), node_lists.values(), strict=True):
        assert np.array_equal(found[found > 0], expected + 1), name
    lists = {name: quads for name, quads in surfaces(mesh).items() if name in mesh.faces}
    for (name, expected), found in zip(lists.items(), segments.values(), strict=True):
        assert np.array_equal(found, expected + 1), name


def test_dyna_bars_and_unions_by_columns(mesh, tmp_path):
    found = blocks(written(mesh, tmp_path / "a.k"), "*", "$")
    sections, materials, section, elements, sets, numbers, unions = {}, {}, {}, {}, {}, {}, {}
    for header, lines in found:
        if header == "*SECTION_BEAM":
            number, form = integers(lines[0], 10)
            assert form == 3
            sections[number] = columns(lines[1], [10])[0]
        elif header == "*PART":
            part, section[part], materials[part] = integers(lines[1], 10)
        elif header.startswith("*SET_"):
            members = [n for line in lines[2:] for n in integers(line, 10)]
            kind = header.split("_")[1]
            numbers.setdefault(kind, {})[integers(lines[1], 10)[0]] = lines[0]
            (unions if "_ADD" in header else sets)[lines[0]] = (kind, members)
    for header, lines in found:
        if header == "*ELEMENT_BEAM":
            for line in lines:
                element, part, *nodes = integers(line, 8)
                elements[element] = (nodes, sections[section[part]])
    check_bars(mesh, elements, {name: members for name, (kind, members) in sets.items() if kind == "BEAM"})
    assert {name: tuple(numbers[kind][n] for n in members) for name, (kind, members) in unions.items()} == {
        name: members for name, members in mesh.collected.items() if name not in mesh.faces
    }
    assert found[0][0] == "*KEYWORD"
    assert found[-1][0] == "*END"


def test_dyna_axes_follow_the_element(tmp_path):
    """AOPT 0, and node 1 to node 2 is the fibre."""
    mesh = MESHES["patch"]("S-731")
    found = [lines for header, lines in blocks(written(mesh, tmp_path / "a.k"), "*", "$") if "ORTHOTROPIC" in header]
    assert [lines[0] for lines in found] == ["warp", "weft"]
    for lines, material in zip(found, mesh.materials):
        number, *first = columns(lines[1], [10] * 8)
        assert first[:4] == pytest.approx(
            [material.solid_density, material.axial, *[material.transverse] * 2], rel=1e-4
        )
        assert columns(lines[2], [10] * 4)[3] == 0
        assert number in (1, 4)
    edge = mesh.points[mesh.hexes[:, 1]] - mesh.points[mesh.hexes[:, 0]]
    assert np.allclose(edge / np.linalg.norm(edge, axis=1, keepdims=True), mesh.fibre, rtol=0, atol=1e-12)


# --- Abaqus --------------------------------------------------------------------------------------------------------


def abaqus_surfaces(text, mesh):
    """name -> quadrilaterals of the named element sides."""
    found = {}
    for header, lines in blocks(text, "*", "**"):
        if header.startswith("*SURFACE"):
            pairs = [re.fullmatch(r"(\d+),S(\d)", line).groups() for line in lines]
            element, side = (np.array(pairs).astype(int) - 1).T
            found[header.split("NAME=")[1]] = mesh.hexes[element[:, None], SIDES[side]]
    return found


def vector_area(corners):
    return np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2


def test_abaqus_read_by_meshio(mesh, tmp_path):
    path = tmp_path / "a.inp"
    text = written(mesh, path)
    read = meshio.read(path)
    assert np.allclose(read.points, mesh.points, rtol=1e-12, atol=1e-25)
    assert np.array_equal(np.concatenate([b.data for b in read.cells if b.type == "hexahedron"]), mesh.hexes)
    quads = [b.data for b in read.cells if b.type == "quad"]
    assert np.array_equal(quads, list(mesh.shells.values())) if mesh.shells else quads == []
    for name, nodes in node_sets(mesh).items():
        assert np.array_equal(np.unique(read.point_sets[name]), nodes), name
    for number, name in enumerate(mesh.names):
        cells = [b.data[part] for b, part in zip(read.cells, read.cell_sets[name]) if part is not None and len(part)]
        assert np.array_equal(np.concatenate(cells), mesh.hexes[mesh.yarn == number])
    for name, quads in abaqus_surfaces(text, mesh).items():
        assert np.array_equal(np.sort(quads), np.sort(mesh.groups[name])), name
        # C3D8 lists the nodes of a side as seen from inside the element; so it is the right element's side.
        inward, outward = (vector_area(mesh.points[q]) for q in (quads, mesh.groups[name]))
        assert np.allclose(inward, -outward, rtol=1e-9, atol=1e-20)
    assert set(abaqus_surfaces(text, mesh)) == set(surfaces(mesh))


def test_abaqus_bars_sections_and_axes(mesh, tmp_path):
    found = blocks(written(mesh, tmp_path / "a.inp"), "*", "**")
    elements, areas, sets, axes = {}, {}, {}, {}
    for header, lines in found:
        if header.startswith("*ELEMENT, TYPE=T3D2"):
            name = header.split("ELSET=")[1]
            elements |= {int(n): ([int(a), int(b)], name) for n, a, b in (line.split(",") for line in lines)}
        elif header.startswith("*SOLID SECTION") and lines:
            areas[re.search(r"ELSET=([^,]+)", header)[1]] = float(lines[0].rstrip(","))
        elif header.startswith("*ELSET"):
            sets[header.split("ELSET=")[1]] = [int(n) for line in lines for n in line.split(",")]
        elif header.startswith("*DISTRIBUTION,"):
            axes = {int(n): values for n, *values in (line.split(",") for line in lines[1:])}
        assert all(len(field) <= 20 for line in lines for field in line.split(",") if header != "*HEADING")
    check_bars(mesh, {n: (nodes, areas[part]) for n, (nodes, part) in elements.items()}, sets)
    found = np.array([axes[n + 1] for n in range(len(mesh.hexes))], float)
    assert np.allclose(found[:, :3], mesh.fibre, rtol=0, atol=1e-9)
    assert np.linalg.norm(np.cross(found[:, :3], found[:, 3:]), axis=1).min() > 0.5


def calculix(folder, deck):
    (folder / "job.inp").write_text(deck)
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    done = subprocess.run(["ccx", "job"], cwd=folder, env=environment, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout[-2000:]
    assert "*ERROR" not in done.stdout
    return (folder / "job.dat").read_text()


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_abaqus_file_solved_by_calculix(tmp_path):
    """A linear step on the file as it is: volumes and masses as ours, and the fibres carry the pull."""
    fabric = catalogue.load("S-720")
    mesh = patch.build(fabric, (2, 2), size=(4, 3, 2))
    ends = "".join(f"{group}, 1, 3, 0.\n" for group in ("warp_start", "weft_start", "weft_end"))
    asked = "".join(f"*EL PRINT, ELSET={n}, TOTALS=ONLY\nEVOL, EMAS\n" for n in ("warp_1", "warp_1_fibre"))
    deck = (
        written(mesh, tmp_path / "mesh.inp")
        + f"*BOUNDARY\n{ends}warp_end, 1, 1, 1e-8\nwarp_end, 2, 3, 0.\n*STEP\n*STATIC\n{asked}*END STEP\n"
    )
    data = calculix(tmp_path, deck)
    totals = [float(v) for v in re.findall(r"total (?:volume|mass) for set .*\n\n\s+(\S+)", data)]
    volume = volumes(mesh.points, mesh.hexes)[mesh.yarn == 0].sum()
    lengths = np.linalg.norm(np.diff(mesh.points[mesh.bars[0]], axis=1)[:, 0], axis=1)
    material = mesh.materials[0]
    bars = (lengths * mesh.bar_area[0]).sum()
    assert totals == pytest.approx(
        [volume, volume * material.solid_density, bars, bars * material.bar_density], rel=2e-6
    )


# --- OpenRadioss ---------------------------------------------------------------------------------------------------


def radioss(text):
    """keyword -> {number: (title, lines)}; for elements number is the part. The order of the file is kept."""
    assert text.startswith("#RADIOSS STARTER\n")
    found = {}
    for header, lines in blocks(text[text.index("/BEGIN") :], "/", "#"):
        *keyword, last = header[1:].split("/")
        if last.isdigit():
            found.setdefault("/".join(keyword), {})[int(last)] = lines
        else:
            found["/".join([*keyword, last])] = lines
    return found


def test_radioss_by_columns(mesh, tmp_path):
    found = radioss(written(mesh, tmp_path / "a_0000.rad"))
    assert list(found)[-1] == "END"
    assert [line.split() for line in found["BEGIN"][2:]] == [["kg", "m", "s"]] * 2
    nodes = np.array([columns(line, [10, 20, 20, 20]) for line in found["NODE"]])
    assert np.array_equal(nodes[:, 0], np.arange(len(mesh.points)) + 1)
    assert np.allclose(nodes[:, 1:], mesh.points, rtol=1e-12, atol=1e-25)
    part = {number: (lines[0], *integers(lines[1], 10)) for number, lines in found["PART"].items()}
    bricks = {n: (nodes, p) for p, lines in found["BRICK"].items() for n, *nodes in (integers(x, 10) for x in lines)}
    assert np.array_equal([bricks[n + 1][0] for n in range(len(mesh.hexes))], mesh.hexes + 1)
    assert [part[bricks[n + 1][1]][0] for n in range(len(mesh.hexes))] == [mesh.names[y] for y in mesh.yarn]
    area = {number: columns(lines[1], [20, 20])[0] for number, lines in found["PROP/TYPE2"].items()}
    bars = {
        n: (nodes, area[part[p][1]])
        for p, lines in found["TRUSS"].items()
        for n, *nodes in (integers(x, 10) for x in lines)
    }
    check_bars(mesh, bars, {lines[0]: members(lines, 10) for lines in found["GRTRUS/TRUS"].values()})
    if mesh.shells:
        quads = [integers(line, 10)[1:] for lines in found["SHELL"].values() for line in lines]
        assert np.array_equal(quads, np.concatenate(list(mesh.shells.values())) + 1)
        assert {columns(lines[3], [10, 10, 20])[2] for lines in found["PROP/TYPE1"].values()} == {2e-5}
    numbers = {kind: {n: lines[0] for n, lines in found[kind].items()} for kind in ("GRNOD/NODE", "SURF/SEG")}
    groups = {lines[0]: members(lines, 10) for lines in found["GRNOD/NODE"].values()}
    groups |= {lines[0]: [integers(line, 10)[1:] for line in lines[1:]] for lines in found["SURF/SEG"].values()}
    assert set(groups) == set(mesh.faces)
    for name, nodes in groups.items():
        assert np.array_equal(nodes, mesh.groups[name] + 1), name
    unions = {}
    for union, kind in (("GRNOD/GRNOD", "GRNOD/NODE"), ("SURF/SURF", "SURF/SEG")):
        for lines in found.get(union, {}).values():
            unions[lines[0]] = tuple(numbers[kind][n] for n in members(lines, 10))
    assert unions == {name: of for name, of in mesh.collected.items() if name not in mesh.faces}


def members(lines, width):
    return [n for line in lines[1:] for n in integers(line, width)]


def test_radioss_materials_and_axes(mesh, tmp_path):
    """Orthotropic solids on the element's edge 1-2 (Ip 20), fully integrated (Isolid 17); every part has its own."""
    found = radioss(written(mesh, tmp_path / "a_0000.rad"))
    solid = found["PROP/TYPE6"][1]
    assert integers(solid[1], 10)[0] == 17
    assert columns(solid[3], [20, 20, 20, 10, 10, 10])[4] == 20
    laws = {**found["MAT/LAW12"], **found["MAT/LAW1"]}
    properties = {**found["PROP/TYPE6"], **found["PROP/TYPE2"], **found.get("PROP/TYPE1", {})}
    for lines in found["PART"].values():
        prop, material = integers(lines[1], 10)
        assert prop in properties
        assert lines[0].startswith(laws[material][0].split()[0])
    for material, number in zip(mesh.materials, (1, 4)):
        density, moduli, _, shear = (columns(line, [20] * (len(line) // 20)) for line in laws[number][1:5])
        assert [*density, *moduli, *shear] == pytest.approx(
            [material.solid_density, material.axial, *[material.transverse] * 2, *[material.shear] * 3], rel=1e-12
        )
        assert len(laws[number]) == 11


# --- All -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".k", ".inp", ".rad"])
def test_units_are_said_in_the_header(suffix, tmp_path):
    head = written(MESHES["quarter"]("S-720"), tmp_path / f"a{suffix}").splitlines()[:8]
    assert any("Units: m, kg, s, N, Pa" in line for line in head)


def test_bars_and_solids_together_have_the_mass_of_the_yarns():
    fabric = catalogue.load("S-731")
    mesh = patch.build(fabric, (2, 2), size=(16, 12, 2))
    volume = volumes(mesh.points, mesh.hexes)
    for number, family in enumerate(mesh.families):
        material = mesh.materials[family]
        lengths = np.linalg.norm(np.diff(mesh.points[mesh.bars[number]], axis=1)[:, 0], axis=1)
        mass = material.bar_density * (lengths * mesh.bar_area[number]).sum()
        mass += material.solid_density * volume[mesh.yarn == number].sum()
        assert mass == pytest.approx(2 * mesh.S0[family] * fabric.weave.yarns[family].linear_density, rel=2e-3)
