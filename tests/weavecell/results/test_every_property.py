"""Each public property of a result is named by a test; those that are read off a record by hand are here."""

import ast
import re
from dataclasses import replace
from functools import cache
from math import inf
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.executors import InProcess
from fabrics.base.files import write_hdf5
from fabrics.ply_law import SOLID_TRAVEL
from shellfabric.membrane import quality
from tests.scene_text import impact_scene
from weavecell.answers.biaxial_fit import BiaxialFitResult
from weavecell.answers.biaxial_paths import BiaxialResult
from weavecell.answers.mesh import MeshResult
from weavecell.answers.result import Result
from weavecell.api.execution import Execution
from weavecell.api.target import resolve_target
from weavecell.results import coupon
from weavecell.results.impact import FORMAT, ImpactRecord
from weavecell.results.result_folder import ResultFolder
from weavecell.studies import biaxial_fit
from weavecell.studies.biaxial_fit import Constant
from weavecell.studies.bracket import Bracket
from weavecell.studies.displacement_record import Motion

ROOT = Path(__file__).parents[3]
# where the classes of results are
PLACES = (
    "shellfabric/impact/result.py",
    "shellfabric/membrane/quality.py",
    "weavecell/results",
    "weavecell/studies",
    "weavecell/runs",
    "weavecell/answers",
    "weavecell/api",
)


def properties(place):
    """(class, name) of the public properties in a file."""
    for node in ast.walk(ast.parse(place.read_text("utf-8"))):
        if not isinstance(node, ast.ClassDef):
            continue
        for part in node.body:
            marks = getattr(part, "decorator_list", [])
            marks = {mark.id for mark in marks if isinstance(mark, ast.Name)}
            if marks & {"property", "cached_property"} and not part.name.startswith("_"):
                yield node.name, part.name


@cache
def words_of_tests():
    texts = (path.read_text("utf-8") for path in (ROOT / "tests").rglob("*.py"))
    return {word for text in texts for word in re.findall(r"\w+", text)}


def test_a_test_names_each_property_of_a_result():
    found = []
    for name in PLACES:
        place = ROOT / name
        for file in sorted(place.glob("*.py")) if place.is_dir() else [place]:
            found += properties(file)
    assert len(found) > 100
    assert [name for name in found if name[1] not in words_of_tests()] == []


def record(**values):
    """A record of three unlike plies that has the fields which a property reads."""
    plain = {
        "outcome": "perforated",
        "backing": None,
        "mass": 0.003,
        "strike_velocity": 100.0,
        "strength": np.array([[200.0, 250.0], [310.0, 170.0], [120.0, 410.0]]),
        "peak_tension": np.array([[90.0, 200.0], [217.0, 51.0], [36.0, 164.0]]),
        "peak_tension_time": np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
        "peak_tension_place": np.arange(12.0).reshape(3, 2, 2),
        "plies": {"cut_yarns": np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0], [3, 2, 1]])},
        "energies": {
            "viscous": np.array([0.0, 0.2, 0.9, 1.3]),
            "kinetic_projectile": np.array([15.0, 13.0, 9.0, 8.0]),
        },
        "gaps": np.array([2e-5, 3e-5]),
        "pack": {
            "ply_contact_source": "S-726.toml",
            "ply_contact_status": "measured",
            "ply_contact_travel_m": 4.3e-5,
            "ply_gap_low_m": 1e-5,
            "ply_gap_high_m": 6e-5,
            "ply_gap_source": "the thickness",
        },
    }
    found = object.__new__(ImpactRecord)
    vars(found).update(plain | values)
    return found


def test_a_projectile_stops_at_the_first_sample_that_is_not_forwards():
    moving = {"time": np.array([0.0, 2e-6, 5e-6, 9e-6]), "velocity": np.array([90, 20, -1, -4])}
    assert record(outcome="stopped", **moving).stop_time == 5e-6
    assert record(outcome="perforated", **moving).stop_time is None


def test_viscosity_counts_up_to_the_sample_before_the_first_cut():
    found = record()
    assert found.viscous_energy_fraction == pytest.approx(0.2 / 2.0)
    assert found.recoil_of_cut_yarns == pytest.approx(1.3 - 0.2)
    assert found.cut_yarns.tolist() == [0, 0, 1, 6]
    assert found.absorbed_energy == pytest.approx(0.5 * 0.003 * 1e4 - 8.0)


def test_a_ply_is_loaded_as_its_worse_family():
    np.testing.assert_allclose(record().ply_shares, [0.8, 0.7, 0.4])


def test_the_highest_tension_of_a_family_comes_with_its_own_ply_time_and_place():
    warp, weft = record().peaks["warp"], record().peaks["weft"]
    assert (warp.tension, warp.share, warp.time, warp.ply) == (217.0, 0.7, 3.0, 2)
    assert (weft.tension, weft.share, weft.time, weft.ply) == (200.0, 0.8, 2.0, 1)
    assert warp.place.tolist() == [4.0, 5.0]
    assert weft.place.tolist() == [2.0, 3.0]


def test_a_panel_is_seen_from_where_something_is_to_be_seen():
    assert record(outcome="stopped").seen_from_front
    assert not record(outcome="perforated").seen_from_front
    assert not record(outcome="stopped", backing=object()).seen_from_front


def test_contact_and_gap_of_plies_are_told_with_their_sources():
    words = "contact of plies: S-726.toml (measured)"
    assert record().contact_words == f"{words}, travel 43 um, then solid fibre"
    solid = record()
    solid.pack["ply_contact_travel_m"] = SOLID_TRAVEL
    assert solid.contact_words == words
    assert record().gap_words == "ply gap 0.02 mm (0.01 .. 0.06 mm), the thickness"
    given = record()
    given.pack["ply_gap_high_m"] = given.pack["ply_gap_low_m"]
    assert ".." not in given.gap_words


def test_a_bracket_is_exhausted_where_its_open_end_is_reached():
    assert Bracket(100.0, 50.0, 300.0, low=300.0).exhausted
    assert Bracket(100.0, 50.0, 300.0, high=50.0).exhausted
    assert not Bracket(100.0, 50.0, 300.0, low=299.0).exhausted
    assert not Bracket(100.0, 50.0, 300.0, high=51.0).exhausted
    # both ends are known: there is no end to look for
    assert not Bracket(100.0, 50.0, 300.0, low=300.0, high=310.0).exhausted
    assert Bracket(100.0, 50.0, 300.0, low=80.0).width == inf
    assert Bracket(100.0, 50.0, 300.0, low=80.0, high=93.0).width == 13.0


def test_a_single_job_of_the_3d_solver_stays_in_this_process():
    one = Execution(jobs=1, executor="local")
    assert isinstance(one.solver_pool["executor"], InProcess)
    assert one.solver_pool["jobs"] == 1
    assert Execution(jobs=3, executor="local").solver_pool == {"jobs": 3, "executor": "local"}


def test_checks_are_told_by_the_worst():
    fine = quality.indicator("energy error", 0.001)
    bad = quality.indicator("time step", 1.2)
    told = SimpleNamespace(checks=(fine, bad))
    assert Result.checks_text.fget(told) == f"doubtful: {bad}"
    assert Result.checks_text.fget(SimpleNamespace(checks=(fine,))) == "ok"


def test_a_shot_has_the_title_of_its_file_or_what_it_is(tmp_path):
    (tmp_path / "own.toml").write_text('title = "mine"\n' + impact_scene(fabric="S-728"))
    assert resolve_target(tmp_path / "own.toml", {}, "impact").shot_title == "mine"
    plain = resolve_target(wc.setup("S-728", "80 m/s"), {}, "impact")
    assert plain.shot_title == f"{plain.title}, 80 m/s"


@pytest.mark.parametrize(
    "kind, is_impact", [(FORMAT, True), ("weavecell impact 1", False), (coupon.FORMAT, False)]
)
def test_histories_of_an_impact_are_those_of_this_version(tmp_path, kind, is_impact):
    assert not ResultFolder(tmp_path).is_impact
    with write_hdf5(tmp_path / "histories.h5", kind) as file:
        file["time"] = np.array([0.0, 1e-6])
    assert ResultFolder(tmp_path).is_impact is is_impact


def test_errors_of_a_record_are_those_of_its_ends_and_of_its_greatest_force():
    motion = Motion(
        time=np.array([0.0, 1.0, 2.0]),
        measured=np.zeros(3),
        displacement=np.zeros(3),
        velocity=np.array([30.0, 20.0, 12.0]),
        force=np.array([5.0, 9.0, 7.0]),
        velocity_error=np.array([0.2, 0.3, 0.5]),
        force_error=np.array([1.0, 2.0, 4.0]),
        mass=0.5,
        noise=1e-5,
        bandwidth=1e4,
        chosen="given",
    )
    # m v dv at both ends: 3 and 3 J
    assert motion.absorbed_energy_error == pytest.approx(np.sqrt(18))
    assert motion.greatest_force_error == 2.0


def test_starts_of_biaxial_tests_are_constants_in_the_unit_of_crimp():
    start = Constant("start of k = 1", 0.0, -1e-4, 1e-4, "")
    assert start.is_start
    assert not replace(start, name="a").is_start
    weave = SimpleNamespace(yarns=[SimpleNamespace(crimp=c) for c in (0.004, 0.011)])
    model = SimpleNamespace(fabric=SimpleNamespace(weave=weave))
    assert biaxial_fit._Problem.start_scale.func(SimpleNamespace(model=model)) == 0.011


def test_a_fit_to_biaxial_tests_tells_its_constants_and_whether_shots_have_its_cell():
    constants = [
        Constant("a", 5e-5, 4e-5, 6e-5, "um"),
        Constant("b", 3e-5, 1e-6, 9e-5, "um N^(1/3)"),
    ]
    model = SimpleNamespace(
        centreline="cosine", slack=(0.0, 0.0), crossover_gap=0.0, stiffening=0.0
    )
    fit = SimpleNamespace(model=model)
    given = SimpleNamespace(fit=fit, constants=constants)
    told = BiaxialFitResult.fitted_constants.fget(given)
    assert [told[name]["value"] for name in ("a", "b")] == [5e-5, 3e-5]
    assert told["b"]["interval"] == [1e-6, 9e-5]
    assert BiaxialFitResult.is_of_shots.fget(given)
    others = [{"centreline": "straight"}, {"slack": (0.0, 1e-3)}]
    for other in (*others, {"crossover_gap": 1e-5}, {"stiffening": 90.0}):
        fit.model = SimpleNamespace(**vars(model) | other)
        assert not BiaxialFitResult.is_of_shots.fget(given), other


def test_strains_at_the_largest_energy_are_those_of_the_map():
    energy_map = SimpleNamespace(most=(3.5, 0.021, 0.017))
    given = SimpleNamespace(energy_map=energy_map)
    assert BiaxialResult.strain_at_largest_energy.fget(given) == (0.021, 0.017)


def test_bars_of_a_mesh_are_counted_by_family():
    mesh = SimpleNamespace(bars=[range(4), range(7), range(2)], families=[0, 1, 0])
    assert MeshResult.fibre_bars.fget(SimpleNamespace(mesh=mesh)) == (6, 7)
