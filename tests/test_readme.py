"""README's numbers are those of the pages that commands write; other tests hold its errors, captions and claims."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text("utf-8")
WORDS = " ".join(README.split())


def page(name):
    return " ".join((ROOT / "docs" / name).read_text("utf-8").split())


def rows(name, columns):
    """Cells of the rows of fabrics in the first table of a page with that many columns."""
    lines = (ROOT / "docs" / name).read_text("utf-8").splitlines()
    cells = [line.strip("| ").split(" | ") for line in lines if line.startswith("| S-")]
    found = [row for row in cells if len(row) == columns]
    return {row[0]: row for row in reversed(found)}


def test_ratios_of_the_computed_laws_are_those_of_the_page_of_calibration():
    others = [row for name, row in rows("reports/calibration.md", 12).items() if name != "S-720"]
    assert len(others) == 5
    for letter, column in (("a", 6), ("b", 7)):
        low, high = (pick(float(row[column]) for row in others) for pick in (min, max))
        expected = {"a": f"a of the other five is {low} to {high} times", "b": f"b {low} to {high} times"}
        assert expected[letter] in WORDS
    own = rows("reports/calibration.md", 12)["S-720"]
    assert max(abs(float(own[column]) - 1) for column in (6, 7)) <= 0.0200001
    assert "S-720 within 2 %" in WORDS


def test_costs_and_misfits_are_those_of_the_page_of_validation():
    text = page("validation.md")
    for number in ("0.080 s", "32 s", "0.7 to 3.3 s", "8.0 to 9.8 s"):
        assert number in WORDS, number
        assert number in text, number
    assert "54 to 61 %" in WORDS
    assert "54 to 61 %" in text
    assert "16 to 21 %" in WORDS
    assert "16 to 21 %" in text


def test_the_energy_balance_is_that_of_the_captions_that_stop():
    stopped = [row for row in _captions() if row[3] == "stops"]
    assert len(stopped) == 6
    assert max(float(row[9]) for row in stopped) <= 0.02
    assert "within 0.02 % of the strike energy" in WORDS


def _captions():
    text = (ROOT / "docs" / "reports" / "one-ply.md").read_text("utf-8")
    part = text.partition("<!-- captions of")[2].partition("<!-- end of captions")[0]
    return [line.strip("| ").split(" | ") for line in part.splitlines() if line.startswith("| S-")]


def test_errors_of_the_default_mesh_are_those_of_the_page_of_convergence():
    """Of one ply with one element per crossover, in the order of that page, and of packs on their default mesh."""
    lines = (ROOT / "docs" / "reports" / "convergence.md").read_text("utf-8").splitlines()
    cells = [line.strip("| ").split(" | ") for line in lines if line.startswith("| S-")]
    for fabric in ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745"):
        V, *pairs = [bold(row[8]) for row in cells if row[0] == fabric and len(row) == 13]
        found = [V, *(f"{one} / {other}" for one, other in zip(pairs[::2], pairs[1::2], strict=True))]
        assert f"| {fabric} | {' | '.join(found)} |" in README
    for plies, fabric in (("2", "S-726"), ("2", "S-728"), ("4", "S-728")):
        rows = [line.strip("| ").split(" | ") for line in lines if line.startswith(f"| {plies} | {fabric} |")]
        V, warp, weft, energy = [bold(row[9]) for row in rows if len(row) == 11]
        assert f"| {plies} plies, {fabric} | {V} | | at 1.5: {energy} | {warp} / {weft} |" in README


def bold(error):
    number = error.strip("* |")
    return f"**{number}**" if abs(float(number)) > 10 else number
