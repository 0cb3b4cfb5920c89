"""A yarn pull-out: the run, its record, and its histories.h5."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fabrics.checks import FilePath
from fabrics.files import write_hdf5
from fabrics.record import Record
from weavecell.results.hdf5_file import put

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.coupon.pull_out_curve import PullOutCurve
    from shellfabric.panel.quality import Indicator

FORMAT = "weavecell pull-out 1"
MEANINGS = {
    "time": "[s] time",
    "displacement of the crosshead": "[m] displacement of the crosshead",
    "load": "[N] load on the pulled yarn",
    "crossovers in slip": "[1] crossovers that the yarn slides through",
    "crossovers left": "[1] crossovers that the end of the yarn has left",
    "work of friction": "[J] work of friction at the crossovers",
}
ENERGY_MEANING = "largest error of the energy balance over the work of the crosshead"


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


def record(curve: PullOutCurve, **facts: Any) -> Record:
    """The record of a curve, a row a sample; `facts` come first."""
    coupon, columns = curve.coupon, ("time", "displacement", "load", "sliding", "left", "friction_work")
    return Record(
        columns={name: getattr(curve, column) for name, column in zip(MEANINGS, columns)},
        meanings=MEANINGS,
        facts={
            **facts,
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
        },
    )


def indicators(curve: PullOutCurve) -> tuple[Indicator, ...]:
    """Quality indicators of a pull-out."""
    from shellfabric.panel import quality

    limit, unit, _ = quality.LIMITS["energy error"]
    error = quality.Indicator("energy error", curve.energy_error, limit, unit, ENERGY_MEANING)
    return (error, *quality.of_cell(curve.coupon.table, (curve.peak, curve.coupon.pre_tension)))


def write(path: FilePath, record: Record) -> None:
    """Write histories.h5, whole or not at all."""
    with write_hdf5(path, FORMAT) as file:
        file.attrs.update({name: value for name, value in record.facts.items() if value is not None})
        for name, values in record.columns.items():
            put(file, f"histories/{name}", values, record.unit(name))
