"""`idealised = true` in the file of a fabric: numbers beyond the plausible are taken, and every output says so."""

import json

import pytest

import weavecell as wc
from fabrics import assumed, catalogue
from fabrics.base.errors import InputError

# warp and weft differ, so that no line of one hides that of the other
SHEET = """key,warp,weft,source
fibre_density,1.44 g/cm^3,1.43 g/cm^3,sheet
modulus,96 GPa,90 GPa,sheet
linear_density,1100 dtex,1000 dtex,sheet
failure_strain,3.3 %,3.0 %,sheet
crimp,0.001 %,0.002 %,bar net
count,8.5 / cm,8.2 / cm,sheet
"""
SHOT = """
[fabric]
file = "bar.toml"
cell_model = "incompressible"
[projectile]
mass = "1.1 g"
diameter = "5.5 mm"
edge_radius = "0.5 mm"
strike_velocity = "120 m/s"
[panel]
opening = "30 mm"
[run]
end_time = "4 us"
elements_per_crossover = 1
"""
CRIMPS = ("warp.crimp: crimp is 0.001 %", "weft.crimp: crimp is 0.002 %")


@pytest.fixture
def make(tmp_path, monkeypatch):
    """A function that makes bar.toml of a sheet with more rows."""
    monkeypatch.chdir(tmp_path)

    def from_sheet(rows):
        (tmp_path / "bar.csv").write_text(SHEET + rows)
        wc.new_fabric("bar.toml", values="bar.csv")
        return tmp_path / "bar.toml"

    return from_sheet


def test_a_bar_net_is_refused_unless_its_sheet_says_that_it_is_meant(make):
    for rows in ("", "idealised,false,,\n"):
        with pytest.raises(InputError, match=r"crimp is 0\.001 %, plausible is 0\.3 to 9 %"):
            make(rows)
    fabric = catalogue.load(make("idealised,true,,\n"))
    first, *others = assumed.lines(fabric)
    assert first.startswith("assumed: bar is idealised: ")
    assert all(crimp in first for crimp in CRIMPS)
    # what is said there is not said again
    assert not any("plausible" in line for line in (*others, *fabric.notes))


def test_a_row_of_a_sheet_says_true_or_false(make):
    with pytest.raises(InputError, match=r"line 8, idealised = 'yes': must be true or false"):
        make("idealised,yes,,\n")


@pytest.mark.parametrize(
    "key, usual, given",
    [
        ("warp.modulus", '"96 GPa"', '"4000 GPa"'),
        ("weft.count", '"8.2 / cm"', '"0.3 / cm"'),
        ("warp.failure_strain", '"3.3 %"', '"0.02 %"'),
    ],
)
def test_what_is_out_of_bounds_is_taken_with_its_sign(key, usual, given, make):
    path = make("idealised,true,,\n")
    text = path.read_text()
    assert text.count(usual) == 1
    changed = text.replace(usual, given)
    with pytest.raises(InputError, match=f"{key} = {given[1:-1]!r}: must be from"):
        catalogue.read(path, changed.replace("idealised = true", ""))
    plain, line = (assumed.lines(catalogue.read(path, each))[0] for each in (text, changed))
    assert set(line.split("; ")) - set(plain.split("; "))
    with pytest.raises(InputError, match="must be from"):
        catalogue.read(path, text.replace(usual, '"-' + given[1:]))


def test_what_contradicts_itself_is_refused_all_the_same(make):
    path = make("idealised,true,,\n")
    text = path.read_text().replace("[warp]", 'areal_density = "300 g/m^2"\n[warp]')
    with pytest.raises(InputError, match="areal_density = '300 g/m"):
        catalogue.read(path, text)


def test_a_trellis_of_nothing_is_taken(make):
    path = make("idealised,true,,\n")
    shear = '\n[shear]\nG1 = "0.2 Pa"\nG2 = "3 Pa"\ngamma1 = "0.2"\ngamma2 = "0.5"\n'
    assert (
        "shear.G2: G2 times section"
        in assumed.lines(catalogue.read(path, path.read_text() + shear))[0]
    )


def test_every_output_of_a_shot_says_that_its_fabric_is_idealised(make, succeed, tmp_path):
    make("idealised,true,,\n")
    (tmp_path / "shot.toml").write_text(SHOT)
    terminal = succeed("impact", "shot.toml", "--verbose", "--out", "out")
    shot = wc.load("out")
    said = {
        "terminal": terminal,
        "page": (tmp_path / "out/report.html").read_text(),
        "JSON": json.loads((tmp_path / "out/summary.json").read_text())["provenance"]["assumed"],
        "loaded": "; ".join(shot.assumed),
        "notebook": shot._repr_html_(),
        "cite": succeed("cite", "out"),
        "forecast": succeed("impact", "shot.toml", "--check"),
        "show": succeed("show", "bar.toml"),
    }
    silent = [
        name for name, text in said.items() if "idealised" not in text or "0.001 %" not in text
    ]
    assert not silent
