"""Data sheets as makers print them: `tests/data/sheets.toml` has what a careful reader takes from each."""

import tomllib
from pathlib import Path

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.fabric_tables import FAMILIES
from weavecell.scenes import printed_sheet
from weavecell.scenes.sheet_names import ALL

DATA = Path(__file__).parents[2] / "data"
SHEETS = tomllib.loads((DATA / "sheets.toml").read_text())
# in each kind of cells; they name nothing that is known
NOISE = (
    "Zorblat index: 0.42 mm",
    "Zorblat;31 x 31;/ inch",
    "Zorblat,930 dtex,900 dtex",
    "see page 4 of 31",
)


def read(path):
    """{key: (warp, weft)} of a sheet as written, with its fibre family; empty if it is refused."""
    try:
        sheet = printed_sheet.read(path)
    except InputError:
        return {}
    values = {key: (value.warp, value.weft or value.warp) for key, value in sheet.values.items()}
    return values | ({"family": (sheet.family, sheet.family)} if sheet.family else {})


def number(key, text):
    return ALL[key].read(text)[0] if key in ALL else text


@pytest.mark.parametrize("name", SHEETS)
def test_what_is_read_of_a_sheet_is_right(name):
    """None wrong, nothing that is of something else, and nine of ten keys."""
    truth = {key: text for key, text in SHEETS[name].items() if key not in ("layout", "held_back")}
    found = read(DATA / "sheets" / name)
    assert set(found) <= set(truth)
    for key, texts in found.items():
        pair = truth[key] if isinstance(truth[key], list) else [truth[key]] * 2
        for ours, theirs in zip(texts, pair):
            # two units of a sheet agree within their rounding
            near = pytest.approx(number(key, theirs), rel=0.012) if key in ALL else theirs
            assert number(key, ours) == near, key
    assert name == "pair.txt" or len(found) >= 0.9 * len(truth)


@pytest.mark.parametrize("name", SHEETS)
def test_a_line_that_is_not_understood_never_changes_a_value(name, tmp_path):
    plain = read(DATA / "sheets" / name)
    lines = (DATA / "sheets" / name).read_text().splitlines()
    for place in range(len(lines) + 1):
        noise = NOISE[place % len(NOISE)]
        (tmp_path / name).write_text("\n".join([*lines[:place], noise, *lines[place:]]))
        found = read(tmp_path / name)
        # a name and its values in the lines below it may be torn apart
        assert found.items() <= plain.items(), (place, noise)
        assert found == plain or name in ("CX-1100.txt", "KV-5300.txt"), (place, noise)


# none of them says what its number is of, or which of several is meant
TRAPS = """
Tear strength: 300 N/5cm
Laminate thickness: 0.9 mm
Thickness of laminate: 0.9 mm
Total thickness: 4.2 mm
Thickness (10 layers): 3.1 mm
Pack thickness: 3.1 mm
Filament linear density: 1.65 dtex
Denier per filament: 1.5
Roll weight: 45 kg
Weight per linear metre: 310 g/m
Width: 1.6 mm
Yarn thickness: 0.2 mm
Thickness: 0.28 – 0.32 mm
Thickness: 0.28 to 0.32 mm
Thickness: max. 0.32 mm
Thickness: min 0.28 mm
Thickness: 0.28 / 0.32 mm
Weight: 200 g/m2 (dry), 260 g/m2 (impregnated)
Weight: 200 g/m2 or 210 g/m2
Weight: 200
Prepreg weight: 260 g/m2
Elongation: 4 %
Breaking strength: 900 N
Breaking strength: 780 lbf/in warp only
Tensile strength of the fabric: 1200 MPa
Tensile strength: 480 MPa laminate
Count: 31 x 31
Count: 31 x 31 x 4 per inch
Fabric density: 0.80 g/cm3
Bulk density: 0.80 g/cm3
Note: the thickness is 0.30 mm
Crimp: 2
Thickness: 0.3 m
Panel areal density: 5 kg/m2
"""


@pytest.mark.parametrize("line", TRAPS.strip().splitlines())
def test_a_number_of_something_else_is_left(line, tmp_path):
    path = tmp_path / "own.txt"
    path.write_text(f"Fibre: Kevlar 129\nYarn: 1000 denier\n{line}\n")
    assert read(path) == {"linear_density": ("1000 denier",) * 2, "family": ("para-aramid",) * 2}


@pytest.mark.parametrize(
    "line, text",
    [
        ("Yarn: 1500/1000 denier", None),
        ("Yarn: 2 x 840 denier", None),
        ("Yarn: 1680 dtex 2-ply", None),
        ("Yarn: 1000 denier (1670 dtex)", None),
        ("Yarn: 400-600 denier", None),
        ("Yarn: 840 or 1000 denier", None),
        ("Yarn count EN ISO 2060 dtex 930 ± 20", "930 dtex"),
        ("Yarn: 1050/140 denier", "1050 denier"),
        ("Yarn: 1100f1000 dtex", "1100 dtex"),
        ("Yarn: 1,100 dtex", "1100 dtex"),
        ("Yarn: 1.100 dtex", "1100 dtex"),
        ("Yarn: 1 100 dtex", "1100 dtex"),
        ("Yarn: Kevlar KM2 600d, 400 filaments", "600 denier"),
        ("Yarn: ECG 75 1/0", "66.141 tex"),
        ("TITRE 1760 DTEX", "1760 dtex"),
    ],
)
def test_a_linear_density_is_that_of_one_yarn(line, text, tmp_path):
    path = tmp_path / "own.txt"
    path.write_text(f"{line}\nThickness: 0.3 mm\n")
    assert read(path).get("linear_density") == (None if text is None else (text, text))


def test_lines_that_disagree_are_both_left(tmp_path):
    path = tmp_path / "own.txt"
    path.write_text(
        "Yarn: Kevlar 600 denier\nYarn: Kevlar 930 dtex\nCrimp: 0 %\nThickness: 0.3 mm\n"
    )
    assert set(read(path)) == {"crimp", "thickness", "family"}
    assert "lines 1 and 2 disagree" in printed_sheet.read(path).lines[0].why


@pytest.mark.parametrize(
    "line, warp, weft",
    [
        ("Warp: 31 ends/in\nWeft: 30 picks/in", "31 / inch", "30 / inch"),
        ("EPI: 31\nPPI: 30", "31 / inch", "30 / inch"),
        ("Sett: 12.2 ends/cm x 11.8 picks/cm", "12.2 / cm", "11.8 / cm"),
        ("Construction: weft 30/in; warp 31/in", "31 / inch", "30 / inch"),
        ("Thread count (warp/weft): 31/30 per inch", "31 / inch", "30 / inch"),
        ("Fadendichte (Fd/cm): K 12,2 / S 11,8", "12.2 / cm", "11.8 / cm"),
        # 1000 denier of 122 and 118 in 10 cm are 267 g/m2
        ("Count: 122 x 118\nWeight: 272 g/m2", "122 / 10 cm", "118 / 10 cm"),
        ("Count: 12.2 x 11.8\nWeight: 272 g/m2", "12.2 / cm", "11.8 / cm"),
        ("Count: 31 x 30\nWeight: 272 g/m2", "31 / inch", "30 / inch"),
    ],
)
def test_counts_in_many_forms(line, warp, weft, tmp_path):
    path = tmp_path / "own.txt"
    path.write_text(f"Yarn: 1000 denier\n{line}\n")
    assert read(path)["count"] == (warp, weft)


@pytest.mark.parametrize(
    "name", ["S-7310.csv", "4711-K.csv", "T-482.csv", "K-FAB-300.txt", "PP-29.txt"]
)
def test_a_sheet_becomes_a_fabric_or_names_what_it_needs(name, tmp_path, caplog):
    """Four lines: read, assumed, missing, written."""
    target = tmp_path / "own.toml"
    with caplog.at_level("INFO", "weavecell"):
        wc.new_fabric(target, values=DATA / "sheets" / name)
    told = [record.getMessage() for record in caplog.records]
    assert [line.split()[0] for line in told] == [f"{name}:", "assumed:", "missing:", "written"]
    if name == "T-482.csv":  # no fibre
        assert "missing: fibre_density, modulus, or run again with" in told[2]
        with pytest.raises(InputError, match="fibre_density"):
            wc.fabric(target)
        return
    law = {"a": "0.045 mm", "b": "0.045 mm N^(1/3)"}
    plan = wc.impact(target, "150 m/s", opening="60 mm", law=law, check=True)
    assert "own" in str(plan)
    text = target.read_text()
    assert name != "PP-29.txt" or "not used (its name is not known): Cured ply thickness" in text


def test_a_value_that_contradicts_the_rest_is_left_out(tmp_path, caplog):
    """1000 denier of 31 and 30 an inch are 267 g/m2, and are thicker than 0.1 mm."""
    path = tmp_path / "sheet.txt"
    path.write_text(
        "Fibre: Kevlar\nYarn: 1000 denier\nCount: 31 x 30 / inch\nWeight: 410 g/m2\nThickness: 0.35 mm\n"
    )
    with caplog.at_level("INFO", "weavecell"):
        wc.new_fabric(tmp_path / "own.toml", values=path)
    assert "left out, for they contradict the rest: areal_density" in caplog.text
    weave = wc.fabric(tmp_path / "own.toml").weave
    assert weave.areal_density == pytest.approx(0.267, rel=0.05)
    assert [weave.warp_count, weave.weft_count] == pytest.approx(
        [si("31 / inch", "1/m"), si("30 / inch", "1/m")]
    )
    assert [yarn.linear_density for yarn in weave.yarns] == pytest.approx(
        [si("1000 denier", "kg/m")] * len(FAMILIES)
    )


@pytest.mark.parametrize(
    "text", ["", "strain [%], force [N]\n0, 0\n1, 40\n", "lorem ipsum\n" * 20, "1,2\n" * 1200]
)
def test_a_file_of_which_nothing_is_understood_is_refused(text, tmp_path):
    (tmp_path / "sheet.txt").write_text(text)
    with pytest.raises(InputError, match=r"sheet\.txt"):
        wc.new_fabric(tmp_path / "own.toml", values=tmp_path / "sheet.txt")
    assert not (tmp_path / "own.toml").exists()
