"""Quasi-static tests on coupons with all their options: bias extension, and a cross pulled by its four arms."""

from __future__ import annotations

import time
import tomllib
from dataclasses import dataclass, replace
from importlib import resources
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue, variants
from fabrics.units import si
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.coupon import quasistatic
from validation.published.bias_extension import cases, dynamic
from validation.verification.cost_accuracy.core import Method

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

    def cell(self, fabric: Fabric) -> CellTable:
        """Table of a fabric."""
        fabric = variants.with_law_form(fabric, self.law)
        if self.elements < 1:
            fabric = variants.homogenised(fabric, round(1 / self.elements))
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


def read(name: str) -> Any:
    """The default case of a scene of scenes.toml: a Bias or Cross."""
    content = tomllib.loads(
        (resources.files("validation.verification.cost_accuracy") / "scenes.toml").read_text("utf-8")
    )[name]
    lengths: dict[str, Any] = {
        key: si(content.pop(key), "m", key=key) for key in ("length", "width", "elongation") if key in content
    }
    return (Bias if lengths else Cross)(**content, **lengths)


def warm(case: Any) -> Bias | Cross:
    """A small and short case of the same kernels."""
    small = replace(
        case, elements=1, table=21, explicit="", steps=1, tolerance=1e-1, model="compressible", law="regularised"
    )
    return replace(small, elongation=0.1 * case.elongation) if isinstance(case, Bias) else replace(small, strain=1e-3)


def methods(base: Bias | Cross) -> tuple[Method, ...]:
    """All methods for a coupon; the first is the default."""

    def one(choice, name, **changes):
        return Method(choice, name, replace(base, **changes))

    found = [
        one("default", "default"),
        one("default", "default of version 0.2: tolerance 0.0001", tolerance=1e-4),
        one("cell", "decoupled", model="decoupled"),
        one("cell", "incompressible", model="incompressible"),
        one("cell", "printed law", law="printed"),
        *(one("table", f"table {n}", table=n) for n in (26, 51, 101)),
        *(one("elements", f"{n} per crossover", elements=e) for n, e in (("1/2 element", 0.5), ("2 elements", 2))),
        *(one("load step", f"{n} load step{'s' * (n > 1)}", steps=n) for n in (1, 10)),
        *(one("tolerance", f"tolerance {t:g}", tolerance=t) for t in (1e-2,)),
        one("combined", "table 51, 1 step", table=51, steps=1),
        one("combined", "1/2 element per crossover, table 51, 1 step", elements=0.5, table=51, steps=1),
        one("combined", "1/2, decoupled, 26, 1 step, 1e-2", elements=0.5, model="decoupled", table=26, steps=1,
            tolerance=1e-2),
    ]  # fmt: skip
    if isinstance(base, Bias):
        found += [one("explicit", f"explicit, {name}, table 51", explicit=element, table=51)
                  for element, name in (("yarns", "yarn grid"), ("one point", "one-point element"))]  # fmt: skip
    return tuple(found)


def references(base: Bias | Cross, finest: tuple[float, ...]) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """(meshes, finer) for `core.Scene`: the meshes, and a finer table, finer steps and tolerance at the first.

    All are relaxed to a tenth of the default tolerance.
    """
    base = replace(base, tolerance=0.1 * base.tolerance)
    meshes = tuple((1 / n, replace(base, elements=n)) for n in finest)
    first = replace(base, elements=finest[0])
    return meshes, (
        (first, replace(first, table=401)),
        (first, replace(first, steps=2 * base.steps)),
        (first, replace(first, tolerance=0.1 * base.tolerance)),
    )
