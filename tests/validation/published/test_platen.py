"""The study of the platen curve: variants change what they say; its measures separate loose from packed yarn."""

import numpy as np
import pytest

from fabrics import catalogue
from validation.published import platen as study


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
    rows = study.factor_rows(pressed, law)
    assert {len(row) for row in rows} == {len(study.HEAD)}
    assert rows[1][5] == f"{1e6 * loose:.1f}"
