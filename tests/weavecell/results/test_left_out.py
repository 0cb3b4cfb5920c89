"""What a number leaves out stands in every place where the number is shown."""

import json
from dataclasses import replace
from types import SimpleNamespace

import pytest

import weavecell as wc
from shellfabric.yarns.model import YarnZone
from tests.weavecell.golden_texts.cases import invented
from tests.weavecell.written import page_of, without_marks
from weavecell.results import left_out

# no test here looks at what a picture shows
pytestmark = pytest.mark.usefixtures("drawn_once")

SMALL = {"opening": "60 mm", "elements_per_crossover": 1}


def fire_shot(out):
    return wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", out=out)


def find_limit(out):
    some = {"tolerance": "20 m/s", "scan": False, "residual_shots": 0}
    with invented():
        return wc.critical_velocity("S-720", out=out, **some, **SMALL)


def find_v50(out):
    with invented():
        return wc.v50("S-720", shots=8, batch=4, out=out, **SMALL)


ALL = {"mesh", "sampling"}


@pytest.mark.parametrize(
    "compute, file, kinds",
    [
        (fire_shot, "summary.json", {*ALL, "what nobody gave"}),
        (find_limit, "critical-velocity.json", {*ALL, "what nobody gave"}),
        (find_v50, "v50.json", ALL - {"sampling"}),
    ],
)
def test_every_place_says_what_a_number_leaves_out(tmp_path, compute, file, kinds):
    result = compute(tmp_path)
    assert {part.kind for part in result.left_out} == kinds
    kept = json.loads((tmp_path / file).read_text())
    assert kept["left_out"] == {part.kind: part.text for part in result.left_out}
    page = page_of(tmp_path)
    notebook = without_marks(result._repr_html_())
    for part in result.left_out:
        for place in (result.details(), page, notebook, result.summary()["left_out"]):
            assert part.text in place
        assert part.brief in [one.what for one in result.answer.movers]


def test_what_is_computed_is_not_left_out():
    setup = wc.setup("S-720", "150 m/s", opening="40 mm")
    every = left_out.find_left_out(setup)
    assert [part.kind for part in every] == ["model", "mesh", "sampling"]
    assert left_out.find_left_out(setup, mesh_compared=True, drawn=True) == every[:1]
    resolved = replace(setup, crossovers=YarnZone(), symmetry="whole")
    names = [part.kind for part in left_out.find_left_out(resolved)]
    assert names == ["mesh", "sampling"]


def test_the_assumed_friction_of_resolved_yarns_is_the_first_that_is_assumed():
    from weavecell.answers.target import list_assumptions

    setup = wc.setup("S-720", "150 m/s", opening="60 mm")
    resolved = replace(setup, crossovers=YarnZone(), symmetry="whole")
    first = list_assumptions(resolved)[0]
    assert first.startswith("assumed: friction between resolved yarns 0.2 (0.1 .. 0.3)")
    measured = replace(resolved, crossovers=YarnZone(friction=0.17))
    assert not any("resolved" in line for line in list_assumptions(measured))


def test_a_law_that_misses_its_samples_is_doubtful():
    """K706: rms 11 % of a, beside an interval of 10 %."""
    from fabrics.compression import CompressionLaw
    from weavecell.answers.calibration import CalibrationResult

    def status(rms):
        law = CompressionLaw(8.2e-6, 1.5e-5, residual_rms=rms)
        solved = object.__new__(CalibrationResult)
        object.__setattr__(solved, "calibration", SimpleNamespace(law=law))
        object.__setattr__(solved, "mesh", SimpleNamespace(checks=()))
        (check,) = solved.checks
        return check.status

    assert [status(rms) for rms in (0.2e-6, 0.6e-6, 0.9e-6)] == ["ok", "noted", "doubtful"]


def test_a_picture_frame_beyond_locking_is_noted():
    """S-720 locks at 0.49 rad."""
    checks = {}
    for angle in ("20 deg", "30 deg"):
        frame = wc.coupon("S-720", "picture_frame", shear_angle=angle, crossovers=2, steps=1)
        checks[angle] = {check.name: check for check in frame.checks}["shear beyond locking"]
    assert checks["20 deg"].status == "ok"
    assert checks["30 deg"].status == "noted"
    assert checks["30 deg"].value == pytest.approx(0.5236 / 0.49, rel=1e-3)
