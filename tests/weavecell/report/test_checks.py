"""Quality checks as users meet them: summary.json, report, printed line, exit code."""

import json

import pytest

from fabrics import catalogue
from fabrics.errors import DoubtfulError
from shellfabric.panel import quality
from shellfabric.panel.quality import Indicator
from tests.scene_text import impact_scene
from validation.models.cable.smith import smith
from weavecell.commands.impact import run
from weavecell.report import checks

GOOD, BAD, WORSE = Indicator("a", 0.5, 1.0), Indicator("b", 2.0, 1.0), Indicator("c", 9.0, 1.0, "m")
NOTED = Indicator("d", 0.5, 1.0, note=0.1)


def short_scene(edge, plies=1):
    return impact_scene(
        "92.5 m/s", end_time="30 us", edge_radius=edge, panel=f"plies = {plies}", run='outputs = ["report"]'
    )


def test_status_and_line():
    assert checks.status((GOOD,)) == "ok"
    assert checks.line((GOOD,)) == ""
    assert checks.status((GOOD, BAD)) == "doubtful"
    assert checks.line((GOOD, BAD, WORSE)) == "c 9.00 m (limit 1 m); b 2.00 (limit 1)"
    assert checks.line((BAD,) * 5).endswith("2 more in the summary")


def test_the_summary_tells_each_indicator():
    found = checks.summary((GOOD, BAD))["checks"]
    assert found["status"] == "doubtful"
    assert [one["ok"] for one in found["indicators"]] == [True, False]
    assert {"name", "value", "limit", "unit", "meaning", "ok"} <= set(found["indicators"][0])


def test_a_viscous_share_is_noted_from_10_and_doubtful_from_25_per_cent():
    limit, _, meaning = quality.LIMITS["viscous energy"]
    found = {share: Indicator("viscous energy", share, limit, "", meaning, quality.NOTES["viscous energy"])
             for share in (0.09, 0.11, 0.24, 0.31)}  # fmt: skip
    assert [one.status for one in found.values()] == ["ok", "noted", "noted", "doubtful"]
    assert checks.status(found.values()) == "doubtful"
    assert checks.words((GOOD, found[0.11])) == "noted: viscous energy 0.110 (noted above 0.1, limit 0.25)"
    assert checks.words((GOOD,)) == "ok"


def test_what_is_noted_is_printed_and_no_error(capsys):
    checks.report((GOOD, NOTED), strict=True)
    assert capsys.readouterr().out == "checks: noted: d 0.500 (noted above 0.1, limit 1)\n"
    assert checks.summary((NOTED,))["checks"]["indicators"][0]["status"] == "noted"
    section = checks.section((NOTED,))
    assert section.lead == "Noted: d 0.500 (noted above 0.1, limit 1)."
    assert section.tables[0].rows[0][3] == "noted (noted above 0.1)"


def test_a_doubtful_result_is_an_error_where_that_is_wanted(capsys):
    checks.report((GOOD,), strict=True)
    assert capsys.readouterr().out == ""
    checks.report((BAD,))
    assert capsys.readouterr().out == "checks: doubtful: b 2.00 (limit 1)\n"
    with pytest.raises(DoubtfulError) as problem:
        checks.report((BAD,), strict=True)
    assert problem.value.exit_code == 3


def test_the_section_of_the_report():
    section = checks.section((GOOD, BAD))
    assert "b 2.00 (limit 1)" in section.lead
    assert [row[3] for row in section.tables[0].rows] == ["ok", "doubtful"]


@pytest.mark.parametrize("plies", [1, 2])
def test_a_run_with_an_edge_that_no_point_of_contact_resolves(tmp_path, capsys, plies):
    path = tmp_path / "scene.toml"
    few = "\n[numerics]\ncontact_points = 8\n"  # those of the default follow the edge
    path.write_text(short_scene("0.05 mm", plies) + few, encoding="utf-8")
    with pytest.raises(DoubtfulError, match="contact point spacing"):
        run(path, tmp_path / "out", strict=True)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["checks"]["status"] == "doubtful"
    assert summary["stop_time_s"] is None
    assert summary["residual_velocity_m_s"] * 30e-6 < summary["max_deflection_m"] < 92.5 * 30e-6 * 1.1
    for name, yarn in zip(("warp", "weft"), catalogue.load("S-720").weave.yarns):
        # a yarn that has to take the crossing yarns along carries more than a lone one struck at this velocity
        assert smith(yarn, 92.5).tension < summary[f"peak_tension_{name}_N"] < yarn.strength
    assert "Quality checks" in (tmp_path / "out" / "report.html").read_text()
    assert "checks: doubtful" in capsys.readouterr().out


def test_a_good_run_says_nothing(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(short_scene("0.3 mm"), encoding="utf-8")
    run(path, tmp_path / "out", strict=True)
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["checks"]["status"] == "ok"
    assert "doubtful" not in capsys.readouterr().out
