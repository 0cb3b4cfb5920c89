"""The study of meshes: its whole program on a tiny panel, and its targets on numbers made up for them."""

import csv
from math import nan
from pathlib import Path

import pytest

from validation.marked_page import split
from validation.program import marks
from validation.verification.mesh_convergence import __main__ as program
from validation.verification.mesh_convergence.study import FACTORS, Case, Limit, Measured
from weavecell.studies.window import Window


@pytest.mark.parametrize(
    ("plies", "quantity", "value", "met"),
    [(1, "absorbed_energy", 10.29, True), (1, "absorbed_energy", 9.69, False), (1, "absorbed_energy", nan, False),
     (4, "absorbed_energy", 9.51, True), (4, "absorbed_energy", 10.51, False), (2, "critical_velocity", 9.79, False),
     (1, "critical_velocity", 10.19, True), (1, "cut_yarns", 20.0, True)],
)  # fmt: skip
def test_targets_are_met_within_three_five_and_two_percent(plies, quantity, value, met):
    row = program.Deviation(plies, "S-728", quantity, {"default": (value, 0.3), "finer": (10.0, 0.4)})
    assert row.met == met
    expected = 10 * (value - 10), 100 * (0.03**2 + (0.1 * value * 0.04) ** 2) ** 0.5
    assert row.percent("default") == pytest.approx(expected, nan_ok=True)


def measured(velocity, **case):
    """A case whose shots all absorb 12 J and leave half the strike velocity."""
    row = {"outcome": "perforated", "absorbed_energy_J": 12.0, "cut_yarns": 4.0, "cpu_s": 0.2, "elements": 100}
    shots = [row | {"strike_velocity_m_s": 200 * factor, "residual_velocity_m_s": 100.0 * factor,
                    "viscous energy": 0.1 * factor} for factor in FACTORS]  # fmt: skip
    return Measured(Case("S-728", **case), Limit(velocity, 0.1), Window(200.0, tuple(shots)))


def test_misses_are_bold_and_counted():
    text = program.tables([[measured(143.0), measured(140.0, mesh="finer")]])
    assert "| 1 | S-728 | critical velocity, m/s | 143 ± 0.1 | 140 ± 0.1 | **+2.1 ± 0.1** | 2 |" in text
    assert "| critical velocity | 1 | 2 | 0 of 1 |\n| absorbed energy | 1 | 3 | 1 of 1 |" in text
    assert "| 1 | S-728 | finer | 100 | 0.20 | 10.8 | 0 of 9 |" in text
    weaves = program.weave_table([measured(velocity) for velocity in (200.0, 204.0, 190.0)])
    assert ["**" in row for row in weaves.splitlines()[2:]] == [False, False, True]  # +0.0, +4.0 and -9.8 %
    keys = [(length, factor) for length in program.LENGTHS for factor in program.COURANT]
    group = [measured(1e5 * length + factor, failure_length=length, cfl=factor) for length, factor in keys]
    assert "\n| 0.75 | 75.45 ± 0.1 | 75.9 ± 0.1 | 12 ± " in program.filter_table(group)


def test_the_program_writes_its_tables_and_goes_on_from_its_folder(tmp_path, monkeypatch):
    page, out, ends = tmp_path / "page.md", tmp_path / "out", marks("means", program.MODULE)
    page.write_text("before {} {} after".format(*ends))
    few = {"fabrics": ["S-728"], "plies": [1], "opening": 0.03, "table_size": 41, "out": out, "page": page}
    program.main(**few)
    with (out / "convergence.csv").open(newline="") as file:
        default, finer = csv.DictReader(file)
    assert int(finer["elements"]) > 2 * int(default["elements"])
    assert float(default["window_middle_m_s"]) == pytest.approx(1.5 * float(default["critical_velocity_m_s"]), abs=0.1)
    text = page.read_text()
    assert text.count("| 1 | S-728 | ") == 4 + 2  # quantities and meshes
    assert (tmp_path / "figures" / "convergence-means.png").stat().st_size > 10_000
    monkeypatch.setattr("shellfabric.impact.simulation.run", None)  # nothing is shot again
    program.main(**few, resume=True)
    assert page.read_text() == text
    for study in ("means", "weaves", "filter"):  # of the report, for each table
        split(Path(__file__).parents[3] / "docs" / "reports" / "convergence.md", *marks(study, program.MODULE))
