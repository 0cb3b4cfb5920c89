"""A command is a plan: its check and its run are of one plan, and an option that changes no plan does nothing."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from weavecell.api.command import without_effect
from weavecell.studies import limit

SCAN = ["scan_above", "scan_below", "scan_step"]
VALUES = {
    "tolerance": ["1 m/s", "7 m/s"],
    "v50_shots": [5, 9],
    "residual_shots": [1, 5],
    "scan": [True, False],
    "scan_above": ["25 %", "30 %"],
    "scan_below": ["10 %", "12 %"],
    "scan_step": ["2 %", "3 %"],
    "assumed_range": [True, False],
}
# what is known to be taken without effect, and should be refused
KNOWN = [
    ({}, []),
    ({"scan": False}, SCAN),
    ({"plies": 2}, SCAN),
    ({"plies": 2, "scan": True}, []),
    ({"crossovers": "auto"}, []),
]


@pytest.mark.parametrize("given, silent", KNOWN)
def test_each_option_changes_the_plan(given, silent):
    others = {option: values for option, values in VALUES.items() if option not in given}
    given = {"opening": "50 mm"} | given
    assert without_effect(wc.critical_velocity, ["S-720"], given, others) == silent


@pytest.mark.parametrize("out", ["mine", "file", "file/inside"])
def test_a_check_refuses_the_folder_that_the_run_refuses(out, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(limit, "search", None)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "report.html").write_text("of the user")
    (tmp_path / "file").write_text("of the user")
    said = []
    for check in (True, False):
        with pytest.raises(InputError) as refused:
            wc.critical_velocity("S-720", opening="50 mm", out=out, check=check)
        said.append(str(refused.value))
    assert said[0] == said[1]
    assert {path.name for path in tmp_path.rglob("*")} == {"mine", "report.html", "file"}
