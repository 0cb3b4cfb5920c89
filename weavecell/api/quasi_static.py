"""Coupons in the Python interface, and the calibration of the 3D crossover."""

from __future__ import annotations

import time
from concurrent.futures import Executor
from dataclasses import replace
from inspect import signature
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal

from fabrics import assumed
from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.executors import InProcess
from fabrics.fabric import Fabric
from weavecell.api import quantities
from weavecell.api.quasi_static_results import CalibrationResult, CouponResult, PullOutResult
from weavecell.api.runs import as_fabric

if TYPE_CHECKING:
    from weavecell.api.keywords import Law

__all__ = ["calibrate", "coupon"]

MeshSize = Literal["coarse", "medium", "fine"]
CellName = Literal["compressible", "incompressible", "decoupled"]
Test = Literal["bias_extension", "picture_frame", "uniaxial", "biaxial", "pull_out"]

TABLE_SIZE = 201  # stretches along each side of the cell's table, as in impacts


def coupon(
    fabric: Fabric | FilePath, test: Test, *, law: Law = None, cell_model: CellName = "compressible", **options: Any
) -> CouponResult | PullOutResult:
    """A test on a piece of fabric, in this process: quasi-static, or a yarn pull-out.

    Parameters
    ----------
    fabric, law : as of `setup`
    test : "bias_extension", "picture_frame", "uniaxial", "biaxial" or "pull_out"
    cell_model : "compressible", "incompressible" or "decoupled"
    **options : of the function of this name in `shellfabric.coupon.quasistatic`, in SI units or with units; such as
        length, width, elongation [m], shear_angle [rad], strain, steps, crossovers (of a picture frame). Of a pull-out
        the keys of its table in a scene file: displacement [m], crossings, velocity [m/s], pre_tension [N],
        crossover_friction [-], crossover_cohesion [N], all_yarns, samples; and bending [N m2] of the yarns

    Returns
    -------
    CouponResult; of a pull-out PullOutResult

    Raises
    ------
    InputError : an unknown test or option, a value that is not allowed, or a law that is missing
    UnstableError : shear in bands, yarns that passed one another, or no equilibrium; its attribute `result` is the run

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> frame.outcome, f"{frame.summary()['shear_stress_Pa'] / 1e6:.2f} MPa"
    ('complete', '0.84 MPa')
    """
    from shellfabric.cell.model import CellModel
    from shellfabric.coupon import quasistatic
    from weavecell.results.coupon import CouponRecord
    from weavecell.results.coupon_measures import PRESCRIBED, indicators, measures
    from weavecell.scenes.coupon import TESTS, TOLERANCE

    if test not in TESTS:
        raise InputError(key="test", value=test, allowed=f"one of {', '.join(TESTS)}")
    cloth = as_fabric(fabric)
    if test == "pull_out":
        pulled = _pull_out(cloth, law, cell_model, options)
        pulled.warn()
        return pulled
    cloth = assumed.with_shear(cloth) if test in ("bias_extension", "picture_frame") else cloth
    run, began = getattr(quasistatic, test), time.perf_counter()
    defaults = _checked(run, options, test)
    laws = quantities.laws(cloth, law) if cell_model == "compressible" else None
    table = CellModel(cloth, laws, model=cell_model).table(TABLE_SIZE)
    options.setdefault("tolerance", TOLERANCE)
    result = run(table, **options)
    title = f"{cloth.name}, {test.replace('_', ' ')}"
    record = CouponRecord.of(
        result, measures(test, SimpleNamespace(**defaults | options), result), PRESCRIBED[test], title=title,
        fabric=cloth.name, test=test, failure_message="", wall_time=time.perf_counter() - began,
        law_name=cell_model if laws is None else laws[0].provenance,
        checks=indicators(result, table, options["tolerance"]),
    )  # fmt: skip
    done = CouponResult(record, tuple(assumed.lines(cloth)))
    done.warn()
    return done


def _checked(run, options, test):
    """{option: its default} of a test; `options` become SI numbers of known names. InputError: an unknown one."""
    if "crossovers" in options:
        options["cells"] = options.pop("crossovers")
    defaults = {name: one.default for name, one in signature(run).parameters.items() if one.default is not one.empty}
    allowed = {*defaults, "tolerance", "max_iterations"}
    for key in sorted(set(options) - allowed):
        raise InputError(key=key, value=options[key], allowed=f"one of {', '.join(sorted(allowed))}")
    _to_si(options, test)
    return defaults


def _to_si(options, test):
    """Numbers in SI units in place of the quantities among the `options` of a test."""
    from weavecell.scenes.coupon import CouponScene
    from weavecell.scenes.schema import unit_of
    from weavecell.scenes.supported import tables

    for key, entry in tables(CouponScene)[test].model_fields.items():
        if key in options and unit_of(entry) is not None:
            options[key] = _si(options[key], unit_of(entry), key)


def _si(value, unit, key):
    """A value or a list of them in SI units; what has no unit may be a text such as "1 %"."""
    if isinstance(value, (list, tuple)):
        return [_si(each, unit, key) for each in value]
    if unit == "1":
        return quantities.number(value, "", key) if isinstance(value, str) else value
    return quantities.number(value, unit, key)


def _pull_out(cloth, law, cell_model, options):
    """The PullOutResult of a Fabric."""
    from shellfabric.cell.model import CellModel
    from weavecell.results import pull_out
    from weavecell.scenes.coupon import PullOutTable

    began, entries = time.perf_counter(), PullOutTable.model_fields
    bending = quantities.number(options.pop("bending", 0.0), "N m^2", "bending")
    for key in sorted(set(options) - set(entries)):
        raise InputError(key=key, value=options[key], allowed=f"one of {', '.join(entries)} and bending")
    if "displacement" not in options:
        raise InputError("is missing", key="displacement", allowed=entries["displacement"].description)
    _to_si(options, "pull_out")
    inputs = SimpleNamespace(**{key: entry.default for key, entry in entries.items()} | options)
    laws = quantities.laws(cloth, law) if cell_model == "compressible" else None
    curve = pull_out.run(CellModel(cloth, laws, model=cell_model).table(TABLE_SIZE), inputs, bending=bending)
    record = pull_out.PullOutRecord.of(
        curve, title=f"{cloth.name}, pull-out", law_name=cell_model if laws is None else laws[0].provenance,
        failure_message="", wall_time=time.perf_counter() - began,
    )  # fmt: skip
    return PullOutResult(record)


def calibrate(
    fabric: Fabric | FilePath, *, mesh: MeshSize = "medium", platen_curve: FilePath | None = None,
    friction: float = 0.0, assumed_range: bool = True, jobs: int = 1, executor: str | Executor = "local",
    out: FilePath | None = None,
) -> CalibrationResult:  # fmt: skip
    """Solve the 3D crossover and fit its compression law; needs dolfinx and PETSc.

    With jobs = 1 and the local executor everything runs in this process; else in `jobs` processes, and the script that
    calls needs the guard `if __name__ == "__main__":`.

    Parameters
    ----------
    fabric : Fabric, or what `weavecell.fabric` takes
    mesh : "coarse", "medium" or "fine"
    platen_curve : CSV file of pressure and thickness, to which E_c, V_c and K_r are fitted first; in their place the
        defaults of the fibre family are assumed where the fabric has no solid law
    friction : [-] Coulomb's coefficient between the yarns
    assumed_range : whether the law is fitted at both ends of an assumed solid law too, which triples the cost
    jobs, executor : as of `fabrics.executors.open_executor`
    out : folder for the histories and laws, or None

    Returns
    -------
    CalibrationResult

    Raises
    ------
    InputError : the fabric cannot be meshed, has no solid law that could be assumed, or a bad curve
    UnstableError : no path got far enough for a fit

    Examples
    --------
    >>> found = wc.calibrate("S-720", mesh="coarse", assumed_range=False)  # doctest: +SKIP
    >>> wc.shoot("S-720", "150 m/s", law=found)  # doctest: +SKIP
    """
    from meshing.mesh_plan import with_room
    from unitcell3d.identify import calibrate as solver
    from unitcell3d.identify.assumed_range import with_assumed_range

    cloth = with_room(assumed.with_solid_laws(as_fabric(fabric)))
    if platen_curve is not None:
        from fabrics.plate_curve import PlateCurve
        from unitcell3d.identify.solid_fit import fit_solid

        cloth = assumed.given(fit_solid(cloth, PlateCurve.read(platen_curve)).fabric, "solid")
    where = InProcess() if executor == "local" and jobs == 1 else executor
    choices: dict[str, Any] = {"size": mesh, "friction": friction, "jobs": jobs, "executor": where}
    done = solver.calibrate(cloth, out=out, **choices)
    failed: dict[str, str] = {}
    if assumed_range:
        done, failed = with_assumed_range(cloth, done, **choices)
    if out is not None:
        done.write(out)
    return CalibrationResult(
        replace(cloth, laws=(done.law, done.law)), done, (*cloth.notes, *assumed.lines(cloth)), failed
    )
