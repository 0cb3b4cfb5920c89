"""What the cases of the 3D crossover come to: {quantity [unit]: value} of each record (`weavecell
crossover`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.assumed import friction_between_yarns
from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric


def yarn(fabric: Fabric, record: Record) -> dict[str, Any]:
    """Evaluate one yarn pulled straight."""
    taut, yarn = (
        record["T_taut"] > 0.1 * record["T_taut"].max(),
        fabric.weave.yarns[record.facts["yarn"]],
    )
    numbers = {"greatest tension [N]": record["T"].max()}
    if np.count_nonzero(taut) > 1 and not record["broken"].any():
        slope, start = np.polyfit(record["strain"][taut], record["T"][taut], 1)
        numbers["stiffness when taut over E A / (1 + crimp) [-]"] = (
            slope * (1 + record.facts["crimp"]) / yarn.EA
        )
        numbers["strain at which it is straight [-]"] = -start / slope
        numbers["crimp [-]"] = record.facts["crimp"]
    # without failure the strength does not enter
    if record["broken"].any():
        numbers["greatest tension over the yarn's strength [-]"] = record["T"].max() / yarn.strength
        numbers["bars failed at the end [-]"] = record["broken"][-1]
    return numbers


def stack(fabric: Fabric, record: Record) -> dict[str, Any]:
    """Evaluate plies between platens."""
    from unitcell3d.cases.stack import law_closure

    numbers = {
        "pressure at the end [MPa]": record["pressure"][-1] / 1e6,
        "closure of a ply at the end [um]": 1e6 * record["closure_ply"][-1],
        "deepest penetration [um]": 1e6 * record["deepest"].max(),
    }
    # the pressure law of the thesis holds for these packs alone
    if fabric.areal_density_measured is not None and record.facts["plies"] in (1, 4, 8, 16):
        pressure, law, closure = law_closure(fabric, record)
        if pressure.size:
            numbers["closure since 28 kPa [um]"] = 1e6 * closure[-1]
            numbers["the same by the pressure law (eq. 2-6) [um]"] = 1e6 * law[-1]
    return numbers


def tensions(fabric: Fabric, record: Record) -> dict[str, Any]:
    """Evaluate biaxial stretch, or any path."""
    numbers = {f"{name} at the end [N]": record[name][-1] for name in ("T1", "T2", "F_c")}
    numbers |= {f"greatest {name} [N]": record[name].max() for name in ("T1", "T2")}
    if np.any(record["broken"]):
        numbers["bars failed at the end [-]"] = np.max(record["broken"][-1])
    # of the crossings of a cell; a single crossover has its law of several paths by `calibrate`
    if "d_c" in record.columns and "crossings" in record.facts:
        numbers |= _law_of_crossings(record)
    return numbers


def _law_of_crossings(record):
    """Return the law of compression of the crossings along one path, if it reaches contact."""
    try:
        law = CompressionLaw.fit(record["F_c"], record["d_c"])
    except InputError:
        return {}
    return {
        "law of the crossings on this path: a [mm]": 1e3 * law.a,
        "law of the crossings on this path: b [mm N^(1/3)]": 1e3 * law.b,
        "rms of this law [um]": 1e6 * (law.residual_rms or 0.0),
    }


def shear(fabric: Fabric, record: Record) -> dict[str, Any]:
    """Evaluate shear of the weave."""
    from fabrics.trellis import touching_angle
    from unitcell3d.identify import shear_fit

    turned = record["gamma"] > 0
    # a stretch before the shear leaves states at zero angle
    gamma = np.concatenate([[0.0], record["gamma"][turned]])
    tau = np.concatenate([[0.0], record["tau"][turned]])
    numbers = {
        "shear angle reached [rad]": gamma[-1],
        "shear stress there [MPa]": tau[-1] / 1e6,
        "tensions there [N]": [record["T1"][-1], record["T2"][-1]],
    }
    for family, name in enumerate(("warps", "wefts")):
        met = np.flatnonzero(record["F_side"][:, family] > 0)
        numbers[f"parallel {name} meet at [rad]"] = record["gamma"][met[0]] if met.size else None
        width, spacing = record.facts["width"][family], record.facts["spacing"][family]
        touching = touching_angle(width, spacing) if width < spacing else None
        numbers[f"by width and spacing of {name} (eq. 4-32) [rad]"] = touching
    try:
        fit = shear_fit.fit(gamma, tau)
    except InputError as problem:
        numbers["fit"] = str(problem)
        return numbers
    numbers |= {"fit of eq. 4-35: " + key: value for key, value in _law(fit.law).items()}
    numbers["rms of the fit [MPa]"] = fit.rms / 1e6
    numbers["gamma2 lies inside the curve"] = fit.locked
    if fabric.shear is not None:
        # the data's moduli are tangents: where the computed curve is as steep shows how both
        # compare
        slope = np.gradient(tau, gamma)
        for part, modulus in (("G1", fabric.shear.G1), ("G2", fabric.shear.G2)):
            stiffer = np.flatnonzero(slope >= modulus)
            numbers[f"tangent modulus passes the data's {part} at [rad]"] = (
                gamma[stiffer[0]] if stiffer.size else None
            )
        numbers |= {
            "fabric's data (Table 4-1): " + key: value for key, value in _law(fabric.shear).items()
        }
    return numbers


def pull_out(fabric: Fabric, record: Record) -> dict[str, Any]:
    """Evaluate one yarn pulled along its axis."""
    from unitcell3d.cases import pull_out as case

    F_c, T_f = case.thresholds(record)
    numbers = {
        "Coulomb's coefficient of the contact [-]": record.facts["friction"],
        "contact forces in slip [N]": F_c.tolist(),
        "slip thresholds [N]": T_f.tolist(),
        "largest force of the normal pressures along the axis [N]": np.abs(
            record["P_geometric"]
        ).max(),
        "largest share of Coulomb's limit [-]": record["mobilised"].max(),
    }
    # one threshold does not determine a line
    if F_c.size > 1:
        law = case.fit(record)
        usual = friction_between_yarns(fabric)
        numbers |= {
            "threshold without contact force, c0 [N]": law.c0,
            "effective coefficient, mu_eff [-]": law.mu_eff,
            "rms of the fit [N]": law.residual_rms,
            "range of the coefficient [-]": list(usual.number.span),
            "status of the range": usual.status,
        }
    return numbers


def _law(law):
    return {
        "gamma1 [rad]": law.gamma1,
        "gamma2 [rad]": law.gamma2,
        "G1 [MPa]": law.G1 / 1e6,
        "G2 [MPa]": law.G2 / 1e6,
    }
