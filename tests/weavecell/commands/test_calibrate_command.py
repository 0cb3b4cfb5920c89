"""`weavecell calibrate`: the whole catalogue side by side, with fitted solids, and what is printed of a law."""

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx")


import weavecell as wc
from fabrics import catalogue
from meshing.session import gmsh_session
from tests.weavecell.session_runs import SHORT, small_calibration
from tests.weavecell.written import table_of
from unitcell3d.identify import calibrate as solver
from unitcell3d.identify import chain, solid_fit
from unitcell3d.identify.solid_record import SolidFit
from validation.cases import solid
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
    monkeypatch.setattr(chain, "path_jobs", lambda *chosen, **more: paths(*chosen, SHORT, **more))
    monkeypatch.setattr(chain, "SIZE", (2, 2, 2))
    monkeypatch.setattr(
        chain.run_cache, "results", lambda function, runs, **_: [function(*one) for one in runs]
    )


def a_fit(fabric, curve, *_, **__):
    pressure = np.geomspace(curve.pressure[0], curve.pressure[-1], 16)
    measured = curve.at(pressure)
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
        curve=curve,
        pressure=pressure,
        measured=measured,
        computed=measured + 1e-6 * np.cos(np.arange(16)),
        before=0.8 * measured,
        checked=None,
        values=values,
        intervals={name: (0.5 * value, 2 * value) for name, value in values.items()},
        determined=dict.fromkeys(values, True),
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
    # on this mesh both ends of E_c have a larger a than its middle
    assert after["a_interval"][0] <= after["a"] * (1 + 1e-12) < after["a_interval"][1]
    assert before["a_ratio"] == pytest.approx(before["a"] / 0.045e-3)
    assert (after["a"], after["b"]) != (before["a"], before["b"])  # another solid, another law
    assert after["misfit_before"] > after["misfit"]
    assert after["constants"]["E_c"] == (1.8e9, 0.9e9, 3.6e9)


def told(out):
    """{first words of a line: the rest}."""
    return {line[:13].strip(): line[14:] for line in out.splitlines()}


def test_one_fabric_from_its_platen_curve(succeed, tmp_path, small, fitted):
    out = succeed("calibrate S-720 --fit-solid --mesh coarse --jobs 1 --out c")
    assert told(out)["E_c"] == "1.8e+09 (9e+08 .. 3.6e+09, 95 %); from 2e+09"
    assert told(out)["misfit"].startswith("0.7 µm and ")
    assert told(out)["of the solid"].count("..") == 2
    solid = table_of(tmp_path / "c", "solid.json")
    assert solid["rms_relative_pressure_before"] > solid["rms_relative_pressure"]
    assert "a of the law is then between" in (tmp_path / "c" / "report.html").read_text()


def test_a_law_is_printed_with_its_intervals_and_spread(results):
    lines = told(results("calibrate").out)
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
    assert note in str(found)
    assert note in found.sections()[0].lead


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


def test_a_fitted_solid_belongs_to_the_fraction_of_the_mesh(command, tmp_path):
    code, _, err = command("calibrate S-726 --fit-solid --fibre-fraction stated --out r")
    assert code == 2
    assert "fibre" in err
    assert "must be mesh if the solid is fitted" in err
    assert not (tmp_path / "r").exists()
