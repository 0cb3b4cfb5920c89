"""Pull-out of one yarn from a strip, from the keys of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.coupon.pull_out import PullOutCurve


def run(table: CellTable, inputs: Any, bending: float = 0.0) -> PullOutCurve:
    """Run the pull-out of a cell's table.

    Parameters
    ----------
    table : CellTable, variational
    inputs : object with the entries of `scenes.coupon.PullOutTable`
    bending : [N m2] bending stiffness of the yarns, with which the contact force of the threshold
        is computed

    Raises
    ------
    InputError : values that do not fit the fabric
    """
    from shellfabric.coupon import pull_out

    coupon = pull_out.PullOut(
        table=table,
        crossings=inputs.crossings,
        pre_tension=inputs.pre_tension,
        mu=inputs.crossover_friction,
        cohesion=inputs.crossover_cohesion,
        bending=(bending, bending),
    )
    return pull_out.follow(coupon, inputs.displacement, samples=inputs.samples)
