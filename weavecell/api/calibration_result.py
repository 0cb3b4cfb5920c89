"""Result of the calibration of the 3D crossover."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from weavecell.api.result import Result, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric
    from unitcell3d.identify.calibration import Calibration

__all__ = ["CalibrationResult"]


@dataclass(frozen=True, repr=False)
class CalibrationResult(Result):
    """A compression law fitted to the 3D crossover.

    Parameters
    ----------
    fabric : Fabric with the fitted law, ready for `shoot`, and with its solid law
    calibration : `unitcell3d.identify.calibration.Calibration`
    assumed : lines that name the laws that are assumed
    failed : {"soft" or "stiff": why this end of the assumed range has no law}

    Examples
    --------
    >>> found = wc.calibrate("S-720", mesh="coarse")  # doctest: +SKIP
    >>> found.law.a, found.law.b  # doctest: +SKIP
    """

    fabric: Fabric
    calibration: Calibration
    assumed: tuple[str, ...] = ()
    failed: dict[str, str] = field(default_factory=dict)

    @property
    def law(self) -> CompressionLaw:
        """The fitted law, of both yarn families."""
        return self.calibration.law

    def summary(self) -> dict[str, Any]:
        """a and b with their 95 % intervals, rms of the fit, and the range over the assumed solid law.

        "outside" says at which forces the ends of that range do not bracket the law.
        """
        law = self.law
        found: dict[str, Any] = {
            "fabric": self.fabric.name,
            "a_m": law.a,
            "b_m_N^(1/3)": law.b,
            "rms_m": law.residual_rms,
        }
        for key, pair in (("a_interval", law.a_interval), ("b_interval", law.b_interval)):
            if pair is not None:
                found |= {f"{key}_low": pair[0], f"{key}_high": pair[1]}
        for end, (a, b) in zip(("soft", "stiff"), law.assumed_range or ()):
            found |= {f"a_{end}_m": a, f"b_{end}_m_N^(1/3)": b}
        if law.outside_ends():
            found["outside"] = "; ".join(law.outside_ends())
        if self.assumed:
            found["assumed"] = "; ".join(self.assumed)
        return found

    def _columns(self):
        units = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "d_c": "m"}
        histories = self.calibration.histories
        columns: dict[str, Any] = {"path": [name for name, path in histories.items() for _ in path.path]}
        for name, unit in units.items():
            columns[f"{name}_{unit}"] = np.concatenate([np.asarray(path[name]) for path in histories.values()])
        return columns

    def plot(self) -> Figure:
        """A matplotlib figure: compression of a yarn [um] against contact force [N], samples and laws."""
        from unitcell3d.identify.calibration import samples
        from weavecell.report import pictures

        done = self.calibration
        drawn = {name: samples(path) for name, path in done.histories.items() if path is not done.plates}
        laws = {"fitted": done.law} | ({} if done.published is None else {"published": done.published})
        return figure(pictures.fit, drawn, laws, (done.plates.F_c, done.plates.d_c))

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh of the crossover at rest, crossover.vtu; returns its path."""
        from meshing import crossover
        from meshing.formats import export

        path = Path(folder) / "crossover.vtu"
        path.parent.mkdir(parents=True, exist_ok=True)
        export.write(crossover.build(self.fabric, size=self.calibration.sizes[0], domain="whole"), path)
        return path

    def write(self, folder: FilePath) -> Path:
        """Write law.json and calibration.json, as `weavecell calibrate` does; returns the path of law.json.

        Raises
        ------
        InputError : the folder is a file
        """
        folder = Path(folder)
        if folder.is_file():
            raise InputError("is a file", file=folder)
        folder.mkdir(parents=True, exist_ok=True)
        self.calibration.write(folder)
        return folder / "law.json"
