"""NaN and infinite numbers in each column of each table that a user gives: one line, with file, line and value."""

from pathlib import Path

import pytest

MINE = Path(__file__).parents[2] / "examples" / "fabrics" / "mine.csv"
NEW = f"fabrics new x.toml --from {MINE}"
# name of the reader: (command, module it needs, rows of the table; the second row of numbers gets the bad value)
READERS = {
    "yarn curve": (f"{NEW} --yarn-curve t.csv", "", "strain [%], force [N]\n0.1, 10\n0.2, 20\n"),
    "picture frame": (
        f"{NEW} --picture-frame t.csv",
        "",
        "shear angle [deg], shear stress [MPa]\n5, 0.1\n10, 0.2\n",
    ),
    "picture frame, force": (
        f"{NEW} --picture-frame t.csv",
        "",
        "force [N], shear angle [deg]\n5, 2\n10, 4\n",
    ),
    "platen curve": (
        "calibrate S-720 --platen-curve t.csv --out r",
        "dolfinx",
        "pressure [MPa], closure [um]\n1, 5\n2, 9\n",
    ),
    "path of a crossover": (
        "crossover path S-720 --path t.csv --mesh 3,2,2 --out r",
        "dolfinx",
        "d1 [um], d2 [um]\n3, 4\n5, 6\n",
    ),
    "contact of plies": (
        "impact scene.toml --out r",
        "",
        "closure [um], pressure [MPa]\n0, 0\n10, 1\n",
    ),
    "fired tests": (
        "reduce tests t.csv --out r",
        "",
        "velocity [m/s], residual velocity [m/s], outcome\n90, 0, PP\n120, 30, CP\n",
    ),
}
SCENE = """
fabric.name = "S-720"
projectile = { mass = "3 g", diameter = "5.5 mm", edge_radius = "0.3 mm", strike_velocity = "90 m/s" }
panel = { opening = "30 mm", plies = 2, ply_contact = "t.csv" }
"""


@pytest.mark.parametrize("bad", ["nan", "-inf", "1e400"])
@pytest.mark.parametrize("column", [0, 1])
@pytest.mark.parametrize("reader", READERS)
def test_what_is_not_finite_is_one_line(command, tmp_path, reader, column, bad):
    run, module, text = READERS[reader]
    if module:
        pytest.importorskip(module)
    heading, first, row = text.splitlines()
    cells = row.split(", ")
    cells[column] = bad
    name = heading.split(", ")[column].partition(" [")[0]
    (tmp_path / "t.csv").write_text(f"# a comment\n{heading}\n{first}\n{', '.join(cells)}\n")
    (tmp_path / "scene.toml").write_text(SCENE)
    code, _, err = command(*run.split())
    assert err == f"error: t.csv: line 4, {name} = {bad!r}: must be a finite number\n"
    assert code == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["scene.toml", "t.csv"]
