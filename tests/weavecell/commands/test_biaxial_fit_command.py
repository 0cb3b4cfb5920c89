"""`weavecell calibrate --biaxial`: from a file of tests to the law, its folder, and a shot with it."""

from dataclasses import replace

import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from fabrics.surface import ResponseSurface
from shellfabric.cell.model import CellModel
from shellfabric.cell.surface_cell import SurfaceCell
from tests.weavecell.written import names, page_of, rows_of, table_of
from weavecell.studies import biaxial_tests
from weavecell.studies.biaxial_path import to_strength

CLOTH = catalogue.load("glass-unbalanced")
LAW = CompressionLaw(1.9e-4, 1.2e-4)
HEADING = "test, warp strain [%], weft strain [%], warp load [N], weft load [N]"


def lines(cell, **ratios):
    rng = np.random.default_rng(7)
    rows = [HEADING]
    for name, ratio in ratios.items():
        path = to_strength(cell, ratio, 16)
        loads = path.tension + [8.0, 1.0] * rng.standard_normal(path.tension.shape)
        for strain, load in zip(100 * path.strain, loads):
            rows.append(f"{name}, {strain[0]:.5f}, {strain[1]:.5f}, {load[0]:.3f}, {load[1]:.3f}")
    return "\n".join(rows)


def test_from_the_curves_to_a_folder_that_loads_back(succeed, tmp_path):
    text = lines(CellModel(CLOTH, (LAW, LAW)), even=(1, 1), across=(0.5, 1))
    (tmp_path / "curves.csv").write_text(text)
    counted = succeed("calibrate glass-unbalanced --biaxial curves.csv --fitted even --check")
    assert "2 tests, 1 fitted test, 32 states, 2 constants" in counted
    assert names(tmp_path) == "curves.csv"
    out = succeed("calibrate glass-unbalanced --biaxial curves.csv --fitted even --out r")
    assert "predicted strains 0.5 : 1" in out
    expected = (
        "biaxial-fit.json curves.csv fabric-keys.toml law.json pictures report.html tests.csv"
    )
    assert names(tmp_path / "r") == expected

    told = table_of(tmp_path / "r", "biaxial-fit.json")
    law = CompressionLaw.from_json(tmp_path / "r" / "law.json")
    assert (told["a_m"], told["b_m_N^(1/3)"]) == (law.a, law.b)
    assert law.a_interval[0] < LAW.a < law.a_interval[1]
    assert law.fabric == "glass-unbalanced"
    assert list(told["constants"]) == ["a", "b"]
    assert told["constants"]["b"]["interval"] == list(law.b_interval)
    rows = rows_of(tmp_path / "r", "tests.csv")
    roles = [(row["test"], row["role"], row["verdict"]) for row in rows]
    assert roles == [("even", "fitted", "agrees"), ("across", "predicted", "agrees")]
    row = rows_of(tmp_path / "r", "curves.csv")[20]
    assert (row["test"], row["role"]) == ("across", "predicted")
    measured = float(row["load_warp_N"]) - float(row["load_computed_warp_N"])
    assert 0 < abs(measured) < 30
    page = page_of(tmp_path / "r")
    assert "Measured less computed loads" in page
    assert "A flat profile" in page

    saved = wc.load(tmp_path / "r")
    assert saved.summary()["a_m"] == law.a
    table = saved.to_dataframe()
    assert table["rms_weft_N"].tolist() == [float(row["rms_weft_N"]) for row in rows]
    # what follows takes the law
    path = wc.biaxial("glass-unbalanced", ratio=["1:1"], law=tmp_path / "r" / "law.json")
    assert path.summary()["law"].endswith("law.json")
    keys = (tmp_path / "r" / "fabric-keys.toml").read_text()
    assert f'a = {{ value = "{1e3 * law.a:.4g} mm"' in keys


def test_a_fabric_without_a_law_gets_its_first_one(tmp_path):
    """As an own fabric has none; the law is that of a fit which begins with another."""
    text = lines(CellModel(CLOTH, (LAW, LAW)), even=(1, 1), across=(0.5, 1))
    (tmp_path / "tests.csv").write_text(text)
    bare = replace(CLOTH, laws=None)
    found = wc.calibrate(bare, biaxial=tmp_path / "tests.csv", out=tmp_path / "r")
    known = wc.calibrate(CLOTH, biaxial=tmp_path / "tests.csv")
    for key in ("a", "b"):
        assert getattr(found.law, key) == pytest.approx(getattr(known.law, key), rel=1e-4)
    assert found.fabric.laws == (found.law, found.law)
    with pytest.raises(InputError, match="with a and b: fabric glass-unbalanced has no"):
        wc.calibrate(bare, biaxial=tmp_path / "tests.csv", constants="a")


def test_a_cell_that_shots_do_not_have_is_handed_on_as_a_surface(tmp_path):
    """Straight yarns, whose stiffness and foot are read from a tensile curve of the warp."""
    EA = 68000.0
    slack = 7e-4
    e = np.linspace(0, 0.0125, 40)
    pulled = EA * (e + slack * np.expm1(-e / slack))
    rows = "\n".join(f"{100 * s:.6f}, {f:.5f}" for s, f in zip(e, pulled))
    (tmp_path / "warp.csv").write_text(f"strain [%], force [N]\n{rows}\n0.9, 12\n")
    warp = CLOTH.weave.warp
    softer = CLOTH.with_yarns(E=(EA / warp.A_s, CLOTH.weave.weft.E))
    cell = CellModel(softer, (LAW, LAW), centreline="straight", slack=(slack, 0.0))
    (tmp_path / "tests.csv").write_text(lines(cell, even=(1, 1)))
    found = wc.calibrate(
        CLOTH,
        biaxial=tmp_path / "tests.csv",
        centreline="straight",
        yarn_curve=[f"warp={tmp_path / 'warp.csv'}"],
        out=tmp_path / "r",
    )
    assert found.fit.model.slack == pytest.approx((slack, 0.0), rel=1e-4)
    yarn = found.fabric.weave.warp
    assert yarn.EA == pytest.approx(EA, rel=1e-4)
    assert yarn.strength == pytest.approx(pulled[-1], rel=1e-4)
    assert found.law.a_interval[0] < LAW.a < found.law.a_interval[1]
    assert "surface = 'surface.h5'" in str(found)
    surface = ResponseSurface.read(tmp_path / "r" / "surface.h5")
    table = SurfaceCell(found.fabric, surface).table(61)
    state = found.fit.model.solve(1.009, 1.011)
    near = [
        int(abs(axis - 1 - x).argmin())
        for axis, x in ((table.stretch1, 0.009), (table.stretch2, 0.011))
    ]
    state = found.fit.model.solve(table.stretch1[near[0]], table.stretch2[near[1]])
    for m, limit in ((1, 850), (2, 80)):
        read = table.values[f"N{m}"][near[0], near[1]]
        assert read == pytest.approx(float(state[f"N{m}"]), abs=0.01 * limit)


def test_a_constant_that_is_kept_though_the_tests_exclude_it_is_a_doubt(tmp_path):
    """b of the catalogue is no third of that which made the tests; with its own it is none. Three fitted ratios are not
    told to try another."""
    text = lines(CellModel(CLOTH, (LAW, LAW)), even=(1, 1), across=(0.5, 1), along=(1, 0.4))
    (tmp_path / "tests.csv").write_text(text)
    for b, doubted in ((0.3 * LAW.b, True), (LAW.b, False)):
        law = CompressionLaw(LAW.a, b)
        given = replace(CLOTH, laws=(law, law))
        found = wc.calibrate(given, biaxial=tmp_path / "tests.csv", constants="a")
        assert ("the tests exclude the b that was kept: fit a and b" in found.doubts) == doubted
    loose = [
        one
        for one in wc.calibrate(CLOTH, biaxial=tmp_path / "tests.csv").lines()
        if "do not determine" in one
    ]
    assert not any("another ratio" in line for line in loose)


@pytest.mark.parametrize(
    "heading, of_a_metre",
    [
        (
            "Ratio,Warp strain (%),Weft strain (%),Warp load per width (N/mm),Weft load per width (N/mm)",
            1e3,
        ),
        (
            "Test No.,Elongation warp [%],Elongation fill [%],Force warp [N/5cm],Force fill [N/5cm]",
            20,
        ),
        (
            "Load ratio,strain in warp [%],strain in fill [%],tension in warp [lbf/in],tension in fill [lbf/in]",
            175.12684,
        ),
        ("specimen,strain warp,strain weft,warp line load,weft line load\n-,%,%,kN/m,kN/m", 1e3),
        (
            "Test,warp strain [%],weft strain [%],Membrane force warp [N/m],Membrane force weft [N/m]",
            1,
        ),
    ],
)
def test_headings_of_biaxial_machines(tmp_path, heading, of_a_metre):
    """Loads per width are those of one yarn by its spacing, unlike for warp and weft."""
    path = tmp_path / "t.csv"
    path.write_text(
        heading + "".join(f"\n1:2,{0.1 * n},{0.2 * n},{2 * n},{3 * n}" for n in range(6))
    )
    (one,) = biaxial_tests.read(path, (1e-3, 2e-3))
    assert one.name == "1:2"
    assert one.strain[-1] == pytest.approx([0.005, 0.01])
    assert one.load[-1] == pytest.approx([10e-3 * of_a_metre, 30e-3 * of_a_metre], rel=1e-6)


LABORATORY = "Ratio;Strain warp (%);Strain weft (%);Warp tension [kN/m];Weft tension [kN/m]"


def test_a_file_as_laboratories_write_it_is_the_same(tmp_path):
    """Ratio, strain first or last, tension per width, semicolons and decimal commas: the same constants."""
    text = lines(CellModel(CLOTH, (LAW, LAW)), even=(1, 1), across=(0.5, 1))
    (tmp_path / "mine.csv").write_text(text)
    rows = [LABORATORY]
    for line in text.splitlines()[1:]:
        name, *cells = line.split(", ")
        numbers = np.array(cells, float)
        numbers[2:] /= 1e3 * np.array(CLOTH.weave.yarn_spacing)
        name = {"even": "1:1", "across": "1:2"}[name]
        rows.append(";".join([name, *(f"{number:.9f}".replace(".", ",") for number in numbers)]))
    (tmp_path / "theirs.csv").write_text("\n".join(rows))
    mine, theirs = (
        wc.calibrate(CLOTH, biaxial=tmp_path / f"{name}.csv") for name in ("mine", "theirs")
    )
    assert [one.name for one in theirs.tests] == ["1:1", "1:2"]
    for key in ("a", "b"):
        assert getattr(theirs.law, key) == pytest.approx(getattr(mine.law, key), rel=1e-5)
    warp, weft = CLOTH.weave.yarn_spacing
    assert warp != pytest.approx(weft)
