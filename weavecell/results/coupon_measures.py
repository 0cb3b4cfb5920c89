"""What is read off a test on a coupon, step by step: forces, strains, angles, stresses, with the closed form beside."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from shellfabric.coupon import quasistatic

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.coupon.solver import Result
    from shellfabric.panel.quality import Indicator

TABLE_SIZE = 201  # stretches along each side of the cell's table, as in impacts
# what each test prescribes: name, unit
PRESCRIBED = {
    "bias_extension": ("elongation", "m"),
    "picture_frame": ("shear angle", "rad"),
    "uniaxial": ("strain of the strip", "1"),
    "biaxial": ("strain of the cross", "1"),
}


def relaxed(table: CellTable, test: str, inputs: Mapping[str, Any], **options: Any) -> Result:
    """The Result of a quasi-static test: `inputs` by the keys of its table, options as of its function."""
    named = {"cells" if key == "crossovers" else key: value for key, value in inputs.items()}
    return getattr(quasistatic, test)(table, **named, **options)


def measures(test: str, inputs: Any, result: Result) -> dict[str, tuple[str, np.ndarray]]:
    """{name: (unit, (steps,))} of a `shellfabric.coupon.solver.Result`; `inputs` is the scene's table of the test."""
    return {"bias_extension": _bias, "picture_frame": _frame, "uniaxial": _uniaxial, "biaxial": _biaxial}[test](
        inputs, result
    )


def _bias(inputs, result):
    size, steps = quasistatic.bias_size(result), range(len(result.states))
    zone = quasistatic.zones(result.coupon, *size)
    gamma = [result.shear(k) for k in steps]
    found = {"load": ("N", np.abs(result.force(1, 1)))}
    for k, name in enumerate(quasistatic.ZONES):
        found[f"angle in zone {name}"] = "rad", np.array([0.5 * pi - angles[zone == k].mean() for angles in gamma])
    A, B, C = (found[f"angle in zone {name}"][1] for name in quasistatic.ZONES)
    found["B less the mean of A and C"] = "rad", B - 0.5 * (A + C)
    rigid = [0.5 * pi - quasistatic.inextensible_shear(*size, moved) for moved in result.prescribed]
    found["zone C, yarns that do not stretch"] = "rad", np.array(rigid)
    found["shear concentration"] = "1", np.array([quasistatic.concentration(angles, zone == 2) for angles in gamma])
    return found


def _frame(inputs, result):
    shear, fabric = quasistatic.frame_stress(result), result.coupon.table.model.fabric
    found = {"shear stress": ("Pa", shear)}
    if fabric.shear is not None:
        found["trellis law"] = "Pa", fabric.shear.stress(result.prescribed)
    return found


def _uniaxial(inputs, result):
    weave, along = result.coupon.weave, 0 if inputs.direction == "warp" else 1
    size = np.ptp(result.coupon.points, axis=0)
    yarns = round(float(size[1]) / (2 * weave.w[1 - along]))
    middle = quasistatic.middle_strain(result, 0.2 * (size if along == 0 else size[::-1]))
    load = result.force(1, 0)
    return {
        "load": ("N", load),
        "load of a yarn": ("N", load / yarns),
        "strain in the middle, along": ("1", middle[:, along]),
        "strain in the middle, across": ("1", middle[:, 1 - along]),
    }


def _biaxial(inputs, result):
    weave = result.coupon.weave
    middle = quasistatic.middle_strain(result, [0.6 * inputs.centre * w for w in weave.w])
    loads = [result.force(1, 0), result.force(3, 1)]
    found = {}
    for name, load, strain in zip(("warp", "weft"), loads, middle.T):
        found[f"load of a {name} yarn"] = "N", load / inputs.centre
        found[f"strain in the middle, {name}"] = "1", strain
    cell = result.coupon.table.model.solve(*(1 + middle.T))
    for name, force in zip(("warp", "weft"), ("N1", "N2")):
        found[f"cell at these strains, {name}"] = "N", cell[force]
    return found


def indicators(result: Any, table: Any, tolerance: float) -> tuple[Indicator, ...]:
    """Quality indicators of a test on a CellTable; the load step in which a yarn fails may go beyond its strength."""
    from shellfabric.panel import quality

    reached = [float(tension.max()) for tension in result.coupon.tensions(result.states[-1].x)]
    if result.outcome == "yarn at its strength":
        reached = [min(one, yarn.strength) for one, yarn in zip(reached, table.model.fabric.weave.yarns)]
    return quality.of_coupon(table, reached, max(state.residual for state in result.states), tolerance)
