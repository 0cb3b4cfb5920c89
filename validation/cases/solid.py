"""The 3D crossover: its meshes, contact and load steps, platens, pull-out, calibration. Needs dolfinx."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, Literal

import numpy as np

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from fabrics.friction.pull_out import PullOutLaw
from fabrics.plate_curve import PlateCurve
from fabrics.variants import with_solids
from meshing import crossover
from shellfabric.membrane import quality
from unitcell3d.cases import pull_out as pulling
from unitcell3d.cases import single_yarn
from unitcell3d.cases.biaxial_and_platens import plate_compression, row
from unitcell3d.identify.platen_misfit import closures, platen_misfit
from unitcell3d.material import solid_law
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.load_stepping import Steps
from unitcell3d.solver.path_following import follow
from validation.models.crossover_law import fitted
from validation.models.second_order import SecondOrderCrossover
from validation.models.variants import scale_solids
from validation.values import Values, flags, largest

FABRIC = "S-720"  # whose solid the thesis calibrated (Tables 3-1, 3-2)
FORCES = ("T1", "T2", "F_c")
INTEGRATION = {False: solid_law.FULL, True: solid_law.ONE_POINT}  # by whether it is reduced
PACKING = 1e6  # [Pa] below which platens close four fifths
POINTS = 24  # of the platen curve


def _numerics(factors: Mapping[str, float], **fields: Any) -> Numerics:
    """The default Numerics with factors on some fields, and others given."""
    plain = Numerics()
    return replace(
        plain, **{name: factor * getattr(plain, name) for name, factor in factors.items()}, **fields
    )


def paths(
    *,
    ends: Mapping[str, Sequence[float]],
    fabric: str = FABRIC,
    size: Sequence[int] = (8, 6, 2),
    order: int = 1,
    domain: str = "quarter",
    section: str | None = None,
    tip: float | None = None,
    equal_bars: bool = False,
    one_point: bool = False,
    factors: Mapping[str, float] | None = None,
    friction: float = 0.0,
    steps: Mapping[str, float] | None = None,
    solids: Mapping[str, float] | None = None,
) -> Values:
    """Pull a crossover, meshed, formulated and stepped in one way, along paths.

    Parameters
    ----------
    ends : {path: (d1, d2)} [m] end displacements at which they stop
    fabric : name
    order : of the hexahedra, 1 or 2: then each is eight of the mesh (`models.second_order`)
    size, domain, section, tip : of `meshing.crossover.build`; tip is its tip_thickness_ratio
    equal_bars : whether all fibre bars have one area, and not what is nearest to each
    one_point : one-point integration of the solids
    factors, friction : on fields of the default Numerics; Coulomb's coefficient
    steps : fields of load_stepping.Steps
    solids : {field of SolidLaw: factor}, on both yarns

    Returns
    -------
    dict with "T1, PATH", "T2, PATH", "F_c, PATH" [N] at the ends; a [m], b [m N^(1/3)] of the law fitted to them, None
    where none can be; unknowns; cpu [s]

    Raises
    ------
    UnstableError : a path that does not reach its end
    """
    began = time.process_time()
    given = scale_solids(catalogue.load(fabric), dict(solids or {}))
    options: Values = {}
    if tip is not None:
        options["tip_thickness_ratio"] = tip
    mesh = crossover.build(given, domain=domain, size=tuple(size), section=section, **options)
    if equal_bars:
        mesh = replace(
            mesh, bar_area=tuple(np.full_like(area, area.mean()) for area in mesh.bar_area)
        )
    numerics = _numerics(factors or {}, friction=friction)
    fields: Any = steps or {}
    stepping = replace(Steps(), **fields)
    histories = []
    unknowns = 0
    values: dict[str, float] = {}
    for name, end in ends.items():
        kind = SecondOrderCrossover if order == 2 else CrossoverModel
        model = kind(mesh, given, numerics, integration=INTEGRATION[one_point])
        load: Any = tuple(end)
        history = follow(model, [Load(), Load(load)], row(model), steps=stepping)
        if history.failed:
            raise UnstableError(f"{name}: {history.failed}")
        histories.append(history)
        values |= {f"{force}, {name}": float(history[force][-1]) for force in FORCES}
        unknowns = model.size
    try:
        law = fitted(*histories)
    except InputError:
        law = None
    cpu = time.process_time() - began
    return {
        "values": values,
        "a": law and law.a,
        "b": law and law.b,
        "unknowns": unknowns,
        "cpu": cpu,
    }


@cache
def _yarn() -> crossover.Crossover:
    return crossover.build(catalogue.load(FABRIC), size=(8, 10, 3))


def bars(*, bars: int, reduced: bool) -> Values:
    """Pull the warp alone, 8 x 10 x 3 hexahedra in half its width and length, straight and on to
    its failure strain.

    Parameters
    ----------
    bars : of the fibre lines, that carry bars
    reduced : one-point integration, which leaves modes without energy, or full

    Returns
    -------
    dict with astray [-], the largest amplitude from node to node along the yarn over its thickness; flags

    Raises
    ------
    UnstableError : the path ends early
    """
    chosen = None
    if bars < len(_yarn().bar_area[0]):
        chosen = bars
    record = single_yarn.pull(
        _yarn(),
        catalogue.load(FABRIC),
        0,
        bars=chosen,
        rows=12,
        integration=INTEGRATION[reduced],
    )
    if record.failed:
        raise UnstableError(record.failed)
    thickness = 2 * catalogue.load(FABRIC).weave.h01
    checks = quality.of_yarn(record["astray"], thickness)
    return {"astray": float(max(record["astray"])) / thickness, "flags": flags(checks)}


def pressed(mesh: crossover.Crossover, fabric: Fabric, numerics: Numerics | None = None) -> Record:
    """Press a crossover between platens to a fifth of their first distance, in steps that resolve
    the lowest pressures."""
    steps = Steps(first=0.004, largest=0.02)
    return plate_compression(mesh, fabric, min_plate_gap=0.2, numerics=numerics, steps=steps)


def platens(
    *,
    mesh: Values | None = None,
    solids: Values | None = None,
    lowest: float = 0.0,
    numerics: Mapping[str, Any] | None = None,
) -> Values:
    """Compare S-720 between platens, by its published solid constants, with its platen law (thesis
    section 3.4.3.2).

    Parameters
    ----------
    mesh : options of `meshing.crossover.build`
    solids : {field of SolidLaw: value, or (warp, weft)}
    lowest : [Pa] from which on the pressures are compared
    numerics : fields of Numerics

    Returns
    -------
    dict with closure [m], pressure [-], the rms misfits, offset free; loose, packed [m], closures below and above
    PACKING, and law_loose, law_packed of the law; Vf0 (warp, weft); ended, why the path ended early, or ""
    """
    file = catalogue.load(FABRIC)
    fabric = with_solids(
        file, **{name: tuple(np.broadcast_to(value, 2)) for name, value in (solids or {}).items()}
    )
    built = crossover.build(fabric, **{"size": (6, 4, 2)} | dict(mesh or {}))
    history = pressed(built, fabric, replace(Numerics(), **dict(numerics or {})))
    assert file.areal_density_measured is not None
    target = PlateCurve.pressure_law(file.areal_density_measured)
    area = file.weave.cell_area
    pressure = np.geomspace(max(lowest, target.pressure[0]), target.pressure[-1], POINTS)
    law = target.at(pressure)
    computed = closures(history, area, pressure, law)
    misfit = platen_misfit(history, area, target, pressure)
    at, of_law = (
        float(np.interp(np.log(PACKING), np.log(pressure), curve)) for curve in (computed, law)
    )
    return {
        "closure": misfit.closure,
        "pressure": misfit.pressure,
        "loose": at - computed[0],
        "packed": computed[-1] - at,
        "law_loose": of_law,
        "law_packed": float(law[-1]) - of_law,
        "Vf0": tuple(map(float, built.Vf0)),
        "ended": history.failed,
    }


def pull_out(
    *,
    pulled: str = "warp",
    friction: float,
    size: Sequence[int] = (8, 6, 2),
    loads: Sequence[float] = (1.0,),
    rows: int = pulling.ROWS,
    slip: float = Numerics.slip,
    pressures: Sequence[float] = (),
) -> Values:
    """Pull a yarn of S-720 through a whole crossover under transverse loads.

    Parameters
    ----------
    pulled : "warp" or "weft"
    friction, slip : Coulomb's coefficient, and [m] over which it sets in
    size : hexahedra along, across and through a quarter of each yarn
    loads : of the largest end displacement of the crossing yarn
    rows : states along the pull
    pressures : [Pa] of platens, in place of the end displacements

    Returns
    -------
    dict with F_c, T_f [N] of each load, largest [N], the sum of normal pressures along the axis, mobilised [-], the
    share of Coulomb's limit; P [N], the largest axial force; c0 [N], mu_eff [-] of the law through them, nan of a
    single one; tangents for each state; seconds
    """
    fabric = catalogue.load(FABRIC)
    family = ("warp", "weft").index(pulled)
    longest = pulling.displacements(fabric, family)[-1] / pulling.LOADS[-1]
    record = pulling.pull_out(
        crossover.build(fabric, domain="whole", size=tuple(size)),
        fabric,
        [] if pressures else [share * longest for share in loads],
        pressures=tuple(pressures),
        pulled=family,
        numerics=Numerics(friction=friction, slip=slip),
        rows=rows,
    )
    if record.failed:
        raise UnstableError(record.failed)
    F_c, T_f = pulling.thresholds(record)
    law = None
    if len(F_c) > 1:
        law = PullOutLaw.fit(F_c, T_f)
    each = [record["load"] == number for number in np.unique(record["load"])]
    c0 = mu_eff = np.nan
    if law is not None:
        c0 = law.c0
        mu_eff = law.mu_eff
    return {
        "F_c": F_c,
        "T_f": T_f,
        "P": largest(record["P"]),
        "largest": [largest(record["P_geometric"][of]) for of in each],
        "mobilised": [float(record["mobilised"][of].max()) for of in each],
        "c0": c0,
        "mu_eff": mu_eff,
        "tangents": float(record["iterations"].sum() / len(record["path"])),
        "seconds": float(record["seconds"].sum()),
    }


def calibrated(
    *,
    fabric: str,
    mesh: str,
    fit_solid: bool = False,
    friction: float = 0.0,
    fibre_fraction: Literal["mesh", "stated"] | None = None,
) -> Values:
    """Compute the compression law of a fabric from its 3D crossover (`weavecell.calibrate`), beside
    the published one.

    Returns
    -------
    dict with a [m], b [m N^(1/3)], a_interval, b_interval; a_ratio, b_ratio [-] over the published values, nan without;
    rms, rms_ratio [m] of the fit and of that of the tension ratio; a_warp, b_warp, a_weft, b_weft of the yarns' own
    laws; of a fitted solid misfit_before, misfit (closure [m], pressure [-]) and constants {name: (value, low, high)};
    cpu [s]
    """
    began = time.process_time()
    found = wc.calibrate(
        fabric,
        mesh=mesh,
        fit_solid=fit_solid,
        friction=friction,
        fibre_fraction=fibre_fraction,
        assumed_range=False,
    )
    cpu = time.process_time() - began
    assert isinstance(found, wc.CalibrationResult)
    done = found.calibration
    law = found.law
    nan = float("nan")
    own = {
        f"{key}_{name}": nan if one is None else getattr(one, key)
        for name, one in zip(("warp", "weft"), done.yarn_laws)
        for key in "ab"
    }
    summary: Values = own | {
        "a": law.a,
        "b": law.b,
        "a_interval": law.a_interval,
        "b_interval": law.b_interval,
        "a_ratio": done.comparison.get("a_ratio", nan),
        "b_ratio": done.comparison.get("b_ratio", nan),
        "rms": law.residual_rms,
        "cpu": cpu,
        "rms_ratio": nan if done.ratio_law is None else done.ratio_law.residual_rms,
    }
    if found.solid is not None:
        summary["constants"] = {
            name: (value, *found.solid.intervals[name])
            for name, value in found.solid.values.items()
        }
        for name in ("misfit_before", "misfit"):
            misfit = getattr(found.solid.platens, name)
            summary[name] = misfit.closure, misfit.pressure
    return summary
