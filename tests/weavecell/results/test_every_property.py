"""Each public property of a result is named by a test; those that are read off a record by hand are here."""

import ast
import re
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
from weavecell.api.execution import Execution
from weavecell.api.result import Result
from weavecell.api.scatter import V50Result
from weavecell.api.target import resolve_target
from weavecell.results import coupon
from weavecell.results.impact import FORMAT, ImpactRecord
from weavecell.results.result_folder import ResultFolder
from weavecell.studies import inputs
from weavecell.studies.assumed_range import AssumedRange, Row
from weavecell.studies.bracket import Bracket

ROOT = Path(__file__).parents[3]
# where the classes of results are
PLACES = (
    "shellfabric/impact/result.py",
    "shellfabric/membrane/quality.py",
    "weavecell/results",
    "weavecell/studies",
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


def test_the_friction_between_yarns_is_told_with_its_own_ends():
    name = inputs.FRICTION_OF_CROSSOVERS
    rows = [("", "", 150.0), (name, f"{name} 0.3", 171.0), (name, f"{name} 0.1", 140.0)]
    rows.append(("crimp", "crimp low", 120.0))
    given = [Row(varied=varied, laws=laws, velocity=V, outcome="") for varied, laws, V in rows]
    found = AssumedRange(quantity="limit", rows=tuple(given))
    words = "friction between yarns of 0.1 to 0.3, which is assumed: 140.0 to 171.0 m/s"
    assert found.over_friction_between_yarns == words
    assert (found.low, found.high) == (120.0, 171.0)
    plain = AssumedRange(quantity="limit", rows=(given[0], given[3]))
    assert plain.over_friction_between_yarns == ""


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


def test_the_interval_of_a_v50_is_that_of_its_curve():
    curves = {
        "probit": SimpleNamespace(intervals={"s": (3.0, 9.0), "V50": (141.0, 163.0)}),
        "logit": SimpleNamespace(intervals={"V50": (139.0, 166.0)}),
    }
    found = SimpleNamespace(study=SimpleNamespace(curves=curves))
    assert V50Result.v50_low.fget(found) == 141.0
    assert V50Result.v50_high.fget(found) == 163.0


def test_a_shot_has_the_title_of_its_file_or_what_it_is(tmp_path):
    (tmp_path / "own.toml").write_text('title = "mine"\n' + impact_scene(fabric="S-728"))
    assert resolve_target(tmp_path / "own.toml", {}, {}).shot_title == "mine"
    plain = resolve_target(wc.setup("S-728", "80 m/s"), {}, {})
    assert plain.shot_title == f"{plain.title}, 80 m/s"


@pytest.mark.parametrize(
    "kind, is_impact", [(FORMAT, True), ("weavecell impact 1", False), (coupon.FORMAT, False)]
)
def test_histories_of_an_impact_are_those_of_this_version(tmp_path, kind, is_impact):
    assert not ResultFolder(tmp_path).is_impact
    with write_hdf5(tmp_path / "histories.h5", kind) as file:
        file["time"] = np.array([0.0, 1e-6])
    assert ResultFolder(tmp_path).is_impact is is_impact
