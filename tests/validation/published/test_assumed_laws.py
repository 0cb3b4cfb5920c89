"""Ranges over assumed laws: what the tables say, the page, and a fabric without laws."""

from dataclasses import replace
from pathlib import Path

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from validation.program import marks
from validation.published import assumed_laws as study
from weavecell.analysis.assumed_range import AssumedRange, Row

PAGE = Path(__file__).parents[3] / "docs" / "reports" / "assumed-laws.md"


def made(critical=(100.0, 90.0, 120.0), published=110.0):
    nominal, low, high = critical
    rows = (Row("nominal", "", nominal), Row("trellis soft", "", low), Row("trellis stiff", "", high))
    around = AssumedRange("critical velocity", ("the trellis law",), rows)
    fabric = catalogue.load("S-720")
    law = CompressionLaw(4e-5, 5e-5, assumed_range=((5e-5, 4e-5), (3e-5, 5e-5)))
    return study.Comparison(fabric, law, published, around, 143.0, published, around)


def test_a_fabric_without_laws_is_completed_by_its_family():
    from fabrics import assumed

    bare = study.without_laws(catalogue.load("S-720"))
    assert (bare.laws, bare.shear, bare.solid_laws) == (None, None, None)
    assert assumed.with_shear(assumed.with_solid_laws(bare)).assumed == ("solid", "shear")


def test_tables_say_whether_the_published_value_is_within_the_range():
    within, outside = made(), replace(made(), critical=130.0)
    assert [row[-1] for row in study.velocities([within, outside])[1:]] == ["yes", "yes", "**no**", "yes"]
    assert study.velocities([within])[1][3:6] == ["100.0", "90.0 to 120.0", "15.0"]
    assert study.laws([within])[1] == [
        "S-720", "0.0450", "0.0400 (0.0500, 0.0300)", "0.0580", "0.0500 (0.0400, 0.0500)",
    ]  # fmt: skip
    assert [row[0] for row in study.combinations([within])] == ["laws", "nominal", "trellis soft", "trellis stiff"]


def test_the_page_has_every_table_with_a_row_for_each_fabric():
    text = PAGE.read_text("utf-8")
    for name in ("stamp", "velocities", "laws", "combinations"):
        begin, end = marks(name, study.__name__)
        part = text.partition(begin)[2].partition(end)[0]
        assert part.strip()
        if name != "stamp":
            assert all(fabric in part for fabric in study.FABRICS)
