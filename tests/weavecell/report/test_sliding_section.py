"""The section of sliding crossovers in the report of an impact."""

from types import SimpleNamespace

from shellfabric.sliding.model import SlipSummary
from weavecell.report import chapters_impact


def test_the_section_says_what_the_slip_came_to():
    """A row a ply; none of pinned crossovers."""
    slips = (SlipSummary(1.5e-3, 2.25e-3, 4, 0.03), SlipSummary(0.5e-3, 1.25e-3, 0, 0.015))
    record = SimpleNamespace(bar=None, backing=None, slips=slips, strike_energy=15.0)
    (section,) = chapters_impact.body(record)
    assert section.key == "slip"
    assert section.tables[0].rows == (("1", "4", "1.5", "2.25", "0.03"), ("2", "0", "0.5", "1.25", "0.015"))
    assert "0.3 % of the strike energy" in section.tables[0].caption
    record.slips = ()
    assert chapters_impact.body(record) == []
