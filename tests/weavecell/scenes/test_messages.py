"""A message shows what the user wrote, where, and the key that is the cause: ten slips in each table, and cases of
their own."""

import re
import tomllib
from itertools import chain

import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base import amounts, written
from fabrics.base.errors import InputError
from fabrics.base.schema import parse_source, tables
from fabrics.fabric_tables import FabricFile
from weavecell.scenes import build, impact
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.fabric_table import check_scene
from weavecell.scenes.impact import Scene

SHOT = """# a shot
[fabric]
name = "S-720"

[projectile]
mass = "3 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "92.5 m/s"

[panel]
opening = "203 mm"
"""
FABRIC = (catalogue.list_names()[0], "S-728")
# as they stand in a file: each is no value of most keys
SLIPS = (
    '"7"',
    '"7 K^3/kg"',
    '"7,5 mm"',
    '"-7e9 mm"',
    '""',
    '"seven mm"',
    '"7 mm 8 mm"',
    "[[[7]]]",
    "-7e9",
    '{ odd = "7 mm" }',
    "1979-05-27",
    '["7 mm", "8"]',
)
TEN = 10


def read_shot(text):
    """Read a shot as a command does, from a file of this text."""
    scene = impact.check(parse_source(text, "scene.toml"), "scene.toml", "shot")
    return build.setup(build.build(scene, "scene.toml", "scene"), "scene.toml")


def read_coupon(text):
    check_scene(CouponScene, parse_source(text, "scene.toml"), "scene.toml", "coupon")


def read_fabric(text):
    from fabrics.base.schema import validated

    context = {"source": "scene.toml", "idealised": False}
    validated(FabricFile, parse_source(text, "scene.toml"), "scene.toml", context)


DOORS = {
    "shot": (Scene, read_shot),
    "coupon": (CouponScene, read_coupon),
    "fabric": (FabricFile, read_fabric),
}
ALL = [(door, name) for door, (model, _) in DOORS.items() for name in tables(model) if name]


def heading_of(name):
    """The heading of a table, in a ply where it is one of a ply."""
    if name == "panel.ply":
        return f"[[{name}]]"
    return f"[[panel.ply]]\n[{name}]" if name.startswith("panel.ply.") else f"[{name}]"


def problems(read, text):
    """The lines that reading refuses a text with; none of one that is taken."""
    try:
        read(text)
    except InputError as problem:
        return list(getattr(problem, "problems", (problem,)))
    return []


@pytest.mark.parametrize(("door", "name"), ALL, ids=lambda part: part)
def test_ten_slips_in_a_table_are_told_as_they_were_written(door, name):
    """Line and text are those of the file: here the slip is the only line of its table, behind two others."""
    model, read = DOORS[door]
    kind = tables(model)[name]
    keys = [key for key, field in kind.model_fields.items() if field.title]
    told = 0
    for key, slip in chain.from_iterable(
        zip(keys, SLIPS[k:] + SLIPS[:k]) for k in range(len(SLIPS))
    ):
        text = f"# one\n\n{heading_of(name)}\n{key} = {slip}\n"
        own = [one for one in problems(read, text) if one.key == f"{name}.{key}" and one.allowed]
        # a key that takes it, or a table in its place
        if not own or own[0].message == "is missing":
            continue
        line = str(own[0])
        assert line.startswith(f"scene.toml:{len(text.splitlines())}: {name}.{key}"), line
        assert repr(tomllib.loads(f"slip = {slip}")["slip"]) in line, line
        told += 1
        if told == TEN:
            return
    # tables that only hold tables, and keys that take nearly anything
    assert told >= min(TEN, 4 * len(keys)), (name, told)


def test_a_mistyped_key_of_any_table_has_its_line():
    for door, name in ALL:
        _, read = DOORS[door]
        text = f"\n{heading_of(name)}\n\nnonsensical_1 = 7\n"
        found = [
            one
            for one in problems(read, text)
            if "unknown key" in str(one) or "not a known key" in str(one)
        ]
        assert [one.line for one in found] == [len(text.splitlines())], (door, name)


INSTANCES = {
    "a limit in the user's unit": (
        {"203 mm": "20 ft"},
        "scene.toml:12: panel.opening = '20 ft': must be a length above 0 and at most 5 m (16.4 ft), such as",
    ),
    "the other key of two": (
        {"5.5 mm": "5.5 inch"},
        "scene.toml:7: projectile.diameter = '5.5 inch': must be below half of panel.opening (203 mm, line 12)",
    ),
    "a number that a name brings": (
        {
            'mass = "3 g"\ndiameter = "5.5 mm"\nedge_radius = "0.3 mm"': 'name = "FSP 1.10 g"',
            "203 mm": "1 cm",
        },
        "scene.toml:6: projectile.name = 'FSP 1.10 g' has projectile.diameter = '5.46 mm': must be below half of "
        "panel.opening (1 cm, line 10)",
    ),
    "one of a list": (
        {
            "# a shot": "# a shot",
            '203 mm"\n': '203 mm"\n[history]\nreport_positions = ["2 mm", "0.9 ft"]\n',
        },
        "scene.toml:14: history.report_positions = '0.9 ft': must be within panel.opening (203 mm, line 12), at most "
        "101.5 mm (0.333 ft) from the impact point",
    ),
    "a mass beside a diameter": (
        {"3 g": "300 lb"},
        "scene.toml:6: projectile.mass = '300 lb': must be from 0.0163 to 90.2 g (3.594e-05 to 0.1989 lb), for a body",
    ),
    "a table of several alike": (
        {'203 mm"\n': '203 mm"\n[[panel.ply]]\nangle = "4 deg"\n[[panel.ply]]\ngap = "-1 mil"\n'},
        "scene.toml:16: panel.ply.gap = '-1 mil': must be a length of at least 0",
    ),
    "a group": (
        {'203 mm"\n': '203 mm"\nplies = 3\nply_gap = "3 inch"\n'},
        "scene.toml:14: panel.ply_gap = '3 inch': gap between plies over the thickness of a ply is 176, plausible is",
    ),
    "a value of several lines": (
        {'"203 mm"': '[\n  "7 inch", # one\n\n  "30 ft",\n]'},
        "scene.toml:12: panel.opening = ['7 inch', '30 ft']: must be a length above 0",
    ),
    "a dotted key": (
        {'203 mm"\n': '203 mm"\nboundary.warp.clamp_force = "1 lbm"\n'},
        "scene.toml:13: panel.boundary.warp.clamp_force = '1 lbm': must be a force above 0",
    ),
    "a law in the file": (
        {'"S-720"\n': '"S-720"\nlaw = { a = "9 mil", b = "0.02 mm N^(1/3)" }\n'},
        "scene.toml:4: fabric.law.a = '9 mil': must be below 0.216 mm (8.504 mil), the mean height",
    ),
}


@pytest.mark.parametrize("name", INSTANCES)
def test_message(name):
    changes, line = INSTANCES[name]
    text = SHOT
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    with pytest.raises(InputError) as refused:
        read_shot(text)
    assert str(refused.value).startswith(line)


def test_no_line_is_told_where_it_might_be_another():
    """Two plies have an angle; the check that refuses one of them does not say which."""
    plies = '[[panel.ply]]\nangle = "0 deg"\n[[panel.ply]]\nangle = "30 deg"\n'
    parse_source(SHOT + plies, "scene.toml")
    assert InputError(file="scene.toml", key="panel.ply.angle", allowed="0").line == 0
    of_one = InputError(file="scene.toml", key="panel.ply.angle", value="30 deg", allowed="0")
    assert of_one.line == 16


def test_python_is_told_what_it_gave():
    with pytest.raises(InputError, match=r"must be below half of panel.opening \(1 cm\)"):
        wc.setup("S-720", "90 m/s", opening="1 cm")
    with pytest.raises(
        InputError, match=r"^tolerance = '3000 ft/s': must be below 136 m/s \(446.2 ft/s\), where"
    ):
        wc.critical_velocity("S-720", tolerance="3000 ft/s", check=True)


@pytest.mark.parametrize("share", [0.0094, 0.024])
def test_a_weakened_yarn_blames_nothing_but_its_share(share):
    """Be it beyond all that is plausible, or one with which the yarn fails at a strain that none has."""
    text = SHOT + f'[fabric.weaving_damage]\nmodulus = {share}\nsource = "x"\n'
    with pytest.raises(InputError) as refused:
        read_shot(text)
    line = str(refused.value)
    assert line.startswith(f"scene.toml:14: fabric.weaving_damage.modulus = {share}: ")


def test_what_was_fitted_is_told_with_its_curve(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    sheet = {
        "linear_density": "1100 dtex",
        "fibre_density": "1.44 g/cm^3",
        "modulus": "90 GPa",
        "failure_strain": "3.3 %",
        "crimp": "1.2 %",
        "count": "8.5 / cm",
    }
    for changed in ({}, {"modulus": "0.05 msi"}, {"crimp": "", "thickness": "3 mm"}):
        rows = [f"{key}, {value}" for key, value in (sheet | changed).items() if value]
        (tmp_path / "-".join(["sheet", *changed, "x.csv"])).write_text(
            "\n".join(["key, warp", *rows])
        )
    stiff = [f"{e / 10}, {e * 300}" for e in range(30)]
    (tmp_path / "yarn.csv").write_text("\n".join(["strain [%], force [N]", *stiff]))
    hard = [f"{g}, {1e3 * g**3}" for g in range(0, 50, 2)]
    (tmp_path / "frame.csv").write_text("\n".join(["shear angle [deg], shear stress [MPa]", *hard]))
    for options, line in (
        (
            {"yarn_curve": "yarn.csv"},
            r"^yarn.csv: warp.modulus = '3927.3 GPa' \(fitted: tensile curve of the yarn, yarn.csv\): ",
        ),
        ({"picture_frame": "frame.csv"}, "^frame.csv: shear.G1 is fitted to this curve: "),
        (
            {"values": "sheet-modulus-x.csv"},
            r"^sheet-modulus-x.csv:4: modulus = '0.05 msi': must be from 1 to 1000 GPa \(0.145 to 145 msi\)",
        ),
        (
            {"values": "sheet-crimp-thickness-x.csv"},
            "^sheet-crimp-thickness-x.csv:7: thickness = '3 mm': must be one",
        ),
    ):
        with pytest.raises(InputError, match=line):
            wc.new_fabric("mine.toml", **{"values": "sheet-x.csv"} | options)


def test_the_line_is_that_of_the_parser():
    """Also behind texts of several lines that hold what looks like the key, and of keys given in parts."""
    text = (
        'a = """\n[t]\nkey = 1\n"""\n[other]\nkey = 2\n\n[t]\n# key = 3\nb.key = [\n 4,\n 5,\n]\n'
    )
    text += "[[l]]\nkey = 6\n[[l]]\nkey = 7\n"
    for path, line in (
        (("a",), 1),
        (("other", "key"), 6),
        (("t", "b", "key"), 10),
        (("l", 1, "key"), 17),
        (("t", "key"), 0),
    ):
        assert written.line_of(text, path) == line


def test_amounts_of_other_dimensions_and_quotes_stay():
    text = 'from 1 to 3 kg, such as "2 kg" (or 4 kg) at 5 m'
    assert amounts.in_unit_of("8 lb", text) == text.replace("3 kg", "3 kg (2.205 to 6.614 lb)", 1)
    assert amounts.in_unit_of("8 kg", text) == text
    assert amounts.in_unit_of(0.3, text) == text
    assert re.search("5 m .16.4 ft", amounts.in_unit_of("7 ft", text))


def test_a_message_knows_nothing_of_the_keywords_of_another_call():
    with pytest.raises(InputError, match=r"panel\.opening"):
        wc.setup("S-720", "150 m/s", opening="1 mm")
    with pytest.raises(InputError) as refused:
        wc.sweep("S-720", over={"colour": ["red"]})
    assert 'over={"panel.opening": ["150 mm", "200 mm"]}' in str(refused.value)
