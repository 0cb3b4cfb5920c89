"""Strength and modulus of yarns over those of the data sheet, against the strain rate: a table,
with its source.

Between two rates of the table a ratio is linear in the logarithm of the rate, as in the law of
Johnson and Cook; beyond the ends it is constant: nothing is extrapolated. Families of fibres:
`fabrics.families`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, placed
from fabrics.base.units import si
from fabrics.fabric_tables import STATUSES

UNITS = {"rates": "1/s", "strength": "", "modulus": ""}
_TABLE = (*UNITS, "source", "status")
# [-] damage sets in over this range below the strength at the slowest rate: slower tests fail
# within it
RAMP = 0.01


def _rises(*values):
    return all(np.diff(values) > 0)


@dataclass(frozen=True)
class RateLaw:
    """Ratios to the data sheet at strain rates.

    Parameters
    ----------
    rates : (n,) [1/s] rising
    strength : (n,) [-] strength over that of the data sheet
    modulus : (n,) [-] modulus over that of the data sheet; empty if it does not change
    source : where the numbers come from
    status : of STATUSES

    Raises
    ------
    InputError : rates that do not rise from above 0, ratios that are not positive or another number
        of them, strengths that neither rise nor are all alike
    """

    rates: tuple[float, ...]
    strength: tuple[float, ...]
    modulus: tuple[float, ...] = ()
    source: str = ""
    status: str = "user"

    def __post_init__(self) -> None:
        if not self.rates or not _rises(0.0, *self.rates, np.inf):
            raise InputError(
                key="rates", value=list(self.rates), allowed="one or more rates above 0, rising"
            )
        for key, count in (
            ("strength", len(self.rates)),
            ("modulus", len(self.rates) if self.modulus else 0),
        ):
            ratios = getattr(self, key)
            if len(ratios) != count or not all(0 < ratio < np.inf for ratio in ratios):
                raise InputError(
                    key=key,
                    value=list(ratios),
                    allowed=f"{len(self.rates)} numbers above 0, one for each rate",
                )

        if len({*self.strength}) > 1 and not _rises(*self.strength):
            raise InputError(
                key="strength", value=list(self.strength), allowed="rising, or all alike"
            )

    @classmethod
    def from_table(cls, table: Any, file: FilePath, default: str = "user") -> RateLaw:
        """Read the law from a table `strain_rate` of a fabric file: three lists, source and status.

        Raises
        ------
        InputError : one line naming the file, the key, its value and what is allowed
        """
        if not isinstance(table, Mapping) or not set(table) <= set(_TABLE):
            wrong = table
            if isinstance(table, Mapping):
                wrong = ", ".join(table)
            raise InputError(
                file=file, key="strain_rate", value=wrong, allowed=f"a table of {', '.join(_TABLE)}"
            )
        if (status := table.get("status", default)) not in STATUSES:
            allowed = f"one of {', '.join(STATUSES)}"
            raise InputError(file=file, key="strain_rate.status", value=status, allowed=allowed)
        columns = {}
        for key, unit in UNITS.items():
            texts = table.get(key, [] if key == "modulus" else None)
            name = f"strain_rate.{key}"
            if not isinstance(texts, list):
                raise InputError(
                    file=file, key=name, value=texts, allowed='a list such as ["30 / s"] or [1.0]'
                )
            columns[key] = tuple(si(text, unit, file=file, key=name) for text in texts)
        with placed(file, "strain_rate."):
            return cls(**columns, source=str(table.get("source", "")), status=status)

    def strength_at(self, rate: float) -> float:
        """Compute the strength [-] over that of the data sheet at a strain rate [1/s]."""
        return float(np.interp(np.log(max(rate, self.rates[0])), np.log(self.rates), self.strength))

    @property
    def dynamic_modulus(self) -> float:
        """[-] modulus over that of the data sheet at the highest rate."""
        if self.modulus:
            return self.modulus[-1]
        return 1.0

    def table(self, failure_strain: float) -> FloatArray:
        """Tabulate (3, n) loads x, and from each to the next the rate of damage [1/s] at it and how
        that grows with the load,

            dD/dt = r'(x) / failure strain = b exp(c (x - x_m))

        as `shellfabric.membrane.criterion_kernels` take them: r(x) is the inverse of the strength, 0 up
        to the first load.
        One load, which nothing damages below, where the strength is the same at all rates.
        """
        loads = np.array(self.strength)
        rates = np.array(self.rates)
        if loads[0] == loads[-1]:
            return np.array([[loads[0]], [0.0], [0.0]])
        growth = np.log(rates[1:] / rates[:-1]) / np.diff(loads)
        first = rates[0] / (RAMP * loads[0])
        slopes = np.concatenate([[first], growth * rates[:-1], [0.0]])
        return np.array(
            [[(1 - RAMP) * loads[0], *loads], slopes / failure_strain, [0.0, *growth, 0.0]]
        )

    def sources(self) -> dict[str, dict[str, str]]:
        """Return the sources as `Fabric.sources` has them: {"strain_rate": {"value", "source",
        "status"}}."""
        parts = [
            f"strength {_list(self.strength)}",
            *([f"modulus {_list(self.modulus)}"] if self.modulus else []),
        ]
        value = f"{', '.join(parts)} at {_list(self.rates)} 1/s"
        return {"strain_rate": {"value": value, "source": self.source, "status": self.status}}


def _list(values):
    return " / ".join(f"{value:g}" for value in values)
