"""Cases of the 3D crossover from the command line.

Folder of `weavecell crossover`
    case.h5     every converged state: columns with their meanings (`unitcell3d.solver.record`)
    case.json   settings, results, provenance
    pictures/   curve.svg, deformed.png

A yarn pulled out adds its slip threshold to the law.json of a calibration, where one is named.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError
from fabrics.files import write_whole
from fabrics.friction.pull_out import FRICTION
from fabrics.units import si
from weavecell.commands import mesh, mesh_options
from weavecell.commands.mesh_options import pair
from weavecell.report import checks, pictures, pictures_crossover
from weavecell.results import json_file, progress, provenance

DOMAINS = {
    "yarn": ("quarter", "whole"),
    "platens": ("quarter",),
    "stack": ("quarter", "periodic"),
    "biaxial": ("whole", "periodic"),
    "path": ("quarter", "whole"),
    "shear": ("whole", "periodic"),
    "pull-out": ("whole",),
}


def command(
    name: str, case: str, out: Path, *, domain: str | None, size: str, section: str | None, gap: str | None,
    strict: bool = False, **choices: Any,
) -> None:  # fmt: skip
    """Run a case of a fabric, write it and print what it found; options are texts of the command line.

    strict : whether a doubtful result is an error
    """
    fabric = mesh.with_3d_data(name)
    if choices["law"] is not None:
        CompressionLaw.from_json(choices["law"])  # refused before anything is computed
    run = CASES[case](fabric, choices)
    shifted = case == "stack" and any(pair(choices["shift"], "", "--shift", "along x and y"))
    allowed = ("periodic",) if shifted else ("quarter",) if case == "stack" else DOMAINS[case]
    domain = allowed[0] if domain is None else domain
    if domain not in allowed:
        raise InputError(key="--domain", value=domain, allowed=f"{' or '.join(allowed)} for this case")
    built = mesh.build(fabric, domain=domain, **mesh_options.parse(size=size, section=section, gap=gap))
    with progress.bar(f"{fabric.name}, {case}") as advance:
        record = run(built, hooks=[lambda share, row: advance(share)])
    found = SUMMARIES[case](fabric, record)
    indicators = _indicators(fabric, record)
    record.write(out / "case.h5")
    content = {
        "fabric": fabric.name, "case": record.case, "domain": domain, "size": size, "rows": len(record["path"]),
        "failed": record.failed, "facts": record.facts, "found": found, **checks.summary(indicators),
        "provenance": provenance.stamp("", fabric),
    }  # fmt: skip
    json_file.write(out / "case.json", content)
    with write_whole(out / "pictures" / "curve.svg", "wb") as file:
        file.write(pictures.render(pictures_crossover.CURVES[case], fabric, record, found))
    pictures_crossover.deformed(built, record, out / "pictures" / "deformed.png")
    if choices["law"] is not None and not record.failed:
        _threshold(record, size).add_to(choices["law"])
    for key, value in found.items():
        print(f"{key:<44}{_as_text(value)}")
    print(f"written to {out}")
    if record.failed:
        raise UnstableError(record.failed)
    checks.report(indicators, strict)


def _indicators(fabric, record):
    """Quality indicators of a case: of a yarn alone, nodes that alternate along it."""
    from shellfabric.panel import quality

    if "astray" not in record.columns:
        return ()
    weave = fabric.weave
    return quality.of_yarn(record["astray"], 2 * (weave.h01, weave.h02)[record.facts["yarn"]])


def _yarn(fabric, choices):
    from unitcell3d.cases import single_yarn as cases_single_yarn
    from unitcell3d.material import solid_law

    integration = solid_law.ONE_POINT if choices["one_point"] else solid_law.FULL
    keys = {key: choices[key] for key in ("bars", "failure")}
    return lambda built, hooks: cases_single_yarn.pull(
        built, fabric, choices["family"], integration=integration, hooks=hooks, **keys
    )


def _platens(fabric, choices):
    return _stack(fabric, choices | {"plies": 1, "shift": "0,0"})


def _stack(fabric, choices):
    from unitcell3d.cases import stack

    pressure = choices["pressure"]
    pressure = stack.PLATEN_PRESSURE if pressure is None else si(pressure, "Pa", key="--pressure")
    shift = pair(choices["shift"], "", "--shift", "along x and y")
    if choices["plies"] < 1:
        raise InputError(key="--plies", value=choices["plies"], allowed="a whole number from 1 on")
    return lambda built, hooks: stack.stack_compression(
        built, fabric, choices["plies"], shift=shift, pressure=pressure, numerics=_numerics(choices), hooks=hooks
    )


def _biaxial(fabric, choices):
    from unitcell3d.cases import periodic_cell

    d = pair(choices["stretch"], "m", "--end-displacement")
    if not any(d):
        raise InputError(key="--end-displacement", value=choices["stretch"], allowed="a length that is not 0")
    return lambda built, hooks: periodic_cell.biaxial(
        built, fabric, d, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _path(fabric, choices):
    from unitcell3d.cases import load_path

    if choices["path"] is None:
        raise InputError(key="--path", allowed="given: a CSV file of corners d1, d2")
    corners = load_path.read(choices["path"])
    return lambda built, hooks: load_path.along(
        built, fabric, corners, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _shear(fabric, choices):
    from unitcell3d.cases import periodic_cell

    gamma, stretch = (
        si(choices["gamma"], "rad", key="--shear-angle"),
        pair(choices["stretch"], "m", "--end-displacement"),
    )
    if not 0 < gamma <= periodic_cell.STEEPEST:
        raise InputError(
            key="--shear-angle", value=choices["gamma"], allowed=f"above 0 and at most {periodic_cell.STEEPEST} rad"
        )
    return lambda built, hooks: periodic_cell.shear(
        built, fabric, gamma, stretch=stretch, failure=choices["failure"], numerics=_numerics(choices), hooks=hooks
    )


def _pull_out(fabric, choices):
    from unitcell3d.cases import pull_out

    pulled = choices["family"]
    given = [text for text in choices["stretch"].split(",") if text.strip() not in ("", "0 mm")]
    lengths = [si(text, "m", key="--end-displacement") for text in given]
    pressures = [si(text, "Pa", key="--pressure") for text in (choices["pressure"] or "").split(",") if text.strip()]
    if pressures and lengths:
        raise InputError(key="--pressure", value=choices["pressure"], allowed="left out with --end-displacement")
    if pressures and not min(pressures) > 0:
        raise InputError(key="--pressure", value=choices["pressure"], allowed="pressures above 0")
    lengths = lengths or ([] if pressures else list(pull_out.displacements(fabric, pulled)))
    pull = None if choices["pull"] is None else si(choices["pull"], "m", key="--pull")
    friction = FRICTION if choices["friction"] is None else choices["friction"]
    numerics = _numerics(choices | {"friction": friction})
    return lambda built, hooks: pull_out.pull_out(
        built, fabric, lengths, pressures=pressures, pulled=pulled, pull=pull, numerics=numerics, hooks=hooks
    )


def _threshold(record, size=""):
    from unitcell3d.cases import pull_out

    return pull_out.fit(record, size)


def _numerics(choices):
    from unitcell3d.model.crossover import Numerics

    return Numerics(friction=choices["friction"] or 0.0)


CASES = {
    "yarn": _yarn,
    "platens": _platens,
    "stack": _stack,
    "biaxial": _biaxial,
    "path": _path,
    "shear": _shear,
    "pull-out": _pull_out,
}


def _yarn_summary(fabric, record):
    taut = record["T_taut"] > 0.1 * record["T_taut"].max()
    found = {"greatest tension [N]": record["T"].max()}
    if np.count_nonzero(taut) > 1 and not record["broken"].any():
        slope, start = np.polyfit(record["strain"][taut], record["T"][taut], 1)
        EA = fabric.weave.yarns[record.facts["yarn"]].EA
        found["stiffness when taut over E A / (1 + crimp) [-]"] = slope * (1 + record.facts["crimp"]) / EA
        found["strain at which it is straight [-]"] = -start / slope
        found["crimp [-]"] = record.facts["crimp"]
    if record["broken"].any():
        found["greatest tension over the yarn's strength [-]"] = (
            record["T"].max() / fabric.weave.yarns[record.facts["yarn"]].strength
        )
        found["bars failed at the end [-]"] = record["broken"][-1]
    return found


def _stack_summary(fabric, record):
    from unitcell3d.cases.stack import law_closure

    found = {
        "pressure at the end [MPa]": record["pressure"][-1] / 1e6,
        "closure of a ply at the end [um]": 1e6 * record["closure_ply"][-1],
        "deepest penetration [um]": 1e6 * record["deepest"].max(),
    }
    if fabric.areal_density_measured is not None and record.facts["plies"] in (1, 4, 8, 16):
        pressure, law, closure = law_closure(fabric, record)
        if pressure.size:
            found["closure since 28 kPa [um]"] = 1e6 * closure[-1]
            found["the same by the pressure law (eq. 2-6) [um]"] = 1e6 * law[-1]
    return found


def _tension_summary(fabric, record):
    found = {f"{name} at the end [N]": record[name][-1] for name in ("T1", "T2", "F_c")}
    found |= {f"greatest {name} [N]": record[name].max() for name in ("T1", "T2")}
    if np.any(record["broken"]):
        found["bars failed at the end [-]"] = np.max(record["broken"][-1])
    return found


def _shear_summary(fabric, record):
    from fabrics.trellis import touching_angle
    from unitcell3d.identify import shear_fit

    turned = record["gamma"] > 0
    gamma = np.concatenate([[0.0], record["gamma"][turned]])
    tau = np.concatenate([[0.0], record["tau"][turned]])
    found = {
        "shear angle reached [rad]": gamma[-1],
        "shear stress there [MPa]": tau[-1] / 1e6,
        "tensions there [N]": [record["T1"][-1], record["T2"][-1]],
    }
    for family, name in enumerate(("warps", "wefts")):
        met = np.flatnonzero(record["F_side"][:, family] > 0)
        found[f"parallel {name} meet at [rad]"] = record["gamma"][met[0]] if met.size else None
        width, spacing = record.facts["width"][family], record.facts["spacing"][family]
        found[f"by width and spacing of {name} (eq. 4-32) [rad]"] = (
            touching_angle(width, spacing) if width < spacing else None
        )
    try:
        fit = shear_fit.fit(gamma, tau)
    except InputError as problem:
        found["fit"] = str(problem)
        return found
    found |= {"fit of eq. 4-35: " + key: value for key, value in _law(fit.law).items()}
    found["rms of the fit [MPa]"] = fit.rms / 1e6
    found["gamma2 lies inside the curve"] = fit.locked
    if fabric.shear is not None:
        slope = np.gradient(tau, gamma)
        for part, modulus in (("G1", fabric.shear.G1), ("G2", fabric.shear.G2)):
            stiffer = np.flatnonzero(slope >= modulus)
            found[f"tangent modulus passes the data's {part} at [rad]"] = gamma[stiffer[0]] if stiffer.size else None
        found |= {"fabric's data (Table 4-1): " + key: value for key, value in _law(fabric.shear).items()}
    return found


def _pull_out_summary(fabric, record):
    from unitcell3d.cases import pull_out

    F_c, T_f = pull_out.thresholds(record)
    found = {
        "Coulomb's coefficient of the contact [-]": record.facts["friction"],
        "contact forces in slip [N]": F_c.tolist(),
        "slip thresholds [N]": T_f.tolist(),
        "largest force of the normal pressures along the axis [N]": np.abs(record["P_geometric"]).max(),
        "largest share of Coulomb's limit [-]": record["mobilised"].max(),
    }
    if F_c.size > 1:
        law = _threshold(record)
        found |= {
            "threshold without contact force, c0 [N]": law.c0,
            "effective coefficient, mu_eff [-]": law.mu_eff,
            "rms of the fit [N]": law.residual_rms,
            "range of the coefficient [-]": list(law.friction_range),
            "status of the range": law.status,
        }
    return found


def _law(law):
    return {
        "gamma1 [rad]": law.gamma1, "gamma2 [rad]": law.gamma2, "G1 [MPa]": law.G1 / 1e6, "G2 [MPa]": law.G2 / 1e6
    }  # fmt: skip


SUMMARIES = {
    "yarn": _yarn_summary,
    "platens": _stack_summary,
    "stack": _stack_summary,
    "biaxial": _tension_summary,
    "path": _tension_summary,
    "shear": _shear_summary,
    "pull-out": _pull_out_summary,
}


def _as_text(value):
    if isinstance(value, list | tuple):
        return ", ".join(_as_text(part) for part in value)
    if value is None:
        return "-"
    return f"{value:.5g}" if isinstance(value, float | np.floating) else str(value)
