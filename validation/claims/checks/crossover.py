"""The 3D crossover against the shell's cell and against what the thesis says of it (chapter 3, section 4.3.4)."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import trapezoid

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.plate_curve import PlateCurve
from shellfabric.cell.model import CellModel
from validation.claims.checks.cell import against_lone_warp
from validation.claims.judge import Found


def platen_error(pressed: Any, fabric: str, least: float) -> float:
    """Closure of the 3D crossover from a pressure [Pa] on, less the law's, over the law's; the largest."""
    given = catalogue.load(fabric)
    pressure, closure = pressed.F_plate.mean(axis=1) / given.weave.cell_area, 2 * (pressed.plates[0] - pressed.plates)
    law = PlateCurve.pressure_law(given.areal_density_measured)
    P = np.geomspace(least, min(pressure.max(), law.pressure[-1]), 60)
    ours, theirs = np.interp(P, pressure, closure), np.interp(P, law.pressure, law.closure)
    ours, theirs = ours - ours[0], theirs - theirs[0]
    return (np.abs(ours[1:] - theirs[1:]) / theirs[1:]).max()


def work_lost(run: Any) -> float:
    """[-] share of the work of closing a pack that it does not give back."""
    closing, opening = (float(trapezoid(pressure, closure)) for closure, pressure in (run.loading, run.unloading))
    return 1 + opening / closing


def fitted(*paths: Any) -> CompressionLaw:
    """CompressionLaw fitted to paths as `unitcell3d.identify.calibrate` does: at equal shares of each displacement."""
    F, d = [], []
    for path in paths:
        shares = np.linspace(0, path.path[-1], 26)[1:]
        force, depth = (np.interp(shares, path.path, values) for values in (path.F_c, path.d_c))
        F.append(force[force > 0])
        d.append(depth[force > 0])
    return CompressionLaw.fit(np.concatenate(F), np.concatenate(d))


def cell_along(path: Any, fabric: str, law: CompressionLaw | None = None) -> Found:
    """The cell with its published law, or another, along a warp extension of the crossover: largest differences of the
    tensions over their peaks, and of the energy from the work of the ends, 2 T1 dd1, over that at the end."""
    given, d, T = catalogue.load(fabric), path.d1, path.T1
    cell = CellModel(given, None if law is None else (law, law)).solve(1 + d / given.weave.w1, 1.0)
    work = np.concatenate([[0], np.cumsum(np.diff(d) * (T[1:] + T[:-1]))])
    return {
        "warp": float(np.abs(cell["T1"] - T).max() / T.max()),
        "weft": float(np.abs(cell["T2"] - path.T2).max() / path.T2.max()),
        "energy": (np.abs(cell["W"] - work) / work.max()).max(),
    }


def warp_in_crossover(woven: Any, alone: Any, fabric: str) -> Found:
    """`against_lone_warp` of the 3D crossover."""
    weave = catalogue.load(fabric).weave
    strain = woven.d1 / weave.w1
    both = (strain > 0) & (strain <= alone.strain[-1])
    found = against_lone_warp(
        strain[both], woven.T1[both], woven.T2[both], np.interp(strain[both], alone.strain, alone.T), weave.warp.crimp
    )
    lead = found["least lead of the woven yarn"] / woven.T1.max()
    return found | {
        "least lead of the woven yarn over the peak": lead,
        "least growth of the weft": float(np.diff(woven.T2).min()),
    }


def cell_error(path: Any, fabric: str, profile: str) -> float:
    """RMS of both tensions of the cell with cosine or straight yarns less those of the 3D crossover, over the
    strengths, along a path of the crossover up to the cell's first failure."""
    given = catalogue.load(fabric)
    cell = CellModel(given, form="equilibrium", profile=profile)
    found = cell.solve(*(1 + d / w for d, w in zip((path.d1, path.d2), given.weave.w)))
    both = list(zip((found["T1"], found["T2"]), (path.T1, path.T2), given.weave.yarns))
    sound = np.all([T <= yarn.strength for T, _, yarn in both], axis=0)
    return float(np.sqrt(np.mean(np.square([(T - given) / yarn.strength for T, given, yarn in both])[:, sound])))


def off_cosine(line: Any) -> float:
    """RMS distance of a deformed centreline from the cosine of its height and length, over the height."""
    x, z = line
    h = z[0] - z[-1]
    return float(np.sqrt(np.mean((z - z[-1] - h * np.cos(0.5 * np.pi * x / x[-1])) ** 2)) / h)
