"""The study of published tests: its shots, its tables, and that its fabrics have the mass of the tests."""

import pytest

import weavecell as wc
from validation.published import measured_shots as study


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
