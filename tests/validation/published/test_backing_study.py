"""The drop test as a program: a coarse one runs, its rows and sentence say what came, and the page has its marks."""

import csv
from pathlib import Path

from fabrics import backings
from validation.published import backing as study

PAGE = Path(__file__).parents[3] / "docs" / "reports" / "backing.md"


def test_a_coarse_drop_test_writes_its_table_and_picture(tmp_path):
    study.main(out=tmp_path, meshes=(15.0,), plies=())
    with open(tmp_path / "drop-test.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["backing"] for row in rows] == list(backings.list_names())
    for row in rows:
        assert 5 < float(row["deepest, mm"]) < 60
        assert float(row["left, mm"]) <= float(row["deepest, mm"])
        # 0.5 % where nothing is eroded; gelatine loses bricks, and here they are half as wide as the ball's radius
        assert float(row["energy error, %"]) < (0.5 if row["backing"] == study.CLAY else 1.0)
    assert (tmp_path / "drop-test.png").read_bytes().startswith(b"\x89PNG")


def test_the_sentence_says_whether_the_dent_is_in_the_window():
    of = lambda size, left: (study.CLAY, f"{size}", "", f"{left + 1}", f"{left}")  # noqa: E731
    inside, outside = study.in_the_limit([of(6, 22.0)]), study.in_the_limit([of(12, 28.0), of(6, 24.0)])
    assert "22.0 mm: within it." in inside
    assert "24.0 mm: outside it." in outside
    assert "leads to 21.0 mm deepest and 20.0 mm left" in outside


def test_the_page_has_places_for_both_tables():
    text = PAGE.read_text("utf-8")
    assert all(mark in text for mark in (*study.MARKS, *study.PACKS))
