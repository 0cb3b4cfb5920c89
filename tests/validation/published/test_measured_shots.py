"""The study of published tests: its shots, its tables, and that its fabrics have the mass of the tests."""

import pytest

import weavecell as wc
from validation.published import measured_shots as study

STOP = {"outcome": "stopped", "residual_velocity_m_s": 0.0, "ply_failed_yarn_segments": [2.0, 0.0, 8.0],
        "max_deflection_m": 0.0123, "energy_error_max": 4e-4, "checks": "ok"}  # fmt: skip
THROUGH = STOP | {"outcome": "perforated", "residual_velocity_m_s": 78.4}


def test_outcomes_in_words():
    assert study.outcome(STOP) == "stops"
    assert study.outcome(THROUGH) == "**perforates**, 78 m/s left"
    assert study.outcome(THROUGH | {"outcome": "in flight"}) == "undecided, 78 m/s left"


def test_tables_hold_the_tests_beside_what_is_computed():
    head, *rows = study.packs([STOP])
    assert rows[0] == ["21", "2.5", "438", "stops", "2 of 21", "12.3", "0.04", "ok"]
    assert [(row[0], row[3]) for row in rows[1:]] == [(f"{n}", "not computed") for n in (38, 42, 48, 62)]
    assert all(len(row) == len(head) for row in rows)
    head, *rows = study.bullets([STOP, THROUGH])
    assert rows[1][:4] == ["309.1", "2 of 15", "**perforates**, 78 m/s left", "2 of 15"]
    assert all(len(row) == len(head) for row in rows)
    head, row = study.varied({"other yarns": STOP})
    assert row[:3] == ["other yarns", "stops", "2 of 21"]
    assert len(row) == len(head)


def test_each_variant_changes_one_thing():
    first, second, third = study.other_shots().values()
    assert (first.fabric, first.failure_strain) == ("CT612-1100", None)
    assert (second.fabric, second.failure_strain) == (study.PACK, 0.036)
    assert {(one.plies, one.velocity) for one in (first, second)} == {(21, 438.0)}
    assert third == study.shot_at(study.PACK, 21, 526.0)


def test_a_kept_shot_depends_on_the_sheet_of_its_fabric():
    assert "550 dtex" in study.shot_at(study.PACK, 21).sheet
    assert study.shot_at(study.PACK, 21) != study.shot_at("CT612-1100", 21)


@pytest.mark.parametrize(("name", "mass"), [("CT612-550", 119.0), ("CT612-1100", 119.0), ("K29-467", 467.0)])
def test_fabrics_have_the_mass_of_the_tests(name, mass):
    fabric = wc.fabric(study.HERE / "measured_fabrics" / f"{name}.toml")
    assert 1e3 * fabric.weave.areal_density == pytest.approx(mass, rel=0.015)


def test_a_variant_changes_the_strength_of_the_yarns_alone():
    before = study.fabric_of(study.shot_at(study.PACK, 1)).weave
    after = study.fabric_of(study.shot_at(study.PACK, 1, failure_strain=0.036)).weave
    for one, other in zip(before.yarns, after.yarns):
        assert other.failure_strain == 0.036
        assert other.EA == one.EA
        assert one.strength == pytest.approx(2.92e9 * one.linear_density / one.fibre_density)
