"""Units that are converted without pint: the numbers are pint's own, to the last bit."""

import subprocess
import sys

import numpy as np
import pytest

from fabrics import units

PAIRS = [(unit, to) for to, table in units.FACTORS.items() for unit in table]
NUMBERS = [f"{x:.{n}g}" for n, x in zip((1, 2, 3, 6, 12) * 20, np.random.default_rng(1).lognormal(2.0, 3.0, 100))]


@pytest.mark.parametrize(("unit", "to"), PAIRS)
def test_the_factors_are_those_of_pint(unit, to):
    for number in ("0", "1", "-3", ".5", "2.", "7e-3", *NUMBERS):
        text = f"{number} {unit}"
        assert units.si(text, to) == units._convert_by_pint(text, to)


@pytest.mark.parametrize(
    ("text", "to"), [("3 mm", "s"), ("3 furlong mm", "m"), ("mm", "m"), ("3 mm 4", "m"), ("", "m")]
)
def test_everything_else_is_read_by_pint(text, to, monkeypatch):
    seen = []
    monkeypatch.setattr(units, "_convert_by_pint", lambda *given: seen.append(given) or 1.0)
    units._convert_text.cache_clear()
    units.si(text, to)
    units._convert_text.cache_clear()
    assert seen == [(text, to)]


def test_the_usual_units_need_no_pint():
    code = (
        "from fabrics.units import si; si('3 g', 'kg'); si('9 / cm', '1/m'); import sys; print('pint' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "False"
