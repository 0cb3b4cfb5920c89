"""Quasi-static tests on coupons with all their options: bias extension, and a cross pulled by its four arms."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from fabrics.units import si
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.coupon import quasistatic
from validation.models import variants as comparison
from validation.published.bias_extension import cases, dynamic

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


@dataclass(frozen=True)
class Test:
    """The options that all coupon cases share.

    Parameters
    ----------
    elements : a crossover, along each side; below 1: an element of so many crossovers
    model, law, table : of the cell, and of compression
    steps, tolerance : load steps, and what counts as at rest (`relax`); that of `weavecell.scenes.coupon`
    explicit : "" for a quasi-static run, or the element of an explicit one, of `dynamic.pull`
    """

    elements: float = 1
    model: str = "compressible"
    law: str = "regularised"
    table: int = 201
    steps: int = 10
    tolerance: float = 1e-3
    explicit: str = ""

    def changed(self, **changes: Any) -> Any:
        return replace(self, **changes)

    def cell(self, fabric: Fabric) -> CellTable:
        """Table of a fabric."""
        fabric = comparison.with_law_form(fabric, self.law)
        if self.elements < 1:
            fabric = comparison.homogenised(fabric, round(1 / self.elements))
        return CellModel(fabric, model=self.model).table(self.table)

    @property
    def choices(self) -> dict[str, Any]:
        """Keywords of the tests of `quasistatic`."""
        several = max(1, int(self.elements))
        return {"elements_per_crossover": several, "steps": self.steps, "tolerance": self.tolerance}


@dataclass(frozen=True)
class Bias(Test):
    """A bias extension: size and elongation [m]."""

    length: float = 0.0676
    width: float = 0.0338
    elongation: float = 4.7e-3

    def run(self) -> tuple[dict[str, float], float]:
        """Its quantities, and the CPU time [s] of the table."""
        begun = time.process_time()
        size: dict[str, Any] = {"length": self.length, "width": self.width, "elongation": self.elongation}
        if self.explicit:
            pulled = dynamic.pull(
                "locking",
                element=self.explicit,
                table_size=self.table,
                elements_per_crossover=int(self.elements),
                **size,
            )
            return self._angles(np.degrees(pulled.angles[-1])), 0.0
        table = self.cell(cases.cloth("locking")[0])
        filled = time.process_time() - begun
        result = quasistatic.bias_extension(table, **size, **self.choices)
        zone = quasistatic.zones(result.coupon, *quasistatic.bias_size(result))
        gamma = np.degrees(result.shear())
        found = self._angles([90 - gamma[zone == k].mean() for k in range(3)])
        return {"load": float(abs(result.force(1, 1)[-1]))} | found, filled

    @staticmethod
    def _angles(degrees):
        return {f"shear angle of {name}": float(90 - angle) for name, angle in zip("ABC", degrees) if name != "A"}


@dataclass(frozen=True)
class Cross(Test):
    """A cross of a fabric, pulled to a strain of its arms: sizes in crossovers."""

    fabric: str = "S-720"
    strain: float = 0.02
    centre: int = 12
    arm: int = 8

    def run(self) -> tuple[dict[str, float], float]:
        """Its quantities, and the CPU time [s] of the table."""
        begun = time.process_time()
        table = self.cell(catalogue.load(self.fabric).with_effective_density())
        filled = time.process_time() - begun
        many = 1 if self.elements >= 1 else round(1 / self.elements)
        result = quasistatic.biaxial(
            table,
            strain=(self.strain,) * 2,
            centre=self.centre // many,
            arm=self.arm // many,
            cross_yarns_removed=False,
            **self.choices,
        )
        half = [0.25 * self.centre * 2 * w / many for w in table.model.fabric.weave.w]
        strains = quasistatic.middle_strain(result, half)[-1]
        loads = {f"load of the {name}": float(abs(result.force(grip, axis)[-1]))
                 for name, grip, axis in (("warp", 1, 0), ("weft", 3, 1))}  # fmt: skip
        return loads | {f"strain of the {name}": float(e) for name, e in zip(("warp", "weft"), strains)}, filled


def run(case: Any) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]})."""
    begun = time.process_time()
    values, table = case.run()
    return values, {"table": table, "march": time.process_time() - begun - table}


def read(case: dict[str, Any]) -> Any:
    """The default case of a scene of scenes.toml: a Bias or Cross."""
    lengths: dict[str, Any] = {
        key: si(case[key], "m", key=key) for key in ("length", "width", "elongation") if key in case
    }
    return (Bias if lengths else Cross)(**case | lengths)


def warm(case: Any) -> Bias | Cross:
    """A small and short case of the same kernels."""
    small = replace(
        case, elements=1, table=21, explicit="", steps=1, tolerance=1e-1, model="compressible", law="regularised"
    )
    return replace(small, elongation=0.1 * case.elongation) if isinstance(case, Bias) else replace(small, strain=1e-3)
