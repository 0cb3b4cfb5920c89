"""Tension per yarn against strain of a crossover stretched at a fixed ratio of strains, or with a free edge.

k = warp strain / weft strain. With a free edge the yarn that crosses carries nothing, and so the contact carries
nothing either (F = 2 T sin(alpha), eq. 4-8): the stretched yarn takes out its crimp alone, then pulls straight.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.units import si
from shellfabric.cell.model import CellModel

RATIOS = (0.5, 1.0, 2.0)
TOE = "strain that the fibres' straightening takes: 0.1 %, or one of the warp and one of the weft, 0.1 %,0.2 %"


def toe_of(text: str) -> Any:
    """A strain from "0.1 %", or those of warp and weft from "0.1 %, 0.2 %"."""
    values = tuple(si(part.strip(), "", key="--toe") for part in text.split(","))
    return values[0] if len(values) == 1 else values


@dataclass(frozen=True)
class Curve:
    """One test on the crossover.

    Parameters
    ----------
    label : "k = 2", "free weft", "free warp"
    strain : (n, 2) [-] of the fabric along warp and weft; the free direction's strain is not prescribed, it is nan
    tension : (n, 2) [N] per yarn
    failed : "warp", "weft" or None, the yarn that reaches its strength at the end of the curve
    """

    label: str
    strain: np.ndarray
    tension: np.ndarray
    failed: str | None


def at_ratio(model: CellModel, k: float, n: int = 241) -> Curve:
    """Stretch both directions from rest at warp strain = k x weft strain, until the first yarn is at its strength.

    Raises
    ------
    InputError : k is not positive
    """
    if not k > 0:
        raise InputError(key="k", value=k, allowed="a positive ratio of warp strain to weft strain")
    path = np.array([k, 1.0]) / max(k, 1.0)
    strengths = np.array([yarn.strength for yarn in model.fabric.weave.yarns])

    def tension(s):
        response = model.solve(1 + path[0] * s, 1 + path[1] * s)
        return np.stack([response["T1"], response["T2"]], axis=-1)

    low, high = 0.0, 1.0
    while high - low > 1e-9:  # the tensions rise along the path, so that the first failure can be bracketed
        middle = 0.5 * (low + high)
        low, high = (low, middle) if np.any(tension(middle) >= strengths) else (middle, high)
    s = np.linspace(0, high, n)
    values = tension(s)
    failed = ("warp", "weft")[int(np.argmax(values[-1] / strengths))]
    return Curve(f"k = {k:g}", s[:, None] * path, values, failed)


def free_edge(model: CellModel, direction: str, n: int = 241) -> Curve:
    """Stretch one direction, "warp" or "weft", with the other free."""
    index = ("warp", "weft").index(direction)
    end = (1 + model.fabric.weave.yarns[index].crimp) * (1 + model.ultimate_strains[index]) - 1
    strain = np.full((n, 2), np.nan)
    strain[:, index] = np.linspace(0, end, n)
    tension = np.zeros((n, 2))
    tension[:, index] = model.alone(index, 1 + strain[:, index])
    return Curve(f"free {'weft' if index == 0 else 'warp'}", strain, tension, direction)


def curves(fabric: Fabric, **model: Any) -> list[Curve]:
    """The thesis's tests on one weave, with the thesis's form of the cell: k = 0.5, 1, 2 and the two free edges."""
    cell = CellModel(fabric, form="equilibrium", **model)
    return [at_ratio(cell, k) for k in RATIOS] + [free_edge(cell, direction) for direction in ("warp", "weft")]
