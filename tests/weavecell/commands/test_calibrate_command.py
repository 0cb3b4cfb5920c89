"""`weavecell calibrate`: the whole catalogue side by side, with fitted solids, and what is printed of a law."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx")


import weavecell as wc
from fabrics import assumed, catalogue
from fabrics.compression import CompressionLaw
from fabrics.surface import ResponseSurface
from meshing.session import gmsh_session
from tests.weavecell.session_runs import SHORT, small_calibration
from tests.weavecell.written import table_of
from unitcell3d.identify import calibrate as solver
from unitcell3d.identify import law_range, response_surface, solid_fit
from unitcell3d.identify.solid_record import PlatenClosures, PulledLoads, SolidFit
from validation.cases import solid
from weavecell.answers.law_effect import LawEffect
from weavecell.api import calibration


@pytest.fixture
def small(monkeypatch):
    """The catalogue has two fabrics, whose calibrations are small."""
    monkeypatch.setattr(catalogue, "list_names", lambda: ["S-720", "S-726"])
    with small_calibration():
        yield


@pytest.fixture
def fitted(monkeypatch):
    """Fits of the solid that give that of the file a tenth softer at once, whatever the fabric."""
    monkeypatch.setattr(solid_fit, "fit_solid", a_fit)
    paths = solver.path_jobs
    monkeypatch.setattr(
        law_range, "path_jobs", lambda *chosen, **more: paths(*chosen, SHORT, **more)
    )
    monkeypatch.setattr(law_range, "SIZE", (2, 2, 2))
    # shots of the law and of both ends, 18 CPU s
    monkeypatch.setattr(
        calibration.law_effect,
        "find_effect",
        lambda fabric, law, report: LawEffect(60.0, (0.0185, 0.0206, 0.0171), (52.0, 50.2, 53.3)),
    )
    monkeypatch.setattr(
        law_range.run_cache, "results", lambda function, runs, **_: [function(*one) for one in runs]
    )


def a_fit(fabric, curve, tests=(), fitted=(), **_):
    platens = None
    if curve is not None:
        pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], 16)
        measured = curve.at(pressure)
        wave = 1e-6 * np.cos(np.arange(16))
        platens = PlatenClosures(curve, pressure, measured, measured + wave, 0.8 * measured)
    pulls = tuple(
        PulledLoads(t.name, t.strain, t.load, 1.1 * t.load, 1.4 * t.load, t.name in fitted)
        for t in tests
    )
    softer, stiffer = (
        replace(
            fabric,
            solid_laws=tuple(replace(law, E_c=factor * law.E_c) for law in fabric.solid_laws),
        )
        for factor in (0.9, 1.1)
    )
    values = {"E_c": 1.8e9, "V_c": 1.0, "K_r": 0.02, "K_r E_c": 3.6e7}
    return SolidFit(
        fabric=softer,
        started=fabric,
        platens=platens,
        pulls=pulls,
        values=values,
        intervals={name: (0.5 * value, 2 * value) for name, value in values.items()},
        determined=dict.fromkeys(values, True),
        free=("E_c", "V_c", "K_r"),
        correlation=np.eye(3),
        singular_values=np.ones(3),
        directions=np.eye(3),
        limits=((softer, stiffer),),
        met=True,
        work={},
        sizes=("coarse", "None"),
    )


def test_a_study_has_the_law_with_the_fitted_solid(small, fitted):
    """Beside that of the file's solid; the interval is what the fit leaves open."""
    before, after = (
        solid.calibrated(fabric="S-720", mesh="coarse", fit_solid=one) for one in (False, True)
    )
    assert after["a_interval"][0] < after["a"] < after["a_interval"][1]
    assert before["a_ratio"] == pytest.approx(before["a"] / 0.045e-3)
    assert (after["a"], after["b"]) != (before["a"], before["b"])  # another solid, another law
    assert after["misfit_before"] > after["misfit"]
    assert after["constants"]["E_c"] == (1.8e9, 0.9e9, 3.6e9)


def told(out):
    """{first words of a line: the rest}."""
    return {line[:13].strip(): line[14:] for line in out.splitlines()}


@pytest.mark.slow(4)
def test_one_fabric_from_its_platen_curve(succeed, tmp_path, small, fitted):
    out = succeed("calibrate S-720 --fit-solid --mesh coarse --jobs 1 --out c --verbose")
    assert told(out)["E_c"] == "1.8e+09 (9e+08 .. 3.6e+09, 95 %); from 2e+09"
    assert told(out)["misfit"].startswith("0.7 µm and ")
    assert told(out)["95 % interval"].count("..") == 2
    assert told(out)["range from"].endswith(" of its variance")
    solid = table_of(tmp_path / "c", "solid.json")
    assert solid["rms_relative_pressure_before"] > solid["rms_relative_pressure"]
    assert "a of the law is then between" in (tmp_path / "c" / "report.html").read_text()


TESTS = """test, warp strain [%], weft strain [%], warp load [N], weft load [N]
even, 0, 0, 0, 0.1
even, 0.3, 0.3, 9, 8
even, 0.6, 0.6, 22, 19
even, 0.9, 0.9, 41, 37
even, 1.2, 1.2, 66, 60
warp, 0.1, 0.05, 1, 0.5
warp, 0.4, 0.2, 16, 4
warp, 0.7, 0.35, 35, 9
warp, 1.0, 0.5, 58, 15
warp, 1.3, 0.65, 86, 23
free, 0.1, , 1,
free, 0.4, , 9,
free, 0.7, , 20,
free, 1.0, , 41,
free, 1.3, , 66,
"""


def test_one_fabric_from_its_biaxial_tests(succeed, command, tmp_path, small, fitted, monkeypatch):
    """Its report has fitted, predicted and earlier curves in one picture; its keys and surface can be used."""
    sample = response_surface.sample
    monkeypatch.setattr(
        response_surface, "sample", lambda *a, **more: sample(*a, **more | {"size": (2, 2, 2)})
    )
    (tmp_path / "t.csv").write_text(TESTS)
    line = (
        "calibrate S-720 --biaxial t.csv --fit-solid --fitted even --mesh coarse --jobs 1 --out c"
    )
    out = succeed(f"{line} --verbose")
    assert told(out)["test even"].startswith("fitted, strains 1 : 1: rms ")
    assert told(out)["test warp"].endswith(": differs")
    assert "free" not in told(out)  # where no yarn is pressed, the solid is not told
    solid = table_of(tmp_path / "c", "solid.json")
    assert [one["role"] for one in solid["tests"]] == ["fitted", "predicted"]
    page = (tmp_path / "c" / "report.html").read_text()
    assert "dotted with the solid before the fit" in page
    keys = tomllib.loads((tmp_path / "c" / "fabric-keys.toml").read_text())
    assert keys["solid"]["warp"]["E_c"]["status"] == "fitted"
    assert ResponseSurface.read(tmp_path / "c" / "surface.h5").T1.shape == (5, 5)
    law = CompressionLaw.from_json(tmp_path / "c" / "law.json")
    assert law.spread is not None
    assert law.sample((0.9, 0.2)) != law
    assert law.outside_ends() == []
    assert told(out)["shots"] == (
        "its range moves the dent of a pinned ply at 60 m/s by -7.6 to +11 % "
        "and its critical velocity in 80 mm by -3.5 to +2.5 %"
    )
    assert table_of(tmp_path / "c", "law-range.json")["shots"]["velocity_m_s"] == 60
    for words, said in (
        ("--fitted free", "fitted = 'free': must be a test of both directions"),
        ("--constants a", "constants = 'a': must be of E_c, V_c, K_r"),
        ("--centreline straight", "--centreline"),
    ):
        code, _, err = command(f"calibrate S-720 --biaxial t.csv --fit-solid {words} --out d")
        assert code == 2
        assert said in err
    code, _, err = command("calibrate S-720 --biaxial t.csv --mesh coarse --out d")
    assert code == 2
    assert "without --fit-solid, which solves no 3D crossover" in err


def test_a_law_is_told_with_its_intervals_and_spread(small):
    lines = told(wc.calibrate("S-720", mesh="coarse").details())
    names = {
        "fitted",
        "published",
        "residual",
        "each path",
        "warp alone",
        "weft alone",
        "alternative",
        "impacts use",
    }
    assert names <= set(lines)
    assert lines["95 % interval"].count("..") == lines["each path"].count("..") == 2
    assert lines["published"] == "a = 0.0450 mm, b = 0.0580 mm N^(1/3)"


def test_a_law_outside_the_ends_of_its_range_says_so(small):
    found = wc.calibrate("S-720", mesh="coarse")
    a = found.law.a
    b = found.law.b
    law = replace(found.law, assumed_range=((0.5 * a, b), (2 * a, b)))  # at all forces
    found = replace(found, calibration=replace(found.calibration, law=law))
    note = "stiff end softer than the law from "
    assert note in found.details()
    assert note in found.sections()[0].lead


@pytest.mark.slow(8)
def test_a_section_changed_in_gmsh_is_calibrated(succeed, command, monkeypatch, tmp_path):
    """The geometry handed out, meshed by gmsh with a thinner warp, is the mesh of paths and platens."""
    run = solver.calibrate
    monkeypatch.setattr(
        solver, "calibrate", lambda *given, **more: run(*given, **more, paths=SHORT)
    )
    succeed("mesh S-720 --mesh 2,2,2 --format geo --out made")
    script = (tmp_path / "made" / "crossover.geo").read_text()
    (tmp_path / "mine.geo").write_text(script.replace("  q = ", "  q = 0.95 * ", 1))
    with gmsh_session("mine") as gmsh:
        gmsh.open(str(tmp_path / "mine.geo"))
        gmsh.model.mesh.generate(3)
        gmsh.write(str(tmp_path / "my.msh"))
    succeed("calibrate S-720 --mesh my.msh --out mine")
    found = table_of(tmp_path / "mine", "calibration.json")
    assert found["mesh"] == {"biaxial": "my.msh", "plates": "my.msh"}
    # S-720 has 0.700 and 0.620; a spline through three places gives 0.1 % less
    sections = "sections of the mesh file (Vf0 0.736 / 0.619)"
    assert table_of(tmp_path / "mine", "mesh.json")["sections"].endswith(sections)
    (tmp_path / "my.msh").write_text("notes")
    code, _, err = command("calibrate S-720 --mesh my.msh --out again")
    assert code == 2
    assert "my.msh: " in err
    assert not (tmp_path / "again").exists()


def test_fibre_fractions_that_differ_are_said():
    """Conforming sections of S-726 are denser than it states, by 4 %; sines of S-720 are as it states."""
    for name, numbers in (("S-726", ["0.730 / 0.647", "0.700 / 0.620"]), ("S-720", [])):
        built = wc.mesh(name, mesh=(2, 2, 1))
        for used, whose in (("mesh", "those of the mesh"), ("stated", "those that are stated")):
            note = calibration.fractions_note(built, used)
            assert bool(note) == bool(numbers)
            assert all(words in note for words in (*numbers, whose)) == bool(numbers)
            assert ("the fabric states" in note) == bool(numbers)
    bare = replace(catalogue.load("S-726"), solid_laws=None)
    note = calibration.fractions_note(
        wc.mesh(assumed.with_solid_laws(bare), mesh=(2, 2, 1)), "mesh"
    )
    assert "assumed are 0.660 / 0.660" in note


def test_a_fitted_solid_belongs_to_the_fraction_of_the_mesh(command, tmp_path):
    code, _, err = command("calibrate S-726 --fit-solid --fibre-fraction stated --out r")
    assert code == 2
    assert "fibre" in err
    assert "must be mesh if the solid is fitted" in err
    assert not (tmp_path / "r").exists()
