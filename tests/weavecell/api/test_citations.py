"""What a run cites: every number's source is in it, publications as entries, assumptions as comments."""

import re
from pathlib import Path

import pytest

import fabrics
import weavecell as wc
from fabrics import references
from fabrics.base.files import read_data
from weavecell.api.citations import _materials, join_numbers
from weavecell.results.sources import Source, list_sources

DATA = Path(fabrics.__file__).parent
# a name with a year, or another form of a publication
NAMED = re.compile(
    r"[A-Z][a-z]+ ((and|et) [a-zA-Z.]+ )?(19|20)\d\d|et al\.|thesis|STANAG|NIJ|ISO \d"
)
SHEET = """name = "sheet"
family = "para-aramid"
thickness = "0.30 mm"
compression = { a = "0.04 mm", b = "0.05 mm * N^(1/3)" }
"""
YARN = """
[{family}]
linear_density = {{ value = "{density} dtex", source = "{source}", status = "measured" }}
fibre_density = "1.44 g/cm^3"
modulus = "95 GPa"
failure_strain = "3.3 %"
count = "9 / cm"
"""
SHOT = """[fabric]
file = "sheet.toml"
[projectile]
name = "FSP 1.10 g"
strike_velocity = "80 m/s"
[panel]
opening = "30 mm"
[run]
end_time = "5 us"
outputs = []
"""
MAKER = "Data sheet of 100 % aramid, A & B #3, yarn_x (2019)"


def texts(table):
    """The sources in a table of a data file, through its tables."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from texts(value)
        elif key == "source":
            yield value


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A folder with the input file, and with its results."""
    folder = tmp_path_factory.mktemp("cited")
    yarns = YARN.format(family="warp", density=930, source=MAKER)
    yarns += YARN.format(family="weft", density=900, source="Brown and Burgoyne, as quoted")
    (folder / "sheet.toml").write_text(SHEET + yarns)
    (folder / "shot.toml").write_text(SHOT)
    wc.impact(folder / "shot.toml", out=folder / "results")
    return folder


def test_every_publication_that_a_data_file_names_has_an_entry():
    named = set()
    for path in DATA.rglob("*.toml"):
        if path.stem != "plausible":
            named |= {text for text in texts(read_data(path)) if NAMED.search(text)}
    assert len(named) > 40
    assert [text for text in named if not references.find_cited(text)] == []


def test_every_entry_is_named_or_used():
    every = {text for path in DATA.rglob("*.toml") for text in texts(read_data(path))}
    for each in references.list_references():
        assert each.used_for or any(map(each.is_named_in, every)), each.key


def test_every_entry_is_checked_or_says_that_it_is_not():
    """What was written down from memory is named as that in BibTeX, beside any other note."""
    listed = references.list_references()
    assert {bool(each.checked) for each in listed} == {True, False}
    for each in listed:
        for note in ("", "Used for a_b"):
            entry = each.to_bibtex(note)
            assert (references.UNCHECKED in entry) == (not each.checked), each.key
            assert "checked =" not in entry
            assert entry.count("note = ") == (
                bool(note) or "note" in each.fields or not each.checked
            )
            assert each.fields.get("note", "") in entry
            assert (r"Used for a\_b" in entry) == bool(note)


def test_a_folder_cites_what_its_input_file_does(run):
    of_file = wc.cite(run / "shot.toml")
    of_folder = wc.cite(run / "results")
    assert of_folder.sources == of_file.sources
    # the folder is moved without the files that it was computed from
    assert {("sheet", "warp.linear_density"), ("projectile FSP 1.10 g", "mass")} <= set(
        of_folder.to_dataframe().index
    )


@pytest.mark.parametrize(
    "scene, of",
    [
        ('[projectile]\nname = "FSP 1.10 g"', "projectile FSP 1.10 g"),
        ('[projectile]\ncore = "lead"', "lead"),
        ('[projectile]\njacket = "OFHC copper"', "OFHC copper"),
        ("[panel]\nplies = 2", "pack"),
        ('[[panel.ply]]\nname = "S-726"\n[[panel.ply]]\nname = "S-728"', "pack"),
        ('[panel]\ncrossovers = "yarns"', "resolved yarns"),
        ('[panel]\ncrossovers = "auto"', "resolved yarns"),
        ('[backing]\nmodulus = "1 MPa"', "block of the thesis"),
        ('[backing]\nmaterial = "Roma Plastilina No. 1"', "Roma Plastilina No. 1"),
    ],
)
def test_what_an_input_file_names_is_cited_and_nothing_else(scene, of):
    found = list_sources((), (), scene)
    assert {source.of for source in found} == {of}
    assert all(source.status for source in found)


def test_yarns_that_may_be_resolved_cite_what_resolved_ones_do():
    sure, maybe = (
        list_sources((), (), f'[panel]\ncrossovers = "{choice}"') for choice in ("yarns", "auto")
    )
    assert sure == maybe


def test_a_hybrid_pack_cites_the_laws_of_all_its_plies(tmp_path):
    plies = '[[panel.ply]]\nname = "S-726"\n[[panel.ply]]\nname = "S-728"\n[run]'
    text = SHOT.replace('[fabric]\nfile = "sheet.toml"\n', "").replace("[run]", plies)
    (tmp_path / "hybrid.toml").write_text(text)
    fabrics_of_it, laws, _ = _materials(str(tmp_path / "hybrid.toml"))
    assert [fabric.name for fabric in fabrics_of_it] == ["S-726", "S-728"]
    assert list(laws) == [law for fabric in fabrics_of_it for law in fabric.laws]


def test_publications_are_entries_and_assumptions_are_comments(run):
    text = str(wc.cite(run / "results"))
    comments, _, entries = text.partition("\n\n")
    assert all(line.startswith("% ") for line in comments.splitlines())
    assert "@" not in comments
    assert r"title = {Data sheet of 100 \% aramid, A \& B \#3, yarn\_x (2019)}" in entries
    assert (
        "weft.linear\\_density, friction of the projectile of sheet"
        in re.search(r"@article\{brown1999,.*?\n\}", entries, re.S)[0]
    )
    assert "middle of the range" not in comments  # names Cheng 2005
    assert "flat_width of projectile FSP 1.10 g" in comments
    keys = re.findall(r"^@\w+\{([\w-]+),$", entries, re.MULTILINE)
    assert len(keys) == len(set(keys)) == entries.count("\n}")
    assert {"weavecell", "thesis2006", "source1", "stanag2920", "numba", "pyvista"} <= set(keys)
    assert "dolfinx" not in keys
    assert entries.count("{") == entries.count("}")


def test_a_law_of_the_3d_crossover_cites_its_programs(run):
    from dataclasses import replace

    warp, weft = (
        replace(law, provenance="3D crossover of S-720, fine mesh", fabric="S-720")
        for law in wc.fabric("S-720").laws
    )
    wc.impact(
        "S-720", "80 m/s", opening="30 mm", law=(warp, weft), end_time="5 us", out=run / "fitted"
    )
    cited = wc.cite(run / "fitted")
    assert {"dolfinx", "gmsh", "petsc4py"} <= set(re.findall(r"\{(\w+),\n", cited.to_bibtex()))


def test_many_numbers_of_a_fabric_are_named_by_their_tables():
    def named(of, *numbers):
        return [Source(of, number, "", "") for number in numbers]

    assert join_numbers(named("A", "warp.count", "weft.count")) == "warp.count, weft.count of A"
    many = named("A", *(f"warp.{key}" for key in "abcd"), "shear.G1", "warp.a")
    assert join_numbers(many + named("B 2", "warp.a")) == "warp, shear of A; warp.a of B 2"


def test_the_entry_of_weavecell_is_that_of_citation_cff():
    root = DATA.parent
    cff = (root / "CITATION.cff").read_text()
    assert f"version: {wc.__version__}" in cff
    title = re.search(r'^title: "(.*)"$', cff, re.MULTILINE)[1]
    assert f"title = {{{title}}}" in wc.cite("S-720").to_bibtex()
    assert next(each for each in references.list_references()).fields["title"] in cff
