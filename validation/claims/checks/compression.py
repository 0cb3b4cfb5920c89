"""Transverse compression: pressure law (chapter 2), law of the cell, solids (chapter 3), gaps of plies (chapter 5)."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, curve_fit

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.plate_curve import PlateCurve
from fabrics.units import si
from shellfabric.cell import crossover_kernels
from shellfabric.cell.model import CellModel
from shellfabric.plies.gap import compression_gap
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.registry import Found, check


@cache
def pressure_law() -> dict[str, float]:
    """{"c1", "c2", "start", "peak", "platen"} in SI, of the built-in one-ply law."""
    content = tomllib.loads((resources.files("fabrics") / "pressure_law.toml").read_text("utf-8"))
    units = {"c1": "Pa * m^3 / (kg/m^2)^3", "c2": "Pa * m^3", "start": "N", "peak": "N", "platen": "m"}
    return {key: si(content[key]["value"], unit) for key, unit in units.items()}


@cache
def stiffness(name: str, plies: int = 1) -> float:
    """K'' [Pa m3] of a fabric or of a pack of it, read off its plate curve."""
    curve = PlateCurve.pressure_law(catalogue.load(name).areal_density_measured, plies)
    P = curve.pressure
    return float((curve.closure[-1] / (P[0] ** (-1 / 3) - P[-1] ** (-1 / 3))) ** 3)


def packs(fabric: str, plies: Sequence[int]) -> FloatArray:
    """(n,) K'' [Pa m3] of packs of each number of plies (erratum E-02)."""
    return np.array([stiffness(fabric, n) for n in plies])


def closures(K: FloatArray, start: float, law: Any = None) -> FloatArray:
    """(n,) [m] what a pack closes by between a start load [N] and the peak load of the platen."""
    law = law or pressure_law()
    P = np.array([start, law["peak"]]) / law["platen"] ** 2
    return np.cbrt(K) * (P[0] ** (-1 / 3) - P[1] ** (-1 / 3))


def gap(fabric: str, start: float, plies: int = 4) -> float:
    """[m] of an interface in a pack (eqs. 5-1 to 5-4)."""
    K = packs(fabric, (1, plies))
    one, many = closures(K, start)
    return (many - one) / (plies - 1)


@check()
def exponent(noise: float, seed: int) -> Found:
    """Refit of the exponent to a curve of the law with noise on it."""
    curve = PlateCurve.pressure_law(catalogue.load("S-720").areal_density_measured)
    P0, scale = curve.pressure[0], curve.closure[-1]
    measured = curve.closure / scale + noise * np.random.default_rng(seed).standard_normal(curve.closure.size)

    def law(P, k, n):
        return k * (1 - (P / P0) ** (-1 / n))

    (_, n), _ = curve_fit(law, curve.pressure, measured, p0=(1.0, 2.0))
    return {"exponent": n}


@check()
def fit_constant(fabric: str) -> Found:
    return {"K": stiffness(fabric)}


@check()
def fit_constant_trend() -> Found:
    K = {name: stiffness(name) for name in KEVLAR}
    cubes = np.array([catalogue.load(name).areal_density_measured ** 3 for name in KEVLAR])
    values, order = np.array(list(K.values())), ranked(K)
    return {
        "correlation with the cube": np.corrcoef(cubes, values)[0, 1],
        "slope": np.polyfit(cubes, values, 1)[0],
        "largest": order[0],
        "smallest": order[-1],
    }


@check()
def areal_density_floor() -> Found:
    low, high = 0.05, 0.3
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        try:
            PlateCurve.pressure_law(middle)
            high = middle
        except InputError:
            low = middle
    return {"floor": high}


@check()
def b_from_pressure_law(fabric: str) -> Found:
    def b(name):
        return np.cbrt(stiffness(name) * catalogue.load(name).weave.cell_area)

    ratios = [catalogue.load(name).laws[0].b / b(name) for name in KEVLAR]
    return {"b": b(fabric), "least of table over computed": min(ratios), "greatest of table over computed": max(ratios)}


@check()
def law_asymptote() -> Found:
    """The law as the cell evaluates it: its shape, its limit, and the distance to it over b / (F + F0)^(1/3)."""
    F, ok, worst, off = np.geomspace(1e-3, 1e3, 400), True, 0.0, 0.0
    for name in catalogue.list_names():
        law = catalogue.load(name).laws[0]
        d = in_the_cell(law, F)
        slope = np.diff(d) / np.diff(F)
        ok = ok and bool(np.all(slope > 0) and np.all(np.diff(slope) < 0))
        worst = max(worst, abs(float(in_the_cell(law, [1e12 * law.F0])[0]) / law.a - 1))
        off = max(off, float(np.abs((law.a - d) * np.cbrt(F + law.F0) / law.b - 1).max()))
    return {"rises ever more slowly": ok, "distance from a": worst, "remaining compression, off the law": off}


def in_the_cell(law: CompressionLaw, F: ArrayLike) -> FloatArray:
    """[m] compression of a yarn under contact forces [N], as the kernel of the cell has it."""
    shift = law.F0 if law.form == "regularised" else 0.0
    return np.array([crossover_kernels.compression(float(f), law.a, law.b, shift)[0] for f in np.ravel(F)])


@check()
def compliance() -> Found:
    """Slope of the law that the cell iterates with, and differences of its compression, against b / (3 F^(4/3))."""
    worst = 0.0
    for name in KEVLAR:
        given = catalogue.load(name).laws[0]
        for law in (given, CompressionLaw(given.a, given.b, form="printed")):
            shift = given.F0 if law.form == "regularised" else 0.0
            for F in (1.0, 10.0, 100.0):
                written = law.b / (3 * (F + shift) ** (4 / 3))
                h = 3e-3 * F  # central differences of four points: the error falls with h^4
                d = in_the_cell(law, [F + k * h for k in (-2, -1, 1, 2)])
                slopes = (
                    (d[0] - 8 * d[1] + 8 * d[2] - d[3]) / (12 * h),
                    crossover_kernels.compression(F, law.a, law.b, shift)[1],
                    float(law.dd_dF(F)),
                )
                worst = max(worst, *(abs(slope / written - 1) for slope in slopes))
    return {"relative difference": worst}


@check()
def van_wyk() -> Found:
    """Exponent of the force on the room that is left, of the law as the cell evaluates it."""
    law = catalogue.load("S-720").laws[0]
    F = law.F0 * np.geomspace(1e-2, 1e5, 50)
    room = law.a - in_the_cell(law, F)
    return {"exponent": -np.polyfit(np.log(room), np.log(F + law.F0), 1)[0]}


@check()
def gutowski(V0: float, Va: float) -> Found:
    def stress(V):
        return (np.sqrt(V / V0) - 1) / (np.sqrt(Va / V) - 1) ** 4

    return {
        "at the initial fraction": stress(V0),
        "near the greatest, over that midway": stress(Va * (1 - 1e-9)) / stress(0.5 * (V0 + Va)),
    }


@check()
def packs_softer(fabric: str, plies: Sequence[int]) -> Found:
    K = packs(fabric, plies)
    closed = dict(zip(map(str, plies), closures(K, pressure_law()["start"])))
    return {"order": ranked(closed), "note": ", ".join(f"{n}: {1e6 * d:.0f} um" for n, d in closed.items())}


@check()
def peak_pressure() -> Found:
    law = pressure_law()
    return {"pressure": law["peak"] / law["platen"] ** 2}


@check()
def table_columns(c1: float, c2: float) -> Found:
    law = pressure_law()
    # MPa um3, with the areal density in 100 g/m2
    ours = law["c1"] * 0.1**3 / 1e-12, law["c2"] / 1e-12
    return {"c1 over that of eq. 2-6": c1 / ours[0], "c2 over that of eq. 2-6": c2 / ours[1]}


@check()
def pack_series(fabric: str, plies: Sequence[int]) -> Found:
    b = np.cbrt(packs(fabric, plies))
    return {f"{n} plies": b[k] / (n * b[0]) for k, n in enumerate(plies)}


@check()
def gap_algebra() -> Found:
    """What a pack of N plies closes by in all, from the gap that a pack of panels is set up with, over the plate curve.

    The gap of the panels (`shellfabric.plies.model.compression_gap`), times N - 1 and with one ply's closure, against
    eq. 2-5 solved for the whole pack.
    """
    worst, start = 0.0, pressure_law()["start"]
    for name in KEVLAR:
        given = catalogue.load(name)
        for N in (4, 8, 16):
            one, pack = closures(packs(name, (1, N)), start)
            built = one + (N - 1) * compression_gap(given.areal_density_measured, N)
            worst = max(worst, abs(built / pack - 1))
    return {"difference": worst}


@check()
def gap_size(fabric: str, start: float) -> Found:
    return {"gap": gap(fabric, start)}


@check()
def gap_start_load(gaps: dict[str, Any]) -> Found:
    def misfit(start):
        return [gap(name, start) / printed - 1 for name, printed in gaps.items()]

    loads = np.geomspace(2, 50, 2000)
    best = loads[np.argmin([np.sum(np.square(misfit(load))) for load in loads])]
    own = [brentq(lambda load, n=n, g=g: gap(n, load) - g, 1, 100) for n, g in gaps.items()]
    off = max(abs(gap(name, best) - printed) for name, printed in gaps.items())
    return {
        "start load": best,
        "largest difference of a gap": off,
        "note": ", ".join(f"{n} alone {load:.1f} N" for n, load in zip(gaps, own)),
    }


@check()
def gap_trend(fabric: str) -> Found:
    gaps = [gap(fabric, load) for load in (20, 10, 5, 2)]
    return {"least growth": min(np.diff(gaps))}


@check()
def gap_range() -> Found:
    gaps = [g for g in (catalogue.load(name).interlayer_gap for name in KEVLAR) if g is not None]
    return {"least": min(gaps), "greatest": max(gaps), "fabrics": len(gaps)}


@check()
def one_law_for_both() -> Found:
    return {
        "alike": all(catalogue.load(name).laws[0] == catalogue.load(name).laws[1] for name in catalogue.list_names())
    }


@check()
def misprinted_a(fabric: str, printed_a: float) -> Found:
    found: Found = {}
    given = catalogue.load(fabric)
    for name, a in (("used", given.laws[0].a), ("as printed", printed_a)):
        law = CompressionLaw(a, given.laws[0].b, form="printed")
        rest = CellModel(given, (law, law), form="equilibrium").solve(1.0, 1.0)
        found |= {
            f"force at rest, a {name}": rest["F"],
            f"weft at rest over its strength, a {name}": rest["T2"] / given.weave.weft.strength,
        }
    return {name: float(value) for name, value in found.items()}


@check()
def least_volume() -> Found:
    """Volume per area that is left under no end of pressure: thickness of the cloth less its closure by eq. 2-5.

    The thickness is that of the micrographs (Table A-1), which is of the cloth that was tested.
    """
    start = pressure_law()["start"] / pressure_law()["platen"] ** 2
    fabrics = [catalogue.load(name) for name in KEVLAR]
    mass = [fabric.areal_density_measured for fabric in fabrics]
    closed = np.array([np.cbrt(stiffness(name)) * start ** (-1 / 3) for name in KEVLAR])
    seen = [np.mean([row["total_thickness"] for row in fabric.micrograph.values()]) for fabric in fabrics]
    least, model = np.array(seen) - closed, np.array([fabric.weave.thickness for fabric in fabrics]) - closed
    return {
        "correlation": float(np.corrcoef(mass, least)[0, 1]),
        "slope": float(np.polyfit(mass, least, 1)[0]),
        "note": ", ".join(f"{name} {1e3 * value:.3f} mm" for name, value in zip(KEVLAR, least))
        + f"; with the thickness of the model the correlation is {np.corrcoef(mass, model)[0, 1]:.2f}",
    }


@check()
def layers_taken_off(fabric: str, layer_modulus: float, layer_thickness: float, rows: int) -> Found:
    """Closure of a ply from two records, with and without it, of a test with PTFE layers; over the ply's own.

    Both are written as files of `rows` rows and read as a user's are; the layers are linear.
    """
    own = PlateCurve.pressure_law(catalogue.load(fabric).areal_density_measured)
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
    return {
        "largest difference over the end": float(np.abs(off).max() / own.closure[-1]),
        "layers over the ply": float(alone[-1] / own.closure[-1]),
    }
