"""The study of the two tests on S-726: its cases, its table, and that no option leaves the tests' own numbers."""

from pathlib import Path

import pytest

from validation.published import tests_s726 as study
from weavecell.report.marked_page import split

PAGE = Path(__file__).parents[3] / "docs" / "reports" / "tests-s726.md"


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


def test_table_sets_misses_bold():
    row = {"case": "a case", "elements per crossover": "1", "96 m/s": "stops", "110 m/s": "stops",
           "critical velocity [m/s]": "120.0"}  # fmt: skip
    assert study.table([row]).splitlines()[-1] == "| a case | 1 | stops | **stops** | 120.0 | 1 of 2 |"
    row |= {"96 m/s": "perforates, 3 m/s left", "110 m/s": "perforates, 40 m/s left"}
    assert "| **perforates, 3 m/s left** | perforates, 40 m/s left | 120.0 | 1 of 2 |" in study.table([row])


def test_page_has_every_case():
    before, after = split(PAGE, *study.MARKS)
    text = PAGE.read_text("utf-8")[len(before) : -len(after)]
    if "Not computed yet." in text:
        pytest.skip("the study has not been run")
    for case in study.cases():
        for elements in study.MESHES:
            assert f"| {case.name} | {elements} |" in text
