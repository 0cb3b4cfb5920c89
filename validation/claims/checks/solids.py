"""The solids of the 3D crossover and what it makes of compression (thesis chapter 3, section 4.3.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.integrate import trapezoid

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.plate_curve import PlateCurve
from validation.claims.registry import Found, Run, RunResult, check


@check(lambda fabric, stretch: {"brick": Run.of("brick", fabric=fabric, stretch=stretch)})
def fibre_fraction(brick: RunResult, fabric: str, stretch: Sequence[float]) -> Found:
    """Fibre fraction that the axial stress of one brick has (eq. 3-2), against Vf0 exp(e1) / J (eqs. 3-6 to 3-9)."""
    found = brick["stress"] / (brick["strain"] * brick["E_a"])
    expected = catalogue.load(fabric).solid_laws[0].Vf0 * np.exp(brick["strain"]) / np.prod(stretch)
    return {"relative difference": abs(found / expected - 1), "fraction": found}


@check()
def solid_modulus(fabric: str) -> Found:
    warp, weft = catalogue.load(fabric).solid_laws
    return {
        "at Vf0": warp.transverse_modulus(warp.Vf0),
        "at V_c": warp.transverse_modulus(warp.V_c),
        "b_E warp": warp.b_E,
        "a_E warp": warp.a_E,
        "b_E weft": weft.b_E,
        "a_E weft": weft.a_E,
    }


@check()
def solid_shape(fabric: str) -> Found:
    law = catalogue.load(fabric).solid_laws[0]
    V = np.linspace(0.5 * law.Vf0, 1.5 * law.V_c, 3001)
    E = law.transverse_modulus(V)
    loose, packed = V < law.Vf0, V > law.V_c
    return {
        "flat below": bool(np.ptp(E[loose]) == 0),
        "rises between": bool(np.all(np.diff(E[~loose & ~packed]) > 0)),
        "flat above": bool(np.ptp(E[packed]) == 0),
    }


@check()
def solid_shear(fabric: str) -> Found:
    return {"G": catalogue.load(fabric).solid_laws[0].G}


PATHS = {"warp only": (1.0, 0.0), "weft only": (0.0, 1.0), "equibiaxial": (1.0, 1.0)}


def paths(fabric: str) -> dict[str, Run]:
    """Runs of the three calibration paths."""
    return {name.split()[0]: Run.of("stretched", fabric=fabric, ratio=ratio) for name, ratio in PATHS.items()}


def fitted(*histories: RunResult) -> CompressionLaw:
    """CompressionLaw fitted to paths as `unitcell3d.identify.calibrate` does: at equal shares of each displacement."""
    F, d = [], []
    for path in histories:
        shares = np.linspace(0, path["path"][-1], 26)[1:]
        force, depth = (np.interp(shares, path["path"], path[name]) for name in ("F_c", "d_c"))
        F.append(force[force > 0])
        d.append(depth[force > 0])
    return CompressionLaw.fit(np.concatenate(F), np.concatenate(d))


@check(paths)
def calibrated(warp: RunResult, weft: RunResult, equibiaxial: RunResult, fabric: str) -> Found:
    law = fitted(warp, weft, equibiaxial)
    given = catalogue.load(fabric).laws[0]
    return {
        "a": law.a,
        "b": law.b,
        "note": f"{law.a / given.a:.2f} and {law.b / given.b:.2f} of the printed; "
        f"rms of the fit {1e6 * law.residual_rms:.2f} um",
    }


@check(lambda fabric, **_: {"pressed": Run.of("plates", fabric=fabric)})
def platen_curve(pressed: RunResult, fabric: str, least_pressure: float) -> Found:
    """Closure of the 3D crossover from a pressure on, against the law's, as share of the law's at the end."""
    given = catalogue.load(fabric)
    pressure = pressed["F_plate"].mean(axis=1) / given.weave.cell_area
    closure = 2 * (pressed["plates"][0] - pressed["plates"])
    law = PlateCurve.pressure_law(given.areal_density_measured)
    reached = min(pressure.max(), law.pressure[-1])
    P = np.geomspace(least_pressure, reached, 60)
    ours, theirs = np.interp(P, pressure, closure), np.interp(P, law.pressure, law.closure)
    ours, theirs = ours - ours[0], theirs - theirs[0]
    off = np.abs(ours[1:] - theirs[1:]) / theirs[1:]
    return {
        "largest difference": off.max(),
        "note": f"from {1e-6 * least_pressure:g} to {1e-6 * reached:.1f} MPa the "
        f"crossover closes by {1e6 * ours[-1]:.0f} um, the law by {1e6 * theirs[-1]:.0f} um",
    }


@check(
    lambda fabric: {
        "pressed": Run.of("plates", fabric=fabric),
        "pulled": Run.of("stretched", fabric=fabric, ratio=(1.0, 1.0)),
    }
)
def platen_and_biaxial(pressed: RunResult, pulled: RunResult, fabric: str) -> Found:
    top = min(pressed["F_plate"].mean(axis=1).max(), pulled["F_c"].max())
    F = np.linspace(0.2 * top, 0.9 * top, 20)
    plates = np.interp(F, pressed["F_plate"].mean(axis=1), pressed["plates"][0] - pressed["plates"])
    biaxial = np.interp(F, pulled["F_c"], pulled["d_c"])
    off = np.abs(plates / biaxial - 1)
    return {
        "least difference": off.min(),
        "note": f"at {F[-1]:.0f} N plates have closed {1e6 * plates[-1]:.0f} um a yarn, "
        f"equibiaxial extension {1e6 * biaxial[-1]:.0f} um",
    }


@check(
    lambda friction, **given: {
        name: Run.of("released", friction=value, **given) for name, value in (("rough", friction), ("smooth", 0.0))
    }
)
def loading_and_unloading(
    rough: RunResult, smooth: RunResult, fabric: str, plies: int, friction: float, closed: float
) -> Found:
    """Work that a pack does not give back when its plates open again, over the work of closing them."""
    lost = {}
    for name, run in (("rough", rough), ("smooth", smooth)):
        work = [float(trapezoid(pressure, closure)) for closure, pressure in (run["loading"], run["unloading"])]
        lost[name] = 1 + work[1] / work[0]
    return {
        "lost with friction": lost["rough"],
        "lost without friction": abs(lost["smooth"]),
        "note": f"closed to {1e-6 * rough['loading'][1].max():.2f} MPa; {rough['failed'] or smooth['failed']}",
    }
