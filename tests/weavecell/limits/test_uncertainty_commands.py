"""`weavecell sensitivity` and `weavecell v50`: what their pages say."""

import json


def test_a_v50_study_says_what_it_found(results):
    run = results("v50")
    assert run.out.count(" with 95 % confidence") == 2
    assert "projectile: a cylinder of 3 g and 5.5 mm" in run.out
    assert "A series of tests up and down" in (run.folder / "v50.html").read_text()
    content = json.loads((run.folder / "v50.json").read_text())
    assert content["scatter"]["shape"] == 14.3


def test_sensitivities_of_an_input_file_are_those_of_its_pack(results):
    run = results("sensitivity")
    found = json.loads((run.folder / "sobol.json").read_text())["indices"]
    assert {one["velocity"] for one in found} == {90.0}
    assert "2 x S-720: Sobol indices" in (run.folder / "sobol.html").read_text()
