"""Rows of a data sheet under the names that makers use."""

import itertools

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.base.units import si
from weavecell.scenes import fabric_file, sheet_names

PLAIN = {
    "linear_density": ("1100 dtex", "1090 dtex"),
    "fibre_density": ("1.44 g/cm3", ""),
    "modulus": ("99 GPa", "97 GPa"),
    "failure_strain": ("3.3 %", "3.2 %"),
    "count": ("85 / 10 cm", "82 / 10 cm"),
    "thickness": ("0.28 mm", ""),
    "areal_density": ("190 g/m2", ""),
}
FORMS = (str, str.upper, str.title, lambda name: f"{name}:", lambda name: name.replace(" ", "_"))


def sheet(tmp_path, rows):
    """A CSV file of {name: (warp, weft)}."""
    path = tmp_path / "sheet.csv"
    lines = [f"{name};{warp};{weft}" for name, (warp, weft) in rows.items()]
    path.write_text("key;warp;weft\n" + "\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("key", [key for key in PLAIN if key in sheet_names.NAMES])
def test_every_name_of_a_maker_is_its_key_in_every_form(key, tmp_path):
    plain = fabric_file.read_values(sheet(tmp_path, PLAIN))
    for number, name in enumerate(sheet_names.NAMES[key]):
        found = sheet_names.find(name)
        assert key in found.keys
        assert all(sheet_names.find(form(name)) == found for form in FORMS)
        # "ends" is of the warp alone
        if len(found.families) != 1 and name not in PLAIN:
            written = FORMS[number % len(FORMS)](name)
            rows = {written if row == key else row: cells for row, cells in PLAIN.items()}
            assert fabric_file.read_values(sheet(tmp_path, rows)) == plain, written


def test_the_unit_decides_between_the_keys_of_a_name():
    for names in sheet_names.NAMES.values():
        for name in names:
            keys = [key for key in sheet_names.find(name).keys if key in fabric_file.ALL]
            for one, other in itertools.permutations(keys, 2):
                assert not fabric_file.ALL[one].takes(fabric_file.ALL[other].example), name


@pytest.mark.parametrize(
    "name",
    [
        "Weight [g/m2]",
        "Areal density (g/m²)",
        "areal_density [g/m^2]",
        "WEIGHT / g/m2",
        "Areal density, g/m2",
        "areal-density in g/m2",
        "Weight: [g/m2]",
        "Weight gsm",
    ],
)
def test_a_number_alone_has_the_unit_behind_its_name(name, tmp_path):
    rows = PLAIN | {"areal_density": None}
    rows = {
        name if key == "areal_density" else key: cells or ("190", "") for key, cells in rows.items()
    }
    values, _ = fabric_file.read_values(sheet(tmp_path, rows))
    value = values["areal_density"]
    assert si(value.warp, "kg/m^2") == 0.19


@pytest.mark.parametrize(
    "unit", ["/ 10 cm", "/10cm", "(1/10 cm)", "[/ 10 cm]", ", / 10 cm", "in 1/10cm"]
)
def test_a_solidus_is_of_the_unit_where_it_makes_one(unit, tmp_path):
    rows = {f"Ends/Picks {unit}" if key == "count" else key: cells for key, cells in PLAIN.items()}
    rows[f"Ends/Picks {unit}"] = ("85", "82")
    values, _ = fabric_file.read_values(sheet(tmp_path, rows))
    count = values["count"]
    assert [si(text, "1/m") for text in (count.warp, count.weft)] == pytest.approx([850, 820])


def test_a_unit_of_a_sheet_is_read_as_one_of_any_heading(tmp_path):
    """`pct` is what instruments write; tables of curves took it, sheets did not."""
    rows = {key: cells for key, cells in PLAIN.items() if key != "failure_strain"}
    rows["Elongation at break, pct"] = ("3.3", "3.2")
    values, _ = fabric_file.read_values(sheet(tmp_path, rows))
    assert values["failure_strain"].warp == "3.3 %"


def test_a_name_that_goes_on_is_no_name(tmp_path):
    with pytest.raises(InputError, match="Weight of the roll"):
        fabric_file.read_values(sheet(tmp_path, PLAIN | {"Weight of the roll": ("0.3 kg", "")}))


def test_descriptions_are_left_out_and_told(tmp_path, caplog):
    caplog.set_level("INFO", "weavecell")
    rows = {"Style": ("K 1", ""), "Roll width": ("150 cm", "")} | PLAIN
    assert fabric_file.read_values(sheet(tmp_path, rows)) == fabric_file.read_values(
        sheet(tmp_path, PLAIN)
    )
    assert "left out, line 2: Style K 1" in caplog.text
    assert "left out, line 3: Roll width 150 cm" in caplog.text


def test_a_weave_of_a_sheet_is_that_of_the_fabric_file(tmp_path):
    rows = {"Weave pattern": ("2/2 Twill", "")} | PLAIN
    values, _ = fabric_file.read_values(sheet(tmp_path, rows))
    fabric = fabric_file.Draft("own", values).write(tmp_path / "own.toml")
    assert fabric.weave.pattern.name == "twill 2/2"
    assert 'weave = "twill 2/2"' in (tmp_path / "own.toml").read_text()


BASKET = """
Property;Warp;Weft
Style;"735, ballistic";
Weave;2 x 2 Basket;
Yarn;Kevlar 29;
Linear density (denier);1500;1500
Fiber density (g/cm3);1.44;
Modulus (g/den);555;
Tenacity (g/den);23.0;
Elongation at break (%);3.6;
Ends/Picks per inch;35;34
Thickness (mil);23.6;
Weight (oz/yd2);14.5;
"""
TWILL = """
Property;Warp;Weft
Style;"T 170";
Weave style;4-harness twill 3/1;
Titre / dtex;1270;1260
Fibre density [g/cm3];1,44;
Modulus [GPa];112;
Tensile strength [MPa];2900;
Elongation at break, pct;2,4;
Ends/Picks [1/cm];6,7;6,6
Thickness [mm];0,29;
Weight [g/m2];173;
"""
SATIN = """
Property;Warp;Weft
Style;181;
Weave;8-HS Satin;
Yarn;Kevlar 49;
Linear density (denier);380;380
Fiber density (g/cm3);1.44;
Modulus (Msi);16.3;
Tensile strength (ksi);435;
Elongation at break (%);2.4;
Ends/Picks per inch;50;49
Thickness (mil);9;
Weight (oz/yd2);5.0;
"""
DENIER, INCH = 1 / 9e6, 0.0254


@pytest.mark.parametrize(
    "printed, weave, straight, mass",
    [
        (BASKET, "basket 2x2", 1500 * DENIER * (35 + 34) / INCH, 0.49163),
        (TWILL, "twill 3/1", 1270e-7 * 670 + 1260e-7 * 660, 0.173),
        (SATIN, "satin 8", 380 * DENIER * (50 + 49) / INCH, 0.16953),
    ],
)
def test_sheets_of_weaves_with_floats_have_the_mass_that_is_printed(
    printed, weave, straight, mass, tmp_path
):
    """`straight` is the mass [kg/m2] without crimp, `mass` that of the sheet."""
    (tmp_path / "sheet.csv").write_text(printed.strip(), encoding="utf-8")
    wc.new_fabric(tmp_path / "own.toml", values=tmp_path / "sheet.csv")
    fabric = wc.fabric(tmp_path / "own.toml")
    assert fabric.weave.pattern.name == weave
    assert fabric.weave.areal_density == pytest.approx(mass, rel=0.02)
    warp, weft = (yarn.crimp for yarn in fabric.weave.yarns)
    assert straight * (1 + min(warp, weft)) < mass < straight * (1 + max(warp, weft))
    assert not any("thickness over spacing" in note for note in fabric.notes)


def test_a_row_yarn_is_a_name_or_a_linear_density(tmp_path, caplog):
    caplog.set_level("INFO", "weavecell")
    values = fabric_file.read_values(sheet(tmp_path, PLAIN))
    named = {"Yarn": ("Kevlar 29", "")} | PLAIN
    assert fabric_file.read_values(sheet(tmp_path, named)) == values
    assert "left out, line 2: Yarn Kevlar 29" in caplog.text
    others = {key: cells for key, cells in PLAIN.items() if key != "linear_density"}
    numbers = {"Yarn": PLAIN["linear_density"]} | others
    assert fabric_file.read_values(sheet(tmp_path, numbers)) == values


def test_a_weave_of_no_pattern_is_refused(tmp_path):
    with pytest.raises(InputError) as refused:
        fabric_file.read_values(sheet(tmp_path, {"Weave": ("triaxial", "")} | PLAIN))
    for word in ("sheet.csv", "line 2, weave", "triaxial", "twill 2/2"):
        assert word in str(refused.value)


def test_a_misspelt_row_is_still_refused(tmp_path):
    with pytest.raises(InputError, match='did you mean "thickness"'):
        fabric_file.read_values(sheet(tmp_path, PLAIN | {"thicknes": ("0.3 mm", "")}))


@pytest.mark.parametrize(
    "weave", ["PLAIN", "plain weave", "Plain (1/1)", "tabby", "1/1, plain", "linen weave", ""]
)
def test_a_plain_weave_has_many_names(weave, tmp_path):
    values, _ = fabric_file.read_values(sheet(tmp_path, {"Weave pattern": (weave, "")} | PLAIN))
    stated = values.pop("weave", None)
    assert values == fabric_file.read_values(sheet(tmp_path, PLAIN))[0]
    assert (stated is None) == (weave == "")
    assert stated is None or stated.warp == "plain"


@pytest.mark.parametrize(
    "weave", ["plain derivative, basket 2x2", "not plain", "plain/twill", "3/1 plain", "semi-plain"]
)
def test_a_weave_that_is_plain_in_part_is_refused(weave, tmp_path):
    with pytest.raises(InputError, match="line 2, weave"):
        fabric_file.read_values(sheet(tmp_path, {"Weave": (weave, "")} | PLAIN))


def test_a_sheet_as_its_maker_prints_it(tmp_path, caplog):
    """Numbers alone in both columns, unlike for warp and weft, each with the unit of its row."""
    caplog.set_level("INFO", "weavecell")
    printed = {
        "Titre (dtex)": ("1100", "1090"),
        "Fiber density (g/cm3)": ("1.44", ""),
        "Young’s modulus [GPa]": ("99", "97"),
        "Elongation at break [%]": ("3.3", "3.2"),
        "Ends/Picks [1/cm]": ("8.5", "8.2"),
        "Fabric thickness [mm]": ("0.28", ""),
        "Weight [g/m2]": ("190", ""),
    }
    found, _ = fabric_file.read_values(sheet(tmp_path, printed))
    assert {key: (value.warp, value.weft) for key, value in found.items()} == {
        "linear_density": ("1100 dtex", "1090 dtex"),
        "fibre_density": ("1.44 g/cm3", "1.44 g/cm3"),
        "modulus": ("99 GPa", "97 GPa"),
        "failure_strain": ("3.3 %", "3.2 %"),
        "count": ("8.5 / cm", "8.2 / cm"),
        "thickness": ("0.28 mm", ""),
        "areal_density": ("190 g/m2", ""),
    }
    assert "line 6: Ends/Picks [1/cm] is taken for count" in caplog.text
