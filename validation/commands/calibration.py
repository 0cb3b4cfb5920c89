"""The compression laws of every fabric of the catalogue from its 3D crossover, beside those that the thesis prints.

    python -m validation calibration --mesh coarse [--fit-solid]

With --fit-solid the whole chain of every fabric with a platen law: platen curve, solid, compression law.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from fabrics.errors import InputError
from validation.published import calibration, calibration_chain
from weavecell.cli.from_signature import CORES

NOTES = {"mesh": "of the 3D crossover", "friction": "Coulomb's coefficient between the yarns",
         "page": "with --fit-solid: put tables and pictures into this page too"}  # fmt: skip


def main(
    *, fit_solid: bool = False, mesh: Literal["coarse", "medium", "fine"] = "medium", friction: float = 0.0,
    jobs: int = CORES, executor: str = "local", resume: bool = False, out: Path | None = None, page: Path | None = None,
) -> None:  # fmt: skip
    """Calibrate the catalogue, write tables, pictures and a report to the folder `out`, and print them."""
    if page is not None and not fit_solid:
        raise InputError("--page goes with --fit-solid")
    out = out or Path("results") / ("calibrate-chain" if fit_solid else "calibrate-all")
    if fit_solid:
        calibration_chain.command(
            out, size=mesh, jobs=jobs, executor=executor, resume=resume, friction=friction, page=page
        )
    else:
        calibration.command(out, size=mesh, jobs=jobs, executor=executor, resume=resume, friction=friction)
