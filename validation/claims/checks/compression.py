"""Transverse compression: pressure law (chapter 2), law of the cell, gaps between plies (chapter 5)."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache, partial
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import curve_fit

from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.compression import CompressionLaw
from fabrics.plate_curve import PlateCurve
from shellfabric.cell import crossover_kernels
from validation.claims import changed_fabrics
from validation.claims.readers import KEVLAR, derivative
from validation.values import Values, largest


@cache
def pressure_law() -> dict[str, float]:
    """Read {"c1", "c2", "start", "peak", "platen"} in SI, of the built-in one-ply law."""
    content = tomllib.loads((resources.files("fabrics") / "pressure_law.toml").read_text("utf-8"))
    units = {
        "c1": "Pa * m^3 / (kg/m^2)^3",
        "c2": "Pa * m^3",
        "start": "N",
        "peak": "N",
        "platen": "m",
    }
    return {key: si(content[key]["value"], unit) for key, unit in units.items()}


def stiffness(name: str, plies: int = 1, table: str = "2-1") -> float:
    """Compute K'' [Pa m3] of a fabric or of a pack of it, read off its plate curve.

    `table` of the thesis has the areal density: 2-1 measured, 5-1 of its model.
    """
    return _stiffness(name, plies, table, changed_fabrics.in_force())


@cache
def _stiffness(name, plies, table, _):
    """As `stiffness`, once for the changes that are in force."""
    fabric = changed_fabrics.load(name)
    density = fabric.areal_density_measured
    if table == "5-1":
        # E-07: the table has that of the yarns whose linear density its runs imply
        density = fabric.with_effective_density().weave.areal_density
    curve = PlateCurve.pressure_law(density, plies)
    P = curve.pressure
    return float((curve.closure[-1] / (P[0] ** (-1 / 3) - P[-1] ** (-1 / 3))) ** 3)


def packs(fabric: str, plies: Sequence[int], table: str = "2-1") -> FloatArray:
    """Compute K'' (n,) [Pa m3] of packs of each number of plies (erratum E-02)."""
    return np.array([stiffness(fabric, n, table) for n in plies])


def closures(K: FloatArray, start: float) -> FloatArray:
    """Compute what a pack closes by, (n,) [m], between a start load [N] and the peak load of the
    platen."""
    P = np.array([start, pressure_law()["peak"]]) / pressure_law()["platen"] ** 2
    return np.cbrt(K) * (P[0] ** (-1 / 3) - P[1] ** (-1 / 3))


def gap(fabric: str, start: float, plies: int = 4, table: str = "2-1") -> float:
    """Compute what an interface in a pack closes by [m] (eqs. 5-1 to 5-4); `table` as of `stiffness`."""
    one, many = closures(packs(fabric, (1, plies), table), start)
    return (many - one) / (plies - 1)


def refitted_exponent(noise: float, seed: int) -> float:
    """Fit the exponent of the pressure law again, to a curve of the law with noise on it."""
    curve = PlateCurve.pressure_law(changed_fabrics.load("S-720").areal_density_measured)
    P0 = curve.pressure[0]
    scale = curve.closure[-1]
    measured = curve.closure / scale + noise * np.random.default_rng(seed).standard_normal(
        curve.closure.size
    )
    (_, n), _ = curve_fit(
        lambda P, k, n: k * (1 - (P / P0) ** (-1 / n)), curve.pressure, measured, p0=(1.0, 2.0)
    )
    return n


def areal_density_floor() -> float:
    """Find the areal density [kg/m2] below which there is no pressure law."""
    low = 0.05
    high = 0.3
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        try:
            PlateCurve.pressure_law(middle)
            high = middle
        except InputError:
            low = middle
    return high


def in_the_cell(law: CompressionLaw, F: ArrayLike) -> FloatArray:
    """Compute the compression [m] of a yarn under contact forces [N], as the kernel of the cell has
    it."""
    return np.array(
        [crossover_kernels.compression(float(f), law.a, law.b, _shift(law))[0] for f in np.ravel(F)]
    )


def _shift(law):
    if law.form == "regularised":
        return law.F0
    return 0.0


def compliance_error() -> float:
    """Compare the slope of the law that the cell iterates with, and differences of its compression,
    with b / (3 F^(4/3))."""
    worst = 0.0
    for name in KEVLAR:
        given = changed_fabrics.load(name).laws[0]
        for law in (given, CompressionLaw(given.a, given.b, form="printed")):
            for F in (1.0, 10.0, 100.0):
                written = law.b / (3 * (F + _shift(law)) ** (4 / 3))
                slopes = (
                    derivative(partial(in_the_cell, law), F, 3e-3 * F)[0],
                    crossover_kernels.compression(F, law.a, law.b, _shift(law))[1],
                    law.dd_dF(F),
                )
                worst = max(worst, *(abs(float(slope) / written - 1) for slope in slopes))
    return worst


def layers_taken_off(
    fabric: str, layer_modulus: float, layer_thickness: float, rows: int
) -> Values:
    """Compute the closure of a ply from two records, with and without it, of a test with PTFE
    layers; over the ply's own.

    Both are written as files of `rows` rows and read as a user's are; the layers are linear.
    """
    own = PlateCurve.pressure_law(changed_fabrics.load(fabric).areal_density_measured)
    layer = 2 * layer_thickness / layer_modulus  # [m/Pa] of both
    with TemporaryDirectory() as folder:
        curves = []
        for name, least, ply in (("with.csv", 1.0, 1.0), ("layers.csv", 0.9, 0.0)):
            P = np.geomspace(least * own.pressure[0], own.pressure[-1], rows)
            closed = layer * (P - P[0]) + ply * own.at(np.maximum(P, own.pressure[0]))
            text = "".join(f"{1e-6 * p:.9g}, {1e6 * c:.9g}\n" for p, c in zip(P, closed))
            path = Path(folder) / name
            path.write_text("pressure [MPa], closure [um]\n" + text, encoding="utf-8")
            curves.append(PlateCurve.read(path))
    P = np.geomspace(1.01 * own.pressure[0], 0.99 * own.pressure[-1], 50)
    both, alone = (curve.at(P) - curve.at(P[0]) for curve in curves)
    off = (both - alone) - (own.at(P) - own.at(P[0]))
    end = own.closure[-1]
    return {
        "largest difference over the end": largest(off) / end,
        "layers over the ply": float(alone[-1] / end),
    }
