"""Quality checks as users meet them: summary.json, report, printed line, exit code."""

import json
from types import SimpleNamespace

import pytest

import weavecell as wc
from fabrics import catalogue
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import Indicator
from tests.scene_text import impact_scene
from validation.models.cable.smith import smith
from weavecell.report import checks
from weavecell.report.shot import chapters_shot
from weavecell.results.impact import ImpactRecord

GOOD = Indicator("a", 0.5, 1.0)
BAD = Indicator("b", 2.0, 1.0)
WORSE = Indicator("c", 9.0, 1.0, "m")
NOTED = Indicator("d", 0.5, 1.0, note=0.1)


def test_a_result_within_its_limits_is_ok():
    assert checks.status((GOOD,)) == "ok"
    assert checks.line((GOOD,)) == ""
    assert checks.words((GOOD,)) == "ok"


def test_a_doubtful_result_names_what_is_beyond_its_limit_worst_first():
    assert checks.status((GOOD, BAD)) == "doubtful"
    assert checks.line((GOOD, BAD, WORSE)) == "c 9.00 m (limit 1 m); b 2.00 (limit 1)"
    assert checks.line((BAD,) * 5).endswith("2 more in the summary")


def test_the_summary_has_every_indicator():
    found = checks.summary((GOOD, BAD, NOTED))["checks"]
    assert found["status"] == "doubtful"
    assert [one["status"] for one in found["indicators"]] == ["ok", "doubtful", "noted"]
    assert [one["ok"] for one in found["indicators"]] == [True, False, True]
    assert {"name", "value", "limit", "unit", "meaning"} <= set(found["indicators"][0])


def test_the_section_of_the_report_has_every_indicator():
    section = checks.section((GOOD, BAD))
    assert "b 2.00 (limit 1)" in section.lead
    assert [row[3] for row in section.tables[0].rows] == ["ok", "doubtful"]


def test_the_section_of_the_report_has_what_is_noted():
    section = checks.section((NOTED,))
    assert section.lead == "Noted: d 0.500 (noted above 0.1, limit 1)."
    assert section.tables[0].rows[0][3] == "noted (noted above 0.1)"


AT_REST = "back-face signature 9 mm (dent in the block at rest, of 3 cm³, radius at half depth 14.0 mm; deepest 12 mm"


def test_the_report_names_what_is_assumed_of_a_block_and_whether_it_still_moves():
    setup = wc.setup("S-728", "200 m/s", backing={"material": "gelatine 20 %", "modulus": "5 MPa"})
    told = dict(chapters_shot.assumptions(setup, ()).tables[0].rows)["block behind"]
    assert told.startswith(
        "assumed: yield_stress 0.41 MPa, hardening 0.0019 MPa, rate_exponent 0, reference_rate"
    )
    assert ", of the block of gelatine 20 %. Its outer faces are fixed." in told
    moves = "no back-face signature yet: the block moves with 0.33 % of the strike energy or"
    for outcome, at_rest, said, longer in (
        ("stopped", True, AT_REST, ""),
        ("stopped", False, moves, "; backing.after_stop lets it come to rest"),
        ("in flight", False, moves, "; a longer run.end_time, and backing.after_stop, let it"),
    ):
        block = SimpleNamespace(
            at_rest=at_rest,
            back_face_signature=9e-3 if at_rest else None,
            volume=3e-6,
            half_width=14e-3,
            deepest_dent=12e-3,
            deepest_dent_time=640e-6,
        )
        energies = {"backing_kinetic": [1.0]}
        shot = SimpleNamespace(
            backing=block, strike_energy=300.0, energies=energies, outcome=outcome
        )
        for name in ("block_motion", "block_moves", "back_face_signature_mm", "deepest_dent_mm"):
            setattr(shot, name, getattr(ImpactRecord, name).fget(shot))
        told = chapters_shot.dent(shot)
        assert told.startswith(said)
        assert longer in told
        assert ("signature 12" in told) is False
        assert "12 mm at 640 µs" in told


def test_a_viscous_share_is_noted_from_10_and_doubtful_from_15_per_cent():
    found = [quality.indicator("viscous energy", share) for share in (0.09, 0.11, 0.14, 0.16)]
    assert [one.status for one in found] == ["ok", "noted", "noted", "doubtful"]
    assert checks.status(found) == "doubtful"
    run = SimpleNamespace(
        cut_yarns=[0, 2], absorbed_energy=100.0, strike_energy=300.0, energies={"viscous": [0, 36]}
    )
    told = "viscosity took 36 % of what the whole run absorbed; its check ends at the first failure"
    assert ImpactRecord.viscous_note.fget(run) == told
    run.energies["viscous"] = [0, 14]
    assert ImpactRecord.viscous_note.fget(run) == ""


def test_a_line_is_printed_of_what_is_noted_and_what_is_doubtful(capsys):
    for indicator, said in ((GOOD, ""), (NOTED, "noted: d 0.500 (noted above 0.1, limit 1)")):
        checks.report((indicator,))
        assert capsys.readouterr().out == (f"checks: {said}\n" if said else "")
    checks.report((BAD,))
    assert capsys.readouterr().out == "checks: doubtful: b 2.00 (limit 1)\n"


@pytest.mark.parametrize("plies", [1, 2])
def test_a_run_with_an_edge_that_no_point_of_contact_resolves(command, tmp_path, plies):
    path = tmp_path / "scene.toml"
    few = "\n[numerics]\ncontact_points = 8\n"  # those of the default follow the edge
    edge = {"edge_radius": "0.05 mm", "panel": f"plies = {plies}", "run": 'outputs = ["report"]'}
    path.write_text(impact_scene("92.5 m/s", end_time="30 us", extra=few, **edge), encoding="utf-8")
    code, printed, err = command(f"impact {path} --out out --strict")
    assert code == 3
    assert "contact point spacing" in err
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["checks"]["status"] == "doubtful"
    assert summary["stop_time_s"] is None
    # the back face of two plies follows once their gap is closed
    way = 30e-6 * summary["residual_velocity_m_s"] - (summary.get("ply_gap_m") or 0.0)
    assert way < summary["max_deflection_m"] < 92.5 * 30e-6 * 1.1
    for name, yarn in zip(("warp", "weft"), catalogue.load("S-720").weave.yarns):
        # a yarn that has to take the crossing yarns along carries more than a lone one struck at this velocity
        assert smith(yarn, 92.5).tension < summary[f"peak_tension_{name}_N"] < yarn.strength
    assert "Quality checks" in (tmp_path / "out" / "report.html").read_text()
    assert "\nanswer      DOUBTFUL: not decided: " in printed
    assert "\ndoubts      contact point spacing " in printed
