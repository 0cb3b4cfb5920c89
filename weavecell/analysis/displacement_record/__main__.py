"""python -m weavecell.analysis.displacement_record RECORD.csv [...] [--mass '3 g'] [--window '20 us'] [--out FOLDER]

Reduces displacement records to velocity, energy and deceleration with their errors: one CSV and one picture a record,
and for all of them shots.csv with strike and residual velocities and energies, and its picture. The format of a record
is described in weavecell/analysis/displacement_record/record.py.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Mapping
from pathlib import Path

from fabrics.checks import FilePath
from fabrics.errors import run_program
from fabrics.files import write_whole
from fabrics.units import si
from weavecell.analysis.displacement_record.pictures import history, shots
from weavecell.analysis.displacement_record.record import Record
from weavecell.analysis.displacement_record.reduction import Reduction, reduce

COLUMNS = (
    "time [s]",
    "displacement [m]",
    "velocity [m/s]",
    "error [m/s]",
    "of noise [m/s]",
    "of smoothing [m/s]",
    "absorbed energy [J]",
    "error [J]",
    "deceleration [m/s2]",
    "error [m/s2]",
    "force [N]",
    "error [N]",
)


def write(found: Reduction, path: FilePath) -> None:
    """One row a sample."""
    columns = (
        found.record.t,
        found.x,
        found.v,
        found.v_error,
        found.v_noise,
        found.v_smoothing,
        found.absorbed,
        found.absorbed_error,
        -found.a,
        found.a_error,
        -found.mass * found.a,
        found.mass * found.a_error,
    )
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow(COLUMNS)
        rows.writerows([f"{value:.7g}" for value in row] for row in zip(*columns))


def write_shots(reductions: Mapping[str, Reduction], path: FilePath) -> None:
    """One row a record: strike and residual velocity, strike and absorbed energy, with errors."""
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow(
            [
                "record",
                "strike velocity [m/s]",
                "error",
                "residual velocity [m/s]",
                "error",
                "outcome",
                "strike energy [J]",
                "absorbed energy [J]",
                "error",
            ]
        )
        for name, found in reductions.items():
            strike, residual = found.strike, (0.0, found.residual[1]) if found.stopped else found.residual
            energy = 0.5 * found.mass * strike[0] ** 2
            error = found.mass * ((residual[0] * residual[1]) ** 2 + (strike[0] * strike[1]) ** 2) ** 0.5
            values = (*strike, *residual), (energy, energy - 0.5 * found.mass * residual[0] ** 2, error)
            rows.writerow(
                [
                    name,
                    *(f"{v:.5g}" for v in values[0]),
                    "stopped" if found.stopped else "moving",
                    *(f"{v:.5g}" for v in values[1]),
                ]
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m weavecell.analysis.displacement_record", description=__doc__.splitlines()[2]
    )
    parser.add_argument("records", nargs="+", type=Path, metavar="RECORD.csv")
    parser.add_argument("--mass", default="3 g", help="of the projectile")
    parser.add_argument("--window", help="over which polynomials are fitted; the best ones if left out")
    parser.add_argument("--out", type=Path, default=Path("results/elvs"))
    options = parser.parse_args()
    mass = si(options.mass, "kg", key="--mass")
    window = si(options.window, "s", key="--window") if options.window else None
    found = {path.stem: reduce(Record.read(path), mass, window=window) for path in options.records}
    for name, reduction in found.items():
        write(reduction, options.out / f"{name}.csv")
        history(name, reduction, options.out / f"{name}.png")
        end = (
            "stopped"
            if reduction.stopped
            else f"{reduction.residual[0]:.1f} ± {reduction.residual[1]:.1f} m/s at the end"
        )
        print(
            f"{name}: strike {reduction.strike[0]:.2f} ± {reduction.strike[1]:.2f} m/s, {end}; window "
            f"{1e6 * reduction.windows[0]:.1f} us, noise {1e6 * reduction.noise:.1f} um"
        )
    write_shots(found, options.out / "shots.csv")
    shots(found, options.out / "shots.png")


if __name__ == "__main__":
    run_program(main)
