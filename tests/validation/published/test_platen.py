"""The study of the platen curve: variants change what they say; its measures separate loose from packed yarn."""

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from validation.published.platen import pictures, study
from validation.published.platen.__main__ import HEAD, factor_rows, range_rows


def test_each_variant_changes_only_what_it_names():
    fabric = catalogue.load(study.FABRIC)
    changed = study.solids(K_r=0.005, Vf0=(0.361, 0.396))(fabric)
    assert [law.K_r for law in changed.solid_laws] == [0.005, 0.005]
    assert [law.Vf0 for law in changed.solid_laws] == [0.361, 0.396]
    assert [law.E_c for law in changed.solid_laws] == [law.E_c for law in fabric.solid_laws]
    assert fabric.solid_laws[0].K_r == 0.02
    names = [variant.name for variant in study.VARIANTS]
    assert len(set(names)) == len(names)
    assert study.VARIANTS[0] is study.PUBLISHED
    assert study.PUBLISHED.change is None


@pytest.fixture(scope="module")
def pressed():
    coarse = {"mesh": {"size": (4, 3, 2)}}
    published = study.Variant("published", "published", **coarse)
    softer = study.Variant("constants", "K_r / 16", study.solids(K_r=0.00125), **coarse)
    return [study.outcome(variant) for variant in (published, softer)]


def test_the_published_yarn_is_too_stiff_when_loose_and_too_soft_when_packed(pressed):
    published, softer = pressed
    law = study.curve(catalogue.load(study.FABRIC)).at(published.pressure)
    loose = float(np.interp(np.log(study.PACKING), np.log(published.pressure), law))
    assert published.loose < 0.5 * loose
    assert published.packed > 1.5 * (law[-1] - loose)
    # a lower modulus of the loose yarn closes more below 1 MPa
    assert softer.loose > 1.3 * published.loose
    assert softer.closure_rms < published.closure_rms
    rows = factor_rows(pressed, law)
    assert {len(row) for row in rows} == {len(HEAD)}
    assert rows[1][5] == f"{1e6 * loose:.1f}"


def test_rows_of_the_ranges():
    rows = range_rows([(27.7e3, 20e-6, 0.8)])
    assert rows[1] == ("0.028", "20.0", "80")


def test_the_shift_of_a_record_that_begins_late():
    """A record that lacks its first 20 um misfits only without the shift; the shift is what it lacks."""
    from validation.published.platen.offset import offset

    pressure = np.geomspace(3e4, 2e7, 16)
    computed = 1.7e-4 * (1 - (pressure / 3e4) ** (-1 / 3))
    same = offset(pressure, computed, computed)
    assert max(same.closure, same.pressure, same.closure_fixed, same.pressure_fixed, *same.higher) < 1e-9
    late = computed.copy()
    late[0] += 20e-6  # the rest of the record is that much too short
    found = offset(pressure, computed, late - late[0])
    assert found.closure_fixed == pytest.approx(20e-6 * np.sqrt(15 / 16), rel=1e-6)
    assert found.closure < 0.3 * found.closure_fixed
    assert found.pressure < 0.3 * found.pressure_fixed
    assert max(found.higher) < 1e-6, "above the lost part the curves are one"


def test_a_folder_without_a_fit_is_refused(tmp_path):
    from validation.published.platen.offset import read

    with pytest.raises(InputError, match="S-720"):
        read(tmp_path, "S-720")


def test_each_constant_is_fitted_alone_and_with_the_others():
    from validation.published.platen import law_by_constant

    assert law_by_constant.choices()[0] == ()
    assert law_by_constant.choices()[-1] == ("E_c", "V_c", "K_r")
    assert len(set(law_by_constant.choices())) == 8
    law = catalogue.load("S-720").laws[0]
    rows = law_by_constant.table("S-720", {(): (law.a, 2 * law.b, [1e-6, 2e-6, 3e-6])})
    assert rows[-1] == ["S-720", "none: the file's solid", "1.00", "2.00", "1.0", "2.0", "3.0"]
    assert rows[1][4:] == [f"{1e6 * float(law.d(F)):.1f}" for F in law_by_constant.FORCES]


def test_the_picture_is_drawn_from_misfits_and_closures(tmp_path):
    variants = study.VARIANTS[:3]
    found = [
        study.Outcome(one, np.ones(2), np.ones(2), 2e-5, 0.6, 5e-5, 7e-5, (0.7, 0.6), "") for one in variants
    ]  # fmt: skip
    pictures.draw(found, 1.3e-4, 4e-5, tmp_path / "platen.png")
    assert (tmp_path / "platen.png").stat().st_size > 10_000
