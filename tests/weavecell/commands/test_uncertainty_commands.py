"""`weavecell sensitivity` and `weavecell v50`: their folders and page, and what they refuse before writing."""

import json

import pytest
from typer.testing import CliRunner

from fabrics.errors import InputError
from weavecell.cli.app import app
from weavecell.commands import uncertainty


@pytest.fixture
def page(tmp_path):
    path = tmp_path / "docs" / "scatter.md"
    path.parent.mkdir()
    path.write_text("before\n<!-- v50 -->\nold\n<!-- end of v50 -->\nafter\n")
    return path


def test_v50_writes_its_folder_and_page(tmp_path, page):
    out = tmp_path / "out"
    words = ["v50", "S-720", "--shots", "8", "--batch", "4", "--opening", "30.6 mm", "--seed", "2", "--jobs", "1"]
    run = CliRunner().invoke(app, [*words, "--page", str(page), "--out", str(out)])
    assert run.exit_code == 0, run.output
    assert run.output.count(" with 95 % confidence") == 2
    assert {path.name for path in out.iterdir()} == {"runs", "shots.csv", "v50.csv", "v50.html", "v50.json", "v50.png"}
    content = json.loads((out / "v50.json").read_text())
    assert content["scatter"]["shape"] == 14.3
    assert content["provenance"]["commit"]
    assert len((out / "shots.csv").read_text().splitlines()) == 9
    text = page.read_text()
    assert text.startswith("before\n<!-- v50 -->")
    assert text.endswith("<!-- end of v50 -->\nafter\n")
    assert "old" not in text
    assert "| probit | V50 |" in text
    assert (page.parent / "figures" / "scatter-v50.png").exists()


def test_the_grading_of_a_v50_study(tmp_path):
    """Read as in a scene, kept with the results, and in the command that the page names; a bad one is one line."""
    zones = "[[6, '1/2'], [8, 1], [inf, 2]]"
    assert uncertainty.grading_of(zones) == ((6.0, 0.5), (8.0, 1.0), (float("inf"), 2.0))
    assert uncertainty.grading_text(uncertainty.grading_of(zones)) == zones
    out = tmp_path / "out"
    words = ["v50", "S-720", "--shots", "4", "--batch", "4", "--opening", "30.6 mm", "--jobs", "1", "--out", str(out)]
    run = CliRunner().invoke(app, [*words, "--grading", "[[11, 1], [inf, 1]]"])
    assert run.exit_code == 0, run.output
    assert json.loads((out / "v50.json").read_text())["grading"] == "[[11, 1], [inf, 1]]"
    assert "--grading &#34;[[11, 1], [inf, 1]]" in (out / "v50.html").read_text()


@pytest.mark.parametrize(
    "zones", ["1", "[[1, 2]", "[[1, 2], [inf, 3]]", "[[1, 0], [inf, 1]]", '[[1, "1/0"], [inf, 1]]']
)
def test_a_grading_that_is_none_is_refused(zones):
    with pytest.raises(InputError, match="grading"):
        uncertainty.grading_of(zones)


def test_a_page_without_marks_is_refused_before_anything_is_run(tmp_path, page):
    with pytest.raises(InputError, match="has no marks"):
        uncertainty.sensitivity(
            "S-720", tmp_path / "out", velocities=[170.0], samples=2, seed=1, jobs=1, executor="local", opening=0.0306,
            resume=False, page=page,
        )  # fmt: skip
    assert not (tmp_path / "out").exists()
