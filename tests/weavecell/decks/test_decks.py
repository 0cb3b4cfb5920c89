"""Decks for LS-DYNA and OpenRadioss of all fabrics and units, read back; none is run in its code."""

import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

import deck_readers
import numpy as np
import pytest
import pyvista
from numpy.testing import assert_allclose, assert_array_equal

import weavecell as wc
from fabrics.base.errors import InputError
from tests.meshing.hexahedra import vector_areas
from weavecell.decks import folder, model
from weavecell.decks.homogenised import HomogenisedFabric
from weavecell.decks.model import UNITS

ROOT = Path(__file__).parents[3]
SCALE = {"kg-m-s": 1.0, "g-mm-ms": 1e-6}  # of stresses in Pa
UNIT_FACTORS = tomllib.loads(Path(__file__).with_name("unit_factors.toml").read_text("utf-8"))


@cache
def deck(fabric, to, match="uniaxial", **options):
    given = wc.setup(fabric, "100 m/s", opening="40 mm", elements_per_crossover=1, **options)
    return model.build(
        given, folder.CODES[to], "kg-m-s", match, title=f"{fabric}, 100 m/s", source="published"
    )


def text(made, to):
    return folder.CODES[to].write(made, "panel")


@cache
def homogenised(fabric):
    return HomogenisedFabric(wc.setup(fabric, "100 m/s").cell())


def close(found, wanted, of):
    """Within 1 % of the largest."""
    assert abs(found - wanted).max() <= 0.01 * np.max(of)


@pytest.mark.parametrize("to", folder.CODES)
def test_no_title_is_a_line_of_its_own_for_the_code(to):
    """A title, or a name of a fabric, that begins as a keyword, a comment or a parameter does."""
    plain = next(iter(text(deck("S-720", to), to).values())).splitlines()
    fabric = wc.fabric("S-720")
    for name in (",*INCLUDE\n*END", "/END", " #no"):
        given = wc.setup(
            replace(fabric, name=name), "100 m/s", opening="40 mm", elements_per_crossover=1
        )
        made = model.build(given, folder.CODES[to], "kg-m-s", "uniaxial", title=name, source=name)
        lines = next(iter(text(made, to).values())).splitlines()
        marks = [line for line in lines if line[:1] in "*/"]
        assert marks == [line for line in plain if line[:1] in "*/"]
        assert len(lines) == pytest.approx(len(plain), abs=4)  # lines of the head are folded


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("to", folder.CODES)
@pytest.mark.parametrize("fabric", wc.fabrics().index)
def test_every_deck_is_read_back_with_the_curves_of_the_cell(fabric, to, units):
    files = text(replace(deck(fabric, to), units=UNITS[units]), to)
    content = next(iter(files.values()))
    gamma = np.linspace(0, homogenised(fabric).shear.gamma2, 50)
    stress = homogenised(fabric).shear.stress(gamma)
    if to == "radioss":
        (rows, shear), *_ = deck_readers.radioss(content).values()
        modulus = np.array([rows[1][0], rows[1][2]]) / SCALE[units]
        assert rows[4][:2] == [1, 1]  # OpenRadioss would take the speed of sound of so many yarns
        crimp = np.array(rows[4][2:4])
        assert modulus * (1 + crimp) == pytest.approx(homogenised(fabric).modulus, rel=0.01)
        assert crimp == pytest.approx(homogenised(fabric).crimp, rel=0.01)
        shear_found = np.interp(np.degrees(gamma), *shear.T) * np.cos(gamma)
        close(shear_found / SCALE[units], stress, stress)
        assert np.all(np.diff(shear, axis=0) > 0)
        return
    (warp, weft, shear), *_ = deck_readers.dyna(content).values()
    assert warp[1] == -2
    assert weft[1] == -2
    assert shear[1] == 0
    for family, (curve, _) in enumerate((warp, weft)):
        stretch, wanted = homogenised(fabric).uniaxial(family)
        close(np.interp(stretch - 1, *curve.T) / SCALE[units], wanted, wanted)
    close(np.interp(gamma, *shear[0].T) / SCALE[units], stress, stress)


def test_dyna_deck_is_read_by_dynakw(tmp_path):
    dynakw = pytest.importorskip("dynakw")
    made = deck("S-720", "lsdyna", plies=2, stacking="alternating")
    path = tmp_path / "panel.k"
    path.write_text(text(made, "lsdyna")["panel.k"])
    with dynakw.DynaKeywordReader(str(path)) as reader:
        found = [(each.full_keyword, each.cards) for each in reader.keywords()]
    cards = dict(found)
    nodes = cards["*NODE"]["Card 1"]
    assert_allclose(np.stack([nodes[k] for k in "XYZ"], axis=1), made.points, rtol=1e-9, atol=1e-12)
    inertia = cards["*PART_INERTIA"]["inertia"]
    assert float(inertia["TM"][0]) == pytest.approx(made.nose.mass, rel=1e-3)
    assert float(inertia["VTZ"][0]) == pytest.approx(100, rel=1e-3)
    assert cards["*SECTION_SHELL_TITLE"]
    assert cards["*MAT_RIGID_TITLE"]
    curves = [card for name, card in found if name == "*DEFINE_CURVE_TITLE"]
    assert len(curves) == 6
    points = next(
        card
        for name, card in curves[0].items()
        if name != "Card 1" and len(next(iter(card.values()))) > 3
    )
    strain, stress = list(points.values())[:2]
    assert_allclose(np.column_stack([strain, stress]), made.cards[0].law.curves[0], rtol=1e-9)


@pytest.mark.parametrize("to", folder.CODES)
def test_turned_plies_have_a_card_with_warp_and_weft_exchanged(to):
    made = deck("S-726", to, plies=3, stacking="alternating", symmetry="half", ply_friction=0.2)
    assert [ply.card.number for ply in made.plies] == [1, 2, 1]
    reader = {"lsdyna": deck_readers.dyna, "radioss": deck_readers.radioss}[to]
    assert len(reader(next(iter(text(made, to).values())))) == 2
    ones, others = (card.fabric for card in made.cards[:2])
    assert_array_equal(ones.modulus, others.modulus[::-1])
    heights = [ply.points[0, 2] for ply in made.plies]
    assert np.all(np.diff(heights) >= made.cards[0].fabric.thickness)
    assert made.friction == 0.2


def test_a_radioss_deck_has_the_settings_and_histories_of_the_runs():
    made = deck("S-728", "radioss", plies=2)
    starter, engine = text(made, "radioss").values()
    assert "\n/DT\n0.5 0\n" in engine
    assert "\n/FAIL" not in starter
    assert "nothing breaks" in "".join(starter.splitlines()[:20])
    # the comment is a card
    deck_readers.radioss(re.sub(r"(?m)^#(/FAIL/FABRIC/\d+|[ \dE.+-]+)$", r"\1", starter))
    values = "".join(line for line in starter.splitlines(keepends=True) if not line.startswith("#"))
    stiffness = [float(part.splitlines()[5][:20]) for part in values.split("/INTER/TYPE7/")[1:]]
    assert stiffness == [0.03, 1, 1]
    lines = starter.partition("/TH/NODE/2\nmotion\n")[2].splitlines()
    named = {line[20:]: int(line[:10]) for line in lines[1:4]}
    middles = [made.points[named[ply.name] - 1] for ply in made.plies]
    assert named["projectile"] == made.nose.reference
    assert np.allclose(middles, [[0, 0, ply.points[0, 2]] for ply in made.plies])


@pytest.mark.parametrize("symmetry", ["quarter", "half", "whole"])
def test_a_deck_holds_its_share_of_the_shot(symmetry):
    made = deck("S-720", "lsdyna", symmetry=symmetry)
    share = {"quarter": 0.25, "half": 0.5, "whole": 1.0}[symmetry]
    assert made.nose.mass == pytest.approx(3e-3 * share)
    ply = made.plies[0]
    held = made.list_held_nodes()
    assert set(held) == {
        "clamped",
        *(["mirror_x"] if share < 1 else []),
        *(["mirror_y"] if share == 0.25 else []),
    }
    # all nodes on a plane of symmetry but those in the clamp, and no other
    loose = np.setdiff1d(np.arange(len(ply.points)) + 1, held["clamped"])
    for axis, name in enumerate(("mirror_x", "mirror_y")):
        if name in held:
            on_plane = abs(ply.points[loose - 1, axis]) < 1e-9
            assert_array_equal(held[name], loose[on_plane])
    sides = ply.points[ply.quads[:, [1, 3]] - 1] - ply.points[ply.quads[:, [0]] - 1]
    spacing = sides[0, 0, 0]
    assert sides[:, 0] == pytest.approx(np.tile([spacing, 0, 0], (len(sides), 1)), abs=1e-12)
    side = np.ptp(ply.points[:, 1]) * (2 if symmetry == "quarter" else 1)
    assert 0.04 - 2 * spacing < side <= 0.04  # a half of a row at either edge lies in the clamps
    cell = made.cards[0].fabric
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()
    mass = cell.density * cell.thickness * area
    assert mass == pytest.approx(share * side**2 * cell.model.fabric.weave.areal_density, rel=1e-9)
    assert np.all(
        ply.points[:, 2] - made.nose.points[:, 2].max() > 0.5 * (cell.thickness + made.skin)
    )


@pytest.mark.parametrize(
    "shape",
    [
        {},
        {"shape": "sphere", "mass": "1 g"},
        {"shape": "hemisphere"},
        {"obliquity": "30 deg"},
        {"name": "FSP 1.10 g"},
        {"shape": "cone", "half_angle": "40 deg", "tip_radius": "1 mm"},
        {
            "shape": "stl",
            "stl": str(ROOT / "examples" / "cube.stl"),
            "stl_unit": "mm",
            "diameter": None,
            "yaw": "10 deg",
        },
    ],
)
def test_the_surface_of_the_projectile_is_closed_ahead_and_free_of_the_cloth(shape):
    edge = {} if shape.get("shape") == "sphere" else {"edge_radius": "0.3 mm"}
    own = {} if "name" in shape else {"mass": "3 g", "diameter": "5.5 mm", **edge}
    shot = {key: value for key, value in {**own, **shape}.items() if value is not None}
    made = deck.__wrapped__("S-720", "lsdyna", symmetry="whole", projectile=shot)
    nose = made.nose
    first = len(made.points) - len(nose.points)
    edges = np.sort(np.stack([nose.quads, np.roll(nose.quads, 1, axis=1)], axis=-1).reshape(-1, 2))
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)  # every edge has two faces
    spacing = np.diff(made.points[made.plies[0].quads[:, [0, 2]] - 1, 0]).min()
    assert np.linalg.norm(np.diff(made.points[edges - 1], axis=1), axis=2).max() < spacing
    assert nose.quads.min() == first
    # no pole: contact adds the stiffness of elements
    assert np.bincount(nose.quads.ravel())[first:].max() <= 4
    corners = nose.points[nose.quads - first]
    assert np.all(
        np.sum(vector_areas(corners) * (corners.mean(axis=1) - nose.points.mean(axis=0)), axis=1)
        > 0
    )
    assert nose.points[:, 2].max() < -0.5 * made.cards[0].fabric.thickness
    reach = np.linalg.norm(nose.points - nose.centre, axis=1)
    assert reach.min() > 0.5 * 2.75e-3
    assert np.linalg.norm(nose.velocity) == pytest.approx(100)


def test_a_body_that_is_not_seen_from_its_axis_is_refused(tmp_path):
    """A staple whose axis goes through one of its legs."""
    x, z = np.array([(-1, 0), (7, 0), (7, -8), (5, -8), (5, -2), (1, -2), (1, -8), (-1, -8)]).T
    flat = pyvista.PolyData(
        np.column_stack([x, 0 * x - 1.0, z]), faces=[8, *range(8)]
    ).triangulate()
    flat.extrude((0, 2, 0), capping=True).triangulate().compute_normals(
        auto_orient_normals=True
    ).save(tmp_path / "u.stl")
    shot = {
        "shape": "stl",
        "stl": str(tmp_path / "u.stl"),
        "stl_unit": "mm",
        "mass": "1 g",
        "edge_radius": "0.3 mm",
    }
    given = wc.setup("S-720", "100 m/s", opening="40 mm", projectile=shot)
    assert given.symmetry == "whole"
    with pytest.raises(
        InputError, match="a body whose whole surface is visible from its axis"
    ) as problem:
        wc.export(given, "lsdyna", tmp_path / "out")
    assert problem.value.key == "projectile.stl"


def test_each_fabric_has_a_card_and_the_header_its_error():
    plies = [{}, {"name": "S-726", "angle": "90 deg"}]
    made = deck.__wrapped__("S-720", "lsdyna", ply=plies, ply_gap="0.1 mm")
    assert [card.name for card in made.cards] == ["S-720", "S-726 turned"]
    head = "\n".join(made.header)
    for word in (
        "NOT RUN",
        "WARNING",
        "Not represented",
        *(f"rms {100 * card.mismatch.rms:.1f} %" for card in made.cards),
    ):
        assert word in head
    assert all(len(line) <= 76 for line in made.header)


PACK = """
[fabric]
name = "S-728"
[projectile]
name = "FSP 1.10 g"
strike_velocity = "150 m/s"
[panel]
opening = "40 mm"
plies = 2
ply_friction = 0.2
{failure}
[run]
end_time = "50 us"
elements_per_crossover = 1
outputs = []
[numerics]
cfl = 0.4
[history]
weft = ["0 mm"]
"""


@pytest.mark.parametrize(
    "to, failure, nothing", [("lsdyna", "", True), ("radioss", "yarn_failure = false", False)]
)
def test_a_deck_names_every_key_of_the_scene_that_it_leaves_out(tmp_path, to, failure, nothing):
    """In the deck and on the terminal; not what a deck has: opening, friction, mesh and end time."""
    scene = tmp_path / "pack.toml"
    scene.write_text(PACK.format(failure=failure))
    made = wc.export(scene, to, tmp_path / "out")
    keys = [line.split(" (")[0] for line in made.keys_left_out]
    wanted = ["panel.ply_contact", "run.outputs", "history", "numerics.cfl"]
    assert keys == ["panel.yarn_failure"] * nothing + wanted
    written = " ".join((tmp_path / "out" / folder.CODES[to].names("pack")[0]).read_text().split())
    for key in keys:
        assert key in str(made).rpartition("left out of the input file:")[2]
        assert key in written


def test_the_python_interface_writes_the_folder(tmp_path):
    given = wc.setup("S-728", "100 m/s", opening="40 mm", plies=2, stacking="alternating")
    errors = wc.export(given, "radioss", tmp_path / "out", units="g-mm-ms").summary()
    assert set(errors) == set(folder.ROWS)
    assert 0 < errors["rms"] < errors["largest"] < 0.2
    written = {path.name for path in (tmp_path / "out").glob("[!.]*")}
    assert written == {
        "S-728_0000.rad",
        "S-728_0001.rad",
        "mapping.svg",
        "report.html",
        "summary.json",
    }
    assert "2 x S-728, 100 m/s" in (tmp_path / "out" / "S-728_0000.rad").read_text()


def test_units_are_consistent():
    """Force is mass times length over time squared: newton in both systems, stress in megapascal in the small one."""
    for units in UNITS.values():
        assert units.kg * units.m / units.s**2 == units.velocity(1.0) == pytest.approx(1)
    small = UNITS["g-mm-ms"]
    assert (small.density(7800.0), small.stress(2e11)) == pytest.approx((7.8e-3, 2e5))


@pytest.mark.parametrize("to", UNIT_FACTORS)
def test_units_go_into_every_number_of_a_deck(to):
    """The same deck in two systems: a field, found by its name above it, differs by the factor of its quantity."""
    made = deck("S-720", to)
    decks = (replace(made, units=UNITS[units]) for units in ("kg-m-s", "g-mm-ms"))
    si, small = (deck_readers.named(next(iter(text(units, to).values()))) for units in decks)
    for keyword, fields in UNIT_FACTORS[to].items():
        for name, factor in fields.items():
            ours, theirs = (float(deck[keyword][name]) for deck in (si, small))
            assert ours or name == "X", (keyword, name)
            assert theirs == pytest.approx(factor * ours, rel=1e-3), (keyword, name)


def lines_below(content, word, comment):
    """[{name: text}] of each block of a word of a deck: its fields by the names in the comment lines above them."""
    found = []
    for block in re.split(rf"(?m)^{re.escape(word)}(?:/\d+)?\n", content)[1:]:
        card, names = {}, []
        for line in block.splitlines():
            if line[0] in "*/":
                break
            if line.startswith(comment):
                names = [(name[0], name.end()) for name in re.finditer(r"(?<=[ #])[^ #]\S*", line)]
            elif names and line[0] not in "#$":
                starts = [0, *(end for _, end in names)]
                for start, (name, end) in zip(starts, names):
                    card.setdefault(name, line[start:end].strip())
        found.append(card)
    return found


WRITTEN = {  # code and word: {field: what it is of the fabric of its card}
    ("lsdyna", "*MAT_FABRIC_TITLE"): {
        "RO": lambda fabric: fabric.density,
        "EA": lambda fabric: fabric.modulus[0],
        "EB": lambda fabric: fabric.modulus[1],
    },
    ("lsdyna", "*SECTION_SHELL_TITLE"): {
        f"T{corner}": lambda fabric: fabric.thickness for corner in range(1, 5)
    },
    ("radioss", "/MAT/LAW58"): {
        "RHO_I": lambda fabric: fabric.density,
        "E1": lambda fabric: fabric.modulus[0] / (1 + fabric.crimp[0]),
        "E2": lambda fabric: fabric.modulus[1] / (1 + fabric.crimp[1]),
        "S1": lambda fabric: fabric.crimp[0],
        "S2": lambda fabric: fabric.crimp[1],
    },
    ("radioss", "/PROP/TYPE16"): {"Thick": lambda fabric: fabric.thickness},
}


@pytest.fixture(scope="module", params=folder.CODES)
def unlike(request):
    """A deck of two unlike fabrics, of which the second is turned, behind an oblique nose; its text."""
    plies = [{"name": "S-726"}, {"name": "S-728", "angle": "90 deg"}]
    shot = {"mass": "2 g", "diameter": "6 mm", "edge_radius": "0.3 mm", "friction": 0.1}
    options = {"ply": plies, "ply_gap": "0.1 mm", "ply_friction": 0.2, "projectile": shot}
    made = deck.__wrapped__(None, request.param, symmetry="half", **options)
    return request.param, made, next(iter(text(made, request.param).values()))


def test_each_card_has_the_numbers_of_its_own_fabric(unlike):
    """Field by field: density, moduli of warp and weft, crimps and thickness; no two cards are alike."""
    to, made, content = unlike
    assert made.cards[0].fabric.thickness != made.cards[1].fabric.thickness
    for (code, word), fields in WRITTEN.items():
        if code != to:
            continue
        blocks = lines_below(content, word, {"lsdyna": "$#", "radioss": "#"}[to])
        for card, block in zip(made.cards, blocks):
            for name, value in fields.items():
                rel = 0.02 if name in ("E1", "E2") else 1e-3
                assert float(block[name]) == pytest.approx(value(card.fabric), rel=rel), (
                    word,
                    name,
                )


def test_parts_cards_and_curves_of_a_deck_belong_together(unlike):
    """The elements of each ply have its part, the part its section and material, the material its curves."""
    to, made, content = unlike
    for number, (ply, card) in enumerate(zip(made.plies, made.cards), 1):
        assert ply.card is card
        assert card.number == number
        assert card.name == ("S-726", "S-728 turned")[number - 1]
    if to == "lsdyna":
        parts = lines_below(content, "*PART", "$#")
        assert [(part["PID"], part["SECID"], part["MID"]) for part in parts] == [
            ("1", "1", "1"),
            ("2", "2", "2"),
        ]
        materials = lines_below(content, "*MAT_FABRIC_TITLE", "$#")
        assert [[card[name] for name in ("LCA", "LCB", "LCAB")] for card in materials] == [
            ["1", "2", "3"],
            ["4", "5", "6"],
        ]
        curves = list(deck_readers.dyna(content).values())
        for card, (warp, weft, _) in zip(made.cards, curves, strict=True):
            for family, (points, _) in enumerate((warp, weft)):
                stretch, stress = card.fabric.uniaxial(family)
                close(np.interp(stretch - 1, *points.T), stress, stress)
    else:
        parts = lines_below(content, "/PART", "#")
        numbers = [(part["prop_ID"], part["mat_ID"]) for part in parts]
        assert numbers == [("1", "1"), ("2", "2"), ("3", "3")]
        for card, (rows, _) in zip(made.cards, deck_readers.radioss(content).values(), strict=True):
            assert rows[4][2:4] == pytest.approx(card.fabric.crimp, rel=0.01)


def test_friction_and_nose_of_a_deck_are_those_of_the_shot(unlike):
    """Between nose and plies and between plies, each by its own coefficient; half of the mass, its velocity."""
    to, made, content = unlike
    if to == "lsdyna":
        (nose,) = lines_below(content, "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE", "$#")
        (between,) = lines_below(content, "*CONTACT_AUTOMATIC_SINGLE_SURFACE", "$#")
        assert [float(nose[name]) for name in ("FS", "FD")] == [0.1, 0.1]
        assert [float(between[name]) for name in ("FS", "FD")] == [0.2, 0.2]
        (body,) = lines_below(content, "*PART_INERTIA", "$#")
        assert float(body["TM"]) == pytest.approx(1e-3)
        assert [float(body[name]) for name in ("VTX", "VTY", "VTZ")] == pytest.approx([0, 0, 100])
        centre = [float(body[name]) for name in ("XC", "YC", "ZC")]
        assert centre == pytest.approx(made.nose.centre.tolist(), rel=1e-3, abs=1e-9)
    else:
        contacts = lines_below(content, "/INTER/TYPE7", "#")
        assert sorted({float(each["Fric"]) for each in contacts}) == [0.1, 0.2]
        (body,) = lines_below(content, "/RBODY", "#")
        assert float(body["Mass"]) == pytest.approx(1e-3)
        flights = lines_below(content, "/INIVEL/TRA", "#")
        assert len(flights) == 2  # of the surface and of the node of reference
        for flight in flights:
            velocity = [float(flight[name]) for name in ("Vx", "Vy", "Vz")]
            assert velocity == pytest.approx([0, 0, 100])


@pytest.mark.parametrize("to", folder.CODES)
@pytest.mark.parametrize("symmetry", ["quarter", "half"])
def test_what_a_plane_of_symmetry_holds_follows_from_its_normal(to, symmetry):
    """Displacements along the normal, and rotations about the two other axes; of the nose, which does not turn, the
    displacements alone."""
    made = deck("S-720", to, symmetry=symmetry)
    content = next(iter(text(made, to).values()))
    names = list(made.list_held_nodes())
    held = {"clamped": "111 111", "mirror_x": "100 011", "mirror_y": "010 101"}
    wanted = [held[name] for name in names]
    of_nose = {"half": "100", "quarter": "110"}[symmetry]
    if to == "lsdyna":
        cards = lines_below(content, "*BOUNDARY_SPC_SET", "$#")
        axes = ("DOFX", "DOFY", "DOFZ", "DOFRX", "DOFRY", "DOFRZ")
        found = ["".join(card[axis] for axis in axes) for card in cards]
        assert found == [code.replace(" ", "") for code in wanted]
        (rigid,) = lines_below(content, "*MAT_RIGID_TITLE", "$#")
        # of the manual: 1 holds x, 2 y, 4 both
        assert rigid["CON1"] == {"100": "1", "110": "4"}[of_nose]
    else:
        cards = lines_below(content, "/BCS", "#")
        assert [card["Tra_rot"] for card in cards] == [*wanted, f"{of_nose} 111"]


def test_a_deck_is_matched_to_what_was_asked_for(tmp_path):
    """Nearest in uniaxial tension, or over the plane."""
    shot = wc.setup("S-728", "150 m/s", opening="20 mm", elements_per_crossover=1)
    plane, uniaxial = (
        wc.export(shot, "radioss", tmp_path / match, match=match).summary()
        for match in ("plane", "uniaxial")
    )
    assert plane["rms"] < 0.9 * uniaxial["rms"]
    assert uniaxial["uniaxial"] < 0.2 * plane["uniaxial"]
