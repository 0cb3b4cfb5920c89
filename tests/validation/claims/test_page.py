"""The page of the claims: made from its stored rows, with every claim; README has the counts of the same rows."""

from pathlib import Path

import pytest

from fabrics.errors import InputError
from validation.claims import claims as data
from validation.claims import judge, page
from validation.claims.claims import Claim, Condition

ROOT = Path(__file__).parents[3]
STAMP = {"command": "weavecell validate", "commit": "abc", "date": "today", "cost": "1 minute"}


def made():
    condition = Condition("h", "value", 0.12, within=0.005, unit="mm")
    claims = [
        Claim("geom-a", "number", "eq. 1", "analytic", "ledger", "h", (condition,), "test", "x", cause="none known"),
        Claim("impact1-b", "number", "Fig. | 2", "analytic", "ledger", "h", (condition,), "test", "x"),
        Claim("gap-c", "number", "eq. 3", "analytic", "ledger", "h", untestable="a lost figure"),
    ]
    records = [
        judge.judge(claims[0], {"h": 0.2e-3}),
        judge.Record("impact1-b", judge.REPRODUCED, {"h": 0.12e-3}, variants={"nominal denier": judge.MISSED}),
        judge.unchecked(claims[2]),
    ]
    return page.rows(claims, records)


def test_rows_have_both_values_and_the_cause_of_a_miss():
    missed, held, lost = made()
    assert (missed["verdict"], missed["cause"]) == (judge.MISSED, "none known")
    assert (missed["computed"], missed["published"]) == ("h 0.2 mm", "0.12 ± 0.005 mm")
    assert (held["cause"], held["variants"]) == ("", "holds in 1 of 2; missed with nominal denier")
    assert (lost["computed"], lost["cause"]) == ("", "a lost figure")


def test_counts_in_words():
    told = page.sentence(made())
    assert "of the 2 that are decided, 1 are reproduced (50 %) and 1 missed" in told
    assert "1 cannot be tested" in told
    assert page.variants_sentence(made()) == (
        "Of 1 such claims 0 hold in 5 of 5, and a variant changes the result of 1"
    )


def test_page_and_data_are_written_together(tmp_path):
    page.write(tmp_path / "claims.md", made(), **STAMP)
    assert page.read(tmp_path / page.DATA) == made()
    text = (tmp_path / "claims.md").read_text("utf-8")
    assert text == page.lines(made(), **STAMP)
    row = [line for line in text.splitlines() if line.startswith("| `impact1-b`")][-1]  # the first is of the variants
    assert row.count("|") == 8, "a bar of the text would end a cell"
    with pytest.raises(InputError, match="--page"):
        page.write(tmp_path / "nowhere" / "claims.md", made(), **STAMP)


def test_a_page_of_some_topics_is_refused(tmp_path):
    from validation.commands.claims import validate

    with pytest.raises(InputError, match="--page"):
        validate(tmp_path / "out", topics=["geom"], slow=False, jobs=1, resume=False, page=tmp_path / "claims.md")
    assert not (tmp_path / "out").exists()


def test_the_page_has_every_claim_and_is_made_from_its_rows():
    table = page.read(ROOT / "docs" / "reports" / page.DATA)
    assert sorted(row["id"] for row in table) == sorted(claim.id for claim in data.load())
    assert not page.counts(table)[judge.BROKEN]
    lead, _, rest = (ROOT / "docs" / "reports" / "claims.md").read_text("utf-8").partition("## Counts")
    assert "weavecell validate" in lead
    assert rest == page.lines(table, **STAMP).partition("## Counts")[2]


def test_validation_and_readme_have_the_counts_of_the_page():
    table = page.read(ROOT / "docs" / "reports" / page.DATA)
    added = {entry["id"] for entry in data.entries(data.FILES[1])}
    found = page.counts([row for row in table if row["id"] not in added])
    decided = found[judge.REPRODUCED] + found[judge.MISSED]
    readme = (ROOT / "README.md").read_text("utf-8")
    assert f"of the {decided} that are decided, {found[judge.REPRODUCED]} are reproduced" in readme
    text = " ".join((ROOT / "docs" / "validation.md").read_text("utf-8").split())
    assert page.sentence(table) in text
    assert page.variants_sentence(table) in text
