"""What a yarn pull-out leaves: its record (histories.h5), its summary, and its curve as load.csv."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FilePath
from fabrics.files import write_hdf5, write_whole
from weavecell.results.hdf5_file import put

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.coupon.pull_out_curve import PullOutCurve
    from shellfabric.panel.quality import Indicator

FORMAT = "weavecell pull-out 1"
_TEXTS = ("title", "fabric", "law_name", "test", "outcome", "failure_message")
# column of the curve: name in files, unit
COLUMNS = {
    "time": ("time", "s"),
    "displacement": ("displacement of the crosshead", "m"),
    "load": ("load", "N"),
    "sliding": ("crossovers in slip", "1"),
    "left": ("crossovers left", "1"),
    "friction_work": ("work of friction", "J"),
}
ENERGY_MEANING = "largest error of the energy balance over the work of the crosshead"


@dataclass(frozen=True)
class PullOutRecord:
    """One yarn pull-out.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    outcome : "complete" or "unstable"
    failure_message : why an unstable run was ended; "" for others
    wall_time : [s]
    curve : shellfabric.coupon.pull_out_curve.PullOutCurve
    checks : tuple of shellfabric.panel.quality.Indicator; kept in summary.json alone
    """

    title: str
    fabric: str
    law_name: str
    outcome: str
    failure_message: str
    wall_time: float
    curve: PullOutCurve
    checks: tuple = ()
    test: str = "pull_out"

    @classmethod
    def of(cls, curve: PullOutCurve, **others: Any) -> PullOutRecord:
        """The record of a curve; `others` are title, law_name, failure_message and wall_time."""
        fabric, outcome = curve.coupon.table.model.fabric.name, "unstable" if others["failure_message"] else "complete"
        return cls(fabric=fabric, outcome=outcome, curve=curve, checks=indicators(curve), **others)

    def lines(self) -> list[str]:
        """Results in a few lines: a name in 44 columns, and a value with its unit."""
        curve, summary = self.curve, self.summary()
        plateau = "not reached" if curve.plateau is None else f"{curve.plateau:.4g} N"
        rows = (
            ("displacement of the crosshead", f"{1e3 * summary['displacement_m']:.4g} mm"),
            ("peak load", f"{curve.peak:.4g} N"),
            ("plateau load", plateau),
            ("slip length at the peak", f"{1e3 * curve.slip_length:.4g} mm"),
            ("crossovers that the yarn's end has left", f"{curve.left[-1]} of {curve.coupon.crossings}"),
            ("work of friction", f"{1e3 * curve.friction_work[-1]:.4g} mJ"),
            ("energy error over the work", f"{100 * curve.energy_error:.2g} %"),
        )
        return [f"{name:<44}{value}" for name, value in rows]

    def summary(self) -> dict[str, Any]:
        """Set-up and results as a flat dict, for summary.json."""
        curve, coupon = self.curve, self.curve.coupon
        return {name: getattr(self, name) for name in _TEXTS} | {
            "wall_time_s": self.wall_time,
            "crossings": coupon.crossings,
            "velocity_m_s": coupon.velocity,
            "pre_tension_N": coupon.pre_tension,
            "crossover_friction": coupon.friction.mu,
            "crossover_cohesion_N": coupon.friction.cohesion,
            "yarn_bending_N_m2": coupon.friction.bending[0],
            "displacement_m": float(curve.displacement[-1]),
            "peak_load_N": curve.peak,
            "plateau_load_N": curve.plateau,
            "slip_length_m": curve.slip_length,
            "crossovers_left": int(curve.left[-1]),
            "crossover_friction_work_J": float(curve.friction_work[-1]),
            "energy_error_max": curve.energy_error,
        }

    def columns(self) -> dict[str, np.ndarray]:
        """{name with unit: (n,)} of the curve."""
        return {f"{name} [{unit}]": getattr(self.curve, key) for key, (name, unit) in COLUMNS.items()}

    def write(self, path: FilePath) -> None:
        """Write the record, whole or not at all."""
        with write_hdf5(path, FORMAT) as file:
            for name in _TEXTS:
                file.attrs[name] = getattr(self, name)
            file.attrs["wall_time_s"] = self.wall_time
            for key, (name, unit) in COLUMNS.items():
                put(file, f"histories/{name}", getattr(self.curve, key), unit)

    def write_csv(self, path: FilePath) -> None:
        """Write the curve, a row a sample, quantities in SI units."""
        columns = self.columns()
        with write_whole(path) as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(columns)
            for row in zip(*columns.values()):
                table.writerow([f"{value:.9g}" for value in row])


def run(table: CellTable, inputs: Any, hooks: Sequence[Any] = (), bending: float = 0.0) -> PullOutCurve:
    """Run the pull-out of a cell's table.

    Parameters
    ----------
    table : CellTable, variational
    inputs : object with the entries of `scenes.coupon.PullOutTable`
    hooks : called with the solver after each sample
    bending : [N m2] bending stiffness of the yarns, with which the contact force of the threshold is computed

    Raises
    ------
    InputError : values that do not fit the fabric
    UnstableError : its `result` is the curve so far
    """
    from shellfabric.coupon import pull_out_curve
    from shellfabric.coupon.pull_out import PullOut
    from shellfabric.panel.numerics import Numerics
    from shellfabric.sliding.model import CrossoverFriction

    friction = CrossoverFriction(inputs.crossover_friction, inputs.crossover_cohesion, (bending, bending))
    coupon = PullOut(
        table, inputs.crossings, inputs.velocity, inputs.pre_tension, friction, Numerics(threads=1), inputs.all_yarns
    )
    return pull_out_curve.follow(coupon, inputs.displacement, samples=inputs.samples, hooks=hooks)


def indicators(curve: PullOutCurve) -> tuple[Indicator, ...]:
    """Quality indicators of a pull-out."""
    from shellfabric.panel import quality

    limit, unit, _ = quality.LIMITS["energy error"]
    error = quality.Indicator("energy error", curve.energy_error, limit, unit, ENERGY_MEANING)
    return (error, *quality.of_cell(curve.coupon.table, (curve.peak, curve.coupon.pre_tension)))
