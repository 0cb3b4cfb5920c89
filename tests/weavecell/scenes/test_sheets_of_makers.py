"""Data sheets as makers print them: from a CSV file to a plan without an edit."""

import pytest

import weavecell as wc
from fabrics import projectiles
from fabrics.base.errors import InputError
from fabrics.base.units import si

# of eight sheets, none of which is of a real product: units, marks and headings of all kinds
SHEETS = {
    "ISO, para-aramid": """key,warp,weft,source
linear_density,930 dtex,930 dtex,sheet
tenacity,2350 mN/tex,2300 mN/tex,sheet
modulus,90 GPa,,sheet
fibre_density,1.44 g/cm3,,sheet
failure_strain,3.4 %,,sheet
count,105 / 10 cm,104 / 10 cm,sheet
thickness,0.30 mm,,sheet
""",
    "without a blank, commas": """Key;Warp;Weft
linear_density;1100 dtex;1100 dtex
tenacity;2060 mN/tex;2060 mN/tex
modulus;67,5 GPa;
fibre_density;1.44 g/cm^3;
failure_strain;4,4 %;
count;85/10cm;83/10cm
thickness;0,31 mm;
""",
    "US glass": """key,warp,weft
linear_density,3750 yd/lb,3750 yd/lb
strength,100 N,95 N
modulus,10.5 Msi,
fibre_density,2.58 g/cc,
failure_strain,2.4 %,
count,31 epi,29 ppi
thickness,9.2 mil,
""",
    "US denier": """# rev. B
key\twarp\tweft
linear_density\t840 denier\t840 den
tenacity\t23.4 g/den\t23.4 gpd
modulus\t620 gf/den\t
fibre_density\t1440 kg/m3\t
failure_strain\t3.5 %\t
count\t31 per inch\t31 per inch
thickness\t0.0115 in\t
""",
    "grams a square metre": """key,warp,weft
linear_density,440 dtex,440 dtex
tenacity,245 cN/tex,245 cN/tex
modulus,100 GPa,
fibre_density,1.44 g/cm3,
failure_strain,3.2 %,
count,14 / cm,13.5 / cm
areal_density,125 g/m2,
crimp,1.2 %,1.5 %
""",
    "tex": """key,warp,weft
linear_density,158 tex,158 tex
tenacity,2.03 N/tex,2.03 N/tex
modulus,70.5 GPa,
fibre_density,1.44 g/cm3,
failure_strain,3.6 %,
count,6.7 /cm,6.7 /cm
thickness,0.46 mm,
""",
    "a strip beside tenacity": """key,warp,weft
linear_density,1000 denier,1000 denier
tenacity,22 g/den,22 g/den
breaking_strength,700 lbf/inch,720 lbf/inch
modulus,71 GPa,
fibre_density,1.44 g/cm3,
failure_strain,3.6 %,
count,31 epi,31 ppi
thickness,14 mil,
""",
    "other columns": """Sheet 17,,,
key,warp,weft,page
linear_density,1260 dtex,1260 dtex,1
tenacity,2100 mN/tex,2150 mN/tex,1
modulus,85 GPa,,2
fibre_density,1.44 g/cm3,,2
failure_strain,3.3 %,,2
count,84 / 10 cm,86 / 10 cm,3
thickness,0.34 mm,,3
""",
}

# yarns in a metre, by hand
COUNTS = {
    "ISO, para-aramid": (1050, 1040),
    "without a blank, commas": (850, 830),
    "US glass": (1220.47, 1141.73),
    "grams a square metre": (1400, 1350),
}


@pytest.mark.parametrize("sheet", SHEETS)
def test_a_sheet_becomes_a_plan_without_an_edit(tmp_path, sheet, caplog):
    (tmp_path / "sheet.csv").write_text(SHEETS[sheet])
    with caplog.at_level("INFO", "weavecell"):
        wc.new_fabric(tmp_path / "own.toml", values=tmp_path / "sheet.csv")
    fabric = wc.fabric(tmp_path / "own.toml")
    law = {"a": "0.045 mm", "b": "0.045 mm N^(1/3)"}
    plan = wc.impact(tmp_path / "own.toml", "150 m/s", opening="60 mm", law=law, check=True)
    assert "own" in str(plan)
    if sheet in COUNTS:
        weave = fabric.weave
        assert (weave.warp_count, weave.weft_count) == pytest.approx(COUNTS[sheet], rel=1e-4)
    if "strip" in sheet:
        told = " ".join(record.getMessage() for record in caplog.records)
        assert "the tenacity is used, not the breaking_strength 700 lbf/inch / 720 lbf/inch" in told
        # 22 gf/denier x 1000 denier = 22,000 gf
        assert "the 215.7 N of the tenacity" in told


SAME = {
    "1/m": ("1050 1/m", "105 / 10 cm", "105/10cm", "10.5 / cm", "105 per 10 cm", "105 ends/10 cm"),
    "kg/m": ("0.001 kg/m", "1 g/m", "1000 tex", "496.05465 yd/lb", "1 km/kg", "1000 m/kg"),
    "Pa": ("6894757293.168 Pa", "1 Msi", "1 MSI", "1000 ksi", "6.894757293168 GPa"),
}


@pytest.mark.parametrize("unit", SAME)
def test_spellings_of_one_number(unit):
    for text in SAME[unit]:
        assert si(text, unit) == pytest.approx(si(SAME[unit][0], unit), rel=1e-6), text


@pytest.mark.parametrize(
    "text, name",
    [
        ("FSP 17 grain", "FSP 1.10 g"),
        ("17 gr FSP", "FSP 1.10 g"),
        ("FSP 44 grains", "FSP 2.79 g"),
        ("FSP 20 grain", "FSP 20 grain"),
        ("RCC 16 grain", "RCC 16 grain"),
        ("cube 17 grain", "cube 17 grain"),
        ("9 mm FMJ", "9 mm FMJ 8.0 g"),
        ("9mm fmj", "9 mm FMJ 8.0 g"),
        ("FMJ", "9 mm FMJ 8.0 g"),
        (".44 Magnum", ".44 Magnum SJHP 15.6 g"),
        ("magnum 10.2 g", ".357 Magnum JSP 10.2 g"),
        ("LR", ".22 LR 2.6 g"),
        ("FSP 1.1 g", "FSP 1.10 g"),
        ("RCC 16", "RCC 16 grain"),
        # of several, of another number, of a number alone
        ("FSP", "FSP"),
        ("Magnum", "Magnum"),
        ("8 mm FMJ", "8 mm FMJ"),
        ("9 mm", "9 mm"),
        ("sphere 8 mm", "sphere 8 mm"),
    ],
)
def test_a_projectile_is_the_only_one_that_a_name_means(text, name):
    assert projectiles.known_name(text) == name
    if name in projectiles.list_names():
        assert projectiles.table(text)["name"] == name


def test_every_part_of_a_name_that_one_projectile_has_means_it():
    for name in projectiles.list_names():
        words = name.split()
        for count in range(1, len(words)):
            part = " ".join(words[:count])
            found = projectiles.known_name(part)
            assert found in (part, name) or part in found, (part, found)


def test_a_sphere_of_steel_is_named_by_its_diameter():
    """Its mass is that of the steel of all fragments: 7.103 g at 12 mm, as 8 times that at 6 mm."""
    shape, data = projectiles.entry("sphere 6 mm")
    assert shape == "sphere"
    assert si(data["mass"]["value"], "kg") == pytest.approx(7.103e-3 / 8, rel=1e-3)
    assert projectiles.table("Sphere 0.25 inch")["diameter"] == "0.25 inch"
    with pytest.raises(InputError, match="unknown projectile"):
        projectiles.entry("sphere 5 N")


def test_a_tensile_curve_gives_modulus_and_failure_strain(tmp_path):
    """Straight, 250 N at 3.2 %: the sheet states neither."""
    text = SHEETS["tex"]
    kept = [line for line in text.splitlines() if line[:7] not in ("modulus", "failure", "tenacit")]
    (tmp_path / "sheet.csv").write_text("\n".join(kept))
    strains = [0.32 * k for k in range(11)]
    rows = "".join(f"{e:.4g},{78.125 * e:.6g}\n" for e in strains)
    (tmp_path / "yarn.csv").write_text("Strain (%),Load (N)\n" + rows)
    wc.new_fabric(
        tmp_path / "own.toml", values=tmp_path / "sheet.csv", yarn_curve=tmp_path / "yarn.csv"
    )
    warp = wc.fabric(tmp_path / "own.toml").weave.warp
    assert warp.failure_strain == pytest.approx(0.032, rel=1e-3)
    assert warp.EA == pytest.approx(7812.5, rel=1e-3)


def test_a_sheet_of_two_marks_is_read_where_each_number_is_clear(tmp_path):
    path = tmp_path / "sheet.csv"
    path.write_text(SHEETS["without a blank, commas"].replace("1.44", "1.440"))
    with pytest.raises(wc.InputError, match="they may be decimal commas, or separate thousands"):
        wc.new_fabric(tmp_path / "own.toml", values=path)


# two more, with other fibres, headings and units: a polyethylene and a PBO, neither of which is sold
TO_A_LIMIT = {
    "polyethylene": """Prüfblatt;Gewebe 7
Property;Kette;Warp;Weft
Style;;PE 7;
Fibre;;UHMWPE;
Weave;;Plain 1/1;
Titre / dtex;;880;1320
Fiber density, kg/m3;;970;
Tensile modulus [cN/dtex];;1150;1080
Elongation at break, pct;;3,1;3,0
Ends/Picks / 10 cm;;98;74
Thickness in mm;;0,39;
""",
    "PBO": """Property, Warp, Fill, source
# a comment of the maker
Yarn count [yd/lb], 4460, 4000, sheet
Yarn breaking force [lbf], 83.3, 90.8, sheet
density of the fibre / g/cm3, 1.56, , sheet
Young's modulus (Msi), 26, 25.4, sheet
Elongation at break (%), 2.9, 2.9, sheet
Construction per inch, 24, 22, sheet
Yarn crimp - %, 1.4, 2.1, micrograph
Basis weight (oz/yd2), 6.38, , sheet
""",
}
# by hand: yarns in a metre, mass of a metre of yarn [kg/m], stiffness [N] and strength [N] of a yarn, of warp and weft
BY_HAND = {
    "polyethylene": ((980, 740), (880e-7, 1320e-7), (10120, 14256), (313.7, 427.7)),
    "PBO": ((944.88, 866.14), (1112.2e-7, 1240.2e-7), (12780, 13922), (370.5, 403.9)),
}


@pytest.mark.slow(25)
@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
@pytest.mark.parametrize("sheet", TO_A_LIMIT)
def test_a_sheet_gets_a_limit_without_an_edit(tmp_path, sheet):
    (tmp_path / "sheet.csv").write_text(TO_A_LIMIT[sheet], encoding="utf-8")
    wc.new_fabric(tmp_path / "own.toml", values=tmp_path / "sheet.csv")
    weave = wc.fabric(tmp_path / "own.toml").weave
    found = (
        (weave.warp_count, weave.weft_count),
        tuple(yarn.linear_density for yarn in weave.yarns),
        tuple(yarn.EA for yarn in weave.yarns),
        tuple(yarn.strength for yarn in weave.yarns),
    )
    for ours, theirs in zip(found, BY_HAND[sheet]):
        assert ours == pytest.approx(theirs, rel=2e-2)
    quick = {"scan": False, "residual_shots": 0, "v50_shots": 0, "tolerance": "30 m/s"}
    law = {"a": "0.03 mm", "b": "0.04 mm N^(1/3)"}
    limit = wc.critical_velocity(
        tmp_path / "own.toml", law=law, opening="26 mm", elements_per_crossover=1, **quick
    )
    low, high = limit.bracket
    assert 20 < low < high <= low + 30
