"""`weavecell sensitivity` and `weavecell v50`: the page of a study, its mesh and its doubtful shots."""

import json

from weavecell.analysis.uncertainty import v50
from weavecell.commands import uncertainty


def test_a_v50_study_has_its_page_and_its_mesh(results):
    run = results("v50")
    assert run.out.count(" with 95 % confidence") == 2
    assert "projectile: a cylinder of 3 g and 5.5 mm" in run.out
    content = json.loads((run.folder / "v50.json").read_text())
    assert content["scatter"]["shape"] == 14.3
    assert content["grading"] == "[[11, 1], [inf, 1]]"
    assert "--grading &#34;[[11, 1], [inf, 1]]" in (run.folder / "v50.html").read_text()
    assert "A series of tests up and down" in (run.folder / "v50.html").read_text()
    text = (run.folder.parent / "page.md").read_text()
    assert text.startswith("before\n<!-- v50 -->")
    assert text.endswith("<!-- end of v50 -->\nafter\n")
    assert "old" not in text
    assert "| probit | V50 |" in text
    assert (run.folder.parent / "figures" / "page-v50.png").exists()


def test_sensitivities_of_an_input_file_are_those_of_its_pack(results):
    run = results("sensitivity")
    found = json.loads((run.folder / "sobol.json").read_text())["indices"]
    assert {one["velocity"] for one in found} == {90.0}
    assert "2 x S-720: Sobol indices" in (run.folder / "sobol.html").read_text()


def test_a_grading_is_read_as_in_a_scene():
    zones = "[[6, '1/2'], [8, 1], [inf, 2]]"
    assert uncertainty.grading_of(zones) == ((6.0, 0.5), (8.0, 1.0), (float("inf"), 2.0))
    assert uncertainty.grading_text(uncertainty.grading_of(zones)) == zones


def test_doubtful_shots_are_counted_by_check():
    checks = ("viscous energy",), (), ("viscous energy", "energy error")
    shots = [v50.Shot(n, 100.0, 0.0, False, 1.0, 1.0, 1.0, (1.0, 1.0), 0.0, names) for n, names in enumerate(checks)]
    assert uncertainty._doubts(shots) == (
        "2 of 3 shots are doubtful; checks beyond their limits: viscous energy in 2, energy error in 1."
    )
    assert v50.Study((90.0, 91.0), tuple(shots), {}, None).doubtful == 2
