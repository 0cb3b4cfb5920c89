"""The section of sliding crossovers in the report of an impact."""

from types import SimpleNamespace

import numpy as np

from shellfabric.sliding.solver import SlipSummary
from weavecell.report import chapters_impact


def test_the_section_says_what_the_slip_came_to():
    record = SimpleNamespace(
        bar=None, backing=None, slip=SlipSummary(1.5e-3, 2.25e-3, 4, 0.03), failed_segments=np.array([0, 3]),
        strike_energy=15.0,
    )  # fmt: skip
    (section,) = chapters_impact.body(record)
    assert section.key == "slip"
    assert [value for _, value in section.tables[0].rows] == ["3", "4", "1.5", "2.25", "0.03", "0.2"]
    record.slip = None
    assert chapters_impact.body(record) == []


def test_a_pack_has_a_row_a_ply():
    slips = (SlipSummary(1.5e-3, 2.25e-3, 4, 0.03), SlipSummary(0.5e-3, 1.25e-3, 0, 0.015))
    section = chapters_impact.slips(SimpleNamespace(slips=slips, strike_energy=15.0))
    assert section.tables[0].rows == (("1", "4", "1.5", "2.25", "0.03"), ("2", "0", "0.5", "1.25", "0.015"))
    assert "0.3 % of the strike energy" in section.tables[0].caption
