"""The page of sliding crossovers: its tables from made-up results, and its place in the documentation."""

from math import nan
from pathlib import Path

from validation.verification import sliding
from validation.verification import sliding_pull_out as pulls

PAGE = Path(__file__).parents[3] / "docs" / "reports" / "sliding.md"


def made_up():
    limits = [(90.0 + n, 91.0 + n, n, 1e-4, 2e-3) for n in range(len(sliding.FABRICS) * (1 + len(sliding.MU)))]
    limits[1] = (nan, nan, 0, nan, nan)
    return {
        "scaling": [[[0.01] * 5 for _ in sliding.SHARES] for _ in sliding.FABRICS],
        "stability": [(1e-4, "in flight", 0.0, 0.5) for _ in sliding.THRESHOLDS for _ in sliding.CFL],
        "cost": [(20.0, 100), (22.0, 100), *[(26.0, 150)] * len(sliding.MU)],
        "pulled": [(1.0, 1e-4)] * len(pulls.CROSSINGS) * len(pulls.PULL_MU),
        "under_load": [(1.0, 5.0, 1e-4)] * len(pulls.STIFFNESS) * len(pulls.COUNTS) * len(pulls.LOADS),
        "limit": limits,
    }


def test_every_study_has_its_table():
    made = sliding.text(made_up())
    for heading in ("effective stretch", "Stability", "Cost", "Pull-out", "Critical velocity"):
        assert f"### {heading}" in made or f"of the {heading}" in made
    assert "1.30" in made
    assert "none found" in made
    assert made.count("S-745") >= 2


def test_the_page_has_a_place_for_the_tables_and_is_listed():
    assert all(mark in PAGE.read_text("utf-8") for mark in sliding.MARKS)
    assert "\nsliding\n" in (PAGE.parent / "index.md").read_text("utf-8")
