"""The calibration of the 3D crossover."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import replace
from typing import Any, Literal

from fabrics import assumed
from fabrics.checks import FilePath
from fabrics.executors import InProcess
from fabrics.fabric import Fabric
from weavecell.api.calibration_result import CalibrationResult
from weavecell.api.targets import as_fabric

__all__ = ["calibrate"]

MeshSize = Literal["coarse", "medium", "fine"]


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
