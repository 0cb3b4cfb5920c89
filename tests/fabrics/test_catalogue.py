"""The catalogue's files, broken files, units, whole files, and the response surface's file."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from fabrics.files import replace_whole, write_whole
from fabrics.surface import ResponseSurface
from fabrics.units import si

GOOD = (catalogue._FOLDER / "S-720.toml").read_text()


def test_every_number_of_the_catalogue_has_a_source():
    assert len(catalogue.list_names()) == 8
    for name in catalogue.list_names():
        fabric = catalogue.load(name)
        assert fabric.name == name
        assert len(fabric.sources) >= 14
        for key, entry in fabric.sources.items():
            assert entry["source"], f"{name} {key}"
            assert entry["status"] in catalogue.STATUSES


def test_errata_are_in_the_data():
    assert catalogue.load("S-728").laws[0].a == pytest.approx(4.4e-5)  # E-01
    assert catalogue.load("S-720").laws[1].b == pytest.approx(5.8e-5)  # E-03
    assert catalogue.load("glass-unbalanced").laws[0].F0 == pytest.approx(0.4423, abs=1e-4)  # E-30
    assert catalogue.load("S-720").weave.warp.E == pytest.approx(9.6e10)  # E-25


def test_effective_linear_density_only_where_known():
    with pytest.raises(InputError, match="glass-balanced has no effective"):
        catalogue.load("glass-balanced").with_effective_density()


def test_a_users_file_needs_no_sources(tmp_path):
    plain = tmp_path / "mine.toml"
    yarn = (
        '\nlinear_density = "1500 denier"\nfibre_density = "1440 kg/m^3"\nmodulus = "96 GPa"\nfailure_strain = 0.03\n'
    )
    plain.write_text("".join(f'[{f}]{yarn}crimp = "1 %"\ncount = "17 / inch"\n' for f in ("warp", "weft")))
    fabric = catalogue.load(plain)
    assert fabric.name == "mine"
    assert fabric.laws is None
    assert fabric.sources["warp.crimp"]["status"] == "user"


BROKEN = {
    "negative crimp": ("2.18 %", "-2.18 %", "warp.crimp = '-2.18 %': must be from 0 to 50 %"),
    "wrong unit": (
        '"20 / inch"',
        '"20 inch"',
        "warp.count = '20 inch': must be a text with a unit that converts to 1/m",
    ),
    "no unit": ('"96 GPa"', "96", "warp.modulus = 96: must be a text with a unit that converts to Pa"),
    "unknown key": (
        "[shear]",
        '[shear]\nG3 = "1 Pa"',
        "shear.G3: is not a known key; must be one of G1, G2, gamma1, gamma2",
    ),
    "unknown status": ('"measured"', '"guessed"', "status = 'guessed': must be one of measured"),
    "missing value": ("crimp   ", "crimpx  ", "warp.crimpx: is not a known key"),
    "locked before it touches": ('"0.49"', '"0.10"', "shear.gamma2 = '0.10': must be above gamma1 = 0.24"),
    "not TOML": ("[shear]", "[shear", "is not TOML"),
    "zero modulus": ('"96 GPa"', '"0 GPa"', "warp.modulus = '0 GPa': must be from 1 to 1000 GPa"),
    "packed from the start": ('"0.70"', '"1.20"', "solid.warp.Vf0 = '1.20': must be below V_c = 1"),
    "unknown section": ('"sine"', '"square"', "section = 'square': must be sine, ellipse or conforming"),
    "infinite": ('"96 GPa"', '"inf GPa"', "warp.modulus = 'inf GPa': must be a text with a unit"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_fabric_files_have_one_clear_line(tmp_path, case):
    old, new, line = BROKEN[case]
    assert old in GOOD
    path = tmp_path / "broken.toml"
    path.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as problem:
        catalogue.load(path)
    text = str(problem.value)
    assert line in text
    assert str(path) in text
    assert "\n" not in text
    assert problem.value.exit_code == 2


def test_unknown_fabrics_and_missing_files(tmp_path):
    with pytest.raises(InputError, match=r"fabric = 'S-999': must be one of S-720"):
        catalogue.load("S-999")
    with pytest.raises(InputError, match="cannot be read"):
        catalogue.load(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("92.5 m/s", "m/s", 92.5),
        ("1420 denier", "kg/m", 1420 * 1e-3 / 9000),
        ("20 / inch", "1/m", 20 / 0.0254),
        ("2.18 %", "", 0.0218),
        (0.03, "", 0.03),
        ("0.058 mm * N^(1/3)", "m * N**(1/3)", 5.8e-5),
        ("300 us", "s", 3e-4),
    ],
)
def test_units(text, unit, value):
    assert si(text, unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("bad", ["92.5 m", "fast", 92.5, True, None, ["1 m/s"], "nan m/s", ""])
def test_bad_units_name_the_key(bad):
    with pytest.raises(InputError, match=r"scene.toml: velocity.*must be a text with a unit that converts to m/s"):
        si(bad, "m/s", file="scene.toml", key="velocity")


def test_files_are_whole_or_absent(tmp_path):
    path = tmp_path / "deep" / "file.txt"
    with pytest.raises(RuntimeError), write_whole(path) as file:
        file.write("half")
        raise RuntimeError
    assert list(path.parent.iterdir()) == []
    with write_whole(path) as file:
        file.write("old")
    with pytest.raises(RuntimeError), replace_whole(path) as beside:
        beside.write_text("half of the new")
        raise RuntimeError
    assert path.read_text() == "old"
    assert list(path.parent.iterdir()) == [path]


def test_errors_say_where_and_when():
    error = UnstableError("energy drift of 3 %", where="element 4711", when="at 12.5 us")
    assert str(error) == "energy drift of 3 %, at element 4711, at 12.5 us"
    assert error.exit_code == 3


def surface(**changes):
    axes = {"d1": np.linspace(0, 3e-5, 4), "d2": np.linspace(0, 2e-5, 3)}
    values = {name: np.random.default_rng(1).random((4, 3)) for name in ("T1", "T2", "F_c", "h1", "h2")}
    return ResponseSurface(**(axes | values | {"fabric": "S-720", "provenance": "a test"} | changes))


def test_response_surface_file_keeps_every_bit(tmp_path):
    surface().write(tmp_path / "surface.h5")
    back = ResponseSurface.read(tmp_path / "surface.h5")
    for name in ("d1", "d2", "T1", "T2", "F_c", "h1", "h2"):
        assert np.array_equal(getattr(back, name), getattr(surface(), name))
    assert (back.fabric, back.provenance) == ("S-720", "a test")


def test_response_surface_checks_itself(tmp_path):
    with pytest.raises(InputError, match="a rising axis"):
        surface(d1=np.array([0, 2e-5, 1e-5, 3e-5]))
    with pytest.raises(InputError, match="of shape"):
        surface(T1=np.zeros((3, 4)))
    (tmp_path / "text.h5").write_text("no")
    with pytest.raises(InputError, match="is not a readable HDF5 file"):
        ResponseSurface.read(tmp_path / "text.h5")
