"""The study of the two tests on S-726: its cases, its table, and that no option leaves the tests' own numbers."""

import pytest

from validation.published import tests_s726 as study


def test_every_case_changes_what_it_says():
    reference, *others = (case.panel(1) for case in study.cases())
    for case, panel in zip(study.cases()[1:], others):
        before, after = reference.weave.warp, panel.weave.warp
        assert (after.EA, after.strength) == pytest.approx(
            (case.retained[0] * before.EA, case.retained[1] * before.strength)
        )
        assert (panel.projectile.bar is not None) == case.elastic
        assert panel.projectile.mass == reference.projectile.mass
        assert (panel.edge != "clamped") == (case.grip is not None)
        assert case.damage.status == "assumed"
    assert len({case.name for case in study.cases()}) == len(study.cases())
