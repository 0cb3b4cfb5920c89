"""`weavecell sensitivity` and `weavecell v50`: their folders, and what they refuse before writing."""

import json

import pytest
from typer.testing import CliRunner

from fabrics.errors import InputError
from weavecell.analysis.uncertainty import v50
from weavecell.cli.app import program
from weavecell.commands import uncertainty


def test_v50_writes_its_folder(tmp_path):
    out = tmp_path / "out"
    words = ["v50", "S-720", "--shots", "8", "--batch", "4", "--opening", "30.6 mm", "--seed", "2", "--jobs", "1"]
    run = CliRunner().invoke(program(), [*words, "--out", str(out)])
    assert run.exit_code == 0, run.output
    assert run.output.count(" with 95 % confidence") == 2
    assert {path.name for path in out.iterdir()} - {".lock"} == {
        "runs", "scene.toml", "shots.csv", "v50.csv", "v50.html", "v50.json", "v50.png",
    }  # fmt: skip
    content = json.loads((out / "v50.json").read_text())
    assert content["scatter"]["shape"] == 14.3
    assert content["provenance"]["commit"]
    assert content["projectile"] == "a cylinder of 3 g and 5.5 mm"
    assert "projectile: a cylinder of 3 g and 5.5 mm" in run.output
    assert content["v50_m_s"] == content["curves"]["probit"]["V50"]
    assert "A series of tests up and down" in (out / "v50.html").read_text()
    assert len((out / "shots.csv").read_text().splitlines()) == 9


def test_the_grading_of_a_v50_study(tmp_path):
    """Read as in a scene, kept with the results, and in the command that the page names; a bad one is one line."""
    zones = "[[6, '1/2'], [8, 1], [inf, 2]]"
    assert uncertainty.grading_of(zones) == ((6.0, 0.5), (8.0, 1.0), (float("inf"), 2.0))
    assert uncertainty.grading_text(uncertainty.grading_of(zones)) == zones
    out = tmp_path / "out"
    words = ["v50", "S-720", "--shots", "4", "--batch", "4", "--opening", "30.6 mm", "--jobs", "1", "--out", str(out)]
    run = CliRunner().invoke(program(), [*words, "--grading", "[[11, 1], [inf, 1]]"])
    assert run.exit_code == 0, run.output
    assert json.loads((out / "v50.json").read_text())["grading"] == "[[11, 1], [inf, 1]]"
    assert "--grading &#34;[[11, 1], [inf, 1]]" in (out / "v50.html").read_text()


def test_doubtful_shots_are_counted_by_check():
    checks = ("viscous energy",), (), ("viscous energy", "energy error")
    shots = [v50.Shot(n, 100.0, 0.0, False, 1.0, 1.0, 1.0, (1.0, 1.0), 0.0, names) for n, names in enumerate(checks)]
    assert uncertainty._doubts(shots) == (
        "2 of 3 shots are doubtful; checks beyond their limits: viscous energy in 2, energy error in 1."
    )
    assert v50.Study((90.0, 91.0), tuple(shots), {}, None).doubtful == 2


@pytest.mark.parametrize(
    "zones", ["1", "[[1, 2]", "[[1, 2], [inf, 3]]", "[[1, 0], [inf, 1]]", '[[1, "1/0"], [inf, 1]]']
)
def test_a_grading_that_is_none_is_refused(zones):
    with pytest.raises(InputError, match="grading"):
        uncertainty.grading_of(zones)


PACK = """
[fabric]
name = "S-720"
[projectile]
mass = "2 g"
diameter = "5.5 mm"
edge_radius = "0.3 mm"
strike_velocity = "90 m/s"
[panel]
opening = "40 mm"
plies = 2
stacking = "alternating"
[run]
end_time = "60 us"
elements_per_crossover = 1
"""


def test_both_take_the_input_file_of_a_pack(command, tmp_path):
    """Its projectile, plies and opening count."""
    scene = tmp_path / "pack.toml"
    scene.write_text(PACK)
    words = ["v50", str(scene), "--shots", "8", "--batch", "4", "--jobs", "1", "--out", str(tmp_path / "v50")]
    run = CliRunner().invoke(program(), words)
    assert run.exit_code == 0, run.output
    content = json.loads((tmp_path / "v50" / "v50.json").read_text())
    assert content["plies"] == 2
    assert content["projectile"] == "a cylinder of 2 g and 5.5 mm"
    assert (tmp_path / "v50" / "scene.toml").read_text() == PACK
    assert "2 x S-720: probability of perforation" in (tmp_path / "v50" / "v50.html").read_text()
    words = ["sensitivity", str(scene), "--samples", "2", "--jobs", "1", "--out", str(tmp_path / "s")]
    run = CliRunner().invoke(program(), words)
    assert run.exit_code == 0, run.output
    found = json.loads((tmp_path / "s" / "sobol.json").read_text())["indices"]
    assert {one["velocity"] for one in found} == {90.0}
